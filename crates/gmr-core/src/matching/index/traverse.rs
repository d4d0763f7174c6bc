//! The search itself, nearest subtree first, for any instruction set.
//!
//! A frame's cost sums the dimensions in their own order, and only that decides. What is ruled out before is ruled out
//! by lower bounds whose sums run otherwise: however n non-negative terms are rounded and summed, the sums differ by less
//! than a share of n/2^22; [`Descent::reach`] grants that share before anything is ruled out. So whatever costs as
//! little as the best is looked at, and the result is exact.
//!
//! A search of many frames mostly waits for memory. So a descent goes in steps, each of which reads one block and has
//! the next one on its way; several descents take turns, and each finds its block when it comes to it. One that is alone
//! has all children on their way that it may come to.

use super::Hit;
use super::Query;
use super::best::Best;
use super::kernel::Kernel;
use super::layout::W;
use super::metric::Metric;
use super::tree::{View, Width};

/// Levels of the deepest tree: 2^32 frames, eight to a leaf and to a node.
const MOST_LEVELS: usize = 10;

/// Descents that take turns: enough for memory to keep up, few enough for their own numbers to stay at hand.
const IN_FLIGHT: usize = 6;

/// What a descent reads next.
#[derive(Clone, Copy)]
enum Next {
    Node {
        level: usize,
        node: usize,
    },
    /// What rules out leaves of the node that is open on the lowest level.
    Leaves,
    /// The rows of a leaf.
    Rows(usize),
    Nothing,
}

/// The node that is open on one level, and which of its children are still to be looked at.
#[derive(Clone, Copy)]
struct Open<S> {
    bounds: S,
    /// The bits of the children still to be looked at.
    left: u32,
    /// Whether none has been looked at.
    is_new: bool,
    node: usize,
}

/// One query on its way through a tree; `ALONE` where no other takes turns with it.
pub(super) struct Descent<'a, K: Kernel<W>, D, M, B, const ALONE: bool> {
    kernel: K,
    tree: View<'a, D>,
    query: Query<'a>,
    metric: M,
    best: B,
    /// 1 and more than the share by which sums of the same terms can differ.
    slack: f32,
    path: [Open<K::Sums>; MOST_LEVELS],
    level: usize,
    next: Next,
}

/// Offers every admitted frame that may beat the bound of the query's best to it.
#[inline(always)]
pub(super) fn search<'a, K: Kernel<W>, D: Width, M: Metric<D>, B: Best>(
    kernel: K,
    tree: View<'a, D>,
    query: Query<'a>,
    best: B,
) -> B {
    let mut descent = Descent::<K, D, M, B, true>::new(kernel, tree, query, best);
    while descent.step() {}
    descent.best
}

/// As [`search`], for one query after the other; finishes what is best for each.
#[inline(always)]
pub(super) fn search_all<'a, K: Kernel<W>, D: Width, M: Metric<D>, B: Best>(
    kernel: K,
    tree: View<'a, D>,
    mut asked: impl Iterator<Item = (Query<'a>, B)>,
) {
    let begin = |(query, best)| Descent::<K, D, M, B, false>::new(kernel, tree, query, best);
    let mut descents: Vec<_> = asked.by_ref().take(IN_FLIGHT).map(begin).collect();
    while !descents.is_empty() {
        let mut turn = 0;
        while turn < descents.len() {
            if descents[turn].step() {
                turn += 1;
                continue;
            }
            let best = match asked.next() {
                Some((query, best)) => descents[turn].begin(query, best),
                None => descents.swap_remove(turn).best,
            };
            best.finish();
        }
    }
}

impl<'a, K: Kernel<W>, D: Width, M: Metric<D>, B: Best, const ALONE: bool> Descent<'a, K, D, M, B, ALONE> {
    #[inline(always)]
    fn new(kernel: K, tree: View<'a, D>, query: Query<'a>, best: B) -> Self {
        // A term is rounded three times at most, and once more wherever it is added.
        let slack = 1.0 + 2.0 * (tree.dims() + 3) as f32 * f32::EPSILON;
        let closed = Open { bounds: kernel.zero(), left: 0, is_new: false, node: 0 };
        let (level, next) = start(&tree);
        let metric = M::new(&tree, &query);
        Self { kernel, tree, query, metric, best, slack, path: [closed; MOST_LEVELS], level, next }
    }

    /// Begins anew with another query; what is best for the one before is given back.
    #[inline(always)]
    fn begin(&mut self, query: Query<'a>, best: B) -> B {
        (self.level, self.next) = start(&self.tree);
        self.metric.set(&self.tree, &query);
        self.query = query;
        std::mem::replace(&mut self.best, best)
    }

    /// Reads what is next and has on its way what comes after it; false where there was nothing.
    #[inline(always)]
    fn step(&mut self) -> bool {
        let below = match self.next {
            Next::Node { level, node } => {
                self.open(level, node);
                if level == 0 { self.choose_leaves() } else { None }
            }
            Next::Leaves => self.rule_out_leaves(),
            Next::Rows(leaf) => {
                self.look_at_rows(leaf);
                self.choose_leaves()
            }
            Next::Nothing => return false,
        };
        self.next = match below {
            Some(next) => next,
            None => self.choose_node(),
        };
        true
    }

    /// What a lower bound is not above where the cost is not above that of the best.
    #[inline(always)]
    fn reach(&self) -> f32 {
        // Products too small to keep their digits differ by no share of themselves, but by next to nothing.
        self.best.bound().cost * self.slack + f32::MIN_POSITIVE
    }

    #[inline(always)]
    fn open(&mut self, level: usize, node: usize) {
        let place = self.tree.place(level, node);
        self.level = level;
        if !self.tree.is_sound_node(place) {
            // What its numbers would come to nobody knows.
            self.path[level] = Open { bounds: self.kernel.zero(), left: 0, is_new: true, node };
            return;
        }
        let mut left = self.tree.children(level, node);
        if self.query.tags != 0 {
            left &= carrying(&self.tree.node_tags[place], self.query.tags);
        }
        let bounds = self.metric.bounds(self.kernel, &self.tree, place);
        if ALONE && level > 0 {
            let mut near = self.kernel.at_most(bounds, self.reach()) & left;
            while near != 0 {
                self.fetch_node(level - 1, node * W + near.trailing_zeros() as usize);
                near &= near - 1;
            }
        }
        self.path[level] = Open { bounds, left, is_new: true, node };
    }

    /// What to read of the leaves below the open node that may hold a frame that beats the best. Where there is none to
    /// beat yet, nothing could be ruled out: then the rows of the nearest.
    #[inline(always)]
    fn choose_leaves(&mut self) -> Option<Next> {
        let (best, reach) = (self.best.bound().cost, self.reach());
        let Open { bounds, left, node, .. } = self.path[0];
        let near = self.kernel.at_most(bounds, reach) & left;
        self.path[0].left = near;
        if near == 0 {
            return None;
        }
        if best == f32::INFINITY {
            let (lane, _) = self.kernel.lowest(bounds, near);
            self.path[0].left = near & !(1 << lane);
            return Some(self.choose_rows(node * W + lane));
        }
        let mut lanes = near;
        while lanes != 0 {
            M::fetch_leaf(self.kernel, &self.tree, node * W + lanes.trailing_zeros() as usize);
            lanes &= lanes - 1;
        }
        Some(Next::Leaves)
    }

    /// The rows of the first leaf that is not ruled out, of those that were chosen.
    #[inline(always)]
    fn rule_out_leaves(&mut self) -> Option<Next> {
        let reach = self.reach();
        let Open { left: mut lanes, node, .. } = self.path[0];
        while lanes != 0 {
            let leaf = node * W + lanes.trailing_zeros() as usize;
            lanes &= lanes - 1;
            if self.tree.is_sound_leaf(leaf) && self.metric.may_reach(self.kernel, &self.tree, leaf, reach) {
                self.path[0].left = lanes;
                return Some(self.choose_rows(leaf));
            }
        }
        self.path[0].left = 0;
        None
    }

    #[inline(always)]
    fn choose_rows(&self, leaf: usize) -> Next {
        self.kernel.fetch(self.tree.leaf(leaf));
        self.kernel.fetch(&self.tree.frames[leaf]);
        Next::Rows(leaf)
    }

    /// A child that may hold a frame that beats the best, of the lowest open node that has one: at first the nearest.
    /// Then little is left to win by an order.
    #[inline(always)]
    fn choose_node(&mut self) -> Next {
        let (best, reach) = (self.best.bound(), self.reach());
        let mut level = self.level.max(1);
        while level < self.tree.levels.count() {
            let open = &mut self.path[level];
            let near = self.kernel.at_most(open.bounds, reach) & open.left;
            if near == 0 {
                level += 1;
                continue;
            }
            let lane = if open.is_new {
                self.kernel.lowest(open.bounds, near).0
            } else {
                near.trailing_zeros() as usize
            };
            let node = open.node;
            (open.left, open.is_new) = (near & !(1 << lane), false);
            // Nothing costs less than nothing: then only a lower frame wins.
            if best.cost > 0.0 || self.tree.lowest[self.tree.place(level, node)][lane] < best.frame {
                let (level, node) = (level - 1, node * W + lane);
                if !ALONE {
                    self.fetch_node(level, node);
                }
                return Next::Node { level, node };
            }
        }
        Next::Nothing
    }

    /// Begins to bring a node into the cache.
    #[inline(always)]
    fn fetch_node(&self, level: usize, node: usize) {
        M::fetch_node(self.kernel, &self.tree, self.tree.place(level, node));
    }

    #[inline(always)]
    fn look_at_rows(&mut self, leaf: usize) {
        if !self.tree.is_sound_leaf(leaf) {
            return;
        }
        let costs = M::costs(self.kernel, &self.query, self.tree.places, self.tree.leaf(leaf));
        let mut near = self.kernel.at_most(costs, self.best.bound().cost);
        while near != 0 {
            let (lane, cost) = self.kernel.lowest(costs, near);
            near &= !(1 << lane);
            let hit = Hit { frame: self.tree.frames[leaf][lane], cost };
            // What fills the last leaf costs infinitely much, unless nothing counts.
            let is_frame = hit.frame != u32::MAX;
            // A query that asks for no tags does not wait for them.
            let tags = if self.query.tags == 0 { 0 } else { self.tree.tags[leaf][lane] };
            if is_frame && hit.beats(self.best.bound()) && self.query.admits(hit.frame, tags) {
                self.best.offer(hit);
                near &= self.kernel.at_most(costs, self.best.bound().cost);
            }
        }
    }
}

/// The level of the root, and what is read first.
#[inline(always)]
fn start(tree: &View<'_, impl Width>) -> (usize, Next) {
    match (tree.frames.len(), tree.levels.count().checked_sub(1)) {
        (0, _) => (0, Next::Nothing),
        (_, None) => (0, Next::Rows(0)),
        (_, Some(top)) => (top, Next::Node { level: top, node: 0 }),
    }
}

/// The bits of the lanes whose tags hold all that is asked.
fn carrying(tags: &[u32; W], asked: u32) -> u32 {
    tags.iter().enumerate().fold(0, |bits, (lane, tags)| bits | u32::from(tags & asked == asked) << lane)
}
