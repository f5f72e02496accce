"""Remakes figures 2, 3, 5 and 6 of the paper from recordings of ours, as SVG and PNG for slides.

    python -m benchmarks.figures --out DIR [--only 3]

figure 2: interpolation between four cells of a map, and the derivatives that eqs. (4)-(6) give. figure 3: the
levels of one map. figure 5: maps of a rescue arena and of a shore. figure 6: maps with the truth over them.
A PNG is the SVG as Chromium draws it.
"""

import argparse
from collections.abc import Callable
from functools import cache
from pathlib import Path

import numpy as np
from playwright.sync_api import sync_playwright

from benchmarks.svg import (
    PANEL,
    TRAVELLED,
    TRUE,
    Drawing,
    diverging,
    grey,
    label,
    map_panel,
    pixels,
    sheet,
    with_lines,
)
from hectorscope.cli.opening import demo_bag
from hectorscope.inputs import SourceOptions
from hectorscope.run.headless import run_headless
from hectorscope.run.map_images import map_images
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.settings import Settings
from hectorscope.run.warmup import load_everything
from hectorscope.simulation import ScenarioName, Simulation
from hectorscope.sources import open_source
from slam_core.config import SlamConfig, with_values
from slam_core.measurements import Float64s
from slam_core.reference.occupancy_grid import OccupancyGrid
from tests.conftest import FLAGS, chromium_path
from tests.sources import MemoryRecording

NEAR, SIDE = 8, 20  # cells: around one that is looked at, and of the patch of figure 2


@cache
def demo(scene: str, resolution: float = 0.05) -> Pipeline:
    """A recording that comes with the program, run to its end."""
    settings = Settings(with_values(SlamConfig(), {"map.resolution": resolution}))
    return run_headless(open_source(str(demo_bag(scene)), SourceOptions()), settings)[0]  # type: ignore[arg-type]


@cache
def simulated(scenario: ScenarioName) -> tuple[Pipeline, Simulation]:
    """A drive of the simulator, and itself, which knows the walls."""
    drive = Simulation(scenario)
    return run_headless(MemoryRecording(list(drive.items())), Settings())[0], drive


def patch() -> OccupancyGrid:
    """A wall's end in the arena, as the reference has a map."""
    pyramid = demo("arena").slam.map
    row0, row1, column0, column1 = pyramid.bounds(0)
    log_odds = pyramid.gather(0, (row0, row1, column0, column1), "log_odds").astype(float)
    busiest = np.unravel_index(np.argmax(_busy(log_odds > 2.0)), log_odds.shape)
    row, column = (
        int(np.clip(at - SIDE // 2, 0, n - SIDE)) for at, n in zip(busiest, log_odds.shape, strict=True)
    )
    corner = np.array([column0 + column, row0 + row])
    return OccupancyGrid(pyramid.levels[0].resolution, corner, log_odds[row : row + SIDE, column : column + SIDE])


def _busy(occupied: np.ndarray) -> Float64s:
    """How many changes from free to occupied each cell has around it."""
    edges = np.zeros(occupied.shape)
    edges[1:] += occupied[1:] != occupied[:-1]
    edges[:, 1:] += occupied[:, 1:] != occupied[:, :-1]
    window = np.ones(2 * NEAR)
    for axis in (0, 1):
        edges = np.apply_along_axis(np.convolve, axis, edges, window, "same")
    return edges


def figure2() -> list[Drawing]:
    """(a) A point among four cells. (b) The probabilities, and their derivatives."""
    grid = patch()
    fine = 8
    rows, columns = grid.log_odds.shape
    steps = ((np.arange(fine * (columns - 1)) + 0.5) / fine + 0.5) * grid.resolution
    x, y = np.meshgrid(steps, steps[: fine * (rows - 1)])
    places = np.column_stack((x.ravel(), y.ravel())) + grid.corner * grid.resolution
    M, gradient = grid.interpolate(places)
    shape = x.shape
    shown = [(M.reshape(shape), "M between the cells, eq. (4)")]
    shown += [(gradient[:, k].reshape(shape), f"∂M/∂{'xy'[k]}, eq. ({5 + k})") for k in (0, 1)]
    drawn = [four_cells(grid)]
    for k, (values, caption) in enumerate(shown):
        colours = grey(values) if k == 0 else diverging(values)
        content, width, height = pixels(colours, PANEL)
        drawn.append(Drawing(width, height, content, f"({'bcd'[k]}) {caption}"))
    return drawn


def four_cells(grid: OccupancyGrid) -> Drawing:
    """The four cells with the steepest slope between them, a point, its M and gradient."""
    P = grid.probability
    slope = np.abs(P[:-1, 1:] - P[:-1, :-1]) + np.abs(P[1:, :-1] - P[:-1, :-1])
    row, column = np.unravel_index(np.argmax(slope), slope.shape)
    u, v = 0.62, 0.4
    point = (np.array([column, row]) + grid.corner + 0.5 + (u, v)) * grid.resolution
    M, gradient = grid.interpolate(np.array([point], np.float64))
    far, near = 340.0, 80.0
    words = []
    for i in (0, 1):
        for j in (0, 1):
            x, y = (near, far)[i], (far, near)[j]
            words.append(f'<circle cx="{x}" cy="{y}" r="7" fill="#18202c"/>')
            words.append(label(x, y - 16, f"M(P{i}{j}) = {P[row + j, column + i]:.2f}"))
    x, y = near + u * (far - near), far - v * (far - near)
    dx, dy = 60.0 * gradient[0] / max(1e-9, float(np.linalg.norm(gradient[0])))
    grid_lines = "".join(
        f'<path d="M{at} 40V380M40 {at}H380" stroke="#9aa3b0" stroke-width="1.5"/>' for at in (near, far)
    )
    arrow = f'<path d="M{x} {y}l{dx:.1f} {-dy:.1f}" stroke="{TRAVELLED}" stroke-width="3"/>'
    value = label(x, y - 18 if gradient[0, 1] <= 0 else y + 28, f"M(Pm) = {M[0]:.2f}", TRAVELLED)
    dot = f'<circle cx="{x}" cy="{y}" r="6" fill="{TRAVELLED}"/>'
    content = grid_lines + "".join(words) + arrow + dot + value
    return Drawing(PANEL, PANEL, content, "(a) a point among four cells, and its gradient")


def figure3() -> list[Drawing]:
    """The levels of the arena's map, coarsest first."""
    levels = map_images(demo("arena").slam.map)[::-1]
    names = (f"({'abc'[k]}) {round(100 * each.resolution)} cm" for k, each in enumerate(levels))
    return [map_panel(each, name)[0] for each, name in zip(levels, names, strict=True)]


def figure5() -> list[Drawing]:
    """Arena and shore, with the way of the robot."""
    drawn = []
    for scene, resolution, caption in (
        ("arena", 0.05, "(a) a rescue arena, cells of 5 cm"),
        ("littoral", 0.25, "(b) a shore, cells of 25 cm"),
    ):
        pipeline = demo(scene, resolution)
        drawing, frame = map_panel(map_images(pipeline.slam.map)[0], caption)
        drawn.append(with_lines(drawing, frame.path(pipeline.trajectory[::20, 1:3], TRAVELLED)))
    return drawn


def figure6() -> list[Drawing]:
    """Maps with the true walls over them, the way and the true way."""
    drawn = []
    scenes: tuple[tuple[ScenarioName, str], ...] = (
        ("handheld", "(a) carried by hand, a large loop"),
        ("rooms", "(b) driven through rooms"),
    )
    for scenario, caption in scenes:
        pipeline, drive = simulated(scenario)
        drawing, frame = map_panel(map_images(pipeline.slam.map)[0], caption)
        walls = [frame.path(edge, TRUE, 0.8) for edge in footprint(drive.scene.world.triangles)]
        way = frame.path(pipeline.trajectory[::20, 1:3], TRAVELLED)
        inside = f'<rect width="{drawing.width:.0f}" height="{drawing.height:.0f}"/>'
        clip = f'<clipPath id="{scenario}">{inside}</clipPath>'
        lines = f'<g clip-path="url(#{scenario})" opacity="0.8">{"".join(walls)}{way}</g>'
        drawn.append(with_lines(drawing, clip + lines))
    return drawn


def footprint(triangles: Float64s) -> list[Float64s]:
    """Where upright triangles stand, each line once: (2, 2) metres."""
    a, b, c = triangles.transpose(1, 0, 2)
    normals = np.cross(b - a, c - a)
    upright = np.abs(normals[:, 2]) < 1e-6 * np.linalg.norm(normals, axis=1)
    flat = triangles[upright][:, :, :2]
    edges = {tuple(map(tuple, np.round(np.unique(each, axis=0)[[0, -1]], 3).tolist())) for each in flat}
    return [np.array(edge) for edge in sorted(edges)]


FIGURES: dict[str, Callable[[], list[Drawing]]] = {"2": figure2, "3": figure3, "5": figure5, "6": figure6}


def write(folder: Path, wanted: list[str]) -> list[Path]:
    """The files that were written."""
    written = []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=FLAGS)
        page = browser.new_page(device_scale_factor=2)
        for number in wanted:
            svg, png = folder / f"figure{number}.svg", folder / f"figure{number}.png"
            svg.write_text(sheet(FIGURES[number]()), encoding="utf-8")
            page.set_content(f'<body style="margin:0">{svg.read_text(encoding="utf-8")}</body>')
            page.locator("svg").screenshot(path=png)
            written += [svg, png]
        browser.close()
    return written


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--out", type=Path, required=True)
    parser.add_argument("--only", choices=sorted(FIGURES), help="one figure")
    chosen = parser.parse_args()
    chosen.out.mkdir(parents=True, exist_ok=True)
    load_everything()
    for path in write(chosen.out, [chosen.only] if chosen.only else sorted(FIGURES)):
        print(path)


if __name__ == "__main__":
    main()
