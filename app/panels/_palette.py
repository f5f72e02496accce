"""The palette of the scene as CSS variables, so that the page and the map wear the same colours."""

from app.web.theme import Rgb, Theme, css

SKY: dict[bool, Rgb] = {True: (56, 104, 150), False: (98, 158, 210)}  # by Theme.dark
GROUND: dict[bool, Rgb] = {True: (98, 78, 60), False: (176, 140, 104)}


MEANINGS = ("match", "prior", "fused", "position", "trajectory", "truth", "robot", "accent", "warning", "error")


def palette_css(theme: Theme) -> str:
    """A style element that defines --hs-text and its siblings."""
    colours = {name: css(getattr(theme, name)) for name in ("surface", "text", "muted", *MEANINGS)} | {
        "field": css(theme.background),
        "line": css(theme.grid),
        "on-accent": css(theme.background if theme.dark else theme.surface),
        "sky": css(SKY[theme.dark]),
        "ground": css(GROUND[theme.dark]),
        "ramp": f"linear-gradient(90deg, {', '.join(css(stop) for stop in theme.ramp)})",
    }
    return f"<style>:root{{{';'.join(f'--hs-{name}:{value}' for name, value in colours.items())}}}</style>"
