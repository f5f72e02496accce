"""Marks that a person sets in the map: victims, hazards, doors and notes."""

from dataclasses import dataclass, replace
from typing import Literal, get_args

from slam_core.errors import SlamError

Kind = Literal["victim", "hazard", "door", "note"]
KINDS: tuple[Kind, ...] = get_args(Kind)
MOST = 500
LONGEST = 200  # characters


class AnnotationError(SlamError):
    """A mark that cannot be set or found."""


@dataclass(frozen=True, slots=True)
class Annotation:
    """One mark. number: it keeps it, and no other one of the run gets it. time_ns: of the scan that was shown.

    x, y: metres in the map. pose: x, y, yaw of the robot then.
    """

    number: int
    kind: Kind
    time_ns: int
    x: float
    y: float
    pose: tuple[float, float, float]
    text: str = ""

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

    def removed(self, number: int) -> "Annotations":
        """One less; its number is not given again."""
        gone = self[number]
        return Annotations(tuple(mark for mark in self.marks if mark is not gone), self.given)

    def __getitem__(self, number: int) -> Annotation:
        found = next((mark for mark in self.marks if mark.number == number), None)
        if found is None:
            raise AnnotationError(f"There is no mark {number} any more")
        return found


def checked(kind: str) -> Kind:
    """AnnotationError for a kind that is none."""
    if kind not in KINDS:
        raise AnnotationError(f"{kind!r} is no kind of mark: choose {', '.join(KINDS)}")
    return kind
