"""The corners of a line through a growing path: an hour of poses is more than a browser can draw."""

from math import asin, atan2, hypot, inf, pi

from slam_core.measurements import Float64s

Point = tuple[float, float, float]


class Corners:
    """The rows (n, 3) of a path, in metres, between which a line runs straight, as the path grows.

    Rows closer than `spacing` to the last one that counted are passed over. The line passes those that count
    within `tolerance`; 0: each of them is a corner.
    """

    def __init__(self, spacing: float, tolerance: float) -> None:
        self._spacing, self._tolerance = spacing, tolerance
        self.rows: list[int] = []
        self._seen = 0  # rows that were looked at
        self._end = 0  # the last row that counted
        self._sleeve = _Sleeve((0.0, 0.0, 0.0), tolerance)

    @property
    def points(self) -> list[int]:
        """The rows that the line goes through: the corners, and where it ends."""
        return self.rows if not self.rows or self._end == self.rows[-1] else [*self.rows, self._end]

    def follow(self, positions: Float64s, same: int) -> None:
        """The path as it is now, of which so many rows are as before. Plain numbers: an hour has 144,000."""
        if same < self._seen:
            self._cut(same)
        if not self.rows and len(positions):
            self.rows, self._seen, self._end = [0], 1, 0
        if not self.rows:
            return
        self._sleeve.begin = tuple(positions[self.rows[-1]].tolist())
        last = tuple(positions[self._end].tolist())
        for row, now in enumerate(positions[self._seen :].tolist(), self._seen):
            if max(abs(now[0] - last[0]), abs(now[1] - last[1]), abs(now[2] - last[2])) >= self._spacing:
                self._count(row, tuple(now), last)
                last = tuple(now)
        self._seen = len(positions)

    def _count(self, row: int, now: Point, last: Point) -> None:
        straight = self._tolerance > 0.0 and self._sleeve.holds(now)
        if not straight and self._end != self.rows[-1]:
            self.rows.append(self._end)
            self._sleeve = _Sleeve(last, self._tolerance)
            self._sleeve.holds(now)
        self._end = row

    def _cut(self, count: int) -> None:
        """Forget the rows from this one on, and look again at those behind the last corner that is left."""
        while self.rows and self.rows[-1] >= count:
            self.rows.pop()
        self._end = self.rows[-1] if self.rows else 0
        self._seen = self._end + 1 if self.rows else 0
        self._sleeve = _Sleeve((0.0, 0.0, 0.0), self._tolerance)


class _Sleeve:
    """The directions of all lines from a corner that pass what lies between closely (Zhao and Saalfeld, 1997)."""

    def __init__(self, begin: Point, tolerance: float) -> None:
        self.begin, self._tolerance = begin, tolerance
        self._ahead: float | None = None  # the first direction; others count from it
        self._low, self._high = -pi, pi
        self._down, self._up = -inf, inf  # slopes
        self._reach = 0.0

    def holds(self, point: Point) -> bool:
        """Whether a line to this point is one of them; if so, it counts from now on, else no other is held."""
        near = self._tolerance
        (x0, y0, z0), (x, y, z) = self.begin, point
        reach, rise = hypot(x - x0, y - y0), z - z0
        is_back = reach < self._reach - near
        if reach <= near:
            if is_back or abs(rise) > near:
                self._reach = inf
            return self._reach < inf
        direction, slope, width = atan2(y - y0, x - x0), rise / reach, asin(near / reach)
        if self._ahead is None:
            self._ahead = direction
        aside = (direction - self._ahead + pi) % (2 * pi) - pi
        if is_back or not (self._low <= aside <= self._high and self._down <= slope <= self._up):
            self._reach = inf
            return False
        self._low, self._high = max(self._low, aside - width), min(self._high, aside + width)
        self._down, self._up = max(self._down, slope - near / reach), min(self._up, slope + near / reach)
        self._reach = max(self._reach, reach)
        return True
