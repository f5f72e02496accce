"""When messages were recorded and stamped, also where a file is damaged."""

import numpy as np
import pytest

from hectorscope.checks.topic_times import TopicTimes


def test_deliveries_are_measured_whatever_the_order_of_the_recorded_times() -> None:
    """A damaged time of the first message is in no place of its own; the fastest delivery is the one that was."""
    log_ns = 1_700_000_000_000_000_000 + 100_000_000 * np.arange(40)
    log_ns[0] += 10**18
    stamped = np.stack([log_ns, log_ns - 30_000_000, np.zeros(40, np.int64)], axis=1)
    times = TopicTimes(log_ns, stamped)
    seconds, fastest = times.delays
    assert times.delay_s == pytest.approx(0.03, abs=1e-6)
    assert (seconds >= 0.0).all()
    assert fastest == pytest.approx(0.03, abs=1e-6)
