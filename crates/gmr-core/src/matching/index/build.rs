//! A tree of rows: frames put in order, then leaves and boxes from the bottom up.

use super::super::aligned::Aligned;
use super::arrange::arrange;
use super::axes::Axes;
use super::boxes::nodes_above;
use super::codes::Codes;
use super::kernel::Kernel;
use super::layout::W;
use super::rows::Rows;
use super::tree::{Levels, Tree, View};
use super::turned::Turned;
use super::{Kernels, Work};
use crate::parallel::for_each_part;

/// Leaves that a thread makes at a time.
const LEAVES_A_PART: usize = 512;

/// How many leaves before it is filled the rows of one are sent for.
const LEAVES_AHEAD: usize = 2;

/// Frames looked at to put the dimensions in the order of their spread, and to find the axes.
const LARGE_SAMPLE: usize = 4096;

/// What becomes the leaves of a [`Tree`].
struct Leaves {
    rows: Aligned<f32>,
    frames: Vec<[u32; W]>,
    tags: Vec<[u32; W]>,
}

impl Rows<'_> {
    /// The tree of all candidates.
    pub(super) fn tree(&self, kernels: Kernels, threads: usize) -> Tree {
        let mut frames = self.frames();
        let (order, axes) = (self.widest_first(&frames), self.axes(&frames, kernels));
        let turned = Turned::of(self, &axes, kernels, threads);
        arrange(&turned, &mut frames, kernels, threads);

        let mut places = vec![0; self.dims];
        order.iter().enumerate().for_each(|(place, &dimension)| places[dimension as usize] = place as u32);
        let leaves = self.leaves(&order, &mut frames, kernels, threads);
        let levels = Levels::above(leaves.frames.len());
        let nodes =
            nodes_above(leaves.rows.as_slice(), &leaves.frames, &leaves.tags, &levels, self.dims, threads);
        let codes = Codes::of(&axes, &leaves.frames, &levels, &turned, kernels, threads);
        Tree {
            order,
            places,
            axes,
            levels,
            codes,
            rows: leaves.rows.into(),
            frames: leaves.frames.into(),
            tags: leaves.tags.into(),
            boxes: nodes.boxes.into(),
            lowest: nodes.lowest.into(),
            node_tags: nodes.tags.into(),
            #[cfg(feature = "file")]
            seals: None,
        }
    }

    /// Leaves of `frames`, `W` to each, which are put in order within them.
    fn leaves(&self, order: &[u32], frames: &mut [u32], kernels: Kernels, threads: usize) -> Leaves {
        let leaf_count = frames.len().div_ceil(W);
        let mut leaves = Leaves {
            rows: Aligned::zeros(leaf_count * self.dims * W),
            frames: vec![[u32::MAX; W]; leaf_count],
            tags: vec![[0; W]; leaf_count],
        };
        let parts = frames
            .chunks_mut(LEAVES_A_PART * W)
            .zip(leaves.rows.as_mut_slice().chunks_mut(LEAVES_A_PART * self.dims * W))
            .zip(leaves.frames.chunks_mut(LEAVES_A_PART).zip(leaves.tags.chunks_mut(LEAVES_A_PART)));
        for_each_part(parts, threads, |((frames, rows), (held, tags))| {
            frames.chunks_mut(W).for_each(<[u32]>::sort_unstable);
            held.as_flattened_mut()[..frames.len()].copy_from_slice(frames);
            if let Some(all) = self.tags {
                let tags = tags.as_flattened_mut().iter_mut();
                tags.zip(&*frames).for_each(|(tags, &frame)| *tags = all[frame as usize]);
            }
            kernels.run(FillLeaves { all: self, order, frames, rows });
        });
        leaves
    }

    /// The dimensions, that in which the frames spread most first.
    pub(super) fn widest_first(&self, frames: &[u32]) -> Vec<u32> {
        let spreads = self.spreads(frames);
        let mut order: Vec<u32> = (0..self.dims as u32).collect();
        order.sort_by(|&a, &b| spreads[b as usize].total_cmp(&spreads[a as usize]));
        order
    }

    /// How far the candidates spread in each dimension: a multiple of the variance.
    fn spreads(&self, frames: &[u32]) -> Vec<f32> {
        let mut sample = self.sample(frames).peekable();
        let Some(&first) = sample.peek() else { return vec![0.0; self.dims] };
        let count = sample.len() as f32;
        let mut sums = vec![[0.0_f32; 2]; self.dims];
        for row in sample {
            for (([sum, squares], x), x0) in sums.iter_mut().zip(row).zip(first) {
                let x = x - x0;
                *sum += x;
                *squares += x * x;
            }
        }
        sums.into_iter().map(|[sum, squares]| squares - sum * sum / count).collect()
    }

    /// The principal axes of the candidates.
    pub(super) fn axes(&self, frames: &[u32], kernels: Kernels) -> Axes {
        kernels.run(FindAxes { rows: self.sample(frames), dims: self.dims })
    }

    /// The rows of an even sample of the candidates.
    fn sample(&self, frames: &[u32]) -> impl ExactSizeIterator<Item = &[f32]> + Clone {
        frames.iter().step_by(frames.len().div_ceil(LARGE_SAMPLE).max(1)).map(|&frame| self.row(frame))
    }

    /// The codes of a tree of these rows.
    pub(super) fn codes(&self, tree: &View, kernels: Kernels) -> Codes {
        let turned = Turned::of(self, tree.axes, kernels, 0);
        Codes::of(tree.axes, tree.frames, tree.levels, &turned, kernels, 0)
    }

    fn row(&self, frame: u32) -> &[f32] {
        &self.features[frame as usize * self.dims..][..self.dims]
    }
}

/// Copies the rows of leaves, those of a leaf side by side.
struct FillLeaves<'a> {
    all: &'a Rows<'a>,
    order: &'a [u32],
    /// `W` to a leaf.
    frames: &'a [u32],
    rows: &'a mut [f32],
}

impl Work for FillLeaves<'_> {
    type Done = ();

    #[inline(always)]
    fn run<K: Kernel<W>>(self, kernel: K) {
        let dims = self.all.dims;
        let leaves = self.rows.as_chunks_mut::<W>().0.chunks_exact_mut(dims);
        for (leaf, (frames, rows)) in self.frames.chunks(W).zip(leaves).enumerate() {
            // Rows lie anywhere: those of a later leaf are sent for, and those of this one read side by side.
            for &frame in self.frames.iter().skip((leaf + LEAVES_AHEAD) * W).take(W) {
                kernel.fetch(self.all.row(frame));
            }
            let here: [&[f32]; W] =
                std::array::from_fn(|lane| self.all.row(frames[lane.min(frames.len() - 1)]));
            for (lanes, &dimension) in rows.iter_mut().zip(self.order) {
                for (lane, x) in lanes.iter_mut().enumerate() {
                    *x = if lane < frames.len() { here[lane][dimension as usize] } else { f32::INFINITY };
                }
            }
        }
    }
}

/// Finds the principal axes of rows.
struct FindAxes<I> {
    rows: I,
    dims: usize,
}

impl<'a, I: Iterator<Item = &'a [f32]> + Clone> Work for FindAxes<I> {
    type Done = Axes;

    #[inline(always)]
    fn run<K: Kernel<W>>(self, _kernel: K) -> Axes {
        Axes::of(self.rows, self.dims)
    }
}
