//! Smoothing what was in no box over the edges of the mesh.
//!
//! Vertices at one place are one: meshes part them where normals or textures change. Such a vertex that was in no box
//! takes the mean of its own weights and those of the vertices that an edge joins to it, all as they were before.

use std::collections::HashMap;

use glam::DVec3;

use super::strongest::Strongest;

/// Edges whose ends follow no joint in common, before and after.
#[derive(Debug, Clone, Copy)]
pub(super) struct Mended {
    pub(super) torn: usize,
    pub(super) still_torn: usize,
}

/// Smooths the vertices `outside`.
pub(super) fn mend(vertices: &[DVec3], faces: &[i32], outside: &[u32], followed: &mut [Strongest]) -> Mended {
    let firsts = firsts(vertices);
    let edges = edges(faces, &firsts);
    let torn = torn(&edges, followed);
    let mut mean = Mean::default();
    let places = || outside.iter().copied().filter(|vertex| firsts[*vertex as usize] == *vertex);
    let smoothed: Vec<Strongest> = places().map(|vertex| mean.around(vertex, &edges, followed)).collect();
    for (vertex, smoothed) in places().zip(smoothed) {
        followed[vertex as usize] = smoothed;
    }
    for &vertex in outside {
        followed[vertex as usize] = followed[firsts[vertex as usize] as usize];
    }
    Mended { torn, still_torn: self::torn(&edges, followed) }
}

/// For each vertex the first at its place.
fn firsts(vertices: &[DVec3]) -> Vec<u32> {
    let mut known = HashMap::with_capacity(vertices.len());
    // Adding 0 makes one of the two zeros.
    let places = vertices.iter().map(|place| (*place + 0.0).to_array().map(f64::to_bits));
    places.zip(0..).map(|(place, vertex)| *known.entry(place).or_insert(vertex)).collect()
}

/// The edges between different places, each from both ends; ascending, each once.
fn edges(faces: &[i32], firsts: &[u32]) -> Vec<[u32; 2]> {
    let corners = faces.as_chunks::<3>().0.iter().map(|face| face.map(|vertex| firsts[vertex as usize]));
    let sides = corners.flat_map(|[a, b, c]| [[a, b], [b, a], [b, c], [c, b], [c, a], [a, c]]);
    let mut edges: Vec<[u32; 2]> = sides.filter(|[a, b]| a != b).collect();
    edges.sort_unstable();
    edges.dedup();
    edges
}

fn torn(edges: &[[u32; 2]], followed: &[Strongest]) -> usize {
    let once = edges.iter().filter(|[a, b]| a < b).map(|ends| ends.map(|vertex| &followed[vertex as usize]));
    once.filter(|[a, b]| !a.shares_a_joint_with(b)).count()
}

/// Room for sums of weights, joint by joint; between uses all are 0.
#[derive(Debug, Default)]
struct Mean {
    sums: Vec<f64>,
    joints: Vec<i32>,
}

impl Mean {
    fn around(&mut self, vertex: u32, edges: &[[u32; 2]], followed: &[Strongest]) -> Strongest {
        let start = edges.partition_point(|edge| edge[0] < vertex);
        let neighbours = edges[start..].iter().take_while(|edge| edge[0] == vertex).map(|edge| edge[1]);
        for one in neighbours.chain([vertex]) {
            followed[one as usize].iter().for_each(|(joint, weight)| self.add(joint, weight));
        }
        self.joints.sort_unstable();
        let mut mean = Strongest::default();
        for joint in self.joints.drain(..) {
            mean.add(joint, std::mem::take(&mut self.sums[joint as usize]));
        }
        mean.normalize();
        mean
    }

    fn add(&mut self, joint: i32, weight: f64) {
        let place = joint as usize;
        if self.sums.len() <= place {
            self.sums.resize(place + 1, 0.0);
        }
        if self.sums[place] <= 0.0 {
            self.joints.push(joint);
        }
        self.sums[place] += weight;
    }
}
