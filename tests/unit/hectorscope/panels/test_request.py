"""Values of requests: checked, whatever a browser sends."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from hectorscope.panels._request import BadRequest, words


@given(st.text(st.characters(codec=None), max_size=50))  # lone surrogates among them, as JSON may bring them
def test_words_can_be_written(text: str) -> None:
    """Into a file, whatever was sent; no longer than allowed, and without blanks around them."""
    found = words(text, 10)
    assert len(found.encode("utf-8").decode("utf-8")) <= 10
    assert found == found.encode().decode()


def test_words_are_text() -> None:
    """Nothing else is taken."""
    with pytest.raises(BadRequest):
        words(3, 10)
