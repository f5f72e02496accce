"""Addresses: which are refused, and what is to be opened in a browser."""

import socket
import subprocess
from pathlib import Path
from urllib.parse import urlsplit

import pytest

from hectorscope.web.access_control import AccessControl
from hectorscope.web.address import ELSEWHERE, Address, Certificate, ServerError, listen
from tests.certificates import self_signed

TOKEN = "open-sesame"


@pytest.mark.parametrize("host", ["0.0.0.0", "::"])
def test_all_addresses_are_told_as_one_that_others_can_open(host: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """That of this machine in its network; without a network its name."""
    url = urlsplit(Address(host, token=TOKEN).url(8080, TOKEN))
    assert url.hostname not in {None, host}
    assert (url.port, url.query) == (8080, f"token={TOKEN}")
    monkeypatch.setitem(ELSEWHERE, host, (ELSEWHERE[host][0], "255.255.255.255"))  # which the system refuses
    assert urlsplit(Address(host, token=TOKEN).url(8080, None)).hostname == socket.gethostname().lower()


@pytest.mark.parametrize(
    ("address", "port", "url"),
    [
        (Address(), 8080, "http://127.0.0.1:8080/"),
        (Address("::1", token=TOKEN), 81, f"http://[::1]:81/?token={TOKEN}"),
        (Address(certificate=Certificate(Path("a"), Path("b"))), 8080, "https://127.0.0.1:8080/"),
        (Address(token=TOKEN, public="https://station.example/hector"), 8080,
         f"https://station.example/hector/?token={TOKEN}"),
        (Address(token=TOKEN, public="http://Station.example:8000/"), 8080,
         f"http://Station.example:8000/?token={TOKEN}"),
    ],
)  # fmt: skip
def test_the_printed_address_opens_the_page(address: Address, port: int, url: str) -> None:
    """It has the scheme, the name and the path that a browser needs."""
    assert address.url(port, address.token) == url


@pytest.mark.parametrize(
    "public",
    [
        "station.example",
        "ftp://station.example/",
        "https://user@station.example/",
        "https://a/?b",
        "https://a b/",
        "",
    ],
)
def test_what_is_no_address_of_a_page_is_refused(public: str) -> None:
    """With an example of one."""
    with pytest.raises(ServerError, match=r"no address of a page: give one like https://station"):
        Address(token=TOKEN, public=public)


def test_a_public_address_needs_a_token() -> None:
    """Others can open it."""
    with pytest.raises(ServerError, match="give a token too"):
        Address(public="https://station.example/hector/")


def test_a_proxy_is_known_by_its_name_alone() -> None:
    """The public name with its port is admitted as Host, in any case of letters; nothing like it is."""
    host = Address(token=TOKEN, public="https://Station.example:444/x").public_host
    access = AccessControl({}, TOKEN, public_host=host)
    assert access.is_our_host("station.EXAMPLE:444")
    for other in ("station.example", "station.example:445", "evil.station.example:444", "evil.example", ""):
        assert not access.is_our_host(other)
    assert not AccessControl({}, TOKEN).is_our_host("")


def test_a_certificate_that_is_of_no_use_is_named(tmp_path: Path) -> None:
    """By one message each: no file, no certificate, another's key."""
    chain, key = self_signed(tmp_path)
    Certificate(chain, key).context()
    with pytest.raises(ServerError, match=r"nothing\.pem is no file: give a certificate and its key"):
        Certificate(tmp_path / "nothing.pem", key).context()
    noise = tmp_path / "noise.pem"
    noise.write_text("no certificate", encoding="utf-8")
    (tmp_path / "other").mkdir()
    _, stranger = self_signed(tmp_path / "other")
    for bad in (Certificate(noise, key), Certificate(chain, noise), Certificate(chain, stranger)):
        with pytest.raises(ServerError, match=r"cannot be used \(.+\): give a certificate"):
            bad.context()


def test_a_certificate_that_cannot_be_reached_is_named() -> None:
    """By a name that is too long for the system."""
    with pytest.raises(ServerError, match="is no file: give a certificate"):
        Certificate(Path("x" * 300), Path("key.pem")).context()


def test_a_locked_key_is_refused_instead_of_asked_about(tmp_path: Path) -> None:
    """A server that starts by itself has nobody who types."""
    chain, key = self_signed(tmp_path)
    locked = tmp_path / "locked.pem"
    subprocess.run(
        ["openssl", "ec", "-in", key, "-aes256", "-passout", "pass:secret", "-out", locked],
        check=True,
        capture_output=True,
    )
    with pytest.raises(ServerError, match="the key is locked by a password"):
        Certificate(chain, locked).context()


def test_an_address_of_another_machine_is_told_apart_from_a_port_in_use() -> None:
    """Another port would not help."""
    with pytest.raises(ServerError, match=r"host 192\.0\.2\.1 is no address of this machine: give one of its own"):
        listen("192.0.2.1", 0)
