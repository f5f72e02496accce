"""Messages by any clocks: none is lost, none overtakes another, and they wait for a window of time at most."""

from hypothesis import given
from hypothesis import strategies as st

from hectorscope.inputs import SourceOptions
from hectorscope.ros.arrivals import Arrival, Arrivals
from hectorscope.ros.clocks import CALM_NS, WINDOW_NS
from hectorscope.ros.repairs import Repairs
from hectorscope.ros.roles import IMU, Roles

TIMES_NS = st.integers(-(2**31) * 10**9, 2**32 * 10**9)
STEPS_NS = st.sampled_from([0, 10_000_000, 100_000_000, 10**9, -(10**9), CALM_NS])
MESSAGES = st.lists(st.tuples(st.sampled_from(["/scan", "/imu", "/more"]), TIMES_NS, STEPS_NS), max_size=100)


@given(messages=MESSAGES, jumps=st.booleans())
def test_every_message_passes_once_in_its_order(messages: list[tuple[str, int, int]], *, jumps: bool) -> None:
    """Whatever their stamps are, and however time passes for the recorder."""
    arrivals = Arrivals(Roles(scan="/scan", imu="/imu"), Repairs(SourceOptions()), None)
    passed: list[Arrival] = []
    pushed: list[Arrival] = []
    receive_ns = 10**18
    for topic, stamp_ns, step_ns in messages:
        receive_ns += step_ns if jumps else abs(step_ns)
        pushed.append(Arrival(topic, IMU, None, receive_ns, stamp_ns))
        passed += arrivals.push(pushed[-1])
        if not jumps and len(passed) < len(pushed):
            assert receive_ns - pushed[len(passed)].receive_ns < 2 * (WINDOW_NS + CALM_NS)  # silence, too
        assert all(isinstance(arrivals.stamp_ns(each), int) for each in pushed)
    assert [*passed, *arrivals.flush()] == pushed
