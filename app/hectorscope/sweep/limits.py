"""How long a run of a sweep may take, and how much memory."""

import os
from dataclasses import dataclass
from pathlib import Path

from slam_core.errors import SlamError

HOUR_S = 3600.0


class LimitError(SlamError):
    """A limit that cannot be kept."""


@dataclass(frozen=True, slots=True)
class Limits:
    """time_s: of a run, seconds; memory_mb: resident memory of its process, MiB. 0: no limit."""

    time_s: float = HOUR_S
    memory_mb: float = 0.0

    def check(self) -> None:
        """LimitError for a negative one, or one that this system cannot keep."""
        for name, value in (("--time-limit", self.time_s), ("--memory-limit", self.memory_mb)):
            if not value >= 0:
                raise LimitError(f"{name} is {value:g}: give a number above 0, or 0 for no limit")
        if self.memory_mb and not resident_mb(os.getpid()):
            raise LimitError("--memory-limit needs /proc, which this system has not: leave it out")


def resident_mb(process: int) -> float:
    """Resident memory of a process in MiB; 0 where the system does not tell."""
    try:
        pages = int(Path(f"/proc/{process}/statm").read_text(encoding="ascii").split()[1])
    except (OSError, ValueError, IndexError):
        return 0.0
    return pages * os.sysconf("SC_PAGE_SIZE") / 2**20
