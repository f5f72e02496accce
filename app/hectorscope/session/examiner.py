"""Examines the whole recording on a thread of its own, while the run goes on."""

from collections.abc import Callable
from contextlib import closing
from functools import partial

from hectorscope.checks.recording_check import examine
from hectorscope.inputs import Examinable, Finding, Reopenable, Source
from hectorscope.session.background_task import BackgroundTask
from hectorscope.session.commands import Answer
from slam_core.errors import SlamError

ABSENT = "Only a recording of ROS messages or a log can be examined as a whole"


class Examiner:
    """answer: hears from any thread how an examination ended."""

    def __init__(self, answer: Callable[[Answer], None]) -> None:
        self._task = BackgroundTask(
            "examine", answer, busy="A recording is being examined already", failed="The examination failed"
        )
        self._examined: tuple[Source, tuple[Finding, ...]] | None = None

    def found(self, source: Source) -> tuple[Finding, ...] | None:
        """What is wrong with a recording; None until it was examined."""
        return self._examined[1] if self._examined and self._examined[0] is source else None

    def start(self, source: Source) -> None:
        """Begin; SlamError if that cannot be."""
        if source.live or not isinstance(source, Reopenable):
            raise SlamError(ABSENT)
        self._task.check_idle()
        self._task.start(partial(self._examine, source))

    def _examine(self, source: Reopenable) -> str:
        with closing(source.reopened()) as opened:
            if not isinstance(opened, Examinable):
                raise SlamError(ABSENT)
            found = tuple(examine(opened))
        self._examined = source, found
        return f"Examined the whole recording: {counted(len(found))}"


def counted(findings: int) -> str:
    """How many, in words."""
    if not findings:
        return "topics, clocks, frames and beams are in order"
    return "one finding" if findings == 1 else f"{findings} findings"
