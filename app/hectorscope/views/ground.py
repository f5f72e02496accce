"""The ground under it all: a metre grid, and where a new browser looks from."""

from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT
from hectorscope.session.snapshot import Snapshot

LOWER = -0.02  # metres: the grid lies below the finest level


class GroundView:
    """Thin lines every metre, thicker ones every five."""

    title = "Grid"
    rate = 0.1

    def __init__(self, scene: Scene) -> None:
        nodes = scene.server.scene
        root = scene.layer("grid", "Metre grid", on_floor=True).root.name
        nodes.add_grid(
            f"{root}/lines",
            infinite_grid=True,
            cell_color=SENT.grid,
            section_color=SENT.grid,
            cell_size=1.0,
            section_size=5.0,
            cell_thickness=0.6,
            section_thickness=1.0,
            fade_distance=120.0,
            shadow_opacity=0.0,
            position=(0.0, 0.0, LOWER),
        )
        nodes.configure_default_lights(enabled=False, cast_shadow=False)  # they wash colours out
        nodes.configure_environment_map(None)
        nodes.add_light_ambient("/light/ambient", intensity=2.0)
        nodes.add_light_directional("/light/sun", intensity=1.5, position=(-4.0, -6.0, 10.0))
        camera = scene.server.initial_camera
        camera.position, camera.look_at, camera.fov = (0.0, -22.0, 15.0), (0.0, 0.0, 0.0), 0.7

    def draw(self, snapshot: Snapshot) -> None:
        """Nothing of it changes."""


VIEW = GroundView
