"""The style sheets of the page."""

from hectorscope.common.resources import resource_folder


def test_no_rule_looks_into_elements() -> None:
    """With :has() a browser styles the whole page with each new figure; static/parts.js marks what rules need."""
    sheets = sorted(resource_folder("static").glob("*.css"))
    assert sheets
    assert not [sheet.name for sheet in sheets if ":has(" in sheet.read_text(encoding="utf-8")]
