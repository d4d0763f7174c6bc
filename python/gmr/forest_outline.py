"""A motion's forest in words: its trees, soft links and dummies, for people and for machines."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from gmr.dummies import find_dummies
from gmr.skeleton import Skeleton

if TYPE_CHECKING:
    from gmr.motion import Motion

__all__ = ["described", "drawn"]


def described(motion: Motion) -> dict[str, Any]:
    """The forest as plain data.

    Returns:
        ``roots``; ``links``: for each cut joint the parent that it had; ``trees``: for each root its joints,
        in file order; ``parents``: of each joint, None for a root; ``dummies``.
    """
    skeleton = motion.skeleton
    names, links = skeleton.names, skeleton.links
    trees: dict[int, list[str]] = {root: [] for root in skeleton.roots}
    for joint, name in enumerate(names):
        trees[skeleton.forest.root_of(joint)].append(name)
    return {
        "joint_count": skeleton.joint_count,
        "roots": list(motion.roots),
        "links": [
            {"joint": names[joint], "parent": names[link]}
            for joint, link in enumerate(links.tolist())
            if link >= 0
        ],
        "trees": [{"root": names[root], "joints": joints} for root, joints in trees.items()],
        "parents": [
            {"joint": name, "parent": names[parent] if parent >= 0 else None}
            for name, parent in zip(names, skeleton.parents.tolist(), strict=True)
        ],
        "dummies": list(motion.dummies),
    }


def drawn(motion: Motion) -> str:
    """The forest as text: a tree for each root, its joints indented below the one they hang on.

    A chain of joints without branches stands in one line. Marks tell soft links, dummies, and joints that
    hang the other way round than at home.
    """
    skeleton = motion.skeleton
    dummies = set(find_dummies(motion))
    count = len(skeleton.roots)
    cut = int((skeleton.links >= 0).sum())
    lines = [
        f"{_counted(skeleton.joint_count, 'joint')} in {_counted(count, 'tree')}, "
        f"{_counted(cut, 'soft link')}, {_counted(len(dummies), 'dummy', 'dummies')}"
    ]
    for root in skeleton.roots:
        lines += ["", *_tree(skeleton, root, dummies)]
    notes = _notes(skeleton, dummies)
    return "\n".join([*lines, *(["", *notes] if notes else [])])


def _tree(skeleton: Skeleton, root: int, dummies: set[int]) -> list[str]:
    top = skeleton.forest.top_of(root)
    link = int(skeleton.links[top])
    lines = [_root_line(skeleton, root, top, link)]
    # A chain, how far it is indented, and whether it is the last of its siblings; the next one last.
    waiting = [(child, "", k == 0) for k, child in enumerate(reversed(skeleton.children[root]))]
    while waiting:
        joint, indent, is_last = waiting.pop()
        chain = [joint]
        while len(children := skeleton.children[chain[-1]]) == 1:
            chain.append(children[0])
        words = " - ".join(_word(skeleton, one, dummies) for one in chain)
        lines.append(f"{indent}{'└─ ' if is_last else '├─ '}{words}")
        deeper = indent + ("   " if is_last else "│  ")
        waiting += [(child, deeper, k == 0) for k, child in enumerate(reversed(children))]
    return lines


def _root_line(skeleton: Skeleton, root: int, top: int, link: int) -> str:
    name = skeleton.names[root]
    if link < 0:
        return f"{name}  (root)" if root == top else f"{name}  (root; at home {skeleton.names[top]})"
    bone = f"{skeleton.names[top]} ~ {skeleton.names[link]}"
    return f"{name}  (root; soft link {bone})"


def _word(skeleton: Skeleton, joint: int, dummies: set[int]) -> str:
    """A joint's name with its marks."""
    turned = "^" if int(skeleton.forest.bones[joint]) != joint else ""
    return f"{skeleton.names[joint]}{turned}{'*' if joint in dummies else ''}"


def _notes(skeleton: Skeleton, dummies: set[int]) -> list[str]:
    """What the marks mean, as far as they are there."""
    parents = skeleton.parents
    bones = skeleton.forest.bones
    notes = []
    if dummies:
        notes.append("*  dummy: of zero length in every frame")
    if any(parents[joint] >= 0 and bones[joint] != joint for joint in range(skeleton.joint_count)):
        notes.append("^  hangs the other way round: at home it is the parent")
    if (skeleton.links >= 0).any():
        notes.append("~  soft link: the bone that is cut, and that --join mends")
    return notes


def _counted(count: int, one: str, several: str | None = None) -> str:
    return f"{count} {one if count == 1 else several or one + 's'}"
