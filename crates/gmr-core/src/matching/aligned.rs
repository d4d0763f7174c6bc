//! Numbers that begin where a cache line begins, so that no load of a full vector touches two lines; where there are
//! many, in large pages, if the system has any.
//!
//! A search jumps about in its index. In pages of 4 KiB nearly every jump costs a walk through the page table besides
//! the wait for the numbers; pages of 2 MiB are few enough for the processor to know them all.

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;

/// What may lie in memory that was never anything but bytes.
#[cfg(feature = "file")]
pub(super) trait Number: bytemuck::Pod + Default {}
#[cfg(feature = "file")]
impl<T: bytemuck::Pod + Default> Number for T {}

/// What may lie in a column.
#[cfg(not(feature = "file"))]
pub(super) trait Number: Copy + Default + 'static {}
#[cfg(not(feature = "file"))]
impl<T: Copy + Default + 'static> Number for T {}

/// A fixed number of values, the first at the beginning of a cache line.
#[derive(Debug)]
pub(super) struct Aligned<T> {
    memory: Memory<T>,
    len: usize,
}

#[derive(Debug)]
enum Memory<T> {
    Own {
        values: Vec<T>,
        start: usize,
    },
    #[cfg(all(feature = "file", target_os = "linux"))]
    Pages(memmap2::MmapMut),
}

impl<T: Number> Aligned<T> {
    /// Zeros, in memory that becomes real where it is first written to, by whichever thread does.
    pub(super) fn zeros(len: usize) -> Self {
        #[cfg(all(feature = "file", target_os = "linux"))]
        if let Some(pages) = pages::of(len.saturating_mul(size_of::<T>())) {
            return Self { memory: Memory::Pages(pages), len };
        }
        let values = vec![T::default(); len + LINE / size_of::<T>()];
        // Where the offset cannot be known there is no harm but time in beginning anywhere.
        let start = values.as_ptr().align_offset(LINE).min(values.len() - len);
        Self { memory: Memory::Own { values, start }, len }
    }

    #[inline(always)]
    pub(super) fn as_slice(&self) -> &[T] {
        match &self.memory {
            Memory::Own { values, start } => &values[*start..][..self.len],
            #[cfg(all(feature = "file", target_os = "linux"))]
            Memory::Pages(pages) => bytemuck::cast_slice(&pages[..self.len * size_of::<T>()]),
        }
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [T] {
        match &mut self.memory {
            Memory::Own { values, start } => &mut values[*start..][..self.len],
            #[cfg(all(feature = "file", target_os = "linux"))]
            Memory::Pages(pages) => bytemuck::cast_slice_mut(&mut pages[..self.len * size_of::<T>()]),
        }
    }
}

impl<T: Number> Clone for Aligned<T> {
    fn clone(&self) -> Self {
        let mut copy = Self::zeros(self.len);
        copy.as_mut_slice().copy_from_slice(self.as_slice());
        copy
    }
}

#[cfg(all(feature = "file", target_os = "linux"))]
mod pages {
    use memmap2::{Advice, MmapMut};

    /// Bytes of a large page.
    const LARGE: usize = 1 << 21;

    /// Large pages for so many bytes, where they are worth one; `None` as well where the system refuses.
    pub(super) fn of(bytes: usize) -> Option<MmapMut> {
        if bytes < LARGE / 2 {
            return None;
        }
        let pages = MmapMut::map_anon(bytes.checked_next_multiple_of(LARGE)?).ok()?;
        // A system without large pages gives small ones, in which everything is the same but the time.
        let _ = pages.advise(Advice::HugePage);
        Some(pages)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_their_copies_begin_on_a_line() {
        for len in [0, 1, 15, 16, 1000, 300_000, 524_288, 600_001] {
            let mut aligned = Aligned::<f32>::zeros(len);
            assert_eq!(aligned.as_slice(), vec![0.0; len]);
            aligned.as_mut_slice().fill(2.0);
            let copy = aligned.clone();
            for aligned in [&aligned, &copy] {
                assert_eq!(aligned.as_slice(), vec![2.0; len]);
                assert_eq!(aligned.as_slice().as_ptr().align_offset(LINE), 0);
            }
        }
    }
}
