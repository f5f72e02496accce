"""When the robot is on the page."""

from dataclasses import replace

from hectorscope.page.scene import Scene
from hectorscope.session.snapshot import Snapshot
from hectorscope.views.frames import FramesView
from hectorscope.views.robot import RobotView
from tests.page import room_snapshot


def test_no_robot_is_shown_before_its_first_pose(scene: Scene) -> None:
    """Neither body nor outline is there until a scan has a result, or once a run begins anew: 0, 0 is no pose."""
    view = RobotView(scene)
    shown = [_shown(view)]
    for snapshot in (Snapshot(), room_snapshot(), Snapshot()):
        view.draw(snapshot)
        shown.append(_shown(view))
    assert shown == [(False, False), (False, False), (True, True), (False, False)]


def _shown(view: RobotView) -> tuple[bool, bool]:
    return view._hull.visible, view._ring.visible


def test_the_frames_of_the_robot_go_with_it(scene: Scene) -> None:
    """A run begun anew has no pose to show them at."""
    view, shown = FramesView(scene), []
    for sequence, snapshot in enumerate((room_snapshot(), Snapshot(), room_snapshot()), 1):
        view.draw(replace(snapshot, sequence=sequence))
        shown.append({frame.visible for frame in view._frames.values()})
    assert shown == [{True}, {False}, {True}]
