//! The order in which vertices are blended: within a window of the mesh those that follow the same joints come one
//! after the other, so that a register of them shares the joints' rows.

use std::ops::Range;

use super::sets::{Followed, Given, Influence, Pairs, pivot};

/// Vertices whose answers are held before they go out in the caller's order; their numbers fit in 16 bits.
pub(super) const WINDOW: usize = 4096;

/// Vertices of a block: as many as the widest register takes at a time.
pub(super) const WIDEST: usize = 16;

/// So many vertices of a set in a window are worth a block of their own; fewer are blended with those of other sets.
const WORTH_A_BLOCK: usize = 8;

/// All vertices, in runs.
#[derive(Debug, Clone, Default)]
pub(super) struct Arrangement {
    pub(super) runs: Vec<Run>,
    /// The runs of each window.
    pub(super) windows: Vec<Range<usize>>,
    /// Which vertex of its window each lane of each block holds.
    pub(super) places: Vec<[u16; WIDEST]>,
    /// What runs follow whose vertices follow the same.
    pub(super) shared: Followed<u32>,
    /// What each lane follows, for the other runs: for each block so many joints of each lane.
    pub(super) own: Followed<[u32; WIDEST]>,
    pub(super) pairs: Vec<[u32; 2]>,
    /// How many weights of a block there are.
    pub(super) weights: usize,
}

/// Vertices of a window, of the same number of influences, in blocks of their own.
#[derive(Debug, Clone)]
pub(super) struct Run {
    /// How many vertices there are; the lanes that the last block has to spare repeat the last vertex.
    pub(super) length: usize,
    /// How many influences each of them has.
    pub(super) influence_count: usize,
    /// The first block.
    pub(super) block: usize,
    /// The first of the blocks' weights, of which each block has `influence_count`.
    pub(super) weights: usize,
    pub(super) follows: Follows,
}

/// Which joints the vertices of a run follow.
#[derive(Debug, Clone, Copy)]
pub(super) enum Follows {
    /// All the same: where they begin in [`Arrangement::shared`].
    Same(usize),
    /// Each lane its own: where they begin in [`Arrangement::own`].
    Each(usize),
}

impl Run {
    /// How many blocks it has.
    pub(super) fn block_count(&self) -> usize {
        self.length.div_ceil(WIDEST)
    }
}

/// A vertex of a window. In order, those that follow the same joints lie together.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Member {
    influence_count: u32,
    /// Its joints, where they are [`IN_A_KEY`] at most; of more something that often differs where they do.
    key: u64,
    pivot: u16,
    place: u16,
}

/// Joints that a key has room for.
const IN_A_KEY: usize = 4;

impl Member {
    fn new(influences: &[Influence], place: u16) -> Self {
        Self {
            influence_count: influences.len() as u32,
            key: influences.iter().fold(0, |key: u64, i| key.rotate_left(16) ^ u64::from(i.joint)),
            pivot: pivot(influences) as u16,
            place,
        }
    }

    fn may_follow_as(&self, other: &Self) -> bool {
        let all = |member: &Self| (member.influence_count, member.key, member.pivot);
        all(self) == all(other)
    }
}

/// Arranges `vertex_count` vertices.
pub(super) fn arrange(vertex_count: usize, joint_count: usize, given: &Given<'_>) -> Arrangement {
    let mut arranging = Arranging {
        given,
        found: Arrangement::default(),
        pairs: Pairs::new(joint_count),
        influences: vec![],
    };
    for start in (0..vertex_count).step_by(WINDOW) {
        arranging.window(start..vertex_count.min(start + WINDOW));
    }
    Arrangement { pairs: arranging.pairs.pairs, ..arranging.found }
}

struct Arranging<'a> {
    given: &'a Given<'a>,
    found: Arrangement,
    pairs: Pairs,
    influences: Vec<Influence>,
}

impl Arranging<'_> {
    fn window(&mut self, vertices: Range<usize>) {
        let start = vertices.start;
        let mut members = Vec::with_capacity(vertices.len());
        for (vertex, place) in vertices.zip(0..) {
            self.given.influences(vertex, &mut self.influences);
            members.push(Member::new(&self.influences, place));
        }
        members.sort_unstable();
        let first = self.found.runs.len();
        for members in members.chunk_by(|a, b| a.influence_count == b.influence_count) {
            self.add_runs(start, members);
        }
        self.found.windows.push(first..self.found.runs.len());
    }

    /// The runs of vertices that have the same number of influences.
    fn add_runs(&mut self, start: usize, members: &[Member]) {
        let mut rest = vec![];
        let mut joints = vec![];
        for alike in members.chunk_by(Member::may_follow_as) {
            let spare = alike.len() % WIDEST;
            let own = if spare < WORTH_A_BLOCK { spare } else { 0 };
            let (alike, own) = alike.split_at(alike.len() - own);
            rest.extend_from_slice(own);
            for alike in self.told_apart(start, alike) {
                let follows = Follows::Same(self.found.shared.joints.len());
                self.joints(start, alike[0], &mut joints);
                self.found.shared.add(&joints, alike[0].pivot.into(), &mut self.pairs);
                self.found.add(alike, follows);
            }
        }
        if rest.is_empty() {
            return;
        }
        // What is written one after the other is written fastest.
        rest.sort_unstable_by_key(|member| member.place);
        let mut followed = Followed::default();
        for member in &rest {
            self.joints(start, *member, &mut joints);
            followed.add(&joints, member.pivot.into(), &mut self.pairs);
        }
        self.found.add(&rest, Follows::Each(self.found.own.joints.len()));
        self.found.own.joints.extend(lanes(&followed.joints, joints.len()));
        self.found.own.paired.extend(lanes(&followed.paired, joints.len()));
    }

    /// Members of one key: runs of those that follow the same joints.
    fn told_apart<'m>(&self, start: usize, members: &'m [Member]) -> Vec<&'m [Member]> {
        let (mut first, mut second) = (vec![], vec![]);
        let mut is_same = |a: &Member, b: &Member| {
            if a.influence_count as usize <= IN_A_KEY {
                return true;
            }
            self.given.influences(start + usize::from(a.place), &mut first);
            self.given.influences(start + usize::from(b.place), &mut second);
            first.iter().map(|i| i.joint).eq(second.iter().map(|i| i.joint))
        };
        members.chunk_by(|a, b| is_same(a, b)).collect()
    }

    /// The joints of a vertex.
    fn joints(&mut self, start: usize, member: Member, found: &mut Vec<u32>) {
        let count = member.influence_count as usize;
        found.clear();
        if count <= IN_A_KEY {
            found.extend((0..count).rev().map(|k| u32::from((member.key >> (16 * k)) as u16)));
        } else {
            self.given.influences(start + usize::from(member.place), &mut self.influences);
            found.extend(self.influences.iter().map(|influence| influence.joint));
        }
    }
}

impl Arrangement {
    fn add(&mut self, members: &[Member], follows: Follows) {
        let influence_count = members[0].influence_count as usize;
        let (block, weights) = (self.places.len(), self.weights);
        self.runs.push(Run { length: members.len(), influence_count, block, weights, follows });
        let places: Vec<u16> = members.iter().map(|member| member.place).collect();
        self.places.extend(blocks(&places));
        self.weights += influence_count * (self.places.len() - block);
    }
}

/// For each block the first of `count` numbers of each item, then their second and so on.
fn lanes(numbers: &[u32], count: usize) -> impl Iterator<Item = [u32; WIDEST]> {
    let items: Vec<&[u32]> = numbers.chunks(count).collect();
    let items = blocks(&items).collect::<Vec<_>>();
    items.into_iter().flat_map(move |block| (0..count).map(move |k| block.map(|numbers| numbers[k])))
}

/// Whole blocks; the last item fills the last one.
fn blocks<T: Copy>(items: &[T]) -> impl Iterator<Item = [T; WIDEST]> {
    items.chunks(WIDEST).map(|block| std::array::from_fn(|lane| block[lane.min(block.len() - 1)]))
}
