"""The libraries that gmr is measured against, each called as its documentation says."""

from __future__ import annotations

import importlib
import importlib.util
from collections.abc import Sequence
from importlib.metadata import PackageNotFoundError, version
from types import ModuleType
from typing import Final

__all__ = ["DISTRIBUTIONS", "Peers", "find_peers"]

DISTRIBUTIONS: Final = {
    "pybvh": "pybvh",
    "pymotion": "upc-pymotion",
    "asfamcparser": "asfamc-parser",
    "scipy": "scipy",
    "faiss": "faiss-cpu",
    "hnswlib": "hnswlib",
    "igl": "libigl",
}
"""Distribution that installs each peer, by the name of its module."""


class Peers:
    """Those of the asked peers that are installed, and how to install the others.

    Args:
        modules: names of the peers' modules, keys of :data:`DISTRIBUTIONS`.
    """

    def __init__(self, modules: Sequence[str]) -> None:
        self._present = {name: importlib.import_module(name) for name in modules if _is_installed(name)}
        self.absent: Final = {
            label(name): f"not installed: pip install {DISTRIBUTIONS[name]}"
            for name in modules
            if name not in self._present
        }

    def __contains__(self, module: str) -> bool:
        return module in self._present

    def __getitem__(self, module: str) -> ModuleType:
        return self._present[module]


def find_peers(*modules: str) -> Peers:
    """Looks for these peers; installs nothing."""
    return Peers(modules)


def label(module: str) -> str:
    """The peer's distribution and version, as the table names it."""
    distribution = DISTRIBUTIONS[module]
    try:
        return f"{distribution} {version(distribution)}"
    except PackageNotFoundError:
        return distribution


def _is_installed(module: str) -> bool:
    return importlib.util.find_spec(module) is not None
