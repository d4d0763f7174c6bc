//! Boxes around what is below them, from the leaves up.

use super::super::aligned::Aligned;
use super::axes::{larger, smaller};
use super::tree::{Levels, W, block, edges};
use crate::parallel::for_each_chunk;

/// Nodes that a thread makes at a time.
const NODES_A_PART: usize = 64;

/// What becomes the nodes of a [`Tree`].
pub(super) struct Nodes {
    pub(super) boxes: Aligned<u32>,
    pub(super) lowest: Vec<[u32; W]>,
    pub(super) tags: Vec<[u32; W]>,
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
        let first_below = level.checked_sub(1).map_or(0, |below| levels.nodes(below).start);
        let children = levels.below(level);
        let (boxes_below, boxes) = nodes.boxes.as_mut_slice().split_at_mut(these.start * dims * W);
        let (lowest_below, lowest) = nodes.lowest.split_at_mut(these.start);
        let (tags_below, above) = nodes.tags.split_at_mut(these.start);
        for (node, (lowest, above)) in lowest.iter_mut().zip(above).take(these.len()).enumerate() {
            for (lane, child) in (node * W..children.min((node + 1) * W)).enumerate() {
                (lowest[lane], above[lane]) = match level {
                    0 => (least(&frames[child]), all_of(&tags[child])),
                    _ => {
                        (least(&lowest_below[first_below + child]), all_of(&tags_below[first_below + child]))
                    }
                };
            }
        }
        let boxes = &mut boxes[..these.len() * dims * W];
        for_each_chunk(boxes, NODES_A_PART * dims * W, threads, |part, boxes| {
            for (node, boxes) in boxes.chunks_exact_mut(dims * W).enumerate() {
                let first = (part * NODES_A_PART + node) * W;
                for lane in 0..W {
                    let boxes = boxes[lane..].iter_mut().step_by(W);
                    let child = first + lane;
                    if child >= children {
                        boxes.for_each(|edges| *edges = edges::EMPTY);
                    } else if level == 0 {
                        let rows = block(rows, child, dims).iter();
                        boxes
                            .zip(rows)
                            .for_each(|(edges, lanes)| *edges = around_rows(lanes, &frames[child]));
                    } else {
                        let below = block(boxes_below, first_below + child, dims).iter();
                        boxes.zip(below).for_each(|(edges, below)| *edges = around_boxes(below));
                    }
                }
            }
        });
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
    let held = |lane: usize| if frames[lane] == u32::MAX { lanes[0] } else { lanes[lane] };
    let lanes = if frames[W - 1] == u32::MAX { std::array::from_fn(held) } else { *lanes };
    edges::around(folded(lanes, smaller), folded(lanes, larger))
}

/// What is left of eight numbers folded by halves.
#[inline(always)]
fn folded(lanes: [f32; W], pick: impl Fn(f32, f32) -> f32) -> f32 {
    let four: [f32; 4] = std::array::from_fn(|lane| pick(lanes[lane], lanes[lane + 4]));
    let two: [f32; 2] = std::array::from_fn(|lane| pick(four[lane], four[lane + 2]));
    pick(two[0], two[1])
}

/// The edges around boxes.
fn around_boxes(boxes: &[u32; W]) -> u32 {
    edges::around(folded(boxes.map(edges::low), smaller), folded(boxes.map(edges::high), larger))
}
