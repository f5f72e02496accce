"""Recordings by address."""

from pathlib import Path

import pytest

from hectorscope.inputs import SourceError
from hectorscope.sweep.fetch import forget, is_address, kept, local


def test_a_path_is_left_as_it_is():
    """Nothing is copied."""
    assert local("/some/a.bag") == Path("/some/a.bag")
    assert not is_address("/some/a.bag")


def test_an_address_is_copied_once_and_the_last_one_is_kept(tmp_path: Path):
    """With its name, as readers go by the ending; a folder with all that is in it."""
    (tmp_path / "a.bag").write_bytes(b"aaa")
    (tmp_path / "run").mkdir()
    (tmp_path / "run" / "metadata.yaml").write_bytes(b"m")
    first, second = f"{tmp_path.as_uri()}/a.bag", f"{tmp_path.as_uri()}/run"
    copy = local(first)
    assert (copy.name, copy.read_bytes()) == ("a.bag", b"aaa")
    assert local(first) == copy != tmp_path / "a.bag"
    folder = local(second)
    assert (folder / "metadata.yaml").read_bytes() == b"m"
    assert not copy.exists()
    forget()
    assert not folder.exists()
    assert kept(second) == second


def test_what_cannot_be_had_is_named():
    """Unknown protocols, and files that are not there."""
    for address in ("nosuch://bucket/a.bag", Path("/nowhere/a.bag").as_uri()):
        with pytest.raises(SourceError, match=f"{address} cannot be read"):
            local(address)
