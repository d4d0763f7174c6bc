//! Boxes around what is below them, from the leaves up.

use super::super::aligned::Aligned;
use super::layout::{Edges, Lanes, W, block, edges, larger, smaller};
use super::tree::Levels;
use crate::parallel::for_each_chunk;

/// Nodes that a thread makes at a time.
const NODES_A_PART: usize = 64;

/// What becomes the nodes of a tree.
pub(super) struct Nodes {
    pub(super) boxes: Aligned<u32>,
    pub(super) lowest: Vec<[u32; W]>,
    pub(super) tags: Vec<[u32; W]>,
}

/// What the nodes of a level stand above: leaves, or nodes.
#[derive(Clone, Copy)]
struct Below<'a> {
    dims: usize,
    numbers: Numbers<'a>,
    /// The frames of a leaf, or the lowest in each box of a node.
    frames: &'a [[u32; W]],
    tags: &'a [[u32; W]],
}

#[derive(Clone, Copy)]
enum Numbers<'a> {
    Rows(&'a [f32]),
    Boxes(&'a [u32]),
}

/// The nodes above leaves with these rows, frames and tags, level by level.
pub(super) fn nodes_above(
    rows: &[f32],
    frames: &[[u32; W]],
    tags: &[[u32; W]],
    levels: &Levels,
    dims: usize,
    threads: usize,
) -> Nodes {
    let count = levels.node_count();
    let mut nodes = Nodes {
        boxes: Aligned::zeros(count * dims * W),
        lowest: vec![[u32::MAX; W]; count],
        tags: vec![[0; W]; count],
    };
    for level in 0..levels.count() {
        let these = levels.nodes(level);
        let (boxes_below, boxes) = nodes.boxes.as_mut_slice().split_at_mut(these.start * dims * W);
        let (lowest_below, lowest) = nodes.lowest.split_at_mut(these.start);
        let (tags_below, node_tags) = nodes.tags.split_at_mut(these.start);
        let below = match level.checked_sub(1).map(|lower| levels.nodes(lower)) {
            None => Below { dims, numbers: Numbers::Rows(rows), frames, tags },
            Some(lower) => Below {
                dims,
                numbers: Numbers::Boxes(&boxes_below[lower.start * dims * W..]),
                frames: &lowest_below[lower.clone()],
                tags: &tags_below[lower],
            },
        };
        for (lowest, frames) in lowest.iter_mut().zip(below.frames.chunks(W)) {
            lowest.iter_mut().zip(frames).for_each(|(lowest, frames)| *lowest = least(frames));
        }
        for (node_tags, tags) in node_tags.iter_mut().zip(below.tags.chunks(W)) {
            node_tags.iter_mut().zip(tags).for_each(|(all, tags)| *all = all_of(tags));
        }
        let boxes = &mut boxes[..these.len() * dims * W];
        for_each_chunk(boxes, NODES_A_PART * dims * W, threads, |part, boxes| {
            for (node, boxes) in boxes.chunks_exact_mut(dims * W).enumerate() {
                below.surround(part * NODES_A_PART + node, boxes.as_chunks_mut().0);
            }
        });
    }
    nodes
}

impl Below<'_> {
    /// Fills the boxes of a node with what is around its children.
    fn surround(self, node: usize, boxes: &mut [Edges<W>]) {
        for (lane, child) in (node * W..(node + 1) * W).enumerate() {
            let boxes = boxes.iter_mut().map(|edges| &mut edges[lane]);
            if child >= self.frames.len() {
                boxes.for_each(|edges| *edges = edges::EMPTY);
                continue;
            }
            match self.numbers {
                Numbers::Rows(rows) => {
                    let lanes = block(rows, child, self.dims).iter();
                    boxes.zip(lanes).for_each(|(edges, x)| *edges = around_rows(x, &self.frames[child]));
                }
                Numbers::Boxes(below) => {
                    let lanes = block(below, child, self.dims).iter();
                    boxes.zip(lanes).for_each(|(edges, below)| *edges = around_boxes(below));
                }
            }
        }
    }
}

fn least(frames: &[u32]) -> u32 {
    frames.iter().copied().fold(u32::MAX, u32::min)
}

fn all_of(tags: &[u32]) -> u32 {
    tags.iter().fold(0, |all, tags| all | tags)
}

/// The edges around the numbers of those frames that there are.
fn around_rows(lanes: &Lanes<W>, frames: &[u32; W]) -> u32 {
    let held = |lane: usize| if frames[lane] == u32::MAX { lanes[0] } else { lanes[lane] };
    let lanes = if frames[W - 1] == u32::MAX { std::array::from_fn(held) } else { *lanes };
    edges::around(folded(lanes, smaller), folded(lanes, larger))
}

/// What is left of eight numbers folded by halves.
#[inline(always)]
fn folded(lanes: Lanes<W>, pick: impl Fn(f32, f32) -> f32) -> f32 {
    let four: [f32; 4] = std::array::from_fn(|lane| pick(lanes[lane], lanes[lane + 4]));
    let two: [f32; 2] = std::array::from_fn(|lane| pick(four[lane], four[lane + 2]));
    pick(two[0], two[1])
}

/// The edges around boxes.
fn around_boxes(boxes: &Edges<W>) -> u32 {
    edges::around(folded(boxes.map(edges::low), smaller), folded(boxes.map(edges::high), larger))
}
