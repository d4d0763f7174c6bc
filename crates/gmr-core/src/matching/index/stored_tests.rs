use proptest::prelude::*;

use super::stored::{Arrays, Parts};
use super::tests::{Case, KINDS, Kind, Random};
use super::tree::Tree;
use super::*;
use crate::Isa;

/// The arrays of an index, as if they lay in a file.
#[derive(Clone, PartialEq, Debug)]
struct Saved {
    frame_count: usize,
    candidate_count: usize,
    order: Vec<u32>,
    mean: Vec<f64>,
    axes: Vec<f64>,
    grids: Vec<f32>,
    box_codes: Vec<u8>,
    row_codes: Vec<u8>,
    rows: Vec<f32>,
    frames: Vec<[u32; 8]>,
    tags: Vec<[u32; 8]>,
    boxes: Vec<u32>,
    lowest: Vec<[u32; 8]>,
    node_tags: Vec<[u32; 8]>,
    sums: Vec<u64>,
}

impl Saved {
    fn of(index: &Index) -> Self {
        let Arrays { order, mean, axes, rows, frames, tags, boxes, lowest, node_tags, sums, .. } =
            index.arrays();
        let Arrays { grids, box_codes, row_codes, .. } = index.arrays();
        Self {
            frame_count: index.frame_count(),
            candidate_count: index.candidate_count(),
            order: order.to_vec(),
            mean: mean.to_vec(),
            axes: axes.to_vec(),
            grids: grids.to_vec(),
            box_codes: box_codes.to_vec(),
            row_codes: row_codes.to_vec(),
            rows: rows.to_vec(),
            frames: frames.to_vec(),
            tags: tags.to_vec(),
            boxes: boxes.to_vec(),
            lowest: lowest.to_vec(),
            node_tags: node_tags.to_vec(),
            sums: sums.to_vec(),
        }
    }

    fn opened(&self, isa: Isa) -> Result<Index, String> {
        let saved = self.clone();
        let parts = Parts {
            file: "walks.gmrm".into(),
            frame_count: saved.frame_count,
            candidate_count: saved.candidate_count,
            order: saved.order,
            mean: saved.mean,
            axes: saved.axes,
            grids: saved.grids.into(),
            box_codes: saved.box_codes.into(),
            row_codes: saved.row_codes.into(),
            rows: saved.rows.into(),
            frames: saved.frames.into(),
            tags: saved.tags.into(),
            boxes: saved.boxes.into(),
            lowest: saved.lowest.into(),
            node_tags: saved.node_tags.into(),
            sums: saved.sums.into(),
        };
        Index::in_file_for(isa, parts)
    }

    /// With sums that fit whatever stands there, as one who means harm would write them.
    fn resealed(mut self) -> Self {
        let index = self.opened(Isa::Scalar).unwrap();
        self.sums = seal::sums(&Tree { seals: None, ..index.tree }.view());
        self
    }

    /// Puts any number anywhere in an array, the order of the dimensions aside.
    fn damage(&mut self, random: &mut Random) {
        let number = match random.below(4) {
            0 => random.below(64),
            1 => f32::NAN.to_bits(),
            2 => 0x7f80_7f80,
            _ => random.below(u32::MAX),
        };
        let words = match random.below(9) {
            0 | 6 => {
                let numbers = if random.below(2) == 0 { &mut self.rows } else { &mut self.grids };
                let at = random.below(numbers.len() as u32) as usize;
                if let Some(x) = numbers.get_mut(at) {
                    *x = f32::from_bits(number);
                }
                return;
            }
            7 | 8 => {
                let codes = if random.below(2) == 0 { &mut self.row_codes } else { &mut self.box_codes };
                let at = random.below(codes.len() as u32) as usize;
                if let Some(code) = codes.get_mut(at) {
                    *code = number as u8;
                }
                return;
            }
            1 => self.frames.as_flattened_mut(),
            2 => self.tags.as_flattened_mut(),
            3 => &mut self.boxes,
            4 => self.lowest.as_flattened_mut(),
            _ => self.node_tags.as_flattened_mut(),
        };
        let at = random.below(words.len() as u32) as usize;
        if let Some(word) = words.get_mut(at) {
            *word = number;
        }
    }
}

fn search_all(case: &Case, index: &Index, random: &mut Random) -> Result<(), IndexError> {
    for _ in 0..20 {
        let (features, weights) = (case.query_features(random), case.weights(random));
        let tags = if random.below(2) == 0 { 0 } else { random.below(8) };
        let query = Query { weights: weights.as_deref(), tags, ..Query::new(&features) };
        let found = index.search(&query)?;
        let mut hits = [Hit::NONE; 5];
        index.search_top(&query, &mut hits)?;
        let right = brute_force::search_top(&case.features, &case.candidates, Some(&case.tags), &query, 5);
        assert_eq!(found, right.first().copied());
        assert_eq!(hits[..right.len()], right);
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 60, ..ProptestConfig::default() })]

    #[test]
    fn an_index_in_a_file_finds_what_the_one_in_memory_finds_on_every_instruction_set(
        kind in proptest::sample::select(&KINDS),
        count in 0_usize..700,
        dims in 1_usize..40,
        seed in 1_u32..,
    ) {
        let mut random = Random(seed);
        let mut case = Case::new(kind, count, dims, &mut random);
        let saved = Saved::of(&case.indices[0]);
        for index in &case.indices {
            prop_assert_eq!(&Saved::of(index), &saved);
            prop_assert_eq!(index.check(&case.features, &case.candidates, &case.tags), Ok(()));
        }
        case.indices = Isa::available().map(|isa| saved.opened(isa).unwrap()).collect();
        for index in &case.indices {
            prop_assert_eq!(index.check(&case.features, &case.candidates, &case.tags), Ok(()));
            prop_assert_eq!(&Saved::of(index), &saved);
        }
        (0..10).for_each(|_| case.check(&mut random));
    }

    /// A search that meets the damage is refused; one that does not is right, as [`search_all`] asserts.
    #[test]
    fn what_is_damaged_is_never_answered_wrongly(count in 1_usize..700, dims in 1_usize..10, seed in 1_u32..) {
        let mut random = Random(seed);
        let case = Case::new(Kind::Walk, count, dims, &mut random);
        let whole = Saved::of(&case.indices[0]);
        let mut damaged = whole.clone();
        damaged.damage(&mut random);
        let is_whole = format!("{damaged:?}") == format!("{whole:?}");
        for isa in Isa::available() {
            let index = damaged.opened(isa).unwrap();
            let answers = search_all(&case, &index, &mut random);
            if let Err(error) = answers {
                prop_assert!(error.to_string().contains("of its index is damaged; save the database again"), "{error}");
                prop_assert!(index.search(&Query::new(&vec![0.0; dims])).is_err());
            }
            prop_assert_eq!(index.check(&case.features, &case.candidates, &case.tags).is_ok(), is_whole);
        }
    }

    /// Where the sums lie too, nothing is read that is not there, and what passes the whole check is right.
    #[test]
    fn what_means_harm_does_none(count in 1_usize..700, dims in 1_usize..10, seed in 1_u32..) {
        let mut random = Random(seed);
        let case = Case::new(Kind::Walk, count, dims, &mut random);
        let mut hostile = Saved::of(&case.indices[0]);
        (0..=random.below(3)).for_each(|_| hostile.damage(&mut random));
        let hostile = hostile.resealed();
        for isa in Isa::available() {
            let index = hostile.opened(isa).unwrap();
            if index.check(&case.features, &case.candidates, &case.tags).is_ok() {
                prop_assert_eq!(search_all(&case, &index, &mut random), Ok(()));
            }
            for _ in 0..20 {
                let mut hits = [Hit::NONE; 5];
                let features = case.query_features(&mut random);
                if index.search_top(&Query::new(&features), &mut hits).is_ok() {
                    prop_assert!(hits.iter().all(|hit| *hit == Hit::NONE || (hit.frame as usize) < count));
                }
            }
        }
    }
}

#[test]
fn a_node_whose_grid_is_none_is_not_measured() {
    let case = Case::new(Kind::Walk, 600, 7, &mut Random(1));
    let whole = Saved::of(&case.indices[0]);
    for parts in [-1.4e32, f32::NAN, f32::INFINITY, 1e30] {
        let mut hostile = whole.clone();
        for grid in hostile.grids.chunks_exact_mut(super::codes::grid_width(7)) {
            let end = grid.len();
            grid[end - 2] = parts;
        }
        let hostile = hostile.resealed();
        for isa in Isa::available() {
            let index = hostile.opened(isa).unwrap();
            let mut hits = [Hit::NONE; 5];
            let query = case.query_features(&mut Random(2));
            assert!(matches!(
                index.search_top(&Query::new(&query), &mut hits),
                Err(IndexError::Damaged { what: "node", .. })
            ));
        }
    }
}

#[test]
fn an_order_that_names_a_dimension_twice_is_refused() {
    let case = Case::new(Kind::Walk, 50, 4, &mut Random(1));
    for order in [vec![0, 1, 1, 2], vec![0, 1, 2, 4], vec![u32::MAX, 1, 2, 3]] {
        let twice = Saved { order, ..Saved::of(&case.indices[0]) };
        assert!(twice.opened(Isa::Scalar).unwrap_err().contains("does not name 4 dimensions once each"));
    }
}

#[test]
fn other_axes_than_those_that_were_saved_are_refused() {
    let saved = Saved::of(&Case::new(Kind::Walk, 50, 4, &mut Random(1)).indices[0]);
    let (mut turned, mut moved, mut reordered) = (saved.clone(), saved.clone(), saved.clone());
    turned.axes[3] = -turned.axes[3];
    moved.mean[2] += 1.0;
    reordered.order.swap(0, 1);
    for damaged in [turned, moved, reordered] {
        assert_eq!(damaged.opened(Isa::Scalar).unwrap_err(), "the axes of its index are damaged");
    }
}
