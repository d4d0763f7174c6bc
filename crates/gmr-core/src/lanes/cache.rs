//! Hints to the memory: fetch what is needed next, and write past the caches what nobody will read soon. Nothing but
//! speed depends on them; Miri, which knows neither, goes without.

use super::Lanes;

/// Bytes of a cache line.
pub(crate) const LINE: usize = 64;

/// Whether an array outgrows the caches: then it is written past them, for it would not stay there, and fetching its
/// lines in order to overwrite them costs a third of the memory's throughput.
pub(crate) fn is_large<T>(array: &[T]) -> bool {
    size_of_val(array) >= 4 << 20
}

/// Asks for `source[start..start + count]`; what lies outside is left out.
#[inline(always)]
pub(crate) fn prefetch<T>(source: &[T], start: usize, count: usize) {
    for at in (start..source.len().min(start + count)).step_by(LINE / size_of::<T>()) {
        prefetch_line(&source[at]);
    }
}

#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline(always)]
fn prefetch_line<T>(place: &T) {
    use std::arch::x86_64::{_MM_HINT_T0, _mm_prefetch};
    // SAFETY: a prefetch of readable memory; SSE belongs to every x86-64.
    unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::from_ref(place).cast()) };
}

#[cfg(any(not(target_arch = "x86_64"), miri))]
#[inline(always)]
fn prefetch_line<T>(_place: &T) {}

/// Copies `source` to `target` past the caches. [`settle`] before another thread may read it.
#[inline(always)]
pub(crate) fn stream<L: Lanes>(source: &[L::Real], target: &mut [L::Real]) {
    let done = stream_lines::<L>(source, target);
    target[done..].copy_from_slice(&source[done..]);
}

/// [`stream`] but for a cache line that only begins in the target; how many numbers were copied.
#[inline(always)]
pub(crate) fn stream_lines<L: Lanes>(source: &[L::Real], target: &mut [L::Real]) -> usize {
    assert_eq!(source.len(), target.len(), "copy of another length");
    let head = target.as_ptr().align_offset(LINE).min(target.len());
    let end = target.len() - (target.len() - head) % (LINE / size_of::<L::Real>());
    if head > 0 {
        target[..head].copy_from_slice(&source[..head]);
    }
    if head < end {
        L::stream(&source[head..end], &mut target[head..end]);
    }
    end
}

/// Waits until what was streamed can be seen by all.
pub(crate) fn settle() {
    #[cfg(all(target_arch = "x86_64", not(miri)))]
    // SAFETY: SSE belongs to every x86-64.
    unsafe {
        std::arch::x86_64::_mm_sfence();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Isa;
    use crate::lanes::{Kernel, Real};

    struct Streamed<'a, T>(&'a [T], &'a mut [T]);

    impl<T: Real> Kernel<T> for Streamed<'_, T> {
        #[inline(always)]
        fn run<L: Lanes<Real = T>>(self) {
            stream::<L>(self.0, self.1);
            settle();
        }
    }

    fn streams_are_copies<T: Real>(isa: Isa) {
        let source: Vec<T> = (0..200).map(|k| T::from_f64(f64::from(k))).collect();
        for start in 0..20 {
            for length in [0, 1, 15, 16, 17, 31, 100, 170] {
                let mut target = [-T::ONE; 200];
                T::dispatch(isa, Streamed(&source[7..7 + length], &mut target[start..start + length]));
                assert!(
                    target[start..start + length] == source[7..7 + length],
                    "{isa}, {length} from {start}"
                );
                assert_eq!(target.iter().filter(|&&x| x == -T::ONE).count(), 200 - length, "{isa}");
            }
        }
    }

    #[test]
    fn streams_of_any_length_and_alignment_are_copies() {
        for isa in Isa::available() {
            streams_are_copies::<f32>(isa);
            streams_are_copies::<f64>(isa);
        }
    }
}
