"""Folders as registries: a new file in sources, views, panels or exporters is found by itself."""

import importlib
import pkgutil
from types import ModuleType
from typing import Any


def members(package: ModuleType, attribute: str) -> list[Any]:
    """`attribute` of every module of `package` that has it, by module name; names with _ in front are helpers."""
    names = sorted(m.name for m in pkgutil.iter_modules(package.__path__) if not m.name.startswith("_"))
    modules = [importlib.import_module(f"{package.__name__}.{name}") for name in names]
    return [getattr(module, attribute) for module in modules if hasattr(module, attribute)]
