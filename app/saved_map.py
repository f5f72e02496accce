"""A map on the disk: map.npz holds all of it exactly, map.yaml and its image are what ROS map servers share."""

import io
import zipfile
import zlib
from pathlib import Path

import numpy as np

from app.ros_map import read_ros_map
from slam_core.config import MapConfig
from slam_core.given import GivenMap, MapError, SavedLevel
from slam_core.measurements import Float64s

NAME = "map.npz"
VERSION = 1
# What numpy and zip raise on a file that is cut, changed or something else.
DAMAGE = (OSError, EOFError, ValueError, KeyError, zipfile.BadZipFile, zlib.error, NotImplementedError)


def to_npz(levels: tuple[SavedLevel, ...]) -> bytes:
    """The same bytes for the same cells."""
    arrays = {"version": np.array(VERSION), "resolutions": np.array([level.resolution for level in levels])}
    for i, level in enumerate(levels):
        arrays[f"corner{i}"], arrays[f"log_odds{i}"] = level.corner, level.log_odds
        if level.surfels is not None:
            arrays[f"surfels{i}"] = level.surfels
    content = io.BytesIO()
    np.savez_compressed(content, allow_pickle=False, **arrays)
    return content.getvalue()


def load_map(path: Path, config: MapConfig, *, write: bool = False, start: Float64s | None = None) -> GivenMap:
    """What is saved in a folder or a file; MapError if there is none, it is damaged, or the settings differ.

    An image has one level: the coarser ones are built from it, as many as the settings ask for. write, start: see
    GivenMap.
    """
    file = _file(path)
    levels = _read_npz(file, config.limit) if file.suffix == ".npz" else read_ros_map(file, config)
    given = GivenMap(str(file), levels, write, start)
    given.check(config)
    return given


def _file(path: Path) -> Path:
    if not path.exists():
        raise MapError(f"{path} does not exist: give the folder that `hectorscope run --out` left")
    if not path.is_dir():
        return path
    if (path / NAME).exists():
        return path / NAME
    described = sorted(path.glob("*.yaml"))
    if len(described) != 1:
        found = ", ".join(file.name for file in described) or "neither map.npz nor a .yaml"
        raise MapError(
            f"{path} holds {found}: give the folder that `hectorscope run --out` left, or one .yaml file"
        )
    return described[0]


def _read_npz(file: Path, limit: float) -> tuple[SavedLevel, ...]:
    try:
        with zipfile.ZipFile(file) as archive:
            megabytes = sum(entry.file_size for entry in archive.infolist()) / 1e6
        if megabytes > limit:
            raise MapError(f"{file} unpacks to {megabytes:.0f} MB: raise --map.limit above that")
        with np.load(file, allow_pickle=False) as arrays:
            if int(arrays["version"]) != VERSION:
                raise MapError(f"{file} is of version {int(arrays['version'])}, not {VERSION}: make the map again")
            entries = dict(arrays)
            del entries["version"]
            levels = tuple(
                _level(
                    float(resolution),
                    entries.pop(f"corner{i}"),
                    entries.pop(f"log_odds{i}"),
                    entries.pop(f"surfels{i}", None),  # of the finest level, and not in maps of long ago
                )
                for i, resolution in enumerate(entries.pop("resolutions"))
            )
            if entries:
                raise ValueError("it holds something else besides")
            return levels
    except DAMAGE as error:
        raise MapError(f"{file} is damaged or no map ({error}): save the map again") from error


def _level(resolution: float, corner: np.ndarray, log_odds: np.ndarray, surfels: np.ndarray | None) -> SavedLevel:
    sound = corner.shape == (2,) and corner.dtype == np.int64 and log_odds.ndim == 2 and log_odds.size
    if not (sound and log_odds.dtype == np.float32 and np.isfinite(log_odds).all() and 0.0 < resolution < 100.0):
        raise ValueError("a level is not made of cells")
    if surfels is not None and not (surfels.dtype == np.uint32 and surfels.shape == log_odds.shape):
        raise ValueError("the surfels are not as many as the cells")
    return SavedLevel(resolution, corner, log_odds, surfels)
