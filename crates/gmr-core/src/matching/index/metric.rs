//! What a dimension of a query adds to a cost: its squared difference, or that times a weight.
//!
//! Each way of counting has loops of its own, so that a search in which all dimensions count alike knows nothing of
//! weights. Costs sum the dimensions in their own order; bounds, and the sums that rule out, in that of the layout.

use super::Query;
use super::traverse::Kernel;
use super::tree::{Edges, Lanes};

/// Dimensions summed between two looks at whether the frames of a leaf are already too far.
pub(super) const STRIDE: usize = 8;

/// How the squared differences of a query are counted.
pub(super) trait Metric {
    /// One dimension of the query, laid out.
    type Term: Copy + Default;

    /// Fills `terms` with the query's dimensions in the order of the layout; says how many of them count.
    fn lay_out(query: &Query, order: &[u32], terms: &mut [Self::Term]) -> usize;

    /// The costs of the frames of a leaf: `places` says where each dimension is laid out.
    fn costs<const W: usize, K: Kernel<W>>(
        kernel: K,
        query: &Query,
        places: &[u32],
        rows: &[Lanes<W>],
    ) -> K::Sums;

    /// Lower bounds of the costs in the boxes of a node, but for rounding.
    fn bounds<const W: usize, K: Kernel<W>>(kernel: K, terms: &[Self::Term], boxes: &[Edges<W>]) -> K::Sums;

    /// Whether some of the dimensions, the widest first, show that all frames of a leaf lie beyond `reach`.
    fn are_too_far<const W: usize, K: Kernel<W>>(
        kernel: K,
        terms: &[Self::Term],
        rows: &[Lanes<W>],
        reach: f32,
    ) -> bool;
}

/// All dimensions count alike.
pub(super) struct Even;

impl Metric for Even {
    type Term = f32;

    #[inline(always)]
    fn lay_out(query: &Query, order: &[u32], terms: &mut [f32]) -> usize {
        terms.iter_mut().zip(order).for_each(|(q, &dimension)| *q = query.features[dimension as usize]);
        terms.len()
    }

    #[inline(always)]
    fn costs<const W: usize, K: Kernel<W>>(
        kernel: K,
        query: &Query,
        places: &[u32],
        rows: &[Lanes<W>],
    ) -> K::Sums {
        let mut costs = kernel.zero();
        for (&q, &place) in query.features.iter().zip(places) {
            costs = kernel.add_squares(costs, kernel.difference(q, &rows[place as usize]));
        }
        costs
    }

    #[inline(always)]
    fn bounds<const W: usize, K: Kernel<W>>(kernel: K, terms: &[f32], boxes: &[Edges<W>]) -> K::Sums {
        // Two sums at a time, for one would wait for itself.
        let (pairs, last) = boxes.as_chunks::<2>();
        let (q_pairs, q_last) = terms.as_chunks::<2>();
        let (mut even, mut odd) = (kernel.zero(), kernel.zero());
        for (q, edges) in q_pairs.iter().zip(pairs) {
            even = kernel.add_squares_fused(even, kernel.gap(q[0], &edges[0]));
            odd = kernel.add_squares_fused(odd, kernel.gap(q[1], &edges[1]));
        }
        for (&q, edges) in q_last.iter().zip(last) {
            even = kernel.add_squares_fused(even, kernel.gap(q, edges));
        }
        kernel.add(even, odd)
    }

    #[inline(always)]
    fn are_too_far<const W: usize, K: Kernel<W>>(
        kernel: K,
        terms: &[f32],
        rows: &[Lanes<W>],
        reach: f32,
    ) -> bool {
        let mut sums = kernel.zero();
        let (rows, _) = rows.as_chunks::<STRIDE>();
        let (terms, _) = terms.as_chunks::<STRIDE>();
        for (q, rows) in terms.iter().zip(rows) {
            for (&q, row) in q.iter().zip(rows) {
                sums = kernel.add_squares_fused(sums, kernel.difference(q, row));
            }
            if kernel.at_most(sums, reach) == 0 {
                return true;
            }
        }
        false
    }
}

/// Each dimension counts by a weight; those of weight 0 are not looked at.
///
/// The terms of bounds are rounded just as those of costs are, so they are not above them however large a weight is.
pub(super) struct Weighted;

/// A dimension that counts.
#[derive(Clone, Copy, Default)]
pub(super) struct WeightedTerm {
    q: f32,
    weight: f32,
    place: u32,
}

impl Metric for Weighted {
    type Term = WeightedTerm;

    #[inline(always)]
    fn lay_out(query: &Query, order: &[u32], terms: &mut [WeightedTerm]) -> usize {
        let weights = query.weights.unwrap_or_default();
        let mut count = 0;
        for (place, &dimension) in order.iter().enumerate() {
            let (q, weight) = (query.features[dimension as usize], weights[dimension as usize]);
            if weight > 0.0 {
                terms[count] = WeightedTerm { q, weight, place: place as u32 };
                count += 1;
            }
        }
        count
    }

    #[inline(always)]
    fn costs<const W: usize, K: Kernel<W>>(
        kernel: K,
        query: &Query,
        places: &[u32],
        rows: &[Lanes<W>],
    ) -> K::Sums {
        let mut costs = kernel.zero();
        let weights = query.weights.unwrap_or_default();
        for ((&q, &weight), &place) in query.features.iter().zip(weights).zip(places) {
            if weight > 0.0 {
                let difference = kernel.difference(q, &rows[place as usize]);
                costs = kernel.add_weighted_squares(costs, weight, difference);
            }
        }
        costs
    }

    #[inline(always)]
    fn bounds<const W: usize, K: Kernel<W>>(
        kernel: K,
        terms: &[WeightedTerm],
        boxes: &[Edges<W>],
    ) -> K::Sums {
        let (pairs, last) = terms.as_chunks::<2>();
        let (mut even, mut odd) = (kernel.zero(), kernel.zero());
        for [one, other] in pairs {
            even =
                kernel.add_weighted_squares(even, one.weight, kernel.gap(one.q, &boxes[one.place as usize]));
            odd = kernel.add_weighted_squares(
                odd,
                other.weight,
                kernel.gap(other.q, &boxes[other.place as usize]),
            );
        }
        for term in last {
            even = kernel.add_weighted_squares(
                even,
                term.weight,
                kernel.gap(term.q, &boxes[term.place as usize]),
            );
        }
        kernel.add(even, odd)
    }

    #[inline(always)]
    fn are_too_far<const W: usize, K: Kernel<W>>(
        kernel: K,
        terms: &[WeightedTerm],
        rows: &[Lanes<W>],
        reach: f32,
    ) -> bool {
        let mut sums = kernel.zero();
        for terms in terms.as_chunks::<STRIDE>().0 {
            for term in terms {
                let difference = kernel.difference(term.q, &rows[term.place as usize]);
                sums = kernel.add_weighted_squares(sums, term.weight, difference);
            }
            if kernel.at_most(sums, reach) == 0 {
                return true;
            }
        }
        false
    }
}
