"""Where sensors sit on the base: transforms from the tf tree, or a stated assumption where there are none."""

from hectorscope.inputs import SourceError
from hectorscope.ros.tf import TfTree
from slam_core.measurements import Transform

BASE_NAMES = ("base_link", "base_footprint")
# Frames that stand in the world (REP-105): they are never the robot's base.
WORLD_NAMES = ("map", "odom", "world", "earth")
# A message waits this long for the chain of transforms that places its sensor to appear at all.
PATIENCE_NS = 1_000_000_000
# It waits this long for a moving mount (a tilting laser) to be known up to the time of the message.
MOVING_PATIENCE_NS = 300_000_000


class Mounts:
    """T_base_sensor by frame. base: the frame of the base, None until a sensor has been placed on it.

    notes: for each frame, what was found or assumed.
    """

    def __init__(self, tree: TfTree, base_frame: str | None) -> None:
        self.base = base_frame.strip("/") if base_frame else None
        self.notes: dict[str, str] = {}
        self._tree = tree
        self._asked_for = base_frame is not None
        self._given_up: set[str] = set()
        self._fixed: dict[str, tuple[int, Transform]] = {}

    def find(self, frame: str, time_ns: int, waited_ns: float) -> Transform | None:
        """T_base_frame at time_ns; None: wait for more of tf. waited_ns: how long the message waited already.

        SourceError when the base frame that a person asked for does not exist.
        """
        cached = self._fixed.get(frame)
        if cached is not None and cached[0] == self._tree.revision:
            return cached[1]
        patient = waited_ns < PATIENCE_NS and frame not in self._given_up
        base = self._search_base(frame, patient=patient) if self.base is None else self.base
        if base is None:
            return None
        T = self._tree.lookup(base, frame, time_ns)
        if T is None:
            return None if patient else self._assume(base, frame)
        until_ns = self._tree.known_until_ns(base, frame)
        if until_ns is None:
            self._fixed[frame] = (self._tree.revision, T)
        elif until_ns < time_ns and waited_ns < MOVING_PATIENCE_NS:
            return None
        self.base = base
        self._note(base, frame, moving=until_ns is not None)
        return T

    @property
    def unplaced(self) -> tuple[str, ...]:
        """The frames that were taken to be at the base, as tf does not place them."""
        known = self._tree.frames()
        return tuple(frame for frame in self._fixed if frame in self._given_up or frame not in known)

    def guess_base(self) -> str | None:
        """The base, even before a sensor has been placed on it."""
        return self.base or _named(self._tree.frames())

    def _search_base(self, frame: str, *, patient: bool) -> str | None:
        """base_link or base_footprint in the tree of `frame`; at last any, or the top of what is fixed to it."""
        known = self._tree.frames()
        root = self._tree.climb(frame)[-1]
        named = _named([other for other in known if self._tree.climb(other)[-1] == root])
        if named or patient:
            return named
        if frame not in known:
            return _named(known) or frame
        above = self._tree.climb(frame, static=True)
        return next((f for f in reversed(above) if f.split("/")[-1] not in WORLD_NAMES), frame)

    def _assume(self, base: str, frame: str) -> Transform:
        known = self._tree.frames()
        if self._asked_for and base not in known:
            raise SourceError(f"base frame {base!r} is not in tf: it knows {', '.join(known) or 'no frames'}")
        self.base = base
        self._given_up.add(frame)
        self._fixed[frame] = (self._tree.revision, Transform())
        self._note(base, frame, moving=False)
        return Transform()

    def _note(self, base: str, frame: str, *, moving: bool) -> None:
        if frame in self._given_up or frame not in self._tree.frames():
            sensor = frame or "a sensor without a frame"
            self.notes[frame] = f"no tf for {sensor}: taken to be at the base (--laser-pose places a laser)"
        elif frame == base:
            self.notes[frame] = f"{frame} is the base"
        else:
            self.notes[frame] = f"tf places {frame} on {base}" + (", moving" if moving else "")


def _named(frames: list[str]) -> str | None:
    candidates = (frame for name in BASE_NAMES for frame in frames if frame.split("/")[-1] == name)
    return next(candidates, None)
