"""A recording that is broken on purpose, and a sweep that finds settings which hold.

    python -m benchmarks.sweeps.shaken [--search 50] [--folder DIR] [--write]

The arena with an inertial unit beside a motor that starts after half a minute: from then on every sample has noise
of 20 m/s^2 and 0.5 rad/s. The search has no truth to go by: its target is the consistency score. --folder keeps
the sweep, which then goes on the next time. --write keeps the outcome in docs/sweeps.md, with pictures of the page
and of the maps of the defaults and of what was found.
"""

import argparse
import base64
import io
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image
from playwright.sync_api import ViewportSize, sync_playwright
from rosbags.rosbag1 import Reader, Writer
from rosbags.typesys import Stores, get_typestore

from benchmarks.sweeps.marks import fill
from benchmarks.tables import table
from hectorscope.cli.opening import demo_bag
from hectorscope.sweep.executors import executor
from hectorscope.sweep.limits import Limits
from hectorscope.sweep.plan import product
from hectorscope.sweep.ranking import cost
from hectorscope.sweep.search import quasi_random
from hectorscope.sweep.spec import RunSpec
from hectorscope.sweep.sweep import sweep
from hectorscope.sweep.table import Row, Table, read_details
from hectorscope.sweep.vary import parse
from hectorscope.web.sweep_server import SweepServer
from tests.conftest import ROOT, chromium_path

SHAKE, TURN = 20.0, 0.5  # m/s^2, rad/s: standard deviations of what is added to every sample
AFTER_S = 30.0
SEARCH, SEED = 50, 1
VARY = (
    "navigation.accel_noise=0.001:1:log",
    "navigation.gyro_noise=0.0001:0.1:log",
    "fusion.omega=0.005:0.5:log",
    "matcher.sigma=0.05:1:log",
)
SCORE, TRUTH = "consistency", "truth.aligned_rmse_m"
SIZE: ViewportSize = {"width": 1280, "height": 1250}
GROWN = 2  # pixels of a picture for one of the sweep's


def shaken(out: Path, seed: int = SEED) -> Path:
    """The arena with noise on its inertial data, as a bag."""
    rng, store = np.random.default_rng(seed), get_typestore(Stores.ROS1_NOETIC)
    with Reader(demo_bag("arena")) as reader, Writer(out) as writer:
        made = {
            each.id: writer.add_connection(each.topic, each.msgtype, msgdef=each.msgdef.data, md5sum=each.digest)
            for each in reader.connections
        }
        for connection, time_ns, raw in reader.messages():
            late = time_ns - reader.start_time > AFTER_S * 1e9
            if late and connection.msgtype == "sensor_msgs/msg/Imu":
                message: Any = store.deserialize_ros1(raw, connection.msgtype)
                for vector, sigma in ((message.linear_acceleration, SHAKE), (message.angular_velocity, TURN)):
                    for axis, noise in zip("xyz", rng.normal(0.0, sigma, 3).tolist(), strict=True):
                        object.__setattr__(vector, axis, getattr(vector, axis) + noise)
                raw = bytes(store.serialize_ros1(message, connection.msgtype))  # noqa: PLW2901
            writer.write(made[connection.id], time_ns, raw)
    return out


def searched(bag: Path, folder: Path, count: int) -> list[Row]:
    """The rows of the search; the first is that of the defaults."""
    axes = [parse(text) for text in VARY]
    settings = [{}, *quasi_random(axes, count - 1, SEED)]
    specs = product([(bag.name, str(bag))], settings, RunSpec("", ""))
    rows = Table(folder, [axis.name for axis in axes])
    with executor(0) as pool:
        sweep(specs, rows, pool, Limits())
    rows.finish(specs)
    return list(rows.rows.values())


def described(rows: list[Row]) -> str:
    """The defaults and the three best, and how many held."""
    names = [text.partition("=")[0] for text in VARY]
    best = sorted(rows, key=lambda row: cost(row, SCORE))
    held = sum(row["status"] == "ok" for row in rows)
    shown = [("defaults", rows[0]), *((f"{k}.", row) for k, row in enumerate(best[:3], 1))]
    lines = [
        [place, *(row[name] for name in names), row["status"], row[SCORE], row[TRUTH]] for place, row in shown
    ]
    head = ("", *names, "ended", "consistency", "error, aligned [m]")
    return (
        f"{held} of {len(rows)} settings held; the best by the score, which does not know the truth:\n\n"
        + table(head, lines)
    )


def picture(folder: Path, row: Row, out: Path) -> None:
    """The small map of a run, larger."""
    content = base64.b64decode(read_details(folder, row["key"])["picture"])
    small = Image.open(io.BytesIO(content)).convert("RGB")
    small.resize((GROWN * small.width, GROWN * small.height), Image.Resampling.NEAREST).save(out)


def page_picture(folder: Path, chosen: tuple[str, str], out: Path) -> None:
    """The page of the sweep, with two runs compared."""
    server = SweepServer(folder, port=0)
    server.start()
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=["--no-sandbox"])
        page = browser.new_page(viewport=SIZE)
        page.goto(server.url)
        for key in chosen:
            page.locator(f'#runs tr[data-key="{key}"] input').check()
        page.locator("#comparison polyline").first.wait_for()
        page.locator("#maps img").last.wait_for()
        page.evaluate("scrollTo(0, 0)")
        page.screenshot(path=out)
        browser.close()
    server.stop()


def main() -> None:
    """Break, search, and tell."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--search", type=int, default=SEARCH)
    parser.add_argument("--folder", type=Path)
    parser.add_argument("--write", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as made:
        folder = args.folder or Path(made)
        folder.mkdir(parents=True, exist_ok=True)
        bag = folder / "shaken.bag"
        rows = searched(bag if bag.exists() else shaken(bag), folder, args.search)
        text = described(rows)
        print(text)
        if args.write:
            best = min(rows, key=lambda row: cost(row, SCORE))
            images = ROOT / "docs" / "images"
            picture(folder, rows[0], images / "sweep-defaults.png")
            picture(folder, best, images / "sweep-found.png")
            page_picture(folder, (rows[0]["key"], best["key"]), images / "sweep-page.png")
            fill(ROOT / "docs" / "sweeps.md", "shaken", text)


if __name__ == "__main__":
    main()
