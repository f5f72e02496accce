"""metrics.json: the figures of a run."""

import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.run.results import Run


def _write(run: Run, folder: Path) -> None:
    text = json.dumps(_told(run.metrics), indent=2, ensure_ascii=False, allow_nan=False)
    write_whole(folder / "metrics.json", f"{text}\n".encode())


def _told(figures: Any) -> Any:
    """The figures with null for those that are no numbers: JSON has no word for them."""
    if isinstance(figures, Mapping):
        return {name: _told(value) for name, value in figures.items()}
    return None if isinstance(figures, float) and not math.isfinite(figures) else figures


EXPORTER = Exporter("metrics", ("metrics.json",), _write, default=True)
