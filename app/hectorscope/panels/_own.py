"""Controls of what each browser keeps for itself: HTML that static/browser.js fills and reads, not the server."""

import html
from collections.abc import Mapping

ICONS = {
    "theme": '<circle cx="12" cy="12" r="8"/><path d="M12 4a8 8 0 0 1 0 16z" fill="currentColor"/>',
    "recordings": '<path d="M3 7h6l2 3h10v9H3zM3 7V5h5"/>',
    "link": '<path d="M10 14a4 4 0 0 0 6 0l3-3a4 4 0 0 0-6-6l-1 1M14 10a4 4 0 0 0-6 0l-3 3a4 4 0 0 0 6 6l1-1"/>',
    "lessons": '<path d="M12 6C9 4 6 4 3 5v13c3-1 6-1 9 1 3-2 6-2 9-1V5c-3-1-6-1-9 1zM12 6v13"/>',
    "plots": '<path d="M4 4v16h16M7 15l4-5 3 3 5-7"/>',
    "panels": '<path d="M4 5h16v14H4zM15 5v14"/>',
    "present": '<path d="M3 5h18v11H3zM12 16v4M8 20h8"/>',
    "screen": '<path d="M4 9V4h5M20 9V4h-5M4 15v5h5M20 15v5h-5"/>',
    "keys": '<path d="M9 9a3 3 0 1 1 4.5 2.6c-1 .6-1.5 1.2-1.5 2.4M12 17.5v.5"/>',
}


def choice(name: str, label: str, options: Mapping[str, str], hint: str) -> str:
    """A list of words."""
    items = "".join(f'<option value="{word}">{html.escape(text)}</option>' for word, text in options.items())
    return row(label, f'<select data-hs-own="{name}" aria-label="{label}">{items}</select>', hint)


def slider(name: str, label: str, span: tuple[float, float, float], hint: str) -> str:
    """A number; span: lowest, highest, step."""
    low, high, step = span
    return row(
        label,
        f'<input type="range" data-hs-own="{name}" aria-label="{label}" min="{low}" max="{high}" step="{step}">',
        hint,
    )


def row(label: str, control: str, hint: str) -> str:
    """A control with its name in front."""
    return f'<label class="hs-own-row" title="{html.escape(hint)}"><span>{label}</span>{control}</label>'


def layer_box(key: str, title: str, colour: str = "") -> str:
    """The switch of one layer."""
    swatch = f'<i class="hs-dot" style="background:var(--hs-{colour})"></i>' if colour else ""
    return (
        f'<label class="hs-own-box"><input type="checkbox" data-hs-own="layers" data-hs-layer="{key}">'
        f"{swatch}{html.escape(title)}</label>"
    )


def button(label: str, icon: str, attributes: str) -> str:
    """A round button with an icon; its name comes up under the pointer."""
    return (
        f'<button type="button" class="hs-tool" title="{label}" aria-label="{label}" {attributes}>'
        f'<svg viewBox="0 0 24 24" aria-hidden="true">{ICONS[icon]}</svg></button>'
    )


def wide_button(kind: str, act: str, label: str, hint: str) -> str:
    """A button with words, which a script of static/ knows by data-hs-KIND."""
    return f'<button type="button" class="hs-wide" data-hs-{kind}="{act}" title="{hint}">{label}</button>'


def tools() -> str:
    """The buttons at the right end of the bar at the top."""
    return '<div class="hs-tools">' + "".join(
        (
            button("Open a recording · O", "recordings", "data-hs-do=recordings"),
            button("Lessons · E", "lessons", "data-hs-do=lessons"),
            button("Copy a link to this view · C", "link", "data-hs-do=link"),
            button("Plots · G", "plots", 'data-hs-own="plots" data-hs-value=\'"off"\' data-hs-inverse'),
            button("Panels · H", "panels", 'data-hs-own="panels"'),
            button("Light theme · T", "theme", 'data-hs-own="theme" data-hs-value=\'"light"\''),
            button("Presentation · P", "present", 'data-hs-own="present"'),
            button("Full screen · F", "screen", "data-hs-do=screen"),
            button("Keys · ?", "keys", "data-hs-do=keys"),
            "</div>",
        )
    )


SHARED = '<p class="hs-scope" title="What is set here every open page shows.">Shared by every browser</p>'
OWN = '<p class="hs-scope" title="Kept in this browser; others have their own.">This browser only</p>'
