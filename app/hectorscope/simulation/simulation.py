"""A scene measured: items in the order in which a recorder would receive them, and the truth at any time."""

import heapq
from collections.abc import Callable, Iterator

from hectorscope.simulation import (
    aids,
    scene_arena,
    scene_corridor,
    scene_glass,
    scene_handheld,
    scene_littoral,
    scene_offices,
    scene_people,
    scene_rooms,
    sensors,
)
from hectorscope.simulation.options import Extra, ScenarioName, SceneOptions, SimulationError
from hectorscope.simulation.scene import Scene
from hectorscope.simulation.sensors import Arrival
from slam_core.measurements import Aid, Imu, LaserScan, Transform, TruthPose

SCENES: dict[ScenarioName, Callable[[SceneOptions], Scene]] = {
    "arena": scene_arena.build,
    "littoral": scene_littoral.build,
    "handheld": scene_handheld.build,
    "rooms": scene_rooms.build,
    "corridor": scene_corridor.build,
    "people": scene_people.build,
    "glass": scene_glass.build,
    "offices": scene_offices.build,
}

SHORTEST = 3.0  # s of a recording


class Simulation:
    """A drive through one scenario; `items` may be called again and gives the same."""

    def __init__(self, scenario: ScenarioName, options: SceneOptions | None = None) -> None:
        self.options = options or SceneOptions()
        self.scene = _begun(SCENES[scenario](self.options), self.options.begin)

    @property
    def duration(self) -> float:
        """Seconds from the first measurement to the last."""
        return self.scene.motion.duration

    @property
    def extras(self) -> tuple[Extra, ...]:
        """What is carried besides laser, inertial unit and barometer."""
        return self.scene.extras if self.options.extras is None else self.options.extras

    def arrivals(self) -> Iterator[Arrival]:
        """(time of arrival [ns], measurement), by time of arrival."""
        motion = self.scene.motion
        streams = [
            sensors.truth(motion),
            sensors.laser_scans(self.scene, self.options),
            sensors.heights(motion, self.options),
        ]
        if self.options.imu:
            streams.append(sensors.inertial(motion, self.options))
        if "compass" in self.extras:
            streams.append(aids.compass(motion, self.options))
        if "gps" in self.extras:
            outage = self.options.gps_outage
            streams.append(aids.fixes(motion, self.options, self.scene.gps_outage if outage is None else outage))
        if "rangefinder" in self.extras:
            streams.append(aids.ground_distances(self.scene, self.options))
        return heapq.merge(*streams, key=lambda arrival: arrival[0])

    def items(self) -> Iterator[LaserScan | Imu | Aid | TruthPose]:
        """Every measurement in order of arrival."""
        return (item for _, item in self.arrivals())

    def truth_at(self, stamp_ns: int) -> Transform:
        """T_map_base at a time within the drive."""
        return self.scene.motion.transform((stamp_ns - sensors.START_NS) * 1e-9)


def _begun(scene: Scene, seconds: float) -> Scene:
    """The scene from its later start on; SimulationError if that lies too near to its end."""
    left = scene.motion.duration - seconds
    if left < SHORTEST:
        raise SimulationError(
            f"begin is {seconds:g} s, and the drive ends after {scene.motion.duration:g} s: leave {SHORTEST:g} s"
        )
    return scene.begun(seconds) if seconds else scene
