"""What a format is: a name, its files, and what writes them."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Protocol

from hectorscope.run.pipeline import Pipeline
from hectorscope.run.results import Run
from slam_core.results import StepResult


class Stream(Protocol):
    """A file that grows while the run goes on. It has its own name from `finish` on, one that says so before."""

    def add(self, pipeline: Pipeline, result: StepResult) -> None:
        """A scan gave a result."""

    def finish(self, pipeline: Pipeline) -> None:
        """The run is at its end."""

    def close(self) -> None:
        """Let go of the file, finished or not."""


def _nothing(_run: Run, _folder: Path) -> None:
    """For a format that is a stream."""


@dataclass(frozen=True, slots=True)
class Exporter:
    """One format: `name` asks for it (`--export`), `files` are what it leaves.

    `write(run, folder)` leaves them in `folder` (under a temporary name, then renamed). A format that is written
    while the run goes on has `stream(folder)` in its place. `drafts(folder)` are what a killed run without a page
    leaves of files that are written as a whole. `order` sorts the exporters: on a disk that fills up, what comes
    first is there. default: it is written unless formats are named.
    """

    name: str
    files: tuple[str, ...]
    write: Callable[[Run, Path], None] = _nothing
    order: int = 50
    default: bool = False
    stream: Callable[[Path], Stream] | None = None
    drafts: Callable[[Path], tuple[Stream, ...]] | None = None
