//! As many vertices at once as a register holds; the same numbers as [`super::scalar`].
//!
//! The joints' rows of a vertex are summed along the row, then the sums of a block of vertices are turned so that a
//! register holds one number of each vertex. A tile of vertices meets all frames of the piece while it is near, and
//! its answer goes out in one run.

use std::marker::PhantomData;
use std::ops::Range;

use super::blend::{Frame, Hemisphere, Method, Work};
use super::bones::{Bones, Row};
use super::formulas::{Matrix, add, move_by, subtract, transform, transform_normal, turn_by};
use super::skin::{FEW, Skin};
use crate::lanes::{Kernel, Lanes, cache};
use crate::rotation::dot;

/// Vertices whose answers are gathered before they go out: a whole number of blocks of every instruction set.
const TILE: usize = 256;

/// The most lanes that a register has.
const WIDEST: usize = 16;

/// The vertices of `work`, in each of some frames.
pub(super) struct Tiles<'a, 'b> {
    pub(super) work: &'a Work<'b>,
    pub(super) frames: &'a mut [Frame<'b>],
}

impl Kernel<f32> for Tiles<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(self) {
        let few = self.work.skin.influence_count == FEW;
        match (self.work.method, few) {
            (Method::Linear, true) => each_tile::<L, Linear, FEW>(self),
            (Method::Linear, false) => each_tile::<L, Linear, MANY>(self),
            (Method::DualQuaternion(Hemisphere::Pivot), true) => {
                each_tile::<L, DualQuaternion<Pivot>, FEW>(self)
            }
            (Method::DualQuaternion(Hemisphere::Pivot), false) => {
                each_tile::<L, DualQuaternion<Pivot>, MANY>(self)
            }
            (Method::DualQuaternion(Hemisphere::Running), true) => {
                each_tile::<L, DualQuaternion<Running>, FEW>(self)
            }
            (Method::DualQuaternion(Hemisphere::Running), false) => {
                each_tile::<L, DualQuaternion<Running>, MANY>(self)
            }
            (Method::Centers(_), true) => each_tile::<L, Centers, FEW>(self),
            (Method::Centers(_), false) => each_tile::<L, Centers, MANY>(self),
        }
    }
}

/// Stands for a number of influences that is known at run time only; fewer than [`FEW`] there never are.
const MANY: usize = 1;

/// What a thread computes in before it goes out.
struct Room<'a> {
    /// The blended numbers of each vertex of a block.
    sums: &'a mut [[f32; 16]],
    /// Four numbers of each vertex of a block.
    fours: [f32; 4 * WIDEST],
    /// A tile, and one number more, so that four can be written for any vertex.
    positions: [f32; 3 * TILE + 1],
    normals: [f32; 3 * TILE + 1],
}

#[inline(always)]
fn each_tile<L: Lanes<Real = f32>, M: Blending, const K: usize>(tiles: Tiles<'_, '_>) {
    let Tiles { work, frames } = tiles;
    // On the heap, for of what lies on the stack the compiler knows that more can be read than is asked for: it then
    // reads across numbers that were written apart, which the processor must wait for.
    let mut sums = vec![0.0_f32; 16 * (WIDEST + 1)];
    let line = sums.as_ptr().align_offset(cache::LINE);
    let sums = sums[line..].as_chunks_mut().0;
    let mut room =
        Room { sums, fours: [0.0; 4 * WIDEST], positions: [0.0; 3 * TILE + 1], normals: [0.0; 3 * TILE + 1] };
    for start in work.vertices.clone().step_by(TILE) {
        let tile = start..work.vertices.end.min(start + TILE);
        let place = 3 * (start - work.vertices.start)..3 * (tile.end - work.vertices.start);
        for frame in &mut *frames {
            let bones = &frame.bones;
            match (&mut frame.normals, bones.residual.is_empty()) {
                (None, true) => blend_tile::<L, M, K, false, false>(work, bones, &tile, &mut room),
                (None, false) => blend_tile::<L, M, K, false, true>(work, bones, &tile, &mut room),
                (Some(_), true) => blend_tile::<L, M, K, true, false>(work, bones, &tile, &mut room),
                (Some(_), false) => blend_tile::<L, M, K, true, true>(work, bones, &tile, &mut room),
            }
            put(&room.positions, &mut frame.positions[place.clone()], work.is_large);
            if let Some(out) = &mut frame.normals {
                put(&room.normals, &mut out[place.clone()], work.is_large);
            }
        }
    }
    if work.is_large {
        cache::settle();
    }
}

fn put(answer: &[f32], out: &mut [f32], is_large: bool) {
    let answer = &answer[..out.len()];
    if is_large { cache::stream(answer, out) } else { out.copy_from_slice(answer) }
}

#[inline(always)]
fn blend_tile<
    L: Lanes<Real = f32>,
    M: Blending,
    const K: usize,
    const NORMALS: bool,
    const STRETCHED: bool,
>(
    work: &Work<'_>,
    bones: &Bones,
    tile: &Range<usize>,
    room: &mut Room<'_>,
) {
    // The arrays are padded: what lies behind the last vertex is computed and left.
    for vertex in tile.clone().step_by(L::WIDTH) {
        let block = Block { work, bones, vertex, sums: &mut *room.sums };
        let v = points::<L>(&work.skin.positions, vertex);
        let n = if NORMALS { points::<L>(&work.skin.normals, vertex) } else { v };
        let (v, n) = M::blend::<L, K, NORMALS, STRETCHED>(block, v, n);
        let at = 3 * (vertex - tile.start);
        store(v, &mut room.fours, &mut room.positions[at..]);
        if NORMALS {
            store(n, &mut room.fours, &mut room.normals[at..]);
        }
    }
}

/// The vertices from `vertex` on that a register holds.
struct Block<'a, 'b> {
    work: &'a Work<'b>,
    bones: &'a Bones,
    vertex: usize,
    sums: &'a mut [[f32; 16]],
}

/// A method, block by block.
trait Blending {
    /// The vertices `v` and their normals `n`, blended.
    fn blend<L: Lanes<Real = f32>, const K: usize, const NORMALS: bool, const STRETCHED: bool>(
        block: Block<'_, '_>,
        v: [L; 3],
        n: [L; 3],
    ) -> ([L; 3], [L; 3]);
}

struct Linear;
struct DualQuaternion<S>(PhantomData<S>);
struct Centers;

impl Blending for Linear {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, const K: usize, const NORMALS: bool, const STRETCHED: bool>(
        mut block: Block<'_, '_>,
        v: [L; 3],
        n: [L; 3],
    ) -> ([L; 3], [L; 3]) {
        let m = block.matrix::<L, K>(&block.bones.linear);
        (transform(&m, v), if NORMALS { transform_normal(&m, n) } else { n })
    }
}

impl<S: Signing> Blending for DualQuaternion<S> {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, const K: usize, const NORMALS: bool, const STRETCHED: bool>(
        mut block: Block<'_, '_>,
        v: [L; 3],
        n: [L; 3],
    ) -> ([L; 3], [L; 3]) {
        let (v, n) = block.stretched::<L, K, NORMALS, STRETCHED>(v, n);
        let q = block.dual_quaternion::<L, K, S>();
        (move_by(q, v), if NORMALS { turn_by(q[0], n) } else { n })
    }
}

impl Blending for Centers {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, const K: usize, const NORMALS: bool, const STRETCHED: bool>(
        mut block: Block<'_, '_>,
        v: [L; 3],
        n: [L; 3],
    ) -> ([L; 3], [L; 3]) {
        let center = points::<L>(block.work.centers, block.vertex);
        let (arm, n) = block.stretched::<L, K, NORMALS, STRETCHED>(subtract(v, center), n);
        let m = block.matrix::<L, K>(&block.bones.linear);
        let q = block.dual_quaternion::<L, K, Pivot>()[0];
        (add(turn_by(q, arm), transform(&m, center)), if NORMALS { turn_by(q, n) } else { n })
    }
}

impl Block<'_, '_> {
    /// The vertices after scale and shear, where there are any.
    #[inline(always)]
    fn stretched<L: Lanes<Real = f32>, const K: usize, const NORMALS: bool, const STRETCHED: bool>(
        &mut self,
        v: [L; 3],
        n: [L; 3],
    ) -> ([L; 3], [L; 3]) {
        if !STRETCHED {
            return (v, n);
        }
        let m = self.matrix::<L, K>(&self.bones.residual);
        (transform(&m, v), if NORMALS { transform_normal(&m, n) } else { n })
    }

    #[inline(always)]
    fn matrix<L: Lanes<Real = f32>, const K: usize>(&mut self, rows: &[Row]) -> Matrix<L> {
        self.sum::<L, K, Unsigned, 12>(rows);
        [self.columns(0), self.columns(4), self.columns(8)]
    }

    #[inline(always)]
    fn dual_quaternion<L: Lanes<Real = f32>, const K: usize, S: Signing>(&mut self) -> [[L; 4]; 2] {
        self.sum::<L, K, S, 8>(&self.bones.dual);
        [self.columns(0), self.columns(4)]
    }

    /// Sums the rows of each vertex, their first `NUMBERS`.
    #[inline(always)]
    fn sum<L: Lanes<Real = f32>, const K: usize, S: Signing, const NUMBERS: usize>(&mut self, rows: &[Row]) {
        let skin = self.work.skin;
        let joints = S::joints(skin);
        let sums = &mut self.sums[..L::WIDTH];
        if K == MANY {
            let count = skin.influence_count;
            for (lane, sum) in sums.iter_mut().enumerate() {
                let influences = (self.vertex + lane) * count..(self.vertex + lane + 1) * count;
                sum_many::<L, S, NUMBERS>(rows, &joints[influences.clone()], &skin.weights[influences], sum);
            }
        } else {
            let lanes = self.vertex..self.vertex + L::WIDTH;
            let joints = &joints.as_chunks::<K>().0[lanes.clone()];
            let weights = &skin.weights.as_chunks::<K>().0[lanes];
            for (lane, sum) in sums.iter_mut().enumerate() {
                sum_few::<L, K, S, NUMBERS>(rows, &joints[lane], &weights[lane], sum);
            }
        }
    }

    /// Four of the numbers of each vertex's sum.
    #[inline(always)]
    fn columns<L: Lanes<Real = f32>>(&self, at: usize) -> [L; 4] {
        L::load_columns(&self.sums.as_flattened()[at..], 16)
    }
}

/// The sum of a vertex with `K` influences.
#[inline(always)]
fn sum_few<L: Lanes<Real = f32>, const K: usize, S: Signing, const NUMBERS: usize>(
    rows: &[Row],
    joints: &[u32; K],
    weights: &[f32; K],
    sum: &mut [f32; 16],
) {
    let mut signing = S::default();
    let mut signed = [L::splat(0.0); K];
    let mut followed = [&rows[0].0; K];
    for k in 0..K {
        followed[k] = &rows[joints[k] as usize].0;
        signed[k] = L::splat(signing.signed(followed[k], weights[k]));
    }
    for at in (0..NUMBERS).step_by(L::WIDTH) {
        let mut total = L::load(&followed[0][at..]) * signed[0];
        for k in 1..K {
            total = total + L::load(&followed[k][at..]) * signed[k];
        }
        total.store(&mut sum[at..]);
    }
}

/// The sum of a vertex with any number of influences.
#[inline(always)]
fn sum_many<L: Lanes<Real = f32>, S: Signing, const NUMBERS: usize>(
    rows: &[Row],
    joints: &[u32],
    weights: &[f32],
    sum: &mut [f32; 16],
) {
    let mut signing = S::default();
    for (k, (&joint, &weight)) in joints.iter().zip(weights).enumerate() {
        let row = &rows[joint as usize].0;
        let signed = L::splat(signing.signed(row, weight));
        for at in (0..NUMBERS).step_by(L::WIDTH) {
            let share = L::load(&row[at..]) * signed;
            let total = if k == 0 { share } else { L::load(&sum[at..]) + share };
            total.store(&mut sum[at..]);
        }
    }
}

/// How a vertex's weights are signed, influence by influence.
trait Signing: Default {
    /// Which rows the influences of all vertices take.
    fn joints(skin: &Skin) -> &[u32];

    /// The weight, with the sign that the row is to have.
    #[inline(always)]
    fn signed(&mut self, _row: &[f32; 16], weight: f32) -> f32 {
        weight
    }
}

/// Not at all.
#[derive(Default)]
struct Unsigned;

/// In the rows, of which there is one for each pivot and joint.
#[derive(Default)]
struct Pivot;

/// By the sum so far of the real parts.
#[derive(Default)]
struct Running([f32; 4]);

impl Signing for Unsigned {
    #[inline(always)]
    fn joints(skin: &Skin) -> &[u32] {
        &skin.joints
    }
}

impl Signing for Pivot {
    #[inline(always)]
    fn joints(skin: &Skin) -> &[u32] {
        &skin.paired
    }
}

impl Signing for Running {
    #[inline(always)]
    fn joints(skin: &Skin) -> &[u32] {
        &skin.joints
    }

    #[inline(always)]
    fn signed(&mut self, row: &[f32; 16], weight: f32) -> f32 {
        let r = [row[0], row[1], row[2], row[3]];
        let signed = if dot(self.0, r) < 0.0 { -weight } else { weight };
        for (sum, r) in self.0.iter_mut().zip(r) {
            *sum += signed * r;
        }
        signed
    }
}

#[inline(always)]
fn points<L: Lanes<Real = f32>>(rows: &[f32], vertex: usize) -> [L; 3] {
    let [x, y, z, _] = L::load_columns(&rows[3 * vertex..], 3);
    [x, y, z]
}

/// Three numbers of each vertex, one vertex after the other; one number more is overwritten.
#[inline(always)]
fn store<L: Lanes<Real = f32>>([x, y, z]: [L; 3], fours: &mut [f32; 4 * WIDEST], out: &mut [f32]) {
    L::store_columns([x, y, z, z], fours, 4);
    let out = &mut out[..3 * L::WIDTH + 1];
    for (lane, four) in fours.as_chunks::<4>().0[..L::WIDTH].iter().enumerate() {
        out[3 * lane..3 * lane + 4].copy_from_slice(four);
    }
}
