"""Assigning to viser's handles: only what changed, in one place."""

from typing import Any

from viser import GuiButtonHandle, GuiHtmlHandle, GuiInputHandle


def put(handle: GuiHtmlHandle, content: str) -> None:
    """Send new content, if it is new."""
    if handle.content != content:
        handle.content = content


def put_value(handle: GuiInputHandle[Any], value: Any) -> None:
    """Show a value in every browser; viser itself keeps quiet when it is the old one."""
    handle.value = value  # type: ignore[misc]  # viser defines the setter apart from its property


def show(control: GuiButtonHandle | GuiInputHandle[Any], visible: bool) -> None:
    """Show or hide a control, if it is not so already."""
    if control.visible != visible:
        control.visible = visible
