"""Where compiled kernels are kept."""

from pathlib import Path

import pytest

from hectorscope.common import kernel_cache


@pytest.fixture
def sources(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A small tree with one kernel and one plain module."""
    for folder in ("slam_core", "hectorscope"):
        (tmp_path / folder).mkdir()
    (tmp_path / "slam_core/kernel.py").write_text("@njit\ndef f(x):\n    return x\n")
    (tmp_path / "hectorscope/plain.py").write_text("x = 1\n")
    monkeypatch.setattr(kernel_cache, "PACKAGES", (tmp_path / "slam_core", tmp_path / "hectorscope"))
    return tmp_path


def test_a_changed_kernel_has_another_folder(sources: Path):
    """Machine code of yesterday's kernel is never found again; other changes keep what is kernel_cache."""
    before = kernel_cache.fingerprint()
    (sources / "hectorscope/plain.py").write_text("x = 2\n")
    assert kernel_cache.fingerprint() == before
    (sources / "slam_core/kernel.py").write_text("@njit\ndef f(x):\n    return 2 * x\n")
    changed = kernel_cache.fingerprint()
    assert changed != before
    (sources / "slam_core/memory.py").write_text("@intrinsic\ndef get(_, array, i):\n    return load\n")
    assert kernel_cache.fingerprint() != changed


def test_the_environment_s_choice_is_kept(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Who set NUMBA_CACHE_DIR keeps it."""
    monkeypatch.setenv("NUMBA_CACHE_DIR", "elsewhere")
    kernel_cache.keep_compiled(sources / "caches")
    assert kernel_cache.os.environ["NUMBA_CACHE_DIR"] == "elsewhere"


def test_the_checked_build_has_a_folder_of_its_own(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Kernels with bounds checks never stand in for those without, nor the other way round."""
    folders = []
    for asked in ("0", "1"):
        monkeypatch.setenv("NUMBA_BOUNDSCHECK", asked)
        monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
        kernel_cache.keep_compiled(sources / "caches")
        folders.append(kernel_cache.os.environ["NUMBA_CACHE_DIR"])
    assert folders[1] == f"{folders[0]}-checked"


def test_a_place_that_cannot_be_written_is_no_error(sources: Path, monkeypatch: pytest.MonkeyPatch):
    """Then numba looks for a place of its own."""
    monkeypatch.delenv("NUMBA_CACHE_DIR", raising=False)
    (sources / "file").write_text("")
    kernel_cache.keep_compiled(sources / "file")
    assert "NUMBA_CACHE_DIR" not in kernel_cache.os.environ
