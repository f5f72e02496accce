"""Looking at the scene of an open page: where a point is in the window, which colour it has, where nodes are."""

import io
from collections.abc import Callable
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import Page

# The scene's point x, y, z (metres, map frame, over the floor) in pixels of the window.
PROJECT = """([x, y, z]) => {
  const page = window.__viserMutable, apply = (m, [x, y, z, w]) => [0, 1, 2, 3].map(
    (i) => m.elements[i] * x + m.elements[4 + i] * y + m.elements[8 + i] * z + m.elements[12 + i] * w);
  const world = apply(page.nodeRefFromName['/floor'].matrixWorld, [x, y, z, 1]);
  const clip = apply(page.camera.projectionMatrix, apply(page.camera.matrixWorldInverse, world));
  const box = page.canvas.getBoundingClientRect();
  return [box.left + (clip[0] / clip[3] + 1) / 2 * box.width, box.top + (1 - clip[1] / clip[3]) / 2 * box.height];
}"""
# Neither on its way to an angle nor moved of late, by the clock and by frames, which are slow on a busy machine.
RESTS = """(({goal, moved, still}) => goal === null && still > 3 && performance.now() - moved > 250)(
  window.hectorscope.cameraState())"""


LOOKS, LOOK_MS = 40, 125


def look(page: Page, mode: str) -> None:
    """Point the camera and wait until it rests."""
    page.evaluate(f"window.hectorscope.camera('{mode}')")
    page.wait_for_function(RESTS)


def choose_own(page: Page, **choices: Any) -> None:
    """Choose what this browser has for itself (static/browser.js)."""
    for name, value in choices.items():
        page.evaluate("([name, value]) => window.hectorscope.own.set(name, value)", [name, value])


def pixel(page: Page, x: float, y: float, z: float = 0.0) -> tuple[int, ...]:
    """The colour that the window shows at a point of the scene."""
    column, row = page.evaluate(PROJECT, [x, y, z])
    shot = page.screenshot(clip={"x": round(column) - 1, "y": round(row) - 1, "width": 3, "height": 3})
    return tuple(np.asarray(Image.open(io.BytesIO(shot)).convert("RGB"))[1, 1].tolist())


def wait_for_pixel(
    page: Page, place: tuple[float, ...], wanted: Callable[[tuple[int, ...]], bool]
) -> tuple[int, ...]:
    """The colour at a point of the scene, once it is the wanted one or has not become so: pictures are decoded
    and drawn after they arrive.
    """
    for _ in range(LOOKS):
        seen = pixel(page, *place)
        if wanted(seen):
            break
        page.wait_for_timeout(LOOK_MS)
    return seen


def is_near(seen: tuple[int, ...], colour: tuple[int, ...], tolerance: int = 12) -> bool:
    """Whether two colours are the same but for rounding and blending at the edge."""
    return max(abs(a - b) for a, b in zip(seen, colour, strict=True)) <= tolerance


def node(page: Page, name: str) -> dict[str, Any] | None:
    """Position and visibility of a scene node; None when the page has none of that name."""
    script = """(name) => {
      const node = window.__viserMutable.nodeRefFromName[name];
      return node ? {position: node.position.toArray(), visible: node.visible} : null;
    }"""
    found: dict[str, Any] | None = page.evaluate(script, name)
    return found


def names(page: Page) -> set[str]:
    """Every node of the scene."""
    found: list[str] = page.evaluate("Object.keys(window.__viserMutable.nodeRefFromName)")
    return set(found)
