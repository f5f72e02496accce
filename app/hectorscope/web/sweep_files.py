"""What the page of a sweep asks for: its own files, the table as JSON, and the details of single runs."""

import json
import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

from hectorscope.common.resources import resource_folder
from hectorscope.exporters import OutputError
from hectorscope.page.static_files import File, static_files
from hectorscope.sweep.figures import HIGHER, NAMES
from hectorscope.sweep.ranking import cost, target_of
from hectorscope.sweep.table import FIXED, Row, read, read_details, value

INDEX, DATA = "/static/sweep/index.html", "/data.json"
DETAILS = re.compile(r"/run/(?P<key>[0-9a-f]{16})\.json")
JSON = "application/json"


class SweepFiles(Mapping[str, File]):
    """By path, as the access control takes them. The table is read at each request: a sweep may be running."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._static = static_files(resource_folder("static"))

    def __getitem__(self, path: str) -> File:
        if path == "/":
            return self._static[INDEX]
        if path == DATA:
            return _json(table(self._folder))
        if found := DETAILS.fullmatch(path):
            try:
                return _json(read_details(self._folder, found["key"]))
            except OutputError as error:
                raise KeyError(path) from error
        return self._static[path]

    def __iter__(self) -> Iterator[str]:
        return iter(("/", DATA, *self._static))

    def __len__(self) -> int:
        return 2 + len(self._static)


def table(folder: Path) -> dict[str, Any]:
    """The rows with numbers as numbers, the names that are varied, and how good each run is by the target."""
    rows = read(folder)
    target = target_of(rows)
    return {
        "name": folder.resolve().name,
        "names": [name for name in (rows[0] if rows else ()) if name not in FIXED],
        "figures": [name for name in NAMES if any(row.get(name) for row in rows)],
        "higher": sorted(HIGHER),
        "target": target,
        "rows": [_row(row, target) for row in rows],
    }


def _row(row: Row, target: str) -> dict[str, Any]:
    """The cells; keys, names and reasons stay words, whatever they look like."""
    found = cost(row, target)
    words = {name: row[name] for name in ("key", "recording", "status", "reason", "worker")}
    cells = {name: value(cell) for name, cell in row.items()}
    return {**cells, **words, "held": found < float("inf") and row["status"] == "ok"}


def _json(value: Any) -> File:
    return File(f"{JSON}; charset=utf-8", json.dumps(value, allow_nan=False).encode())
