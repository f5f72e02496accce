"""Writes bags: ROS 1 .bag, rosbag2 .mcap, or a rosbag2 folder with sqlite3; also what tests make theirs with."""

import shutil
import sqlite3
from contextlib import suppress
from functools import partial
from pathlib import Path
from types import TracebackType
from typing import Any, Literal, Self

import lz4.frame
from rosbags import rosbag1, rosbag2
from rosbags.interfaces import (
    Connection,
    Qos,
    QosDurability,
    QosHistory,
    QosLiveliness,
    QosReliability,
    QosTime,
)
from rosbags.typesys import Stores, get_types_from_msg, get_typestore
from rosbags.typesys.store import Typestore

from hectorscope.common.paths import exists
from slam_core.errors import SlamError

BagFormat = Literal["bag", "mcap", "sqlite3"]
LATCHED = ("/tf_static",)
LZ4_LEVEL = 9  # three quarters of the size that the library's usual level gives, and as fast to read

# What the containers raise where nothing can be written, as on a full disk.
FAILURES = (OSError, sqlite3.Error)

_NEVER = QosTime(2147483647, 4294967295)
_LATCHING = Qos(
    QosHistory.KEEP_LAST,
    1,
    QosReliability.RELIABLE,
    QosDurability.TRANSIENT_LOCAL,
    _NEVER,
    _NEVER,
    QosLiveliness.AUTOMATIC,
    _NEVER,
    avoid_ros_namespace_conventions=False,
)


class RecorderError(SlamError):
    """The bag cannot be written there."""


def format_of(path: Path) -> BagFormat:
    """The container that a path's suffix asks for; RecorderError for a suffix that is none."""
    if path.suffix in {".bag", ".mcap"}:
        return "bag" if path.suffix == ".bag" else "mcap"
    if path.suffix:
        raise RecorderError(f"{path} ends in {path.suffix}: give NAME.bag, NAME.mcap, or a folder without suffix")
    return "sqlite3"


class Recorder:
    """An open bag. It appears under its name when the `with` block ends well, and not at all otherwise.

    path: NAME.bag, NAME.mcap, or a folder. compress: as strongly as fast reading allows.
    """

    def __init__(self, path: Path, *, compress: bool = True) -> None:
        self.path, self.format = path, format_of(path)
        if exists(path):
            raise RecorderError(f"{path} exists: remove it or choose another name")
        self.typestore = _typestore(self.format)
        self._unfinished = path.parent / f".{path.name}.part"
        self._connections: dict[str, Connection] = {}
        self._compress = compress

    def __enter__(self) -> Self:
        """Begin under a temporary name."""
        shutil.rmtree(self._unfinished, ignore_errors=True)
        try:
            self._unfinished.mkdir(parents=True)
            self._writer = self._open()
        except FAILURES as failure:
            shutil.rmtree(self._unfinished, ignore_errors=True)
            raise self._refused(failure) from failure
        return self

    def _open(self) -> rosbag1.Writer | rosbag2.Writer:
        target = self._unfinished / self.path.stem
        if self.format == "bag":
            bag = rosbag1.Writer(target.with_suffix(".bag"))
            if self._compress:
                # bz2 is half the size, but unpacking it takes longer than all the rest of the reading.
                bag.set_compression(rosbag1.Writer.CompressionFormat.LZ4)
                bag.compressor = partial(lz4.frame.compress, compression_level=LZ4_LEVEL)
            bag.open()
            return bag
        mcap = self.format == "mcap"
        plugin = rosbag2.StoragePlugin.MCAP if mcap else rosbag2.StoragePlugin.SQLITE3
        folder = rosbag2.Writer(target, version=9, storage_plugin=plugin)
        if self._compress:
            mode = rosbag2.CompressionMode.STORAGE if mcap else rosbag2.CompressionMode.FILE
            folder.set_compression(mode, rosbag2.CompressionFormat.ZSTD)
        folder.open()
        return folder

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        """Give the finished bag its name, or leave nothing; RecorderError if it cannot be finished."""
        try:
            if kind is None:
                self._finish()
        except FAILURES as failure:
            raise self._refused(failure) from failure
        finally:
            with suppress(*FAILURES):
                self._writer.abort()  # of what is closed, nothing
            shutil.rmtree(self._unfinished, ignore_errors=True)

    def _finish(self) -> None:
        self._writer.close()
        finished = self._unfinished / self.path.stem
        if self.format != "sqlite3":
            finished = next(self._unfinished.rglob(f"*.{self.format}"))
        finished.rename(self.path)

    def _refused(self, failure: Exception) -> RecorderError:
        reason = getattr(failure, "strerror", None) or failure
        return RecorderError(f"{self.path} cannot be written ({reason}): choose another place")

    def make(self, msgtype: str, **fields: Any) -> Any:
        """A message of `msgtype` ("sensor_msgs/msg/Imu"), all fields given."""
        return self.typestore.types[msgtype](**fields)

    def header(self, stamp_ns: int, frame_id: str) -> Any:
        """A std_msgs Header in this container's dialect."""
        stamp = self.make("builtin_interfaces/msg/Time", sec=stamp_ns // 10**9, nanosec=stamp_ns % 10**9)
        counter = {"seq": 0} if self.format == "bag" else {}
        return self.make("std_msgs/msg/Header", **counter, stamp=stamp, frame_id=frame_id)

    def write(self, topic: str, message: Any, time_ns: int) -> None:
        """Append a message as received at `time_ns`; a topic keeps the type of its first message.

        RecorderError if it finds no room.
        """
        serialize = self.typestore.serialize_ros1 if self.format == "bag" else self.typestore.serialize_cdr
        try:
            connection = self._connections.get(topic) or self._connect(topic, message.__msgtype__)
            self._writer.write(connection, time_ns, serialize(message, connection.msgtype))
        except FAILURES as failure:
            raise self._refused(failure) from failure

    def _connect(self, topic: str, msgtype: str) -> Connection:
        latched = topic in LATCHED
        if isinstance(self._writer, rosbag1.Writer):
            node, latching = "/recorder", 1 if latched else None
            connection = self._writer.add_connection(
                topic, msgtype, typestore=self.typestore, callerid=node, latching=latching
            )
        else:
            profiles = (_LATCHING,) if latched else ()
            connection = self._writer.add_connection(
                topic, msgtype, typestore=self.typestore, offered_qos_profiles=profiles
            )
        self._connections[topic] = connection
        return connection


def _typestore(container: BagFormat) -> Typestore:
    """The messages of ROS 1 Noetic (with the tf2 message, which is missing there) or ROS 2 Jazzy."""
    if container != "bag":
        return get_typestore(Stores.ROS2_JAZZY)
    store = get_typestore(Stores.ROS1_NOETIC)
    name = "tf2_msgs/msg/TFMessage"
    if name not in store.types:
        store.register(get_types_from_msg("geometry_msgs/TransformStamped[] transforms", name))
    return store
