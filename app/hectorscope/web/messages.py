"""Messages that a browser may send: values of controls within their bounds, and few more. All else is dropped."""

import math
from collections.abc import Callable, Iterable, Mapping
from typing import Any

import viser

MAX_TEXT = 1000  # characters in a text field
MAX_REQUEST = 60_000  # and in a hidden one: what a script asks for, all notes of an export among it
MAX_PIXELS = 100_000  # of a window, either way

Find = Callable[[str], Any]


class RefusedError(ValueError):
    """A value that its control could not have sent."""


def admit(message: Any, find: Find) -> dict[str, Any] | None:
    """The message as it may pass, None when it is dropped; `find` gives the control of a uuid, or None."""
    try:
        return passed(message) or checked(message, find)
    except RefusedError:
        return None


def passed(message: Any) -> dict[str, Any] | None:
    """A message that is no change of a value, with the fields that viser takes; None for one of another type."""
    match message:
        case {"type": str(name), **fields} if name in PASSED:
            rules = PASSED[name]
            require(name, fields.keys() == rules.keys())
            return {"type": name, **{field: rule(fields[field]) for field, rule in rules.items()}}
    return None


def checked(message: Any, find: Find) -> dict[str, Any]:
    """The change of a control's value, bounded; RefusedError for anything else."""
    match message:
        case {"type": "GuiUpdateMessage", "uuid": str(uuid), "updates": {"value": value, **others}} if not others:
            control = find(uuid)
            require(control, control is not None and not control.disabled)
            return {"type": "GuiUpdateMessage", "uuid": uuid, "updates": {"value": bounded(control, value)}}
    raise RefusedError("no change of a value")


def bounded(control: Any, value: Any) -> Any:
    """`value` brought into the range of `control`; RefusedError when no such control sends it."""
    for kinds, rule in RULES:
        if isinstance(control, kinds):
            return rule(control, value)
    raise RefusedError(type(control).__name__)


def clamp(value: Any, low: float | None, high: float | None) -> float:
    """A finite number inside [low, high]; None means open."""
    require(value, isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value))
    within: float = value
    if low is not None:
        within = max(low, within)
    return within if high is None else min(high, within)


def row(value: Any, size: int) -> Iterable[Any]:
    """A list of `size` items."""
    return list(require(value, isinstance(value, list | tuple) and len(value) == size))


def numbers(size: int) -> Callable[[Any], list[float]]:
    """The rule for so many finite numbers."""
    return lambda value: [number(each) for each in row(value, size)]


def number(value: Any) -> float:
    """A finite number."""
    return clamp(value, None, None)


def pixels(value: Any) -> int:
    """The size of a window."""
    return int(clamp(value, 1, MAX_PIXELS))


def text(value: Any, longest: int = MAX_TEXT) -> str:
    """A short text."""
    words: str = require(value, isinstance(value, str) and len(value) <= longest)
    return words


def require(value: Any, good: bool) -> Any:
    """`value` if it is good."""
    if not good:
        raise RefusedError(repr(value)[:80])
    return value


def vector(control: Any, value: Any) -> list[float]:
    """Each component within its own bounds."""
    size = len(control.value)
    lows, highs = (bound or (None,) * size for bound in (control.min, control.max))
    return [clamp(*item) for item in zip(row(value, size), lows, highs, strict=True)]


RULES: tuple[tuple[tuple[type, ...], Callable[[Any, Any], Any]], ...] = (
    ((viser.GuiButtonHandle,), lambda _, __: True),
    ((viser.GuiCheckboxHandle,), lambda _, value: require(value, isinstance(value, bool))),
    (
        (viser.GuiTextHandle,),
        lambda control, value: text(value, MAX_TEXT if control.visible else MAX_REQUEST),
    ),
    (
        (viser.GuiDropdownHandle, viser.GuiButtonGroupHandle),
        lambda control, value: require(value, value in tuple(control.options)),
    ),
    (
        (viser.GuiSliderHandle, viser.GuiNumberHandle),
        lambda control, value: clamp(value, control.min, control.max),
    ),
    (
        (viser.GuiMultiSliderHandle,),
        lambda control, value: [clamp(v, control.min, control.max) for v in row(value, len(control.value))],
    ),
    (
        (viser.GuiRgbHandle, viser.GuiRgbaHandle),
        lambda control, value: [int(clamp(v, 0, 255)) for v in row(value, len(control.value))],
    ),
    ((viser.GuiVector2Handle, viser.GuiVector3Handle), vector),
)

# The fields of the other messages that pass: viser relies on their types.
PASSED: Mapping[str, Mapping[str, Callable[[Any], Any]]] = {
    "ViewerCameraMessage": {
        "wxyz": numbers(4),
        **dict.fromkeys(("position", "look_at", "up_direction"), numbers(3)),
        **dict.fromkeys(("fov", "near", "far"), number),
        **dict.fromkeys(("image_height", "image_width"), pixels),
    },
    "GuiButtonHoldMessage": {"uuid": text, "frequency": number},
    "CommandTriggerMessage": {"uuid": text},
    # Of the handle in a browser's own scene (panels/_xray_scene.py); there is none that browsers share.
    "TransformControlsUpdateMessage": {"name": text, "owner": text, "wxyz": numbers(4), "position": numbers(3)},
    "TransformControlsDragStartMessage": {"name": text, "owner": text},
    "TransformControlsDragEndMessage": {"name": text, "owner": text},
}
