import re

from hectorscope.common.resources import resource_folder
from hectorscope.page.scene import Display
from hectorscope.panels import match
from hectorscope.panels._palette import palette_css
from tests.page import room_snapshot


def test_the_style_sheet_has_todays_palette() -> None:
    """After a change of app/hectorscope/page/theme.py write it again: python -m hectorscope.panels._palette."""
    assert (resource_folder("static") / "palette.css").read_text(encoding="utf-8") == palette_css()


def test_every_colour_that_the_page_uses_is_defined() -> None:
    """No --hs- variable of the style sheet or of a read-out is missing from the palette."""
    sheets = ("hectorscope.css", "layout.css")
    style = "".join((resource_folder("static") / name).read_text(encoding="utf-8") for name in sheets)
    used = style + match.legend_html(room_snapshot(), Display())
    defined = palette_css() + style
    names = set(re.findall(r"var\(--hs-([a-z-]+)\)", used))
    assert names
    assert not [name for name in names if f"--hs-{name}:" not in defined]
