"""series.csv: every figure of every scan, a row a scan, written while the run goes on."""

from collections.abc import Iterator
from pathlib import Path

from hectorscope.exporters import Exporter
from hectorscope.exporters._files import exact_seconds, lines_of
from hectorscope.exporters._lines import LinesStream
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.series import SERIES_FIELDS

NAME = "series.csv"
HEAD = ",".join(("t", *SERIES_FIELDS)) + "\n"


def _lines(pipeline: Pipeline, first: int) -> Iterator[bytes]:
    start_ns = pipeline.start_ns or 0

    def line(row: list[float]) -> str:
        return f"{exact_seconds(start_ns, row[0])},{','.join(f'{value:.9g}' for value in row)}\n"

    return lines_of(pipeline.series[first:], line)


def _stream(folder: Path) -> LinesStream:
    return LinesStream(folder / NAME, _lines, HEAD.encode())


EXPORTER = Exporter("csv", (NAME,), stream=_stream)
