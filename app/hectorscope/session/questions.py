"""Commands that would lose something wait here until a person agrees."""

import time
from collections.abc import Callable

from hectorscope.session.commands import Command
from hectorscope.session.snapshot import Question

PATIENCE_S = 60.0


class Questions:
    """One question at a time: a newer one takes the place of the one before. Without an answer nothing happens.

    clock: seconds, monotonic.
    """

    def __init__(self, clock: Callable[[], float] = time.monotonic) -> None:
        self.open: Question | None = None
        self._clock = clock
        self._asked = 0
        self._held: Command | None = None
        self._expires = 0.0

    @property
    def left(self) -> float | None:
        """Seconds until the question is withdrawn; None if there is none."""
        return None if self.open is None else max(0.0, self._expires - self._clock())

    def ask(self, command: Command, text: str, agree: str, decline: str, patience_s: float = PATIENCE_S) -> None:
        """Hold a command back, for so many seconds."""
        self._asked += 1
        self.open = Question(self._asked, text, agree, decline)
        self._held = command
        self._expires = self._clock() + patience_s

    def agreed(self, number: int) -> Command | None:
        """The command that this question held back; None if the question is no longer open."""
        if self.open is None or self.open.number != number:
            return None
        held = self._held
        self.withdraw()
        return held

    def declined(self, number: int) -> None:
        """The command is dropped."""
        if self.open is not None and self.open.number == number:
            self.withdraw()

    def withdraw(self) -> None:
        """Nothing is asked any more."""
        self.open = self._held = None

    def lapse(self) -> bool:
        """Withdraw a question that nobody answered; whether there was one."""
        over = self.left == 0.0
        if over:
            self.withdraw()
        return over
