"""One control for each kind of value: a slider, a logarithmic slider with a box beside it, a choice, a switch."""

import math
from collections.abc import Callable, Coroutine, Mapping
from typing import Any, Protocol

from viser import GuiApi, GuiEvent

from hectorscope.panels._format import hint, label, number
from hectorscope.panels._handles import put_value
from hectorscope.panels._slider import Scale, scale_of
from slam_core.config import Leaf

Touch = Callable[[GuiEvent[Any]], None]


class Control(Protocol):
    """Shows a value and reads what a person made of it. Its `touched` hears of browsers, never of `show`."""

    def read(self) -> Any:
        """The value now; from a browser, so to be checked."""

    def show(self, value: Any) -> None:
        """Show another value in every browser."""


def control_for(gui: GuiApi, leaf: Leaf, touched: Touch) -> Control:
    """The control that fits a setting."""
    name, help_text = label(leaf), hint(leaf)
    if leaf.choices:
        names = {word: word.replace("_", " ") for word in leaf.choices}
        return Choice(gui, name, names, leaf.value, help_text, touched)
    if leaf.type is bool:
        return Switch(gui, name, leaf.value, help_text, touched)
    kind = LogSlider if leaf.param.log else LinearSlider
    return kind(gui, name, scale_of(leaf), leaf.value, help_text, touched)


def by_hand(touched: Touch) -> Callable[[GuiEvent[Any]], Coroutine[Any, Any, None]]:
    """`touched` for events of browsers only: values set by the server fire callbacks too.

    A coroutine, as viser runs it where it sets the value. A function waits for a thread: a panel that draws
    meanwhile shows the value of the run again, and what the hand has set is lost.
    """

    async def filtered(event: GuiEvent[Any]) -> None:
        if event.client is not None:
            touched(event)

    return filtered


class LinearSlider:
    """A slider whose box takes a typed value."""

    def __init__(self, gui: GuiApi, name: str, scale: Scale, value: float, help_text: str, touched: Touch) -> None:
        self._scale = scale
        kind: type[int] | type[float] = int if scale.integer else float
        self._slider = gui.add_slider(
            name, kind(scale.low), kind(scale.high), kind(scale.step), initial_value=kind(value), hint=help_text
        )
        self._slider.on_update(by_hand(touched))

    def read(self) -> float:
        """The slider's value."""
        return self._scale.from_slider(self._slider.value)

    def show(self, value: float) -> None:
        """Move the slider."""
        put_value(self._slider, value)


class LogSlider:
    """A slider over decades and a box with the value itself; each follows the other."""

    def __init__(self, gui: GuiApi, name: str, scale: Scale, value: float, help_text: str, touched: Touch) -> None:
        self._scale, self._shown = scale, value
        low, high = 10.0**scale.low, 10.0**scale.high
        ends = ((scale.low, number(low, 4)), (scale.high, number(high, 4)))
        gui.add_html('<i class="hs-mark hs-log"></i>')
        self._slider = gui.add_slider(
            name,
            scale.low,
            scale.high,
            scale.step,
            initial_value=scale.to_slider(value),
            marks=ends,
            hint=help_text,
        )
        step = 10.0 ** math.floor(scale.low - 1)
        self._number = gui.add_number(name, float(value), min=low, max=high, step=step, hint=help_text)
        self._typed = False
        self._slider.on_update(by_hand(lambda event: self._touch(event, False, touched)))
        self._number.on_update(by_hand(lambda event: self._touch(event, True, touched)))

    def _touch(self, event: GuiEvent[Any], typed: bool, touched: Touch) -> None:
        self._typed = typed
        touched(event)

    def read(self) -> float:
        """The value of whichever of the two was touched last."""
        return self._number.value if self._typed else self._scale.from_slider(self._slider.value)

    def show(self, value: float) -> None:
        """Move both, but not the slider under the hand that just set this value with it."""
        put_value(self._number, value)
        if self._scale.from_slider(self._slider.value) != value:
            put_value(self._slider, self._scale.to_slider(value))


class Choice:
    """A drop-down list; `names` gives each word as it is shown."""

    def __init__(
        self, gui: GuiApi, name: str, names: Mapping[str, str], value: str, help_text: str, touched: Touch
    ) -> None:
        self._names = names
        self._list = gui.add_dropdown(name, tuple(names.values()), initial_value=names[value], hint=help_text)
        self._list.on_update(by_hand(touched))

    @property
    def visible(self) -> bool:
        """Whether it is shown."""
        return self._list.visible

    @visible.setter
    def visible(self, visible: bool) -> None:
        if self._list.visible != visible:
            self._list.visible = visible

    def read(self) -> str:
        """The word chosen, as the configuration spells it."""
        return next((word for word, name in self._names.items() if name == self._list.value), "")

    def show(self, value: str) -> None:
        """Choose a word."""
        put_value(self._list, self._names[value])


class Switch:
    """A tick box."""

    def __init__(self, gui: GuiApi, name: str, value: bool, help_text: str | None, touched: Touch) -> None:
        self._box = gui.add_checkbox(name, value, hint=help_text)
        self._box.on_update(by_hand(touched))

    def read(self) -> bool:
        """Whether it is ticked."""
        return self._box.value

    def show(self, value: bool) -> None:
        """Tick it or not."""
        put_value(self._box, value)
