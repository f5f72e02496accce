"""Another drive that localises in a saved map: how near it comes, by its cells alone and with its surfels."""

from dataclasses import replace

import numpy as np

from benchmarks.accuracy import Outcome, outcome, process
from hectorscope.simulation import SceneOptions, Simulation
from hectorscope.simulation.options import ScenarioName
from slam_core.config import SlamConfig
from slam_core.localization.prior_map import PriorMap, saved_levels

OTHER = 100  # the seed of the second drive is that of the first and so much
SCENES: dict[str, tuple[ScenarioName, SceneOptions]] = {
    "rooms": ("rooms", SceneOptions()),
    "rooms, 5 Hz": ("rooms", SceneOptions(scan_rate=5.0)),
    "rooms, sway": ("rooms", SceneOptions(sway=15.0, sway_frequency=1.2)),
    "arena": ("arena", SceneOptions()),
    "handheld": ("handheld", SceneOptions()),
}


def localised(name: str, seed: int) -> tuple[Outcome, Outcome]:
    """The second drive by cells alone, and in the whole map that the first one left."""
    scene, options = SCENES[name]
    first = process(Simulation(scene, replace(options, seed=seed)).items(), SlamConfig())
    levels = saved_levels(first.slam.map)
    items = list(Simulation(scene, replace(options, seed=seed + OTHER)).items())
    cells_alone = tuple(replace(level, surfels=None) for level in levels)
    alone, whole = (
        outcome(process(items, SlamConfig(), PriorMap("the first drive's", each, start=np.zeros(3))))
        for each in (cells_alone, levels)
    )
    return alone, whole
