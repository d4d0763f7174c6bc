//! The search itself, nearest subtree first, for any instruction set.
//!
//! A frame's cost sums the dimensions in their own order, and only that decides. What is ruled out before is ruled out
//! by sums in the order of the layout, of the same terms or of lower ones: rounding keeps order, so the difference to
//! the nearest point of a box is at most that to any frame in it. However n non-negative terms are rounded and summed,
//! the sums differ by less than a share of n/2^22; [`Probe::reach`] grants that share before anything is ruled out. So
//! whatever costs as little as the best is looked at, and the result is exact.

use super::best::Best;
use super::tree::{Edges, Lanes, Tree};
use super::{Hit, Query};

/// What an instruction set does with one number of each of `W` frames or boxes at once.
///
/// What is generic over this trait is inlined into a function that has the instructions; a closure handed to an
/// iterator would not be.
pub(super) trait Kernel<const W: usize>: Copy {
    /// `W` sums in one register.
    type Sums: Copy;

    /// Sums of nothing.
    fn zero(self) -> Self::Sums;

    /// Adds to each sum the squared difference between `q` and a frame's number; difference, product and sum are each
    /// rounded to `f32`, none fused, for these are the costs.
    fn add_costs(self, sums: Self::Sums, q: f32, row: &Lanes<W>) -> Self::Sums;

    /// As [`Kernel::add_costs`], for ruling out only: product and sum may be fused.
    fn add_distances(self, sums: Self::Sums, q: f32, row: &Lanes<W>) -> Self::Sums;

    /// Adds to each sum the squared difference between `q` and the nearest number between a box's edges; product and
    /// sum may be fused.
    fn add_bounds(self, sums: Self::Sums, q: f32, edges: &Edges<W>) -> Self::Sums;

    /// Sums of sums.
    fn add(self, a: Self::Sums, b: Self::Sums) -> Self::Sums;

    /// The bits of the sums at or below `limit`.
    fn at_most(self, sums: Self::Sums, limit: f32) -> u32;

    /// The lowest of the sums whose bits are in `among`, which is not 0, and where it stands; of equal ones the first.
    fn lowest(self, sums: Self::Sums, among: u32) -> (usize, f32);

    /// Begins to bring into the cache what is soon to be read.
    fn fetch<T>(self, block: &[T]);
}

/// Levels of the deepest tree: 2^32 frames, four to a node.
const MOST_LEVELS: usize = 16;

/// Dimensions summed between two looks at whether the frames of a leaf are already too far.
const STRIDE: usize = 8;

/// Dimensions of a query that is put in the order of the layout without asking for memory.
const FEW_DIMS: usize = 64;

/// A query and how to lay it against a tree.
struct Probe<'a, const W: usize, K> {
    kernel: K,
    tree: &'a Tree<W>,
    query: &'a Query<'a>,
    /// The query's features as the tree lays them out.
    laid_out: &'a [f32],
    /// 1 and more than the share by which sums of the same terms can differ.
    slack: f32,
}

/// The node that is open on one level, and which of its children are still to be looked at.
#[derive(Clone, Copy)]
struct Open<S> {
    bounds: S,
    /// The bits of the children after `nearest`.
    others: u32,
    nearest: usize,
    /// The bound of `nearest`; NaN, which is at most nothing, where no child is left.
    bound: f32,
    node: usize,
}

/// Offers `best` every admitted frame that may beat its bound.
#[inline(always)]
pub(super) fn search<const W: usize, K: Kernel<W>>(
    kernel: K,
    tree: &Tree<W>,
    query: &Query,
    best: &mut impl Best,
) {
    let dims = tree.dims();
    let (mut few, mut many) = ([0.0; FEW_DIMS], Vec::new());
    let laid_out = if dims <= FEW_DIMS {
        &mut few[..dims]
    } else {
        many.resize(dims, 0.0);
        &mut many[..]
    };
    laid_out.iter_mut().zip(&tree.order).for_each(|(q, &dimension)| *q = query.features[dimension as usize]);
    let slack = 1.0 + 2.0 * (dims + 2) as f32 * f32::EPSILON;
    let probe = Probe { kernel, tree, query, laid_out, slack };
    match (tree.frames.len(), tree.levels.len().checked_sub(1)) {
        (0, _) => {}
        (_, None) => probe.look_at_leaf(0, best),
        (_, Some(top)) => probe.descend(top, best),
    }
}

impl<const W: usize, K: Kernel<W>> Probe<'_, W, K> {
    /// What a sum in the order of the layout is not above where the cost is not above `cost`.
    #[inline(always)]
    fn reach(&self, cost: f32) -> f32 {
        // Products too small to keep their digits differ by no share of themselves, but by next to nothing.
        cost * self.slack + f32::MIN_POSITIVE
    }

    #[inline(always)]
    fn descend(&self, top: usize, best: &mut impl Best) {
        let closed = Open { bounds: self.kernel.zero(), others: 0, nearest: 0, bound: f32::NAN, node: 0 };
        let mut path = [closed; MOST_LEVELS];
        path[top] = self.open(top, 0);
        let mut level = top;
        loop {
            match self.next_child(level, &mut path[level], best.bound()) {
                Some(leaf) if level == 0 => self.look_at_leaf(leaf, best),
                Some(child) => {
                    level -= 1;
                    path[level] = self.open(level, child);
                }
                None if level == top => return,
                None => level += 1,
            }
        }
    }

    #[inline(always)]
    fn open(&self, level: usize, node: usize) -> Open<K::Sums> {
        let mut children = self.tree.children(level, node);
        if self.query.tags != 0 {
            children &= carrying(&self.tree.levels[level].tags[node], self.query.tags);
        }
        let mut open =
            Open { bounds: self.bounds(level, node), others: children, nearest: 0, bound: 0.0, node };
        self.advance(&mut open);
        open
    }

    /// Lower bounds of the costs in the boxes of a node, but for [`Probe::reach`]'s share.
    #[inline(always)]
    fn bounds(&self, level: usize, node: usize) -> K::Sums {
        let boxes = self.tree.node(level, node);
        // Two sums at a time, for one would wait for itself.
        let (pairs, last) = boxes.as_chunks::<2>();
        let (q_pairs, q_last) = self.laid_out.as_chunks::<2>();
        let (mut even, mut odd) = (self.kernel.zero(), self.kernel.zero());
        for (q, edges) in q_pairs.iter().zip(pairs) {
            even = self.kernel.add_bounds(even, q[0], &edges[0]);
            odd = self.kernel.add_bounds(odd, q[1], &edges[1]);
        }
        for (&q, edges) in q_last.iter().zip(last) {
            even = self.kernel.add_bounds(even, q, edges);
        }
        self.kernel.add(even, odd)
    }

    /// Makes the nearest of the other children the nearest.
    #[inline(always)]
    fn advance(&self, open: &mut Open<K::Sums>) {
        if open.others == 0 {
            open.bound = f32::NAN;
        } else {
            (open.nearest, open.bound) = self.kernel.lowest(open.bounds, open.others);
            open.others &= !(1 << open.nearest);
        }
    }

    /// Takes the nearest child that may hold a frame that beats `best`.
    #[inline(always)]
    fn next_child(&self, level: usize, open: &mut Open<K::Sums>, best: Hit) -> Option<usize> {
        let reach = self.reach(best.cost);
        while open.bound <= reach {
            let lane = open.nearest;
            self.advance(open);
            // Nothing costs less than nothing: then only a lower frame wins.
            if best.cost > 0.0 || self.tree.levels[level].lowest[open.node][lane] < best.frame {
                if open.bound <= reach {
                    self.fetch(level, open.node * W + open.nearest);
                }
                return Some(open.node * W + lane);
            }
        }
        None
    }

    /// Has the child that may be next on its way while its sibling is looked at.
    #[inline(always)]
    fn fetch(&self, level: usize, child: usize) {
        match level.checked_sub(1) {
            None => self.kernel.fetch(&self.tree.leaf(child)[..self.tree.dims().min(2 * STRIDE)]),
            Some(below) => self.kernel.fetch(self.tree.node(below, child)),
        }
    }

    #[inline(always)]
    fn look_at_leaf(&self, leaf: usize, best: &mut impl Best) {
        let rows = self.tree.leaf(leaf);
        if self.is_too_far(rows, best.bound().cost) {
            return;
        }
        let mut costs = self.kernel.zero();
        for (&q, &place) in self.query.features.iter().zip(&self.tree.places) {
            costs = self.kernel.add_costs(costs, q, &rows[place as usize]);
        }
        let mut near = self.kernel.at_most(costs, best.bound().cost);
        while near != 0 {
            let (lane, cost) = self.kernel.lowest(costs, near);
            near &= !(1 << lane);
            let hit = Hit { frame: self.tree.frames[leaf][lane], cost };
            if hit.beats(best.bound()) && self.query.admits(hit.frame, self.tree.tags[leaf][lane]) {
                best.offer(hit);
                near &= self.kernel.at_most(costs, best.bound().cost);
            }
        }
    }

    /// Whether some of the dimensions, the widest first, show that all frames of a leaf cost more than `best`.
    #[inline(always)]
    fn is_too_far(&self, rows: &[Lanes<W>], best: f32) -> bool {
        let reach = self.reach(best);
        let mut sums = self.kernel.zero();
        let (rows, _) = rows.as_chunks::<STRIDE>();
        let (laid_out, _) = self.laid_out.as_chunks::<STRIDE>();
        for (q, rows) in laid_out.iter().zip(rows) {
            for (&q, row) in q.iter().zip(rows) {
                sums = self.kernel.add_distances(sums, q, row);
            }
            if self.kernel.at_most(sums, reach) == 0 {
                return true;
            }
        }
        false
    }
}

/// The bits of the lanes whose tags hold all that is asked.
fn carrying<const W: usize>(tags: &[u32; W], asked: u32) -> u32 {
    tags.iter().enumerate().fold(0, |bits, (lane, tags)| bits | u32::from(tags & asked == asked) << lane)
}
