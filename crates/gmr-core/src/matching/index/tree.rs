//! The layout that is searched: leaves of `W` frames in the order of a kd-tree, and above them boxes, `W` to a node.
//!
//! Every node but the last of its level is full, so child `j` of node `i` is node `i W + j` of the level below, and
//! nothing needs to be stored to find it. What `W` lanes share stands side by side: one number of each of `W` frames,
//! the edges of each of `W` boxes. Dimensions are laid out widest first, for what a few of them rule out need not be
//! read further.

use super::aligned::Aligned;

/// One number of each of `W` frames.
pub(super) type Lanes<const W: usize> = [f32; W];

/// Lower (low half) and upper edge (high half) of each of `W` boxes in one dimension, rounded outwards: see [`edges`].
pub(super) type Edges<const W: usize> = [u32; W];

/// Leaves and the levels of nodes above them.
#[derive(Debug, Clone)]
pub(super) struct Tree<const W: usize> {
    /// The dimensions as they are laid out.
    pub(super) order: Vec<u32>,
    /// Where each dimension is laid out: the inverse of `order`.
    pub(super) places: Vec<u32>,
    /// Leaves x dims x `W`.
    pub(super) rows: Aligned<f32>,
    /// Frames of each leaf, ascending; `u32::MAX` behind the last.
    pub(super) frames: Vec<[u32; W]>,
    /// Tag bits of each of them.
    pub(super) tags: Vec<[u32; W]>,
    /// The level above the leaves first, the root's last; none where one leaf holds all.
    pub(super) levels: Vec<Level<W>>,
}

/// Nodes of `W` boxes, and what a search may ask of the frames in each.
#[derive(Debug, Clone)]
pub(super) struct Level<const W: usize> {
    /// Nodes x dims x `W`.
    pub(super) boxes: Aligned<u32>,
    /// Lowest frame in each box.
    pub(super) lowest: Vec<[u32; W]>,
    /// All bits that the frames in each box carry.
    pub(super) tags: Vec<[u32; W]>,
}

impl<const W: usize> Tree<W> {
    pub(super) fn dims(&self) -> usize {
        self.order.len()
    }

    /// The frames of a leaf, `W` side by side in every dimension.
    #[inline(always)]
    pub(super) fn leaf(&self, leaf: usize) -> &[Lanes<W>] {
        block(self.rows.as_slice(), leaf, self.dims())
    }

    /// The boxes of a node, `W` side by side in every dimension.
    #[inline(always)]
    pub(super) fn node(&self, level: usize, node: usize) -> &[Edges<W>] {
        block(self.levels[level].boxes.as_slice(), node, self.dims())
    }

    /// The bits of a node's children: `W` of them, or what is left for the last node of a level.
    #[inline(always)]
    pub(super) fn children(&self, level: usize, node: usize) -> u32 {
        let below = level.checked_sub(1).map_or(self.frames.len(), |below| self.levels[below].lowest.len());
        u32::MAX >> (32 - (below - node * W).min(W))
    }
}

#[inline(always)]
fn block<T, const W: usize>(values: &[T], place: usize, dims: usize) -> &[[T; W]] {
    values[place * dims * W..][..dims * W].as_chunks().0
}

/// The two edges of a box in one dimension, each the upper half of an `f32`, rounded outwards.
///
/// Half the bytes mean half the cache lines of a node, which is what a search of many frames waits for; a box that
/// is larger by up to 1/128 of its distance from zero rules out nearly as much.
pub(super) mod edges {
    /// The upper half of an `f32`: its sign, its exponent and seven bits of its fraction.
    pub(in super::super) const UPPER: u32 = 0xffff_0000;

    /// A box that holds nothing: from infinity to minus infinity.
    pub(in super::super) const EMPTY: u32 = 0xff80_7f80;

    /// A box that reaches from `low` to `high`, or a little further.
    pub(in super::super) fn around(low: f32, high: f32) -> u32 {
        downwards(low) >> 16 | downwards(-high) ^ (1 << 31)
    }

    /// The lower edge.
    #[inline(always)]
    pub(in super::super) fn low(edges: u32) -> f32 {
        f32::from_bits(edges << 16)
    }

    /// The upper edge.
    #[inline(always)]
    pub(in super::super) fn high(edges: u32) -> f32 {
        f32::from_bits(edges & UPPER)
    }

    /// Bits of the greatest number that needs no more than the upper half and is not above `x`.
    fn downwards(x: f32) -> u32 {
        let bits = x.to_bits();
        // Cutting bits off goes towards zero: down for positive numbers, up for negative ones.
        let cut_up = x < 0.0 && bits & !UPPER != 0;
        (bits & UPPER) + if cut_up { 1 << 16 } else { 0 }
    }

    #[cfg(test)]
    mod tests {
        use super::*;

        #[test]
        fn edges_hold_what_they_are_around_and_little_more() {
            let tiny = f32::from_bits(1);
            for x in [0.0, -0.0, 1.0, 1.5, 0.1, 1e-30, 1e30, tiny, f32::MIN_POSITIVE, f32::MAX] {
                for x in [x, -x] {
                    let edges = around(x, x);
                    assert!(low(edges) <= x && x <= high(edges), "{x}: {} {}", low(edges), high(edges));
                    let slack = x.abs() / 127.0 + 1e-38;
                    assert!(x.abs() == f32::MAX || high(edges) - low(edges) <= slack, "{x}");
                }
            }
            assert_eq!((low(EMPTY), high(EMPTY)), (f32::INFINITY, f32::NEG_INFINITY));
        }
    }
}
