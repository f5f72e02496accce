"""Marks that a person sets."""

import pytest

from hectorscope.run.annotations import LONGEST, MOST, Annotation, AnnotationError, Annotations

HERE = (1.0, 2.0, 0.5)


def some(count: int = 3) -> Annotations:
    """Victims along the x axis."""
    marks = Annotations()
    for number in range(count):
        marks = marks.put("victim", number, (float(number), 0.0), HERE, "")
    return marks


def test_a_number_is_given_once() -> None:
    """A mark keeps its number, and a removed one's is not given again."""
    marks = some().removed(3).put("door", 9, (5.0, 5.0), HERE, " exit ")
    assert [mark.number for mark in marks.marks] == [1, 2, 4]
    assert marks[4] == Annotation(4, "door", 9, 5.0, 5.0, HERE, "exit")


def test_editing_changes_kind_and_text_only() -> None:
    """Place, time and pose stay, and so do the others and the value of before."""
    before = some()
    after = before.edited(2, "hazard", "gas")
    assert (after[2].kind, after[2].text, after[2].x, after[2].time_ns) == ("hazard", "gas", 1.0, 1)
    assert after[1] is before[1]
    assert before[2].kind == "victim"


def test_what_cannot_be_is_refused_with_the_reason() -> None:
    """A kind that is none, a number that is gone, one mark too many; long texts are cut."""
    with pytest.raises(AnnotationError, match="choose victim, hazard, door, note"):
        some().put("gold", 0, (0.0, 0.0), HERE, "")
    with pytest.raises(AnnotationError, match="no mark 9"):
        some().removed(9)
    with pytest.raises(AnnotationError, match="remove some"):
        some(MOST).put("note", 0, (0.0, 0.0), HERE, "")
    assert len(Annotations().put("note", 0, (0.0, 0.0), HERE, "x" * 999)[1].text) == LONGEST
