"""Which input an address or a path chooses."""

import pytest

from hectorscope.cli.main import ADDRESS
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.sources import addresses, open_source


@pytest.mark.parametrize("uri", ["http://robot:8765", "mqtt://robot", "WS://robot", "://robot", "ros://"])
def test_an_unknown_kind_of_address_is_told_with_the_list(uri: str) -> None:
    """The scheme has to be exactly one of those that are known."""
    with pytest.raises(SourceError, match=r"is no kind of address that is known") as error:
        open_source(uri, SourceOptions())
    assert all(address in str(error.value) for address in addresses())


def test_the_help_names_every_address() -> None:
    """The command line lists them without importing what opens them."""
    assert [address for address in addresses() if address not in ADDRESS] == []
