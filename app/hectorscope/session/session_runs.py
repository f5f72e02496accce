"""The runs of a session beside the shown one: their list, the one that is compared, a kept one on its way."""

from typing import TYPE_CHECKING

from hectorscope.run.run_file import RunFile, hash_of
from hectorscope.session.comparison import Comparison
from hectorscope.session.runs import NamedRun, Runs, RunsError, first_difference
from hectorscope.session.undo import KeptName

if TYPE_CHECKING:
    from hectorscope.session.session import Session


class SessionRuns:
    """Belongs to the engine's thread. expected: a kept run on its way to where it was kept.

    budget: bytes of checkpoints of a compared run.
    """

    def __init__(self, session: "Session", budget: int) -> None:
        self.runs = Runs()
        self.comparison: Comparison | None = None
        self.expected: RunFile | None = None
        self._session, self._budget = session, budget

    def note(self) -> None:
        """Put the shown run into the list as it is now."""
        session = self._session
        run, transport, pipeline = session.run, session.transport, session.run.pipeline
        time_ns = transport.wanted_ns or transport.target_ns or pipeline.time_ns
        offset_ns = max(0, time_ns - (pipeline.start_ns or 0))
        name, path = self.runs.name(run.slot), session.intake.path
        self.runs.put(NamedRun(run.slot, name, session.source.name, path, run.settings, offset_ns))

    def arrived(self) -> None:
        """A seek has ended: a kept run that was opened is compared with what was kept of it."""
        session = self._session
        kept, self.expected, pipeline = self.expected, None, session.run.pipeline
        if kept is None or session.run.settings != kept.link.settings:
            return
        if (pipeline.scans, hash_of(pipeline.trajectory)) == (kept.scans, kept.trajectory_sha256):
            session.log(
                f"{kept.link.name}: the same trajectory to the byte as when it was kept ({kept.scans} scans)"
            )
        else:
            session.log(
                f"{kept.link.name} differs from when it was kept: {pipeline.scans} scans, {kept.scans} then."
                " Another version of the program or another --map was used",
                "warning",
                answer=True,
            )

    def new_slot(self, name: str = "") -> int:
        """The number of one more run; the shown one is noted. The first recording has that of the beginning."""
        if not self._session.transport.empty:
            self.note()
            return self.runs.new(name)
        if name:
            self.runs.rename(self._session.run.slot, name)
        return self._session.run.slot

    def keep_removed(self, run: NamedRun) -> None:
        """For a minute."""
        self._session.undone.push(f"removing {run.name}", KeptName(run))

    @property
    def compared_with(self) -> int:
        """The number of the run that is compared; 0 for none."""
        return self.comparison.run.number if self.comparison else 0

    def compare(self, run: NamedRun) -> None:
        """Compare with a run of the shown recording; RunsError if that cannot be."""
        session, shown = self._session, self._session.run
        if run.number == shown.slot or run.path != session.intake.path or not shown.pipeline.scans:
            raise RunsError(f"{run.name} cannot be compared: choose another run of the recording that is shown")
        known = shown.checkpoints.until(first_difference(shown.settings, run.settings), self._budget)
        made = Comparison(run, session.source, shown.pipeline.start_ns, session.prior_map, known)
        self.end_comparison()
        self.comparison = made

    def end_comparison(self) -> None:
        """Compare with no run."""
        if self.comparison:
            self.comparison.close()
        self.comparison = None

    def advance(self, seconds: float) -> bool:
        """Run on with the compared run for about so long; whether there was something to do."""
        return self.comparison is not None and self.comparison.advance(seconds, self._session.run.pipeline.time_ns)
