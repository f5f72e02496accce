"""Decoded messages in, measurements out; nothing is lost without being counted and named."""

import math
from collections import Counter, defaultdict, deque
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from hectorscope.inputs import Item, SourceOptions, SourceReport
from hectorscope.ros import aid_messages, messages
from hectorscope.ros.arrivals import Arrival, Arrivals
from hectorscope.ros.messages import BadMessage
from hectorscope.ros.mounts import Mounts
from hectorscope.ros.repairs import Repairs
from hectorscope.ros.roles import PRESSURE, ROLE_TYPES, TF_TYPES, Roles, is_static_tf, tf_spec
from hectorscope.ros.stamps import AHEAD, Stamps
from hectorscope.ros.tf import TfTree
from hectorscope.ros.tf_poses import TfPoses
from slam_core.measurements import (
    Attitude,
    GpsPosition,
    GpsVelocity,
    GroundDistance,
    Height,
    Imu,
    LaserScan,
    MagneticField,
    Odometry,
    Transform,
    TruthPose,
)
from slam_core.navigation.aiding.geodesy import TangentPlane


@dataclass(slots=True, eq=False)
class _Pending:
    """A message on its way. stamp_ns: its own time. receive_ns: when it was recorded or received."""

    duty: "_Duty"
    topic: str
    message: Any
    stamp_ns: int
    receive_ns: int


# Gives the item of a message; None while tf does not contain its mount. The number: nanoseconds waited so far.
_Duty = Callable[[_Pending, float], Item | None]


class Converter:
    """Messages of one recording or connection to measurements, in order of arrival.

    A message whose mount is not known yet waits for tf, and those behind it wait too; `flush` ends the waiting.
    Stamps are by the clock of the scans (see `Arrivals`).
    """

    def __init__(self, roles: Roles, options: SourceOptions) -> None:
        self.tree = TfTree()
        self.mounts = Mounts(self.tree, options.base_frame)
        self._repairs, self._own_frame = Repairs(options), options.own_frame
        self._arrivals = Arrivals(roles, self._repairs, options.own_frame)
        self._tf_poses = TfPoses(self.tree, self.mounts)
        self._read: Counter[str] = Counter()
        self._skipped: Counter[str] = Counter()
        self._notes: dict[str, str] = {}
        self._waiting: deque[_Pending] = deque()
        self._stamps: defaultdict[str, Stamps] = defaultdict(Stamps)
        self._beams: dict[str, int] = {}
        self._height_origin: float | None = None
        self._plane: TangentPlane | None = None
        self.assign(roles)

    def assign(self, roles: Roles) -> None:
        """Take the topics of `roles` from now on (a live stream learns of its topics bit by bit)."""
        self.roles = roles
        self._arrivals.assign(roles)
        self._tf_poses.assign(roles)
        parts: dict[str, _Duty] = {
            "scan": self._scan,
            "imu": self._imu,
            "attitude": self._attitude,
            "odometry": self._odometry,
            "height": self._height,
            "ground": self._ground,
            "magnetic": self._magnetic,
            "gps": self._gps,
            "gps_velocity": self._gps_velocity,
            "truth": self._truth,
        }
        self._duties: dict[tuple[str, str], list[_Duty]] = {}  # one topic may come in several types
        for role, duty in parts.items():
            topic = getattr(roles, role)
            if topic is not None and tf_spec(topic) is None:
                for msgtype in ROLE_TYPES[role]:
                    self._duties.setdefault((topic, msgtype), []).append(duty)

    @property
    def report(self) -> SourceReport:
        """Counters so far, and what was found or assumed."""
        notes = (*self.roles.notes, *self.mounts.notes.values(), *self._tf_poses.notes(), *self._notes.values())
        plane = self._plane
        origin = (plane.latitude, plane.longitude, plane.altitude) if plane else None
        warnings = self._arrivals.warnings()
        return SourceReport(dict(self._read), dict(self._skipped), notes=notes, warnings=warnings, origin=origin)

    @property
    def put_right(self) -> tuple[str, ...]:
        """Topics, and frames of tf, whose clocks are put beside that of the scans."""
        return self._arrivals.put_right

    def convert(self, topic: str, msgtype: str, message: Any, receive_ns: int) -> list[Item]:
        """What may go on now that `message` (a rosbags object) has come; what has no part gives nothing."""
        if not ((topic in self.roles.transforms and msgtype in TF_TYPES) or (topic, msgtype) in self._duties):
            return []
        self._read[topic] += 1
        own_ns = messages.stamp_ns(message, receive_ns)
        arrived = self._arrivals.push(Arrival(topic, msgtype, message, receive_ns, own_ns))
        return [item for each in arrived for item in self._take(each)]

    def flush(self) -> list[Item]:
        """What still waits, at the end."""
        arrived = [item for each in self._arrivals.flush() for item in self._take(each)]
        return [*arrived, *self._release(math.inf)]

    def skip(self, topic: str, reason: str) -> None:
        """Count a message that was left out, under its topic and reason."""
        self._skipped[f"{topic}: {reason}"] += 1

    def _take(self, arrival: Arrival) -> list[Item]:
        """What may go on behind a message whose clock is known."""
        topic, receive_ns = arrival.topic, arrival.receive_ns
        if arrival.is_transforms:
            return [*self._transforms(arrival), *self._release(receive_ns)]
        stamp_ns = self._arrivals.stamp_ns(arrival)
        fault = self._stamps[topic].fault(stamp_ns, receive_ns)
        if fault:
            self.skip(topic, fault)
            return []
        for duty in self._duties.get((topic, arrival.msgtype), ()):
            self._waiting.append(_Pending(duty, topic, arrival.message, stamp_ns, receive_ns))
        return self._release(receive_ns)

    def _release(self, now_ns: float) -> list[Item]:
        """Items of the messages that need not wait any more, in their order."""
        items: list[Item] = []
        while self._waiting:
            pending = self._waiting[0]
            waited_ns = abs(now_ns - pending.receive_ns) if self.roles.transforms else math.inf
            try:
                item = pending.duty(pending, waited_ns)
                if item is None:
                    break
                items.append(item)
            except BadMessage as reason:
                self.skip(pending.topic, str(reason))
            self._waiting.popleft()
        return items

    def _mount(self, pending: _Pending, waited_ns: float, time_ns: int | None = None) -> Transform | None:
        return self.mounts.find(messages.frame_id(pending.message), time_ns or pending.stamp_ns, waited_ns)

    # ---------------------------------------------------------------------------------------- duties

    def _scan(self, pending: _Pending, waited_ns: float) -> LaserScan | None:
        message = pending.message
        stamp_ns = pending.stamp_ns - self._repairs.scan_delay_ns
        middle_ns = stamp_ns + self._repairs.sweep_ns(messages.sweep_ns(message)) // 2
        mount = self._repairs.laser_pose or self._mount(pending, waited_ns, middle_ns)
        if mount is None:
            return None
        beams = len(message.ranges)
        if self._beams.setdefault(pending.topic, beams) != beams:
            self._notes["beams"] = f"{pending.topic}: the number of beams varies"
        return self._repairs.scan(messages.laser_scan(message, stamp_ns, messages.near_base(mount)))

    def _imu(self, pending: _Pending, waited_ns: float) -> Imu | None:
        mount = self._mount(pending, waited_ns)
        if mount is None:
            return None
        stamp_ns = pending.stamp_ns - self._repairs.imu_delay_ns
        return self._repairs.imu(messages.imu(pending.message, stamp_ns, mount.rotation))

    def _attitude(self, pending: _Pending, waited_ns: float) -> Attitude | None:
        mount = self._mount(pending, waited_ns)
        if mount is None:
            return None
        stamp_ns = pending.stamp_ns - self._repairs.imu_delay_ns
        return self._repairs.attitude(messages.imu_attitude(pending.message, stamp_ns, mount.rotation))

    def _odometry(self, pending: _Pending, _waited_ns: float) -> Odometry:
        return messages.odometry(pending.message, pending.stamp_ns)

    def _truth(self, pending: _Pending, _waited_ns: float) -> TruthPose:
        return messages.truth_pose(pending.message, pending.stamp_ns)

    def _height(self, pending: _Pending, _waited_ns: float) -> Height:
        """Heights count from the first one."""
        message = pending.message
        pressure = messages.message_type(message) == PRESSURE
        value = messages.pressure_altitude(message) if pressure else messages.point_height(message)
        if self._height_origin is None:
            self._height_origin = value
        return Height(pending.stamp_ns, value - self._height_origin)

    def _ground(self, pending: _Pending, waited_ns: float) -> GroundDistance | None:
        mount = self._mount(pending, waited_ns)
        if mount is None:
            return None
        mount = mount if self.roles.transforms else messages.LOOKING_DOWN
        return aid_messages.ground_distance(pending.message, pending.stamp_ns, mount)

    def _magnetic(self, pending: _Pending, waited_ns: float) -> MagneticField | None:
        mount = self._mount(pending, waited_ns)
        if mount is None:
            return None
        stamp_ns = pending.stamp_ns - self._repairs.imu_delay_ns
        return self._repairs.magnetic(aid_messages.magnetic_field(pending.message, stamp_ns, mount.rotation))

    def _gps(self, pending: _Pending, waited_ns: float) -> GpsPosition | None:
        """Positions count from the first one."""
        mount = self._mount(pending, waited_ns)
        if mount is None:
            return None
        if self._plane is None:
            latitude, longitude, altitude = aid_messages.geodetic(pending.message)
            self._plane = TangentPlane(latitude, longitude, altitude if math.isfinite(altitude) else 0.0)
            self._notes["gps"] = f"{pending.topic}: east and north count from {latitude:.6f}°, {longitude:.6f}°"
        return aid_messages.gps_position(pending.message, pending.stamp_ns, self._plane, mount.translation)

    def _gps_velocity(self, pending: _Pending, _waited_ns: float) -> GpsVelocity:
        return aid_messages.gps_velocity(pending.message, pending.stamp_ns)

    def _transforms(self, arrival: Arrival) -> list[Item]:
        """Grow the tf tree; items for the chains that stand for attitude or truth."""
        topic, static = arrival.topic, is_static_tf(arrival.topic)
        updated: dict[str, int] = {}
        for stamped in arrival.message.transforms:
            try:
                T = messages.transform(stamped.transform)
            except BadMessage as reason:
                self.skip(topic, str(reason))
                continue
            child, parent = stamped.child_frame_id.strip("/"), messages.frame_id(stamped)
            if parent == self._own_frame:
                continue
            stamp_ns, receive_ns = self._arrivals.frame_stamp_ns(arrival, stamped), arrival.receive_ns
            fault = self.tree.add(parent, child, stamp_ns, T, static=static, receive_ns=receive_ns)
            if not fault:
                updated[child] = stamp_ns
            elif fault == AHEAD:  # late and repeated transforms are common
                self.skip(topic, fault)
        return self._tf_poses.after(updated)
