"""A boat around a wooded island, along a vegetated shore: rough outlines, waves, no return from the water."""

import numpy as np

from hectorscope.simulation.course import STILL, Pace, follow
from hectorscope.simulation.motion import Channels, Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, Sway, ease_in, overlay
from hectorscope.simulation.shore import BED, Shore
from hectorscope.simulation.worlds import Surface, World, box, post
from slam_core.measurements import Float64s, Transform

DURATION = 58.0
SPEED = 1.4  # m/s
LASER = (0.4, 0.0, 0.7)  # m over the waterline amidships
SWAY, SWELL = 8.0, 0.45  # degrees, Hz
GPS_OUTAGE = 30.0  # s, behind the island
HEAVE = 0.2  # m at a sway of SWAY

_LAP = np.array([(0, 0), (22, 0), (22, 14), (-4, 14), (-4, 0)], dtype=np.float64)
_MAINLAND = np.array(
    [
        *[(-16, 32), (-13, 22), (-14, 12), (-12, 3), (-10, -5), (-3, -8), (4, -8.5), (9, -5), (13, -4.2)],
        *[(17, -6), (22, -9), (29, -10), (34, -5), (36, 3), (41, 10)],
    ],
    dtype=np.float64,
)
_ISLAND = np.array(
    [(1.5, 7), (4, 4.8), (8, 5.4), (12, 4.6), (16, 5.6), (17.6, 7.4), (15, 9.4), (10, 9), (6, 9.8), (2.5, 9)],
    dtype=np.float64,
)
_ISLET = np.array([(27, 11), (29, 9.5), (32, 10), (33, 12.5), (30.5, 14), (28, 13.2)], dtype=np.float64)


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it; the plants stand in the same places whatever the seed."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(25), acceleration=0.3, radius=5.0)
    waves = _waves(Sway.chosen(options, SWAY, SWELL))
    motion = Motion.through(overlay(follow(_LAP, pace, duration), waves), duration)
    world, mount = _world(np.random.default_rng(7)), Transform(np.array(LASER))
    return Scene(world, motion, mount, extras=("gps", "compass"), gps_outage=GPS_OUTAGE)


def _waves(sway: Sway) -> Channels:
    """Three swells that meet from different sides; nearly calm until the boat leaves."""

    def swell(t: Float64s, phase: float) -> Float64s:
        values = 0.55 * sway.wave(t, 1.0, phase) + 0.3 * sway.wave(t, 0.71, 2 * phase)
        return values + 0.15 * sway.wave(t, 1.53, 3 * phase)

    def channels(t: Float64s) -> Float64s:
        height = HEAVE / np.radians(SWAY) * sway.amplitude
        amplitudes = (0.0, 0.0, height, sway.amplitude, 0.7 * sway.amplitude, 0.25 * sway.amplitude)
        phases = (0.0, 0.0, 2.2, 0.0, 1.3, 0.6)
        strength = 0.04 * ease_in(t, 0.0, 1.0) + 0.96 * ease_in(t, STILL, 5.0)
        waves = [a * swell(t, phase) for a, phase in zip(amplitudes, phases, strict=True)]
        return np.column_stack([strength * wave for wave in waves])

    return channels


def _world(rng: np.random.Generator) -> World:
    island, islet = (np.concatenate((ring, ring[:1]))[::-1] for ring in (_ISLAND, _ISLET))  # water on the left
    shores = [
        Shore.along(_MAINLAND, (0.0, 0.8, 6.0), (-0.2, 0.35, 1.4), rng),
        Shore.along(island, (0.0, 0.7, 1.9), (-0.2, 0.35, 0.6), rng),
        Shore.along(islet, (0.0, 0.6, 1.4), (-0.2, 0.3, 0.5), rng),
    ]
    firm = [shape for shore in shores for shape in (shore.bank(), shore.trunks(rng))]
    surfaces = [
        Surface(np.concatenate([*firm, *_jetty()]), depth=0.01),
        Surface(np.concatenate([shore.bushes(rng) for shore in shores]), depth=0.05),
        Surface(np.concatenate([shore.reeds(rng) for shore in shores]), depth=0.03),
    ]
    return World(surfaces, ground=0.0, water=True, cell=1.0)


def _jetty() -> list[Float64s]:
    """A small landing stage on posts."""
    posts = [post(x, y, 0.08, BED, 0.95) for x in (24.3, 25.7) for y in (-9.0, -7.6, -6.2, -4.8)]
    return [*posts, box(24.2, -9.6, 25.8, -4.7, 0.45, 0.55)]
