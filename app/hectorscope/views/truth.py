"""Where the robot really was, if the recording knows: dashed, carried into the map by its first pose."""

from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT
from hectorscope.page.viser_private import move
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._polyline import Polyline
from slam_core.geometry import yaw_quaternion


class TruthView:
    """A dashed line; the node that it hangs below carries truth into the map frame."""

    title = "Truth"
    rate = 5.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._root = scene.layer("truth", "Truth", colour="truth").root
        self._line = Polyline(
            scene.server.scene, self._root.name, SENT.truth, spacing=0.2, pixels=2.0, dashed=True
        )

    def draw(self, snapshot: Snapshot) -> None:
        """Show what was driven."""
        x, y, z, yaw = snapshot.truth_in_map
        move(self._root, (x, y, z), yaw_quaternion(yaw))
        self._line.draw(snapshot.truth[:, 1:4])


VIEW = TruthView
