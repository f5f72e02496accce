"""The driven robot as a live source: steps by the clock, requests from any thread."""

import threading
import time
from collections.abc import Iterator

from hectorscope.inputs import Item, SourceReport
from hectorscope.simulation.driven import DrivenRobot, DriveWorld
from hectorscope.simulation.motion import STEP
from hectorscope.simulation.options import SceneOptions
from hectorscope.steering import DriveState, Request, Steer

DEAD_MAN_S = 0.6  # without another word of the hand the robot stops: its browser may be gone


class DriveSource:
    """Each step is due STEP seconds after the one before. A slow machine drives slowly; it does not catch up."""

    live = True
    span_ns = None
    report = SourceReport(connected=True, notes=("The robot is simulated, and driven from the page.",))

    def __init__(self, world: DriveWorld, seed: int = 1) -> None:
        """SimulationError for an unknown world, or a seed that is none."""
        SceneOptions(seed=seed)
        self.name = f"drive {world}"
        self._robot = DrivenRobot(world, seed)
        self._closed = threading.Event()
        self._lock = threading.Lock()
        self._steered = 0.0

    @property
    def state(self) -> DriveState:
        """What a page shows of the robot."""
        with self._lock:
            return self._robot.state

    def drive(self, request: Request) -> str:
        """Obey; a sentence if that cannot be, else empty."""
        with self._lock:
            if isinstance(request, Steer):
                self._steered = time.monotonic()
            return self._robot.obey(request)

    def items(self) -> Iterator[Item]:
        """Measurements as they come, until `close`."""
        due = time.monotonic()
        while not self._closed.wait(max(0.0, due - time.monotonic())):
            due = max(due + STEP, time.monotonic())
            with self._lock:
                if time.monotonic() - self._steered > DEAD_MAN_S:
                    self._robot.obey(Steer(0.0, 0.0))
                items = list(self._robot.step())
            yield from items

    def close(self) -> None:
        """Stop driving."""
        self._closed.set()
