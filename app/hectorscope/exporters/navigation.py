"""navigation.csv: the state a hundred times a second: `t x y z qx qy qz qw vx vy vz`."""

from pathlib import Path

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.exporters._files import exact_seconds, lines_of
from hectorscope.run.results import Run

HEAD = "t,x,y,z,qx,qy,qz,qw,vx,vy,vz\n"


def _write(run: Run, folder: Path) -> None:
    def line(row: list[float]) -> str:
        seconds, x, y, z, qw, qx, qy, qz, *velocity = row
        values = ",".join(f"{value:.6f}" for value in (x, y, z, qx, qy, qz, qw, *velocity))
        return f"{exact_seconds(run.start_ns, seconds)},{values}\n"

    write_whole(folder / "navigation.csv", HEAD.encode(), lines_of(run.navigation, line))


EXPORTER = Exporter("navigation", ("navigation.csv",), _write, default=True)
