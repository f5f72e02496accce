"""The examples of docs/extending.md, each put into its folder as a reader would."""

import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from types import ModuleType

import numpy as np
import pytest

from hectorscope.exporters import exporters
from hectorscope.inputs import SourceError, SourceOptions
from hectorscope.panels import panel_classes
from hectorscope.run.headless import run_headless
from hectorscope.run.results import Run
from hectorscope.run.settings import Settings
from hectorscope.session.engine import Engine
from hectorscope.session.snapshot import Snapshot
from hectorscope.sources import open_source
from hectorscope.views import view_classes
from hectorscope.web.server import PageServer
from slam_core.config import SlamConfig, with_value
from tests.conftest import ROOT
from tests.sources import MemoryRecording

SMALL = Settings(with_value(SlamConfig(), "map.size", 256))


def example(folder: str) -> tuple[str, str]:
    """Name and text of the file that the document puts into `folder`."""
    text = (ROOT / "docs" / "extending.md").read_text(encoding="utf-8")
    found = re.findall(rf"`app/hectorscope/{folder}/(\w+)\.py`:\n\n```python\n(.*?)```", text, re.DOTALL)
    assert len(found) == 1
    return found[0]


@pytest.fixture
def added(request: pytest.FixtureRequest, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[str]:
    """The module's name, after a folder with the example has joined the package."""
    package: ModuleType = importlib.import_module(f"hectorscope.{request.param}")
    name, text = example(request.param)
    (tmp_path / f"{name}.py").write_text(text, encoding="utf-8")
    monkeypatch.setattr(package, "__path__", [*package.__path__, str(tmp_path)])
    yield name
    sys.modules.pop(f"{package.__name__}.{name}", None)


@pytest.fixture
def ranges(tmp_path: Path) -> str:
    """Two sweeps in an open half circle of 3 m."""
    file = tmp_path / "room.csv"
    file.write_text("".join(f"{stamp}," + ",".join(["3.0"] * 181) + "\n" for stamp in (0, 10**8)))
    return str(file)


@pytest.mark.parametrize("added", ["sources"], indirect=True)
def test_source_is_found_and_runs(added: str, ranges: str):
    """The pipeline runs on the example source, chosen by the address alone, and stays within a cell."""
    pipeline, _ = run_headless(open_source(ranges, SourceOptions()), SMALL)
    assert pipeline.scans == 2
    np.testing.assert_allclose(pipeline.trajectory[:, 1:4], 0.0, atol=0.05)


@pytest.mark.parametrize("added", ["sources"], indirect=True)
def test_source_names_what_it_cannot_read(added: str, tmp_path: Path):
    """A file without numbers is refused with its name and the remedy."""
    (tmp_path / "words.csv").write_text("no,numbers\n")
    with pytest.raises(SourceError, match=r"words\.csv is no table of ranges .*: give numbers"):
        open_source(str(tmp_path / "words.csv"), SourceOptions())


@pytest.mark.parametrize("added", ["exporters"], indirect=True)
def test_exporter_writes_its_files(added: str, tmp_path: Path):
    """The example is found, and what it says it writes is there with a line a pose."""
    (exporter,) = [e for e in exporters() if e.files == ("path.csv",)]
    exporter.write(Run(0, np.arange(16.0).reshape(2, 8), (), SMALL, {}), tmp_path)
    rows = (tmp_path / "path.csv").read_text().splitlines()
    assert rows == ["t,x,y,z", "0.000,1.0000,2.0000,3.0000", "8.000,9.0000,10.0000,11.0000"]


@pytest.fixture
def page() -> Iterator[PageServer]:
    """The page of an engine that has nothing to do."""
    server = PageServer(Engine(MemoryRecording([]), SMALL), port=0)
    server.start()
    yield server
    server.stop()


@pytest.mark.parametrize("added", ["views"], indirect=True)
def test_view_draws_on_the_page(added: str, page: PageServer):
    """The example is one of the views that the page was made with; it shows itself from the first scan on."""
    (view,) = [v for v in view_classes() if v.title == "Origin"]
    assert "origin" in {layer.key for layer in page.scene.layers}
    drawn = view(page.scene)
    drawn.draw(Snapshot())
    assert not drawn._axes.visible
    drawn.draw(Snapshot(scans=1))
    assert drawn._axes.visible


@pytest.mark.parametrize("added", ["panels"], indirect=True)
def test_panel_reads_out(added: str, page: PageServer):
    """The example is one of the panels; it sums the path."""
    (panel,) = [p for p in panel_classes() if p.title == "Distance"]
    made = panel(page.scene)
    made.draw(Snapshot(trajectory=np.array([[0.0, 0, 0, 0, 1, 0, 0, 0], [1.0, 3, 4, 0, 1, 0, 0, 0]])))
    assert "5.00 m" in made._length.content
