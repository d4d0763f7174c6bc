//! What a dimension of a query adds to a cost: its squared difference, or that times a weight.
//!
//! Costs sum the dimensions in their own order and read the rows as they are; what rules out has sums of its own. Where
//! all dimensions count alike that are the coded boxes and rows; where they have weights, distances along other axes say
//! nothing, so boxes and rows along the features' own dimensions rule out.

use super::Query;
use super::axes::{axis_blocks, size};
use super::codes::{MOST_CODED, Placed};
use super::kernel::Kernel;
use super::layout::{Lanes, W};
use super::tree::{View, Width};

/// Dimensions summed between two looks at whether the frames of a leaf are already too far.
const STRIDE: usize = 8;

/// How the squared differences of a query are counted, and the query as that needs it.
pub(super) trait Metric<D: Width> {
    /// Makes a query ready.
    fn new(tree: &View<D>, query: &Query) -> Self;

    /// As [`Metric::new`], in the place of another query.
    fn set(&mut self, tree: &View<D>, query: &Query);

    /// Lower bounds of the costs in the boxes of a node, but for rounding.
    fn bounds<K: Kernel<W>>(&mut self, kernel: K, tree: &View<D>, node: usize) -> K::Sums;

    /// Whether frames of a leaf may lie within `reach`; the leaf is below the node whose bounds were asked for last.
    fn may_reach<K: Kernel<W>>(&self, kernel: K, tree: &View<D>, leaf: usize, reach: f32) -> bool;

    /// The costs of the frames of a leaf.
    fn costs<K: Kernel<W>>(kernel: K, query: &Query, places: &[u32], rows: &[Lanes<W>]) -> K::Sums;

    /// Begins to bring a node into the cache.
    fn fetch_node<K: Kernel<W>>(kernel: K, tree: &View<D>, node: usize);

    /// Begins to bring into the cache what [`Metric::may_reach`] reads first.
    fn fetch_leaf<K: Kernel<W>>(kernel: K, tree: &View<D>, leaf: usize);
}

/// All dimensions count alike, and rows are coded.
pub(super) struct Even {
    /// The query along the principal axes.
    turned: [[f32; W]; MOST_CODED / W],
    /// How far off that can be.
    error: f32,
    placed: Placed,
}

impl<D: Width> Metric<D> for Even {
    #[inline(always)]
    fn new(tree: &View<D>, query: &Query) -> Self {
        let turned = [[0.0; W]; MOST_CODED / W];
        let mut even = Self { turned, error: 0.0, placed: Placed::new() };
        even.set(tree, query);
        even
    }

    #[inline(always)]
    fn set(&mut self, tree: &View<D>, query: &Query) {
        let turned = &mut self.turned[..axis_blocks(tree.dims())];
        tree.axes.turn(query.features, turned);
        self.error = tree.axes.error(size(turned));
    }

    #[inline(always)]
    fn bounds<K: Kernel<W>>(&mut self, kernel: K, tree: &View<D>, node: usize) -> K::Sums {
        let turned = &self.turned[..axis_blocks(tree.dims())];
        self.placed.place(kernel, turned, self.error, tree.grid(node));
        self.placed.bounds_of_boxes(kernel, tree.coded_node(node))
    }

    #[inline(always)]
    fn may_reach<K: Kernel<W>>(&self, kernel: K, tree: &View<D>, leaf: usize, reach: f32) -> bool {
        kernel.at_most(self.placed.bounds_of_rows(kernel, tree.coded_leaf(leaf)), reach) != 0
    }

    #[inline(always)]
    fn costs<K: Kernel<W>>(kernel: K, query: &Query, places: &[u32], rows: &[Lanes<W>]) -> K::Sums {
        let mut costs = kernel.zero();
        for (&q, &place) in query.features.iter().zip(places) {
            costs = kernel.add_squares(costs, kernel.difference(q, &rows[place as usize]));
        }
        costs
    }

    #[inline(always)]
    fn fetch_node<K: Kernel<W>>(kernel: K, tree: &View<D>, node: usize) {
        kernel.fetch(tree.grid(node).numbers);
        kernel.fetch(tree.coded_node(node));
    }

    #[inline(always)]
    fn fetch_leaf<K: Kernel<W>>(kernel: K, tree: &View<D>, leaf: usize) {
        kernel.fetch(tree.coded_leaf(leaf));
    }
}

/// Each dimension counts by a weight, by 1 where the query has none; those of weight 0 are not looked at.
///
/// The terms of bounds are rounded just as those of costs are, so they are not above them however large a weight is.
pub(super) struct Weighted {
    /// The dimensions that count, the widest first.
    few: [WeightedTerm; FEW],
    count: usize,
    /// As `few`, where there may be more than that.
    many: Vec<WeightedTerm>,
}

/// Dimensions for which a query asks for no memory.
const FEW: usize = 64;

impl Weighted {
    #[inline(always)]
    fn terms(&self) -> &[WeightedTerm] {
        if self.many.is_empty() { &self.few[..self.count] } else { &self.many }
    }
}

/// A dimension that counts.
#[derive(Clone, Copy, Default)]
struct WeightedTerm {
    q: f32,
    weight: f32,
    place: u32,
}

impl<D: Width> Metric<D> for Weighted {
    #[inline(always)]
    fn new(tree: &View<D>, query: &Query) -> Self {
        let mut weighted = Self { few: [WeightedTerm::default(); FEW], count: 0, many: Vec::new() };
        weighted.set(tree, query);
        weighted
    }

    #[inline(always)]
    fn set(&mut self, tree: &View<D>, query: &Query) {
        let term = |(place, &dimension): (usize, &u32)| {
            let q = query.features[dimension as usize];
            let weight = query.weights.map_or(1.0, |weights| weights[dimension as usize]);
            (weight > 0.0).then_some(WeightedTerm { q, weight, place: place as u32 })
        };
        let terms = tree.order.iter().enumerate().filter_map(term);
        (self.count, self.many) = (0, Vec::new());
        if tree.dims() > FEW {
            self.many.extend(terms);
        } else {
            for term in terms {
                self.few[self.count] = term;
                self.count += 1;
            }
        }
    }

    #[inline(always)]
    fn bounds<K: Kernel<W>>(&mut self, kernel: K, tree: &View<D>, node: usize) -> K::Sums {
        // Two sums at a time, for one would wait for itself.
        let boxes = tree.node(node);
        let (pairs, last) = self.terms().as_chunks::<2>();
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
    fn may_reach<K: Kernel<W>>(&self, kernel: K, tree: &View<D>, leaf: usize, reach: f32) -> bool {
        let rows = tree.leaf(leaf);
        let mut sums = kernel.zero();
        for terms in self.terms().as_chunks::<STRIDE>().0 {
            for term in terms {
                let difference = kernel.difference(term.q, &rows[term.place as usize]);
                sums = kernel.add_weighted_squares(sums, term.weight, difference);
            }
            if kernel.at_most(sums, reach) == 0 {
                return false;
            }
        }
        true
    }

    #[inline(always)]
    fn costs<K: Kernel<W>>(kernel: K, query: &Query, places: &[u32], rows: &[Lanes<W>]) -> K::Sums {
        let Some(weights) = query.weights else {
            return <Even as Metric<D>>::costs(kernel, query, places, rows);
        };
        let mut costs = kernel.zero();
        for ((&q, &weight), &place) in query.features.iter().zip(weights).zip(places) {
            if weight > 0.0 {
                let difference = kernel.difference(q, &rows[place as usize]);
                costs = kernel.add_weighted_squares(costs, weight, difference);
            }
        }
        costs
    }

    #[inline(always)]
    fn fetch_node<K: Kernel<W>>(kernel: K, tree: &View<D>, node: usize) {
        kernel.fetch(tree.node(node));
    }

    #[inline(always)]
    fn fetch_leaf<K: Kernel<W>>(kernel: K, tree: &View<D>, leaf: usize) {
        kernel.fetch(&tree.leaf(leaf)[..tree.dims().min(2 * STRIDE)]);
    }
}
