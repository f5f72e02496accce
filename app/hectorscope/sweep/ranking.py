"""What a sweep looks for: a figure, and how good each run is by it."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass
from math import inf
from statistics import median

from hectorscope.sweep.figures import HIGHER, NAMES, TARGETS
from hectorscope.sweep.search import standing
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.table import Row, value
from slam_core.errors import SlamError, nearest

DIGITS = 6  # of a median, as of the figures themselves
LOST = 1e9  # added to the cost of a run whose pose was lost: behind all that held


class TargetError(SlamError):
    """A figure that there is not."""


def check_target(name: str | None) -> None:
    """TargetError for a figure that no run has."""
    if name is not None and name not in NAMES:
        near = nearest(name, NAMES, separator=".")
        remedy = f"did you mean {near}?" if near else f"there are {', '.join(NAMES)}"
        raise TargetError(f"--target {name} is no figure: {remedy}")


def target_of(rows: Collection[Row]) -> str:
    """The error against the truth where all runs with figures have one, else the consistency score."""
    done = [row for row in rows if row["status"] in {"ok", "lost"}]
    return next((name for name in TARGETS if done and all(row.get(name) for row in done)), TARGETS[-1])


@dataclass(frozen=True, slots=True)
class Place:
    """One setting among those of a sweep.

    spec: one of its runs. median: of the target over the recordings with figures, None without one. bad: runs that
    were lost or have no figures.
    """

    spec: RunSpec
    median: float | None
    bad: int


def places(specs: Sequence[RunSpec], rows: Mapping[str, Row], target: str) -> list[Place]:
    """The settings of whole runs, from the best on, as `standing` puts them."""
    whole = [spec for spec in specs if spec.share == 1.0 and spec.key in rows]
    found = {spec.key: cost(rows[spec.key], target) for spec in whole}
    return [
        _place([spec for spec in whole if spec.setting_key == key], rows, target) for key in standing(whole, found)
    ]


def _place(specs: Sequence[RunSpec], rows: Mapping[str, Row], target: str) -> Place:
    own = [rows[spec.key] for spec in specs]
    values = [found for row in own if isinstance(found := value(row.get(target, "")), float)]
    bad = sum(row["status"] != "ok" for row in own)
    return Place(specs[0], round(median(values), DIGITS) if values else None, bad)


def cost(row: Mapping[str, str], target: str) -> float:
    """Lower is better; infinite without the figure."""
    found = value(row.get(target, ""))
    if not isinstance(found, float) or row["status"] not in {"ok", "lost"}:
        return inf
    return (-found if target in HIGHER else found) + (LOST if row["status"] == "lost" else 0.0)
