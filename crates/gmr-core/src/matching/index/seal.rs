//! What the blocks of an index in a file must sum up to, looked at when a search first meets a block.
//!
//! Opening a file reads none of its rows, so what is wrong with them shows only where they are read. The first look at
//! a leaf or node takes its sum and checks what the search relies on; later looks read one bit. A block that is not as
//! it was saved is passed over and remembered, and from then on no search of the index is answered.

use std::path::PathBuf;
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};

use super::super::column::Column;
use super::IndexError;
use super::layout::{W, edges};
use super::tree::{View, Width};

/// The sums of all blocks, the leaves first, and what is known of the blocks.
#[derive(Debug)]
pub(super) struct Seals {
    pub(super) sums: Column<u64>,
    /// Frames in all leaves.
    pub(super) held: usize,
    /// Rows that frames are numbers of.
    pub(super) frame_count: usize,
    file: PathBuf,
    /// One bit a block: whether it was looked at and found sound.
    sound: Vec<AtomicU64>,
    /// A block that was found damaged, or [`NONE`].
    damaged: AtomicUsize,
}

/// No block at all.
const NONE: usize = usize::MAX;

impl Seals {
    pub(super) fn new(sums: Column<u64>, held: usize, frame_count: usize, file: PathBuf) -> Self {
        let sound = (0..sums.len().div_ceil(64)).map(|_| AtomicU64::new(0)).collect();
        Self { sums, held, frame_count, file, sound, damaged: AtomicUsize::new(NONE) }
    }

    /// Whether a leaf is as it was saved; where it is not, that is remembered.
    #[inline(always)]
    pub(super) fn is_leaf_sound(&self, tree: &View<'_, impl Width>, leaf: usize) -> bool {
        self.is_known(leaf) || self.look_at(leaf, || self.fits_leaf(tree, leaf))
    }

    /// As [`Seals::is_leaf_sound`], of a node.
    #[inline(always)]
    pub(super) fn is_node_sound(&self, tree: &View<'_, impl Width>, node: usize) -> bool {
        let block = tree.levels.leaf_count() + node;
        self.is_known(block) || self.look_at(block, || self.fits_node(tree, node, block))
    }

    /// An error where a block was found damaged.
    pub(super) fn check(&self, leaf_count: usize) -> Result<(), IndexError> {
        let block = self.damaged.load(Ordering::Relaxed);
        let (what, number) =
            if block < leaf_count { ("leaf", block) } else { ("node", block.saturating_sub(leaf_count)) };
        match block {
            NONE => Ok(()),
            _ => Err(IndexError::Damaged { file: self.file.clone(), what, number }),
        }
    }

    #[inline(always)]
    fn is_known(&self, block: usize) -> bool {
        self.sound[block / 64].load(Ordering::Relaxed) >> (block % 64) & 1 == 1
    }

    #[cold]
    #[inline(never)]
    fn look_at(&self, block: usize, fits: impl FnOnce() -> bool) -> bool {
        let is_sound = fits();
        if is_sound {
            self.sound[block / 64].fetch_or(1 << (block % 64), Ordering::Relaxed);
        } else {
            self.damaged.store(block, Ordering::Relaxed);
        }
        is_sound
    }

    fn fits_leaf(&self, tree: &View<'_, impl Width>, leaf: usize) -> bool {
        let held = self.held.saturating_sub(leaf * W).min(W);
        let (frames, rest) = tree.frames[leaf].split_at(held);
        let are_finite = tree.leaf(leaf).iter().all(|row| row[..held].iter().all(|x| x.is_finite()));
        sum_of_leaf(tree, leaf) == self.sums[leaf]
            && frames.is_sorted_by(|a, b| a < b)
            && frames.last().is_some_and(|&last| (last as usize) < self.frame_count)
            && rest.iter().all(|&frame| frame == u32::MAX)
            && are_finite
    }

    fn fits_node(&self, tree: &View<'_, impl Width>, node: usize, block: usize) -> bool {
        let is_number = |&edges: &u32| !edges::low(edges).is_nan() && !edges::high(edges).is_nan();
        sum_of_node(tree, node) == self.sums[block]
            && tree.node(node).iter().flatten().all(is_number)
            && tree.grid(node).is_sound()
    }
}

/// The sums of all leaves, then of all nodes, last of what lays out rows.
pub(super) fn sums(tree: &View<'_, impl Width>) -> Vec<u64> {
    let leaves = (0..tree.levels.leaf_count()).map(|leaf| sum_of_leaf(tree, leaf));
    let nodes = (0..tree.levels.node_count()).map(|node| sum_of_node(tree, node));
    leaves.chain(nodes).chain([sum_of_layout(tree)]).collect()
}

fn sum_of_leaf(tree: &View<'_, impl Width>, leaf: usize) -> u64 {
    let rows = tree.leaf(leaf).iter().map(|row| row.map(f32::to_bits));
    let codes = in_words(tree.coded_leaf(leaf).as_flattened());
    sum(leaf, rows.chain([tree.frames[leaf], tree.tags[leaf]]).chain(codes))
}

fn sum_of_node(tree: &View<'_, impl Width>, node: usize) -> u64 {
    let boxes = tree.node(node).iter().copied().chain([tree.lowest[node], tree.node_tags[node]]);
    let grid = in_lines(tree.grid(node).numbers.iter().map(|x| x.to_bits()));
    let codes = in_words(tree.coded_node(node).as_flattened());
    sum(tree.levels.leaf_count() + node, boxes.chain(grid).chain(codes))
}

/// The sum of the order of the dimensions and of the axes.
pub(super) fn sum_of_layout(tree: &View<'_, impl Width>) -> u64 {
    let block = tree.levels.leaf_count() + tree.levels.node_count();
    let numbers = tree.axes.mean.iter().chain(&tree.axes.turn);
    let words = numbers.map(|x| x.to_bits()).flat_map(|bits| [bits as u32, (bits >> 32) as u32]);
    sum(block, in_lines(tree.order.iter().copied().chain(words)))
}

/// Words in lines of eight, zeros behind the last.
fn in_lines(mut words: impl Iterator<Item = u32>) -> impl Iterator<Item = [u32; W]> {
    std::iter::from_fn(move || {
        let first = words.next()?;
        let mut line = [first, 0, 0, 0, 0, 0, 0, 0];
        line[1..].iter_mut().zip(&mut words).for_each(|(place, word)| *place = word);
        Some(line)
    })
}

/// Bytes, four to a word, the first the lowest.
fn in_words(bytes: &[u8]) -> impl Iterator<Item = [u32; W]> {
    in_lines(bytes.as_chunks::<4>().0.iter().map(|bytes| u32::from_le_bytes(*bytes)))
}

/// A number that differs where the block's number does, or any one word: each step turns different sums into different
/// ones. Docs/matching.md says it in words.
fn sum(block: usize, lines: impl Iterator<Item = [u32; W]>) -> u64 {
    let mut lanes = [0_u32; W];
    for line in lines {
        for (lane, word) in lanes.iter_mut().zip(line) {
            *lane = (lane.rotate_left(5) ^ word).wrapping_mul(0x9e37_79b1);
        }
    }
    let add =
        |sum: u64, lane: u32| (sum.rotate_left(29) ^ u64::from(lane)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    lanes.into_iter().fold(block as u64, add)
}
