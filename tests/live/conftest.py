"""Servers for the live source: the real one in a process of its own, and one that says what a test tells it."""

import signal
import subprocess
import sys
import threading
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.server import ServerConnection, serve
from websockets.typing import Subprotocol

from hectorscope.simulation import SimulateOptions, simulate
from tests.conftest import ROOT

SERVERS = {"ws": "replay_server", "rosbridge": "rosbridge_server", "zenoh": "zenoh_router"}


@dataclass
class Replay:
    """A running replay server."""

    process: subprocess.Popen[str]
    port: int
    scheme: str

    @property
    def uri(self) -> str:
        """Where it listens."""
        return f"{self.scheme}://127.0.0.1:{self.port}"

    def kill(self) -> None:
        """As the power switch does it: no farewell."""
        self.process.send_signal(signal.SIGKILL)
        self.process.wait()


def started(recording: Path, *arguments: str, scheme: str = "ws") -> Replay:
    """A replay server of a scheme, with the arguments of its program; to be killed."""
    command = [sys.executable, "-m", f"tests.live.{SERVERS[scheme]}", str(recording), *arguments]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    greeting = process.stdout.readline().split()
    assert greeting[:1] == ["listening"], "the replay server did not start"
    return Replay(process, int(greeting[1]), scheme)


@pytest.fixture(scope="session")
def drive(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Six seconds through the arena with everything on board; tests may ask for another container."""
    path = tmp_path_factory.mktemp("drive") / str(getattr(request, "param", "drive.mcap"))
    simulate(SimulateOptions(scenario="arena", duration=6.0, scan_rate=10.0, beams=181, out=path))
    return path


@pytest.fixture
def replay() -> Iterator[Callable[..., Replay]]:
    """A function that starts replay servers of a scheme, with the arguments of its program."""
    running: list[Replay] = []

    def start(recording: Path, *arguments: str, scheme: str = "ws") -> Replay:
        running.append(started(recording, *arguments, scheme=scheme))
        return running[-1]

    yield start
    for server in running:
        server.kill()


@dataclass
class Script:
    """A server that sends the given frames to everybody who comes, and keeps what it was asked."""

    frames: list[str | bytes]
    subprotocols: list[Subprotocol] | None
    answers: dict[str, list[str | bytes]]  # a word in a request -> the frames it brings
    asked: list[str] = field(default_factory=list)
    port: int = 0

    @property
    def uri(self) -> str:
        """Where it listens."""
        return f"ws://127.0.0.1:{self.port}"

    def play(self, connection: ServerConnection) -> None:
        """Serve one client."""
        try:
            for frame in self.frames:
                connection.send(frame)
            for request in connection:
                self.asked.append(str(request))
                for word, frames in self.answers.items():
                    if word in str(request):
                        for frame in frames:
                            connection.send(frame)
        except ConnectionClosed:
            return


@pytest.fixture
def scripted() -> Iterator[Callable[..., Script]]:
    """A function that starts scripted servers; protocol None takes whatever is offered and chooses nothing."""
    stops: list[Callable[[], None]] = []

    def start(
        frames: list[str | bytes],
        protocol: str | None = "foxglove.websocket.v1",
        answers: dict[str, list[str | bytes]] | None = None,
    ) -> Script:
        script = Script(frames, [Subprotocol(protocol)] if protocol else None, answers or {})
        server = serve(script.play, "127.0.0.1", 0, subprotocols=script.subprotocols)
        script.port = server.socket.getsockname()[1]
        threading.Thread(target=server.serve_forever, daemon=True).start()
        stops.append(server.shutdown)
        return script

    yield start
    for stop in stops:
        stop()
