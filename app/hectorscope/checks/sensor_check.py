"""Checks the sensors of a source against what their messages promise, before a run is spoilt in silence."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from typing import Any

from hectorscope.checks.findings import findings, remedy, repairing_options
from hectorscope.checks.sensor_statistics import LONGEST_S, SensorStatistics
from hectorscope.inputs import (
    SENSOR_OPTIONS,
    Finding,
    Framed,
    Item,
    MessageListener,
    Rereadable,
    Seekable,
    Source,
    SourceError,
    SourceOptions,
    SourceReport,
    Tappable,
)
from slam_core.measurements import Transform

REST_S = 1.5  # of a stream: then gravity is looked at, which needs no turn
STEP_S = 4.0  # after each of these it is asked whether enough was seen
PREFIX_S = 30.0  # enough was seen by then
ROUNDS = 3  # of repairs: what was wrong may have hidden something else
CHECKING = "Checking the sensors against each other, by the beginning of the recording"


class SensorError(SourceError):
    """A sensor contradicts what its messages promise; the options that repair it are named."""


class SensorCheck:
    """Takes the items from the beginning of a source; settled: it has seen enough and found nothing wrong.

    found: what contradicts the messages. warnings: the same as a sentence, where it does not spoil the run, or not
    surely. live: do not wait for a turn with what can be judged before. thorough: look as far as `inspect` does.
    """

    def __init__(self, name: str, options: SourceOptions, *, live: bool = False, thorough: bool = False) -> None:
        self.settled = False
        self.found: tuple[Finding, ...] = ()
        self.warnings: tuple[str, ...] = ()
        self._live = self._glance = live
        self._name, self._options = name, options
        self._statistics = SensorStatistics()
        self._asked_s = LONGEST_S if thorough else STEP_S

    def take(self, item: Item) -> None:
        """One more item; SensorError once it is clear that something is wrong."""
        time_s = self._statistics.take(item)
        if self._glance and time_s >= REST_S:
            measures = self._statistics.at_rest()
            self._glance = measures.gravity is None
            self._tell(findings(measures, self._options))
        if time_s >= self._asked_s:
            self._asked_s += STEP_S
            self.judge(last=time_s >= PREFIX_S or not self._statistics.comparable, whole=time_s >= LONGEST_S)

    def judge(self, *, last: bool, whole: bool) -> None:
        """By the data so far. The verdict waits for a turn, so that all faults are reported at once.

        whole: there is no more to look at. A recording with a fault is looked at as far as `inspect` does, so that
        both give the same figures.
        """
        measures = self._statistics.measures()
        enough = last or measures.has_turn
        found = findings(measures, self._options) if enough else []
        if found and not self._live and not whole:
            self._asked_s = LONGEST_S
            return
        if enough:
            self._tell(found)
            self.settled = last or not self._statistics.show_times or measures.has_times

    def _tell(self, found: Sequence[Finding]) -> None:
        self.found = tuple(found)
        facts = "; ".join(finding.fact for finding in self.found)
        by_hand = f"or with {remedy(self.found)}"
        if any(name.startswith("imu_") for name in repairing_options(self.found)):
            by_hand += ", or without the IMU by --imu-topic none"
        text = f"{self._name}: {facts}: run again with --repair, {by_hand}"
        if any(finding.grave for finding in self.found):
            raise SensorError(text)
        self.warnings = (text,) if self.found else ()


class CheckedSource:
    """A source with checked sensors: a recording by its beginning, before its items come; a stream as it flows.

    opened: opens the source with options. repairs: put right what `inspect` finds, instead of a SensorError; of a
    stream, whoever reads it does, as what flowed until then was wrong.
    """

    def __init__(
        self, opened: Callable[[SourceOptions], Source], options: SourceOptions, *, repairs: bool = False
    ) -> None:
        self.repairs = repairs
        self._opened, self._options = opened, options
        self._source = opened(options)
        self.name, self.live = self._source.name, self._source.live
        self._check: SensorCheck | None = None
        self._checking = self._is_sound = False
        self._repaired: tuple[Finding, ...] = ()
        self._rounds = 0
        self._listeners: list[MessageListener] = []

    @property
    def span_ns(self) -> tuple[int, int] | None:
        """Of the source."""
        return self._source.span_ns

    @property
    def report(self) -> SourceReport:
        """Of the source, with what its sensors contradict, and what was repaired."""
        report, check = self._source.report, self._check
        if self._checking:
            report = replace(report, waiting=CHECKING)
        notes = tuple(f"Repaired: {finding.fact} ({finding.repair})" for finding in self._repaired)
        return replace(
            report,
            notes=(*notes, *report.notes),
            warnings=(*report.warnings, *(check.warnings if check else ())),
            findings=check.found if check else (),
            repaired=self._repaired,
            sensors=stated(self._options),
        )

    def items(self) -> Iterator[Item]:
        """Of the source. SensorError if its sensors are not what they promise."""
        if self.live:
            return self._watched()
        self.check()
        return self._source.items()

    def reopened(self) -> Source:
        """The source once more, without its check."""
        return self._opened(self._options)

    def place(self) -> object:
        """Of the source; None if it has none."""
        return self._source.place() if isinstance(self._source, Seekable) else None

    def items_from(self, place: object) -> Iterator[Item]:
        """Of the source, which gave the place."""
        assert isinstance(self._source, Seekable)
        return self._source.items_from(place)

    def again(self) -> Seekable | None:
        """Of the source, which must be checked already."""
        return self._source.again() if isinstance(self._source, Rereadable) else None

    def root(self, time_ns: int) -> tuple[str, Transform]:
        """Of the source, which must be a stream."""
        assert isinstance(self._source, Framed)
        return self._source.root(time_ns)

    def check(self) -> None:
        """Look at the beginning of a recording, once; SensorError if it does not bear out its messages."""
        self._checking = True
        try:
            while not self._is_sound:
                try:
                    self._examine()
                except SensorError:
                    if not (self.repairs and self.repair()):
                        raise
                else:
                    self._is_sound = not (self.repairs and self.repair())
        finally:
            self._checking = False

    def _examine(self) -> None:
        check = self._check = SensorCheck(self.name, self._options, thorough=self.repairs)
        for item in self._source.items():
            check.take(item)
            if check.settled:
                break
        else:
            check.judge(last=True, whole=True)

    def _watched(self) -> Iterator[Item]:
        check = self._check = SensorCheck(self.name, self._options, live=True)
        for item in self._source.items():
            if not check.settled:
                check.take(item)
                if self.repairs and check.warnings and not self._repaired:
                    raise SensorError(check.warnings[0])
            yield item

    def repair(self) -> tuple[Finding, ...]:
        """Open the source again with the options that repair what was found; that, or nothing.

        What is found then is repaired too, but not again and again.
        """
        found = self._check.found if self._check and self._rounds < ROUNDS else ()
        if found:
            self.repairs, self._rounds = True, self._rounds + 1
            changed: dict[str, Any] = repairing_options(found)
            self._options = replace(self._options, **changed)
            self._source.close()
            self._source = self._opened(self._options)
            for listener in self._listeners:
                self._tap(listener)
            self._check, self._is_sound = None, False
            self._repaired += found
        return found

    def tap(self, listener: MessageListener) -> None:
        """Pass it the messages of a live source, also once it was opened again."""
        self._listeners.append(listener)
        self._tap(listener)

    def _tap(self, listener: MessageListener) -> None:
        if isinstance(self._source, Tappable):
            self._source.tap(listener)

    def untap(self, listener: MessageListener) -> None:
        """It gets nothing any more."""
        self._listeners.remove(listener)
        if isinstance(self._source, Tappable):
            self._source.untap(listener)

    def close(self) -> None:
        """Let go of the source."""
        self._source.close()


def stated(options: SourceOptions) -> dict[str, Any]:
    """The `SENSOR_OPTIONS` that are stated; a topic only where it is left out."""
    values = {name: getattr(options, name) for name in SENSOR_OPTIONS}
    return {n: v for n, v in values.items() if v is not None and (not n.endswith("_topic") or v == "none")}
