"""What is wrong with the sources of the motion: a sentence each, while it lasts and a little longer."""

from collections import Counter
from collections.abc import Iterable, Mapping

from slam_core.navigation.aiding.gates import LEAST_STREAK
from slam_core.navigation.filter import LEAPT, SET_BACK, TOO_OLD, UNUSABLE, NavigationFilter
from slam_core.navigation.imu_check import AT_RANGE, NO_NUMBER
from slam_core.results import AidingStatus

SILENT_NS = 500_000_000
CONTRADICTED_NS = 1_000_000_000  # a source that is rejected for longer is named
TOLD_FOR_NS = 5_000_000_000  # what is over is shown for so long
NO_BEAM = "scan without a beam in range"
NO_ATTITUDE = "scan before the attitude was known"

WEIGHTLESS = (
    "the accelerometers show no gravity: of the IMU only the yaw rate is used; its driver must publish the"
    " specific force in m/s², gravity included"
)
SILENT = "no inertial data comes: the motion is predicted from the matches alone; check the IMU"
# Of what is counted, by its reason; of a source, with its name.
COUNTED = {
    AT_RANGE: "the gyro was clipped: turn slower, or set a wider range in the IMU and in navigation.gyro_range",
    SET_BACK: "the clock of the IMU was set back: the filter went on from where it was; restart if that is wrong",
    LEAPT: "the clock of the IMU leapt ahead: the filter went on from where it was; restart if that is wrong",
    NO_NUMBER: "the IMU gives values that are no plausible numbers: they are left out; check its driver",
    NO_BEAM: "scans come without a beam in range: the pose is carried on without them; check the laser",
}
OF_SOURCE = {
    UNUSABLE: "{} gives values that are no plausible numbers: they are left out; check that sensor",
    TOO_OLD: "{} comes too late to be used: check the link and the clocks, or raise navigation.history",
}


class Recent:
    """Sentences with the time when each was true last."""

    def __init__(self) -> None:
        self._told: dict[str, int] = {}

    def tell(self, sentences: Iterable[str], time_ns: int) -> None:
        """They are true at this moment."""
        self._told.update(dict.fromkeys(sentences, time_ns))

    def at(self, time_ns: int) -> tuple[str, ...]:
        """What is or was true a little while ago; by any clock, as that may have been set."""
        return tuple(text for text, told_ns in self._told.items() if abs(time_ns - told_ns) < TOLD_FOR_NS)


class Watch:
    """Looks at a filter after every scan; one for each run."""

    def __init__(self) -> None:
        self._recent = Recent()
        self._counted: dict[tuple[str, str], int] = {}
        self._totals: tuple[int, ...] = ()

    def look(
        self,
        estimator: NavigationFilter,
        aiding: Iterable[AidingStatus],
        skipped: Counter[str],
        time_ns: int,
    ) -> None:
        """The filter and the sources as they are after a scan; skipped: scans without a result, by reason."""
        sentences = _states(estimator, time_ns)
        totals = *estimator.counts.values(), *skipped.values()
        if totals != self._totals:  # hardly ever
            self._totals = totals
            sentences += self._news(estimator.counts) + self._news(skipped)
        for status in aiding:
            if status.streak or status.frozen:
                sentences += _of_source(status)
            if status.dropped:
                sentences += self._news(status.dropped, status.source)
        if sentences:
            self._recent.tell(sentences, time_ns)

    def warnings(self, time_ns: int) -> tuple[str, ...]:
        """What is wrong at the time of the last scan, or was a moment before."""
        return self._recent.at(time_ns)

    def _news(self, counts: Mapping[str, int], source: str = "") -> list[str]:
        """The sentences on what has been counted since the last time."""
        texts, news = OF_SOURCE if source else COUNTED, []
        for reason, count in counts.items():
            if reason in texts and count > self._counted.get((source, reason), 0):
                self._counted[source, reason] = count
                news.append(texts[reason].format(source))
        return news


def _states(estimator: NavigationFilter, time_ns: int) -> list[str]:
    if not estimator.ready:
        return [WEIGHTLESS] if estimator.weightless else []
    return [SILENT] if time_ns - estimator.sample_ns > SILENT_NS else []


def _of_source(status: AidingStatus) -> list[str]:
    if status.frozen:
        return [f"{status.source} repeats one value while the robot moves and is not used: check that sensor"]
    if status.streak >= LEAST_STREAK and status.stamp_ns - status.streak_ns >= CONTRADICTED_NS:
        return [f"{status.source} contradicts the other sensors and is not used: check its frame, units and noise"]
    return []
