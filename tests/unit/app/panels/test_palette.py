import re

from app.panels import match
from app.panels._palette import palette_css
from app.web.files import static_folder
from app.web.stage import Display
from tests.page import room_snapshot


def test_the_style_sheet_has_todays_palette() -> None:
    """After a change of app/web/theme.py write it again: python -m app.panels._palette."""
    assert (static_folder() / "palette.css").read_text(encoding="utf-8") == palette_css()


def test_every_colour_that_the_page_uses_is_defined() -> None:
    """No --hs- variable of the style sheet or of a read-out is missing from the palette."""
    style = (static_folder() / "hectorscope.css").read_text(encoding="utf-8")
    used = style + match.legend_html(room_snapshot(), Display())
    defined = palette_css() + style
    names = set(re.findall(r"var\(--hs-([a-z-]+)\)", used))
    assert names
    assert not [name for name in names if f"--hs-{name}:" not in defined]
