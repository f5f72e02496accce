"""The frames of REP-105 and REP-120: map, base_footprint, base_stabilized, base_link."""

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.page.viser_private import move
from hectorscope.session.snapshot import Snapshot
from slam_core.geometry import split_heading, yaw_quaternion

LENGTH = 0.9  # metres of an axis of the footprint; the frames above it have shorter, thicker ones
SHAPES = {"base_footprint": (1.0, 0.012), "base_stabilized": (0.8, 0.02), "base_link": (0.6, 0.035)}


class FramesView:
    """base_footprint on the floor, base_stabilized above it at the robot's height, base_link tilted in it."""

    title = "Frames"

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        nodes, layer = scene.server.scene, scene.layer("frames", "Frames")
        nodes.add_frame(f"{layer.root.name}/map", axes_length=1.0, axes_radius=0.02)
        self._frames = {
            name: nodes.add_frame(
                f"{layer.root.name}/{name}", axes_length=LENGTH * share, axes_radius=radius, visible=False
            )
            for name, (share, radius) in SHAPES.items()
        }
        self._drawn = -1

    def draw(self, snapshot: Snapshot) -> None:
        """Move them to the newest pose; there is none after a restart."""
        result = snapshot.result
        if snapshot.sequence == self._drawn:
            return
        self._drawn = snapshot.sequence
        if result is None:
            for frame in self._frames.values():
                frame.visible = False
            return
        position = result.T_map_base.translation
        psi, _ = split_heading(result.T_map_base.rotation)
        level = yaw_quaternion(psi)
        poses = {
            "base_footprint": (np.array([*position[:2], self._scene.floor.position[2]]), level),
            "base_stabilized": (position, level),
            "base_link": (position, result.T_map_base.rotation),
        }
        for name, frame in self._frames.items():
            frame.visible = True
            move(frame, *poses[name])


VIEW = FramesView
