"""Writes docs/configuration.md from the configuration tree: `make docs`."""

from collections.abc import Iterator
from dataclasses import fields
from itertools import groupby
from pathlib import Path

from slam_core.config import PRESETS, Leaf, SlamConfig, leaves

TARGET = Path(__file__).with_suffix(".md")

HEAD = """# Settings

Written by `make docs` from `slam_core/config`; do not edit.

Every setting stands in one tree. Its name is the same everywhere:

- on the command line, with dashes: `hectorscope view BAG --matcher.sigma 0.3 --map.update-distance 0.2`;
- in a file, given by `--config FILE`: the table `[matcher]` with `sigma = 0.3` (a run leaves such a file);
- on the page, as a slider or switch with the same help.

Flags override the file, and the file overrides the preset. A value out of range is refused with the range. A
change on the page acts from its time on and is logged with it. At rest that is the scan that is shown, which is
processed again with the new value; else it is the next scan. *Changes act: for the whole run* runs a recording
again up to the same instant. So does a setting marked *restart*, which rebuilds the map; a live stream begins a
new map, after a question. [What can be taken back](commands.md#what-can-be-lost-and-taken-back) is listed.

Settings in **bold** are the basic ones. The page opens on them, and `--help` lists them. *expert* on the page and
`--help-all` show every one, and a search on the page finds any by its name or its help. The page names what
differs from the preset; a click resets one setting, or all of them, or brings back those that flags and file had
set.

## Presets

`--preset paper` (on the page: Settings, Preset) runs the method of the paper: every addition of the defaults is
switched off. [beyond-the-paper.md](beyond-the-paper.md) lists the additions and what each is worth. In Python it
is `SlamConfig.paper()`. These settings differ from the defaults:
"""


def document() -> str:
    """The whole file."""
    return "\n".join([HEAD, *_presets(), *_groups()])


def _presets() -> Iterator[str]:
    yield "| setting | default | paper |\n|---|---|---|"
    for name, value in PRESETS["default"].items():
        yield f"| `{name}` | {_word(value)} | {_word(PRESETS['paper'][name])} |"
    yield ""


def _groups() -> Iterator[str]:
    config = SlamConfig()
    titles = {field.name: type(getattr(config, field.name)).__doc__ or "" for field in fields(config)}
    for name, members in groupby(leaves(config), key=lambda leaf: leaf.name.partition(".")[0]):
        yield f"## {name}\n\n{titles[name].splitlines()[0]}\n"
        yield "| setting | default | range | unit | what it does |\n|---|---|---|---|---|"
        yield from map(_row, members)
        yield ""


def _row(leaf: Leaf) -> str:
    name = f"`{leaf.name.partition('.')[2]}`"
    name = f"**{name}**" if leaf.param.tier != "expert" else name
    remark = " *restart*" if leaf.param.restart else ""
    return f"| {name} | {_word(leaf.value)} | {_range(leaf)} | {leaf.param.unit} | {leaf.param.help}{remark} |"


def _word(value: object) -> str:
    return str(value).lower() if isinstance(value, bool) else str(value)


def _range(leaf: Leaf) -> str:
    if leaf.choices:
        return ", ".join(leaf.choices)
    if leaf.type is bool:
        return "true, false"
    return f"{leaf.param.low:g} to {leaf.param.high:g}"


if __name__ == "__main__":
    TARGET.write_text(document(), encoding="utf-8")
