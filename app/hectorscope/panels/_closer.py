"""What a closer look shows in words: the card of a beam, and that of a cell."""

import math
from collections.abc import Iterator

from hectorscope.panels._format import clock, fixed, text
from hectorscope.run.readings import BeamView, CellView, Span, View

Row = tuple[str, str]
GONE = "<h2>Nothing to see here</h2><p>The shown scan has no such beam.</p>"


def card_html(view: View | None) -> str:
    """The content of the card; numbers alone come from outside."""
    if view is None:
        return GONE
    if isinstance(view, CellView):
        return f"<h2>Cell</h2>{_table(_place(view))}{_levels(view)}{_table(_history(view))}"
    title = f"<h2>Beam {view.number} <small>of {view.beams}</small></h2>{STEPS.format(view.number)}"
    if view.end is None:
        return f"{title}{_table(_measured(view))}<p>It has no endpoint in this scan: {_why(view)}.</p>"
    return f"{title}{_table([*_measured(view), *_matched(view), *_place(view.end)])}{_levels(view.end)}"


def marks(view: View | None) -> dict[str, object]:
    """What static/closer.js draws over the scene: both ends of a beam, metres; a cell as in `_square`."""
    if view is None:
        return {}
    if isinstance(view, CellView):
        return {"cell": _square(view)}
    if view.end is None:
        return {}
    return {"beam": [*view.laser, view.end.x, view.end.y], "cell": _square(view.end)}


def _square(cell: CellView) -> list[float]:
    """Level, low x, low y, side in metres."""
    (column, row), side = cell.levels[cell.level].cell, cell.levels[cell.level].resolution
    return [cell.level, column * side, row * side, side]


def _measured(beam: BeamView) -> Iterator[Row]:
    reach = {math.inf: "no return", -math.inf: "too close"}.get(beam.range_m, f"{fixed(beam.range_m, 3)} m")
    yield "range", "no value" if math.isnan(beam.range_m) else reach
    if beam.end is not None and beam.used_m != beam.range_m:
        yield "smoothed to", f"{fixed(beam.used_m, 3)} m"
    yield "angle", f"{fixed(math.degrees(beam.angle), 2)}°"
    late = "no beam timing" if math.isnan(beam.after_s) else f"{fixed(1e3 * beam.after_s, 2)} ms"
    yield "in the sweep after", late


def _matched(beam: BeamView) -> Iterator[Row]:
    first = math.isnan(beam.residual)
    yield "residual in the match", "first scan" if first else f"{fixed(beam.residual, 3)} · level 0"
    if beam.left_out:
        yield "in the match", "left out: on an object that may move"
    yield "height over the laser", f"{fixed(beam.height, 2)} m"
    yield "ends in free space", "yes" if beam.unexpected else "no"


def _place(cell: CellView) -> Iterator[Row]:
    yield "x, y", f"{fixed(cell.x, 2)}, {fixed(cell.y, 2)} m"


def _history(cell: CellView) -> Iterator[Row]:
    history = cell.history
    if history.first is None or history.last is None:
        yield "written", "never"
        return
    yield "written first", ("in the saved map, or " if history.saved else "") + _when(history.first)
    yield "changed last", _when(history.last)


def _when(span: Span) -> str:
    if span.first == span.last:
        return f"scan {span.first}, {clock(span.from_s)}"
    return f"scan {span.first} to {span.last}, {clock(span.from_s)} to {clock(span.to_s)}"


def _levels(cell: CellView) -> str:
    rows = (
        f"<tr><td>{i} · {100 * level.resolution:g} cm</td><td>{level.cell[0]}, {level.cell[1]}</td>"
        f"<td>{'unknown' if level.probability is None else fixed(level.probability, 3)}</td>"
        f"<td>{fixed(level.residual, 3)}</td></tr>"
        for i, level in enumerate(cell.levels)
    )
    head = "<tr><th>level</th><th>cell</th><th>probability</th><th>1 − M</th></tr>"
    return f'<table class="hs-levels">{head}{"".join(rows)}</table>'


def _why(beam: BeamView) -> str:
    if math.isfinite(beam.range_m) and beam.range_m > 0.0:
        return "its range is out of the limits of laser or settings, or its end out of the band of heights"
    return "the laser gives no distance for it"


def _table(rows: Iterator[Row] | list[Row]) -> str:
    cells = "".join(f"<tr><th>{text(name)}</th><td>{text(value)}</td></tr>" for name, value in rows)
    return f'<table class="hs-closer-rows">{cells}</table>'


STEPS = (
    '<div class="hs-closer-steps" data-hs-number="{}">'
    '<button type="button" data-hs-beam="-1" aria-label="Beam before">‹</button>'
    '<button type="button" data-hs-beam="1" aria-label="Next beam">›</button></div>'
)
