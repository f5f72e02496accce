"""One run of a sweep, in the process of a worker: from a spec to its summary."""

import base64
import io
import os
import socket
import time
from collections.abc import Iterator
from functools import partial
from itertools import takewhile
from typing import Any

import numpy as np
from PIL import Image

from hectorscope.checks.sensor_check import CheckedSource
from hectorscope.inputs import Item, Source, SourceReport
from hectorscope.run.headless import run_headless
from hectorscope.run.map_image import PALETTE, MapImage
from hectorscope.run.map_images import level_image
from hectorscope.run.metrics import failure, metrics
from hectorscope.run.pipeline import Pipeline
from hectorscope.run.relations import read_relations, relation_figures
from hectorscope.sources import open_source
from hectorscope.sweep.fetch import kept, local
from hectorscope.sweep.figures import SCORE, flat
from hectorscope.sweep.limits import resident_mb
from hectorscope.sweep.sampler import Sampler
from hectorscope.sweep.spec import RunSpec, RunSummary
from slam_core.errors import SlamError
from slam_core.measurements import LaserScan

PICTURE = 160  # pixels, of its longer side at most
POSES = 300  # of the path that is kept


class Beginning:
    """The first `share` of a recording's time, as a source."""

    def __init__(self, source: Source, share: float) -> None:
        self.name, self.live, self._source, self._share = source.name, source.live, source, share

    @property
    def span_ns(self) -> tuple[int, int] | None:
        """Of the part."""
        span = self._source.span_ns
        return (span[0], span[0] + round(self._share * (span[1] - span[0]))) if span else None

    @property
    def report(self) -> SourceReport:
        """Of the source."""
        return self._source.report

    def items(self) -> Iterator[Item]:
        """Those up to the end of the part: the same scans with whatever delay, which moves their stamps."""
        end_ns = self.span_ns[1] if self.span_ns and self._share < 1.0 else None
        items = self._source.items()
        sensors: dict[str, Any] = dict(self.report.sensors)
        delay_ns: int = round(1e9 * sensors.get("scan_delay", 0.0))

        def within(item: Item) -> bool:
            return item.stamp_ns + delay_ns * isinstance(item, LaserScan) <= (end_ns or 0)

        return items if end_ns is None else takewhile(within, items)

    def close(self) -> None:
        """Let go of the source."""
        self._source.close()


def execute(spec: RunSpec) -> RunSummary:
    """The whole run. What stops it is the summary's reason; no error is raised."""
    begin = time.perf_counter()
    status, reason, found = "ok", "", dict[str, Any]()
    try:
        found = _run(spec)
        status = found.pop("status")
    except SlamError as error:
        status, reason = "refused", str(error)
    except MemoryError:
        status, reason = "memory", "an array was larger than the memory"
    except Exception as error:  # whatever it is, the other runs go on
        status, reason = "failed", f"{type(error).__name__}: {error}"
    return RunSummary(
        status,  # type: ignore[arg-type]  # one of them
        _without_copy(reason, spec),
        wall_s=round(time.perf_counter() - begin, 3),
        memory_mb=round(resident_mb(os.getpid()), 1),
        worker=f"{socket.gethostname()}:{os.getpid()}",
        **found,
    )


def _run(spec: RunSpec) -> dict[str, Any]:
    """The parts of the summary of a run that came to its end."""
    opened = partial(open_source, str(local(spec.path)))
    relations = read_relations(local(spec.relations)) if spec.relations else None
    source = Beginning(CheckedSource(opened, spec.source_options(), repairs=spec.repair), spec.share)
    sampler = Sampler()
    pipeline, _ = run_headless(source, spec.run_settings(), observe=sampler.add)
    figures = metrics(pipeline, source.report)
    if relations is not None:
        figures["relations"] = relation_figures(pipeline.trajectory, pipeline.start_ns or 0, relations)
    pyramid = pipeline.slam.map
    image = None if pyramid.empty else level_image(pyramid, 0)
    figures[SCORE] = round(sampler.score(image), 6)
    return {
        "status": "lost" if failure(figures) else "ok",
        "figures": dict(flat(figures)),
        "picture": picture(image) if image else "",
        "extent": _extent(image) if image else (),
        "path": path(pipeline),
    }


def picture(image: MapImage) -> str:
    """A small PNG of the map in base64, in which the most occupied cell of each pixel shows."""
    cells = image.cells[::-1]
    n = -(-max(cells.shape) // PICTURE)
    padded = np.pad(cells, [(0, -length % n) for length in cells.shape])
    rows, columns = (length // n for length in padded.shape)
    small = Image.fromarray(padded.reshape(rows, n, columns, n).max(axis=(1, 3)))
    small.putpalette(PALETTE)
    content = io.BytesIO()
    small.save(content, "PNG", bits=2)
    return base64.b64encode(content.getvalue()).decode()


def _extent(image: MapImage) -> tuple[float, ...]:
    """x0, y0, x1, y1 of the picture: what it is padded by lies to the right and below."""
    n, (rows, columns), cell = -(-max(image.cells.shape) // PICTURE), image.cells.shape, image.resolution
    top = image.y + rows * cell
    low, right = top - (rows + -rows % n) * cell, image.x + (columns + -columns % n) * cell
    return tuple(round(edge, 4) for edge in (image.x, low, right, top))


def path(pipeline: Pipeline) -> tuple[tuple[float, ...], ...]:
    """Seconds, x and y of up to POSES poses, and of the last."""
    rows = pipeline.trajectory[:, :3]
    kept = np.vstack([rows[:: -(-len(rows) // POSES)], rows[-1:]])
    return tuple(tuple(round(value, 4) for value in row) for row in kept.tolist())


def _without_copy(reason: str, spec: RunSpec) -> str:
    """A reason with the recording's name in the place of where a copy of it lies."""
    return " ".join(reason.replace(kept(spec.path), spec.recording).split())
