//! The scaling of features: minus the mean, over the mean standard deviation of the group, times its weight.
//!
//! Source: Holden et al., "Learned Motion Matching" (2020), Sec. 3 and its published code.

use crate::error::ShapeError;
use crate::matching::features::Schema;

/// Groups whose mean standard deviation lies below this do not vary (metres, metres a second, or unit vectors).
const CONSTANT: f64 = 1e-4;

/// Offset and scale per dimension: `feature = (raw - offset) / scale`. Frozen with the database that it was fitted to.
#[derive(Debug, Clone, PartialEq)]
pub struct Normalization {
    /// Mean of each dimension.
    pub offset: Vec<f32>,
    /// Mean standard deviation of the dimension's group, over the group's weight.
    pub scale: Vec<f32>,
}

impl Normalization {
    /// Fits offset and scale to the rows for which `counts` holds; returns them with the groups that do not vary
    /// there. Those keep their own unit instead of being blown up.
    ///
    /// # Errors
    /// When the arrays do not fit together.
    pub fn fit(schema: &Schema, raw: &[f32], counts: &[bool]) -> Result<(Self, Vec<usize>), ShapeError> {
        let dims = schema.dims();
        ShapeError::check("raw features", counts.len() * dims, raw.len())?;
        let rows = || raw.chunks_exact(dims).zip(counts).filter(|(_, counts)| **counts).map(|(row, _)| row);
        let count = rows().count().max(1) as f64;
        let mut mean = vec![0.0_f64; dims];
        rows().for_each(|row| mean.iter_mut().zip(row).for_each(|(sum, &x)| *sum += f64::from(x)));
        mean.iter_mut().for_each(|sum| *sum /= count);
        let mut variance = vec![0.0_f64; dims];
        for row in rows() {
            for (d, &x) in row.iter().enumerate() {
                variance[d] += (f64::from(x) - mean[d]).powi(2) / count;
            }
        }
        let mut scale = Vec::with_capacity(dims);
        let mut constant = Vec::new();
        for (g, group) in schema.groups().iter().enumerate() {
            let range = schema.range(g);
            let width = range.len().max(1) as f64;
            let spread = variance[range.clone()].iter().map(|v| v.sqrt()).sum::<f64>() / width;
            if spread < CONSTANT {
                constant.push(g);
            }
            let unit = if spread < CONSTANT { 1.0 } else { spread };
            scale.extend(range.map(|_| (unit / f64::from(group.weight)) as f32));
        }
        Ok((Self { offset: mean.into_iter().map(|m| m as f32).collect(), scale }, constant))
    }

    /// Turns raw rows into features, in place.
    ///
    /// # Panics
    /// When `rows` is no whole number of rows.
    pub fn normalize(&self, rows: &mut [f32]) {
        assert_eq!(rows.len() % self.offset.len(), 0, "whole rows of {} numbers", self.offset.len());
        for row in rows.chunks_exact_mut(self.offset.len()) {
            for ((x, offset), scale) in row.iter_mut().zip(&self.offset).zip(&self.scale) {
                *x = (*x - offset) / scale;
            }
        }
    }

    /// One raw number as the feature of dimension `dim`.
    ///
    /// # Panics
    /// When there is no such dimension.
    #[must_use]
    pub fn feature(&self, dim: usize, raw: f32) -> f32 {
        (raw - self.offset[dim]) / self.scale[dim]
    }

    /// The raw number (metres, metres a second) that the feature `x` of dimension `dim` stands for.
    ///
    /// # Panics
    /// When there is no such dimension.
    #[must_use]
    pub fn raw(&self, dim: usize, x: f32) -> f32 {
        x * self.scale[dim] + self.offset[dim]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows of numbers with a spread that grows with the dimension.
    fn noise(rows: usize) -> Vec<f32> {
        (0..rows * 27).map(|i| ((i * 7919) % 1013) as f32 / 1013.0 * (1 + i % 27) as f32 + 5.0).collect()
    }

    #[test]
    fn normalised_groups_have_their_weight_as_mean_standard_deviation() {
        let schema = Schema::locomotion(1, 1, 0, 2).unwrap();
        let mut rows = noise(400);
        let counts = vec![true; 400];
        let (normalization, constant) = Normalization::fit(&schema, &rows, &counts).unwrap();
        let raw = rows.clone();
        normalization.normalize(&mut rows);
        assert!(constant.is_empty());
        for (g, group) in schema.groups().iter().enumerate() {
            let spread = |d: usize| {
                let column = || rows.iter().skip(d).step_by(27).map(|&x| f64::from(x));
                let mean = column().sum::<f64>() / 400.0;
                (column().map(|x| (x - mean).powi(2)).sum::<f64>() / 400.0).sqrt()
            };
            let mean = schema.range(g).map(spread).sum::<f64>() / group.width() as f64;
            assert!((mean - f64::from(group.weight)).abs() < 1e-4, "{}: {mean}", group.name);
        }
        assert!((normalization.raw(14, rows[14]) - raw[14]).abs() < 1e-5);
        assert_eq!(normalization.feature(14, raw[14]), rows[14]);
    }

    #[test]
    fn groups_that_do_not_vary_are_named_and_left_in_their_unit() {
        let schema = Schema::locomotion(1, 1, 0, 2).unwrap();
        let rows = vec![1.5_f32; 27 * 10];
        let (normalization, constant) = Normalization::fit(&schema, &rows, &[true; 10]).unwrap();
        assert_eq!(constant, (0..7).collect::<Vec<_>>());
        assert_eq!(normalization.feature(26, 2.0), 0.75, "0.5 times the weight 1.5");
    }
}
