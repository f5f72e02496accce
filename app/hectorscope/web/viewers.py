"""Runs of a sweep on the bench: each opened one is `hectorscope view` in a process of its own."""

import json
import os
import subprocess
import sys
import tempfile
import threading
from dataclasses import asdict
from pathlib import Path

from hectorscope.checks.sensor_check import stated
from hectorscope.exporters import OutputError
from hectorscope.inputs import OptionValue
from hectorscope.run.settings_file import to_toml
from hectorscope.sweep.fetch import local
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.table import read_details
from slam_core.errors import SlamError

MOST = 3  # at a time: each holds a whole run
SAYS = "Hectorscope is at "
MAIN = "import sys; sys.path[:] = {!r}; from hectorscope.cli.main import main; sys.exit(main())"


class ViewerError(SlamError):
    """A run cannot be opened."""


class Viewers:
    """Opens runs by their keys, with their settings; the oldest is closed when there are too many."""

    def __init__(self, folder: Path, host: str, token: str | None) -> None:
        self._folder, self._host, self._token = folder, host, token
        self._open: dict[str, tuple[str, subprocess.Popen[str]]] = {}
        self._lock = threading.Lock()
        self._kept = tempfile.TemporaryDirectory(prefix="hectorscope-")

    def open(self, key: str) -> str:
        """The address of the page with this run; ViewerError or another SlamError with the reason why not."""
        with self._lock:
            if key in self._open and self._open[key][1].poll() is None:
                return self._open[key][0]
            spec = spec_of(self._folder, key)
            config = Path(self._kept.name) / f"{key}.toml"
            config.write_text(to_toml(spec.run_settings(), stated(spec.source_options())), encoding="utf-8")
            while len(self._open) >= MOST:
                self._open.pop(next(iter(self._open)))[1].terminate()
            self._open[key] = self._begin(view_arguments(spec, config))
            return self._open[key][0]

    def _begin(self, arguments: list[str]) -> tuple[str, "subprocess.Popen[str]"]:
        command = [sys.executable, "-c", MAIN.format(sys.path), *arguments, "--host", self._host, "--port", "0"]
        secret = {"HECTORSCOPE_TOKEN": self._token} if self._token else {}
        process = subprocess.Popen(
            command,
            stdin=subprocess.DEVNULL,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            env={**os.environ, **secret},
        )
        assert process.stdout is not None
        said = ""
        for line in process.stdout:
            if line.startswith(SAYS):
                threading.Thread(target=process.stdout.read, daemon=True).start()  # so that it never waits
                return line.removeprefix(SAYS).strip(), process
            said = line.strip() or said
        raise ViewerError(said.removeprefix("hectorscope: ") or "the viewer did not start: try the command view")

    def close(self) -> None:
        """End all of them."""
        with self._lock:
            for _, process in self._open.values():
                process.terminate()
            for _, process in self._open.values():
                process.wait()
            self._open.clear()
        self._kept.cleanup()


def spec_of(folder: Path, key: str) -> RunSpec:
    """The spec of a run of a sweep; OutputError if there is none."""
    try:
        spec = RunSpec.from_json(json.dumps(read_details(folder, key)["spec"]))
        spec.source_options()
    except (KeyError, TypeError, AttributeError) as error:
        raise OutputError(f"{folder} has the run {key} of another version: run it again") from error
    return spec


def view_arguments(spec: RunSpec, config: Path) -> list[str]:
    """The command that shows a run with its settings; config: the file that holds them.

    A folder of somebody else's is not trusted: a name or value that looks like another flag stays what it is.
    ViewerError for a path that is none.
    """
    path = local(spec.path)
    if not path.is_absolute():
        raise ViewerError(f"{spec.path} is no absolute path: run the sweep again")
    options = {name: value for name, value in asdict(spec.source_options()).items() if value is not None}
    arguments = ["view", str(path), "--config", str(config)]
    for name in sorted(options.keys() - stated(spec.source_options()).keys()):  # the others are in the file
        arguments += _flag(name.replace("_", "-"), options[name])
    return [*arguments, "--repair"] if spec.repair else arguments


def _flag(name: str, value: OptionValue) -> list[str]:
    if isinstance(value, tuple):
        return [f"--{name}", *(repr(float(part)) for part in value)]
    return [f"--{name}={value}"]
