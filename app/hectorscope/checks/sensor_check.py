"""Refuses a source whose sensors contradict what their messages promise, before a run is spoilt in silence."""

from collections.abc import Iterator
from dataclasses import replace

from hectorscope.checks.findings import findings, remedy
from hectorscope.checks.sensor_statistics import Measures, SensorStatistics
from hectorscope.inputs import Item, Source, SourceError, SourceOptions, SourceReport

REST_S = 1.5  # of a stream: then gravity is looked at, which needs no turn
STEP_S = 4.0  # after each of these it is asked whether enough was seen
PREFIX_S = 30.0  # enough was seen by then


class DeviceError(SourceError):
    """A sensor contradicts what its messages promise; the options that repair it are named."""


class SensorCheck:
    """Takes the items from the beginning of a source; settled: it has seen enough and found nothing wrong.

    warnings: what contradicts the messages without spoiling the run, or not surely. live: do not wait for a turn
    with what can be judged before.
    """

    def __init__(self, name: str, options: SourceOptions, *, live: bool = False) -> None:
        self.settled = False
        self.warnings: tuple[str, ...] = ()
        self._glance = live
        self._name, self._options = name, options
        self._evidence = SensorStatistics()
        self._asked_s = STEP_S

    def take(self, item: Item) -> None:
        """One more item; DeviceError once it is clear that something is wrong."""
        time_s = self._evidence.take(item)
        if self._glance and time_s >= REST_S:
            measures = self._evidence.at_rest()
            self._glance = measures.gravity is None
            self._tell(measures)
        if time_s >= self._asked_s:
            self._asked_s += STEP_S
            self.judge(last=time_s >= PREFIX_S or not self._evidence.comparable)

    def judge(self, *, last: bool) -> None:
        """By the data so far. The verdict waits for a turn, so that all faults are reported at once."""
        measures = self._evidence.measures()
        self.settled = last or measures.turn is not None or measures.wheels is not None
        if self.settled:
            self._tell(measures)

    def _tell(self, measures: Measures) -> None:
        found = findings(measures, self._options)
        facts = "; ".join(finding.fact for finding in found)
        text = f"{self._name}: {facts}: run again with {remedy(found)}, or without the IMU by --imu-topic none"
        if any(finding.grave for finding in found):
            raise DeviceError(text)
        self.warnings = (text,) if found else ()


class Watched:
    """A stream that is checked_source as it flows: a DeviceError ends it."""

    live = True
    span_ns = None

    def __init__(self, source: Source, options: SourceOptions) -> None:
        self.name = source.name
        self._source = source
        self._examiner = SensorCheck(source.name, options, live=True)

    @property
    def report(self) -> SourceReport:
        """Of the stream, with what its devices contradict."""
        return replace(self._source.report, warnings=self._examiner.warnings)

    def items(self) -> Iterator[Item]:
        """Of the stream."""
        for item in self._source.items():
            if not self._examiner.settled:
                self._examiner.take(item)
            yield item

    def close(self) -> None:
        """Hang up."""
        self._source.close()


def checked_source(source: Source, options: SourceOptions) -> Source:
    """The source, once the beginning of a recording has borne out its messages; DeviceError if it does not."""
    if source.live:
        return Watched(source, options)
    check = SensorCheck(source.name, options)
    for item in source.items():
        check.take(item)
        if check.settled:
            return source
    check.judge(last=True)
    return source
