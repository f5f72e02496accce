"""Chains of transforms that stand for a measurement: the attitude that somebody publishes to tf, or the truth."""

from hectorscope.inputs import Item
from hectorscope.ros.mounts import Mounts
from hectorscope.ros.roles import Roles, TfSpec, tf_spec
from hectorscope.ros.stamps import SET_BACK_NS
from hectorscope.ros.tf import TfTree
from slam_core.measurements import Attitude, Transform, TruthPose

# A base that never leans further than this gives no attitude: sin^2 of half of 0.1 degrees.
LEVEL = 7.6e-7


class TfPoses:
    """Watches tf for poses of the base.

    Without an IMU the attitude of the base in the root of its tree (odom or map, which stand level) is taken from
    the moment on when it first leans; before, level was right as well.
    """

    def __init__(self, tree: TfTree, mounts: Mounts) -> None:
        self._tree = tree
        self._mounts = mounts
        self._leaning = False
        self._latest_ns: dict[str, int] = {}

    def assign(self, roles: Roles) -> None:
        """Follow the chains that `roles` names."""
        self._automatic = roles.imu is None and roles.attitude is None
        self._attitude = tf_spec(roles.attitude or "")
        self._truth = tf_spec(roles.truth or "")

    def after(self, updated: dict[str, int]) -> list[Item]:
        """The new poses in tf, after transforms of these child frames came with these stamps."""
        items: list[Item] = []
        spec = self._automatic_chain() if self._automatic else self._attitude
        pose = self._news("attitude", spec, updated)
        if pose is not None and (not self._automatic or self._leans(pose[1])):
            items.append(Attitude(pose[0], pose[1].rotation))
        truth = self._news("truth", self._truth, updated)
        if truth is not None:
            items.append(TruthPose(*truth))
        return items

    def notes(self) -> list[str]:
        """Which chain was found, and which cannot be followed."""
        found = [f"attitude from {self._automatic_chain()}"] if self._leaning else []
        known = ", ".join(self._tree.frames()) or "no frames"
        return found + [
            f"{spec}: tf does not join these frames, it knows {known}"
            for spec in (self._attitude, self._truth)
            if spec is not None and self._tree.lookup(spec.parent, spec.child, 0) is None
        ]

    def _automatic_chain(self) -> TfSpec | None:
        base = self._mounts.guess_base()
        return TfSpec(self._tree.climb(base)[-1], base) if base else None

    def _news(self, use: str, spec: TfSpec | None, updated: dict[str, int]) -> tuple[int, Transform] | None:
        """(stamp, T_parent_child) for one use of a chain, if the edge that carries it went on, or was set back."""
        carrier = self._tree.carrier(spec.parent, spec.child) if spec else None
        if spec is None or carrier not in updated:
            return None
        stamp_ns = updated[carrier]
        if 0 <= self._latest_ns.get(use, stamp_ns - 1) - stamp_ns <= SET_BACK_NS:
            return None
        self._latest_ns[use] = stamp_ns
        T = self._tree.lookup(spec.parent, spec.child, stamp_ns)
        return None if T is None else (stamp_ns, T)

    def _leans(self, T: Transform) -> bool:
        self._leaning |= bool(T.rotation[1] ** 2 + T.rotation[2] ** 2 > LEVEL)
        return self._leaning
