//! The candidates turned to the principal axes.

use std::sync::atomic::{AtomicU32, Ordering};

use super::super::aligned::Aligned;
use super::axes::{Axes, axis_blocks, size};
use super::kernel::Kernel;
use super::layout::{W, larger};
use super::rows::Rows;
use super::{Kernels, Work};
use crate::parallel::for_each_part;

/// Rows that a thread turns at a time.
const ROWS_A_PART: usize = 4096;

/// The coordinates of all candidates along the principal axes; those of rows too wide to be turned as they are.
pub(super) struct Turned {
    pub(super) dims: usize,
    /// Frames x dims, zeros for what is no candidate; then one block of zeros more.
    rows: Aligned<f32>,
    /// The largest coordinate, or further from 0.
    pub(super) size: f32,
}

impl Turned {
    pub(super) fn of(rows: &Rows, axes: &Axes, kernels: Kernels, threads: usize) -> Self {
        let Rows { dims, candidates, features, .. } = *rows;
        let mut turned = Aligned::zeros(features.len() + W);
        // Numbers that are not below 0 compare as their bits do.
        let size = AtomicU32::new(0);
        let parts = features
            .chunks(ROWS_A_PART * dims)
            .zip(candidates.chunks(ROWS_A_PART))
            .zip(turned.as_mut_slice().chunks_mut(ROWS_A_PART * dims))
            .map(|((rows, candidates), turned)| Turn { axes, rows, candidates, turned });
        for_each_part(parts, threads, |part| {
            size.fetch_max(kernels.run(part).to_bits(), Ordering::Relaxed);
        });
        Self { dims, rows: turned, size: f32::from_bits(size.into_inner()) }
    }

    #[inline(always)]
    pub(super) fn row(&self, frame: u32) -> &[f32] {
        &self.rows.as_slice()[frame as usize * self.dims..][..self.dims]
    }

    /// The row in whole blocks: behind its last number stands something else.
    #[inline(always)]
    pub(super) fn blocks(&self, frame: u32) -> &[[f32; W]] {
        let numbers = &self.rows.as_slice()[frame as usize * self.dims..];
        numbers[..self.dims.next_multiple_of(W)].as_chunks().0
    }
}

/// Turns some rows.
struct Turn<'a> {
    axes: &'a Axes,
    rows: &'a [f32],
    candidates: &'a [bool],
    turned: &'a mut [f32],
}

impl Work for Turn<'_> {
    /// The largest coordinate, or further from 0.
    type Done = f32;

    #[inline(always)]
    fn run<K: Kernel<W>>(self, _kernel: K) -> f32 {
        let dims = self.axes.dims();
        let mut wide = vec![[0.0; W]; axis_blocks(dims)];
        let mut largest = 0.0;
        let rows = self.rows.chunks_exact(dims).zip(self.turned.chunks_exact_mut(dims));
        for ((row, turned), _) in rows.zip(self.candidates).filter(|&(_, &candidate)| candidate) {
            if wide.is_empty() {
                turned.copy_from_slice(row);
                continue;
            }
            self.axes.turn(row, &mut wide);
            turned.copy_from_slice(&wide.as_flattened()[..dims]);
            largest = larger(size(&wide), largest);
        }
        largest
    }
}
