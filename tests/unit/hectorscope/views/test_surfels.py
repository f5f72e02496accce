"""When surfels are drawn, and what is sent of them."""

from dataclasses import replace

import numpy as np

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot
from hectorscope.views.surfels import SurfelsView
from tests.page import restarted, room_snapshot

SOME = np.uint32(10)  # beams, of a surfel in the middle of its cell


def with_surfels(snapshot: Snapshot, count: int = 3) -> Snapshot:
    """The finest level has surfels in some of its cells."""
    finest = snapshot.maps[0]
    words = np.zeros(finest.cells.shape, np.uint32)
    words[2, :count] = SOME | 63 << 13  # a normal along y
    return replace(snapshot, maps=(replace(finest, surfels=words), *snapshot.maps[1:]))


def asked(scene: Scene) -> None:
    """As after a browser has switched them on."""
    (layer,) = scene.layers
    scene.ask(layer)


def drawn(view: SurfelsView) -> int:
    """How many lines are on the page."""
    return len(view._lines.points) if view._lines is not None and view._lines.visible else 0


def test_nothing_is_sent_until_somebody_asks(scene: Scene) -> None:
    """Off at first; switched on the lines are there at once, though the map did not change."""
    view, snapshot = SurfelsView(scene), with_surfels(room_snapshot())
    view.draw(snapshot)
    assert view._lines is None
    asked(scene)
    view.draw(snapshot)
    assert drawn(view) == 3


def test_the_lines_follow_the_map(scene: Scene) -> None:
    """More of them, another run without any, and none where there is no map."""
    view, snapshot = SurfelsView(scene), with_surfels(room_snapshot())
    asked(scene)
    counts = []
    more = with_surfels(replace(snapshot, maps=tuple(replace(m, revision=2) for m in snapshot.maps)), 5)
    for each in (Snapshot(), snapshot, more, restarted(snapshot)):
        view.draw(each)
        counts.append(drawn(view))
    assert counts == [0, 3, 5, 0]


def test_they_lie_where_their_cells_are(scene: Scene) -> None:
    """Across the cells of the third row, from the map's corner on."""
    view, snapshot = SurfelsView(scene), with_surfels(room_snapshot())
    asked(scene)
    view.draw(snapshot)
    assert view._lines is not None
    finest = snapshot.maps[0]
    points = np.asarray(view._lines.points)
    assert np.allclose(points[:, :, 1], finest.y + 2.5 * finest.resolution, atol=1e-5)
    x = np.sort(points[:, :, 0], axis=1)
    assert np.allclose(x, finest.x + finest.resolution * np.array([[0, 1], [1, 2], [2, 3]]), atol=1e-5)
