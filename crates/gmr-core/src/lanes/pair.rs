//! Two registers of `f64` beside one of `f32` with as many lanes as both.

use super::{Doubles, Lanes};
use std::ops::{Add, Mul, Sub};

/// The first half of the frames, and the second.
#[derive(Clone, Copy)]
pub(super) struct Pair<D>(pub(super) D, pub(super) D);

impl<D: Lanes<Real = f64>> Pair<D> {
    /// [`Lanes::load_columns`] of twice as many rows.
    #[inline(always)]
    pub(super) fn load_columns(source: &[f64], stride: usize) -> [Self; 4] {
        let [a, b, c, d] = D::load_columns(source, stride);
        let [e, f, g, h] = D::load_columns(&source[D::WIDTH * stride..], stride);
        [Self(a, e), Self(b, f), Self(c, g), Self(d, h)]
    }
}

impl<D: Add<Output = D>> Add for Pair<D> {
    type Output = Self;

    #[inline(always)]
    fn add(self, other: Self) -> Self {
        Self(self.0 + other.0, self.1 + other.1)
    }
}

impl<D: Sub<Output = D>> Sub for Pair<D> {
    type Output = Self;

    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        Self(self.0 - other.0, self.1 - other.1)
    }
}

impl<D: Mul<Output = D>> Mul for Pair<D> {
    type Output = Self;

    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        Self(self.0 * other.0, self.1 * other.1)
    }
}

impl<D: Doubles> Doubles for Pair<D> {
    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(D::splat(value), D::splat(value))
    }

    #[inline(always)]
    fn all_at_most(self, limit: f64) -> bool {
        self.0.all_at_most(limit) & self.1.all_at_most(limit)
    }

    #[inline(always)]
    fn changed(self, change: fn(&mut [f64])) -> Self {
        Self(self.0.changed(change), self.1.changed(change))
    }
}
