"""The headless run: the whole recording through the pipeline as fast as it goes, and files at the end."""

import time
from collections.abc import Callable, Iterator
from itertools import islice

from hectorscope.inputs import Item, Source, merged
from hectorscope.run.metrics import Effort
from hectorscope.run.pipeline import Pipeline, nothing_used
from hectorscope.run.settings import Settings
from slam_core.localization.prior_map import PriorMap
from slam_core.measurements import LaserScan, Measurement
from slam_core.results import StepResult

Progress = Callable[[int], None]
Observer = Callable[[Pipeline, StepResult], None]

# Items are read so many at a time: one by one between the scans, each would find the caches full of map.
READ_AHEAD = 256


def run_headless(
    source: Source,
    settings: Settings,
    progress: Progress = lambda _: None,
    prior_map: PriorMap | None = None,
    observe: Observer = lambda _pipeline, _result: None,
) -> tuple[Pipeline, Effort]:
    """Every item of `source`, in a plain loop. progress: called with the time of every scan. Closes the source.

    prior_map: the map to begin with. observe: called with every result. SourceError when not a single scan could
    be used.
    """
    begin = time.perf_counter()
    span = source.span_ns
    pipeline = Pipeline(settings, span[0] if span else None, prior_map)
    try:
        for item in _read_ahead(source.items()):
            _step(pipeline, pipeline.admit(item), observe)
            if isinstance(item, LaserScan):
                progress(item.stamp_ns)
        _step(pipeline, pipeline.flush(), observe)
    finally:
        source.close()
    if not pipeline.scans:
        raise nothing_used(source.name, merged(source.report, pipeline.skipped, 0).skipped, pipeline.slam)
    recorded = (span[1] - span[0]) / 1e9 if span else float(pipeline.trajectory[-1, 0])
    return pipeline, Effort(recorded, time.perf_counter() - begin)


def _step(pipeline: Pipeline, measurements: list[Measurement], observe: Observer) -> None:
    for measurement in measurements:
        result = pipeline.step(measurement)
        if result is not None:
            observe(pipeline, result)


def _read_ahead(items: Iterator[Item]) -> Iterator[Item]:
    while some := list(islice(items, READ_AHEAD)):
        yield from some
