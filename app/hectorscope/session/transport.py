"""What a player's buttons mean: whether the next scan may go now, later, or not before a command."""

import math
import time
from dataclasses import dataclass

from hectorscope.session.playback import Clock, Pacer, RateMeter
from hectorscope.session.snapshot import PlaybackState

SLOWEST = 0.1
NEAR = 1.5  # times the last interval between scans: so near to its target may a scan be the last of a seek
PAUSED = "scan while the stream was paused"  # the reason for which such a scan is skipped
HURRY_S = 0.25  # a seek that takes no longer shows nothing on its way: to draw it would take as long again
SILENCE_S = 1.0  # a live stream without a scan for so long is waited for


@dataclass(frozen=True, slots=True)
class Stand:
    """How far a run has come that is put aside: ended, failed, or on the way to a time."""

    ended: bool
    failure: str
    target_ns: int | None


class Transport:
    """Play, pause, one step, a seek, the end or a failure, of a recording or a live stream.

    A stream flows on while it is paused: its scans are `unwanted`. live: whether it is one. empty: whether no
    recording is open. opening: what is being opened, for the time that takes. processed_again: whether the last
    scan was so, with other settings. wanted_ns: where the next seek goes, once this one has arrived. seeks: how
    many have arrived. preparing, prepared: as in a `PlaybackStatus`. clock: seconds, monotonic.
    """

    def __init__(
        self, live: bool, autoplay: bool = True, speed: float = 1.0, clock: Clock = time.monotonic
    ) -> None:
        self.live = live
        self.empty = False
        self.opening = ""
        self.preparing = ""
        self.prepared: float | None = None
        self.failure = ""
        self.seeks = 0
        self.meter = RateMeter(clock)
        self._clock = clock
        self._pacer = Pacer(speed, clock)
        self._paused = not autoplay
        self.begin()

    def begin(self) -> None:
        """At the beginning again, playing or paused as before."""
        self.failure, self._ended, self._single = "", False, False
        self.processed_again = False
        self.target_ns: int | None = None
        self.wanted_ns: int | None = None
        self._last_ns: int | None = None
        self._passed_at = self._sought_at = self._clock()
        self._rest()

    def look_back(self) -> None:
        """Rest at an earlier time of a stream, which is then like a recording."""
        self.live, self._paused = False, True

    def go_live(self) -> None:
        """Follow the stream again."""
        self.live, self._paused = True, False
        self.begin()

    @property
    def stand(self) -> Stand:
        """What `resume` needs."""
        return Stand(self._ended, self.failure, self.target_ns)

    def resume(self, stand: Stand) -> None:
        """Where a run stood that was put aside, playing or paused as now."""
        self.begin()
        self._ended, self.failure, self.target_ns = stand.ended, stand.failure, stand.target_ns

    def play(self) -> None:
        """On from here."""
        self._paused, self._single = False, False
        self._give_up_seek()
        self._rest()

    def pause(self) -> None:
        """Nothing more."""
        self._paused, self._single = True, False
        self._give_up_seek()
        self._rest()

    def step(self) -> None:
        """One scan, then nothing more."""
        self.pause()
        self._single = not self.stopped

    def seek(self, time_ns: int) -> None:
        """As fast as it goes through every scan up to this time, then as before."""
        self._single, self.target_ns = False, None if self.stopped else time_ns
        self._sought_at = self._clock()

    def end(self) -> None:
        """There is no more."""
        self.seeks += self.target_ns is not None
        self._ended, self._single, self.target_ns = True, False, None

    def fail(self, reason: str) -> None:
        """It cannot go on."""
        self.failure, self._single = reason, False
        self._give_up_seek()

    @property
    def speed(self) -> float:
        """Times real time."""
        return self._pacer.speed

    @speed.setter
    def speed(self, speed: float) -> None:
        self._pacer.speed = max(SLOWEST, speed)

    @property
    def stopped(self) -> bool:
        """Ended or failed: only a new beginning helps."""
        return self._ended or bool(self.failure)

    @property
    def running(self) -> bool:
        """Playing, or on the way to another time."""
        return not self.stopped and not self.empty and (not self._paused or self.target_ns is not None)

    @property
    def hurries(self) -> bool:
        """Whether it has just set out for another time, and may be there soon."""
        return self.target_ns is not None and self._clock() - self._sought_at < HURRY_S

    @property
    def unwanted(self) -> bool:
        """Whether scans go by unprocessed."""
        return self.live and self._paused and not self._single

    def patience(self, scan_ns: int | None) -> float | None:
        """Seconds to wait (None: for ever) before going on with a scan of this time, or with other data (None)."""
        if self.stopped or self.empty:
            return None
        if scan_ns is None or self.live or self._single or self.target_ns is not None:
            return 0.0
        return None if self._paused else self._pacer.delay(scan_ns)

    def arrives(self, scan_ns: int) -> bool:
        """Whether a seek ends before this scan; if so it has ended now."""
        if self.target_ns is None or scan_ns <= self.target_ns:
            return False
        self.target_ns = None
        self.seeks += 1
        self._rest()
        return True

    def may_rest_after(self, scan_ns: int) -> bool:
        """Whether a recording may stand still after this scan: one step, or a seek whose target is near."""
        if self.live:
            return False
        if self.target_ns is None or self._last_ns is None:
            return self._single
        return scan_ns + NEAR * (scan_ns - self._last_ns) > self.target_ns

    def passed(self, scan_ns: int) -> None:
        """A scan went by; only one that was processed counts for the rates."""
        if not self.unwanted:
            self.meter.count(scan_ns)
        self._single = self.processed_again = False
        self._last_ns = scan_ns
        self._passed_at = self._clock()

    def state(self, scans: int) -> PlaybackState:
        """The one word for all this, after so many scans."""
        playing: PlaybackState = "playing" if scans and not self.preparing else "loading"
        if self.live and not self.preparing and self._clock() - self._passed_at > SILENCE_S:
            playing = "waiting"
        choices: list[tuple[bool, PlaybackState]] = [
            (bool(self.opening), "loading"),
            (bool(self.failure), "failed"),
            (self.empty, "empty"),
            (self.wanted_ns is not None, "seeking"),
            (self._ended, "ended"),
            (self.target_ns is not None, "seeking"),
            (self._paused and not self._single, "paused"),
        ]
        return next((state for holds, state in choices if holds), playing)

    def _give_up_seek(self) -> None:
        self.target_ns = self.wanted_ns = None

    def _rest(self) -> None:
        self._pacer.rest()
        self.meter.reset()


def valid_speed(speed: float) -> bool:
    """Whether a number can be a speed at all."""
    return not math.isnan(speed) and speed > 0
