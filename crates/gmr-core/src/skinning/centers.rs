//! Centres of rotation: for each vertex the point about which its blended rotation should turn it.
//!
//! `p_v = sum_t s(w_v, w_t) a_t c_t / sum_t s(w_v, w_t) a_t` over the triangles t with area a, centroid c and the mean
//! w of their vertices' weights, where
//! `s(u, w) = sum_{j != k} u_j u_k w_j w_k exp(-(u_j w_k - u_k w_j)^2 / sigma^2)`
//! is high for weights that are alike and that several joints share.
//! Source: Le and Hodgins 2016, Eqs. 1 and 4; sigma as there.
//!
//! The sums are taken pair of joints by pair of joints, over weights rounded to [`STEPS`]: triangles that a pair
//! moves alike count as one. So the work grows with how many ways of sharing there are, not with the mesh.

use std::collections::{BTreeMap, HashMap};

use glam::{DVec3, Vec3};

use super::skin::Lane;
use super::{Skin, SkinError};
use crate::error::ShapeError;
use crate::parallel::for_each_chunk;

const SIGMA: f64 = 0.1;

/// Steps from weight 0 to weight 1; one is a twenty-fifth of sigma.
const STEPS: f32 = 256.0;

/// How a pair of joints, the lower first, shares something: their weights in steps.
type Sharing = ([u32; 2], [u16; 2]);

/// An area, and its centroid times it.
#[derive(Debug, Clone, Copy, Default)]
struct Surface {
    area: f64,
    moment: DVec3,
}

/// The centres (V, 3) of a skin whose surface is made of (T, 3) `faces`. A vertex that follows one joint alone, or
/// whose way of sharing no surface has, is its own centre: it is then blended linearly.
///
/// The bits do not depend on `threads` (0: all cores).
///
/// # Errors
/// When a face names a vertex that is not there.
pub fn centers_of_rotation(skin: &Skin, faces: &[i32], threads: usize) -> Result<Vec<f32>, SkinError> {
    ShapeError::check("faces", faces.len() / 3 * 3, faces.len())?;
    let vertices = skin.lanes_by_vertex();
    let surfaces = surfaces(skin, &vertices, faces)?;
    let mut wanted: BTreeMap<Sharing, usize> = vertices
        .iter()
        .flat_map(|vertex| sharings(&weights(&[*vertex])))
        .map(|sharing| (sharing, 0))
        .collect();
    let keys: Vec<Sharing> = wanted.keys().copied().collect();
    wanted.values_mut().zip(0..).for_each(|(place, k)| *place = k);
    let mut found = vec![Surface::default(); keys.len()];
    for_each_chunk(&mut found, 64, threads, |chunk, found| {
        found.iter_mut().zip(&keys[64 * chunk..]).for_each(|(found, key)| *found = alike(*key, &surfaces));
    });

    let mut centers = Vec::with_capacity(3 * skin.vertex_count);
    for vertex in vertices {
        let parts = sharings(&weights(&[vertex])).map(|sharing| found[wanted[&sharing]]);
        let all = parts.fold(Surface::default(), Surface::plus);
        let center = if all.area > f64::MIN_POSITIVE {
            (all.moment / all.area).as_vec3()
        } else {
            Vec3::from(vertex.point(&skin.positions))
        };
        centers.extend(center.to_array());
    }
    Ok(centers)
}

impl Surface {
    fn plus(self, other: Self) -> Self {
        Self { area: self.area + other.area, moment: self.moment + other.moment }
    }

    fn times(self, scale: f64) -> Self {
        Self { area: self.area * scale, moment: self.moment * scale }
    }
}

/// For each pair of joints the surface that it shares, by how.
type Surfaces = HashMap<[u32; 2], BTreeMap<[u16; 2], Surface>>;

fn surfaces(skin: &Skin, vertices: &[Lane<'_>], faces: &[i32]) -> Result<Surfaces, SkinError> {
    let mut surfaces = Surfaces::new();
    for (face, corners) in faces.as_chunks::<3>().0.iter().enumerate() {
        let vertex_count = skin.vertex_count;
        if let Some(&vertex) = corners.iter().find(|v| !(0..vertex_count as i64).contains(&i64::from(**v))) {
            return Err(SkinError::Face { face, vertex: vertex.into(), vertex_count });
        }
        let corners = corners.map(|v| vertices[v as usize]);
        let [a, b, c] = corners.map(|corner| Vec3::from(corner.point(&skin.positions)).as_dvec3());
        let area = 0.5 * (b - a).cross(c - a).length();
        if area.is_nan() || area <= 0.0 {
            continue;
        }
        let surface = Surface { area, moment: area * (a + b + c) / 3.0 };
        for (pair, steps) in sharings(&weights(&corners)) {
            let known = surfaces.entry(pair).or_default().entry(steps).or_default();
            *known = known.plus(surface);
        }
    }
    Ok(surfaces)
}

/// The surface that a pair shares, weighed by how alike to `steps`: the pair's part of the sums.
fn alike((pair, steps): Sharing, surfaces: &Surfaces) -> Surface {
    let [u, v] = steps.map(|steps| f64::from(steps) / f64::from(STEPS));
    let Some(shared) = surfaces.get(&pair) else { return Surface::default() };
    let parts = shared.iter().map(|(steps, surface)| {
        let [s, t] = steps.map(|steps| f64::from(steps) / f64::from(STEPS));
        let apart = (u * t - v * s) / SIGMA;
        surface.times(u * v * s * t * (-apart * apart).exp())
    });
    parts.fold(Surface::default(), Surface::plus)
}

/// The mean of some vertices' weights, by joint.
fn weights(vertices: &[Lane<'_>]) -> BTreeMap<u32, f32> {
    let mut found = BTreeMap::new();
    for vertex in vertices {
        for k in 0..vertex.influence_count() {
            *found.entry(vertex.joint(k)).or_default() += vertex.weight(k) / vertices.len() as f32;
        }
    }
    found
}

/// How each pair of joints shares; pairs of which one joint has next to no weight are left out.
fn sharings(weights: &BTreeMap<u32, f32>) -> impl Iterator<Item = Sharing> + use<> {
    let steps = weights.iter().map(|(&joint, weight)| (joint, (weight * STEPS).round() as u16));
    let steps: Vec<(u32, u16)> = steps.filter(|&(_, steps)| steps > 0).collect();
    (0..steps.len()).flat_map(move |j| {
        let first = steps[j];
        let rest = steps[j + 1..].to_vec();
        rest.into_iter().map(move |second| ([first.0, second.0], [first.1, second.1]))
    })
}
