"""The link to a robot as a table: rate, latency and age of each topic, and how far its clock is off."""

from hectorscope.common.robot_link import RobotLink, TopicLink
from hectorscope.panels._format import figure, fixed, text, tip

STALE_S = 1.0
DAY_S, HOUR_S, MINUTE_S = 86400.0, 3600.0, 60.0


def link_html(link: RobotLink | None) -> str:
    """Empty for what is no link, or as long as nothing came over it."""
    if link is None or link.clock_offset_s is None:
        return ""
    offset = duration(abs(link.clock_offset_s))
    side = "ahead" if link.clock_offset_s > 0 else "behind"
    figures = figure("clock of the robot", f"{offset} {side}") + (
        figure("round trip", duration(link.round_trip_s)) if link.round_trip_s else ""
    )
    heads = {"topic rate": "Hz", "latency": "latency", "age": "age"}
    names = "".join(f"<td {tip(name)}>{word}</td>" for name, word in heads.items())
    rows = "".join(_row(name, topic) for name, topic in sorted(link.topics.items()))
    table = f'<table class="hs-sources"><thead><tr><th>topic</th>{names}</tr></thead><tbody>{rows}</tbody></table>'
    return f'<div class="hs-robot-link"><div class="hs-figures">{figures}</div>{table}</div>'


def _row(name: str, topic: TopicLink) -> str:
    word = "silent" if topic.age_s > max(STALE_S, 3.0 / topic.rate_hz if topic.rate_hz else 0.0) else "live"
    small = f"<small>{word}</small>" if word == "silent" else ""
    return (
        f'<tr class="hs-is-{word}"><th {tip("topic " + word)}><i></i>{text(name)}{small}</th>'
        f"<td {tip('topic rate')}>{fixed(topic.rate_hz, 1)}</td>"
        f"<td {tip('latency')}>{duration(topic.latency_s)}</td><td {tip('age')}>{duration(topic.age_s)}</td></tr>"
    )


def duration(seconds: float) -> str:
    """In the unit that suits it, of few digits."""
    if seconds < 1.0:
        return f"{1000.0 * seconds:.0f} ms"
    if seconds < 2 * MINUTE_S:
        return f"{seconds:.1f} s"
    if seconds < 2 * HOUR_S:
        return f"{seconds / MINUTE_S:.0f} min"
    return f"{seconds / HOUR_S:.1f} h" if seconds < 2 * DAY_S else f"{seconds / DAY_S:.0f} days"
