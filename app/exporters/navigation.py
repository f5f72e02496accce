"""navigation.csv: the state a hundred times a second: `t x y z qx qy qz qw vx vy vz`."""

from pathlib import Path

from app.exporters import Exporter, Run
from app.exporters._files import write_whole

HEAD = "t,x,y,z,qx,qy,qz,qw,vx,vy,vz\n"


def _write(run: Run, folder: Path) -> None:
    lines = [HEAD]
    for seconds, x, y, z, qw, qx, qy, qz, *velocity in run.navigation.tolist():
        stamp_ns = run.start_ns + round(seconds * 1e9)
        values = ",".join(f"{value:.6f}" for value in (x, y, z, qx, qy, qz, qw, *velocity))
        lines.append(f"{stamp_ns // 10**9}.{stamp_ns % 10**9:09d},{values}\n")
    write_whole(folder / "navigation.csv", "".join(lines).encode())


EXPORTER = Exporter(("navigation.csv",), _write)
