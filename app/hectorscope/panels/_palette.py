"""The palette of the scene as a style sheet, so that the page and the map wear the same colours.

Written to static/palette.css by: python -m hectorscope.panels._palette
"""

from hectorscope.common.resources import resource_folder
from hectorscope.page.theme import DARK, LIGHT, Rgb, Theme, css

SHARED = ("surface", "text", "muted", "accent", "warning", "error")
MEANINGS = ("match", "prior", "fused", "position", "trajectory", "truth", "robot", "unexpected")
SKY: dict[bool, Rgb] = {True: (56, 104, 150), False: (98, 158, 210)}  # by Theme.dark
GROUND: dict[bool, Rgb] = {True: (98, 78, 60), False: (176, 140, 104)}


def palette_css() -> str:
    """Variables --hs-text and its siblings for both themes; dark until the page knows better."""
    light = ':root[data-mantine-color-scheme="light"]'
    return f"/* Written by app/hectorscope/panels/_palette.py */\n{rule(':root', DARK)}{rule(light, LIGHT)}"


def rule(selector: str, theme: Theme) -> str:
    """The variables of one theme."""
    colours = {name: css(getattr(theme, name)) for name in SHARED + MEANINGS} | {
        "field": css(theme.background),
        "line": css(theme.grid),
        "on-accent": css(theme.background if theme.dark else theme.surface),
        "sky": css(SKY[theme.dark]),
        "ground": css(GROUND[theme.dark]),
        "ramp": f"linear-gradient(90deg, {', '.join(css(stop) for stop in theme.ramp)})",
    }
    lines = "".join(f"  --hs-{name}: {value};\n" for name, value in colours.items())
    return f"{selector} {{\n{lines}}}\n"


if __name__ == "__main__":
    (resource_folder("static") / "palette.css").write_text(palette_css(), encoding="utf-8")
