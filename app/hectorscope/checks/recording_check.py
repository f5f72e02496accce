"""What is wrong with a recording as such: its topics, clocks, frames and beams. Each finding has a remedy.

No standard gives these thresholds. A gap counts where a robot at 1 m/s has left the cell of the coarsest level, in
which a match converges; jitter where a turn of 1 rad/s moves the beams by their spacing, a third of a degree; a
drift where it is several times that of two quartz clocks.
"""

import math
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from statistics import median

from hectorscope.checks.contradictions import LONGEST_LAG
from hectorscope.checks.laser_returns import LaserReturns
from hectorscope.checks.topic_times import FEWEST, Gap, Times, TopicTimes
from hectorscope.inputs import Examinable, Finding, SourceOptions, Stamped

GAP_S, GAP_PERIODS = 0.2, 4.0  # 0.2 m at 1 m/s, and three messages in a row are missing
JITTER_S = 0.005  # 0.3 degrees at 1 rad/s
AHEAD_S = 0.01  # clocks that are kept together over a local network differ by less
APART_S = 0.06  # as in `findings`: a delay that shows in the map
STEP_S = 0.02
DRIFT, DRIFTED_S = 5e-4, 0.02  # two quartz clocks differ by 1e-4 at most
OUTSIDE_SHARE = 0.01
VALID_SHARE = 0.5
PLACED_BY = {
    "scan": ", or give --laser-pose X Y Z ROLL PITCH YAW",
    "imu": ", or give --imu-rotation ROLL PITCH YAW",
}
GAPS_SHOWN = 3  # of one topic, the longest


@dataclass
class RecordingCheck:
    """Takes every message of a recording that has a use, in the order of recording."""

    times: defaultdict[str, Times] = field(default_factory=lambda: defaultdict(Times))
    returns: defaultdict[str, LaserReturns] = field(default_factory=lambda: defaultdict(LaserReturns))

    def take(self, messages: Iterable[Stamped]) -> "RecordingCheck":
        """All of these."""
        for each in messages:
            times = self.times[each.topic]
            times.add(each.log_ns, each.stamp_ns, each.lasts_ns)
            if each.frame:
                times.frames.add(each.frame)
            if each.ranges is not None:
                self.returns[each.topic].add(each.log_ns, each.ranges, each.limits)
        return self

    def turns_compare(self, source: Examinable, options: SourceOptions) -> bool:
        """Whether scans and inertial data, with the delays that are stated, may be compared by their turns."""
        used = source.parts
        scan, imu = (self.times.get(used.get(role, "")) for role in ("scan", "imu"))
        if scan is None or imu is None or used["imu"] in source.put_right:
            return True
        stated_s = (options.imu_delay or 0.0) - (options.scan_delay or 0.0)
        return abs(_apart_s(scan.result, imu.result) - stated_s) <= LONGEST_LAG

    def findings_of(self, source: Examinable) -> list[Finding]:
        """Of a recording whose items were read."""
        return self.findings(source.parts, source.unplaced, source.put_right, source.clock_offset_ns)

    def findings(
        self,
        used: Mapping[str, str],
        unplaced: Sequence[str] = (),
        put_right: Sequence[str] = (),
        shift_ns: int = 0,
    ) -> list[Finding]:
        """Of the topics in use (role -> topic). unplaced: frames that tf does not place.

        put_right: topics whose clocks are put beside that of the scans. shift_ns: from the recorder's clock to
        that of the run.
        """
        topics = {role: topic for role, topic in used.items() if topic in self.times}
        measured = {topic: self.times[topic].result for topic in dict.fromkeys(topics.values())}
        found = [
            *_clocks(measured, topics, put_right),
            *(one for role, topic in topics.items() for one in _rhythm(role, topic, measured[topic])),
            *(
                one
                for role, topic in topics.items()
                for one in _frames(role, topic, self.times[topic].frames, unplaced)
            ),
            *(one for topic in measured if topic in self.returns for one in _beams(topic, self.returns[topic])),
        ]
        unique = {one.fact: one for one in found}  # a topic may play two roles
        return [one.moved(shift_ns) for one in unique.values()]


def _rhythm(role: str, topic: str, times: TopicTimes) -> Iterator[Finding]:
    """Gaps of the sensors that a run cannot do without, jitter, and order."""
    if role in ("scan", "imu", "odometry", "attitude") and len(times.log_ns) >= FEWEST:
        gaps = times.gaps(max(GAP_S, GAP_PERIODS * times.period_s))
        for gap in sorted(sorted(gaps, key=lambda gap: -gap.seconds)[:GAPS_SHOWN]):
            more = f", the longest of {len(gaps)}" if len(gaps) > GAPS_SHOWN else ""
            yield _gap(topic, gap, times.period_s, more)
    if role in ("scan", "imu") and times.jitter_s > JITTER_S:
        yield Finding(
            f"the stamps of {topic} jitter by {1e3 * times.jitter_s:.0f} ms around {1e3 * times.period_s:.1f} ms",
            remedy="have the driver stamp by the clock of the device, not by the time of arrival",
        )
    if len(late := times.backwards):
        yield Finding(
            f"{len(late)} messages of {topic} are stamped before an earlier one",
            remedy="they are skipped; look for two publishers of that topic, or a clock that is set while it runs",
            time_ns=int(late[0]),
        )


def _gap(topic: str, gap: Gap, period_s: float, more: str) -> Finding:
    """Messages that are missing, or that came together at its end."""
    due = round(gap.seconds / period_s) if period_s > 0.0 else 1
    if 1 < gap.together >= due / 2:
        return Finding(
            f"{topic} stops for {gap.seconds:.2f} s, and {gap.together} messages come together then{more}",
            remedy="they are taken at a steady rate; have the driver stamp by the clock of the device",
            time_ns=gap.log_ns,
        )
    return Finding(
        f"{topic} has a gap of {gap.seconds:.2f} s: about {due - gap.together} messages are missing{more}",
        remedy="the map may jump there; look at disk, network and driver when it is recorded again",
        time_ns=gap.log_ns,
    )


def _clocks(
    measured: Mapping[str, TopicTimes], topics: Mapping[str, str], put_right: Sequence[str]
) -> Iterator[Finding]:
    """How the stamps of each topic run against the recorder's clock, and against those of the scans."""
    clocks = {topic: times for topic, times in measured.items() if len(times.stamped) >= 2 * FEWEST}
    common = median(times.drift for times in clocks.values()) if len(clocks) > 2 else 0.0
    for topic, times in clocks.items():
        span_s = float(times.stamped[-1, 0] - times.stamped[0, 0]) * 1e-9
        drift = times.drift - common
        if times.step and _is_set(times):
            yield _step(topic, *times.step)
        elif abs(drift) > DRIFT and abs(drift) * span_s > DRIFTED_S:
            yield _drift(topic, drift, span_s)
        elif times.delay_s < -AHEAD_S:
            yield _ahead(topic, times)
    yield from _apart(clocks, topics, put_right)


def _ahead(topic: str, times: TopicTimes) -> Finding:
    if times.shortest_s < -AHEAD_S:
        return Finding(
            f"the stamps of {topic} are up to {-times.shortest_s:.3g} s ahead of the recorder's clock",
            remedy="set the clocks of both computers by NTP or PTP; for one topic alone its stamps are wrong",
        )
    return Finding(
        f"{topic} is recorded up to {-times.delay_s:.3g} s before its last beam can have been measured",
        remedy=f"if its stamps are those of the end of the sweep, give --scan-delay {times.lasts_s:.3g}; else its"
        " time_increment is too large",
    )


def _step(topic: str, log_ns: int, change_s: float) -> Finding:
    way = "back" if change_s > 0.0 else "ahead"
    return Finding(
        f"the clock of {topic} is set {way} by {abs(change_s):.3g} s while it runs",
        remedy="keep that clock by NTP or PTP that slews, or let the computer that records stamp the messages",
        time_ns=log_ns,
    )


def _drift(topic: str, drift: float, span_s: float) -> Finding:
    way = "slow" if drift > 0.0 else "fast"
    return Finding(
        f"the clock of {topic} runs {100.0 * abs(drift):.2g} % too {way}: by {abs(drift) * span_s:.2g} s in"
        f" {span_s:.0f} s",
        remedy="a fixed delay repairs its mean alone: keep that clock by PTP, or let the recording computer stamp",
    )


def _apart(
    clocks: Mapping[str, TopicTimes], topics: Mapping[str, str], put_right: Sequence[str]
) -> Iterator[Finding]:
    """Inertial data and scans that come by different clocks, or late by a fixed time."""
    apart = _apart_s(clocks.get(topics.get("scan", "")), clocks.get(topics.get("imu", "")))
    if abs(apart) <= APART_S:
        return
    later, sooner, option = ("scan", "imu", "imu-delay") if apart > 0.0 else ("imu", "scan", "scan-delay")
    flag = f"--{option} {abs(apart):.2f}"
    is_put_right = topics["imu"] in put_right
    if is_put_right or abs(apart) > LONGEST_LAG:
        repair = (
            "it is put right by when messages came" if is_put_right else f"give {flag}, and look at their turns"
        )
        yield Finding(
            f"the clock of {topics[later]} is {abs(apart):.2f} s behind that of {topics[sooner]}",
            remedy=f"{repair}; keep both clocks by NTP or PTP",
        )
        return
    yield Finding(
        f"{topics[later]} takes {abs(apart):.2f} s longer from its stamp to the recorder than {topics[sooner]}",
        remedy=f"if it is not the way of the data that takes so long, {flag} repairs it: compare with the delay"
        " that the turns show",
    )


def _apart_s(scan: TopicTimes | None, imu: TopicTimes | None) -> float:
    """Seconds that scans take longer to the recorder than inertial data; 0 where that is not known."""
    if scan is None or imu is None or _is_set(scan) or _is_set(imu) or abs(scan.drift - imu.drift) > DRIFT:
        return 0.0
    apart = scan.delay_s - imu.delay_s
    return apart if math.isfinite(apart) else 0.0


def _is_set(times: TopicTimes) -> bool:
    """Whether the clock is set while it runs."""
    return times.step is not None and abs(times.step[1]) > STEP_S


def _frames(role: str, topic: str, seen: set[str], unplaced: Sequence[str]) -> Iterator[Finding]:
    if len(seen) > 1:
        yield Finding(
            f"{topic} has messages of {len(seen)} frames ({', '.join(sorted(seen)[:4])})",
            remedy=f"one topic is for one device: give each its own; --{role.replace('_', '-')}-topic chooses one",
        )
    for frame in sorted(seen.intersection(unplaced)):
        yield Finding(
            f"tf does not place {frame}, the frame of {topic}: it is taken to be at the base",
            remedy=f"record /tf_static too{PLACED_BY.get(role, '')}",
        )


def _beams(topic: str, returns: LaserReturns) -> Iterator[Finding]:
    if returns.millimetres:
        yield Finding(
            f"the ranges of {topic} reach {returns.farthest:.0f} where metres are due, so they are in millimetres",
            remedy="divide them by 1000 in the driver; as they are, no beam can be used",
            time_ns=returns.outside_since_ns,
        )
    elif returns.outside_share > OUTSIDE_SHARE:
        yield Finding(
            f"{100.0 * returns.outside_share:.0f} % of the beams of {topic} have ranges out of the limits of the"
            f" message, up to {returns.farthest:.3g} m",
            remedy="they are not used: put right range_min and range_max in the driver",
            time_ns=returns.outside_since_ns,
        )
    for stretch in returns.covered[:GAPS_SHOWN]:
        yield Finding(
            f"next to no beam of {topic} returns for {stretch.seconds:.1f} s",
            remedy="look for something in front of the laser, or dust and glass around it",
            time_ns=stretch.log_ns,
        )
    if not math.isnan(returns.valid_share) and returns.valid_share < VALID_SHARE and not returns.millimetres:
        yield Finding(
            f"{100.0 * (1.0 - returns.valid_share):.0f} % of the beams of {topic} return nothing of use",
            remedy="outdoors and in halls that is normal; else look for something in front of the laser",
        )


def examine(source: Examinable) -> list[Finding]:
    """Read a whole recording for what is wrong with it; times are those of the run."""
    for _ in source.items():
        pass  # tf is complete behind them
    check = RecordingCheck().take(source.stamped())
    return check.findings_of(source)
