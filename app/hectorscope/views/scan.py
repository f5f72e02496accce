"""The scan where it was matched: endpoints coloured by how badly they fit the map, and what is new to it."""

import numpy as np

from hectorscope.page.scene import Display, Scene
from hectorscope.page.theme import SENT
from hectorscope.page.viser_private import move
from hectorscope.session.snapshot import Snapshot
from slam_core.config import ScanConfig
from slam_core.geometry import transform_points
from slam_core.results import StepResult

LIFT = 0.03  # metres over the floor
SIZE = 0.06  # metres; seen from far, the page keeps them a few pixels wide
UNKNOWN = 0.5  # residual of a first scan, which was matched to nothing


class ScanView:
    """A point cloud turned into the map: its node takes the place, so the points need half precision only.

    A busy browser moves a node at once and draws its points later. Were it to turn the node, far ends would lie
    beside their walls meanwhile, whenever the robot turns.
    """

    title = "Scan"

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        layer = scene.layer("scan", "Scan", on_floor=True)
        self._frame = layer.root
        self._cloud = scene.server.scene.add_point_cloud(
            f"{layer.root.name}/points",
            np.zeros((1, 3), np.float32),
            np.zeros((1, 3), np.uint8),
            point_size=SIZE,
            point_shape="circle",
            precision="float16",
            visible=False,
        )
        self._drawn: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Send a new scan, or the same one in other colours."""
        display, result = self._scene.display, snapshot.result
        state = (snapshot.epoch, result.index if result else None, display.points)
        if state == self._drawn:
            return
        self._drawn = state
        if result is None:
            self._cloud.visible = False
            return
        points = np.zeros((len(result.points), 3), np.float16)
        points[:, :2] = transform_points(np.array([0.0, 0.0, result.planar[2]]), result.points)
        colours = point_colours(result, display, snapshot.config.scan)
        self._cloud.visible = True
        self._cloud.points = points
        self._cloud.colors = colours
        move(self._frame, (*result.planar[:2], LIFT))


def point_colours(result: StepResult, display: Display, config: ScanConfig) -> np.ndarray:
    """(n, 3) uint8, by residual or by height between the filter's limits, or all alike.

    By residual, beams that end where the map knows free space have a colour of their own: new, or on the move.
    """
    theme, count = SENT, len(result.points)
    if display.points == "height":
        span = max(config.z_max - config.z_min, 1e-6)
        return theme.residual_colours((result.heights - config.z_min) / span)
    if display.points == "residual":
        residuals = result.match.residuals if result.match else np.full(count, UNKNOWN, np.float32)
        colours = theme.residual_colours(residuals)
        colours[result.unexpected] = theme.unexpected
        return colours
    return np.tile(np.array(theme.accent, np.uint8), (count, 1))


VIEW = ScanView
