"""metrics.json: the figures of a run."""

import json
from pathlib import Path

from app.exporters import Exporter, Run
from app.exporters._files import write_whole


def _write(run: Run, folder: Path) -> None:
    text = json.dumps(run.metrics, indent=2, ensure_ascii=False, allow_nan=False)
    write_whole(folder / "metrics.json", f"{text}\n".encode())


EXPORTER = Exporter(("metrics.json",), _write)
