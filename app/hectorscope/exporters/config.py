"""config.toml: every setting of the run, and what is stated of its sensors, to be given to --config again."""

from pathlib import Path

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.run.results import Run
from hectorscope.run.settings_file import to_toml


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / "config.toml", to_toml(run.settings, run.report.sensors).encode())


EXPORTER = Exporter("config", ("config.toml",), _write, default=True)
