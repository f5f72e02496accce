"""Examines the whole recording on a thread of its own, while the run goes on."""

import logging
import threading
from collections.abc import Callable

from hectorscope.checks.recording_check import examine
from hectorscope.inputs import Examinable, Finding, Reopenable, Source
from hectorscope.session.commands import Answer
from slam_core.errors import SlamError

_logger = logging.getLogger("hectorscope")

ABSENT = "Only a recording of ROS messages or a log can be examined as a whole"


class Examiner:
    """answer: hears from any thread how an examination ended."""

    def __init__(self, answer: Callable[[Answer], None]) -> None:
        self._answer = answer
        self._thread: threading.Thread | None = None
        self._examined: tuple[Source, tuple[Finding, ...]] | None = None

    def found(self, source: Source) -> tuple[Finding, ...] | None:
        """What is wrong with a recording; None until it was examined."""
        return self._examined[1] if self._examined and self._examined[0] is source else None

    def start(self, source: Source) -> None:
        """Begin; SlamError if that cannot be."""
        if source.live or not isinstance(source, Reopenable):
            raise SlamError(ABSENT)
        if self._thread is None or not self._thread.is_alive():
            self._thread = threading.Thread(target=self._examine, args=[source], name="examine", daemon=True)
            self._thread.start()

    def _examine(self, source: Reopenable) -> None:
        try:
            opened = source.reopened()
            try:
                if not isinstance(opened, Examinable):
                    raise SlamError(ABSENT)
                found = tuple(examine(opened))
            finally:
                opened.close()
        except SlamError as error:
            self._answer(Answer(str(error), failed=True))
        except Exception as error:  # a bug must not leave the person without an answer
            _logger.exception("an examination failed")
            self._answer(Answer(f"The recording was not examined: {type(error).__name__}: {error}", failed=True))
        else:
            self._examined = source, found
            self._answer(Answer(f"Examined the whole recording: {counted(len(found))}"))


def counted(findings: int) -> str:
    """How many, in words."""
    if not findings:
        return "topics, clocks, frames and beams are in order"
    return "one finding" if findings == 1 else f"{findings} findings"
