"""What the engine does with the run as long as nobody asks for anything: reads, steps, and ends."""

from collections.abc import Callable

from hectorscope.run.pipeline import nothing_used
from hectorscope.session.session import Session
from hectorscope.session.transport import PAUSED
from slam_core.measurements import LaserScan

FETCH_S = 0.02  # how long a command may wait while a source has nothing to give
AT_ONCE = 20  # items before a look at everything else: a tenth of a second, where a stream has no scans


class Stepping:
    """Belongs to the engine's thread. asked: whether a command waits. show: shows at once how things are."""

    def __init__(self, session: Session, asked: Callable[[], bool], show: Callable[[], None]) -> None:
        self._session, self._asked, self._show = session, asked, show
        self._transport, self._publisher = session.transport, session.publisher

    def advance(self) -> None:
        """One scan, or what comes before it, as long as nobody asks for anything and nothing is to be shown."""
        self._session.past.step_front()
        run = self._session.run
        if isinstance(run.waiting, LaserScan):
            self._scan(run.waiting.stamp_ns)
            return
        for _ in range(AT_ONCE):
            if run.waiting is not None:
                run.step()
            elif not self._fetch():
                return
            if isinstance(run.waiting, LaserScan) or self._asked() or self._publisher.due():
                return

    def _fetch(self) -> bool:
        """Read one item; whether there was one at hand."""
        self._session.keep()
        run, intake = self._session.run, self._session.intake
        item = intake.get(FETCH_S)
        if item is not None:
            run.admit(item)
        elif intake.done:
            run.flush()
            if run.waiting is None:
                self._end()
        return item is not None

    def _scan(self, stamp_ns: int) -> None:
        self._publisher.touch()
        if self._transport.arrives(stamp_ns):
            self._session.named.arrived()
            self._seek_on()
            return
        if self._transport.unwanted:
            self._session.run.skip(PAUSED)
        else:
            self._step(stamp_ns)
        self._transport.passed(stamp_ns)

    def _seek_on(self) -> None:
        """A seek has arrived: show that, and go on to where somebody wants to be by now."""
        wanted_ns = self._transport.wanted_ns
        if wanted_ns is not None:
            self._show()
            self._transport.wanted_ns = None
            self._session.seek(wanted_ns)

    def _step(self, stamp_ns: int) -> None:
        run, before = self._session.run, self._session.run.pipeline.result
        result = run.step_scan(rests=self._transport.may_rest_after(stamp_ns))
        if result is None and run.pipeline.searching and not run.sought:
            run.sought = True
            self._session.log(f"The robot is not found in the map yet: {run.pipeline.searching}", "warning")
        if self._session.past.front is None:
            self._session.tell(before, result)

    def _end(self) -> None:
        session = self._session
        session.intake.check()
        if session.past.front:
            session.past.go_live()
            return
        if not (pipeline := session.run.pipeline).scans:
            raise nothing_used(session.source.name, session.report.skipped, pipeline.slam)
        session.named.arrived()
        self._transport.end()
        self._publisher.touch()
        self._publisher.log_once(session.entry(f"The recording ended after {pipeline.scans} scans"))
        self._seek_on()
