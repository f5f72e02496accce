"""Which topic plays which part, found by message type and name."""

from collections.abc import Iterable
from dataclasses import dataclass

from hectorscope.inputs import SourceError, SourceOptions
from slam_core.errors import nearest

SCAN = "sensor_msgs/msg/LaserScan"
IMU = "sensor_msgs/msg/Imu"
ODOMETRY = "nav_msgs/msg/Odometry"
PRESSURE = "sensor_msgs/msg/FluidPressure"
RANGE = "sensor_msgs/msg/Range"
MAGNETIC = "sensor_msgs/msg/MagneticField"
FIX = "sensor_msgs/msg/NavSatFix"
TWIST = "geometry_msgs/msg/TwistStamped"
TWIST_COVARIANCE = "geometry_msgs/msg/TwistWithCovarianceStamped"
POINT = "geometry_msgs/msg/PointStamped"
POSE = "geometry_msgs/msg/PoseStamped"
POSE_COVARIANCE = "geometry_msgs/msg/PoseWithCovarianceStamped"
TRANSFORM = "geometry_msgs/msg/TransformStamped"
TF_TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")

ROLE_TYPES: dict[str, tuple[str, ...]] = {
    "scan": (SCAN,),
    "imu": (IMU,),
    "attitude": (IMU,),
    "odometry": (ODOMETRY,),
    "height": (PRESSURE, POINT),
    "ground": (RANGE,),
    "magnetic": (MAGNETIC,),
    "gps": (FIX,),
    "gps_velocity": (TWIST, TWIST_COVARIANCE),
    "truth": (POSE, POSE_COVARIANCE, ODOMETRY, TRANSFORM),
}
# Asked for as a topic, it leaves a part out.
NOTHING = "none"
TRUTH_WORDS = ("truth", "vicon", "vrpn", "mocap", "ground")
HEIGHT_WORDS = ("height", "altitude", "altimeter", "baro")
GROUND_WORDS = (*HEIGHT_WORDS, "down")
GPS_WORDS = ("gps", "gnss", "fix", "navsat")
# Types that serve many purposes: only a topic with such a name is taken without being asked for.
_NAMED = {"ground": GROUND_WORDS, "gps_velocity": GPS_WORDS}


@dataclass(frozen=True, slots=True)
class Topic:
    """A topic on offer. messages, beams (of one scan): 0 where nobody knows yet."""

    name: str
    msgtype: str
    messages: int = 0
    beams: int = 0


@dataclass(frozen=True, slots=True)
class TfSpec:
    """A chain of transforms in the place of a topic, written tf:PARENT>CHILD."""

    parent: str
    child: str

    def __str__(self) -> str:
        return f"tf:{self.parent}>{self.child}"


@dataclass(frozen=True, slots=True)
class Roles:
    """The topic of each part, as the recording writes it; truth and attitude may be a TfSpec's text."""

    scan: str | None = None
    imu: str | None = None
    attitude: str | None = None
    odometry: str | None = None
    height: str | None = None
    ground: str | None = None
    magnetic: str | None = None
    gps: str | None = None
    gps_velocity: str | None = None
    truth: str | None = None
    transforms: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()

    def topics(self) -> frozenset[str]:
        """Every topic that has to be read."""
        parts = (*(getattr(self, role) for role in ROLE_TYPES), *self.transforms)
        return frozenset(topic for topic in parts if topic and tf_spec(topic) is None)


def tf_spec(topic: str) -> TfSpec | None:
    """The frames of "tf:PARENT>CHILD"; None for the name of a topic."""
    if not topic.startswith("tf:"):
        return None
    parent, arrow, child = topic[3:].partition(">")
    if not (parent and arrow and child):
        raise SourceError(f"{topic!r} is no chain of transforms: write tf:PARENT>CHILD, such as tf:map>base_link")
    return TfSpec(parent.strip("/ "), child.strip("/ "))


def is_static_tf(topic: str) -> bool:
    """Whether transforms of this topic hold for all times."""
    return topic.rsplit("/", maxsplit=1)[-1] == "tf_static"


def choose_roles(topics: Iterable[Topic], options: SourceOptions) -> Roles:
    """The best topic for each part; a part whose topic is not on offer (yet) stays None."""
    offer = sorted(topics, key=lambda topic: topic.name)
    chosen = {role: _choose(role, offer, options) for role in ROLE_TYPES}
    transforms = tuple(topic.name for topic in offer if topic.msgtype in TF_TYPES)
    return Roles(**chosen, transforms=transforms, notes=tuple(_scan_note(offer, chosen["scan"], options)))


def check_overrides(topics: Iterable[Topic], options: SourceOptions) -> None:
    """SourceError when a topic that a person asked for is missing or of the wrong type."""
    offer = sorted(topics, key=lambda topic: topic.name)
    for role, types in ROLE_TYPES.items():
        wanted = _wanted(role, options)
        if wanted is None or wanted == NOTHING:
            continue
        if role in ("attitude", "truth") and tf_spec(wanted):
            _check_tf(wanted, role, offer)
            continue
        fitting = [topic for topic in offer if topic.msgtype in types]
        if any(_same_name(topic.name, wanted) for topic in fitting):
            continue
        other = next((topic for topic in offer if _same_name(topic.name, wanted)), None)
        fact = f"topic {wanted!r} is a {other.msgtype}" if other else f"there is no topic {wanted!r}"
        if not other and (near := nearest(wanted, [topic.name for topic in fitting])):
            fact += f" (did you mean {near}?)"
        names = ", ".join(topic.name for topic in fitting) or "none here"
        flag = f"--{role.replace('_', '-')}-topic"
        raise SourceError(f"{fact}: {flag} takes one of {_short(types)} ({names})")


def _check_tf(wanted: str, role: str, offer: Iterable[Topic]) -> None:
    if not any(topic.msgtype in TF_TYPES for topic in offer):
        raise SourceError(
            f"{wanted} needs transforms, but no topic has any: give a topic as --{role}-topic, or none"
        )


def _choose(role: str, offer: list[Topic], options: SourceOptions) -> str | None:
    wanted = _wanted(role, options)
    if wanted == NOTHING:
        return None
    if wanted is not None and wanted.startswith("tf:"):
        return wanted
    fitting = [topic for topic in offer if topic.msgtype in ROLE_TYPES[role]]
    if wanted is not None:
        return next((topic.name for topic in fitting if _same_name(topic.name, wanted)), None)
    candidates = [topic for topic in fitting if _is_clear(role, topic)]
    best = max(candidates, key=lambda topic: topic.messages * max(topic.beams, 1), default=None)
    return best.name if best else None


def _is_clear(role: str, topic: Topic) -> bool:
    """Whether a topic of the right type may be taken for `role` without being asked for.

    An orientation in an Imu message often is a constant that nobody estimated, so attitude is only on request.
    """
    name = topic.name.lower()
    is_truth = any(word in name for word in TRUTH_WORDS)
    if role == "truth":
        return is_truth
    if role == "height":
        return topic.msgtype == PRESSURE or any(word in name for word in HEIGHT_WORDS)
    if role in _NAMED:
        return not is_truth and any(word in name for word in _NAMED[role])
    return role != "attitude" and not is_truth


def _wanted(role: str, options: SourceOptions) -> str | None:
    topic: str | None = getattr(options, f"{role}_topic")
    return topic


def _scan_note(offer: list[Topic], scan: str | None, options: SourceOptions) -> Iterable[str]:
    scans = [topic for topic in offer if topic.msgtype == SCAN]
    if scan and len(scans) > 1 and options.scan_topic is None:
        others = ", ".join(topic.name for topic in scans if topic.name != scan)
        yield f"{scan} gives the most beams of {len(scans)} scanners: --scan-topic takes another ({others})"


def _same_name(a: str, b: str) -> bool:
    return a.lstrip("/") == b.lstrip("/")


def _short(types: Iterable[str]) -> str:
    return ", ".join(name.replace("/msg/", "/") for name in types)
