//! Hints to the memory: fetch what is needed next, and write past the caches what nobody will read soon. Nothing but
//! speed depends on them; Miri, which knows neither, goes without.

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
pub(crate) fn stream<T: super::Real>(source: &[T], target: &mut [T]) {
    let done = stream_lines(source, target);
    target[done..].copy_from_slice(&source[done..]);
}

/// [`stream`] without the beginning of a cache line at the target's end; how many numbers were copied.
#[cfg(all(target_arch = "x86_64", not(miri)))]
#[inline(always)]
pub(crate) fn stream_lines<T: super::Real>(source: &[T], target: &mut [T]) -> usize {
    use std::arch::x86_64::{__m128i, _mm_loadu_si128, _mm_stream_si128};
    assert_eq!(source.len(), target.len(), "copy of another length");
    let head = (target.as_ptr().align_offset(LINE)).min(target.len());
    let lines = (target.len() - head) * size_of::<T>() / LINE;
    if head > 0 {
        target[..head].copy_from_slice(&source[..head]);
    }
    // SAFETY: `lines` whole lines lie in both arrays from `head` on, where the target is aligned to a line; SSE2
    // belongs to every x86-64.
    unsafe {
        let mut from: *const __m128i = source.as_ptr().add(head).cast();
        let mut to: *mut __m128i = target.as_mut_ptr().add(head).cast();
        for _ in 0..lines {
            for k in 0..LINE / size_of::<__m128i>() {
                _mm_stream_si128(to.add(k), _mm_loadu_si128(from.add(k)));
            }
            (from, to) = (from.add(4), to.add(4));
        }
    }
    head + lines * LINE / size_of::<T>()
}

#[cfg(any(not(target_arch = "x86_64"), miri))]
pub(crate) fn stream_lines<T: super::Real>(source: &[T], target: &mut [T]) -> usize {
    target.copy_from_slice(source);
    target.len()
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

    #[test]
    fn streams_of_any_length_and_alignment_are_copies() {
        let source: Vec<f32> = (0..200).map(|k| k as f32).collect();
        for start in 0..20 {
            for length in [0, 1, 15, 16, 17, 31, 100, 170] {
                let mut target = vec![-1.0; 200];
                stream(&source[7..7 + length], &mut target[start..start + length]);
                settle();
                assert_eq!(target[start..start + length], source[7..7 + length]);
                assert_eq!(target.iter().filter(|&&x| x == -1.0).count(), 200 - length);
            }
        }
    }
}
