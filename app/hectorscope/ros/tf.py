"""The tree of coordinate frames (REP-105) as in /tf and /tf_static."""

from bisect import bisect_right
from dataclasses import dataclass, field

from hectorscope.ros.stamps import Stamps
from slam_core import geometry
from slam_core.measurements import Transform

# Moving transforms are remembered this long: more than any scan is ever late.
HISTORY_NS = 20_000_000_000


@dataclass(slots=True)
class _Edge:
    """T_parent_child over time. A dynamic edge counts as fixed until it is seen to move."""

    parent: str
    static: bool
    moving: bool = False
    clock: Stamps = field(default_factory=lambda: Stamps(repeats=False))
    stamps: list[int] = field(default_factory=list)
    values: list[Transform] = field(default_factory=list)

    def add(self, stamp_ns: int, T: Transform) -> bool:
        """Take in one sample; true when the edge changed its kind (a fixed one is elsewhere now)."""
        if self.static:
            changed = not self.values or not _same(self.values[0], T)
            self.stamps, self.values = [stamp_ns], [T]
            return changed
        begins_to_move = bool(self.values) and not self.moving and not _same(self.values[-1], T)
        self.moving |= begins_to_move
        if self.stamps and stamp_ns < self.stamps[-1]:  # by a clock that was set back
            self.stamps, self.values = [], []
        if len(self.values) > 1 and _same(self.values[-1], T) and _same(self.values[-2], T):
            self.stamps[-1] = stamp_ns  # a plateau needs its two ends only
            return False
        self.stamps.append(stamp_ns)
        self.values.append(T)
        self._forget()
        return begins_to_move or len(self.values) == 1

    def at(self, time_ns: int) -> Transform:
        """The transform at a time, interpolated; held beyond the ends of what is known."""
        after = bisect_right(self.stamps, time_ns)
        if after in (0, len(self.stamps)):
            return self.values[min(after, len(self.values) - 1)]
        t0, t1 = self.stamps[after - 1], self.stamps[after]
        a, b = self.values[after - 1], self.values[after]
        s = (time_ns - t0) / (t1 - t0)
        translation = (1.0 - s) * a.translation + s * b.translation
        return Transform(translation, geometry.slerp(a.rotation, b.rotation, s))

    def _forget(self) -> None:
        if self.stamps[0] < self.stamps[-1] - 2 * HISTORY_NS:
            old = bisect_right(self.stamps, self.stamps[-1] - HISTORY_NS) - 1
            del self.stamps[:old], self.values[:old]


class TfTree:
    """Frames and the transforms between them. `revision` grows when a fixed relation may have changed."""

    def __init__(self) -> None:
        self.revision = 0
        self._edges: dict[str, _Edge] = {}

    def add(
        self, parent: str, child: str, stamp_ns: int, T: Transform, *, static: bool, receive_ns: int = 0
    ) -> str:
        """One T_parent_child at a time. Why it is ignored, if it is no news (see `Stamps`); else empty."""
        edge = self._edges.get(child)
        if edge is None or edge.parent != parent or edge.static != static:
            edge = self._edges[child] = _Edge(parent, static)
        fault = "" if static else edge.clock.fault(stamp_ns, receive_ns)
        if not fault and edge.add(stamp_ns, T):
            self.revision += 1
        return fault

    def frames(self) -> list[str]:
        """Every frame heard of, sorted."""
        return sorted({*self._edges, *(edge.parent for edge in self._edges.values())})

    def climb(self, frame: str, *, static: bool = False) -> list[str]:
        """`frame` and its ancestors up to the root; with `static`, only as far as /tf_static leads."""
        path = [frame]
        while (edge := self._edges.get(path[-1])) and edge.parent not in path:
            if static and not edge.static:
                break
            path.append(edge.parent)
        return path

    def lookup(self, parent: str, child: str, time_ns: int) -> Transform | None:
        """T_parent_child at a time; None when no chain of transforms joins the frames."""
        legs = self._legs(parent, child)
        if legs is None:
            return None
        return geometry.chain(geometry.invert(self._descend(legs[0], time_ns)), self._descend(legs[1], time_ns))

    def known_until_ns(self, parent: str, child: str) -> int | None:
        """Up to when the chain is known: None while one of its edges has not moved, so that it is fixed."""
        edges = [self._edges[frame] for leg in self._legs(parent, child) or () for frame in leg]
        return min((edge.stamps[-1] for edge in edges if edge.moving), default=None)

    def carrier(self, parent: str, child: str) -> str | None:
        """The frame below the dynamic edge nearest to `child`: its updates are those of the chain."""
        legs = self._legs(parent, child)
        frames = [*legs[1], *reversed(legs[0])] if legs else []
        return next((frame for frame in frames if not self._edges[frame].static), None)

    def _legs(self, parent: str, child: str) -> tuple[list[str], list[str]] | None:
        """The frames below the nearest common ancestor, on the side of parent and on the side of child."""
        up, down = self.climb(parent), self.climb(child)
        meeting = next((frame for frame in down if frame in up), None)
        if meeting is None:
            return None
        return up[: up.index(meeting)], down[: down.index(meeting)]

    def _descend(self, leg: list[str], time_ns: int) -> Transform:
        T = Transform()
        for frame in reversed(leg):
            T = geometry.chain(T, self._edges[frame].at(time_ns))
        return T


def _same(a: Transform, b: Transform) -> bool:
    """As lists, which for so few numbers are compared ten times faster than arrays."""
    there: list[list[float]] = [a.translation.tolist(), a.rotation.tolist()]
    return there == [b.translation.tolist(), b.rotation.tolist()]
