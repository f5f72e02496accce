"""navigation.csv: the state a hundred times a second: `t x y z qx qy qz qw vx vy vz`."""

from pathlib import Path

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import exact_seconds, write_whole
from hectorscope.run.results import Run

HEAD = "t,x,y,z,qx,qy,qz,qw,vx,vy,vz\n"


def _write(run: Run, folder: Path) -> None:
    lines = [HEAD]
    for seconds, x, y, z, qw, qx, qy, qz, *velocity in run.navigation.tolist():
        values = ",".join(f"{value:.6f}" for value in (x, y, z, qx, qy, qz, qw, *velocity))
        lines.append(f"{exact_seconds(run.start_ns, seconds)},{values}\n")
    write_whole(folder / "navigation.csv", "".join(lines).encode())


EXPORTER = Exporter(("navigation.csv",), _write)
