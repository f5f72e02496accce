"""Marks that a person sets in the map: victims, hazards, doors and notes."""

from dataclasses import dataclass, replace
from math import isfinite
from typing import Any, Literal, get_args

from hectorscope.common.numbers import as_float, is_time_ns
from hectorscope.common.terminal import printable
from hectorscope.run.pictures import Picture
from slam_core.errors import SlamError

Kind = Literal["victim", "hazard", "door", "note"]
KINDS: tuple[Kind, ...] = get_args(Kind)
MOST = 500
LONGEST = 200  # characters
MOST_BYTES = 16 * 2**20  # of all pictures of a run
PLACE = ("x", "y", "robot_x", "robot_y", "robot_yaw")


class AnnotationError(SlamError):
    """A mark that cannot be set or found."""


@dataclass(frozen=True, slots=True)
class Annotation:
    """One mark. number: it keeps it, and no other one of the run gets it. time_ns: of the scan that was shown.

    x, y: metres in the map. pose: x, y, yaw of the robot then. picture: of what is there, if any.
    """

    number: int
    kind: Kind
    time_ns: int
    x: float
    y: float
    pose: tuple[float, float, float]
    text: str = ""
    picture: Picture | None = None

    @property
    def picture_name(self) -> str:
        """Of the file in the archive of the pictures; empty without one."""
        return f"mark_{self.number}.jpg" if self.picture else ""

    def to_tree(self) -> dict[str, int | str | list[float]]:
        """Plain values for a file that is read again, without the picture; place: PLACE."""
        place = [self.x, self.y, *self.pose]
        return {
            "number": self.number,
            "kind": self.kind,
            "time_ns": self.time_ns,
            "place": place,
            "text": self.text,
        }

    def told(self, start_ns: int) -> dict[str, object]:
        """Plain values for a file."""
        return {
            "number": self.number,
            "kind": self.kind,
            "time_s": (self.time_ns - start_ns) / 1e9,
            "x_m": self.x,
            "y_m": self.y,
            "robot": list(self.pose),
            "text": self.text,
            **({"picture": self.picture_name} if self.picture else {}),
        }


@dataclass(frozen=True, slots=True)
class Annotations:
    """Those of a run, as a value: every method returns another one. AnnotationError if it cannot be."""

    marks: tuple[Annotation, ...] = ()
    given: int = 0

    def put(
        self, kind: str, time_ns: int, at: tuple[float, float], pose: tuple[float, float, float], text: str
    ) -> "Annotations":
        """One more, with the next number."""
        if len(self.marks) >= MOST:
            raise AnnotationError(f"There are {MOST} marks already: remove some")
        mark = Annotation(self.given + 1, checked(kind), time_ns, *at, pose, text.strip()[:LONGEST])
        return Annotations((*self.marks, mark), self.given + 1)

    def edited(self, number: int, kind: str, text: str) -> "Annotations":
        """One of them with another kind and text."""
        new = replace(self[number], kind=checked(kind), text=text.strip()[:LONGEST])
        return Annotations(tuple(new if mark.number == number else mark for mark in self.marks), self.given)

    def pictured(self, number: int, picture: Picture) -> "Annotations":
        """One of them with a picture, in place of that which it had."""
        new = replace(self[number], picture=picture)
        marks = tuple(new if mark.number == number else mark for mark in self.marks)
        if sum(len(mark.picture.content) for mark in marks if mark.picture) > MOST_BYTES:
            raise AnnotationError(f"The pictures take more than {MOST_BYTES >> 20} MiB: remove some marks")
        return Annotations(marks, self.given)

    def removed(self, number: int) -> "Annotations":
        """One less; its number is not given again."""
        gone = self[number]
        return Annotations(tuple(mark for mark in self.marks if mark is not gone), self.given)

    def joined(self, others: "Annotations") -> "Annotations":
        """With those of others that are not there, which keep their numbers if these are free."""
        known = {replace(mark, number=0, picture=None) for mark in self.marks}
        joined, numbers = list(self.marks), {mark.number for mark in self.marks}
        given = max(self.given, others.given)
        for mark in others.marks:
            if replace(mark, number=0, picture=None) not in known and len(joined) < MOST:
                given += mark.number in numbers
                joined.append(replace(mark, number=given) if mark.number in numbers else mark)
        return Annotations(tuple(joined), given)

    def __getitem__(self, number: int) -> Annotation:
        found = next((mark for mark in self.marks if mark.number == number), None)
        if found is None:
            raise AnnotationError(f"There is no mark {number} any more")
        return found


def read_marks(entries: Any) -> Annotations:
    """Those of a file, each as `Annotation.to_tree` gave it; AnnotationError for anything else."""
    if not isinstance(entries, list) or len(entries) > MOST:
        raise AnnotationError(f"the marks are no list of at most {MOST}")
    marks = tuple(map(_read, entries))
    numbers = [mark.number for mark in marks]
    if len(set(numbers)) != len(numbers):
        raise AnnotationError("two marks have the same number")
    return Annotations(marks, max(numbers, default=0))


def _read(entry: Any) -> Annotation:
    match entry:
        case {
            "number": int(number),
            "kind": str(kind),
            "time_ns": int(time_ns),
            "place": [*place],
            "text": str(text),
        }:
            numbers = [as_float(each) for each in place if type(each) in {int, float}]
            if len(place) == len(PLACE) == sum(map(isfinite, numbers)) and is_time_ns(time_ns):
                x, y, *pose = numbers
                said = printable(text)[:LONGEST]
                return Annotation(number, checked(kind), time_ns, x, y, (pose[0], pose[1], pose[2]), said)
    raise AnnotationError(f"the mark {entry!r} is none: give number, kind, time_ns, place and text")


def checked(kind: str) -> Kind:
    """AnnotationError for a kind that is none."""
    if kind not in KINDS:
        raise AnnotationError(f"{kind!r} is no kind of mark: choose {', '.join(KINDS)}")
    return kind
