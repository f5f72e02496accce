"""Faults of the sensors that the motion is estimated from, found after each scan."""

from collections import Counter
from collections.abc import Iterable, Mapping

from slam_core.diagnostics import NO_BEAM, REPEATED, TOO_LATE, Code, Diagnostic, Recent
from slam_core.navigation.filter import NavigationFilter
from slam_core.navigation.gates import LEAST_STREAK
from slam_core.navigation.imu_check import AFTER_LEAP, AT_RANGE, NO_NUMBER, SENT_AGAIN
from slam_core.navigation.imu_spikes import SPIKE
from slam_core.navigation.level_ride import LevelRide
from slam_core.navigation.rejections import LEAPT, SET_BACK, SLIPPED, TOO_OLD, UNUSABLE
from slam_core.results import AidingStatus

SILENT_NS = 500_000_000
CONTRADICTED_NS = 1_000_000_000  # a source that is rejected for longer is reported

# Diagnostics of what is counted, by the reason of the count.
COUNTED: Mapping[str, Code] = {
    AT_RANGE: "gyro_clipped",
    SET_BACK: "imu_clock_set_back",
    LEAPT: "imu_clock_set_ahead",
    NO_NUMBER: "imu_implausible",
    SENT_AGAIN: "imu_repeats",
    SPIKE: "imu_spikes",
    AFTER_LEAP: "imu_shaken",
    NO_BEAM: "no_beam_in_range",
    REPEATED: "scans_repeated",
    TOO_LATE: "scans_too_late",
    SLIPPED: "wheels_slip",
}
OF_SOURCE: Mapping[str, Code] = {UNUSABLE: "aid_implausible", TOO_OLD: "aid_too_late"}


class Monitor:
    """Compares the counters of the filter and of its sources with those after the scan before."""

    def __init__(self) -> None:
        self._recent: Recent[Diagnostic] = Recent()
        self._counted: dict[tuple[str, str], int] = {}
        self._totals: tuple[int, ...] = ()
        self._level_ride = LevelRide()

    def update(
        self, estimator: NavigationFilter, aiding: Iterable[AidingStatus], skipped: Counter[str], time_ns: int
    ) -> None:
        """The filter and the sources as they are after a scan; skipped: scans without a result, by reason."""
        found = _states(estimator, time_ns)
        if self._level_ride.unknown_height(estimator, aiding, time_ns):
            found.append(Diagnostic("height_unknown"))
        totals = *estimator.counts.values(), *skipped.values()
        if totals != self._totals:  # rare
            self._totals = totals
            found += self._increased(estimator.counts) + self._increased(skipped)
        for status in aiding:
            if status.streak or status.frozen:
                found += _of_source(status)
            if status.dropped:
                found += self._increased(status.dropped, status.source)
        if found:
            self._recent.add(found, time_ns)

    def diagnostics(self, time_ns: int) -> tuple[Diagnostic, ...]:
        """What is wrong at the time of the last scan, or was a moment before."""
        return self._recent.at(time_ns)

    def _increased(self, counts: Mapping[str, int], source: str = "") -> list[Diagnostic]:
        """Diagnostics of the counters that have grown since the last scan."""
        codes, found = OF_SOURCE if source else COUNTED, []
        for reason, count in counts.items():
            if reason in codes and count > self._counted.get((source, reason), 0):
                self._counted[source, reason] = count
                found.append(Diagnostic(codes[reason], source))
        return found


def _states(estimator: NavigationFilter, time_ns: int) -> list[Diagnostic]:
    if not estimator.ready:
        return [Diagnostic("no_gravity")] if estimator.weightless else []
    return [Diagnostic("imu_silent")] if time_ns - estimator.sample_ns > SILENT_NS else []


def _of_source(status: AidingStatus) -> list[Diagnostic]:
    if status.frozen:
        return [Diagnostic("aid_frozen", status.source)]
    if status.streak >= LEAST_STREAK and status.stamp_ns - status.streak_ns >= CONTRADICTED_NS:
        return [Diagnostic("aid_contradicts", status.source)]
    return []
