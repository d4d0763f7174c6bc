//! The definition: the cost of a frame, and the search that looks at every one of them.

use super::Hit;
use super::Query;

/// Squared distance between `query` and `row`: the dimensions in order, each difference, square and sum rounded to
/// `f32` by itself.
#[must_use]
#[inline]
pub fn cost(query: &[f32], row: &[f32]) -> f32 {
    query.iter().zip(row).fold(0.0, |sum, (q, x)| {
        let difference = q - x;
        sum + difference * difference
    })
}

/// As [`cost`], each square times the weight of its dimension, that product rounded too; dimensions of weight 0 are
/// left out.
#[must_use]
#[inline]
pub fn weighted_cost(query: &[f32], weights: &[f32], row: &[f32]) -> f32 {
    let terms = query.iter().zip(weights).zip(row).filter(|((_, weight), _)| **weight > 0.0);
    terms.fold(0.0, |sum, ((q, weight), x)| {
        let difference = q - x;
        sum + weight * (difference * difference)
    })
}

/// The best of all frames for which `candidates` holds: what [`super::Index::search`] must find.
///
/// `features` holds frames x `query.features.len()` numbers, `tags` one word a frame.
#[must_use]
pub fn search(features: &[f32], candidates: &[bool], tags: Option<&[u32]>, query: &Query) -> Option<Hit> {
    admitted(features, candidates, tags, query).reduce(|best, hit| if hit.beats(best) { hit } else { best })
}

/// The `k` best frames, best first: what [`super::Index::search_top`] must find.
#[must_use]
pub fn search_top(
    features: &[f32],
    candidates: &[bool],
    tags: Option<&[u32]>,
    query: &Query,
    k: usize,
) -> Vec<Hit> {
    let mut hits: Vec<Hit> = admitted(features, candidates, tags, query).collect();
    hits.sort_by(|a, b| a.cost.total_cmp(&b.cost).then(a.frame.cmp(&b.frame)));
    hits.truncate(k);
    hits
}

fn admitted(
    features: &[f32],
    candidates: &[bool],
    tags: Option<&[u32]>,
    query: &Query,
) -> impl Iterator<Item = Hit> {
    let rows = features.chunks_exact(query.features.len().max(1));
    rows.enumerate().filter_map(move |(i, row)| {
        let hit = Hit { frame: i as u32, cost: query.cost_of(row) };
        let admitted = candidates[i] && query.admits(hit.frame, tags.map_or(0, |tags| tags[i]));
        (admitted && hit.cost < query.max_cost).then_some(hit)
    })
}
