"""report.html: a run on one page that needs no network: map, curves, findings, figures, settings, recording."""

import math
from base64 import b64encode
from collections.abc import Iterator, Mapping
from datetime import UTC, datetime
from functools import cache
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np
from jinja2 import Environment, StrictUndefined, Template

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter, _charts
from hectorscope.exporters._charts import Chart, chart
from hectorscope.exporters._map_drawing import map_drawing
from hectorscope.inputs import SourceReport
from hectorscope.run.fingerprint import fingerprints
from hectorscope.run.marks import listed, marks
from hectorscope.run.results import Run
from hectorscope.run.series import SERIES_DTYPE
from hectorscope.run.settings_file import to_toml
from slam_core.config import Leaf, SlamConfig, leaves

MOST_MARKS = 300  # listed; more of them say no more
TEMPLATE = Path(__file__).with_name("report.html.jinja")


def charts(run: Run) -> list[Chart]:
    """Residual, fit and sigmas over time, of what the run has."""
    series = np.ascontiguousarray(run.series).view(SERIES_DTYPE).reshape(-1)
    seconds, degrees = series["time_s"], 180.0 / math.pi
    sigma = {name: series[f"fused_sigma_{name}"] for name in ("x", "y", "yaw")}
    drawn = [
        chart("Mean residual: 0 is a perfect fit, 0.5 an unknown map", seconds, {"residual": series["residual"]}),
        chart("Fit: share of the points on walls, %", seconds, {"fit": 100.0 * series["fit"]}),
        chart("σ of the position, mm", seconds, {"x": 1e3 * sigma["x"], "y": 1e3 * sigma["y"]}, log=True),
        chart("σ of the heading, °", seconds, {"ψ": degrees * sigma["yaw"]}, log=True),
        chart("Beams that end in free space, %", seconds, {"unexpected": 100.0 * series["unexpected"]}),
    ]
    return [each for each in drawn if not each.empty]


def figures(run: Run) -> Iterator[tuple[str, str]]:
    """The rows of the table: what, and how much with its unit; of `metrics` what is there."""
    told = run.metrics
    if scans := told.get("scans"):
        yield "Scans", f"{scans['used']} used of {scans['read']}"
        yield from (("Skipped", f"{count} × {reason}") for reason, count in scans["skipped"].items())
    if tracking := told.get("tracking"):
        yield "Tracking", ", ".join(f"{count} {state}" for state, count in tracking.items())
    steps = np.linalg.norm(np.diff(run.trajectory[:, 1:3], axis=0), axis=1)  # a height may be unmeasured
    yield "Path in the plane", f"{steps.sum():.2f} m in {run.trajectory[-1, 0] - run.trajectory[0, 0]:.1f} s"
    if "map_updates" in told:
        yield "Map", f"{told['map_updates']} updates, {told['occupied_cells']} occupied cells"
    if "realtime_factor" in told:
        yield "Processing", f"{told['wall_s']:.1f} s, {told['realtime_factor']:.1f} × real time"
    for part, us in told.get("median_us", {}).items():
        yield f"Median time, {part}", f"{us:.0f} µs"
    yield from truth(told.get("truth") or {})
    if where := told.get("map_in_world"):
        place = f"east {where['east_m']:.2f} m, north {where['north_m']:.2f} m (σ {where['sigma_m']:.2f} m)"
        yield "Map in the plane of the satellites", f"{place}, {where['from_east_deg']:.1f}° from east"


def annotations(run: Run) -> Iterator[tuple[str, str]]:
    """The marks that a person set, a row each."""
    for mark in run.annotations:
        where = f"x {mark.x:.2f} m, y {mark.y:.2f} m at {(mark.time_ns - run.start_ns) / 1e9:.1f} s"
        yield f"Mark {mark.number}: {mark.kind}", f"{where} {mark.text}".rstrip()


def pictures(run: Run) -> Iterator[tuple[str, str]]:
    """Those of the marks: what each shows, and its content for an address."""
    for mark in run.annotations:
        if mark.picture:
            title = f"Mark {mark.number}: {mark.kind} {mark.text}".rstrip()
            yield title, b64encode(mark.picture.content).decode()


def truth(errors: Mapping[str, float]) -> Iterator[tuple[str, str]]:
    """The errors against a truth, where there is one."""
    if errors:
        aligned, raw = errors["aligned_rmse_m"], errors["raw_rmse_m"]
        yield "Trajectory error (RMSE)", f"{aligned:.4f} m aligned, {raw:.4f} m raw"
    if "roll_rms_deg" in errors:
        yield "Attitude error (RMS)", f"roll {errors['roll_rms_deg']:.3f}°, pitch {errors['pitch_rms_deg']:.3f}°"
    if "height_rms_m" in errors:
        yield "Height error (RMS)", f"{errors['height_rms_m']:.3f} m"


def changed(run: Run) -> list[tuple[Leaf, Any]]:
    """The settings that are not the default, each with the default."""
    pairs = zip(leaves(run.settings.start), leaves(SlamConfig()), strict=True)
    return [(ours, usual.value) for ours, usual in pairs if ours.value != usual.value]


@cache
def _template() -> Template:
    environment = Environment(
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    return environment.from_string(TEMPLATE.read_text(encoding="utf-8"))


def page(run: Run) -> str:
    """The page; what comes from the recording is escaped."""
    series = np.ascontiguousarray(run.series).view(SERIES_DTYPE).reshape(-1)
    return _template().render(
        title=run.recording.name if run.recording else "Run",
        begin=datetime.fromtimestamp(run.start_ns // 10**9, UTC).strftime("%Y-%m-%d %H:%M:%S UTC"),
        version=version("hectorscope"),
        map=map_drawing(run.maps, run.trajectory),
        charts=charts(run),
        size=_charts,
        findings=run.report.findings,
        notes=run.metrics.get("notes", ()),
        marks=listed(marks(series, run.start_ns, run.settings, SourceReport()), run.start_ns)[:MOST_MARKS],
        figures=[*figures(run), *annotations(run)],
        pictures=list(pictures(run)),
        changed=changed(run),
        changes=[((change.time_ns - run.start_ns) / 1e9, change) for change in run.settings.changes],
        toml=to_toml(run.settings, run.report.sensors),
        files=fingerprints(run.recording) if run.recording else (),
    )


def _write(run: Run, folder: Path) -> None:
    write_whole(folder / "report.html", page(run).encode())


EXPORTER = Exporter("report", ("report.html",), _write, order=90)
