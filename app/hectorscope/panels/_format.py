"""Numbers and names as a person reads them."""

import math
from functools import cache
from html import escape

from hectorscope.panels._hints import HINTS
from slam_core.config import Leaf
from slam_core.results import MatchResult

GREEK = {"sigma": "σ", "omega": "ω"}


def clock(seconds: float) -> str:
    """Minutes, seconds and tenths: 01:02.3; with hours from one hour on."""
    tenths = max(0, round(seconds * 10)) if math.isfinite(seconds) else 0
    minutes, rest = divmod(tenths, 600)
    hours, minutes = divmod(minutes, 60)
    lead = f"{hours}:" if hours else ""
    return f"{lead}{minutes:02d}:{rest // 10:02d}.{rest % 10}"


def number(value: float, digits: int = 3) -> str:
    """`digits` significant digits, a power of ten for the tiny and the huge; a dash for what is not finite."""
    if not math.isfinite(value):
        return "–"
    text = f"{value:.{digits}g}"
    if "e+" in text and abs(value) < LARGE:
        text = f"{float(text):.0f}"
    if "e" not in text:
        return minus(text)
    mantissa, exponent = text.split("e")
    times = "" if mantissa == "1" else minus(mantissa) + "×"
    return f"{times}10{str(int(exponent)).translate(SUPERSCRIPT)}"


LARGE = 1e7
SUPERSCRIPT = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def fixed(value: float, decimals: int) -> str:
    """A fixed number of decimals, so that digits do not dance; a dash for what is not finite."""
    return minus(f"{value + 0.0:.{decimals}f}") if math.isfinite(value) else "–"


def minus(text: str) -> str:
    """A true minus sign, as wide as a plus; a rounded -0 loses it."""
    return text.removeprefix("-") if float_is_zero(text) else text.replace("-", "−")


def float_is_zero(text: str) -> bool:
    """Whether a number's text is all zeros."""
    return not text.strip("-0.")


def label(leaf: Leaf) -> str:
    """A setting's name for a person, with its unit: 'Update distance (m)'."""
    return title(leaf) + (f" ({leaf.param.unit})" if leaf.param.unit else "")


def title(leaf: Leaf) -> str:
    """The same without the unit."""
    if leaf.param.title:
        return leaf.param.title
    words = leaf.name.split(".")[-1].split("_")
    words = [GREEK.get(word, word) for word in words]
    words[0] = words[0][:1].upper() + words[0][1:] if words[0] not in GREEK.values() else words[0]
    return " ".join(words)


def hint(leaf: Leaf) -> str:
    """What a setting does, its range, its default, and what changing it costs."""
    parts = [leaf.param.help]
    unit = f" {leaf.param.unit}" if leaf.param.unit else ""
    if leaf.param.low is not None and leaf.param.high is not None:
        parts.append(f"Range {number(leaf.param.low, 6)} to {number(leaf.param.high, 6)}{unit}.")
    parts.append(f"Default {worded(leaf.value)}{unit}.")
    if leaf.param.restart:
        parts.append("Changing it rebuilds the map from the start.")
    return " ".join(parts)


def worded(value: float | bool | str) -> str:
    """The value of a setting for a person."""
    if isinstance(value, bool):
        return "on" if value else "off"
    return value.replace("_", " ") if isinstance(value, str) else number(value, 6)


def left_out(match: MatchResult) -> str:
    """That a match did without some beams; nothing if it took all."""
    beams = len(match.left_out)
    told = "beam on an object that may move was" if beams == 1 else "beams on objects that may move were"
    return f"{beams} {told} left out" if beams else ""


def text(value: object) -> str:
    """Escaped for the page: names of files and topics come from outside."""
    return escape(str(value), quote=True)


def figure(name: str, value: str, kind: str = "", *, caption: str | None = None, more: str = "") -> str:
    """A small caption and a value as HTML, with the text of HINTS under the pointer.

    name: in HINTS, or explained by `more`. kind: styles it, "good", "bad", ... caption: another one than the name.
    more: what there is to say of this very value, before the hint.
    """
    style = f"hs-figure hs-{kind}" if kind else "hs-figure"
    shown = name if caption is None else caption
    return f'<span class="{style}" {tip(name, more)}><small>{shown}</small>{value}</span>'


def tip(name: str, more: str = "") -> str:
    """The attribute that puts a text under the pointer: what there is to say now, and the hint of the name."""
    words = (text(f"{sentence(more)}.") if more else "", _hint(name))
    return f'title="{" ".join(filter(None, words))}"'


@cache
def _hint(name: str) -> str:
    return text(HINTS.get(name, ""))


def sentence(words: str) -> str:
    """With a capital at the beginning, unless an address or a topic stands there."""
    return words[:1].upper() + words[1:] if words.split(" ", 1)[0].isalpha() else words
