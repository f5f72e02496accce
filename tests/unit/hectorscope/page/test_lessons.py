"""Lessons are Markdown files with a header; what they hold is checked and escaped."""

from pathlib import Path

import pytest

from hectorscope.cli.opening import demos
from hectorscope.page.lessons import Condition, LessonError, condition, inline, lessons_in, read_lesson
from tests.conftest import ROOT

GOOD = """+++
title = "A & B"
recording = "arena"
time = 1.5
try = "Press `B`."
done = ["map.levels == 1", "closer == beam", "scan.stabilise == false"]
[settings]
"map.levels" = 2
[question]
text = "One?"
answers = ["yes", "no"]
right = 2
why = "Because."
+++
Text with $a < b$ and <script>alert(1)</script> and [a link](javascript:alert(1)).
"""


def lesson(tmp_path: Path, text: str = GOOD):
    """As read from a file."""
    path = tmp_path / "one.md"
    path.write_text(text, encoding="utf-8")
    return read_lesson(path)


def test_a_lesson_is_one_file(tmp_path):
    """Header and text become values; no code is needed for another one."""
    read = lesson(tmp_path)
    assert (read.key, read.title, read.demo, read.offset_ns) == ("one", "A & B", "arena", 1_500_000_000)
    assert read.settings.start.map.levels == 2
    assert read.question.right == 1
    assert read.done == (
        Condition("map.levels", "==", 1.0),
        Condition("closer", "==", "beam"),
        Condition("scan.stabilise", "==", False),
    )


def test_text_is_escaped(tmp_path):
    """Neither HTML nor links of a lesson reach the page; a formula stays text until the page draws it."""
    body = lesson(tmp_path).body
    assert "<script" not in body and "<a " not in body
    assert '<span class="hs-tex">a &lt; b</span>' in body


def test_a_lone_dollar_is_a_dollar():
    """Only a pair makes a formula."""
    assert inline("It costs 5 $.") == "It costs 5 $."
    assert inline("$$x$$") == '<span class="hs-tex hs-tex-block">x</span>'


@pytest.mark.parametrize(
    ("wrong", "instead", "named"),
    [
        ('title = "A & B"\n', "", "'title'"),
        ("right = 2", "right = 3", "right is 3: give 1 to 2"),
        ("map.levels == 1", "moon == full", "moon == full"),
        ('"map.levels" = 2', '"map.levels" = 99', "map.levels"),
        ("time = 1.5", "time = 1.5\ncolour = 3", "colour"),
        ("+++\ntitle", "title", "no header"),
    ],
)
def test_a_bad_header_is_named(tmp_path, wrong, instead, named):
    """The message has the file and what is wrong in it."""
    with pytest.raises(LessonError, match=r"one\.md") as caught:
        lesson(tmp_path, GOOD.replace(wrong, instead, 1))
    assert named in str(caught.value)


def test_conditions_are_numbers_switches_or_words():
    """By how they are written."""
    assert condition("time > 20.5") == Condition("time", ">", 20.5)
    assert condition("compared == true") == Condition("compared", "==", True)


def test_every_lesson_names_a_recording_that_comes_along():
    """The scene of each can be set up without another file."""
    lessons = lessons_in(ROOT / "static" / "lessons")
    assert len(lessons) == 8
    assert {each.demo for each in lessons} <= set(demos())
