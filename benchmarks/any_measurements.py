"""How long steps take when anything is measured and every setting moves: the fuzz of measurements, timed.

    python -m benchmarks.any_measurements [--examples 500]

Runs the machine of `tests/property/test_any_measurements.py` with maps as large as they are by default. A step is
one measurement. Prints the longest steps with what was measured; times are of the processor, so that other
programs do not count.
"""

import argparse
import time
import warnings
from collections import Counter
from collections.abc import Iterable, Mapping

import numpy as np
from hypothesis import HealthCheck, settings
from hypothesis.stateful import run_state_machine_as_test

from hectorscope.run.warmup import load_everything
from slam_core.measurements import Measurement
from tests.property.test_any_measurements import AnyMeasurements

EXAMPLES, STEPS = 500, 30
SLOW_MS = 50.0
SHOWN = 5


class Timed(AnyMeasurements):
    """The same, with the default map and a clock."""

    map_settings: Mapping[str, float] = {}
    steps: list[tuple[float, str]] = []  # noqa: RUF012  of all examples together

    def add(self, measurement: Measurement) -> None:
        """To the pipeline, timed."""
        window, begin = self.slam.map.levels[0].shape, time.thread_time()
        super().add(measurement)
        ms, grown = 1e3 * (time.thread_time() - begin), self.slam.map.levels[0].shape != window
        self.steps.append((ms, "a larger window" if grown else type(measurement).__name__))


def report(steps: Iterable[tuple[float, str]]) -> str:
    """Of all steps."""
    ordered = sorted(steps, reverse=True)
    times = np.array([ms for ms, _ in ordered])
    longest = ", ".join(f"{ms:.1f} ms ({name})" for ms, name in ordered[:SHOWN])
    slow = Counter(name for ms, name in ordered if ms > SLOW_MS)
    over = f"over {SLOW_MS:g} ms: {dict(slow)}"
    return f"{len(times)} steps, median {np.median(times):.3f} ms; {over}; longest {longest}"


def main() -> None:
    """Print the report."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--examples", type=int, default=EXAMPLES)
    args = parser.parse_args()
    warnings.simplefilter("ignore", RuntimeWarning)
    load_everything()
    chosen = settings(
        max_examples=args.examples,
        stateful_step_count=STEPS,
        derandomize=True,
        deadline=None,
        suppress_health_check=list(HealthCheck),
    )
    run_state_machine_as_test(Timed, settings=chosen)
    print(report(Timed.steps))


if __name__ == "__main__":
    main()
