"""A building that somebody walks through with the device in the hand: a loop of corridors, with rooms on it."""

import numpy as np

from hectorscope.simulation.course import STILL, Pace, follow
from hectorscope.simulation.motion import Channels, Motion
from hectorscope.simulation.options import SceneOptions
from hectorscope.simulation.scene import Scene, Sway, ease_in, overlay
from hectorscope.simulation.worlds import Surface, World, box, post, wall
from slam_core.measurements import Float64s, Transform

DURATION = 59.0
SPEED = 1.2  # m/s
LASER = (0.05, 0.0, 0.08)  # m
FLOOR, CEILING = -1.2, 1.5  # m from the hand
SWAY, STRIDE = 10.0, 1.0  # degrees, Hz: one stride is two steps

_LAP = np.array(
    [(0, 0), (16, 0), (16, 10), (9.5, 10), (9.5, 13.5), (5.5, 13.5), (5.5, 10), (-3, 10), (-3, 0)],
    dtype=np.float64,
)


def build(options: SceneOptions) -> Scene:
    """The scene as `options` ask for it."""
    duration = options.duration or DURATION
    pace = Pace(speed=SPEED * options.speed, turn_rate=np.radians(65), acceleration=0.8, radius=0.7)
    gait = _gait(Sway.chosen(options, SWAY, STRIDE))
    motion = Motion.through(overlay(follow(_LAP, pace, duration), gait), duration)
    world = World([Surface(np.concatenate(_walls() + _furniture()))], ground=FLOOR, ceiling=CEILING)
    return Scene(world, motion, Transform(np.array(LASER)))


def _gait(sway: Sway) -> Channels:
    """Two bobs and one sideways swing a stride; the hand follows, and wanders slowly besides."""

    def channels(t: Float64s) -> Float64s:
        walking, angle = ease_in(t, STILL, 1.5), sway.amplitude
        swing, step = sway.wave(t), sway.wave(t, 2.0, 0.4)
        motions = (
            0.012 * step,
            0.025 * swing,
            0.018 * sway.wave(t, 2.0, 1.9),
            angle * (0.42 * swing + 0.4 * sway.wave(t, 0.19, 0.3) + 0.18 * sway.wave(t, 0.07)),
            angle * (0.34 * step + 0.46 * sway.wave(t, 0.13, 1.1) + 0.2 * sway.wave(t, 0.05)),
            0.05 * sway.wave(t, 1.0, 0.8) + 0.06 * sway.wave(t, 0.17),
        )
        return np.column_stack([walking * motion for motion in motions])

    return channels


def _partition(a: tuple[float, float], b: tuple[float, float], *doors: float, width: float = 1.0) -> Float64s:
    """A wall of full height with open doorways of `width`, each given by its middle along the wall."""
    return wall(a, b, FLOOR, CEILING, 0.14, [(door - width / 2, door + width / 2) for door in doors])


def _walls() -> list[Float64s]:
    """Corridors 2 m wide around a core of 17 x 8 m, and rooms around them."""
    return [
        box(-9, -6, 22, 16.5, FLOOR, CEILING),  # the building
        _partition((-2, 1), (15, 1), 2.5, 8.0, 13.5),  # the core
        _partition((-2, 9), (15, 9), 4.0, 12.6),
        _partition((-2, 1), (-2, 9), 5.6),
        _partition((15, 1), (15, 9), 2.2),
        _partition((3.4, 1), (3.4, 9)),
        _partition((9.2, 1), (9.2, 9), 6.6),
        _partition((3.4, 5), (9.2, 5)),
        _partition((-4, -1), (17, -1), 3.2, 8.8, 12.4, 18.0),  # along the corridors
        _partition((-4, 11), (17, 11), 1.6, 9.5, 13.5, 18.6),
        _partition((17, -1), (17, 11), 2.6, 8.0),
        _partition((-4, 5), (-4, 11), 3.0),
        _partition((-4, -6), (-4, -1), 3.6, width=1.6),
        _partition((1.6, -6), (1.6, -1)),  # rooms in the south
        _partition((6.6, -6), (6.6, -1), 1.2),
        _partition((12.2, -6), (12.2, -1)),
        _partition((17, -6), (17, -1)),
        _partition((-4, 11), (-4, 16.5)),  # rooms in the north
        _partition((3.6, 11), (3.6, 16.5), 4.2),
        _partition((11.4, 11), (11.4, 16.5)),
        _partition((17, 11), (17, 16.5)),
        _partition((17, 4.6), (22, 4.6)),  # rooms in the east and west
        _partition((17, 11), (22, 11), 4.0),
        _partition((-9, 5), (-4, 5), 1.4),
    ]


def _furniture() -> list[Float64s]:
    """Cupboards and columns of full height, tables and benches that only a tilted beam meets."""
    high, desk, bench = 0.8, FLOOR + 0.74, FLOOR + 0.45
    columns = [(-6.6, 1.8), (-6.6, -3.2), (20.0, 8.0), (7.5, 15.0)]
    cupboards = [
        *[(4.3, 11.1, 5.0, 11.5), (10.7, 12.0, 11.3, 14.0), (3.7, 13.2, 4.1, 14.8), (6.2, 16.0, 8.8, 16.4)],
        *[(-1.9, 1.2, -1.4, 3.0), (2.8, 6.8, 3.3, 8.9), (5.0, 1.1, 7.0, 1.6), (9.3, 2.0, 9.8, 4.6)],
        *[(13.4, 8.3, 14.9, 8.9), (-3.5, -5.9, -1.0, -5.4), (4.6, -5.9, 6.5, -5.4), (7.0, -5.8, 7.5, -3.6)],
        *[(15.9, -5.9, 16.9, -5.3), (20.5, -0.8, 21.9, -0.2), (21.4, 5.4, 21.9, 7.6), (-8.9, 6.5, -8.4, 9.5)],
        *[(-3.9, 6.0, -3.6, 6.8), (16.6, 5.2, 16.9, 6.6), (-0.2, 10.7, 1.2, 10.92), (10.6, -0.92, 11.6, -0.7)],
    ]
    tables = [
        *[(6.4, 14.2, 8.6, 15.0), (0.2, 12.4, 1.8, 14.0), (12.6, 13.0, 15.6, 14.2), (4.6, 6.2, 6.6, 7.4)],
        *[(11.0, 3.0, 13.0, 5.0), (3.0, -4.6, 4.6, -3.4), (8.8, -4.4, 10.8, -3.0), (13.6, -4.2, 15.2, -2.8)],
    ]
    benches = [(-8.6, -1.0, -8.1, 3.0), (0.4, 0.6, 2.0, 0.9), (18.0, 0.4, 19.6, 0.9)]
    return [
        *[post(x, y, 0.2, FLOOR, CEILING, sides=12) for x, y in columns],
        *[box(*plan, FLOOR, high) for plan in cupboards],
        *[box(*plan, FLOOR, desk) for plan in tables],
        *[box(*plan, FLOOR, bench) for plan in benches],
    ]
