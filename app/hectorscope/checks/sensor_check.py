"""Refuses a source whose sensors contradict what their messages promise, before a run is spoilt in silence."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from hectorscope.checks.findings import Finding, findings, remedy
from hectorscope.checks.sensor_statistics import LONGEST_S, SensorStatistics
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
        self._live = self._glance = live
        self._name, self._options = name, options
        self._evidence = SensorStatistics()
        self._asked_s = STEP_S

    def take(self, item: Item) -> None:
        """One more item; DeviceError once it is clear that something is wrong."""
        time_s = self._evidence.take(item)
        if self._glance and time_s >= REST_S:
            measures = self._evidence.at_rest()
            self._glance = measures.gravity is None
            self._tell(findings(measures, self._options))
        if time_s >= self._asked_s:
            self._asked_s += STEP_S
            self.judge(last=time_s >= PREFIX_S or not self._evidence.comparable, whole=time_s >= LONGEST_S)

    def judge(self, *, last: bool, whole: bool) -> None:
        """By the data so far. The verdict waits for a turn, so that all faults are reported at once.

        whole: there is no more to look at. A recording to be refused is looked at as far as `inspect` does,
        so that both give the same figures.
        """
        measures = self._evidence.measures()
        enough = last or measures.turn is not None or measures.wheels is not None
        found = findings(measures, self._options) if enough else []
        if not self._live and not whole and any(finding.grave for finding in found):
            self._asked_s = LONGEST_S
            return
        self.settled = enough
        if enough:
            self._tell(found)

    def _tell(self, found: Sequence[Finding]) -> None:
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
    check.judge(last=True, whole=True)
    return source
