"""map.npz: every cell of every level, exactly: what --map takes to localise in or to go on with."""

from pathlib import Path

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.maps.saved_map import NAME, to_npz
from hectorscope.run.results import Run


def _write(run: Run, folder: Path) -> None:
    if run.levels:
        write_whole(folder / NAME, to_npz(run.levels))


EXPORTER = Exporter("npz", (NAME,), _write, order=0, default=True)
