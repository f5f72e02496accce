"""Latencies and the offset of the clocks, from stamps and arrivals."""

import random

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.sources._link_delays import BIN_S, BINS, MOST_TOPICS, RECENT, LinkDelays

NOW_NS = 1_800_000_000 * 10**9
MS = 10**6


def heard(delays_ms: dict[str, list[float]], offset_s: float, period_ms: float = 25.0) -> tuple[LinkDelays, int]:
    """Messages that needed so long, of a robot whose clock is ahead; and when the last one came."""
    link, last_ns = LinkDelays(), NOW_NS
    for topic, delays in delays_ms.items():
        for number, delay in enumerate(delays):
            sent_ns = NOW_NS + round(number * period_ms * MS)
            arrived_ns = sent_ns + round(delay * MS)
            link.note(topic, sent_ns + round(offset_s * 1e9), arrived_ns)
            last_ns = max(last_ns, arrived_ns)
    return link, last_ns


@given(st.floats(-1e7, 1e7), st.floats(1.0, 50.0), st.integers(0, 1000))
def test_offset_and_latencies_are_found(offset_s: float, fastest_ms: float, seed: int) -> None:
    """By any offset of the clocks, when the fastest message needed half of the round trip."""
    noise = random.Random(seed)
    fast = [fastest_ms + noise.uniform(0.0, 5.0) for _ in range(RECENT)]
    fast[noise.randrange(RECENT)] = fastest_ms
    link, now_ns = heard({"/imu": fast, "/scan": [delay + 100.0 for delay in fast]}, offset_s)
    seen = link.link(now_ns, 2 * fastest_ms / 1000)
    assert seen.clock_offset_s == pytest.approx(offset_s, abs=1e-6)
    assert seen.topics["/imu"].latency_s == pytest.approx(sorted(fast)[RECENT // 2] / 1000, abs=1e-6)
    assert seen.topics["/scan"].latency_s == pytest.approx(seen.topics["/imu"].latency_s + 0.1, abs=1e-6)
    assert seen.topics["/scan"].rate_hz == pytest.approx(40.0, rel=0.02)


def test_a_clock_that_drifts_or_is_set_is_followed_within_a_minute() -> None:
    """What was fast by the clock before counts for a minute only."""
    link, now_ns = heard({"/imu": [5.0]}, offset_s=0.0)
    for number in range(2 * BINS):
        at_ns = now_ns + round((number + 1) * BIN_S * 1e9)
        link.note("/imu", at_ns - 7200 * 10**9, at_ns)  # set back by two hours
    assert link.link(at_ns, 0.0).clock_offset_s == pytest.approx(-7200.0)


def test_age_grows_while_nothing_comes() -> None:
    """And after a minute of silence nothing is said of the clock."""
    link, now_ns = heard({"/scan": [10.0, 10.0]}, offset_s=0.0)
    assert link.link(now_ns + 3 * 10**9, 0.0).topics["/scan"].age_s == pytest.approx(3.0)
    assert link.link(now_ns + 120 * 10**9, 0.0).clock_offset_s is None
    assert LinkDelays().link(now_ns, 0.5) == (None, 0.5, {})


def test_topics_are_bounded() -> None:
    """A robot cannot fill our memory with names."""
    link = LinkDelays()
    for number in range(3 * MOST_TOPICS):
        link.note(f"/{number}", NOW_NS, NOW_NS)
    assert len(link.link(NOW_NS, 0.0).topics) == MOST_TOPICS
