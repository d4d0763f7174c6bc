"""Blocks in blocks: how text formats write a forest of joints."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence

from gmr.skeleton import Skeleton

__all__ = ["file_order", "nested_lines"]

_DEEPEST_INDENT = 32
"""Deeper blocks are indented no further: a chain of joints would make the file grow with its square."""


def file_order(skeleton: Skeleton) -> list[int]:
    """Joints as a file nests them: each before its children, siblings as they are listed."""
    order: list[int] = []
    waiting = list(reversed(skeleton.roots))
    while waiting:
        joint = waiting.pop()
        order.append(joint)
        waiting.extend(reversed(skeleton.children[joint]))
    return order


def nested_lines(
    order: Iterable[int], parents: Sequence[int], block: Callable[[int], tuple[str, list[str]]]
) -> Iterator[str]:
    """The lines of a block for each joint, those of its children in it.

    Args:
        order: joints as :func:`file_order` lists them; some of those without children may be left out.
        parents: (J,) -1 for a root.
        block: the line above a joint's brace, and those below it.
    """
    open_joints: list[int] = []
    for joint in order:
        while open_joints and open_joints[-1] != parents[joint]:
            open_joints.pop()
            yield _indent(len(open_joints)) + "}"
        tabs = _indent(len(open_joints))
        head, lines = block(joint)
        yield f"{tabs}{head}"
        yield f"{tabs}{{"
        for line in lines:
            yield f"{tabs}\t{line}"
        open_joints.append(joint)
    while open_joints:
        open_joints.pop()
        yield _indent(len(open_joints)) + "}"


def _indent(depth: int) -> str:
    return "\t" * min(depth, _DEEPEST_INDENT)
