//! The principal axes of the rows, on which distances are what they are, and few numbers tell most of them.
//!
//! Features of motion go together: where a character will be in a third of a second says much of where it will be in
//! two. Turned to the eigenvectors of their covariance (Pearson 1901, Hotelling 1933), rows lie in boxes that are far
//! tighter than along their own dimensions, and the first few coordinates hold nearly all that tells rows apart.
//! A turn changes no distance, so bounds on turned coordinates bound costs; costs themselves never see them.

use super::codes::MOST_CODED;
use super::layout::{W, larger};

/// Rounds of rotations after which off-diagonal numbers are far below rounding; each squares what is left.
const MOST_SWEEPS: usize = 12;

/// Blocks of axes whose sums have room in registers.
pub(super) const BLOCKS_AT_ONCE: usize = 4;

/// Coordinates go no further, so that whatever is reckoned with them stays a number.
const LARGEST: f64 = 1e18;

/// Blocks of eight axes that rows of so many numbers are turned to: none of rows that are too wide to be coded.
pub(in super::super) fn axis_blocks(dims: usize) -> usize {
    if dims > MOST_CODED { 0 } else { dims.div_ceil(W) }
}

/// An orthogonal change of coordinates: `y = A (x - mean)`.
#[derive(Debug, Clone, PartialEq)]
pub(in super::super) struct Axes {
    /// What is subtracted from each of D numbers.
    pub(super) mean: Vec<f64>,
    /// The largest number of `mean`, or further from 0.
    farthest: f64,
    /// A, the widest axis first: the numbers of eight axes side by side for each dimension (axes / 8, D, 8), zeros
    /// behind the last; nothing where rows are too wide.
    pub(super) turn: Vec<f64>,
}

impl Axes {
    pub(super) fn new(mean: Vec<f64>, turn: Vec<f64>) -> Self {
        let farthest = mean.iter().fold(0.0, |most: f64, mean| most.max(mean.abs()));
        Self { mean, farthest, turn }
    }

    /// The axes of these rows, each of `dims` numbers.
    #[inline(always)]
    pub(super) fn of<'a>(rows: impl Iterator<Item = &'a [f32]> + Clone, dims: usize) -> Self {
        let count = rows.clone().count().max(1) as f64;
        let mut mean = vec![0.0; dims];
        for row in rows.clone() {
            mean.iter_mut().zip(row).for_each(|(mean, &x)| *mean += f64::from(x) / count);
        }
        if axis_blocks(dims) == 0 {
            return Self::new(mean, Vec::new());
        }
        let (variances, vectors) = eigenvectors(covariance(rows, &mean), dims);
        let mut order: Vec<usize> = (0..dims).collect();
        order.sort_by(|&a, &b| variances[b].total_cmp(&variances[a]));
        let mut turn = vec![0.0; axis_blocks(dims) * W * dims];
        for (axis, &vector) in order.iter().enumerate() {
            for dimension in 0..dims {
                turn[(axis / W * dims + dimension) * W + axis % W] = vectors[vector * dims + dimension];
            }
        }
        Self::new(mean, turn)
    }

    pub(super) fn dims(&self) -> usize {
        self.mean.len()
    }

    /// Fills `turned` with the first coordinates of a row, zeros behind the last. They have the same bits on every
    /// machine.
    #[inline(always)]
    pub(super) fn turn(&self, row: &[f32], turned: &mut [[f32; W]]) {
        // Several blocks at once, for the sums of one would wait for themselves.
        let (many, few) = turned.as_chunks_mut::<BLOCKS_AT_ONCE>();
        for (part, turned) in many.iter_mut().enumerate() {
            *turned = self.turned(row, part * BLOCKS_AT_ONCE);
        }
        for (block, turned) in few.iter_mut().enumerate() {
            [*turned] = self.turned(row, many.len() * BLOCKS_AT_ONCE + block);
        }
    }

    /// `N` blocks of coordinates from the `first` on.
    #[inline(always)]
    fn turned<const N: usize>(&self, row: &[f32], first: usize) -> [[f32; W]; N] {
        let dims = self.dims();
        let axes: [&[[f64; W]]; N] =
            std::array::from_fn(|block| &self.turn[(first + block) * dims * W..].as_chunks::<W>().0[..dims]);
        let mut sums = [[0.0_f64; W]; N];
        for (dimension, (&x, mean)) in row.iter().zip(&self.mean).enumerate() {
            let x = f64::from(x) - mean;
            for (sums, axes) in sums.iter_mut().zip(axes) {
                let axes = &axes[dimension];
                *sums = std::array::from_fn(|lane| sums[lane] + axes[lane] * x);
            }
        }
        sums.map(|sums| sums.map(coordinate))
    }

    /// How far off a coordinate of a row can be at most whose coordinates are of that `size` at most: rounded once to
    /// `f32`, and as a sum of that many `f64`.
    #[inline(always)]
    pub(super) fn error(&self, size: f32) -> f32 {
        let terms = 8.0 * (self.dims() + 2) as f64;
        let summed = terms * terms * f64::EPSILON * (f64::from(size) + self.farthest);
        // Cut as they are, two coordinates never are further apart.
        (f32::EPSILON * size + summed as f32).min(2.0 * LARGEST as f32)
    }
}

/// The largest coordinate, or further from 0.
#[inline(always)]
pub(super) fn size(turned: &[[f32; W]]) -> f32 {
    let mut largest = [0.0_f32; W];
    for block in turned {
        largest = std::array::from_fn(|lane| larger(block[lane].abs(), largest[lane]));
    }
    largest.into_iter().fold(0.0, larger)
}

/// A coordinate in `f32`. What is cut off of very large ones brings rows nearer, never further apart.
#[inline(always)]
fn coordinate(x: f64) -> f32 {
    x.clamp(-LARGEST, LARGEST) as f32
}

/// The covariance of rows with this mean, D x D.
#[inline(always)]
fn covariance<'a>(rows: impl Iterator<Item = &'a [f32]> + Clone, mean: &[f64]) -> Vec<f64> {
    let dims = mean.len();
    let count = rows.clone().count().max(1) as f64;
    let mut covariance = vec![0.0; dims * dims];
    let mut x = vec![0.0; dims];
    for row in rows {
        x.iter_mut().zip(row).zip(mean).for_each(|((x, &number), mean)| *x = f64::from(number) - mean);
        for (i, line) in covariance.chunks_exact_mut(dims).enumerate() {
            let x_i = x[i];
            line[i..].iter_mut().zip(&x[i..]).for_each(|(c, x_j)| *c += x_i * x_j / count);
        }
    }
    for i in 0..dims {
        for j in 0..i {
            covariance[i * dims + j] = covariance[j * dims + i];
        }
    }
    covariance
}

/// Eigenvalues of a symmetric matrix and, in rows, its eigenvectors, by cyclic rotations (Jacobi 1846; the choice of
/// angle of Rutishauser 1966).
#[inline(always)]
fn eigenvectors(mut a: Vec<f64>, n: usize) -> (Vec<f64>, Vec<f64>) {
    let mut v: Vec<f64> = (0..n * n).map(|i| if i / n == i % n { 1.0 } else { 0.0 }).collect();
    for _ in 0..MOST_SWEEPS {
        let mut is_diagonal = true;
        for p in 0..n {
            for q in p + 1..n {
                let (a_pp, a_qq, a_pq) = (a[p * n + p], a[q * n + q], a[p * n + q]);
                if a_pq.abs() <= f64::EPSILON * (a_pp.abs() * a_qq.abs()).sqrt() {
                    continue;
                }
                is_diagonal = false;
                let theta = (a_qq - a_pp) / (2.0 * a_pq);
                let t = 1.0_f64.copysign(theta) / (theta.abs() + (theta * theta + 1.0).sqrt());
                let c = 1.0 / (t * t + 1.0).sqrt();
                let s = t * c;
                for line in a.chunks_exact_mut(n) {
                    (line[p], line[q]) = (c * line[p] - s * line[q], s * line[p] + c * line[q]);
                }
                rotate(&mut a, n, [p, q], c, s);
                rotate(&mut v, n, [p, q], c, s);
            }
        }
        if is_diagonal {
            break;
        }
    }
    ((0..n).map(|i| a[i * n + i]).collect(), v)
}

/// Rotates line `p`, the earlier one, against line `q` of `n` numbers a line.
#[inline(always)]
fn rotate(lines: &mut [f64], n: usize, [p, q]: [usize; 2], c: f64, s: f64) {
    let (before, from_q) = lines.split_at_mut(q * n);
    for (x_p, x_q) in before[p * n..][..n].iter_mut().zip(&mut from_q[..n]) {
        (*x_p, *x_q) = (c * *x_p - s * *x_q, s * *x_p + c * *x_q);
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn turning_changes_no_distance_and_puts_the_widest_axis_first(
            dims in 1_usize..40,
            count in 1_usize..60,
            seed in 1_u32..,
        ) {
            let mut random = super::super::tests::Random(seed);
            let rows: Vec<f32> = (0..count * dims)
                .map(|i| (random.below(1000) as f32 - 500.0) * [1.0, 0.01, 30.0][i % dims % 3])
                .collect();
            let axes = Axes::of(rows.chunks_exact(dims), dims);
            let mut turned = vec![[7.0; W]; count * axis_blocks(dims)];
            let blocks = turned.chunks_exact_mut(axis_blocks(dims));
            rows.chunks_exact(dims).zip(blocks).for_each(|(row, turned)| axes.turn(row, turned));
            let turned = turned.as_flattened();
            let squared = |a: &[f32], b: &[f32]| {
                a.iter().zip(b).map(|(a, b)| f64::from(a - b).powi(2)).sum::<f64>()
            };
            let width = dims.next_multiple_of(W);
            for i in 1..count {
                let asked = squared(&rows[..dims], &rows[i * dims..][..dims]);
                let found = squared(&turned[..width], &turned[i * width..][..width]);
                prop_assert!((asked - found).abs() <= 1e-4 * (1.0 + asked), "{asked} {found}");
            }
            let spread = |axis: usize| {
                (0..count).map(|i| f64::from(turned[i * width + axis]).powi(2)).sum::<f64>()
            };
            for axis in 1..dims {
                prop_assert!(spread(axis) <= spread(axis - 1) * (1.0 + 1e-4) + 1e-3);
            }
            for axis in dims..width {
                prop_assert_eq!(spread(axis), 0.0);
            }
        }
    }
}
