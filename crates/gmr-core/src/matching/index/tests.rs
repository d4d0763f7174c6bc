use proptest::prelude::*;

use super::*;

/// Xorshift: the same numbers on every machine.
pub(super) struct Random(pub(super) u32);

impl Random {
    pub(super) fn below(&mut self, count: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0 % count.max(1)
    }

    fn unit(&mut self) -> f32 {
        self.below(1 << 24) as f32 / (1 << 23) as f32 - 1.0
    }
}

/// What the numbers of a database are like.
#[derive(Debug, Clone, Copy)]
pub(super) enum Kind {
    /// Small whole numbers: many equal rows, many equal costs, and no rounding.
    Whole,
    /// Every row the same.
    Constant,
    /// A walk, as motion is.
    Walk,
    /// From numbers whose squares vanish to numbers whose squares overflow.
    Extreme,
    /// As large as numbers get: most costs overflow, and so would coordinates.
    Huge,
    /// Squares of a few times the least number there is, or of half of it.
    Tiny,
    /// As different as can be from dimension to dimension.
    Skewed,
}

pub(super) const KINDS: [Kind; 7] =
    [Kind::Whole, Kind::Constant, Kind::Walk, Kind::Extreme, Kind::Huge, Kind::Tiny, Kind::Skewed];

impl Kind {
    fn rows(self, count: usize, dims: usize, random: &mut Random) -> Vec<f32> {
        let mut walk = vec![0.0; dims];
        let number = |(i, at): (usize, &mut f32)| match self {
            Kind::Whole => random.below(3) as f32,
            Kind::Constant => 0.3,
            Kind::Walk => {
                *at += 0.1 * random.unit();
                *at
            }
            Kind::Extreme => random.unit() * 10.0_f32.powi(random.below(60) as i32 - 30),
            Kind::Huge if random.below(4) == 0 => random.unit(),
            Kind::Huge => random.unit() * 10.0_f32.powi(random.below(23) as i32 + 16),
            Kind::Tiny => [0.0, 1.0, 1.5, 3.0][random.below(4) as usize] * 2.0_f32.powi(-75),
            Kind::Skewed => random.unit() * 10.0_f32.powi((i % 7) as i32 - 3),
        };
        let mut number = number;
        (0..count).flat_map(|_| walk.iter_mut().enumerate().map(&mut number).collect::<Vec<_>>()).collect()
    }
}

/// A database with its indices for every instruction set of this machine.
pub(super) struct Case {
    pub(super) dims: usize,
    pub(super) features: Vec<f32>,
    pub(super) candidates: Vec<bool>,
    pub(super) tags: Vec<u32>,
    pub(super) indices: Vec<Index>,
}

impl Case {
    pub(super) fn new(kind: Kind, count: usize, dims: usize, random: &mut Random) -> Self {
        let features = kind.rows(count, dims, random);
        let candidates: Vec<bool> = (0..count).map(|_| random.below(8) != 0).collect();
        let tags: Vec<u32> = (0..count).map(|_| random.below(8)).collect();
        let build = |isa| Index::build_for(isa, &features, dims, &candidates, Some(&tags), 1).unwrap();
        let indices = Isa::available().map(build).collect();
        Self { dims, features, candidates, tags, indices }
    }

    /// A frame moved a little, exactly a frame, or a mix of two.
    pub(super) fn query_features(&self, random: &mut Random) -> Vec<f32> {
        let count = self.candidates.len() as u32;
        if count == 0 {
            return vec![1.0; self.dims];
        }
        let mut row = || &self.features[random.below(count) as usize * self.dims..][..self.dims];
        let (one, other) = (row(), row());
        match random.below(3) {
            0 => one.to_vec(),
            1 => one.iter().map(|x| x * (1.0 + 0.01 * random.unit())).collect(),
            _ => one.iter().zip(other).map(|(a, b)| if random.below(2) == 0 { *a } else { *b }).collect(),
        }
    }

    /// None, or weights that are all 1, all 0, of everyday size, or of all sizes.
    pub(super) fn weights(&self, random: &mut Random) -> Option<Vec<f32>> {
        let kind = random.below(6);
        let weight = |_| match kind {
            0 => 1.0,
            1 => 0.0,
            2 => (random.below(4) as f32 - 1.0).max(0.0),
            3 => random.below(1 << 20) as f32 * 10.0_f32.powi(random.below(60) as i32 - 33),
            _ => 0.01 * random.below(300) as f32,
        };
        (kind < 5).then(|| (0..self.dims).map(weight).collect())
    }

    /// Asks every index in every way, and holds the answers against brute force.
    pub(super) fn check(&self, random: &mut Random) {
        self.check_weighted(None, random);
        let weights = self.weights(random);
        self.check_weighted(weights.as_deref(), random);
    }

    fn check_weighted(&self, weights: Option<&[f32]>, random: &mut Random) {
        let count = self.candidates.len() as u32;
        let features = self.query_features(random);
        let from = random.below(count);
        let mut query = Query {
            features: &features,
            weights,
            tags: if random.below(2) == 0 { 0 } else { random.below(8) },
            exclude: from..from + random.below(41),
            max_cost: f32::INFINITY,
        };
        let k = random.below(20) as usize;
        let brute =
            |query: &Query| brute_force::search(&self.features, &self.candidates, Some(&self.tags), query);
        let ranked = brute_force::search_top(&self.features, &self.candidates, Some(&self.tags), &query, k);
        let best = brute(&query);
        let start = Hit {
            frame: random.below(count),
            cost: best.map_or(1.0, |hit| hit.cost * random.below(3) as f32),
        };
        query.max_cost = best.map_or(0.0, |hit| hit.cost);
        let below_best = brute(&query);
        for index in &self.indices {
            query.max_cost = f32::INFINITY;
            assert_eq!(index.search(&query).unwrap(), best);
            let mut hits = vec![Hit { frame: 7, cost: 7.0 }; k];
            let found = index.search_top(&query, &mut hits).unwrap();
            assert_eq!(hits[..found], ranked[..]);
            assert!(hits[found..].iter().all(|hit| *hit == Hit::NONE));
            let better = best.filter(|hit| hit.beats(start)).unwrap_or(start);
            assert_eq!(index.search_from(&query, start).unwrap(), better);
            query.max_cost = best.map_or(0.0, |hit| hit.cost);
            assert_eq!(index.search(&query).unwrap(), below_best);
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, ..ProptestConfig::default() })]

    /// 400 databases of 30 queries: 12,000, each asked in four ways on every instruction set.
    #[test]
    fn every_instruction_set_finds_what_brute_force_finds(
        kind in proptest::sample::select(&KINDS),
        count in 0_usize..700,
        dims in prop_oneof![4 => 1_usize..70, 1 => Just(USUAL_DIMS)],
        seed in 1_u32..,
    ) {
        let mut random = Random(seed);
        let case = Case::new(kind, count, dims, &mut random);
        (0..30).for_each(|_| case.check(&mut random));
    }
}

/// Holds every bound on every box and every leaf against the costs below it, so that no luck in the order of a search
/// can hide one that is too high, and every bound on a box against the definition's.
struct Bounds<'a> {
    tree: &'a View<'a>,
    query: Query<'a>,
    rows: &'a [f32],
}

impl Work for Bounds<'_> {
    type Done = Result<(), TestCaseError>;

    fn run<K: Kernel<W>>(self, kernel: K) -> Self::Done {
        let Self { tree, query, rows } = self;
        let dims = tree.dims();
        let cost = |frame: u32| query.cost_of(&rows[frame as usize * dims..][..dims]);
        let least = |leaves: Range<usize>| {
            let frames = tree.frames[leaves].as_flattened().iter().filter(|&&frame| frame != u32::MAX);
            frames.map(|&frame| cost(frame)).fold(f32::INFINITY, f32::min)
        };
        let reach = |cost: f32| cost * (1.0 + 2.0 * (dims + 3) as f32 * f32::EPSILON) + f32::MIN_POSITIVE;
        let (mut even, mut defined) = (Even::new(tree, &query), Even::new(tree, &query));
        for level in 0..tree.levels.count() {
            let leaves = W.pow(level as u32);
            for node in 0..tree.levels.nodes(level).len() {
                let bounds = even.bounds(kernel, tree, tree.place(level, node));
                let defined = defined.bounds(scalar::Scalar, tree, tree.place(level, node));
                for limit in defined {
                    let alike = Kernel::<W>::at_most(scalar::Scalar, defined, limit);
                    prop_assert_eq!(kernel.at_most(bounds, limit), alike);
                }
                for (lane, child) in (node * W..tree.levels.below(level)).take(W).enumerate() {
                    let below = child * leaves..((child + 1) * leaves).min(tree.frames.len());
                    let least = least(below);
                    let is_near = kernel.at_most(bounds, reach(least)) >> lane & 1 == 1;
                    prop_assert!(is_near, "{} is above {least}", defined[lane]);
                    let reached = level > 0 || even.may_reach(kernel, tree, child, reach(least));
                    prop_assert!(reached, "a leaf is ruled out that holds a cost of {least}");
                }
            }
        }
        Ok(())
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn what_rules_out_is_never_above_a_cost(
        kind in proptest::sample::select(&KINDS),
        count in 9_usize..700,
        dims in 1_usize..70,
        seed in 1_u32..,
    ) {
        let mut random = Random(seed);
        let case = Case::new(kind, count, dims, &mut random);
        for _ in 0..5 {
            let features = case.query_features(&mut random);
            for index in &case.indices {
                let (tree, query) = (&index.tree.view(), Query::new(&features));
                index.kernels.run(Bounds { tree, query, rows: &case.features })?;
            }
        }
    }
}

#[test]
fn deep_trees_find_what_brute_force_finds() {
    let mut random = Random(1);
    for kind in KINDS {
        let case = Case::new(kind, 20_000, 5, &mut random);
        (0..40).for_each(|_| case.check(&mut random));
    }
}

#[test]
fn many_dimensions_find_what_brute_force_finds() {
    let mut random = Random(1);
    for kind in KINDS {
        let case = Case::new(kind, 300, 400, &mut random);
        (0..20).for_each(|_| case.check(&mut random));
    }
}

#[test]
fn equal_rows_yield_the_lowest_candidate() {
    let mut candidates = vec![true; 100_000];
    candidates[..17].fill(false);
    for isa in Isa::available() {
        let index = Index::build_for(isa, &vec![0.3; 300_000], 3, &candidates, None, 1).unwrap();
        for q in [0.3, 0.1] {
            let hit = index.search(&Query::new(&[q; 3])).unwrap().unwrap();
            assert_eq!(hit.frame, 17);
            assert_eq!(hit.cost.to_bits(), brute_force::cost(&[q; 3], &[0.3; 3]).to_bits());
        }
    }
}

#[test]
fn a_batch_has_the_bits_of_single_queries_whatever_the_thread_count() {
    let mut random = Random(3);
    let case = Case::new(Kind::Walk, 5000, 27, &mut random);
    let queries: Vec<f32> = (0..300).flat_map(|_| case.query_features(&mut random)).collect();
    let tags: Vec<u32> = (0..300).map(|i| i % 3).collect();
    let exclude: Vec<Range<u32>> = (0..300).map(|i| i..i + 40).collect();
    let one = vec![0.5; 27];
    let each: Vec<f32> = (0..300 * 27).map(|_| random.below(4) as f32).collect();
    for (index, weights) in case.indices.iter().zip([None, Some(&one), Some(&each)].into_iter().cycle()) {
        for threads in [1, 2, 5] {
            let batch = Batch {
                queries: &queries,
                weights: weights.map(Vec::as_slice),
                count: 300,
                tags: &tags,
                exclude: Some(&exclude),
                max_cost: 9.0,
                threads,
            };
            let mut hits = vec![Hit::NONE; 300 * 3];
            index.search_batch(&batch, 3, &mut hits, || true).unwrap();
            for (i, hits) in hits.chunks(3).enumerate() {
                let features = &queries[i * 27..][..27];
                let weights = weights.map(|rows| &rows[if rows.len() == 27 { 0 } else { i * 27 }..][..27]);
                let (tags, exclude) = (tags[i], exclude[i].clone());
                let query = Query { features, weights, tags, exclude, max_cost: 9.0 };
                let mut single = [Hit::NONE; 3];
                index.search_top(&query, &mut single).unwrap();
                assert_eq!(hits, single);
            }
        }
    }
}

/// All that an index holds, as bits.
fn bits(index: &Index) -> Vec<Vec<u32>> {
    let tree = index.tree.view();
    let floats = |numbers: &[f32]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<u32>>();
    let turn = tree.axes.turn.iter().chain(&tree.axes.mean);
    vec![
        tree.order.to_vec(),
        turn.flat_map(|x| [x.to_bits() as u32, (x.to_bits() >> 32) as u32]).collect(),
        tree.frames.as_flattened().to_vec(),
        tree.tags.as_flattened().to_vec(),
        tree.lowest.as_flattened().to_vec(),
        tree.node_tags.as_flattened().to_vec(),
        floats(tree.rows),
        tree.boxes.to_vec(),
        floats(tree.grids),
        tree.node_codes.iter().chain(tree.leaf_codes).map(|&code| code.into()).collect(),
    ]
}

#[test]
fn an_index_has_the_same_bits_whatever_the_instruction_set_and_the_thread_count() {
    let mut random = Random(7);
    for (count, dims) in [(0, 3), (7, 27), (9, 1), (65, 8), (40_000, 27), (20_000, 3), (9000, 130)] {
        let case = Case::new(Kind::Walk, count, dims, &mut random);
        let expected = bits(&case.indices[0]);
        for (isa, alone) in Isa::available().zip(&case.indices) {
            assert!(bits(alone) == expected, "{count} x {dims}, {isa}");
            for threads in [0, 2, 3, 7] {
                let (candidates, tags) = (&case.candidates, Some(&case.tags[..]));
                let index = Index::build_for(isa, &case.features, dims, candidates, tags, threads).unwrap();
                assert!(bits(&index) == expected, "{count} x {dims}, {isa}, {threads} threads");
                index.check(&case.features, candidates, &case.tags).unwrap();
            }
        }
    }
}

#[test]
fn a_batch_that_is_stopped_answers_nothing_more() {
    let index = Index::build(&[1.0, 2.0], 1, &[true; 2], None, 1).unwrap();
    let batch = Batch {
        queries: &[1.0],
        weights: None,
        count: 1,
        tags: &[0],
        exclude: None,
        max_cost: 9.0,
        threads: 1,
    };
    let mut hits = [Hit::NONE];
    index.search_batch(&batch, 1, &mut hits, || false).unwrap();
    assert_eq!(hits, [Hit::NONE]);
}

#[test]
fn what_cannot_be_indexed_is_refused_in_words() {
    let refusal = |features: &[f32], dims, candidates: &[bool], tags: Option<&[u32]>| {
        Index::build(features, dims, candidates, tags, 1).unwrap_err().to_string()
    };
    assert!(refusal(&[], 0, &[], None).contains("0 dimensions"));
    assert!(refusal(&[1.0; 5], 2, &[true; 2], None).contains("features holds 5 elements where 4 are needed"));
    assert!(
        refusal(&[1.0; 6], 2, &[true; 2], None).contains("candidates holds 2 elements where 3 are needed")
    );
    assert!(refusal(&[1.0; 6], 2, &[true; 3], Some(&[0])).contains("tags holds 1"));
    let mut features = [1.0; 6];
    features[3] = f32::NAN;
    assert!(refusal(&features, 2, &[true; 3], None).contains("feature 1 of frame 1 is NaN"));
    features[3] = f32::INFINITY;
    assert!(refusal(&features, 2, &[true; 3], None).contains("feature 1 of frame 1 is inf"));
    assert!(
        Index::build(&features, 2, &[true, false, true], None, 1).is_ok(),
        "what is no candidate may be anything"
    );
}

#[test]
fn what_cannot_be_asked_is_refused_in_words() {
    let index = Index::build(&[1.0, 2.0], 2, &[true], None, 1).unwrap();
    let refusal = |query: &Query| index.search(query).unwrap_err().to_string();
    assert!(refusal(&Query::new(&[1.0])).contains("query features holds 1 elements where 2 are needed"));
    assert!(refusal(&Query::new(&[1.0, f32::NAN])).contains("feature 1 of query 0 is NaN"));
    assert!(refusal(&Query { max_cost: f32::NAN, ..Query::new(&[1.0, 2.0]) }).contains("NaN"));
    let start = Hit { frame: 0, cost: f32::NAN };
    assert!(index.search_from(&Query::new(&[1.0, 2.0]), start).is_err());
    let queries = [1.0, 2.0, 3.0, f32::INFINITY];
    let batch = Batch {
        queries: &queries,
        weights: None,
        count: 2,
        tags: &[0],
        exclude: None,
        max_cost: 1.0,
        threads: 1,
    };
    let refusal_of =
        |batch: &Batch| index.search_batch(batch, 1, &mut [Hit::NONE; 2], || true).unwrap_err().to_string();
    assert!(refusal_of(&batch).contains("feature 1 of query 1 is inf"));
    let finite = Batch { queries: &[0.0; 4], ..batch };
    let refusal_of_weights =
        |weights: &[f32]| refusal_of(&Batch { weights: Some(weights), ..finite.clone() });
    assert!(refusal_of_weights(&[1.0, 1.0, 1.0, -0.5]).contains("weight 1 of query 1 is -0.5"));
    assert!(refusal_of_weights(&[1.0, f32::NAN]).contains("weight 1 of query 0 is NaN"));
    assert!(refusal_of_weights(&[1.0; 3]).contains("weights holds 3 elements where 4 are needed"));
}

#[test]
fn an_instruction_set_of_another_machine_is_refused() {
    let other = Isa::ALL.into_iter().find(|isa| !isa.is_available()).unwrap();
    let error = Index::build_for(other, &[1.0], 1, &[true], None, 1).unwrap_err();
    assert!(error.to_string().contains(other.name()));
}

#[test]
fn weights_of_one_change_no_bit() {
    let mut random = Random(5);
    let case = Case::new(Kind::Skewed, 3000, 27, &mut random);
    for _ in 0..50 {
        let features = case.query_features(&mut random);
        let even = Query::new(&features);
        let ones = Query { weights: Some(&[1.0; 27]), ..even.clone() };
        for index in &case.indices {
            assert_eq!(index.search(&even), index.search(&ones));
        }
    }
}

#[test]
fn a_dimension_of_no_weight_says_nothing() {
    let mut random = Random(6);
    let case = Case::new(Kind::Walk, 3000, 6, &mut random);
    let narrow: Vec<f32> = case.features.chunks_exact(6).flat_map(|row| row[..4].to_vec()).collect();
    let narrow = Index::build(&narrow, 4, &case.candidates, Some(&case.tags), 1).unwrap();
    for _ in 0..50 {
        let features = case.query_features(&mut random);
        let pose_only = Query { weights: Some(&[1.0, 1.0, 1.0, 1.0, 0.0, 0.0]), ..Query::new(&features) };
        let expected = narrow.search(&Query::new(&features[..4]));
        for index in &case.indices {
            assert_eq!(index.search(&pose_only), expected);
        }
    }
}

#[test]
fn where_nothing_counts_the_lowest_frame_is_found() {
    for isa in Isa::available() {
        let index = Index::build_for(isa, &[1.0; 19], 1, &[true; 19], None, 1).unwrap();
        let nothing = Query { weights: Some(&[0.0]), ..Query::new(&[5.0]) };
        let mut hits = [Hit::NONE; 25];
        assert_eq!(index.search_top(&nothing, &mut hits), Ok(19));
        assert!(hits[..19].iter().enumerate().all(|(i, hit)| *hit == Hit { frame: i as u32, cost: 0.0 }));
    }
}
