"""Which figures of a run a table keeps, and which of them are better when they are higher."""

from collections.abc import Iterator, Mapping
from typing import Any

FIGURES = {
    "scans": ("read", "used"),
    "tracking": ("tracking", "recovered", "degraded", "lost"),
    "truth": ("poses", "raw_rmse_m", "aligned_rmse_m", "height_rms_m", "roll_rms_deg", "pitch_rms_deg"),
    "relations": (
        "given", "used", "translation_mean_m", "translation_std_m", "rotation_mean_deg", "rotation_std_deg",
    ),
}  # fmt: skip
COUNTS = ("map_updates", "occupied_cells")
SCORE = "consistency"
NAMES = (SCORE, *(f"{group}.{name}" for group, names in FIGURES.items() for name in names), *COUNTS)
"""The figures of a run that a table keeps, by dotted name: none is a time."""
HIGHER = frozenset({SCORE, "scans.used", "tracking.tracking"})  # is better; of the others lower is
TARGETS = ("truth.aligned_rmse_m", SCORE)  # without a word: the first that all recordings have


def flat(figures: Mapping[str, Any]) -> Iterator[tuple[str, float | None]]:
    """The figures that a table keeps, by dotted name; of states that never were, 0."""
    for name in (SCORE, *COUNTS):
        yield name, figures[name]
    for group, names in FIGURES.items():
        found = figures.get(group) or {}
        for name in names:
            yield f"{group}.{name}", found.get(name, 0 if group == "tracking" else None)
