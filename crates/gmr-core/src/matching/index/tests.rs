use super::*;

/// Two rows of small whole numbers are often equal: ties everywhere.
fn grid(frame_count: usize, dims: usize, levels: u32, seed: u32) -> Vec<f32> {
    let mut state = seed | 1;
    let mut next = || {
        state ^= state << 13;
        state ^= state >> 17;
        state ^= state << 5;
        (state % levels) as f32
    };
    (0..frame_count * dims).map(|_| next()).collect()
}

#[test]
fn the_index_finds_what_brute_force_finds() {
    let (n, dims) = (500, 3);
    let rows = grid(n, dims, 6, 1);
    let candidates: Vec<bool> = (0..n).map(|i| i % 5 != 0).collect();
    let tags: Vec<u32> = (0..n as u32).map(|i| i % 4).collect();
    let index = Index::build(&rows, dims, &candidates, Some(&tags)).unwrap();
    for (i, features) in grid(200, dims, 8, 2).chunks_exact(dims).enumerate() {
        let from = i as u32;
        let query = Query { tags: from % 4, exclude: from..from + 41, ..Query::new(features) };
        let expected = brute_force::search(&rows, &candidates, Some(&tags), &query);
        assert_eq!(index.search(&query).unwrap(), expected);
        let ranked = brute_force::search_top(&rows, &candidates, Some(&tags), &query, 7);
        let mut hits = [Hit::NONE; 7];
        let found = index.search_top(&query, &mut hits).unwrap();
        assert_eq!(hits[..found], ranked[..]);
    }
}
