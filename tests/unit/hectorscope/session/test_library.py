"""The recordings that a page can open, and those that it cannot."""

from collections.abc import Mapping
from pathlib import Path

import pytest

from hectorscope.common.recent import Recent
from hectorscope.inputs import OptionValue, Source, SourceError
from hectorscope.session.library import DEMOS, RECENT, UPLOADED, Library, LibraryError, check_folders
from tests.sources import MemoryRecording


class Opener:
    """Remembers what was opened."""

    def __init__(self) -> None:
        self.paths: list[Path] = []

    def __call__(self, path: Path, _: Mapping[str, OptionValue]) -> Source:
        """A recording with the name of its file."""
        self.paths.append(path)
        source = MemoryRecording([])
        source.name = path.name
        return source


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Recordings, a rosbag2 folder, what is neither, and links: two that stay within, three that lead out."""
    inside, outside = tmp_path / "bags", tmp_path / "secret"
    for name in ("a.bag", "deep/b.mcap", "two/metadata.yaml", "two/two_0.db3", "notes.txt", "noending"):
        (inside / name).parent.mkdir(parents=True, exist_ok=True)
        (inside / name).touch()
    outside.mkdir()
    (outside / "c.bag").touch()
    (inside / "d.bag").symlink_to(inside / "a.bag")
    (inside / "within").symlink_to(inside / "deep")
    (inside / "e.bag").symlink_to(outside / "c.bag")
    (inside / "out").symlink_to(outside)
    (inside / "loop.bag").symlink_to(inside / "loop.bag")
    return inside


def names(library: Library) -> list[str]:
    return [each.name for each in library.listed]


def test_the_recordings_of_a_folder_are_listed(folder: Path) -> None:
    """Files by their endings and rosbag2 folders, named as below it; nothing that a link leads out of it to."""
    library = Library(Opener(), [folder])
    assert names(library) == ["a.bag", "d.bag", "deep/b.mcap", "two"]
    assert {each.group for each in library.listed} == {"bags"}
    assert str(folder.parent) not in repr(library.listed)


def test_a_key_opens_its_recording(folder: Path) -> None:
    """Keys stay the same when the list is made anew, whatever came in between."""
    opener = Opener()
    library = Library(opener, [folder])
    key = library.listed[2].key
    (folder / "aaa.bag").touch()
    library.refresh()
    assert library.open(key)[0].name == "b.mcap"
    assert opener.paths == [folder / "deep/b.mcap"]


@pytest.mark.parametrize("key", ["", "r99", "../secret/c.bag", "/etc/passwd", "a.bag", "r1\0", "R1"])
def test_a_key_that_is_not_in_the_list_opens_nothing(folder: Path, key: str) -> None:
    """Names, paths and numbers of nobody: the disk is not asked."""
    opener = Opener()
    library = Library(opener, [folder])
    with pytest.raises(LibraryError, match="not in the list"):
        library.open(key)
    assert opener.paths == []


def test_a_recording_that_became_a_link_out_of_the_folder_is_refused(folder: Path) -> None:
    """It is looked at again when it is opened."""
    opener = Opener()
    library = Library(opener, [folder])
    (folder / "a.bag").unlink()
    (folder / "a.bag").symlink_to(folder.parent / "secret" / "c.bag")
    with pytest.raises(LibraryError, match="no longer in its folder"):
        library.open(library.listed[0].key)
    assert opener.paths == []


def test_a_rosbag2_folder_with_a_link_out_of_it_is_not_listed(folder: Path) -> None:
    """Of all its files."""
    (folder / "two" / "two_1.db3").symlink_to(folder.parent / "secret" / "c.bag")
    assert "two" not in names(Library(Opener(), [folder]))


def test_recent_demos_and_uploads_are_listed(folder: Path, tmp_path: Path) -> None:
    """What was opened is recent, but for demos and uploads, which are there anyway or go with the program."""
    demo, upload = folder / "deep/b.mcap", tmp_path / "0.bag"
    upload.touch()
    library = Library(Opener(), [folder], {"arena": demo}, Recent(tmp_path / "recent.json"))
    added = library.add(upload, "<my run>.bag")
    assert library.open(added)[0].name == "<my run>.bag"
    for each in library.listed:
        if each.name in ("arena", "a.bag"):
            library.open(each.key)
    library.refresh()
    groups = {group: [e.name for e in library.listed if e.group == group] for group in (UPLOADED, RECENT, DEMOS)}
    assert groups == {UPLOADED: ["<my run>.bag"], RECENT: ["bags/a.bag"], DEMOS: ["arena"]}


def test_an_error_has_the_name_and_not_the_path(folder: Path) -> None:
    """A page is told which recording it was, and nothing of the server's disk."""

    def broken(path: Path, _: Mapping[str, OptionValue]) -> Source:
        raise SourceError(f"{path} is cut off: record it again")

    library = Library(broken, [folder])
    with pytest.raises(LibraryError) as refused:
        library.open(library.listed[0].key)
    assert str(refused.value) == "a.bag is cut off: record it again"


def test_a_folder_that_is_none_is_named(tmp_path: Path) -> None:
    """What is missing, and what is a file."""
    (tmp_path / "a.bag").touch()
    with pytest.raises(LibraryError, match=r"--folder .*bags does not exist"):
        check_folders([tmp_path / "bags"])
    with pytest.raises(LibraryError, match=r"--folder .*a\.bag is no folder"):
        check_folders([tmp_path / "a.bag"])
