//! Frames put in the order of a kd-tree.

use super::Kernels;
use super::Work;
use super::axes::BLOCKS_AT_ONCE;
use super::kernel::Kernel;
use super::layout::W;
use super::turned::Turned;
use crate::parallel::{for_each_chunk, join, thread_count};

/// A frame and, above it, one of its coordinates in a form that compares as the coordinate does.
type Key = u64;

/// Rows looked at to choose the axis of a cut; more do not make better cuts.
const SAMPLE: usize = 64;

/// Keys that a thread makes at a time.
const KEYS_A_PART: usize = 1 << 14;

/// Puts frames so that every run of `W`, `W^2`, `W^3`, ... lies close together.
pub(super) fn arrange(turned: &Turned, frames: &mut [u32], kernels: Kernels, threads: usize) {
    let mut keys: Vec<Key> = frames.iter().copied().map(Key::from).collect();
    let mut run = W;
    while run < keys.len() {
        run = run.saturating_mul(W);
    }
    let cuts = Cuts { turned, kernels };
    let threads = thread_count(threads, keys.len().div_ceil(KEYS_A_PART));
    cuts.arrange(&mut keys, run, threads);
    frames.iter_mut().zip(keys).for_each(|(frame, key)| *frame = frame_of(key));
}

/// Cuts frames with these coordinates.
#[derive(Clone, Copy)]
struct Cuts<'a> {
    turned: &'a Turned,
    kernels: Kernels,
}

impl Cuts<'_> {
    /// Cuts `keys` into runs of `run`, halving them across their widest axis, then each run into smaller ones.
    fn arrange(self, keys: &mut [Key], run: usize, threads: usize) {
        if keys.len() <= W {
            return;
        }
        if keys.len() <= run {
            return self.arrange(keys, run / W, threads);
        }
        let middle = keys.len().div_ceil(run) / 2 * run;
        let widest = self.kernels.run(Widest { turned: self.turned, keys });
        for_each_chunk(keys, KEYS_A_PART, threads, |_, keys| {
            for key in keys {
                let frame = frame_of(*key);
                *key = Key::from(ascending(self.turned.row(frame)[widest])) << 32 | Key::from(frame);
            }
        });
        keys.select_nth_unstable(middle);
        let (left, right) = keys.split_at_mut(middle);
        join(
            threads,
            |threads| self.arrange(left, run, threads),
            |threads| self.arrange(right, run, threads),
        );
    }
}

/// Finds the axis whose halves are furthest apart: that of the largest mean distance from the mean. Squared distances
/// would hear a few outliers more than all others.
struct Widest<'a> {
    turned: &'a Turned,
    keys: &'a [Key],
}

impl Work for Widest<'_> {
    type Done = usize;

    #[inline(always)]
    fn run<K: Kernel<W>>(self, _kernel: K) -> usize {
        let dims = self.turned.dims;
        let (mut widest, mut furthest) = (0, f32::NEG_INFINITY);
        let mut block = 0;
        while block * W < dims {
            // Several blocks at once, for the sums of one would wait for themselves.
            let distances = self.distances(block);
            let axes = block * W..dims.min((block + BLOCKS_AT_ONCE) * W);
            for (axis, &distance) in axes.zip(distances.as_flattened()) {
                if distance >= furthest {
                    (widest, furthest) = (axis, distance);
                }
            }
            block += BLOCKS_AT_ONCE;
        }
        widest
    }
}

impl Widest<'_> {
    /// The sums of distances from the mean in blocks of axes from the `first` on; behind the last, anything.
    #[inline(always)]
    fn distances(&self, first: usize) -> [[f32; W]; BLOCKS_AT_ONCE] {
        let step = self.keys.len().div_ceil(SAMPLE);
        let last = self.turned.dims.div_ceil(W) - 1;
        let sample = self.keys.iter().step_by(step).map(|&key| {
            let blocks = self.turned.blocks(frame_of(key));
            std::array::from_fn::<_, BLOCKS_AT_ONCE, _>(|block| blocks[(first + block).min(last)])
        });
        let share = 1.0 / sample.len() as f32;
        let mut means = [[0.0; W]; BLOCKS_AT_ONCE];
        for row in sample.clone() {
            for (mean, x) in means.iter_mut().zip(row) {
                *mean = std::array::from_fn(|lane| mean[lane] + x[lane] * share);
            }
        }
        let mut distances = [[0.0; W]; BLOCKS_AT_ONCE];
        for row in sample {
            for ((sum, mean), x) in distances.iter_mut().zip(means).zip(row) {
                *sum = std::array::from_fn(|lane| sum[lane] + (x[lane] - mean[lane]).abs());
            }
        }
        distances
    }
}

fn frame_of(key: Key) -> u32 {
    key as u32
}

/// Bits that compare as whole numbers as finite `x` do as numbers.
fn ascending(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 0 { bits | 1 << 31 } else { !bits }
}
