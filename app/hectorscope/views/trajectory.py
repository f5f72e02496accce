"""Where the robot was, as estimated at the time."""

from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._polyline import Polyline


class TrajectoryView:
    """A line through the fused positions."""

    title = "Trajectory"
    rate = 10.0

    def __init__(self, scene: Scene) -> None:
        root = scene.layer("trajectory", "Trajectory", colour="trajectory").root.name
        self._line = Polyline(scene.server.scene, root, SENT.trajectory, spacing=0.03, tolerance=0.005, pixels=2.5)

    def draw(self, snapshot: Snapshot) -> None:
        """Show what was driven."""
        self._line.draw(snapshot.trajectory[:, 1:4])


VIEW = TrajectoryView
