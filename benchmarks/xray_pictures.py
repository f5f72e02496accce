"""Pictures of what happens inside the matcher, for `benchmarks.screenshots`."""

import io
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from PIL import Image
from playwright.sync_api import Page

COLOURS = 200  # of a picture of the documents, which keeps it small
NEAR = 10.0  # metres from the camera to the robot
CLOSE, CLOSER = 5.0, 2.0
ZOOM = """(distance) => {
  const { cameraControl: camera, nodeRefFromName: nodes } = window.__viserMutable;
  const { x, y, z } = nodes["/robot"].position.clone().setFromMatrixPosition(nodes["/robot"].matrixWorld);
  camera.moveTo(x, y, z, false);
  camera.dollyTo(distance, false);
}"""
WANT = "(wanted) => Object.entries(wanted).forEach(([name, value]) => window.hectorscope.xray.want(name, value))"
PATIENCE_MS = 120_000


@dataclass(frozen=True)
class Inside:
    """A laboratory with its choices. says: words on its card once all of it is there. mode: of the camera."""

    name: str
    says: str
    wanted: dict[str, Any] = field(default_factory=dict)
    mode: str = "top"
    distance: float = NEAR


INSIDES = (
    Inside("steps", "Level 2", {"lab": "steps", "step": 0}),
    Inside("landscape", "lowest (7)", {"lab": "landscape", "show": "surface"}, "free", CLOSE),
    Inside("basin", "3721 of 3721", {"lab": "landscape", "show": "basin", "span": 2.0}),
    Inside("lens", "equation", {"lab": "lens", "at": [0, 7.0, 1.835]}, distance=CLOSER),
    Inside("covariance", "cloud of 400", {"lab": "covariance", "omega": 0.3}),
    Inside("places", "Open water · 139 beams · cloud of 400", {"lab": "covariance", "of": "places"}),
    Inside("attitude", "by a quaternion", {"lab": "attitude", "pitch": 1.309}),
)


def pictures(page: Page, taken: Callable[[Page], bytes], folder: Path, only: str = "") -> Iterator[Path]:
    """One of each laboratory, of a page at rest. taken: makes a picture of the page once it stands still."""
    page.keyboard.press("i")
    for inside in INSIDES:
        if only not in f"xray-{inside.name}":
            continue
        page.evaluate(WANT, inside.wanted)
        page.evaluate("(mode) => window.hectorscope.camera(mode)", inside.mode)
        page.locator(".hs-xray-words", has_text=inside.says).wait_for(timeout=PATIENCE_MS)
        page.wait_for_function("window.hectorscope.cameraState().goal === null", timeout=PATIENCE_MS)
        page.mouse.move(300, 300)
        page.mouse.wheel(0, 1)  # a hand on the camera: it no longer keeps the whole map in view
        page.evaluate(ZOOM, inside.distance)
        target = folder / f"xray-{inside.name}.png"
        target.write_bytes(small(taken(page)))
        yield target


def small(png: bytes) -> bytes:
    """The picture with few colours."""
    out = io.BytesIO()
    Image.open(io.BytesIO(png)).convert("RGB").quantize(COLOURS).save(out, "PNG", optimize=True)
    return out.getvalue()
