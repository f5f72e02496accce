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
        self._otherwise: Command | None = None
        self._expires = 0.0

    @property
    def left(self) -> float | None:
        """Seconds until the question is withdrawn; None if there is none."""
        return None if self.open is None else max(0.0, self._expires - self._clock())

    def ask(
        self,
        command: Command,
        text: str,
        agree: str,
        decline: str,
        *,
        patience_s: float = PATIENCE_S,
        otherwise: Command | None = None,
    ) -> None:
        """Hold a command back, for so many seconds. otherwise: what is done once somebody declines."""
        self._asked += 1
        self.open = Question(self._asked, text, agree, decline)
        self._held, self._otherwise = command, otherwise
        self._expires = self._clock() + patience_s

    def agreed(self, number: int) -> Command | None:
        """The command that this question held back; None if the question is no longer open."""
        return self._answered(number, self._held)

    def declined(self, number: int) -> Command | None:
        """The command is dropped; what is done in its place, if anything."""
        return self._answered(number, self._otherwise)

    def _answered(self, number: int, command: Command | None) -> Command | None:
        if self.open is None or self.open.number != number:
            return None
        self.withdraw()
        return command

    def withdraw(self) -> None:
        """Nothing is asked any more."""
        self.open = self._held = self._otherwise = None

    def lapse(self) -> bool:
        """Withdraw a question that nobody answered; whether there was one."""
        over = self.left == 0.0
        if over:
            self.withdraw()
        return over
