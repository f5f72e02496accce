"""Robots and listeners on eProsima Fast DDS, an implementation of DDS that is not ours."""

import queue
import re
import shutil
import socket
import struct
import subprocess
import threading
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path

import pytest
from rosbags.highlevel import AnyReader
from rosbags.typesys import Stores, get_typestore

STORE = get_typestore(Stores.ROS2_HUMBLE)
LATCHED, RELIABLE, BEST_EFFORT = "L", "R", "B"
KINDS = {"/tf_static": LATCHED, "/scan": BEST_EFFORT}
INSTALL = "sudo apt-get install g++ libfastrtps-dev libfastcdr-dev"
GIVE_UP_S = 60.0
# Below the ports that systems give away by themselves, and away from those that people use.
DOMAINS = range(30, 100)
# Cyclone DDS, on the loopback interface alone.
LOOPBACK = (
    "<CycloneDDS><Domain>"
    "<General><Interfaces><NetworkInterface name='lo' multicast='false'/></Interfaces></General>"
    "<Discovery><Peers><Peer address='127.0.0.1'/></Peers></Discovery>"
    "</Domain></CycloneDDS>"
)


def built(folder: Path) -> Path:
    """The program of `fastdds_peer.cpp`; skips the test where it cannot be compiled."""
    if shutil.which("g++") is None:
        pytest.skip(f"no g++ here: {INSTALL}")
    program, text = folder / "fastdds_peer", Path(__file__).with_name("fastdds_peer.cpp")
    command = ["g++", "-std=c++17", "-O1", "-o", str(program), str(text), "-lfastrtps", "-lfastcdr", "-pthread"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if re.search(r"fast(dds|rtps)/.*No such file|cannot find -lfast", done.stderr):
        pytest.skip(f"no Fast DDS here: {INSTALL}")
    assert done.returncode == 0, done.stderr
    return program


@contextmanager
def reserved_domain() -> Iterator[int]:
    """A domain that no other test on this machine uses: each holds its port for TCP, which DDS leaves free."""
    for domain in DOMAINS:
        with socket.socket() as held:
            try:
                held.bind(("127.0.0.1", 7400 + 250 * domain))
            except OSError:
                continue
            yield domain
            return
    raise AssertionError("every domain is in use")


@dataclass(frozen=True)
class Spoken:
    """What a robot says: its messages by (topic, ns after the start, bytes), in order. kinds: of its topics."""

    types: dict[str, str]
    kinds: dict[str, str]
    messages: list[tuple[str, int, bytes]]
    told: dict[str, str] = field(default_factory=dict)  # user data of a topic

    def write(self, path: Path) -> Path:
        """As `fastdds_peer publish` reads it."""

        def block(data: bytes) -> bytes:
            return struct.pack("<I", len(data)) + data

        names = list(self.types)
        with path.open("wb") as file:
            file.write(struct.pack("<I", len(names)))
            for name in names:
                words = (f"rt{name}", dds_type(self.types[name]), self.kinds[name], self.told.get(name, ""))
                file.write(b"".join(block(word.encode()) for word in words))
            for name, after_ns, data in self.messages:
                file.write(struct.pack("<Iq", names.index(name), after_ns) + block(data))
        return path


def dds_type(msgtype: str) -> str:
    """The name of a message type in DDS."""
    package, _, name = msgtype.split("/")
    return f"{package}::msg::dds_::{name}_"


def recorded(path: Path, topics: Sequence[str], *, speed: float = 1.0, begin: float = 0.0) -> Spoken:
    """What a recording has of some topics: transforms latched and first, inertial data reliable, the rest not."""
    with AnyReader([path], default_typestore=STORE) as reader:
        wanted = [c for c in reader.connections if c.topic in topics]
        begin_ns = reader.start_time + round(begin * 1e9)
        types = {c.topic: c.msgtype for c in wanted}
        kinds = {topic: KINDS.get(topic, RELIABLE) for topic in types}
        kept = [c for c in wanted if kinds[c.topic] == LATCHED]
        live = [c for c in wanted if kinds[c.topic] != LATCHED]
        # Without connections, the reader would take all of them.
        messages = [(c.topic, 0, bytes(data)) for c, _, data in reader.messages(kept)] if kept else []
        for c, stamp_ns, data in reader.messages(live, start=begin_ns):
            messages.append((c.topic, round((stamp_ns - begin_ns) / speed), bytes(data)))
    return Spoken(types, kinds, messages)


class Peer:
    """A running program. Its standard input keeps it alive: it leaves in good order when that ends."""

    def __init__(self, program: Path, *arguments: str) -> None:
        self.process = subprocess.Popen(
            [str(program), *arguments], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )
        self._lines: queue.Queue[str] = queue.Queue()
        self._reader = threading.Thread(target=self._read, daemon=True)
        self._reader.start()
        assert self.line().startswith("listening")

    def _read(self) -> None:
        assert self.process.stdout is not None
        for line in self.process.stdout:
            self._lines.put(line.rstrip("\n"))
        self._lines.put("")

    def line(self) -> str:
        """The next one that it says; "" at its end."""
        return self._lines.get(timeout=GIVE_UP_S)

    def leave(self) -> None:
        """With a farewell."""
        assert self.process.stdin is not None
        self.process.stdin.close()
        assert self.process.wait(GIVE_UP_S) == 0

    def kill(self) -> None:
        """As the power switch does it."""
        self.process.kill()
        self.process.wait()
