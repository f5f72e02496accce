"""The palette of the scene as CSS variables, so that the page and the map wear the same colours."""

from app.web.theme import Rgb, Theme, css

SKY: dict[bool, Rgb] = {True: (56, 104, 150), False: (98, 158, 210)}  # by Theme.dark
GROUND: dict[bool, Rgb] = {True: (98, 78, 60), False: (176, 140, 104)}


def palette_css(theme: Theme) -> str:
    """A style element that defines --hs-text and its siblings."""
    colours = {
        "surface": theme.surface,
        "field": theme.background,
        "text": theme.text,
        "muted": theme.muted,
        "line": theme.grid,
        "accent": theme.accent,
        "on-accent": theme.background if theme.dark else theme.surface,
        "warning": theme.warning,
        "error": theme.error,
        "robot": theme.robot,
        "sky": SKY[theme.dark],
        "ground": GROUND[theme.dark],
    }
    return f"<style>:root{{{';'.join(f'--hs-{name}:{css(c)}' for name, c in colours.items())}}}</style>"
