"""What of the matcher is drawn in the scene of one browser alone: beams, heat map, surface, and the handle."""

import math
from collections.abc import Callable
from typing import Any

import numpy as np
import viser
from viser import TransformControlsEvent

from hectorscope.page.theme import SENT, for_lines
from hectorscope.panels._xray_shown import Dots, Heat, Shown
from slam_core.geometry import heading, yaw_quaternion
from slam_core.measurements import Float64s

HANDLE = "/floor/xray_start"
HANDLE_PIXELS = 80.0  # from its middle to the tip of an arrow
LIFT = 0.04  # metres over the plane of a level
WITHIN = 1e4  # metres from the map's start
EVERY = 3  # lines of the surface: so many poses apart

Moved = Callable[[Float64s], None]


class ClientScene:
    """Nodes of one browser. moved: hears the pose (3,) to which the start was dragged."""

    def __init__(self, client: viser.ClientHandle, moved: Moved) -> None:
        self._scene, self._moved = client.scene, moved
        self._nodes: dict[str, list[Any]] = {"dots": [], "heat": []}
        self._drawn: dict[str, object] = {"dots": None, "heat": None}
        self._handle: viser.TransformControlsHandle | None = None

    def draw(self, shown: Shown) -> None:
        """Bring the nodes up to date; what is the same object as before stays."""
        for name, value, make in (("dots", shown.dots, self._dots), ("heat", shown.heat, self._heat)):
            if value is not self._drawn[name]:
                before, self._nodes[name] = self._nodes[name], make(value) if value else []
                self._drawn[name] = value
                made = {node.name for node in self._nodes[name]}
                for node in before:
                    if node.name not in made:  # one of the same name has taken its place
                        node.remove()
        self._place_handle(shown.handle)

    def clear(self) -> None:
        """Nothing is shown any more."""
        self.draw(Shown(""))

    def _dots(self, dots: Any) -> list[Any]:
        made: Dots = dots
        root = f"/floor/map/level{made.level}/xray"
        nodes: list[Any] = []
        if len(made.points):
            points = np.column_stack([made.points, np.full(len(made.points), LIFT)]).astype(np.float32)
            nodes.append(
                self._scene.add_point_cloud(
                    f"{root}/points",
                    points,
                    made.colours,
                    point_size=made.size,
                    point_shape="circle",
                    precision="float32",
                )
            )
        if len(made.lines):
            lines = np.full((len(made.lines), 2, 3), LIFT, np.float32)
            lines[..., :2] = made.lines
            colours = np.repeat(for_lines(made.colours)[:, None], 2, axis=1)
            nodes.append(
                self._scene.add_line_segments(
                    f"{root}/gradients", lines, colours, thickness=1.5, thickness_units="screen"
                )
            )
        return nodes

    def _heat(self, heat: Any) -> list[Any]:
        made: Heat = heat
        root = f"/floor/map/level{made.level}/xray"
        width, height = made.size
        place = (float(made.centre[0]), float(made.centre[1]), 0.6 * LIFT)
        image = self._scene.add_image(
            f"{root}/heat", made.picture, width, height, format="png", cast_shadow=False, receive_shadow=False,
            position=place,
        )  # fmt: skip
        nodes: list[Any] = [image]
        if made.heights is not None:
            points, colours = surface(made)
            nodes.append(
                self._scene.add_line_segments(
                    f"{root}/surface", points, for_lines(colours), thickness=1.2, thickness_units="screen"
                )
            )
        return nodes

    def _place_handle(self, start: Float64s | None) -> None:
        if start is None:
            if self._handle is not None:
                self._handle.remove()
                self._handle = None
            return
        if self._handle is None:
            self._handle = self._scene.add_transform_controls(
                HANDLE,
                scale=HANDLE_PIXELS,
                fixed=True,
                line_width=4.0,
                active_axes=(True, True, False),
                depth_test=False,
            )
            self._handle.on_update(self._dragged)
        if not np.allclose(pose_of(self._handle), start, atol=1e-9):
            self._handle.position = (float(start[0]), float(start[1]), LIFT)
            self._handle.wxyz = yaw_quaternion(float(start[2]))

    async def _dragged(self, event: TransformControlsEvent) -> None:
        pose = pose_of(event.target)
        if np.isfinite(pose).all() and np.abs(pose[:2]).max() < WITHIN:
            self._moved(pose)


def pose_of(handle: viser.TransformControlsHandle) -> Float64s:
    """(3,) x, y, psi of the handle."""
    x, y, _ = (float(v) for v in handle.position)
    q = np.asarray(handle.wxyz, np.float64)
    size = float(np.linalg.norm(q))
    psi = heading(q / size) if size > 0.0 else math.nan
    return np.array([x, y, psi])


def surface(heat: Heat) -> tuple[np.ndarray, np.ndarray]:
    """The lines (m, 2, 3) of the surface over a heat map, and their colours (m, 2, 3)."""
    assert heat.heights is not None
    rows, columns = heat.heights.shape
    ys, xs = (
        c + s * (np.arange(n) + 0.5 - n / 2) / n
        for c, s, n in zip(heat.centre[::-1], heat.size[::-1], (rows, columns), strict=True)
    )
    grid = np.dstack([*np.meshgrid(xs, ys), heat.heights]).astype(np.float32)
    rise = heat.heights - heat.heights.min()
    shares = (rise / max(float(rise.max()), 1e-12)).astype(np.float32)
    colours = SENT.residual_colours(shares.ravel()).reshape(rows, columns, 3)  # seen on the heat map too
    pairs = [(each[::EVERY, :-1], each[::EVERY, 1:]) for each in (grid, colours)]
    ups = [(each[:-1, ::EVERY], each[1:, ::EVERY]) for each in (grid, colours)]
    lines, shades = (
        np.concatenate([np.stack(ends, axis=2).reshape(-1, 2, 3) for ends in (pairs[i], ups[i])]) for i in (0, 1)
    )
    return lines, shades
