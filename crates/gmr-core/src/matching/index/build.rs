//! Frames put in the order of a kd-tree, then leaves and boxes from the bottom up.

use super::aligned::Aligned;
use super::tree::{Level, Tree, edges};

/// A frame and, above it, one of its features in a form that compares as the feature does.
type Key = u64;

/// Frames looked at to choose the dimension of a cut; more do not make better cuts.
const SAMPLE: usize = 256;

/// Frames looked at to put the dimensions in the order of their spread.
const LARGE_SAMPLE: usize = 4096;

/// Features and tags of the candidates of a database.
pub(super) struct Rows<'a> {
    pub(super) features: &'a [f32],
    pub(super) dims: usize,
    pub(super) candidates: &'a [bool],
    pub(super) tags: Option<&'a [u32]>,
}

impl Rows<'_> {
    /// The tree of all candidates.
    pub(super) fn tree<const W: usize>(&self) -> Tree<W> {
        let candidates = (0..self.candidates.len() as u32).filter(|&f| self.candidates[f as usize]);
        let mut keys: Vec<Key> = candidates.map(Key::from).collect();
        let order = self.widest_first(&keys);
        self.arrange_all::<W>(&mut keys);
        let mut frames: Vec<u32> = keys.into_iter().map(frame_of).collect();
        frames.chunks_mut(W).for_each(<[u32]>::sort_unstable);

        let mut tree = self.leaves(order, &frames);
        if tree.frames.len() > 1 {
            tree.levels.push(above_leaves(&tree));
        }
        while tree.levels.last().is_some_and(|top| top.lowest.len() > 1) {
            tree.levels.push(above_nodes(&tree, tree.levels.len() - 1));
        }
        tree
    }

    /// Leaves of `frames`, `W` to each, and nothing above them.
    fn leaves<const W: usize>(&self, order: Vec<u32>, frames: &[u32]) -> Tree<W> {
        let leaf_count = frames.len().div_ceil(W);
        let mut places = vec![0; self.dims];
        order.iter().enumerate().for_each(|(place, &dimension)| places[dimension as usize] = place as u32);
        let mut tree = Tree {
            order,
            places,
            rows: Aligned::new(f32::INFINITY, leaf_count * self.dims * W),
            frames: vec![[u32::MAX; W]; leaf_count],
            tags: vec![[0; W]; leaf_count],
            levels: Vec::new(),
        };
        let rows = tree.rows.as_mut_slice().chunks_exact_mut(self.dims * W);
        for ((leaf, frames), rows) in frames.chunks(W).enumerate().zip(rows) {
            for (lane, &frame) in frames.iter().enumerate() {
                tree.frames[leaf][lane] = frame;
                tree.tags[leaf][lane] = self.tags.map_or(0, |tags| tags[frame as usize]);
                let row = self.row(frame);
                let lanes = rows[lane..].iter_mut().step_by(W);
                lanes.zip(&tree.order).for_each(|(x, &dimension)| *x = row[dimension as usize]);
            }
        }
        tree
    }

    /// Puts the frames so that every run of `W`, `W^2`, `W^3`, ... lies close together.
    fn arrange_all<const W: usize>(&self, keys: &mut [Key]) {
        let mut run = W;
        while run < keys.len() {
            run = run.saturating_mul(W);
        }
        self.arrange::<W>(keys, run);
    }

    /// Cuts `keys` into runs of `run`, halving them across their widest dimension, then each run into smaller ones.
    fn arrange<const W: usize>(&self, keys: &mut [Key], run: usize) {
        if keys.len() <= W {
            return;
        }
        if keys.len() <= run {
            return self.arrange::<W>(keys, run / W);
        }
        let middle = keys.len().div_ceil(run) / 2 * run;
        let spreads = self.spreads(keys, SAMPLE);
        let widest = (0..self.dims).max_by(|&a, &b| spreads[a].total_cmp(&spreads[b])).unwrap_or(0);
        for key in keys.iter_mut() {
            let frame = frame_of(*key);
            *key = Key::from(ascending(self.row(frame)[widest])) << 32 | Key::from(frame);
        }
        keys.select_nth_unstable(middle);
        let (left, right) = keys.split_at_mut(middle);
        self.arrange::<W>(left, run);
        self.arrange::<W>(right, run);
    }

    /// The dimensions, that in which the frames spread most first.
    fn widest_first(&self, keys: &[Key]) -> Vec<u32> {
        let spreads = self.spreads(keys, LARGE_SAMPLE);
        let mut order: Vec<u32> = (0..self.dims as u32).collect();
        order.sort_by(|&a, &b| spreads[b as usize].total_cmp(&spreads[a as usize]));
        order
    }

    /// How far an even sample of the frames spreads in each dimension: a multiple of the variance.
    fn spreads(&self, keys: &[Key], sample: usize) -> Vec<f32> {
        let Some(&first) = keys.first() else { return vec![0.0; self.dims] };
        let first = self.row(frame_of(first));
        let sampled = keys.iter().step_by(keys.len().div_ceil(sample));
        let count = sampled.len() as f32;
        let mut sums = vec![[0.0_f32; 2]; self.dims];
        for &key in sampled {
            for (([sum, squares], x), x0) in sums.iter_mut().zip(self.row(frame_of(key))).zip(first) {
                let x = x - x0;
                *sum += x;
                *squares += x * x;
            }
        }
        sums.into_iter().map(|[sum, squares]| squares - sum * sum / count).collect()
    }

    fn row(&self, frame: u32) -> &[f32] {
        &self.features[frame as usize * self.dims..][..self.dims]
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

/// The boxes around leaves.
fn above_leaves<const W: usize>(tree: &Tree<W>) -> Level<W> {
    level(tree, &tree.frames, &tree.tags, |leaf, dimension| {
        let held = tree.frames[leaf].iter().filter(|&&frame| frame != u32::MAX).count();
        let lanes = &tree.leaf(leaf)[dimension][..held];
        (
            lanes.iter().copied().fold(f32::INFINITY, f32::min),
            lanes.iter().copied().fold(f32::NEG_INFINITY, f32::max),
        )
    })
}

/// The boxes around the nodes of `below`.
fn above_nodes<const W: usize>(tree: &Tree<W>, below: usize) -> Level<W> {
    let nodes = &tree.levels[below];
    level(tree, &nodes.lowest, &nodes.tags, |node, dimension| {
        let boxes = &tree.node(below, node)[dimension];
        let low = boxes.iter().map(|&edges| edges::low(edges)).fold(f32::INFINITY, f32::min);
        (low, boxes.iter().map(|&edges| edges::high(edges)).fold(f32::NEG_INFINITY, f32::max))
    })
}

/// The level above children with these lowest frames and tags, whose extent in a dimension `extent` tells.
fn level<const W: usize>(
    tree: &Tree<W>,
    lowest: &[[u32; W]],
    tags: &[[u32; W]],
    extent: impl Fn(usize, usize) -> (f32, f32),
) -> Level<W> {
    let (dims, nodes) = (tree.dims(), lowest.len().div_ceil(W));
    let mut level = Level {
        boxes: Aligned::new(edges::EMPTY, nodes * dims * W),
        lowest: vec![[u32::MAX; W]; nodes],
        tags: vec![[0; W]; nodes],
    };
    for child in 0..lowest.len() {
        let (node, lane) = (child / W, child % W);
        level.lowest[node][lane] = lowest[child].iter().copied().fold(u32::MAX, u32::min);
        level.tags[node][lane] = tags[child].iter().fold(0, |all, tags| all | tags);
        let boxes = level.boxes.as_mut_slice()[(node * dims * W + lane)..].iter_mut().step_by(W);
        for (dimension, edges) in boxes.take(dims).enumerate() {
            let (low, high) = extent(child, dimension);
            *edges = edges::around(low, high);
        }
    }
    level
}
