"""The growing line: what is sent, and what is drawn in the end."""

import io

import numpy as np
import trimesh

from hectorscope.page.scene import Scene
from hectorscope.page.theme import for_line
from hectorscope.views._polyline import CHUNK, THIN, WIDE, Polyline

COLOUR = (1, 2, 3)


def straight(count: int, step: float = 0.1) -> np.ndarray:
    return np.column_stack([step * np.arange(count), np.zeros(count), np.zeros(count)])


def drawn(line: Polyline) -> np.ndarray:
    """Every segment of every node, without those of no length."""
    thin = [segments_of(node.glb_data) for node in line._thin]
    segments = np.concatenate([*thin, *(node.points for node in line._nodes)])
    return segments[np.any(segments[:, 0] != segments[:, 1], axis=1)]


def segments_of(glb: bytes) -> np.ndarray:
    """Of a glTF model, as another library reads it."""
    (path,) = trimesh.load_scene(io.BytesIO(glb), file_type="glb").geometry.values()
    return path.vertices.reshape(-1, 2, 3)


def test_chunks_make_one_line(scene: Scene) -> None:
    """However the rows arrive, the segments join without a gap from the first row to the last."""
    line, path = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0), straight(3 * CHUNK + 17)
    for rows in (1, 2, CHUNK, CHUNK + 1, CHUNK + 2, len(path)):
        line.draw(path[:rows])
    segments = drawn(line)
    assert np.allclose(segments[:, 0], path[:-1])
    assert np.allclose(segments[:, 1], path[1:])
    assert len(line._nodes) == 4


def test_only_the_last_chunk_is_sent_again(scene: Scene) -> None:
    """A row more leaves full chunks untouched."""
    line, path = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0), straight(2 * CHUNK + 9)
    line.draw(path[:-1])
    full = [node.points.copy() for node in line._nodes[:-1]]
    line.draw(path)
    assert all(np.array_equal(a, node.points) for a, node in zip(full, line._nodes, strict=False))


def test_the_beginning_of_a_long_line_is_few_thin_nodes(scene: Scene) -> None:
    """However it grew and was cut: its end is wide, and what did not change is not sent again."""
    line = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0)
    path = straight(3 * THIN + WIDE + 700)
    for rows in (
        10,
        THIN,
        THIN + 1,
        THIN + WIDE,
        2 * THIN + WIDE + 1,
        len(path),
        THIN - 5,
        2 * THIN + 3,
        len(path),
    ):
        line.draw(path[:rows])
        segments = drawn(line)
        assert np.allclose(segments[:, 0], path[: rows - 1], atol=1e-4)
        assert np.allclose(segments[:, 1], path[1:rows], atol=1e-4)
        assert sum(len(node.points) for node in line._nodes) >= min(WIDE, rows - 1)
    first = line._thin[0]
    assert (len(line._thin), len(line._nodes)) == (3, 4 + 3)
    line.draw(path[: 2 * THIN + WIDE + 9])
    assert line._thin[0] is first
    assert len(line._thin) == 2


def test_a_jump_back_ends_at_its_last_row(scene: Scene) -> None:
    """Also between two corners of a straight line, and while the robot stands."""
    line, path = (
        Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0, tolerance=0.01),
        straight(50),
    )
    path = np.concatenate([path, np.repeat(path[-1:], 50, axis=0)])
    line.draw(path)
    for rows in (80, 33, 2):
        line.draw(path[:rows])
        assert np.allclose(drawn(line)[[0, -1], [0, 1]], path[[0, rows - 1]])
    line.draw(path[:1])
    line.draw(path[:0])
    assert not line._nodes


def test_standing_still_adds_nothing(scene: Scene) -> None:
    """Poses closer than the spacing are left out."""
    line = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0)
    line.draw(straight(1000, step=1e-4))
    assert len(drawn(line)) == 1


def test_other_rows_begin_a_new_line(scene: Scene) -> None:
    """After a restart nothing of the old line is left, also when the new one is longer."""
    line = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0)
    line.draw(straight(CHUNK + 50))
    line.draw(straight(2 * CHUNK) + np.array([0, 5, 0]))
    assert (drawn(line)[:, :, 1] == 5).all()


def test_a_jump_within_a_run_keeps_the_common_part(scene: Scene) -> None:
    """Back, forward, and to rows that differ from one on: full chunks before that are not sent again."""
    line, path = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0), straight(4 * CHUNK)
    other = path + np.array([0.0, 1.0, 0.0]) * (np.arange(len(path)) >= 2 * CHUNK + 9)[:, None]
    line.draw(path)
    first, sent = line._nodes[0], line._nodes[0].points
    for rows in (path[: 3 * CHUNK], path[: CHUNK + 1], path, other, path[:1], other):
        if len(rows) == 1:
            assert line._nodes[0] is first
            assert first.points is sent
        line.draw(rows.copy())
        segments = drawn(line) if line._nodes else np.empty((0, 2, 3))
        assert np.allclose(segments[:, 0], rows[:-1])
        assert np.allclose(segments[:, 1], rows[1:])


def test_dashes_leave_out_every_second_segment(scene: Scene) -> None:
    """A dashed line draws half of it."""
    line = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0, dashed=True)
    line.draw(straight(21))
    assert len(drawn(line)) == 10


def test_all_chunks_have_the_colour(scene: Scene) -> None:
    """The first and those that follow, as the film curve needs it."""
    line = Polyline(scene.server.scene, "/line", COLOUR, spacing=0.05, pixels=1.0)
    line.draw(straight(CHUNK + 50))
    assert len(line._nodes) == 2
    assert all((node.colors == for_line(COLOUR)).all() for node in line._nodes)
