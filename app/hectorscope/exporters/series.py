"""series.csv: every figure of every scan, a row a scan, written while the run goes on."""

from pathlib import Path

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import GrowingFile, exact_seconds, lines_of
from hectorscope.run.pipeline import TOGETHER, Pipeline
from hectorscope.run.series import SERIES_FIELDS
from slam_core.results import StepResult

NAME = "series.csv"
HEAD = ",".join(("t", *SERIES_FIELDS)) + "\n"


class SeriesStream:
    """The rows that the pipeline has written, as soon as it has."""

    def __init__(self, folder: Path) -> None:
        self._file = GrowingFile(folder / NAME)
        self._file.write(HEAD.encode())
        self._written = 0

    def add(self, pipeline: Pipeline, _result: StepResult) -> None:
        """Some rows at a time, as the pipeline does."""
        if pipeline.scans - self._written >= TOGETHER:
            self._catch_up(pipeline)

    def finish(self, pipeline: Pipeline) -> None:
        """The last rows."""
        self._catch_up(pipeline)
        self._file.finish()

    def close(self) -> None:
        """Leave it as it is."""
        self._file.close()

    def _catch_up(self, pipeline: Pipeline) -> None:
        start_ns, rows = pipeline.start_ns or 0, pipeline.series[self._written :]

        def line(row: list[float]) -> str:
            return f"{exact_seconds(start_ns, row[0])},{','.join(f'{value:.9g}' for value in row)}\n"

        for lines in lines_of(rows, line):
            self._file.write(lines)
        self._written += len(rows)


EXPORTER = Exporter("csv", (NAME,), stream=SeriesStream)
