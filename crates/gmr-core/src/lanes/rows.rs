//! Arrays taken a block of rows at a time: what a register's lanes are filled from, and emptied into.
//!
//! A block that is cut short at the array's end, and rows of fewer than four numbers, go through a small copy, so that
//! kernels see whole blocks only and every row gets the same arithmetic. Large answers go through it too, on their way
//! past the caches.

use std::ops::Range;

use super::{Lanes, Real, cache};

/// Consecutive ranges of [`Lanes::WIDTH`] of `count` rows, the last perhaps shorter.
pub(crate) fn blocks<L: Lanes>(count: usize) -> impl Iterator<Item = Range<usize>> {
    (0..count).step_by(L::WIDTH).map(move |start| start..count.min(start + L::WIDTH))
}

/// First columns of groups of four that cover all wanted columns and stay inside a row (of at least four).
pub(crate) fn groups(is_wanted: &[bool]) -> Vec<usize> {
    let last = is_wanted.len().saturating_sub(4);
    let mut groups: Vec<usize> = vec![];
    for column in (0..is_wanted.len()).filter(|&column| is_wanted[column]) {
        if groups.last().is_none_or(|&start| start + 4 <= column) {
            groups.push(column.min(last));
        }
    }
    groups
}

/// Rows to read.
pub(crate) struct SourceRows<'a, T> {
    data: &'a [T],
    width: usize,
    copy: Vec<T>,
    start: usize,
    is_copied: bool,
}

impl<'a, T: Copy + Default> SourceRows<'a, T> {
    /// Rows of `width` numbers.
    pub(crate) fn new(data: &'a [T], width: usize) -> Self {
        Self { data, width, copy: vec![], start: 0, is_copied: false }
    }

    /// The rows of a block and how far apart they begin; a short block repeats its last row up to `height` rows.
    #[inline(always)]
    pub(crate) fn block(&mut self, rows: &Range<usize>, height: usize) -> (&[T], usize) {
        self.start = rows.start * self.width;
        self.is_copied = rows.len() < height || self.width < 4;
        if self.is_copied {
            self.copy_rows(rows, height);
        }
        self.current()
    }

    /// All the rows.
    #[inline(always)]
    pub(crate) fn data(&self) -> &'a [T] {
        self.data
    }

    /// Numbers in a row.
    #[inline(always)]
    pub(crate) fn width(&self) -> usize {
        self.width
    }

    /// The block asked for last.
    #[inline(always)]
    pub(crate) fn current(&self) -> (&[T], usize) {
        if self.is_copied { (&self.copy, self.width.max(4)) } else { (&self.data[self.start..], self.width) }
    }

    fn copy_rows(&mut self, rows: &Range<usize>, height: usize) {
        let stride = self.width.max(4);
        self.copy.resize(height * stride, T::default());
        for (k, copy) in self.copy.chunks_exact_mut(stride).enumerate() {
            let row = (rows.start + k).min(rows.end - 1);
            copy[..self.width].copy_from_slice(&self.data[row * self.width..][..self.width]);
        }
    }
}

/// Rows to write.
pub(crate) struct TargetRows<'a, T> {
    data: &'a mut [T],
    width: usize,
    /// A block that is not written to its place at once, from `first` on, where a cache line begins.
    copy: Vec<T>,
    first: usize,
    is_streamed: bool,
    /// How many numbers before `first`, the last of the blocks before, wait for the rest of their cache line: a line
    /// streamed in two parts would have to be fetched.
    waiting: usize,
}

impl<'a, T: Real> TargetRows<'a, T> {
    /// Rows of `width` numbers; `is_large`: they are part of an answer that outgrows the caches.
    pub(crate) fn new(data: &'a mut [T], width: usize, is_large: bool) -> Self {
        let is_streamed = is_large && width >= 4;
        Self { data, width, copy: vec![], first: 0, is_streamed, waiting: 0 }
    }

    /// How many rows there are; none where they hold no numbers.
    pub(crate) fn row_count(&self) -> usize {
        self.data.len().checked_div(self.width).unwrap_or(0)
    }

    /// Room for a block of [`Lanes::WIDTH`] rows, and how far apart they begin. To be followed by [`Self::finish`].
    /// Blocks come in the order of the rows, without gaps.
    #[inline(always)]
    pub(crate) fn block<L: Lanes<Real = T>>(&mut self, rows: &Range<usize>) -> (&mut [T], usize) {
        if self.is_copied::<L>(rows) {
            let stride = self.width.max(4);
            if self.copy.is_empty() {
                self.make_room(L::WIDTH * stride);
            }
            return (&mut self.copy[self.first..], stride);
        }
        (&mut self.data[rows.start * self.width..rows.end * self.width], self.width)
    }

    /// Puts a block in its place that was not written there at once.
    #[inline(always)]
    pub(crate) fn finish<L: Lanes<Real = T>>(&mut self, rows: &Range<usize>) {
        if self.is_streamed {
            let is_last = rows.end * self.width == self.data.len();
            let place = &mut self.data[rows.start * self.width - self.waiting..rows.end * self.width];
            let copy = &self.copy[self.first - self.waiting..][..place.len()];
            let done = cache::stream_lines::<L>(copy, place);
            if is_last {
                place[done..].copy_from_slice(&copy[done..]);
            }
            self.waiting = place.len() - done;
            let end = self.first + rows.len() * self.width;
            self.copy.copy_within(end - self.waiting..end, self.first - self.waiting);
        } else if self.is_copied::<L>(rows) {
            let stride = self.width.max(4);
            for (row, copy) in rows.clone().zip(self.copy[self.first..].chunks_exact(stride)) {
                self.data[row * self.width..][..self.width].copy_from_slice(&copy[..self.width]);
            }
        }
    }

    #[cold]
    fn make_room(&mut self, count: usize) {
        let line = cache::LINE / size_of::<T>();
        self.copy = vec![T::ZERO; count + 2 * line];
        // Where the offset cannot be known there is no harm but time in beginning anywhere.
        self.first = line + self.copy.as_ptr().align_offset(cache::LINE).min(line);
    }

    fn is_copied<L: Lanes>(&self, rows: &Range<usize>) -> bool {
        self.is_streamed || rows.len() < L::WIDTH || self.width < 4
    }
}

impl<T> Drop for TargetRows<'_, T> {
    /// Other threads may read the rows as soon as this is gone.
    fn drop(&mut self) {
        if self.is_streamed {
            cache::settle();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Isa;
    use crate::lanes::Kernel;

    #[test]
    fn groups_of_four_cover_what_is_wanted_and_stay_inside() {
        let wanted = |columns: &[usize], count: usize| {
            let is_wanted: Vec<bool> = (0..count).map(|c| columns.contains(&c)).collect();
            groups(&is_wanted)
        };
        assert_eq!(wanted(&[0, 1, 2, 3, 4], 5), [0, 1]);
        assert_eq!(wanted(&[3, 4, 5, 9], 12), [3, 8]);
        assert_eq!(wanted(&[1], 3), [0]);
        assert_eq!(wanted(&[], 3), [0_usize; 0]);
        assert_eq!(wanted(&[], 0), [0_usize; 0]);
    }

    struct Passed<'a>(SourceRows<'a, f32>, TargetRows<'a, f32>);

    impl Kernel<f32> for Passed<'_> {
        #[inline(always)]
        fn run<L: Lanes<Real = f32>>(mut self) {
            for rows in blocks::<L>(self.1.row_count()) {
                let (from, stride) = self.0.block(&rows, L::WIDTH);
                let (to, same_stride) = self.1.block::<L>(&rows);
                assert_eq!(stride, same_stride);
                to[..stride * L::WIDTH].copy_from_slice(&from[..stride * L::WIDTH]);
                self.1.finish::<L>(&rows);
            }
        }
    }

    #[test]
    fn short_blocks_and_narrow_rows_come_back_as_they_went() {
        let shapes = [(3, 9), (3, 1), (7, 9), (4, 8), (5, 0), (5, 67), (37, 40)];
        let cases = shapes.into_iter().flat_map(|s| [(s, false), (s, true)]);
        for (isa, ((width, count), is_large)) in
            cases.flat_map(|case| Isa::available().map(move |isa| (isa, case)))
        {
            let data: Vec<f32> = (0..width * count).map(|k| k as f32).collect();
            for start in 0..5 {
                let mut room = vec![-1.0; start + data.len() + 1];
                let found = &mut room[start..start + data.len()];
                let target = TargetRows::new(found, width, is_large);
                f32::dispatch(isa, Passed(SourceRows::new(&data, width), target));
                assert_eq!(found, data, "{isa}, {width} by {count} from {start}");
                assert_eq!(room.iter().filter(|&&x| x == -1.0).count(), start + 1, "{isa}");
            }
        }
    }
}
