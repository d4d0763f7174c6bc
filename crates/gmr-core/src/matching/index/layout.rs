//! Numbers of eight frames or boxes side by side, and the edges of boxes in half the bits.

/// Frames of a leaf and boxes of a node.
pub(in super::super) const W: usize = 8;

/// One number of each of `N` frames.
pub(super) type Lanes<const N: usize> = [f32; N];

/// Lower (low half) and upper edge (high half) of each of `N` boxes in one dimension, rounded outwards: see [`edges`].
pub(super) type Edges<const N: usize> = [u32; N];

/// The larger of two numbers, in one instruction.
#[inline(always)]
pub(super) fn larger(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

/// The smaller of two numbers, in one instruction.
#[inline(always)]
pub(super) fn smaller(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The `place`th of blocks of `lines` lines of `N` values.
#[inline(always)]
pub(super) fn block<T, const N: usize>(values: &[T], place: usize, lines: usize) -> &[[T; N]] {
    values[place * lines * N..][..lines * N].as_chunks().0
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
