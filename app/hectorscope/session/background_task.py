"""Work on a thread of its own, beside the run: one piece at a time, and each ends with an answer in the log."""

import logging
import threading
from collections.abc import Callable

from hectorscope.session.commands import Answer
from slam_core.errors import SlamError

_logger = logging.getLogger("hectorscope")


class BackgroundTask:
    """name: of the thread. answer: gets from it how the work ended. busy, failed: beginnings of two sentences.

    daemon: whether the end of the program does not wait for it.
    """

    def __init__(
        self, name: str, answer: Callable[[Answer], None], *, busy: str, failed: str, daemon: bool = True
    ) -> None:
        self._name, self._answer, self._daemon = name, answer, daemon
        self._busy, self._failed = busy, failed
        self._thread: threading.Thread | None = None

    def check_idle(self) -> None:
        """SlamError while something is worked on."""
        if self._thread is not None and self._thread.is_alive():
            raise SlamError(f"{self._busy}: wait for the end")

    def start(self, work: Callable[[], str]) -> None:
        """Begin, while idle. work: gives the sentence for the log."""
        self._thread = threading.Thread(target=self._run, args=(work,), name=self._name, daemon=self._daemon)
        self._thread.start()

    def wait(self) -> None:
        """Until the end of what is worked on."""
        if self._thread is not None:
            self._thread.join()

    def _run(self, work: Callable[[], str]) -> None:
        try:
            answer = Answer(work())
        except (SlamError, OSError) as error:
            answer = Answer(f"{self._failed}: {error}", failed=True)
        except Exception as error:  # also a bug must not leave the person without an answer
            _logger.exception("%s", self._failed)
            answer = Answer(f"{self._failed}: {type(error).__name__}: {error}", failed=True)
        self._answer(answer)
