"""wss:// against the real server: trusted certificates only."""

import shutil
import subprocess
from itertools import islice
from pathlib import Path

import foxglove
import pytest

from hectorscope.inputs import SourceError
from hectorscope.sources._websocket import Link
from hectorscope.sources.foxglove import PEER


@pytest.fixture(scope="module")
def certificate(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A certificate that this machine signed for itself, and its key."""
    openssl = shutil.which("openssl")
    if openssl is None:
        pytest.skip("no openssl on the path to make a certificate")
    folder = tmp_path_factory.mktemp("tls")
    certificate, key = folder / "certificate.pem", folder / "key.pem"
    command = [openssl, "req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes"]
    names = ["-subj", "/CN=127.0.0.1", "-addext", "subjectAltName=IP:127.0.0.1", "-days", "2"]
    subprocess.run([*command, *names, "-keyout", key, "-out", certificate], check=True, capture_output=True)
    return certificate, key


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
        with pytest.raises(SourceError, match=r"not trusted \(self-signed.*name its issuer in SSL_CERT_FILE"):
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
