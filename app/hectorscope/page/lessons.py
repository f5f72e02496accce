"""Guided lessons: a Markdown file each in static/lessons, with a header in TOML between lines of +++.

Formulas stand between $ or $$. The text is escaped; raw HTML, links and images in it stay what they are: text.
"""

import html
import re
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from markdown_it import MarkdownIt
from markdown_it.rules_inline import StateInline
from markdown_it.token import Token

from hectorscope.run.settings import Settings
from slam_core.config import Leaves, SlamConfig, preset, with_values
from slam_core.errors import SlamError

FENCE = re.compile(r"\+\+\+\n(?P<header>.*?)\n\+\+\+\n(?P<body>.*)", re.DOTALL)
CONDITION = re.compile(r"(?P<fact>[a-z_.]+) (?P<test>==|!=|>=|<=|>|<) (?P<value>.+)")
FACTS = ("time", "tracking", "error", "compared", "closer", "layout", "plots")  # beside every setting, by its name
HEADER = {"title", "recording", "time", "try", "done", "question", "preset", "settings", "browser"}


class LessonError(SlamError):
    """A lesson cannot be read: the message names the file and the remedy."""


@dataclass(frozen=True, slots=True)
class Condition:
    """A fact of the page or of the run, a comparison, and a value: "scan.stabilise == false"."""

    fact: str
    test: str
    value: float | bool | str


@dataclass(frozen=True, slots=True)
class Question:
    """text, why and answers are HTML. right: the index of the right answer."""

    text: str
    answers: tuple[str, ...]
    right: int
    why: str


@dataclass(frozen=True, slots=True)
class Lesson:
    """body, task: HTML. offset_ns: where the recording rests. done: all hold once the task is done.

    browser: choices of static/browser.js that the scene needs.
    """

    key: str
    title: str
    demo: str
    offset_ns: int
    settings: Settings
    browser: Mapping[str, Any]
    body: str
    task: str
    done: tuple[Condition, ...]
    question: Question


@cache
def lessons_in(folder: Path) -> tuple[Lesson, ...]:
    """Every lesson of a folder, by the names of the files; LessonError for a bad one."""
    return tuple(read_lesson(path) for path in sorted(folder.glob("*.md")))


def read_lesson(path: Path) -> Lesson:
    """One lesson; LessonError names what is wrong with its header."""
    found = FENCE.fullmatch(path.read_text(encoding="utf-8"))
    if found is None:
        raise LessonError(f"{path.name} has no header: begin it with a line of +++, TOML, and another line of +++")
    try:
        return _lesson(path.stem, tomllib.loads(found["header"]), found["body"])
    except KeyError as error:
        raise LessonError(f"the header of {path.name} has no {error}: add it") from error
    except (ValueError, TypeError, AttributeError, SlamError) as error:
        raise LessonError(f"the header of {path.name} cannot be used ({error}): see docs/teaching.md") from error


def _lesson(key: str, header: dict[str, Any], body: str) -> Lesson:
    if unknown := header.keys() - HEADER:
        raise ValueError(f"{sorted(unknown)[0]} is unknown")
    config = with_values(preset(header.get("preset", "default")), header.get("settings", {}))
    asked = header["question"]
    answers = tuple(inline(each) for each in asked["answers"])
    if not 1 <= asked["right"] <= len(answers):
        raise ValueError(f"right is {asked['right']}: give 1 to {len(answers)}")
    return Lesson(
        key=key,
        title=str(header["title"]),
        demo=str(header["recording"]),
        offset_ns=round(1e9 * float(header["time"])),
        settings=Settings(config),
        browser=header.get("browser", {}),
        body=MARKDOWN.render(body),
        task=inline(header["try"]),
        done=tuple(condition(each) for each in header["done"]),
        question=Question(inline(asked["text"]), answers, asked["right"] - 1, inline(asked["why"])),
    )


def condition(text: str) -> Condition:
    """A condition from its words; ValueError for a fact that is none."""
    found = CONDITION.fullmatch(text)
    if found is None or not (found["fact"] in FACTS or found["fact"] in Leaves(SlamConfig())):
        raise ValueError(f"done {text!r} is no condition: give one as 'map.levels == 1'")
    words: dict[str, bool] = {"true": True, "false": False}
    value: float | bool | str = words.get(found["value"], found["value"])
    try:
        value = value if isinstance(value, bool) else float(value)
    except ValueError:  # a word
        value = found["value"]
    return Condition(found["fact"], found["test"], value)


# ------------------------------------------------------------------------------------------------------ Markdown


def _formula(state: StateInline, silent: bool) -> bool:
    """$...$ and $$...$$, as an inline rule of markdown-it."""
    source, start = state.src, state.pos
    if source[start] != "$":
        return False
    fence = "$$" if source.startswith("$$", start) else "$"
    end = source.find(fence, start + len(fence))
    if end < 0:
        return False
    if not silent:
        token = state.push("formula", "", 0)
        token.content, token.markup = source[start + len(fence) : end].strip(), fence
    state.pos = end + len(fence)
    return True


def _render_formula(tokens: list[Token], index: int, _options: Any, _env: Any) -> str:
    """An element that static/lessons.js draws; without it the source is read."""
    shown = " hs-tex-block" if tokens[index].markup == "$$" else ""
    return f'<span class="hs-tex{shown}">{html.escape(tokens[index].content)}</span>'


def _markdown() -> MarkdownIt:
    made = MarkdownIt("commonmark", {"html": False}).enable("table").disable(["image", "link", "autolink"])
    made.inline.ruler.before("escape", "formula", _formula)
    made.renderer.rules["formula"] = _render_formula  # type: ignore[attr-defined]
    return made


MARKDOWN = _markdown()


def inline(text: str) -> str:
    """HTML of a line without a paragraph around it."""
    rendered: str = MARKDOWN.renderInline(text)
    return rendered
