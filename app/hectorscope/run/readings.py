"""What a closer look at a beam or a cell shows, and where somebody looks: values without the work behind them."""

import math
from dataclasses import dataclass

Cell = tuple[int, int]
"""Column and row in the lattice of a level."""


@dataclass(frozen=True, slots=True)
class Span:
    """Scans, counted from 1, and their seconds since the start: something happened at one of them."""

    first: int
    last: int
    from_s: float
    to_s: float


@dataclass(frozen=True, slots=True)
class History:
    """When a cell was written first and last; None for a cell that is unknown.

    saved: it may have been known from the start, by the map that the run began with.
    """

    first: Span | None = None
    last: Span | None = None
    saved: bool = False


@dataclass(frozen=True, slots=True)
class BeamTarget:
    """A beam by its number in the scan, from 0."""

    number: int


@dataclass(frozen=True, slots=True)
class CellTarget:
    """A place on a level of the map, metres."""

    level: int
    x: float
    y: float


Target = BeamTarget | CellTarget


@dataclass(frozen=True, slots=True)
class LevelReading:
    """A level at a place. cell: in the lattice of the level. resolution: metres a cell. probability: of the cell;
    None where it is unknown. residual: 1 - M of eq. (4), interpolated at the place.
    """

    cell: Cell
    resolution: float
    probability: float | None
    residual: float


@dataclass(frozen=True, slots=True)
class CellView:
    """The map at a place (metres), on every level, finest first; the history of the cell of one `level`."""

    level: int
    x: float
    y: float
    levels: tuple[LevelReading, ...]
    history: History


@dataclass(frozen=True, slots=True)
class BeamView:
    """A beam of the shown scan.

    beams: of the scan. range_m: as measured, may be inf or nan. angle: radians, by the laser. after_s: since the
    first beam; nan without beam timing. laser: (x, y) where the beam starts, metres in the map.
    Of a beam with an endpoint alone: used_m, its range, which may be smoothed. height over the laser, metres.
    residual: 1 - M in the match, at the finest level; nan for a scan that was matched to nothing. left_out: it was
    not matched, as it is on an object that may move. unexpected: it ended in free space. end: the map there.
    """

    number: int
    beams: int
    range_m: float
    angle: float
    after_s: float
    laser: tuple[float, float]
    used_m: float = math.nan
    height: float = math.nan
    residual: float = math.nan
    left_out: bool = False
    unexpected: bool = False
    end: CellView | None = None


View = BeamView | CellView
