//! Numbers that begin where a cache line begins, so that no load of a full vector touches two lines.

/// Bytes of a cache line, and of the widest vector.
const LINE: usize = 64;

/// A fixed number of values, the first at the beginning of a cache line.
#[derive(Debug)]
pub(super) struct Aligned<T> {
    values: Vec<T>,
    start: usize,
    len: usize,
}

impl<T: Copy> Aligned<T> {
    pub(super) fn new(fill: T, len: usize) -> Self {
        let values = vec![fill; len + LINE / size_of::<T>()];
        // Where the offset cannot be known there is no harm but time in beginning anywhere.
        let start = values.as_ptr().align_offset(LINE).min(values.len() - len);
        Self { values, start, len }
    }

    pub(super) fn as_slice(&self) -> &[T] {
        &self.values[self.start..][..self.len]
    }

    pub(super) fn as_mut_slice(&mut self) -> &mut [T] {
        &mut self.values[self.start..][..self.len]
    }
}

impl<T: Copy> Clone for Aligned<T> {
    fn clone(&self) -> Self {
        let Some(&fill) = self.values.first() else { return Self { values: Vec::new(), start: 0, len: 0 } };
        let mut copy = Self::new(fill, self.len);
        copy.as_mut_slice().copy_from_slice(self.as_slice());
        copy
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_their_copies_begin_on_a_line() {
        for len in [0, 1, 15, 16, 1000] {
            let mut aligned = Aligned::new(1.0_f32, len);
            aligned.as_mut_slice().fill(2.0);
            let copy = aligned.clone();
            for aligned in [&aligned, &copy] {
                assert_eq!(aligned.as_slice(), vec![2.0; len]);
                assert_eq!(aligned.as_slice().as_ptr().align_offset(LINE), 0);
            }
        }
    }
}
