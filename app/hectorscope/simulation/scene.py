"""What the simulator drives through: a world, the true motion in it, and how the sensors are mounted."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from hectorscope.simulation.course import STILL
from hectorscope.simulation.motion import Channels, Motion
from hectorscope.simulation.options import Extra, SceneOptions
from hectorscope.simulation.people import Person
from hectorscope.simulation.scanner import UTM30LX, Scanner
from hectorscope.simulation.worlds import World
from slam_core.measurements import Float64s, Transform


@dataclass(frozen=True, slots=True, eq=False)
class Scene:
    """One scenario. The map frame is the base at the start of the drive, where truth is the origin, facing +x.

    extras, gps_outage [s]: what is carried and missed if nobody asks for anything else.
    """

    world: World
    motion: Motion
    T_base_laser: Transform
    extras: tuple[Extra, ...] = ()
    gps_outage: float = 0.0
    people: tuple[Person, ...] = ()
    scanner: Scanner = UTM30LX

    def begun(self, seconds: float) -> "Scene":
        """The scene from so many seconds on, when the robot and the people are on their way."""
        motion = self.motion.begun(seconds)
        late = self.motion.duration - motion.duration
        return replace(self, motion=motion, people=tuple(each.begun(late) for each in self.people))


@dataclass(frozen=True, slots=True)
class Sway:
    """Amplitude [rad] of roll and pitch, and frequency [Hz], of the motion on top of the course."""

    amplitude: float
    frequency: float

    @classmethod
    def chosen(cls, options: SceneOptions, degrees: float, frequency: float) -> "Sway":
        """The options' sway, or what the scene prefers."""
        sway = degrees if options.sway is None else options.sway
        return cls(float(np.radians(sway)), options.sway_frequency or frequency)

    def wave(self, t: Float64s, ratio: float = 1.0, phase: float = 0.0) -> Float64s:
        """Unit sine at `ratio` times the frequency."""
        return np.sin(2 * np.pi * ratio * self.frequency * t + phase)


def rocking(sway: Sway) -> Channels:
    """Roll and pitch that set in after the start; frequencies apart, so that every mixture occurs."""

    def channels(t: Float64s) -> Float64s:
        values = np.zeros((len(t), 6))
        grown = sway.amplitude * ease_in(t, STILL, 2.0)
        values[:, 3] = grown * sway.wave(t)
        values[:, 4] = grown * sway.wave(t, 0.83, 1.0)
        return values

    return channels


def ease_in(t: Float64s, start: float, length: float) -> Float64s:
    """0 before `start`, 1 from `start + length` on, smooth between."""
    u = np.clip((t - start) / length, 0.0, 1.0)
    return u * u * (3 - 2 * u)


def overlay(course: Callable[[Float64s], Float64s], extra: Channels) -> Channels:
    """A course (x, y, yaw) with `extra` on top; its x and y are forward and left of the heading."""

    def channels(t: Float64s) -> Float64s:
        x, y, yaw = course(t).T
        values = extra(t)
        forward, left = values[:, 0].copy(), values[:, 1].copy()
        values[:, 0] = x + forward * np.cos(yaw) - left * np.sin(yaw)
        values[:, 1] = y + forward * np.sin(yaw) + left * np.cos(yaw)
        values[:, 5] += yaw
        return values

    return channels
