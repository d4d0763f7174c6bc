//! The definition: one vertex after the other, in plain numbers.

use super::arrangement::WIDEST;
use super::bones::Bones;
use super::formulas::{Matrix, add, move_by, subtract, transform, transform_normal, turn_by};
use super::lines::{Row, Wide};
use super::method::{Hemisphere, Method};
use super::skin::Lane;
use super::work::{Frame, Work};

/// Works on the vertices of `work` in each frame.
pub(super) fn run(work: &Work<'_>, frames: &mut [Frame<'_>]) {
    let first = work.first_vertex();
    for Frame { bones, positions, normals } in frames {
        let positions = positions.as_chunks_mut::<3>().0;
        let mut normals = normals.as_deref_mut().map(|normals| normals.as_chunks_mut::<3>().0);
        let skin = work.skin;
        for (start, runs) in work.windows() {
            for lane in runs.iter().flat_map(|run| skin.lanes(start, run)) {
                let rest = lane.point(&skin.positions);
                let normal = normals.is_some().then(|| lane.point(&skin.normals));
                let vertex = Vertex { work, lane };
                let (position, turned) = vertex.blend(bones, rest, normal.unwrap_or_default());
                positions[lane.vertex() - first] = position;
                if let Some(normals) = &mut normals {
                    normals[lane.vertex() - first] = turned;
                }
            }
        }
    }
}

/// One vertex of a skin.
#[derive(Clone, Copy)]
struct Vertex<'a, 'b> {
    work: &'a Work<'b>,
    lane: Lane<'a>,
}

impl<'a> Vertex<'a, '_> {
    /// The vertex at `v` and its normal `n`, blended.
    fn blend(self, bones: &Bones, v: [f32; 3], n: [f32; 3]) -> ([f32; 3], [f32; 3]) {
        if let Method::Linear = self.work.method {
            let m = matrix(self.sum(&bones.linear, Lane::joint));
            return (transform(&m, v), transform_normal(&m, n));
        }
        let residual = (!bones.residual.is_empty()).then(|| matrix(self.sum(&bones.residual, Lane::joint)));
        let n = residual.map_or(n, |m| transform_normal(&m, n));
        let stretched = |v| residual.map_or(v, |m| transform(&m, v));
        match self.work.method {
            Method::Centers(_) => {
                let q = quaternions(self.sum(&bones.dual, Lane::paired))[0];
                let center = self.lane.point(self.work.centers);
                let m = matrix(self.sum(&bones.linear, Lane::joint));
                (add(turn_by(q, stretched(subtract(v, center))), transform(&m, center)), turn_by(q, n))
            }
            Method::DualQuaternion(Hemisphere::Running) => {
                let q = quaternions(self.running_sum(&bones.dual));
                (move_by(q, stretched(v)), turn_by(q[0], n))
            }
            _ => {
                let q = quaternions(self.sum(&bones.dual, Lane::paired));
                (move_by(q, stretched(v)), turn_by(q[0], n))
            }
        }
    }

    /// `sum_k w_k row_k`, joint by joint in ascending order; `which` names the rows.
    fn sum(self, rows: &[Row], which: impl Fn(Lane<'a>, usize) -> u32) -> Row {
        let row = |k| &rows[which(self.lane, k) as usize];
        weighted_sum((0..self.lane.influence_count()).map(|k| (row(k), self.lane.weight(k))))
    }

    /// `sum_k w_k s_k row_k`, where `s_k` makes the row point as the sum of those that were given before it does.
    fn running_sum(self, rows: &[Row]) -> Row {
        let mut signed = vec![Wide([0.0; WIDEST]); self.lane.influence_count()];
        self.lane.signing(rows).sign(|k| self.lane.joint(k), &mut signed);
        let weights = signed.iter().map(|weights| weights.0[self.lane.lane()]);
        weighted_sum((0..).map(|k| &rows[self.lane.joint(k) as usize]).zip(weights))
    }
}

fn weighted_sum<'a>(influences: impl Iterator<Item = (&'a Row, f32)>) -> Row {
    let shares = influences.map(|(row, weight)| Row(row.0.map(|number| number * weight)));
    shares.reduce(|sum, share| Row(std::array::from_fn(|k| sum.0[k] + share.0[k]))).unwrap_or(Row::ZERO)
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
