"""Files that a run leaves. One file a format; each has `EXPORTER`, an `Exporter`."""

import sys
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from app.registry import members


@dataclass(frozen=True, slots=True)
class Exporter:
    """`write(run, folder)` leaves its files in `folder` (under a temporary name, then renamed)."""

    files: tuple[str, ...]
    write: Callable[[Any, Path], None]


def exporters() -> list[Exporter]:
    """Every exporter of this folder."""
    return members(sys.modules[__name__], "EXPORTER")
