"""ASF and AMC for tests: a small pair whose parts can be exchanged, random skeletons and their motions."""

from __future__ import annotations

import math

import numpy as np
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.typing import NDArray
from scipy.spatial.transform import Rotation

from gmr import Motion
from gmr.acclaim import UNLIMITED, Acclaim, Bone, Root
from gmr.dof_rows import DofRows
from gmr.formats.asf_amc import amc_chunks, asf_chunks, read_amc
from strategies import ORDERS

ASF = """# a small man
:version 1.10
:name SMALL
:units
  mass 2.5
  length 0.45
  angle deg
:documentation
   one leg # and no arm
:root
   order TX TY TZ RX RY RZ
   axis XYZ
   position 1 2 3
   orientation 0 0 0
:bonedata
  begin
     id 1
     name hip
     direction 1 0 0
     length 2.5
     axis 0 0 0 XYZ
  end
  begin
     id 2
     name thigh
     direction 0 -1 0
     length 7
     axis 0 0 20 XYZ
    dof rx ry rz
    limits (-160.0 20.0)
           (-70.0 70.0)
           (-inf 70.0)
     bodymass 3
  end
  begin
     id 3
     name shin
     direction 0 -1 0
     length 6
     axis 10 20 30 ZYX
    dof rx rz
    limits (-10 170) (0 5)
  end
:hierarchy
  begin
    root hip
    hip thigh
    thigh shin
  end
"""

AMC = """#!OML:ASF small.asf
:FULLY-SPECIFIED
:DEGREES
1
root 1 2 3 10 20 30
thigh 5 -6 7.5
shin 80 1e-3
2
root 1.5 2.5 3.5 11 21 31
thigh 5 -6 8.5
shin 81 0
"""


def asf(*changes: tuple[str, str]) -> bytes:
    """The small skeleton with parts exchanged, each once."""
    return _changed(ASF, changes)


def amc(*changes: tuple[str, str]) -> bytes:
    """The small motion with parts exchanged, each once."""
    return _changed(AMC, changes)


def _changed(text: str, changes: tuple[tuple[str, str], ...]) -> bytes:
    for old, new in changes:
        assert old in text, old
        text = text.replace(old, new, 1)
    return text.encode()


def written(motion: Motion) -> tuple[bytes, bytes]:
    """The ASF and the AMC of a motion."""
    return b"".join(asf_chunks(motion)), b"".join(amc_chunks(motion))


def read_back(motion: Motion) -> Motion:
    """The motion after it was written."""
    skeleton, frames = written(motion)
    return read_amc(frames, asf=skeleton)


def _of_length_1(vector: tuple[float, float, float]) -> tuple[float, float, float]:
    x, y, z = (value / math.hypot(*vector) for value in vector)
    return x, y, z


numbers = st.one_of(st.integers(-9, 9).map(float), st.floats(-200, 200, allow_subnormal=False))
vectors = st.tuples(numbers, numbers, numbers)
directions = vectors.filter(any).map(_of_length_1)
turns = st.permutations(["rx", "ry", "rz"]).flatmap(
    lambda dofs: st.integers(0, 3).map(lambda count: tuple(dofs[:count]))
)
limits = st.one_of(st.just(UNLIMITED), st.tuples(numbers, numbers), numbers.map(lambda low: (low, math.inf)))


@st.composite
def bones(draw: st.DrawFn, name: str) -> Bone:
    dofs = draw(turns)
    return Bone(
        name,
        draw(directions),
        draw(st.floats(0, 50)),
        draw(st.one_of(st.just((0.0, 0.0, 0.0)), vectors)),
        draw(st.sampled_from(ORDERS)),
        dofs,
        tuple(draw(limits) for _ in dofs),
        draw(st.sampled_from(["7", "a"])),
        draw(st.sampled_from([(), ("bodymass 3", "cofmass 1")])),
    )


@st.composite
def acclaims(draw: st.DrawFn, max_bones: int = 5) -> Acclaim:
    """Any skeleton that gmr reads."""
    count = draw(st.integers(0, max_bones))
    order = draw(st.permutations(["TX", "TY", "TZ", "RX", "RY", "RZ"]))
    root = Root(
        tuple(order[: draw(st.integers(1, 6))]), draw(st.sampled_from(ORDERS)), draw(vectors), draw(vectors)
    )
    places = draw(st.permutations(range(1, count + 1)))
    above = {0: 0}
    for k, joint in enumerate(places):
        above[joint] = draw(st.sampled_from([0, *places[:k]]))
    return Acclaim(
        root,
        tuple(draw(bones(f"bone{k}")) for k in range(count)),
        tuple(above[joint] for joint in range(1, count + 1)),
        length=draw(st.sampled_from([1.0, 0.45, 2.54])),
        mass=draw(st.sampled_from([1.0, 75.5])),
        radians=draw(st.booleans()),
        documentation=("  drawn",),
        notes=draw(st.sampled_from([(), ("!one", " two")])),
    )


@st.composite
def dof_motions(draw: st.DrawFn, min_frames: int = 0, max_frames: int = 3) -> Motion:
    """A motion as read of an AMC."""
    acclaim = draw(acclaims())
    shape = (draw(st.integers(min_frames, max_frames)), acclaim.column_count)
    values = draw(arrays(np.float64, shape, elements=numbers, fill=st.just(0.0)))
    valued = [joint for joint, names in enumerate(acclaim.channels) if names]
    listed = tuple(draw(st.permutations(valued))) if shape[0] else ()
    first = draw(st.sampled_from([1, 0, 130])) if shape[0] else 0
    rate = draw(st.sampled_from([120, 60.0, 29.97]))
    source = DofRows(values, acclaim, draw(st.booleans()), listed, first, rate != 120)
    return Motion(acclaim.skeleton, 1 / rate, source, acclaim.unit)


def matrices_by_definition(motion: Motion) -> NDArray[np.float64]:
    """(F, J, 4, 4) by SciPy, factor by factor: ``M_parent C A C^-1 T``, the root ``T C A C^-1``."""
    source = motion.source
    assert isinstance(source, DofRows)
    acclaim = source.acclaim
    parents = [-1, *acclaim.parents]
    found = np.zeros((len(source), len(parents), 4, 4))
    found[:] = np.eye(4)
    for joint in motion.skeleton.parents_first:
        told = acclaim.root if joint == 0 else acclaim.bones[joint - 1]
        angles = told.orientation if isinstance(told, Root) else told.axis
        c = _turned(list(told.axis_order.lower()), np.array([angles]), acclaim.radians)
        names = acclaim.channels[joint]
        columns = source.values[:, acclaim.starts[joint] : acclaim.starts[joint + 1]]
        turning = [k for k, name in enumerate(names) if name[0] == "r"]
        a = _turned([names[k][1] for k in turning], columns[:, turning], source.radians)
        local = np.tile(np.eye(4), (len(source), 1, 1))
        local[:, :3, :3] = c @ a @ np.swapaxes(c, -1, -2)
        if isinstance(told, Root):
            local[:, :3, 3] = told.position
            for k, name in enumerate(names):
                if name[0] == "t":
                    local[:, "xyz".index(name[1]), 3] += columns[:, k]
            found[:, 0] = local
            continue
        shift = np.eye(4)
        shift[:3, 3] = np.multiply(told.direction, told.length)
        found[:, joint] = found[:, parents[joint]] @ local @ shift
    return found


def _turned(axes: list[str], angles: NDArray[np.float64], radians: bool) -> NDArray[np.float64]:
    """(F, 3, 3) of (F, n) angles, each applied after the one before it, about axes that stay."""
    found = np.tile(np.eye(3), (len(angles), 1, 1))
    for k, axis in enumerate(axes):
        turned = Rotation.from_euler(axis, angles[:, k : k + 1], degrees=not radians)
        found = turned.as_matrix() @ found
    return found
