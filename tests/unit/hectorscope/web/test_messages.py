"""Which messages of a browser pass, and with which values."""

import math
from typing import Any

import pytest
import viser

from hectorscope.page.viser_private import input_control
from hectorscope.web.messages import admit


def update(control: Any, value: Any, server: viser.ViserServer) -> Any:
    """The value that passes, or None when the message is dropped."""
    uuid = control._impl.uuid
    message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": value}}
    passed = admit(message, lambda name: input_control(server, name))
    return passed["updates"]["value"] if passed else None


@pytest.mark.parametrize(
    "value, expected", [(0.5, 0.5), (99, 1.0), (-99, 0.0), (math.nan, None), ("1", None), (True, None)]
)
def test_sliders_are_clamped(server: viser.ViserServer, value: Any, expected: float | None) -> None:
    """A slider's value is brought into its bounds; what is no number is dropped."""
    slider = server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.3)
    assert update(slider, value, server) == expected


def test_numbers_may_be_open(server: viser.ViserServer) -> None:
    """A number without bounds takes every finite value; infinity is none."""
    number = server.gui.add_number("n", 1.0, min=0.0)
    assert update(number, 1e9, server) == 1e9
    assert update(number, -1.0, server) == 0.0
    assert update(number, math.inf, server) is None


def test_choices_are_among_the_options(server: viser.ViserServer) -> None:
    """Dropdowns and button groups take their own options only."""
    for control in (server.gui.add_dropdown("d", ("a", "b")), server.gui.add_button_group("g", ("a", "b"))):
        assert update(control, "b", server) == "b"
        assert update(control, "c", server) is None


def test_other_controls_take_their_own_kind(server: viser.ViserServer) -> None:
    """Switches take truth values, texts short texts, colours bytes, vectors as many numbers as they have."""
    gui = server.gui
    assert update(gui.add_checkbox("c", False), 1, server) is None
    assert update(gui.add_text("t", ""), "x" * 2000, server) is None
    assert update(gui.add_text("t", ""), "map", server) == "map"
    assert update(gui.add_rgb("r", (0, 0, 0)), [1, 300, -5], server) == [1, 255, 0]
    vector = gui.add_vector3("v", (0.0, 0.0, 0.0), min=(-1.0, -1.0, -1.0), max=(1.0, 1.0, 1.0))
    assert update(vector, [5, -5, 0], server) == [1.0, -1.0, 0]
    assert update(vector, [5, -5], server) is None


def test_disabled_controls_do_not_move(server: viser.ViserServer) -> None:
    """What the page shows greyed out cannot be changed by a message either."""
    assert update(server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.3, disabled=True), 0.5, server) is None


@pytest.mark.parametrize(
    "message",
    [
        {"type": "ShareUrlRequest"},
        {"type": "ShareUrlDisconnect"},
        {"type": "FileTransferStartUpload"},
        {"type": "RunJavascriptMessage", "source": "alert(1)"},
        {"type": "SceneNodeUpdateMessage", "name": "/robot", "updates": {}},
        {"type": "GuiUpdateMessage", "uuid": "nobody", "updates": {"value": 1}},
        {"type": "GuiUpdateMessage", "uuid": 5, "updates": {"value": 1}},
        {"type": "GuiUpdateMessage", "uuid": "x"},
        [1, 2],
        None,
    ],
)
def test_everything_else_is_dropped(server: viser.ViserServer, message: Any) -> None:
    """Public tunnels, uploads, scripts, changes of the scene and nonsense never reach viser."""
    assert admit(message, lambda name: input_control(server, name)) is None


CAMERA = {
    "type": "ViewerCameraMessage",
    "wxyz": [1.0, 0.0, 0.0, 0.0],
    "position": [0, 0, 5],
    "fov": 1.3,
    "near": 0.01,
    "far": 1000.0,
    "image_height": 600,
    "image_width": 800,
    "look_at": [0.0, 0.0, 0.0],
    "up_direction": [0.0, 0.0, 1.0],
}


def test_the_camera_of_a_browser_passes(server: viser.ViserServer) -> None:
    """As it is; a window of any size is one that can be."""
    assert admit(CAMERA, lambda _: None) == CAMERA
    wide = admit({**CAMERA, "image_width": 1e300}, lambda _: None)
    assert wide is not None and wide["image_width"] == 100_000


@pytest.mark.parametrize(
    "changes",
    [
        {"wxyz": "abcd"},
        {"position": [1.0, 2.0]},
        {"position": [1.0, 2.0, math.nan]},
        {"look_at": [[1.0], 2.0, 3.0]},
        {"fov": None},
        {"far": math.inf},
        {"image_width": "800"},
        {"near": True},
        {"owner": "x"},
    ],
)
def test_an_ill_typed_camera_is_dropped(changes: dict[str, Any]) -> None:
    """Its fields are taken by the page's library as they are."""
    assert admit({**CAMERA, **changes}, lambda _: None) is None


@pytest.mark.parametrize("field", sorted(CAMERA.keys() - {"type"}))
def test_a_camera_that_lacks_something_is_dropped(field: str) -> None:
    """All of its fields, or none."""
    assert admit({name: value for name, value in CAMERA.items() if name != field}, lambda _: None) is None


@pytest.mark.parametrize(
    "message",
    [
        {"type": "GuiButtonHoldMessage", "uuid": "x", "frequency": [1]},
        {"type": "GuiButtonHoldMessage", "uuid": ["x"], "frequency": 1.0},
        {"type": "CommandTriggerMessage"},
        {"type": "CommandTriggerMessage", "uuid": {"a": 1}},
        {"type": ["ViewerCameraMessage"]},
        {"type": {}},
    ],
)
def test_other_ill_typed_messages_are_dropped(message: Any) -> None:
    """Lists and maps where viser looks up a text."""
    assert admit(message, lambda _: None) is None


def test_internals_of_a_control_cannot_be_set(server: viser.ViserServer) -> None:
    """A message may change a control's value and nothing else of it."""
    uuid = server.gui.add_slider("s", 0.0, 1.0, 0.1, 0.3)._impl.uuid
    message = {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": 0.5, "update_cb": []}}
    assert admit(message, lambda name: input_control(server, name)) is None


def test_a_dragged_handle_sends_its_pose() -> None:
    """Name, owner and finite numbers of the right count pass; anything else is dropped."""
    good = {"type": "TransformControlsUpdateMessage", "name": "/a", "owner": "3", "wxyz": [1.0, 0.0, 0.0, 0.0]}
    assert admit({**good, "position": [1.0, 2.0, 0.0]}, lambda _: None)
    for position in ([1.0, 2.0], [1.0, math.nan, 0.0], "here", [1.0, True, 0.0]):
        assert admit({**good, "position": position}, lambda _: None) is None
    assert admit({"type": "TransformControlsDragEndMessage", "name": "/a", "owner": "3"}, lambda _: None)
    assert admit({"type": "TransformControlsDragEndMessage", "name": "/a"}, lambda _: None) is None
