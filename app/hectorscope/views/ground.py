"""The ground under it all: a metre grid, and where a new browser looks from."""

from hectorscope.page.scene import Stage
from hectorscope.page.theme import Theme
from hectorscope.session.snapshot import Snapshot

LOWER = -0.02  # metres: the grid lies below the finest level


class GroundView:
    """Thin lines every metre, thicker ones every five."""

    title = "Grid"
    rate = 2.0

    def __init__(self, stage: Stage) -> None:
        self._stage = stage
        scene = stage.server.scene
        root = stage.layer("grid", "Metre grid", on_floor=True).root.name
        self._grid = scene.add_grid(
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
        scene.configure_default_lights(enabled=False, cast_shadow=False)  # they wash colours out
        scene.configure_environment_map(None)
        scene.add_light_ambient("/light/ambient", intensity=2.0)
        scene.add_light_directional("/light/sun", intensity=1.5, position=(-4.0, -6.0, 10.0))
        camera = stage.server.initial_camera
        camera.position, camera.look_at, camera.fov = (0.0, -22.0, 15.0), (0.0, 0.0, 0.0), 0.7

    def draw(self, snapshot: Snapshot) -> None:
        """Follow the theme."""
        theme = self._stage.theme
        if theme is self._theme:
            return
        self._theme = theme
        with self._stage.server.atomic():
            self._grid.cell_color = self._grid.section_color = theme.grid


VIEW = GroundView
