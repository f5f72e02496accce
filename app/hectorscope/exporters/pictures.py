"""pictures.zip: the pictures of the marks, by their numbers; no file where there are none."""

import io
import zipfile
from pathlib import Path

from hectorscope.common.paths import write_whole
from hectorscope.exporters import Exporter
from hectorscope.exporters._files import PICTURES
from hectorscope.run.results import Run


def _write(run: Run, folder: Path) -> None:
    shown = [(mark.picture_name, mark.picture) for mark in run.annotations if mark.picture]
    if not shown:
        (folder / PICTURES).unlink(missing_ok=True)
        return
    content = io.BytesIO()
    with zipfile.ZipFile(content, "w") as archive:
        for name, picture in shown:
            archive.writestr(zipfile.ZipInfo(name), picture.content)
    write_whole(folder / PICTURES, content.getvalue())


EXPORTER = Exporter("pictures", (PICTURES,), _write, default=True)
