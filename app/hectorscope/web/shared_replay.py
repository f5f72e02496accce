"""The format html: replay.html, the scene of a run with timeline, curves, log and notes, which needs no server.

viser, which draws it, is loaded with the first scan: the names of the formats must come at once.
"""

from collections.abc import Sequence
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from hectorscope.run.notes import Note

if TYPE_CHECKING:
    from hectorscope.exporters import Exporter, Stream


def exporter(notes: Sequence[Note] = (), source: str = "") -> "Exporter":
    """The format, with these notes pinned to their moments. source: the name of what was run."""
    from hectorscope.exporters import REPLAY, Exporter  # noqa: PLC0415 - it needs numba

    return Exporter("html", (REPLAY,), order=95, stream=partial(_stream, tuple(notes), source))


def _stream(notes: tuple[Note, ...], source: str, folder: Path) -> "Stream":
    from hectorscope.web.replay import ReplayStream  # noqa: PLC0415

    return ReplayStream(folder, notes, source)
