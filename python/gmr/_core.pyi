"""The extension module: kernels over plain arrays."""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

__version__: str

# --- isa ---

def instruction_set() -> str: ...
def instruction_sets() -> list[str]: ...

# --- index ---

class Index:
    """Exact nearest neighbours of float32 rows in squared distance; ties go to the lowest frame.

    Args:
        features: (N, D), C-contiguous; finite in every candidate row.
        candidates: (N,) rows that can be found; all where left out.
        tags: (N,) bits of each row; none where left out.
        threads: that build it; 0: all cores. The bits do not depend on it.

    Raises:
        ValueError: when shapes do not fit or a candidate's feature is not finite.
    """

    def __init__(
        self,
        features: NDArray[np.float32],
        candidates: NDArray[np.bool_] | None = None,
        tags: NDArray[np.uint32] | None = None,
        threads: int = 0,
    ) -> None: ...
    @property
    def dims(self) -> int: ...
    @property
    def frame_count(self) -> int: ...
    @property
    def candidate_count(self) -> int: ...
    def search(
        self,
        queries: NDArray[np.float32],
        k: int = 1,
        tags: NDArray[np.uint32] | None = None,
        exclude: NDArray[np.uint32] | None = None,
        max_cost: float = ...,
        threads: int = 0,
        weights: NDArray[np.float32] | None = None,
    ) -> tuple[NDArray[np.float32], NDArray[np.int64]]:
        """The ``k`` best frames of each query, best first.

        Args:
            queries: (Q, D), C-contiguous and finite.
            k: hits a query.
            tags: (1,) or (Q,) bits that a frame must all carry.
            exclude: (Q, 2) first and one past the last frame that is no candidate.
            max_cost: only frames that cost strictly less are hits.
            threads: 0 means all cores; the answer is the same for every number.
            weights: (1, D) or (Q, D) that squared differences are multiplied by, 0 or more; 1 where left out.

        Returns:
            Costs (Q, k), float32, inf where there is no hit; frames (Q, k), -1 where there is no hit.

        Raises:
            ValueError: when shapes do not fit or a query is not finite.
        """

# --- matching ---

def simulation_root(
    positions: NDArray[np.float32],
    hips: int,
    across: list[tuple[int, int]],
    position_window: int,
    heading_window: int,
) -> tuple[NDArray[np.float64], NDArray[np.float64]]:
    """Ground positions (F, 2) and continuous headings (F,) of a body's smoothed root.

    Args:
        positions: (F, J, 3) world positions in metres, Y up, C-contiguous.
        hips: joint whose projection is the position.
        across: (left, right) joints whose directions are averaged.
        position_window: frames that a smoothed position is fitted to.
        heading_window: frames that a smoothed heading is fitted to.

    Raises:
        ValueError: a joint does not exist, or no frame shows a facing.
    """

def smooth(samples: NDArray[np.float64], window: int) -> NDArray[np.float64]:
    """Cubic Savitzky-Golay filter, read from the end windows' own cubics at the ends."""

class DatabaseBuilder:
    """Collects clips of one skeleton, metres and Y up, then makes their database.

    Args:
        topology: J joints, S slots.
        translated: the T joints with a translation in every frame.
        groups: name, measure, joint, frames and weight of each feature group.
        rate: frames a second.

    Raises:
        ValueError: a joint does not exist, a group is none, or a bone stands under no rotation.
    """

    def __init__(
        self,
        topology: Topology,
        translated: list[int],
        groups: list[tuple[str, str, int | None, list[int], float]],
        rate: float,
    ) -> None: ...
    @property
    def needed_frames(self) -> int:
        """Frames that a clip must have to hold one candidate."""

    def add_clip(
        self,
        positions: NDArray[np.float32],
        rotations: NDArray[np.float64],
        translations: NDArray[np.float64],
        offsets: NDArray[np.float64],
        ground: NDArray[np.float64],
        heading: NDArray[np.float64],
        tags: NDArray[np.uint32] | None = None,
    ) -> int:
        """Adds a clip of F frames; returns its index.

        Args:
            positions: (F, J, 3) in the world.
            rotations: (F, S, 4) local, xyzw.
            translations: (F, T, 3) a root's place in the world, another joint's vector in its slot's frame.
            offsets: (J, 3) of this clip's skeleton.
            ground: (F, 2) of its simulation root.
            heading: (F,) of its simulation root, continuous.
            tags: (F,) bits.

        Raises:
            ValueError: shapes do not fit, or a number is not finite; the builder is as it was.
        """

    def finish(
        self,
        offset: list[float] | NDArray[np.float32] | None = None,
        scale: list[float] | NDArray[np.float32] | None = None,
        threads: int = 0,
    ) -> Database:
        """The database, scaled by itself or as given; the builder is then used up.

        ``threads`` build its index, 0: all cores; the bits do not depend on it.

        Raises:
            ValueError: no clip holds a candidate, or the scale is of another schema.
        """

class Database:
    """N rows; arrays are read-only and share its memory."""

    features: NDArray[np.float32]
    clips: NDArray[np.uint32]
    candidates: NDArray[np.bool_]
    tags: NDArray[np.uint32]
    ground: NDArray[np.float64]
    heading: NDArray[np.float64]
    positions: NDArray[np.float32]
    rotations: NDArray[np.float32]
    translations: NDArray[np.float32]
    displacements: NDArray[np.float32]
    turns: NDArray[np.float32]
    clip_ranges: list[tuple[int, int]]
    normalization: tuple[list[float], list[float]]
    constant_groups: list[int]
    is_trajectory: list[bool]
    rate: float
    translated: list[int]
    index: Index
    def subset(self, left: NDArray[np.bool_], threads: int = 0) -> Database:
        """The same rows, of which only those of (N,) ``left`` may be shown; shares the poses.

        ``threads`` build its index, 0: all cores; the bits do not depend on it.

        Raises:
            ValueError: another number of rows, or none that may be jumped to is left.
        """

    def offsets(self, row: int) -> NDArray[np.float32]:
        """(J, 3) of the skeleton of the clip that the row belongs to, metres."""

    def costs_by_group(
        self,
        queries: NDArray[np.float32],
        rows: NDArray[np.int64],
        weights: NDArray[np.float32] | None = None,
    ) -> NDArray[np.float32]:
        """(Q, k, G) what rows (Q, k) cost queries (Q, D) by feature group; NaN for rows below 0."""

    def normalize(self, raw: NDArray[np.float32]) -> NDArray[np.float32]:
        """(Q, D) scaled features of (Q, D) raw numbers."""

def save_database(
    database: Database, path: str, joints: list[str], clips: list[str], notes: dict[str, str]
) -> None:
    """Saves a database with the names of its joints and clips, and whatever else by name.

    Raises:
        ValueError: there is not one name for each.
        OSError: the file cannot be written.
    """

def check_database(database: Database) -> None:
    """Holds the index against the rows.

    Raises:
        ValueError: a part of its file is damaged, or it is the index of other rows.
    """

def open_database(path: str) -> tuple[Database, list[str], list[str], dict[str, str]]:
    """What was saved, mapped into memory.

    Raises:
        ValueError: it is no saved database.
        OSError: the file cannot be read.
    """

class Character:
    """A body that is stepped; places are x, z and heading."""

    def __init__(
        self,
        database: Database,
        place: tuple[float, float, float],
        search_every: float,
        exclude_within: int,
        transition_penalty: float,
        tags: int,
        weights: list[float] | None,
        half_life: float,
    ) -> None: ...
    times: list[float]
    place: tuple[float, float, float]
    choice: tuple[int, int, float, float]
    def search_now(self) -> None: ...
    def step(
        self, wanted: NDArray[np.float64], dt: float
    ) -> tuple[NDArray[np.float32], NDArray[np.float32], tuple[float, float, float]]:
        """Positions (J, 3), bone rotations (J, 4) and place after ``dt`` seconds.

        Raises:
            ValueError: a shape or a number is out of bounds.
        """

    def shown(self) -> tuple[NDArray[np.float32], NDArray[np.float32], tuple[float, float, float]]: ...

# --- numbers ---

def parse_rows(
    data: bytes, start: int, columns: int, limit: int
) -> tuple[NDArray[np.float64], int, tuple[str, int, int, int, int] | None]:
    """Rows of numbers from text, one row a line, each value the nearest float64.

    Args:
        data: the whole text.
        start: byte at which the rows begin.
        columns: numbers in a row.
        limit: the most rows to read; memory is bounded by the text whatever this says.

    Returns:
        The rows, (F, columns); the byte after the last whole row; what ended the reading early, if anything:
        "not a number", "overflow", "row too short", "row too long" or "cut" (the text ends inside the row),
        its row and value from 0, the bytes from and to which the token reaches.
    """

def count_rows(data: bytes, start: int) -> int:
    """Number of lines from byte ``start`` on that hold more than blanks and padding."""

def format_rows(rows: NDArray[np.float64]) -> bytes:
    """Text of (F, C) C-contiguous rows, one line each: the shortest decimals that read back bit-identical.

    Raises:
        ValueError: a value is not finite; its row and column are named from 0.
    """

def parse_frames(
    data: bytes, start: int, names: Sequence[bytes], counts: Sequence[int]
) -> tuple[
    NDArray[np.float64],
    int,
    list[int],
    tuple[int, int, int],
    tuple[int, int, int],
    int,
    tuple[str, int, int | None, int, int, int] | None,
]:
    """Frames of an AMC file: a line with a number, then a line a bone, its name and its values.

    Args:
        data: the whole text.
        start: byte at which the first frame begins.
        names: of the bones, all different.
        counts: how many values each has; these are the columns, in this order.

    Returns:
        The rows, (F, columns), a bone that a frame leaves out at its values before; the first frame's number;
        the bones as the first frame lists them; how many frames' numbers do not follow the one before, and
        the first frame and its byte; the same for frames that leave bones out; the first bone left out;
        what ended the reading early, if anything: "not a number", "overflow", "row too short",
        "row too long", "cut", "unknown bone", "bone twice", "no number" or "too sparse", its frame, bone and
        value from 0, the bytes from and to which the token reaches.
    """

def format_frames(
    rows: NDArray[np.float64], names: Sequence[bytes], counts: Sequence[int], first: int
) -> bytes:
    """The lines of (F, C) C-contiguous rows as frames numbered from ``first`` on; see :func:`parse_frames`.

    Raises:
        ValueError: a value is not finite; its row and column are named from 0.
    """

# --- rotation ---

_Floats = NDArray[np.float32] | NDArray[np.float64]

def euler_to_quaternions(
    rows: NDArray[np.float64], columns: NDArray[np.int32], axes: NDArray[np.uint8], out: _Floats
) -> None:
    """Local rotations of all slots.

    Args:
        rows: (F, C) in degrees, C-contiguous.
        columns: (S, 3) column of each angle; -1: angle 0.
        axes: (S, 3) axis of each angle in composing order (0: x, 1: y, 2: z): R = R_0 R_1 R_2.
        out: (F, S, 4) xyzw, unit; written. Their sign follows no rule: q and -q are one rotation.

    Raises:
        ValueError: when shapes do not fit, or a column or axis does not exist.
    """

def turned_euler_to_quaternions(
    rows: NDArray[np.float64],
    columns: NDArray[np.int32],
    axes: NDArray[np.uint8],
    frames: NDArray[np.float64],
    out: NDArray[np.float64],
) -> None:
    """:func:`euler_to_quaternions` about axes of each slot's own: C A C^-1, with C one of ``frames`` (S, 4).

    Raises:
        ValueError: when shapes do not fit, or a column or axis does not exist.
    """

def turn_slots(
    rotations: NDArray[np.float64],
    slots: NDArray[np.int32],
    by: NDArray[np.int32],
    inverse: bool,
    threads: int = 1,
) -> None:
    """Turns slots of (F, S, 4) ``rotations`` by others, in place and one after the other.

    Args:
        rotations: C-contiguous; written.
        slots: (P,) those to turn.
        by: (P,) for each of them the one that it is turned by: ``R_slot <- R_by R_slot``.
        inverse: by the inverse of ``R_by``.
        threads: 0 means all cores; the bits are the same for every number.

    Raises:
        ValueError: when a slot does not exist.
    """

def quaternions_to_euler(quaternions: NDArray[np.float64], axes: NDArray[np.uint8]) -> NDArray[np.float64]:
    """Angles in degrees, (F, S, 3), of quaternions (F, S, 4) of any length about ``axes`` (S, 3).

    Each frame takes, of all angles that name its rotation, those nearest to the frame before; the first
    frame's middle angle is between -90 and 90 (0 and 180 where first and last axis are equal).

    Raises:
        ValueError: when shapes do not fit, or two neighbouring axes are the same.
    """

def slerp_frames(quaternions: _Floats, times: NDArray[np.float64]) -> Any:
    """Rotations (G, S, 4) at ``times`` (G,), in frames, between those of (F, S, 4), the short way round.

    Times beyond the ends hold the ends; whole times give the frames themselves; signs never jump.

    Raises:
        ValueError: when there are times but no frames.
    """

# --- kinematics ---

class Topology:
    """Parents and rotation slots of a skeleton, checked once.

    Args:
        parents: (J,) -1: a root.
        slots: (J,) the slot that turns the bone ending in each joint; -1: it has its parent's world rotation.
        slot_count: S.

    Raises:
        ValueError: an index out of range, a cycle, or a slot shared by bones of different parents.
    """

    def __init__(self, parents: NDArray[np.int32], slots: NDArray[np.int32], slot_count: int) -> None: ...
    @property
    def parents(self) -> NDArray[np.int32]: ...
    @property
    def slots(self) -> NDArray[np.int32]: ...
    @property
    def slot_parents(self) -> NDArray[np.int32]:
        """(S,) the slot after which each is applied; -1: the world."""

    @property
    def world_slots(self) -> NDArray[np.int32]:
        """(J,) the slot whose world rotation is the bone's; -1: the identity."""

    @property
    def slot_count(self) -> int: ...
    @property
    def joint_count(self) -> int: ...

def forward_kinematics(
    topology: Topology,
    rotations: _Floats,
    translated: NDArray[np.int32],
    translations: _Floats,
    offsets: _Floats,
    joints: NDArray[np.int32] | None = None,
    rotation_slots: NDArray[np.int32] | None = None,
    positions_out: _Floats | None = None,
    rotations_out: _Floats | None = None,
    threads: int = 1,
    *,
    normalize: bool = False,
) -> None:
    """World positions and rotations from local quaternions, float32 or float64 throughout.

    Args:
        topology: J joints, S slots.
        rotations: (F, S, 4) xyzw, C-contiguous; unit to rounding unless ``normalize``.
        translated: (T,) joints that ``translations`` is of.
        translations: (F, T, 3) a root's place in the world, another joint's vector in its slot's frame.
        offsets: (J, 3) the same for joints that are not translated.
        joints: (K,) whose positions are asked for; all where left out.
        rotation_slots: (M,) whose world rotations are asked for, -1: the identity; all where left out.
        positions_out: (F, K, 3), written; not computed where left out.
        rotations_out: (F, M, 4), written; not computed where left out.
        threads: 0 means all cores; the bits are the same for every number.
        normalize: divide each rotation by its length; one of zeros gives NaN.

    Raises:
        ValueError: shapes do not fit, an index does not exist, or a slot that turns no bone is asked for.
        TypeError: when arrays are of different float types.
    """

def forward_kinematics_euler(
    topology: Topology,
    rows: NDArray[np.float64],
    rotation_columns: NDArray[np.int32],
    rotation_axes: NDArray[np.uint8],
    translated: NDArray[np.int32],
    translation_columns: NDArray[np.int32],
    adds_offset: bool,
    offsets: _Floats,
    joints: NDArray[np.int32] | None = None,
    rotation_slots: NDArray[np.int32] | None = None,
    positions_out: _Floats | None = None,
    rotations_out: _Floats | None = None,
    threads: int = 1,
) -> None:
    """As :func:`forward_kinematics`, from rows (F, C) as files hold them; the outputs' type decides.

    Args:
        rotation_columns: (S, 3) as in :func:`euler_to_quaternions`.
        rotation_axes: (S, 3) as in :func:`euler_to_quaternions`.
        translation_columns: (T, 3) columns of x, y, z of each translated joint; -1: the offset's component.
        adds_offset: whether these columns are added to the offset (else they replace it).
    """

# --- forest ---

class Forest:
    """A skeleton in one of its configurations: which of its bones are cut, and each tree's root.

    Args:
        home: the skeleton before any root was moved.
        parents: (J,) in this configuration; as at home where left out.

    Raises:
        ValueError: a joint hangs on one that it has no bone with, or the parents form no trees.
    """

    def __init__(self, home: Topology, parents: NDArray[np.int32] | None = None) -> None: ...
    def shift_root(self, joint: int, names: Sequence[str]) -> Forest:
        """The forest in which ``joint`` is the root of its tree; ``names`` are for errors (ValueError)."""

    def split(self, joint: int, names: Sequence[str]) -> Forest:
        """The forest in which ``joint`` is a root too."""

    def join(self, root: int, names: Sequence[str]) -> Forest:
        """The forest in which the tree of ``root`` hangs on the joint that its soft link names."""

    def with_roots(self, roots: list[int], names: Sequence[str]) -> Forest:
        """The forest with just these roots."""

    def root_of(self, joint: int) -> int:
        """The root of a joint's tree."""

    def top_of(self, joint: int) -> int:
        """The joint of a joint's tree that is nearest to home."""

    @property
    def topology(self) -> Topology: ...
    @property
    def bones(self) -> NDArray[np.int32]:
        """(J,) the joint in which the bone that each joint's slot turns ends at home."""

    @property
    def links(self) -> NDArray[np.int32]:
        """(J,) for a joint that is cut off from its parent at home: that parent; -1 elsewhere."""

def configure(
    before: Forest,
    after: Forest,
    offsets: NDArray[np.float64],
    translated: NDArray[np.int32],
    frames: tuple[NDArray[np.float64], NDArray[np.float64]]
    | tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.uint8], NDArray[np.int32], bool],
    threads: int = 1,
    slots: NDArray[np.int32] | None = None,
    joints: NDArray[np.int32] | None = None,
    /,
) -> tuple[NDArray[np.float64], NDArray[np.int32], NDArray[np.float64]]:
    """A motion in another configuration of its skeleton.

    Args:
        before: the configuration that the frames are in.
        after: the one wanted; of the same skeleton at home.
        offsets: (J, 3) in ``before``.
        translated: (T,) in ``before``.
        frames: rotations (F, S, 4) and translations (F, T, 3); or rows (F, C) and what their columns are, as
            :func:`forward_kinematics_euler` takes them.
        threads: 0 means all cores; the bits are the same for every number.
        slots: (P,) those of ``after`` whose rotations are wanted; None: all.
        joints: those whose translations are wanted, as far as they are translated; None: all.

    Returns:
        Rotations (F, P, 4); the joints translated (U,): roots, moving bones, and those that were cut;
        translations (F, U, 3).

    Raises:
        ValueError: shapes do not fit, or the two are of different skeletons.
    """

# --- trial ---

def run_trials(
    database: Database,
    profiles: Sequence[tuple[Sequence[tuple[float, float, float, float]], float]],
    tracking: str,
    search_every: float,
    exclude_within: int,
    transition_penalty: float,
    tags: int,
    threads: int,
    progress: Callable[[int, int], object] | None = None,
    weights: list[float] | None = None,
) -> dict[str, NDArray[Any]]:
    """Trials along reference paths; Ctrl-C ends them.

    Args:
        profiles: one a trial: its ``(duration s, speed m/s, turn rate rad/s, drift rad)`` and the second
            from which it counts.
        tracking: "time" or "velocity".
        progress: called now and then with the number of trials done and of all; what it raises ends the run.

    Returns:
        Columns ``lengths`` and ``recorded_from`` (trials,), and (trials, steps): ``x z heading ref_x ref_z
        ref_heading ref_speed ref_turn_rate ref_drift cost_pose cost_trajectory discontinuity row status``;
        after the end of a trial NaN, row -1, status 255.

    Raises:
        ValueError: when a profile or setting is out of bounds, or no candidate carries the tags.
    """

# --- playback ---

def trial_positions(
    database: Database,
    rows: NDArray[np.int64],
    placements: NDArray[np.float64],
    half_life: float,
    joints: Sequence[int] | None = None,
) -> NDArray[np.float32]:
    """World positions (T, K, 3) of what a trial shows, metres, every jump inertialised.

    Args:
        rows: (T,) database row of each step; a jump is where one is not the next of its clip.
        placements: (T, 3) x, z and heading of the root at each step.
        half_life: of the offsets, seconds.
        joints: the K joints asked for; all where left out.

    Raises:
        ValueError: when lengths do not fit, or a row or joint is not there.
    """

# --- skinning ---

def bind_skin(
    vertices: NDArray[np.float64],
    faces: NDArray[np.int32],
    heads: NDArray[np.float64],
    tails: NDArray[np.float64],
    joints: NDArray[np.int32],
    open: NDArray[np.bool_],
    threads: int = 1,
) -> tuple[NDArray[np.int32], NDArray[np.float32], NDArray[np.uint32], int, int]:
    """Joints and weights (V, 4), strongest first, of (V, 3) vertices with 3 T faces that follow the bones
    from heads to tails (B, 3), each turned by its joint (B,) and open at head, tail (B, 2) where no other
    meets it; the vertices in no box; the edges that were torn, and those that still are.

    Raises:
        ValueError: when lengths do not fit, a place is not finite, or a face names a vertex that is not
            there.
    """

class Skin:
    """A mesh at rest and the joints that its vertices follow: (V, 3), (V, K), (V, K), (V, 3), C-contiguous.

    Raises:
        ValueError: when shapes do not fit, a joint is not there, or a weight is no weight.
    """

    def __init__(
        self,
        vertices: NDArray[np.float32],
        joints: NDArray[np.int32],
        weights: NDArray[np.float32],
        joint_count: int,
        normals: NDArray[np.float32] | None = None,
    ) -> None: ...
    @property
    def vertex_count(self) -> int: ...
    @property
    def joint_count(self) -> int: ...
    def blend(
        self,
        transforms: NDArray[np.float64],
        method: str,
        out: NDArray[np.float32],
        normals_out: NDArray[np.float32] | None = None,
        centers: NDArray[np.float32] | None = None,
        threads: int = 1,
    ) -> None:
        """Positions, and normals, (F, V, 3), under transforms (F, 16 B), "linear", "pivot", "running" or
        "centers"; the last takes centres (1, V, 3).
        """

    def centers(self, faces: NDArray[np.int32], threads: int) -> NDArray[np.float32]:
        """Centres of rotation, 3 V, on the surface of ``faces``, 3 T."""
