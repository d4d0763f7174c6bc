//! The search itself, nearest subtree first, for any instruction set.
//!
//! A frame's cost sums the dimensions in their own order, and only that decides. What is ruled out before is ruled out
//! by sums in the order of the layout, of the same terms or of lower ones: rounding keeps order, so the difference to
//! the nearest point of a box is at most that to any frame in it. However n non-negative terms are rounded and summed,
//! the sums differ by less than a share of n/2^22; [`Probe::reach`] grants that share before anything is ruled out. So
//! whatever costs as little as the best is looked at, and the result is exact.

use super::best::Best;
use super::metric::{Metric, STRIDE};
use super::tree::{Edges, Lanes, Tree, View};
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

    /// What `q` is above the number of each of `W` frames.
    fn difference(self, q: f32, row: &Lanes<W>) -> Self::Sums;

    /// What `q` is above the nearest number between the edges of each of `W` boxes.
    fn gap(self, q: f32, edges: &Edges<W>) -> Self::Sums;

    /// Adds the squares of the differences; square and sum are each rounded to `f32`, not fused, for these are the
    /// costs.
    fn add_squares(self, sums: Self::Sums, difference: Self::Sums) -> Self::Sums;

    /// As [`Kernel::add_squares`], for ruling out only: square and sum may be fused.
    fn add_squares_fused(self, sums: Self::Sums, difference: Self::Sums) -> Self::Sums;

    /// Adds the squares of the differences times `weight`; square, product and sum are each rounded to `f32`.
    fn add_weighted_squares(self, sums: Self::Sums, weight: f32, difference: Self::Sums) -> Self::Sums;

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

/// Dimensions of a query that is put in the order of the layout without asking for memory.
const FEW_DIMS: usize = 64;

/// A query and how to lay it against a tree.
struct Probe<'a, const W: usize, K, M: Metric> {
    kernel: K,
    tree: &'a View<'a, W>,
    query: &'a Query<'a>,
    /// The query as the tree lays its dimensions out.
    laid_out: &'a [M::Term],
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
pub(super) fn search<const W: usize, K: Kernel<W>, M: Metric>(
    kernel: K,
    tree: &Tree<W>,
    query: &Query,
    best: &mut impl Best,
) {
    let tree = &tree.view();
    let dims = tree.dims();
    let (mut few, mut many) = ([M::Term::default(); FEW_DIMS], Vec::new());
    let laid_out = if dims <= FEW_DIMS {
        &mut few[..dims]
    } else {
        many.resize(dims, M::Term::default());
        &mut many[..]
    };
    let count = M::lay_out(query, tree.order, laid_out);
    // A term is rounded three times at most, and once more wherever it is added.
    let slack = 1.0 + 2.0 * (dims + 3) as f32 * f32::EPSILON;
    let probe = Probe::<W, K, M> { kernel, tree, query, laid_out: &laid_out[..count], slack };
    match (tree.frames.len(), tree.levels.count().checked_sub(1)) {
        (0, _) => {}
        (_, None) => probe.look_at_leaf(0, best),
        (_, Some(top)) => probe.descend(top, best),
    }
}

impl<const W: usize, K: Kernel<W>, M: Metric> Probe<'_, W, K, M> {
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
        let place = self.tree.place(level, node);
        let mut children = if self.tree.is_sound_node(place) { self.tree.children(level, node) } else { 0 };
        if self.query.tags != 0 {
            children &= carrying(&self.tree.node_tags[place], self.query.tags);
        }
        let mut open = Open { bounds: self.bounds(place), others: children, nearest: 0, bound: 0.0, node };
        self.advance(&mut open);
        open
    }

    /// Lower bounds of the costs in the boxes of a node, but for [`Probe::reach`]'s share.
    #[inline(always)]
    fn bounds(&self, place: usize) -> K::Sums {
        M::bounds(self.kernel, self.laid_out, self.tree.node(place))
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
            if best.cost > 0.0 || self.lowest(level, open.node)[lane] < best.frame {
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
            Some(below) => self.kernel.fetch(self.tree.node(self.tree.place(below, child))),
        }
    }

    #[inline(always)]
    fn lowest(&self, level: usize, node: usize) -> &[u32; W] {
        &self.tree.lowest[self.tree.place(level, node)]
    }

    #[inline(always)]
    fn look_at_leaf(&self, leaf: usize, best: &mut impl Best) {
        if !self.tree.is_sound_leaf(leaf) {
            return;
        }
        let rows = self.tree.leaf(leaf);
        if M::are_too_far(self.kernel, self.laid_out, rows, self.reach(best.bound().cost)) {
            return;
        }
        let costs = M::costs(self.kernel, self.query, self.tree.places, rows);
        let mut near = self.kernel.at_most(costs, best.bound().cost);
        while near != 0 {
            let (lane, cost) = self.kernel.lowest(costs, near);
            near &= !(1 << lane);
            let hit = Hit { frame: self.tree.frames[leaf][lane], cost };
            // What fills the last leaf costs infinitely much, unless nothing counts.
            let is_frame = hit.frame != u32::MAX;
            if is_frame && hit.beats(best.bound()) && self.query.admits(hit.frame, self.tree.tags[leaf][lane])
            {
                best.offer(hit);
                near &= self.kernel.at_most(costs, best.bound().cost);
            }
        }
    }
}

/// The bits of the lanes whose tags hold all that is asked.
fn carrying<const W: usize>(tags: &[u32; W], asked: u32) -> u32 {
    tags.iter().enumerate().fold(0, |bits, (lane, tags)| bits | u32::from(tags & asked == asked) << lane)
}
