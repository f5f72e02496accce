"""The state a hundred times a second, predicted on to each instant from what had arrived by then."""

import numpy as np

from hectorscope.run.rows import GrowingRows, Rows
from slam_core.slam import HectorSlam

PERIOD_NS = 10_000_000
# A pause is not filled with guesses.
LONGEST_NS = 2_000_000_000
COLUMNS = 11


class ConstantRate:
    """Rows of seconds since the start, x, y, z, qw, qx, qy, qz of T_map_base, and velocity in the map."""

    def __init__(self) -> None:
        self._rows = GrowingRows(COLUMNS)
        self._next_ns: int | None = None

    @property
    def rows(self) -> Rows:
        """(n, 11), a row an instant."""
        return self._rows.view

    def follow(self, slam: HectorSlam, start_ns: int) -> None:
        """Add the instants since the last time, before something is measured that would change their past."""
        now_ns = slam.now_ns
        if now_ns is None:
            return
        if self._next_ns is None or not -LONGEST_NS <= now_ns - self._next_ns <= LONGEST_NS:
            self._next_ns = start_ns + -(-(now_ns - start_ns) // PERIOD_NS) * PERIOD_NS
        if self._next_ns > now_ns:
            return
        times = range(self._next_ns, now_ns + 1, PERIOD_NS)
        self._next_ns = times[-1] + PERIOD_NS
        rows = np.empty((len(times), COLUMNS))
        rows[:, 0] = [(time_ns - start_ns) / 1e9 for time_ns in times]
        rows[:, 1:] = slam.motion_at(times)
        self._rows.extend(rows)
