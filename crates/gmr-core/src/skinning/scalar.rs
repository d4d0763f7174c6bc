//! The definition: one vertex after the other, in plain numbers.

use super::blend::{Frame, Hemisphere, Method, Work};
use super::bones::{Bones, Row};
use super::formulas::{Matrix, add, move_by, subtract, transform, transform_normal, turn_by};
use crate::rotation::dot;

/// Works on the vertices of `work` in each frame.
pub(super) fn run(work: &Work<'_>, frames: &mut [Frame<'_>]) {
    for Frame { bones, positions, normals } in frames {
        let positions = positions.as_chunks_mut::<3>().0;
        let mut normals = normals.as_deref_mut().map(|normals| normals.as_chunks_mut::<3>().0);
        for (k, vertex) in work.vertices.clone().enumerate() {
            let rest = point(&work.skin.positions, vertex);
            let normal = normals.is_some().then(|| point(&work.skin.normals, vertex));
            let (position, turned) = Vertex { work, vertex }.blend(bones, rest, normal.unwrap_or_default());
            positions[k] = position;
            if let Some(normals) = &mut normals {
                normals[k] = turned;
            }
        }
    }
}

/// One vertex of a skin.
#[derive(Clone, Copy)]
struct Vertex<'a, 'b> {
    work: &'a Work<'b>,
    vertex: usize,
}

impl Vertex<'_, '_> {
    /// The vertex at `v` and its normal `n`, blended.
    fn blend(self, bones: &Bones, v: [f32; 3], n: [f32; 3]) -> ([f32; 3], [f32; 3]) {
        let skin = self.work.skin;
        if let Method::Linear = self.work.method {
            let m = matrix(self.sum(&bones.linear, &skin.joints));
            return (transform(&m, v), transform_normal(&m, n));
        }
        let residual = (!bones.residual.is_empty()).then(|| matrix(self.sum(&bones.residual, &skin.joints)));
        let n = residual.map_or(n, |m| transform_normal(&m, n));
        let stretched = |v| residual.map_or(v, |m| transform(&m, v));
        match self.work.method {
            Method::Centers(_) => {
                let q = quaternions(self.sum(&bones.dual, &skin.paired))[0];
                let center = point(self.work.centers, self.vertex);
                let m = matrix(self.sum(&bones.linear, &skin.joints));
                (add(turn_by(q, stretched(subtract(v, center))), transform(&m, center)), turn_by(q, n))
            }
            Method::DualQuaternion(Hemisphere::Running) => {
                let q = quaternions(self.running_sum(&bones.dual));
                (move_by(q, stretched(v)), turn_by(q[0], n))
            }
            _ => {
                let q = quaternions(self.sum(&bones.dual, &skin.paired));
                (move_by(q, stretched(v)), turn_by(q[0], n))
            }
        }
    }

    /// `sum_i w_i row_i`.
    fn sum(self, rows: &[Row], joints: &[u32]) -> Row {
        let influences = self.influences().map(|place| (&rows[joints[place] as usize], self.weight(place)));
        weighted_sum(influences)
    }

    /// `sum_i w_i s_i row_i`, where `s_i` makes the row point as the sum so far does.
    fn running_sum(self, rows: &[Row]) -> Row {
        let mut real = [0.0; 4];
        let influences = self.influences().map(|place| {
            let row = &rows[self.work.skin.joints[place] as usize];
            let r = quaternions(*row)[0];
            let weight = self.weight(place);
            let signed = if dot(real, r) < 0.0 { -weight } else { weight };
            real = std::array::from_fn(|c| real[c] + signed * r[c]);
            (row, signed)
        });
        weighted_sum(influences)
    }

    fn influences(self) -> std::ops::Range<usize> {
        let count = self.work.skin.influence_count;
        self.vertex * count..(self.vertex + 1) * count
    }

    fn weight(self, place: usize) -> f32 {
        self.work.skin.weights[place]
    }
}

fn weighted_sum<'a>(influences: impl Iterator<Item = (&'a Row, f32)>) -> Row {
    let shares = influences.map(|(row, weight)| Row(row.0.map(|number| number * weight)));
    shares.reduce(|sum, share| Row(std::array::from_fn(|k| sum.0[k] + share.0[k]))).unwrap_or(Row::ZERO)
}

fn point(rows: &[f32], at: usize) -> [f32; 3] {
    [rows[3 * at], rows[3 * at + 1], rows[3 * at + 2]]
}

fn matrix(Row(row): Row) -> Matrix<f32> {
    let [a, b, c, _] = fours(row);
    [a, b, c]
}

fn quaternions(Row(row): Row) -> [[f32; 4]; 2] {
    let [r, d, ..] = fours(row);
    [r, d]
}

fn fours(row: [f32; 16]) -> [[f32; 4]; 4] {
    std::array::from_fn(|k| std::array::from_fn(|c| row[4 * k + c]))
}
