//! As many vertices at once as a register holds; the same numbers as [`super::scalar`].
//!
//! A window of vertices meets all frames of the piece while it is near. Its answers come run by run and are put down
//! in the caller's order, from where they go out one after the other.

use super::arrangement::{Arrangement, Follows, Run, WIDEST, WINDOW};
use super::blend::{Frame, Hemisphere, Method, Work};
use super::bones::Bones;
use super::formulas::{add, move_by, subtract, transform, transform_normal, turn_by};
use super::skin::{Points, Skin, Wide};
use super::sums::{At, Each, Influences, MANY, Rows, Same, dual_quaternion, matrix};
use crate::lanes::{Kernel, Lanes, cache};

/// The vertices of `work`, in each of some frames.
pub(super) struct Windows<'a, 'b> {
    pub(super) work: &'a Work<'b>,
    pub(super) frames: &'a mut [Frame<'b>],
}

impl Kernel<f32> for Windows<'_, '_> {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(self) {
        match self.work.method {
            Method::Linear => each_window::<L, Linear>(self),
            Method::DualQuaternion(Hemisphere::Pivot) => each_window::<L, Pivot>(self),
            Method::DualQuaternion(Hemisphere::Running) => each_window::<L, Running>(self),
            Method::Centers(_) => each_window::<L, Centers>(self),
        }
    }
}

/// Vertices whose answers are streamed at a time.
const PACK: usize = 256;

/// The most usual number of influences.
const FEW: usize = 4;

/// What a thread computes in before it goes out. All on the heap, for of what lies on the stack the compiler knows
/// that more can be read than is asked for: it then reads across numbers that were written apart, which the processor
/// must wait for.
struct Room {
    answers: Answers,
    /// Some of the answers, three numbers each.
    packed: Vec<f32>,
    same: Same,
    /// The blended numbers of each vertex of a register.
    sums: Box<[[f32; 16]; WIDEST]>,
    /// The weights of a block, with their signs.
    signed: Vec<Wide>,
}

/// Those of a window, three numbers and one to spare each.
struct Answers {
    positions: Vec<[f32; 4]>,
    normals: Vec<[f32; 4]>,
}

impl Room {
    fn new(skin: &Skin, normals: bool) -> Self {
        let most = skin.arrangement.runs.iter().map(|run| run.influence_count).max().unwrap_or(0);
        Self {
            answers: Answers {
                positions: vec![[0.0; 4]; WINDOW],
                normals: vec![[0.0; 4]; if normals { WINDOW } else { 0 }],
            },
            packed: vec![0.0; 3 * PACK],
            same: Same::default(),
            sums: Box::new([[0.0; 16]; WIDEST]),
            signed: vec![Wide([0.0; WIDEST]); most],
        }
    }
}

#[inline(always)]
fn each_window<L: Lanes<Real = f32>, M: Blending>(windows: Windows<'_, '_>) {
    let Windows { work, frames } = windows;
    let mut room = Room::new(work.skin, frames.iter().any(|frame| frame.normals.is_some()));
    for (start, runs) in work.windows() {
        let end = work.skin.vertex_count.min(start + WINDOW);
        let place = 3 * (start - work.first_vertex())..3 * (end - work.first_vertex());
        for Frame { bones, positions, normals } in &mut *frames {
            match normals {
                None => blend_runs::<L, M, false>(work, bones, start, runs, &mut room),
                Some(normals) => {
                    blend_runs::<L, M, true>(work, bones, start, runs, &mut room);
                    put(&room.answers.normals, &mut room.packed, &mut normals[place.clone()], work.is_large);
                }
            }
            put(&room.answers.positions, &mut room.packed, &mut positions[place.clone()], work.is_large);
        }
    }
    if work.is_large {
        cache::settle();
    }
}

/// Sends the first answers out, as many as there is room for.
fn put(answers: &[[f32; 4]], packed: &mut [f32], out: &mut [f32], is_large: bool) {
    if !is_large {
        return pack(answers, out);
    }
    for (answers, out) in answers.chunks(PACK).zip(out.chunks_mut(3 * PACK)) {
        let packed = &mut packed[..out.len()];
        pack(answers, packed);
        cache::stream(packed, out);
    }
}

/// The first three numbers of each answer, one after the other.
fn pack(answers: &[[f32; 4]], out: &mut [f32]) {
    let (fours, twelves) = (answers.as_chunks::<4>().0, out.as_chunks_mut::<12>());
    for ([a, b, c, d], out) in fours.iter().zip(twelves.0) {
        *out = [a[0], a[1], a[2], b[0], b[1], b[2], c[0], c[1], c[2], d[0], d[1], d[2]];
    }
    let done = out.len() / 12 * 4;
    for (answer, out) in answers[done..].iter().zip(out[3 * done..].as_chunks_mut::<3>().0) {
        *out = [answer[0], answer[1], answer[2]];
    }
}

#[inline(always)]
fn blend_runs<L: Lanes<Real = f32>, M: Blending, const NORMALS: bool>(
    work: &Work<'_>,
    bones: &Bones,
    start: usize,
    runs: &[Run],
    room: &mut Room,
) {
    let Room { answers, same, sums, signed, .. } = room;
    let Arrangement { shared, own, .. } = &work.skin.arrangement;
    for run in runs {
        let part = Part { work, bones, run, start };
        let count = run.influence_count;
        match run.follows {
            Follows::Same(start) => {
                let dual_joints = if M::IS_PAIRED { &shared.paired } else { &shared.joints };
                same.pick(bones, &shared.joints[start..][..count], &dual_joints[start..][..count]);
                part.blend::<L, M, _, NORMALS>(&mut *same, signed, answers);
            }
            Follows::Each(start) => {
                let joints = &own.joints[start..][..count * run.block_count()];
                let dual_joints = if M::IS_PAIRED { &own.paired } else { &own.joints };
                let dual_joints = &dual_joints[start..][..count * run.block_count()];
                if count == FEW {
                    let influences = Each::<FEW> { bones, joints, dual_joints, sums };
                    part.blend::<L, M, _, NORMALS>(influences, signed, answers);
                } else {
                    let influences = Each::<MANY> { bones, joints, dual_joints, sums };
                    part.blend::<L, M, _, NORMALS>(influences, signed, answers);
                }
            }
        }
    }
}

/// A run in a frame.
#[derive(Clone, Copy)]
struct Part<'a> {
    work: &'a Work<'a>,
    bones: &'a Bones,
    run: &'a Run,
    /// The first vertex of the window.
    start: usize,
}

impl Part<'_> {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, M: Blending, I: Influences<L>, const NORMALS: bool>(
        self,
        mut influences: I,
        signed: &mut [Wide],
        answers: &mut Answers,
    ) {
        let Self { work, bones, run, .. } = self;
        let (skin, count) = (work.skin, run.influence_count);
        let is_stretched = !bones.residual.is_empty();
        for block in 0..run.block_count() {
            let place = run.block + block;
            let weights = &skin.weights[run.weights + block * count..][..count];
            let signed = M::signed(self, block, weights, signed);
            let places = &skin.arrangement.places[place];
            // Lanes behind the last vertex repeat it.
            let end = WIDEST.min(run.length - WIDEST * block);
            for lane in (0..end).step_by(L::WIDTH) {
                let at = At { block, weights, signed, lane };
                let v = points(&skin.positions[place], lane);
                let n = if NORMALS { points(&skin.normals[place], lane) } else { v };
                let center = if M::ABOUT_CENTERS { points(&work.centers[place], lane) } else { v };
                let rest = Rest { v, n, center, is_stretched };
                let (v, n) = M::blend::<L, I, NORMALS>(&mut influences, at, rest);
                L::scatter_columns([v[0], v[1], v[2], v[2]], &mut answers.positions, &places[lane..]);
                if NORMALS {
                    L::scatter_columns([n[0], n[1], n[2], n[2]], &mut answers.normals, &places[lane..]);
                }
            }
        }
    }
}

#[inline(always)]
fn points<L: Lanes<Real = f32>>([x, y, z]: &Points, lane: usize) -> [L; 3] {
    [L::load(&x.0[lane..]), L::load(&y.0[lane..]), L::load(&z.0[lane..])]
}

/// What stays of the vertices of a register.
#[derive(Clone, Copy)]
struct Rest<L> {
    v: [L; 3],
    n: [L; 3],
    center: [L; 3],
    /// Whether any joint scales or shears in this frame.
    is_stretched: bool,
}

/// A method.
trait Blending {
    /// Whether there are centres of rotation.
    const ABOUT_CENTERS: bool = false;

    /// Whether there is a dual quaternion for each pair of a pivot and a joint.
    const IS_PAIRED: bool = true;

    /// The weights of a block, with the signs that the rows take.
    #[inline(always)]
    fn signed<'a>(
        _part: Part<'_>,
        _block: usize,
        weights: &'a [Wide],
        _signed: &'a mut [Wide],
    ) -> &'a [Wide] {
        weights
    }

    /// The vertices and their normals, blended.
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]);
}

struct Linear;
struct Pivot;
struct Running;
struct Centers;

impl Blending for Linear {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let m = matrix(influences, Rows::Linear, at);
        (transform(&m, rest.v), if NORMALS { transform_normal(&m, rest.n) } else { rest.n })
    }
}

impl Blending for Pivot {
    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let (v, n) = stretched::<L, I, NORMALS>(influences, at, rest.v, rest);
        let q = dual_quaternion(influences, at);
        (move_by(q, v), if NORMALS { turn_by(q[0], n) } else { n })
    }
}

impl Blending for Running {
    const IS_PAIRED: bool = false;

    #[inline(always)]
    fn signed<'a>(part: Part<'_>, block: usize, weights: &'a [Wide], signed: &'a mut [Wide]) -> &'a [Wide] {
        let Part { work, run, bones, start } = part;
        let Arrangement { shared, own, .. } = &work.skin.arrangement;
        let first = work.skin.lane(start, run, WIDEST * block).signing(&bones.dual);
        match run.follows {
            Follows::Same(at) => {
                let joints = &shared.joints[at..][..weights.len()];
                first.sign_block(|k, _| joints[k], signed);
            }
            Follows::Each(at) => {
                let joints = &own.joints[at + block * weights.len()..][..weights.len()];
                first.sign_block(|k, lane| joints[k][lane], signed);
            }
        }
        &signed[..weights.len()]
    }

    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let (v, n) = stretched::<L, I, NORMALS>(influences, at, rest.v, rest);
        let q = dual_quaternion(influences, at);
        (move_by(q, v), if NORMALS { turn_by(q[0], n) } else { n })
    }
}

impl Blending for Centers {
    const ABOUT_CENTERS: bool = true;

    #[inline(always)]
    fn blend<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
        influences: &mut I,
        at: At<'_>,
        rest: Rest<L>,
    ) -> ([L; 3], [L; 3]) {
        let arm = subtract(rest.v, rest.center);
        let (arm, n) = stretched::<L, I, NORMALS>(influences, at, arm, rest);
        let m = matrix(influences, Rows::Linear, at);
        let q = dual_quaternion(influences, at)[0];
        (add(turn_by(q, arm), transform(&m, rest.center)), if NORMALS { turn_by(q, n) } else { n })
    }
}

/// `v` and the normal after scale and shear, where there are any.
#[inline(always)]
fn stretched<L: Lanes<Real = f32>, I: Influences<L>, const NORMALS: bool>(
    influences: &mut I,
    at: At<'_>,
    v: [L; 3],
    rest: Rest<L>,
) -> ([L; 3], [L; 3]) {
    if !rest.is_stretched {
        return (v, rest.n);
    }
    let m = matrix(influences, Rows::Residual, at);
    (transform(&m, v), if NORMALS { transform_normal(&m, rest.n) } else { rest.n })
}
