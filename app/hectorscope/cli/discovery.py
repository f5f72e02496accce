"""Looks for robots where they usually are: bridges on local ports, Zenoh routers that answer, DDS domains."""

import socket
import threading
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass

from hectorscope.common.terminal import printable
from hectorscope.inputs import OffersTopics, Source, SourceError, SourceOptions
from hectorscope.ros.roles import SCAN
from hectorscope.sources import dds, open_source, scheme
from hectorscope.sources.rmw_zenoh import scouted

USUAL = ("ws://127.0.0.1:8765", "rosbridge://127.0.0.1:9090", "zenoh://127.0.0.1:7447")
ANSWERS_S = 0.5
LISTENS_S = 3.0  # for the topics of a robot
LOOK_S = 0.05
SETTLES_S = 0.3


@dataclass(frozen=True, slots=True)
class Found:
    """A robot that answers. scans: its topics of laser scans. trouble: why it cannot be read; empty if it can."""

    address: str
    topics: int = 0
    scans: tuple[str, ...] = ()
    trouble: str = ""

    def __str__(self) -> str:
        """A line for a person."""
        if self.trouble:
            return f"{self.address}: {self.trouble}"
        told = f"scans on {', '.join(self.scans)}" if self.scans else "no laser scans"
        return f"{self.address}: {self.topics} topics, {told}"


def look(addresses: Sequence[str] | None = None) -> list[Found]:
    """Every robot that answers, at these addresses or at the usual ones and by Zenoh's discovery.

    A DDS domain is found by its topics alone.
    """
    known = list(USUAL if addresses is None else addresses)
    if addresses is None:
        known += [address for address in (*scouted(), *dds.usual()) if address not in known]
    with ThreadPoolExecutor() as at_once:
        found = list(at_once.map(_asked, filter(_listens, known)))
    return [robot for robot in found if scheme(robot.address) != "dds" or robot.topics]


def _listens(address: str) -> bool:
    if scheme(address) == "dds":
        return True
    host, _, port = address.partition("://")[2].partition("/")[0].rpartition(":")
    try:
        socket.create_connection((host.strip("[]"), int(port)), ANSWERS_S).close()
    except (OSError, ValueError):
        return False
    return True


def _asked(address: str) -> Found:
    try:
        source = open_source(address, SourceOptions())
    except SourceError as error:
        return Found(address, trouble=str(error))
    reader = threading.Thread(target=_read, args=(source,), daemon=True)
    reader.start()
    offered = _topics(source)
    source.close()
    reader.join(ANSWERS_S)
    return Found(address, len(offered), tuple(sorted(topic for topic, kind in offered.items() if kind == SCAN)))


def _read(source: Source) -> None:
    for _ in source.items():
        pass


def _topics(source: Source) -> dict[str, str]:
    """What is offered once there is a laser and nothing more comes, or after some seconds."""
    waited, offered, same = threading.Event(), dict[str, str](), 0
    for _ in range(round(LISTENS_S / LOOK_S)):
        before, offered = offered, dict(source.offered) if isinstance(source, OffersTopics) else {}
        same = same + 1 if offered == before else 0
        if SCAN in offered.values() and same * LOOK_S >= SETTLES_S:
            break
        waited.wait(LOOK_S)
    return offered


def told(found: Iterable[Found]) -> str:
    """A line for each robot, and what to do; SourceError if there is none."""
    robots = list(found)
    if not robots:
        places = ", ".join((*USUAL, *dds.usual()))
        raise SourceError(f"no robot was found at {places} or by Zenoh: start its bridge, or give its ADDRESS")
    best = next((robot for robot in robots if robot.scans), robots[0])
    return printable("\n".join([*map(str, robots), f"Show one of them: hectorscope live {best.address}"]))
