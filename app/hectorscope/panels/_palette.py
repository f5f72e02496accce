"""The palette of the scene as a style sheet, so that the page and the map wear the same colours.

Written to static/palette.css by: python -m hectorscope.panels._palette
"""

from hectorscope.common.resources import resource_folder
from hectorscope.page.theme import DARK, LIGHT, SENT, Rgb, Theme, css

PAGE = ("surface", "field", "line", "text", "muted", "accent", "warning", "error")
SCENE = ("background", "grid", "free", "occupied")
MEANINGS = ("match", "prior", "fused", "position", "compared", "trajectory", "truth", "robot", "unexpected")
SKY: dict[bool, Rgb] = {True: (56, 104, 150), False: (98, 158, 210)}  # by Theme.dark
GROUND: dict[bool, Rgb] = {True: (98, 78, 60), False: (176, 140, 104)}


def palette_css() -> str:
    """Variables --hs-text and its siblings for both themes, and --hs-sent-... for what static/dress.js changes."""
    light = ':root[data-mantine-color-scheme="light"]'
    return (
        f"/* Written by app/hectorscope/panels/_palette.py */\n{rule(':root', DARK, sent())}{rule(light, LIGHT)}"
    )


def rule(selector: str, theme: Theme, more: dict[str, str] | None = None) -> str:
    """The variables of one theme."""
    colours = {name: css(getattr(theme, name)) for name in PAGE + SCENE + MEANINGS} | {
        "on-accent": css(theme.field if theme.dark else theme.surface),
        "sky": css(SKY[theme.dark]),
        "ground": css(GROUND[theme.dark]),
        "ramp": f"linear-gradient(90deg, {', '.join(css(stop) for stop in theme.ramp)})",
        "ramps": listed(theme.ramp),
        "series": listed(theme.series),
        "veil": " ".join(f"{opacity:g}" for opacity in theme.veil),
    }
    lines = "".join(f"  --hs-{name}: {value};\n" for name, value in (colours | (more or {})).items())
    return f"{selector} {{\n{lines}}}\n"


def sent() -> dict[str, str]:
    """The colours of what the server draws, by which the page's script knows them."""
    names = ("free", "occupied", "accent", "unexpected")
    return {f"sent-{name}": css(getattr(SENT, name)) for name in names} | {"sent-ramps": listed(SENT.ramp)}


def listed(colours: tuple[Rgb, ...]) -> str:
    """Several colours, with a space between them."""
    return " ".join(css(colour) for colour in colours)


if __name__ == "__main__":
    (resource_folder("static") / "palette.css").write_text(palette_css(), encoding="utf-8")
