"""Files with a line a scan, which are written while the run goes on."""

from collections.abc import Callable, Iterator
from pathlib import Path

from hectorscope.exporters._files import GrowingFile
from hectorscope.run.pipeline import TOGETHER, Pipeline
from slam_core.results import StepResult

Lines = Callable[[Pipeline, int], Iterator[bytes]]
"""The lines of a pipeline from a scan on, some at a time."""


class LinesStream:
    """The lines that the pipeline has, as soon as it has them. head: before the first."""

    def __init__(self, path: Path, lines: Lines, head: bytes = b"") -> None:
        self._file, self._lines, self._written = GrowingFile(path), lines, 0
        self._file.write(head)

    def add(self, pipeline: Pipeline, _result: StepResult) -> None:
        """Some lines at a time, as the pipeline writes its rows."""
        if pipeline.scans - self._written >= TOGETHER:
            self._catch_up(pipeline)

    def finish(self, pipeline: Pipeline) -> None:
        """The last lines."""
        self._catch_up(pipeline)
        self._file.finish()

    def close(self) -> None:
        """Leave it as it is."""
        self._file.close()

    def _catch_up(self, pipeline: Pipeline) -> None:
        for lines in self._lines(pipeline, self._written):
            self._file.write(lines)
        self._written = pipeline.scans


class Draft(LinesStream):
    """Lines that a killed process leaves of a file that is written as a whole in the end."""

    def finish(self, pipeline: Pipeline) -> None:
        """The last lines; it stays a draft, and is removed once the file is there."""
        self._catch_up(pipeline)
