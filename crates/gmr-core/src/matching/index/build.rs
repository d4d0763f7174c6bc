//! Frames put in the order of a kd-tree, then leaves and boxes from the bottom up.

use super::super::aligned::Aligned;
use super::axes::{Axes, axis_blocks, larger, size};
use super::codes::Codes;
use super::traverse::Kernel;
use super::tree::{Levels, Tree, View, W, block, edges};
use super::{Kernels, Work};

/// A frame and, above it, one of its features in a form that compares as the feature does.
type Key = u64;

/// Frames looked at to choose the axis of a cut; more do not make better cuts.
const SAMPLE: usize = 64;

/// Frames looked at to put the dimensions in the order of their spread, and to find the axes.
const LARGE_SAMPLE: usize = 4096;

/// Features and tags of the candidates of a database.
pub(super) struct Rows<'a> {
    pub(super) features: &'a [f32],
    pub(super) dims: usize,
    pub(super) candidates: &'a [bool],
    pub(super) tags: Option<&'a [u32]>,
}

/// What becomes the leaves of a [`Tree`].
struct Leaves {
    rows: Aligned<f32>,
    frames: Vec<[u32; W]>,
    tags: Vec<[u32; W]>,
}

/// What becomes the nodes of a [`Tree`].
pub(super) struct Nodes {
    pub(super) boxes: Aligned<u32>,
    pub(super) lowest: Vec<[u32; W]>,
    pub(super) tags: Vec<[u32; W]>,
}

impl Rows<'_> {
    /// The tree of all candidates.
    pub(super) fn tree(&self, kernels: Kernels) -> Tree {
        let (order, axes) = (self.widest_first(), self.axes());
        let mut keys = self.keys();
        let turned = kernels.run(Turn { rows: self, axes: &axes });
        turned.arrange_all(&mut keys);
        let mut frames: Vec<u32> = keys.into_iter().map(frame_of).collect();
        frames.chunks_mut(W).for_each(<[u32]>::sort_unstable);

        let leaves = self.leaves(&order, &frames);
        let levels = Levels::above(leaves.frames.len());
        let nodes = nodes_above(leaves.rows.as_slice(), &leaves.frames, &leaves.tags, &levels, self.dims);
        let codes = Codes::of(&axes, &leaves.frames, &levels, turned.size, |frame| turned.row(frame));
        let mut places = vec![0; self.dims];
        order.iter().enumerate().for_each(|(place, &dimension)| places[dimension as usize] = place as u32);
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

    /// Leaves of `frames`, `W` to each.
    fn leaves(&self, order: &[u32], frames: &[u32]) -> Leaves {
        let leaf_count = frames.len().div_ceil(W);
        let mut leaves = Leaves {
            rows: Aligned::new(f32::INFINITY, leaf_count * self.dims * W),
            frames: vec![[u32::MAX; W]; leaf_count],
            tags: vec![[0; W]; leaf_count],
        };
        let rows = leaves.rows.as_mut_slice().chunks_exact_mut(self.dims * W);
        for ((leaf, frames), rows) in frames.chunks(W).enumerate().zip(rows) {
            for (lane, &frame) in frames.iter().enumerate() {
                leaves.frames[leaf][lane] = frame;
                leaves.tags[leaf][lane] = self.tags.map_or(0, |tags| tags[frame as usize]);
            }
            // All rows at once, for they lie anywhere and each is waited for.
            let here: [&[f32]; W] = std::array::from_fn(|lane| self.row(frames[lane.min(frames.len() - 1)]));
            for (lanes, &dimension) in rows.as_chunks_mut::<W>().0.iter_mut().zip(order) {
                for (x, row) in lanes.iter_mut().zip(here).take(frames.len()) {
                    *x = row[dimension as usize];
                }
            }
        }
        leaves
    }

    fn keys(&self) -> Vec<Key> {
        let frames = (0..self.candidates.len() as u32).filter(|&f| self.candidates[f as usize]);
        frames.map(Key::from).collect()
    }

    /// The dimensions, that in which the frames spread most first.
    pub(super) fn widest_first(&self) -> Vec<u32> {
        let spreads = self.spreads();
        let mut order: Vec<u32> = (0..self.dims as u32).collect();
        order.sort_by(|&a, &b| spreads[b as usize].total_cmp(&spreads[a as usize]));
        order
    }

    /// How far the candidates spread in each dimension: a multiple of the variance.
    fn spreads(&self) -> Vec<f32> {
        let keys = self.keys();
        let mut sample = self.sample(&keys).peekable();
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
    pub(super) fn axes(&self) -> Axes {
        Axes::of(self.sample(&self.keys()), self.dims)
    }

    /// The rows of an even sample of the candidates.
    fn sample(&self, keys: &[Key]) -> impl ExactSizeIterator<Item = &[f32]> + Clone {
        keys.iter().step_by(keys.len().div_ceil(LARGE_SAMPLE).max(1)).map(|&key| self.row(frame_of(key)))
    }

    /// The codes of a tree of these rows.
    pub(super) fn codes(&self, tree: &View) -> Codes {
        let turned = Turn { rows: self, axes: tree.axes }.turned();
        Codes::of(tree.axes, tree.frames, tree.levels, turned.size, |frame| turned.row(frame))
    }

    fn row(&self, frame: u32) -> &[f32] {
        &self.features[frame as usize * self.dims..][..self.dims]
    }
}

/// The coordinates of all candidates along the principal axes; those of rows too wide to be turned as they are.
struct Turned {
    dims: usize,
    /// Frames x dims; zeros for what is no candidate.
    rows: Aligned<f32>,
    /// The largest coordinate.
    size: f32,
}

/// Turns the candidates.
struct Turn<'a> {
    rows: &'a Rows<'a>,
    axes: &'a Axes,
}

impl Work for Turn<'_> {
    type Done = Turned;

    #[inline(always)]
    fn run<K: Kernel<W>>(self, _kernel: K) -> Turned {
        self.turned()
    }
}

impl Turn<'_> {
    #[inline(always)]
    fn turned(self) -> Turned {
        let Rows { dims, candidates, features, .. } = *self.rows;
        let mut turned = Turned { dims, rows: Aligned::new(0.0, features.len()), size: 0.0 };
        let mut wide = vec![[0.0; W]; axis_blocks(dims)];
        let rows = features.chunks_exact(dims).zip(turned.rows.as_mut_slice().chunks_exact_mut(dims));
        for ((row, turned_row), _) in rows.zip(candidates).filter(|&(_, &candidate)| candidate) {
            if wide.is_empty() {
                turned_row.copy_from_slice(row);
                continue;
            }
            self.axes.turn(row, &mut wide);
            turned_row.copy_from_slice(&wide.as_flattened()[..dims]);
            turned.size = larger(size(&wide), turned.size);
        }
        turned
    }
}

impl Turned {
    /// Puts the frames so that every run of `W`, `W^2`, `W^3`, ... lies close together.
    fn arrange_all(&self, keys: &mut [Key]) {
        let mut run = W;
        while run < keys.len() {
            run = run.saturating_mul(W);
        }
        self.arrange(keys, run);
    }

    /// Cuts `keys` into runs of `run`, halving them across their widest axis, then each run into smaller ones.
    fn arrange(&self, keys: &mut [Key], run: usize) {
        if keys.len() <= W {
            return;
        }
        if keys.len() <= run {
            return self.arrange(keys, run / W);
        }
        let middle = keys.len().div_ceil(run) / 2 * run;
        let widest = self.widest(keys);
        for key in keys.iter_mut() {
            let frame = frame_of(*key);
            *key = Key::from(ascending(self.row(frame)[widest])) << 32 | Key::from(frame);
        }
        keys.select_nth_unstable(middle);
        let (left, right) = keys.split_at_mut(middle);
        self.arrange(left, run);
        self.arrange(right, run);
    }

    /// The axis whose halves are furthest apart: that of the largest mean distance from the mean. Squared distances
    /// would hear a few outliers more than all others.
    fn widest(&self, keys: &[Key]) -> usize {
        let sample = keys.iter().step_by(keys.len().div_ceil(SAMPLE)).map(|&key| self.row(frame_of(key)));
        let share = 1.0 / sample.len() as f32;
        let (mut means, mut distances) = (vec![0.0_f32; self.dims], vec![0.0_f32; self.dims]);
        for row in sample.clone() {
            means.iter_mut().zip(row).for_each(|(mean, x)| *mean += x * share);
        }
        for row in sample {
            let numbers = row.iter().zip(&means);
            distances.iter_mut().zip(numbers).for_each(|(sum, (x, mean))| *sum += (x - mean).abs());
        }
        (0..self.dims).max_by(|&a, &b| distances[a].total_cmp(&distances[b])).unwrap_or(0)
    }

    fn row(&self, frame: u32) -> &[f32] {
        &self.rows.as_slice()[frame as usize * self.dims..][..self.dims]
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

/// The nodes above leaves with these rows, frames and tags, level by level.
pub(super) fn nodes_above(
    rows: &[f32],
    frames: &[[u32; W]],
    tags: &[[u32; W]],
    levels: &Levels,
    dims: usize,
) -> Nodes {
    let count = levels.node_count();
    let mut nodes = Nodes {
        boxes: Aligned::new(edges::EMPTY, count * dims * W),
        lowest: vec![[u32::MAX; W]; count],
        tags: vec![[0; W]; count],
    };
    for level in 0..levels.count() {
        let first = levels.nodes(level).start;
        let first_below = level.checked_sub(1).map_or(0, |below| levels.nodes(below).start);
        let (boxes_below, boxes) = nodes.boxes.as_mut_slice().split_at_mut(first * dims * W);
        let (lowest_below, lowest) = nodes.lowest.split_at_mut(first);
        let (tags_below, above) = nodes.tags.split_at_mut(first);
        for child in 0..levels.below(level) {
            let (node, lane) = (child / W, child % W);
            let boxes = boxes[(node * dims * W + lane)..].iter_mut().step_by(W).take(dims);
            if level == 0 {
                lowest[node][lane] = least(&frames[child]);
                above[node][lane] = all_of(&tags[child]);
                let rows = block(rows, child, dims).iter();
                boxes.zip(rows).for_each(|(edges, lanes)| *edges = around_rows(lanes, &frames[child]));
            } else {
                let child = first_below + child;
                lowest[node][lane] = least(&lowest_below[child]);
                above[node][lane] = all_of(&tags_below[child]);
                let below = block(boxes_below, child, dims).iter();
                boxes.zip(below).for_each(|(edges, below)| *edges = around_boxes(below));
            }
        }
    }
    nodes
}

fn least(frames: &[u32]) -> u32 {
    frames.iter().copied().fold(u32::MAX, u32::min)
}

fn all_of(tags: &[u32]) -> u32 {
    tags.iter().fold(0, |all, tags| all | tags)
}

/// The edges around the numbers of those frames that there are.
fn around_rows(lanes: &[f32; W], frames: &[u32; W]) -> u32 {
    let held = frames.iter().filter(|&&frame| frame != u32::MAX).count();
    let lanes = lanes[..held].iter().copied();
    edges::around(lanes.clone().fold(f32::INFINITY, f32::min), lanes.fold(f32::NEG_INFINITY, f32::max))
}

/// The edges around boxes.
fn around_boxes(boxes: &[u32; W]) -> u32 {
    let low = boxes.iter().map(|&edges| edges::low(edges)).fold(f32::INFINITY, f32::min);
    edges::around(low, boxes.iter().map(|&edges| edges::high(edges)).fold(f32::NEG_INFINITY, f32::max))
}
