"""Durations of the stages of a step, by a clock that the caller provides: the core has none."""

from collections.abc import Callable
from typing import Generic, ParamSpec, TypeVar

from slam_core.results import Durations

Clock = Callable[[], int]
P = ParamSpec("P")
R = TypeVar("R")


class Stopwatch:
    """Adds up the time spent in the functions that it wraps, by stage. clock: nanoseconds."""

    def __init__(self, clock: Clock) -> None:
        self.clock = clock
        self.spent = dict.fromkeys(Durations._fields, 0)

    def timed(self, stage: str, function: Callable[P, R]) -> "Timed[P, R]":
        """The function, whose time counts for a stage (a field of Durations)."""
        return Timed(self, stage, function)

    def lap(self) -> Durations:
        """The durations since the last lap."""
        durations = Durations(**self.spent)
        self.spent = dict.fromkeys(Durations._fields, 0)
        return durations


class Timed(Generic[P, R]):
    """A function and its stage; an object, as a copy of the pipeline has to copy what a method is bound to."""

    def __init__(self, stopwatch: Stopwatch, stage: str, function: Callable[P, R]) -> None:
        self._stopwatch, self._stage, self._function = stopwatch, stage, function

    def __call__(self, *arguments: P.args, **options: P.kwargs) -> R:
        """The function's result."""
        stopwatch = self._stopwatch
        begin = stopwatch.clock()
        result = self._function(*arguments, **options)
        stopwatch.spent[self._stage] += stopwatch.clock() - begin
        return result
