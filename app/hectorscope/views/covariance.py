"""The covariance of each estimate: ellipses of match, prior and fused pose, ellipsoid of the position."""

from hectorscope.page.scene import Scene
from hectorscope.page.theme import SENT, for_line
from hectorscope.page.viser_private import move, resize
from hectorscope.session.snapshot import Snapshot
from hectorscope.views._shapes import disc, ellipse, ellipsoid, ring
from slam_core.results import PlanarGaussian, StepResult

TITLES = {"prior": "Prior", "match": "Match", "fused": "Fused"}  # drawn in this order, upwards
LIFT = 0.04  # metres over the floor, and between one ellipse and the next
SEE_THROUGH = 0.22


class CovarianceView:
    """Unit shapes whose scale and attitude change: a few bytes an update."""

    title = "Covariances"

    def __init__(self, scene: Scene) -> None:
        self._scene = scene
        self._ellipses = [_Ellipse(scene, key, LIFT * (1 + i)) for i, key in enumerate(TITLES)]
        root = scene.layer("position", "Position (3D)", colour="position", shown=False).root.name
        self._ellipsoid = scene.server.scene.add_icosphere(
            f"{root}/ellipsoid", radius=1.0, subdivisions=3, opacity=SEE_THROUGH, cast_shadow=False, visible=False,
            color=SENT.position,
        )  # fmt: skip
        self._drawn: object = None

    def draw(self, snapshot: Snapshot) -> None:
        """Scale them to the newest covariances."""
        display = self._scene.display
        state = (snapshot.sequence, display.ellipse_scale)
        if state == self._drawn:
            return
        self._drawn = state
        planes = gaussians(snapshot.result)
        for item in self._ellipses:
            item.draw(planes.get(item.key), display.ellipse_scale)
        self._draw_position(snapshot.result, display.ellipse_scale)

    def _draw_position(self, result: StepResult | None, sigmas: float) -> None:
        state = result.navigation if result else None
        self._ellipsoid.visible = state is not None
        if state is not None:
            scale, wxyz = ellipsoid(state.covariance[3:6, 3:6], sigmas)
            resize(self._ellipsoid, scale)
            move(self._ellipsoid, state.T_map_base.translation, wxyz)


def gaussians(result: StepResult | None) -> dict[str, PlanarGaussian]:
    """The planar estimates that this scan brought, by the name of their layer."""
    if result is None:
        return {}
    found = {
        "prior": result.prior,
        "match": result.match.gaussian if result.match else None,
        "fused": result.fused,
    }
    return {key: value for key, value in found.items() if value is not None}


class _Ellipse:
    """A see-through disc with a rim."""

    def __init__(self, scene: Scene, key: str, height: float) -> None:
        self.key = key
        nodes = scene.server.scene
        colour = getattr(SENT, key)
        root = scene.layer(key, TITLES[key], colour=key, on_floor=True).root.name
        self._frame = nodes.add_frame(f"{root}/pose", show_axes=False, visible=False)
        self._height = height
        self._rim = nodes.add_line_segments(
            f"{root}/pose/rim", ring(), for_line(colour), thickness=3.0, thickness_units="screen"
        )
        self._disc = nodes.add_mesh_simple(
            f"{root}/pose/disc",
            *disc(),
            color=colour,
            opacity=SEE_THROUGH,
            flat_shading=True,  # like the robot, and one side only: a browser compiles a program for each kind
            side="front",
            cast_shadow=False,
            receive_shadow=False,
        )

    def draw(self, gaussian: PlanarGaussian | None, sigmas: float) -> None:
        """Show `gaussian`, `sigmas` large."""
        self._frame.visible = gaussian is not None
        if gaussian is None:
            return
        scale, wxyz = ellipse(gaussian.covariance[:2, :2], sigmas)
        move(self._frame, (*gaussian.mean[:2], self._height), wxyz)
        resize(self._rim, scale)
        resize(self._disc, scale)


VIEW = CovarianceView
