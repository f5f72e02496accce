"""The thread that works for every browser that looks inside the matcher: neither the engine nor the page waits."""

import logging
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from hectorscope.panels._xray_shown import Shown
from hectorscope.panels._xray_wanted import Wanted
from hectorscope.run.settings import Settings
from slam_core.config import SlamConfig
from slam_core.errors import SlamError
from slam_core.measurements import Float64s
from slam_core.results import StepResult

if TYPE_CHECKING:
    from hectorscope.panels._xray_work import OpenScan
    from hectorscope.session.other_scans import OtherScans, Reached
    from hectorscope.session.rework import Rework

# The core is imported once somebody looks: the page is served before.

log = logging.getLogger(__name__)

MOST = 64  # browsers that look inside at a time
SLICE_S = 0.05  # of work on the way to another scan, before others have their turn
MOST_OPEN = 4  # scans that are held open at a time; another one takes some 0.1 s to open


@dataclass(frozen=True, eq=False)
class Subject:
    """The scan at which a run rests, and the run before it. scan_s: its time since the start of the recording."""

    rework: "Rework"
    result: StepResult
    config: SlamConfig
    settings: Settings
    scan_s: float = 0.0

    def open_scan(self) -> "OpenScan | None":
        """Where it is worked on; None for a scan that was matched to nothing."""
        from hectorscope.panels._xray_work import OpenScan  # noqa: PLC0415
        from hectorscope.run.xray.match_problem import problem_of  # noqa: PLC0415

        problem = problem_of(self.rework.before(self.settings), self.result, self.config)
        return OpenScan(problem) if problem else None


@dataclass(eq=False)
class Visit:
    """Another scan of a recording, to which one browser goes. scan_s: its time since the start."""

    others: "OtherScans"
    scan_s: float
    subject: Subject | None = None

    def way(self) -> Iterator[None]:
        """Work in slices, until `subject` is there; at once the second time. SlamError if it cannot be."""
        if self.subject is None:
            reached: Reached | None = None
            for reached in self.others.way_to(self.scan_s, SLICE_S):
                if reached is None:
                    yield
            assert reached is not None
            found = reached.rework, reached.result, reached.config
            self.subject = Subject(*found, self.others.settings, self.scan_s)


@dataclass(eq=False)
class _Viewer:
    """A browser: what it wants of which scan, and what is still to be worked out for it."""

    wanted: Wanted
    subject: Subject | Visit | None
    start: Float64s | None = None
    work: Iterator[Shown] | None = None

    @property
    def keeps(self) -> bool:
        """Whether its scan stays."""
        return self.wanted.keep and self.subject is not None


class Worker:
    """Takes turns between browsers, a slice of work each. show: gets each result, on this thread.

    The thread begins with the first browser and ends with the last.
    """

    def __init__(self, show: Callable[[int, Shown], None]) -> None:
        self._show = show
        self._changed = threading.Condition()
        self._viewers: dict[int, _Viewer] = {}
        self._subject: Subject | None = None
        self._scans: dict[Subject, OpenScan | None] = {}
        self._thread: threading.Thread | None = None

    def look_at(self, subject: Subject | None, *, anew: bool = False) -> None:
        """Another scan is shown, or none that can be looked into. anew: of another recording, so none is kept."""
        with self._changed:
            self._subject = subject
            self._take(*(client for client, each in self._viewers.items() if anew or not each.keeps))

    def want(self, client: int, wanted: Wanted) -> None:
        """A browser wants to see something."""
        with self._changed:
            if client in self._viewers:
                self._viewers[client].wanted = wanted
            elif len(self._viewers) < MOST:
                self._viewers[client] = _Viewer(wanted, self._subject)
            if client in self._viewers and not self._viewers[client].keeps:
                self._take(client)
            self._begin(client)

    def start_at(self, client: int, start: Float64s | None) -> None:
        """A browser starts the matcher at another pose (3,); None for that of the run."""
        with self._changed:
            if client in self._viewers:
                self._viewers[client].start = start
                self._begin(client)

    def visit(self, client: int, others: "OtherScans", near_s: float | None, by: int = 0) -> None:
        """A browser goes to another scan and keeps it: the one nearest to a time, or so many scans from there.

        near_s: seconds since the start of the recording; None for where the browser is.
        """
        with self._changed:
            viewer = self._viewers.get(client)
            if viewer is None:
                return
            if near_s is None:
                near_s = viewer.subject.scan_s if viewer.subject else 0.0
            scan_s = others.time_of(near_s, by)
            if scan_s is not None:
                viewer.wanted = replace(viewer.wanted, keep=True)
                viewer.subject, viewer.start = Visit(others, scan_s), None
                self._begin(client)

    def leave(self, client: int) -> None:
        """A browser looks no more."""
        with self._changed:
            self._viewers.pop(client, None)
            self._changed.notify()

    @property
    def viewers(self) -> list[int]:
        """Who looks."""
        with self._changed:
            return list(self._viewers)

    def _take(self, *clients: int) -> None:
        """These browsers look at the scan that the run shows, from the run's own start if it is another one."""
        for client in clients:
            viewer = self._viewers[client]
            if viewer.subject is not self._subject:
                viewer.subject, viewer.start = self._subject, None
                self._begin(client)

    def _begin(self, *clients: int) -> None:
        for client in clients:
            if client in self._viewers:
                viewer = self._viewers[client]
                viewer.work = self._work(viewer.subject, viewer.wanted, viewer.start)
        if self._viewers and self._thread is None:
            self._thread = threading.Thread(target=self._run, name="xray", daemon=True)
            self._thread.start()
        self._changed.notify()

    def _work(self, subject: Subject | Visit | None, wanted: Wanted, start: Float64s | None) -> Iterator[Shown]:
        """Runs on the thread, from the first `next` on."""
        from hectorscope.panels import _xray_words as words  # noqa: PLC0415

        if isinstance(subject, Visit):
            try:
                for _ in subject.way():
                    yield Shown(words.ON_THE_WAY, scan_s=subject.scan_s)
            except SlamError as error:
                yield Shown(words.unreached(str(error)), scan_s=subject.scan_s)
                return
            subject = subject.subject
        opened = self._opened(subject) if subject else None
        if subject is None or opened is None:
            yield Shown(words.FIRST if subject else words.NOTHING)
            return
        for shown in opened.shown(wanted, start):
            yield replace(shown, scan_s=subject.scan_s)

    def _opened(self, subject: Subject) -> "OpenScan | None":
        """A scan, held open; those that were not asked for longest are closed."""
        opened = self._scans.pop(subject) if subject in self._scans else subject.open_scan()
        while len(self._scans) >= MOST_OPEN:
            del self._scans[next(iter(self._scans))]
        self._scans[subject] = opened
        return opened

    def _run(self) -> None:
        while (turn := self._next_turn()) is not None:
            client, work = turn
            try:
                shown = next(work, None)
                if shown is not None:
                    self._show(client, shown)
            except Exception:  # the others go on
                log.exception("the match cannot be looked into")
                shown = None
            if shown is None:
                self._end(client, work)

    def _next_turn(self) -> tuple[int, Iterator[Shown]] | None:
        """The browser that waited longest, with its work; None once nobody looks."""
        with self._changed:
            while self._viewers:
                for client, viewer in self._viewers.items():
                    if viewer.work is not None:
                        self._viewers[client] = self._viewers.pop(client)  # to the end of the line
                        return client, viewer.work
                self._changed.wait()
            self._thread = None
            self._scans.clear()
            return None

    def _end(self, client: int, work: Iterator[Shown]) -> None:
        with self._changed:
            viewer = self._viewers.get(client)
            if viewer is not None and viewer.work is work:
                viewer.work = None
