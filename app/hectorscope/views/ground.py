"""The ground under it all: a metre grid, and where a new browser looks from."""

from hectorscope.page.scene import Scene
from hectorscope.page.theme import Theme
from hectorscope.session.snapshot import Snapshot

LOWER = -0.02  # metres: the grid lies below the finest level


class GroundView:
    """Thin lines every metre, thicker ones every five."""

    title = "Grid"
    rate = 2.0

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        nodes = scene.server.scene
        root = scene.layer("grid", "Metre grid", on_floor=True).root.name
        self._grid = nodes.add_grid(
            f"{root}/lines",
            infinite_grid=True,
            cell_size=1.0,
            section_size=5.0,
            cell_thickness=0.6,
            section_thickness=1.0,
            fade_distance=120.0,
            shadow_opacity=0.0,
            position=(0.0, 0.0, LOWER),
        )
        self._theme: Theme | None = None
        nodes.configure_default_lights(enabled=False, cast_shadow=False)  # they wash colours out
        nodes.configure_environment_map(None)
        nodes.add_light_ambient("/light/ambient", intensity=2.0)
        nodes.add_light_directional("/light/sun", intensity=1.5, position=(-4.0, -6.0, 10.0))
        camera = scene.server.initial_camera
        camera.position, camera.look_at, camera.fov = (0.0, -22.0, 15.0), (0.0, 0.0, 0.0), 0.7

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the theme."""
        theme = self._scene.theme
        if theme is self._theme:
            return
        self._theme = theme
        with self._scene.server.atomic():
            self._grid.cell_color = self._grid.section_color = theme.grid


VIEW = GroundView
