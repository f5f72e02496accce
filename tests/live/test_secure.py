"""wss:// against the real server: trusted certificates only."""

import queue
import threading
from itertools import islice
from pathlib import Path

import foxglove
import pytest
from websockets.sync.server import ServerConnection, serve

from hectorscope.inputs import LinkOptions, SourceError
from hectorscope.sources._foxglove_wire import SUBPROTOCOLS
from hectorscope.sources._websocket import Link
from hectorscope.sources.foxglove import PEER
from tests.certificates import self_signed
from tests.live.measurements import GIVE_UP_S


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A certificate that this machine signed for itself, and its key."""
    return self_signed(tmp_path_factory.mktemp("tls"))


def test_only_a_trusted_server_is_talked_to(
    certificate: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    """An unknown certificate is refused with the way to trust it, and that way works."""
    issuer, key = certificate
    server = foxglove.start_server(
        host="127.0.0.1", port=0, tls_cert=issuer.read_bytes(), tls_key=key.read_bytes()
    )
    uri = f"wss://127.0.0.1:{server.port}"
    try:
        with pytest.raises(SourceError, match=r"not trusted \(self-signed.*name its issuer by --ca"):
            Link(uri, PEER)
        plain = Link(uri.replace("wss://", "ws://"), PEER)
        plain.close()
        assert "with a certificate: wss://" in plain.status
        monkeypatch.setenv("SSL_CERT_FILE", str(issuer))
        link = Link(uri, PEER)
        (frames,) = islice(link.connections(), 1)
        assert '"serverInfo"' in str(next(frames))
        link.close()
    finally:
        server.stop()


def test_a_certificate_of_ones_own_is_trusted(certificate: tuple[Path, Path], tmp_path: Path) -> None:
    """--ca does for one robot what SSL_CERT_FILE does for all; what is no certificate is refused by name."""
    issuer, key = certificate
    server = foxglove.start_server(
        host="127.0.0.1", port=0, tls_cert=issuer.read_bytes(), tls_key=key.read_bytes()
    )
    uri = f"wss://127.0.0.1:{server.port}"
    try:
        link = Link(uri, PEER, options=LinkOptions(ca=str(issuer)))
        (frames,) = islice(link.connections(), 1)
        assert '"serverInfo"' in str(next(frames))
        link.close()
        (tmp_path / "none.pem").write_text("nothing")
        for file in ("none.pem", "missing.pem"):
            with pytest.raises(SourceError, match=r"--ca .* cannot be read as a certificate .*: give a PEM file"):
                Link(uri, PEER, options=LinkOptions(ca=str(tmp_path / file)))
    finally:
        server.stop()


def test_headers_go_with_the_handshake() -> None:
    """As a gateway before the robot may ask for; what is no header is refused."""
    seen: queue.Queue[str | None] = queue.Queue()

    def greet(connection: ServerConnection) -> None:
        assert connection.request is not None
        seen.put(connection.request.headers.get("X-Robot"))

    with serve(greet, "127.0.0.1", 0, subprotocols=[SUBPROTOCOLS[0]]) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        uri = f"ws://127.0.0.1:{server.socket.getsockname()[1]}"
        Link(uri, PEER, options=LinkOptions(headers=(("X-Robot", "seven"),))).close()
        assert seen.get(timeout=GIVE_UP_S) == "seven"
        server.shutdown()
    for header in (("X Robot", "a"), ("X-Robot", "a\r\nHost: b")):
        with pytest.raises(SourceError, match=r"--header .* give NAME=VALUE"):
            Link(uri, PEER, options=LinkOptions(headers=(header,)))
