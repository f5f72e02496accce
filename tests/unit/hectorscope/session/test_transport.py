import math

import pytest

from hectorscope.session.transport import Transport

S = 1_000_000_000


class Clock:
    """A clock that moves when told."""

    now = 0.0

    def __call__(self) -> float:
        """Seconds."""
        return self.now


@pytest.fixture
def clock() -> Clock:
    return Clock()


def recording(clock: Clock, **options: float | bool) -> Transport:
    return Transport(False, clock=clock, **options)  # type: ignore[arg-type]


def test_a_paused_recording_waits_for_a_command(clock: Clock):
    """Paused: no scan for ever, other data may be read on."""
    transport = recording(clock, autoplay=False)
    assert transport.patience(S) is None
    assert transport.patience(None) == 0.0
    assert transport.state(3) == "paused"


def test_one_step_is_one_scan(clock: Clock):
    """StepScan lets exactly one scan through, then it is paused."""
    transport = recording(clock)
    transport.step()
    assert transport.patience(S) == 0.0
    transport.passed(S)
    assert transport.patience(2 * S) is None


def test_a_seek_runs_up_to_its_time_and_then_goes_on_as_before(clock: Clock):
    """Scans up to the target are due at once; the first one after it ends the seek: as before."""
    for autoplay, after in ((True, "playing"), (False, "paused")):
        transport = recording(clock, autoplay=autoplay)
        transport.seek(5 * S)
        assert transport.state(1) == "seeking"
        assert transport.patience(5 * S) == 0.0
        assert not transport.arrives(5 * S)
        assert transport.arrives(5 * S + 1)
        assert transport.state(1) == after


@pytest.mark.parametrize("button", ["play", "pause", "step"])
def test_any_button_ends_a_seek(clock: Clock, button: str):
    """The next command cancels the run up to a time, and the time that waits behind it."""
    transport = recording(clock)
    transport.seek(5 * S)
    transport.wanted_ns = 7 * S
    getattr(transport, button)()
    assert transport.target_ns is transport.wanted_ns is None


def test_a_seek_hurries_for_a_moment(clock: Clock):
    """One that takes longer shows how far it is; each that arrives is counted."""
    transport = recording(clock)
    assert not transport.hurries
    transport.seek(5 * S)
    assert transport.hurries
    clock.now += 1.0
    assert not transport.hurries
    transport.seek(6 * S)
    assert transport.hurries
    assert transport.arrives(6 * S + 1)
    assert (transport.hurries, transport.seeks) == (False, 1)
    transport.wanted_ns = 7 * S
    assert transport.state(1) == "seeking"


def test_after_the_end_only_a_new_beginning_helps(clock: Clock):
    """Ended or failed, neither a step nor a seek brings scans; begin does."""
    for stop, state in ((lambda t: t.end(), "ended"), (lambda t: t.fail("why"), "failed")):
        transport = recording(clock)
        stop(transport)
        assert transport.state(1) == state
        transport.step()
        transport.seek(S)
        assert transport.patience(S) is None
        transport.begin()
        assert transport.failure == ""


def test_a_paused_stream_lets_scans_go_by(clock: Clock):
    """A stream cannot be held: paused, its scans are unwanted, but for a single step."""
    transport = Transport(True, autoplay=False, clock=clock)
    assert transport.patience(S) == 0.0
    assert transport.unwanted
    transport.step()
    assert not transport.unwanted
    transport.passed(S)
    assert transport.unwanted


def test_a_silent_stream_is_waited_for(clock: Clock):
    """Seconds without a scan read as waiting, the next scan as playing."""
    transport = Transport(True, clock=clock)
    transport.passed(S)
    clock.now += 5
    assert transport.state(1) == "waiting"
    transport.passed(2 * S)
    assert transport.state(2) == "playing"


def test_a_stream_is_not_waited_for_before_the_program_is_ready(clock: Clock):
    """While the kernels are loaded nothing is asked of the robot yet."""
    transport = Transport(live=True, clock=clock)
    transport.preparing = "48 of 119"
    clock.now += 5.0
    assert transport.state(0) == "loading"
    transport.preparing = ""
    assert transport.state(0) == "waiting"


def test_speed_is_kept_within_its_limits(clock: Clock):
    """Slower than 0.1x is 0.1x; inf is allowed."""
    transport = recording(clock)
    transport.speed = 0.0001
    assert transport.speed == 0.1
    transport.speed = math.inf
    assert transport.patience(S) == 0.0


def test_running_is_playing_or_on_the_way(clock: Clock):
    """A pause, a single step and an end are not running; a seek is, also of a paused run."""
    transport = recording(clock)
    assert transport.running
    transport.step()
    assert not transport.running
    transport.seek(5 * S)
    assert transport.running
    transport.end()
    assert not transport.running
