"""gmr: motion capture at memory speed."""

# Nothing is imported here, not even typing: the command line can answer an interrupt only after this module.
TYPE_CHECKING = False

if TYPE_CHECKING:
    from typing import Any

    from gmr import actionlets, editing, evaluation, markers, matching, skinning, view
    from gmr._core import __version__
    from gmr.bone_tails import Bones, bones
    from gmr.channels import ChannelLayout
    from gmr.concatenation import concatenate
    from gmr.errors import (
        ActionletError,
        DatasetError,
        FormatError,
        FormatWarning,
        GmrError,
        MissingExtraError,
        SkeletonError,
        SkinError,
        SkinWarning,
    )
    from gmr.evaluation.compare import compare
    from gmr.evaluation.comparison import Comparison
    from gmr.evaluation.evaluate import evaluate
    from gmr.evaluation.result import Evaluation
    from gmr.formats import read, read_character, read_folder, read_markers, write, write_character
    from gmr.kinematics import forward_kinematics
    from gmr.markers.recording import Markers
    from gmr.motion import Motion
    from gmr.skeleton import Skeleton
    from gmr.skinning.character import Character

__all__ = [
    "ActionletError",
    "Bones",
    "ChannelLayout",
    "Character",
    "Comparison",
    "DatasetError",
    "Evaluation",
    "FormatError",
    "FormatWarning",
    "GmrError",
    "Markers",
    "MissingExtraError",
    "Motion",
    "Skeleton",
    "SkeletonError",
    "SkinError",
    "SkinWarning",
    "__version__",
    "actionlets",
    "bones",
    "compare",
    "concatenate",
    "editing",
    "evaluate",
    "evaluation",
    "forward_kinematics",
    "markers",
    "matching",
    "read",
    "read_character",
    "read_folder",
    "read_markers",
    "skinning",
    "view",
    "write",
    "write_character",
]

# All is imported when first used: `gmr --help` answers at once, and an instruction set that this machine has
# not (GMR_ISA) is the command line's to explain.
_HOMES = {
    "ActionletError": "gmr.errors",
    "Bones": "gmr.bone_tails",
    "ChannelLayout": "gmr.channels",
    "Character": "gmr.skinning.character",
    "Comparison": "gmr.evaluation.comparison",
    "DatasetError": "gmr.errors",
    "Evaluation": "gmr.evaluation.result",
    "FormatError": "gmr.errors",
    "FormatWarning": "gmr.errors",
    "GmrError": "gmr.errors",
    "Markers": "gmr.markers.recording",
    "MissingExtraError": "gmr.errors",
    "Motion": "gmr.motion",
    "Skeleton": "gmr.skeleton",
    "SkeletonError": "gmr.errors",
    "SkinError": "gmr.errors",
    "SkinWarning": "gmr.errors",
    "__version__": "gmr._core",
    "bones": "gmr.bone_tails",
    "compare": "gmr.evaluation.compare",
    "concatenate": "gmr.concatenation",
    "evaluate": "gmr.evaluation.evaluate",
    "forward_kinematics": "gmr.kinematics",
    "read": "gmr.formats",
    "read_character": "gmr.formats",
    "read_folder": "gmr.formats",
    "read_markers": "gmr.formats",
    "write": "gmr.formats",
    "write_character": "gmr.formats",
}
_MODULES = frozenset({"actionlets", "editing", "evaluation", "markers", "matching", "skinning", "view"})


def __getattr__(name: str) -> "Any":
    from importlib import import_module

    if name in _MODULES:
        return import_module(f"gmr.{name}")
    if name not in _HOMES:
        raise AttributeError(f"module 'gmr' has no attribute '{name}'")
    found = getattr(import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
