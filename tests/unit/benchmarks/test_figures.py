"""The figures for slides: what is drawn lies where it is."""

import xml.etree.ElementTree as ET

import numpy as np

from benchmarks.figures import footprint, four_cells
from benchmarks.svg import Drawing, map_panel, sheet, with_lines
from hectorscope.run.map_image import MapImage
from hectorscope.simulation.worlds import box
from slam_core.reference.occupancy_grid import OccupancyGrid


def test_a_sheet_is_one_svg_with_every_caption():
    """Well formed, as slides want it, also with signs that XML reserves."""
    panels = [Drawing(100, 50, "<g/>", "(a) A < B"), Drawing(60, 80, "<g/>", "(b) & more")]
    root = ET.fromstring(sheet(panels))
    assert [text.text for text in root.iter("{http://www.w3.org/2000/svg}text")] == ["(a) A < B", "(b) & more"]
    assert float(root.attrib["width"]) >= 160


def test_lines_lie_on_the_map_where_their_metres_are():
    """The lower left corner of the map is that of the panel."""
    image = MapImage(0, 0.5, -2.0, 1.0, np.ones((10, 20), np.uint8), 1)
    drawing, frame = map_panel(image, "map")
    line = frame.path(np.array([[-2.0, 1.0], [8.0, 6.0]]), "red")
    assert f'points="0.0,{drawing.height:.1f} {drawing.width:.1f},0.0"' in line
    assert with_lines(drawing, line).content.endswith(line)


def test_the_footprint_of_a_box_is_its_four_sides():
    """Roofs have none, and the two triangles of a side are one line."""
    edges = footprint(box(0.0, 0.0, 2.0, 1.0, 0.0, 1.0))
    assert len(edges) == 4
    assert sorted(np.linalg.norm(b - a) for a, b in edges) == [1.0, 1.0, 2.0, 2.0]


def test_the_point_among_four_cells_has_the_value_of_the_reference():
    """What is written in figure 2 (a) is eq. (4)."""
    log_odds = np.array([[0.0, 0.0], [2.0, -2.0]])
    grid = OccupancyGrid(0.1, np.zeros(2, np.int64), log_odds)
    M, _ = grid.interpolate(np.array([[0.05 + 0.062, 0.05 + 0.04]]))
    assert f"M(Pm) = {M[0]:.2f}" in four_cells(grid).content
