"""Checkpoints of a run: what it takes to go on from an instant that was passed, within a budget of memory."""

import io
import pickle
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Any

import zstandard

from hectorscope.run.pipeline import Pipeline
from hectorscope.run.rows import GrowingRows
from hectorscope.run.settings import Settings
from slam_core.mapping.frozen_map import FrozenMap, Packing
from slam_core.mapping.tiled_map import TiledMap

MEBIBYTE = 1 << 20
BUDGET_MB = 512
# Scans that a seek steps at least, so that it arrives with a scan that can be processed again.
LEAD = 3
ENTRY = 100  # bytes of the list of tiles, for each
ZSTD = Packing(partial(zstandard.compress, level=1), zstandard.decompress)


@dataclass(frozen=True, slots=True)
class Place:
    """Where in a recording items go on. taken: how many were handed out. state: what the source needs for it."""

    taken: int
    state: object


class _Pickler(pickle.Pickler):
    """Leaves out the map of the run, which is kept in tiles, and rows, which are shared."""

    def __init__(self, file: io.BytesIO, kept: TiledMap, before: FrozenMap | None) -> None:
        super().__init__(file, pickle.HIGHEST_PROTOCOL)
        self.map = FrozenMap(kept, ZSTD, before)
        self.rows: list[GrowingRows] = []
        self._kept = kept

    def persistent_id(self, value: Any) -> int | None:
        """-1 for the map, the number of rows, None for what is to be pickled."""
        if value is self._kept:
            return -1
        if isinstance(value, GrowingRows):
            self.rows.append(value.share())
            return len(self.rows) - 1
        return None


class _Unpickler(pickle.Unpickler):
    def __init__(self, state: bytes, frozen: FrozenMap, rows: list[GrowingRows]) -> None:
        super().__init__(io.BytesIO(state))
        self._map, self._rows = frozen.thaw(), rows

    def persistent_load(self, number: Any) -> Any:
        """What `persistent_id` gave the number of."""
        return self._map if number < 0 else self._rows[number].share()


class Checkpoint:
    """A pipeline as it was at a place of its recording.

    time_ns: of its last scan. scans_read, scans: up to there, all and those with a result. serves_ns: the earliest
    time that is sought from here.
    """

    def __init__(self, pipeline: Pipeline, place: Place, before: "Checkpoint | None") -> None:
        """before: an earlier one of the same run, with which tiles are shared."""
        seconds = pipeline.trajectory[-2:, 0]
        interval_ns = round(1e9 * float(seconds[-1] - seconds[0])) if len(seconds) else 0
        self.place, self.time_ns, self.scans_read = place, pipeline.time_ns, pipeline.scans_read
        self.scans = pipeline.scans
        self.serves_ns = self.time_ns + LEAD * max(0, interval_ns)
        file = io.BytesIO()
        pickler = _Pickler(file, pipeline.slam.map, before.map if before else None)
        pickler.dump(pipeline)
        self._state, self._rows = ZSTD.pack(file.getvalue()), pickler.rows
        self.map: FrozenMap = pickler.map

    def pipeline(self, settings: Settings) -> Pipeline:
        """A pipeline that goes on from here with settings, which are the same up to here."""
        pipeline: Pipeline = _Unpickler(ZSTD.unpack(self._state), self.map, self._rows).load()
        pipeline.settings = settings
        return pipeline

    def nbytes(self, before: "Checkpoint | None" = None) -> int:
        """Memory that it takes beside another one."""
        shared = {id(tile) for tile in before.map.tiles} if before else set()
        tiles = self.map.tiles
        return len(self._state) + ENTRY * len(tiles) + sum(t.nbytes for t in tiles if id(t) not in shared)


class Checkpoints:
    """Those of one run, in order. budget: bytes of pipelines and tiles; 0 for none at all.

    When it is used up, every second one is given up, and from then on they are kept half as often.
    """

    def __init__(self, budget: int = BUDGET_MB * MEBIBYTE) -> None:
        self._budget = budget
        self._kept: list[Checkpoint] = []
        self._apart = 1  # scans from one to the next
        self.nbytes = 0

    def __len__(self) -> int:
        return len(self._kept)

    @property
    def last(self) -> Checkpoint | None:
        """The one that is furthest; None without any."""
        return self._kept[-1] if self._kept else None

    def __iter__(self) -> Iterator[Checkpoint]:
        return iter(self._kept)

    def add(self, pipeline: Pipeline, place: Place) -> None:
        """The run is at a place: the pipeline is kept if it is further than all kept ones, and it is time."""
        last = self.last
        since = pipeline.scans_read - (last.scans_read if last else 0)
        if not self._budget or not pipeline.scans or since < self._apart:
            return
        self._kept.append(Checkpoint(pipeline, place, last))
        self.nbytes += self._kept[-1].nbytes(last)
        while self.nbytes > self._budget and len(self._kept) > 1:
            self._thin_out()

    def before(self, time_ns: int) -> Checkpoint | None:
        """The last one from which a time is reached; None before the first."""
        serving = (kept for kept in reversed(self._kept) if kept.serves_ns <= time_ns)
        return next(serving, None)

    def until(self, time_ns: int | None, budget: int | None = None) -> "Checkpoints":
        """Those before a time (None: all), for a run that is the same up to there. budget: None for as much."""
        other = Checkpoints(self._budget if budget is None else budget)
        other._apart = self._apart
        other._kept = [kept for kept in self._kept if time_ns is None or kept.time_ns < time_ns]
        other._count()
        while other.nbytes > other._budget and len(other) > 1:
            other._thin_out()
        return other

    def first(self, taken: int) -> Checkpoint | None:
        """The first one behind so many items; None without any."""
        return next((kept for kept in self._kept if kept.place.taken >= taken), None)

    def forget_before(self, taken: int) -> None:
        """Give up those that need an item before that number, once they are many."""
        stale = sum(kept.place.taken < taken for kept in self._kept)
        if stale * 8 > len(self._kept):
            del self._kept[:stale]
            self._count()

    def forget_from(self, time_ns: int) -> None:
        """Give up those at and after a time at which the settings changed."""
        self._kept = [kept for kept in self._kept if kept.time_ns < time_ns]
        self._count()

    def _thin_out(self) -> None:
        spans = [b.scans_read - a.scans_read for a, b in pairwise(self._kept)]
        self._apart = 2 * min(spans)
        del self._kept[1::2]
        self._count()

    def _count(self) -> None:
        pairs = zip([None, *self._kept], self._kept, strict=False)
        self.nbytes = sum(kept.nbytes(before) for before, kept in pairs)
