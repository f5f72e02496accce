"""The rows of a sweep: appended to runs.csv as runs end, put in order at the end; a file of details of each."""

import csv
import io
import json
import math
import os
from collections.abc import Iterable, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import asdict
from pathlib import Path
from typing import Any

from hectorscope.common.paths import write_whole
from hectorscope.exporters import OutputError
from hectorscope.sweep.figures import NAMES
from hectorscope.sweep.spec import RunSpec, RunSummary

CSV, PARQUET, DETAILS = "runs.csv", "runs.parquet", "details"
FIRST, AFTER, TIMES = ("key", "recording"), ("share", "status", "reason"), ("wall_s", "memory_mb", "worker")
FIXED = (*FIRST, *AFTER, *NAMES, *TIMES)
"""The columns beside the settings that are varied, which stand behind FIRST. TIMES differ from sweep to sweep."""
BROKEN = frozenset({"failed", "timeout", "memory", "crashed"})  # what --retry runs again

Row = dict[str, str]


class Table:
    """runs.csv in a folder, for one program at a time. A row is on the disk before `append` returns.

    names: the settings that are varied now; a column that an earlier sweep had stays.
    """

    def __init__(self, folder: Path, names: Sequence[str]) -> None:
        self._folder = folder
        self.rows = {row["key"]: row for row in read(folder)}
        before = [name for row in self.rows.values() for name in row if name not in FIXED]
        self.names = list(dict.fromkeys([*before, *names]))
        self._columns = [*FIRST, *self.names, *FIXED[len(FIRST) :]]
        if self.rows or not (folder / CSV).exists():
            self._write()  # a row that was cut goes, new columns come

    def __contains__(self, key: object) -> bool:
        return key in self.rows

    def forget(self, statuses: Iterable[str]) -> None:
        """Leave out the rows of runs that ended so: they are done again."""
        gone = set(statuses)
        self.rows = {key: row for key, row in self.rows.items() if row["status"] not in gone}
        self._write()

    def append(self, spec: RunSpec, summary: RunSummary) -> None:
        """One more run; its details first, so that a row always has them. OutputError if the disk is full."""
        row = self._row(spec, summary)
        with _writing(self._folder):
            write_details(self._folder, spec, summary)
            with (self._folder / CSV).open("ab") as file:
                file.write(self._line(row))
                file.flush()
                os.fsync(file.fileno())
        self.rows[spec.key] = row

    def finish(self, specs: Iterable[RunSpec]) -> None:
        """Put the rows into the order of the specs, whatever order they ended in; others behind them."""
        order = {spec.key: k for k, spec in enumerate(specs)}
        ordered = sorted(self.rows, key=lambda key: (order.get(key, len(order)), key))
        self.rows = {key: self.rows[key] for key in ordered}
        self._write()

    def _row(self, spec: RunSpec, summary: RunSummary) -> Row:
        values: dict[str, Any] = {**asdict(summary), **summary.figures, "key": spec.key}
        values |= {"recording": spec.recording, "share": spec.share, "reason": summary.reason}
        values |= {name: spec.value(name) for name in self.names}
        return {name: text(values.get(name)) for name in self._columns}

    def _line(self, row: Row) -> bytes:
        line = io.StringIO()
        csv.writer(line, lineterminator="\n").writerow([row.get(name, "") for name in self._columns])
        return line.getvalue().encode()

    def _write(self) -> None:
        head = self._line(dict(zip(self._columns, self._columns, strict=True)))
        with _writing(self._folder):
            write_whole(self._folder / CSV, head, (self._line(row) for row in self.rows.values()))


@contextmanager
def _writing(folder: Path) -> Iterator[None]:
    """OutputError where a file of the folder cannot be written."""
    try:
        yield
    except OSError as error:
        raise OutputError(
            f"{folder} cannot be written to ({error.strerror}): make room, and start again to do what is missing"
        ) from error


def text(value: Any) -> str:
    """A value in a cell; empty for none."""
    if value is None or (isinstance(value, float) and not math.isfinite(value)):
        return ""
    return value if isinstance(value, str) else json.dumps(value)


def value(cell: str) -> float | bool | str | None:
    """What a cell holds: a number, a switch, a word, or nothing."""
    if not cell:
        return None
    if cell in {"true", "false"}:
        return cell == "true"
    try:
        number = float(cell)
    except ValueError:
        return cell
    return number if math.isfinite(number) else cell


def read(folder: Path) -> list[Row]:
    """The rows of the table in a folder; of a key the last. A last line that was cut is left out."""
    try:
        content = (folder / CSV).read_bytes()
    except FileNotFoundError:
        return []
    except OSError as error:
        raise OutputError(f"{folder / CSV} cannot be read ({error.strerror}): give another folder") from error
    whole = content[: content.rfind(b"\n") + 1].decode("utf-8", "replace")
    reader = csv.DictReader(io.StringIO(whole), strict=False)
    if whole and not {*FIRST, "status"} <= set(reader.fieldnames or ()):
        raise OutputError(f"{folder / CSV} is no table of a sweep: give another folder")
    rows = [row for row in reader if None not in row and None not in row.values() and row["key"].isalnum()]
    return list({row["key"]: row for row in rows}.values())


def write_details(folder: Path, spec: RunSpec, summary: RunSummary) -> None:
    """What opens the run again, its picture and its path, as a file by its key."""
    kept = {name: getattr(summary, name) for name in ("picture", "extent", "path")}
    path = folder / DETAILS / f"{spec.key}.json"
    path.parent.mkdir(exist_ok=True)
    write_whole(path, json.dumps({"spec": asdict(spec), **kept}).encode())


def read_details(folder: Path, key: str) -> dict[str, Any]:
    """Of `write_details`; OutputError if there are none for a key."""
    try:
        found: dict[str, Any] = json.loads((folder / DETAILS / f"{key}.json").read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise OutputError(f"{folder} has no details of the run {key}: run it again") from error
    return found


def write_parquet(folder: Path) -> Path:
    """runs.parquet with what runs.csv holds, numbers as numbers; OutputError without pyarrow."""
    try:
        import pyarrow  # noqa: PLC0415  an extra
        from pyarrow import parquet  # noqa: PLC0415
    except ImportError as error:
        raise OutputError("--parquet needs pyarrow: run pip install 'hectorscope[parquet]'") from error
    rows = read(folder)
    columns = {name: _column([row[name] for row in rows]) for name in (rows[0] if rows else FIXED)}
    content = io.BytesIO()
    parquet.write_table(pyarrow.table(columns), content)
    with _writing(folder):
        write_whole(folder / PARQUET, content.getvalue())
    return folder / PARQUET


def _column(cells: list[str]) -> list[Any]:
    """The values of a column, of one type: words, unless all are numbers or switches."""
    values = [value(cell) for cell in cells]
    kinds = {type(each) for each in values if each is not None}
    return values if len(kinds) <= 1 else [cell or None for cell in cells]
