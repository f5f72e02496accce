"""The robot: a small body with a nose, tilted as estimated, and its outline on the floor."""

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT, for_line
from hectorscope.page.viser_private import move
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._shapes import prism, ring
from slam_core.geometry import heading, yaw_quaternion

HULL = np.array([[-0.3, -0.2], [0.1, -0.2], [0.36, 0.0], [0.1, 0.2], [-0.3, 0.2]])  # metres, nose at +x
LASER = 0.07 * ring(16)[:, 0, :2] + np.array([0.08, 0.0])
LIFT = 0.02  # metres over the floor
LASER_COLOUR = (40, 44, 52)


class RobotView:
    """Body and laser in base_link, a ring in base_footprint."""

    title = "Robot"

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        nodes = scene.server.scene
        self._body = scene.layer("robot", "Robot", colour="robot", more=(f"{scene.floor.name}/footprint",)).root
        name = self._body.name
        self._hull = nodes.add_mesh_simple(
            f"{name}/hull", *prism(HULL, 0.0, 0.16), flat_shading=True, visible=False, color=SENT.robot
        )
        nodes.add_mesh_simple(
            f"{name}/hull/laser", *prism(LASER, 0.16, 0.26), flat_shading=True, color=LASER_COLOUR
        )
        self._ring = nodes.add_line_segments(
            f"{scene.floor.name}/footprint", ring(32) * 0.45, for_line(SENT.robot), thickness=2.0,
            thickness_units="screen", visible=False,
        )  # fmt: skip
        self._drawn = -1

    def draw(self, snapshot: Snapshot) -> None:
        """Move it to the newest pose."""
        result = snapshot.result
        if snapshot.sequence == self._drawn:
            return
        self._drawn = snapshot.sequence
        self._hull.visible = self._ring.visible = result is not None
        if result is not None:
            T = result.T_map_base
            move(self._body, T.translation, T.rotation)
            move(self._ring, (*T.translation[:2], LIFT), yaw_quaternion(heading(T.rotation)))


VIEW = RobotView
