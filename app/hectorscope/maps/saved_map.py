"""A map on the disk: map.npz holds all of it exactly, map.yaml and its image are what ROS map servers share."""

import io
import zipfile
from collections import defaultdict
from collections.abc import Sequence
from pathlib import Path

import numpy as np

from hectorscope.common.paths import absence, exists
from hectorscope.maps.ros_map import read_ros_map
from slam_core.config import MapConfig
from slam_core.localization.prior_map import MapError, PriorMap, SavedLevel
from slam_core.measurements import Float64s, Int64s

NAME = "map.npz"
WHOLE, IN_PARTS = 1, 2  # versions: each level as one rectangle, or as several


def to_npz(levels: tuple[SavedLevel, ...]) -> bytes:
    """The same bytes for the same cells."""
    resolutions = [level.resolution for level in levels]
    version = WHOLE if len(set(resolutions)) == len(resolutions) else IN_PARTS
    arrays = {"version": np.array(version), "resolutions": np.array(resolutions)}
    for i, level in enumerate(levels):
        arrays[f"corner{i}"], arrays[f"log_odds{i}"] = level.corner, level.log_odds
        if level.surfels is not None:
            arrays[f"surfels{i}"] = level.surfels
    content = io.BytesIO()
    np.savez_compressed(content, allow_pickle=False, **arrays)
    return content.getvalue()


def load_map(path: Path, config: MapConfig, *, write: bool = False, start: Float64s | None = None) -> PriorMap:
    """What is saved in a folder or a file; MapError if there is none, it is damaged, or the settings differ.

    An image has one level: the coarser ones are built from it, as many as the settings ask for. write, start: see
    PriorMap.
    """
    file = _file(path)
    levels = _read_npz(file, config.limit) if file.suffix == ".npz" else read_ros_map(file, config)
    prior_map = PriorMap(str(file), levels, write, start)
    prior_map.check(config)
    return prior_map


def _file(path: Path) -> Path:
    if why := absence(path):
        raise MapError(f"{path} {why}: give the folder that `hectorscope run --out` left")
    if not path.is_dir():
        return path
    if exists(path / NAME):
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
            version = arrays["version"]
            if version.ndim or version.dtype.kind not in "iu":
                raise ValueError("its version is no whole number")
            if version not in (WHOLE, IN_PARTS):
                raise MapError(f"{file} is of version {version}, not {WHOLE} or {IN_PARTS}: make the map again")
            entries = {name: arrays[name] for name in arrays if name != "version"}
            return _levels(entries, in_parts=bool(version == IN_PARTS))
    except MapError:
        raise
    except Exception as error:  # the ways of numpy and zip to stumble over a damaged file are many
        raise MapError(f"{file} is damaged or no map ({error}): save the map again") from error


def _levels(entries: dict[str, np.ndarray], *, in_parts: bool) -> tuple[SavedLevel, ...]:
    resolutions = entries.pop("resolutions")
    if resolutions.ndim != 1 or resolutions.dtype != np.float64 or not resolutions.size:
        raise ValueError("its resolutions are not one number a level")
    levels = tuple(
        _level(
            float(resolution),
            entries.pop(f"corner{i}"),
            entries.pop(f"log_odds{i}"),
            entries.pop(f"surfels{i}", None),  # of the finest level, and not in maps of long ago
        )
        for i, resolution in enumerate(resolutions)
    )
    if entries:
        raise ValueError("it holds something else besides")
    _check_pyramid(levels, in_parts=in_parts)
    return levels


def _level(resolution: float, corner: np.ndarray, log_odds: np.ndarray, surfels: np.ndarray | None) -> SavedLevel:
    sound = corner.shape == (2,) and corner.dtype == np.int64 and log_odds.ndim == 2 and log_odds.size
    if not (sound and log_odds.dtype == np.float32 and np.isfinite(log_odds).all() and 0.0 < resolution < 100.0):
        raise ValueError("a level is not made of cells")
    if surfels is not None and not (surfels.dtype == np.uint32 and surfels.shape == log_odds.shape):
        raise ValueError("the surfels are not as many as the cells")
    return SavedLevel(resolution, corner, log_odds, surfels)


def _check_pyramid(levels: tuple[SavedLevel, ...], *, in_parts: bool) -> None:
    """ValueError unless each level has half the resolution of the one below, and all cover the same area.

    To a cell or two: the finest level also holds what is behind walls, and ends on the edge of a cell are rounded.
    """
    whole: defaultdict[float, list[SavedLevel]] = defaultdict(list)
    for i, level in enumerate(levels):
        whole[level.resolution if in_parts else i].append(level)
    low, high = _extent(whole[levels[0].resolution if in_parts else 0])
    for i, parts in enumerate(whole.values()):
        first, last = _extent(parts)
        apart = first - (low >> i), last + (-high >> i)
        if abs(parts[0].resolution - levels[0].resolution * 2**i) > 1e-9 or np.abs(apart).max() > 2:
            raise ValueError(f"level {i} does not cover level 0 with cells {2**i} times as large")


def _extent(parts: Sequence[SavedLevel]) -> tuple[Int64s, Int64s]:
    """First and last column and row, the last excluded, of a level in parts."""
    low = np.min([part.corner for part in parts], axis=0)
    return low, np.max([part.corner + part.log_odds.shape[::-1] for part in parts], axis=0)
