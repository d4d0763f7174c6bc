//! As many vertices at once as a register holds; the same numbers as [`super::scalar`].
//!
//! A window of vertices meets all frames of the piece while it is near. Its answers come run by run and are put down
//! in the caller's order, from where they go out one after the other.

use super::arrangement::{Arrangement, Follows, Run, WIDEST, WINDOW};
use super::lines::{Points, Wide};
use super::method::{Hemisphere, Method};
use super::methods::{Blending, Centers, Linear, Pivot, Rest, Running};
use super::scalar;
use super::skin::Skin;
use super::sums::{At, Each, Influences, MANY, Same};
use super::work::{Frame, Window, Work};
use crate::Isa;
use crate::lanes::{Kernel, Lanes, Real, cache};

/// Works on the vertices of `work` in each frame.
pub(super) fn run<'b>(isa: Isa, work: &Work<'b>, frames: &mut [Frame<'b>]) {
    match work.method {
        Method::Linear => f32::dispatch(isa, Windows(work, frames, Linear)),
        Method::DualQuaternion(Hemisphere::Pivot) => f32::dispatch(isa, Windows(work, frames, Pivot)),
        Method::DualQuaternion(Hemisphere::Running) => f32::dispatch(isa, Windows(work, frames, Running)),
        Method::Centers(_) => f32::dispatch(isa, Windows(work, frames, Centers)),
    }
}

/// The vertices of the work in each of some frames, by a method.
struct Windows<'a, 'b, M>(&'a Work<'b>, &'a mut [Frame<'b>], M);

impl<M: Blending> Kernel<f32> for Windows<'_, '_, M> {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(self) {
        each_window::<L, M>(self.0, self.1);
    }

    fn run_plain(self) {
        scalar::run(self.0, self.1);
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
fn each_window<L: Lanes<Real = f32>, M: Blending>(work: &Work<'_>, frames: &mut [Frame<'_>]) {
    let mut room = Room::new(work.skin, frames.iter().any(|frame| frame.normals.is_some()));
    for (start, runs) in work.windows() {
        let end = work.skin.vertex_count.min(start + WINDOW);
        let place = 3 * (start - work.first_vertex())..3 * (end - work.first_vertex());
        for (k, Frame { bones, positions, normals }) in frames.iter_mut().enumerate() {
            // Later frames find near what the first has brought.
            let window = Window { work, bones, start, is_far: k == 0 };
            match normals {
                None => blend_runs::<L, M, false>(window, runs, &mut room),
                Some(normals) => {
                    blend_runs::<L, M, true>(window, runs, &mut room);
                    put::<L>(
                        &room.answers.normals,
                        &mut room.packed,
                        &mut normals[place.clone()],
                        work.is_large,
                    );
                }
            }
            put::<L>(&room.answers.positions, &mut room.packed, &mut positions[place.clone()], work.is_large);
        }
    }
    if work.is_large {
        cache::settle();
    }
}

/// Sends the first answers out, as many as there is room for.
#[inline(always)]
fn put<L: Lanes<Real = f32>>(answers: &[[f32; 4]], packed: &mut [f32], out: &mut [f32], is_large: bool) {
    if !is_large {
        return pack(answers, out);
    }
    for (answers, out) in answers.chunks(PACK).zip(out.chunks_mut(3 * PACK)) {
        let packed = &mut packed[..out.len()];
        pack(answers, packed);
        cache::stream::<L>(packed, out);
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
    window: Window<'_>,
    runs: &[Run],
    room: &mut Room,
) {
    let Room { answers, same, sums, signed, .. } = room;
    let Window { work, bones, .. } = window;
    let Arrangement { shared, own, .. } = &work.skin.arrangement;
    let (shared_dual, own_dual) = match M::IS_PAIRED {
        true => (&shared.paired, &own.paired),
        false => (&shared.joints, &own.joints),
    };
    for run in runs {
        let count = run.influence_count;
        match run.follows {
            Follows::Same(start) => {
                same.pick(bones, &shared.joints[start..][..count], &shared_dual[start..][..count]);
                blend_run::<L, M, _, NORMALS>(window, run, &mut *same, signed, answers);
            }
            Follows::Each(start) => {
                let joints = &own.joints[start..][..count * run.block_count()];
                let dual_joints = &own_dual[start..][..count * run.block_count()];
                if count == FEW {
                    let influences = Each::<FEW> { bones, joints, dual_joints, sums };
                    blend_run::<L, M, _, NORMALS>(window, run, influences, signed, answers);
                } else {
                    let influences = Each::<MANY> { bones, joints, dual_joints, sums };
                    blend_run::<L, M, _, NORMALS>(window, run, influences, signed, answers);
                }
            }
        }
    }
}

#[inline(always)]
fn blend_run<L: Lanes<Real = f32>, M: Blending, I: Influences<L>, const NORMALS: bool>(
    window: Window<'_>,
    run: &Run,
    mut influences: I,
    signed: &mut [Wide],
    answers: &mut Answers,
) {
    let Window { work, bones, is_far, .. } = window;
    let (skin, count) = (work.skin, run.influence_count);
    let is_stretched = !bones.residual.is_empty();
    for block in 0..run.block_count() {
        let place = run.block + block;
        let first = run.weights + block * count;
        if is_far {
            fetch(skin.positions.as_flattened(), 3 * place, 3);
            fetch(&skin.weights, first, count);
            if NORMALS {
                fetch(skin.normals.as_flattened(), 3 * place, 3);
            }
        }
        let weights = &skin.weights[first..][..count];
        let signed = M::signed(window, run, block, signed);
        let signed = signed.unwrap_or(weights);
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

/// Blocks that are fetched before they are needed, across the bounds of runs and windows.
const AHEAD: usize = 8;

/// Fetches what lies [`AHEAD`] blocks behind what a block holds: `count` lines of `lines` from `start` on.
#[inline(always)]
fn fetch(lines: &[Wide], start: usize, count: usize) {
    cache::prefetch(lines, start + AHEAD * count, count);
}

#[inline(always)]
fn points<L: Lanes<Real = f32>>([x, y, z]: &Points, lane: usize) -> [L; 3] {
    [L::load(&x.0[lane..]), L::load(&y.0[lane..]), L::load(&z.0[lane..])]
}
