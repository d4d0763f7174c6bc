//! Work cut into fixed pieces and shared among threads; the pieces, and so the bits, do not depend on how many.

use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The number of threads to use for `asked` (0 means all cores) and this many pieces of work.
#[must_use]
pub fn thread_count(asked: usize, pieces: usize) -> usize {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let wanted = if asked == 0 { cores() } else { asked };
    wanted.min(pieces).max(1)
}

/// Runs `work(piece)` for every piece in `0..pieces`, on `threads` threads (0: all cores).
///
/// `work` must write only what belongs to its piece; then the result is the same whatever the thread count.
pub fn for_each_piece(pieces: usize, threads: usize, work: impl Fn(usize) + Sync) {
    let threads = thread_count(threads, pieces);
    if threads == 1 {
        (0..pieces).for_each(work);
        return;
    }
    let next = AtomicUsize::new(0);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let piece = next.fetch_add(1, Ordering::Relaxed);
                    if piece >= pieces {
                        break;
                    }
                    work(piece);
                }
            });
        }
    });
}

/// Splits `out` into consecutive chunks of `chunk` elements and runs `work(index, chunk)` for each, on `threads`
/// threads (0: all cores).
pub fn for_each_chunk<T: Send>(
    out: &mut [T],
    chunk: usize,
    threads: usize,
    work: impl Fn(usize, &mut [T]) + Sync,
) {
    for_each_part(out.chunks_mut(chunk.max(1)).enumerate(), threads, |(index, chunk)| work(index, chunk));
}

/// Runs `work(part)` for every part, on `threads` threads (0: all cores).
///
/// What `work` writes must belong to its part; then the result is the same whatever the thread count.
pub fn for_each_part<T: Send>(parts: impl Iterator<Item = T>, threads: usize, work: impl Fn(T) + Sync) {
    if thread_count(threads, usize::MAX) == 1 {
        return parts.for_each(work);
    }
    let slots: Vec<Mutex<Option<T>>> = parts.map(|part| Mutex::new(Some(part))).collect();
    for_each_piece(slots.len(), threads, |i| {
        let taken = slots[i].lock().ok().and_then(|mut slot| slot.take());
        if let Some(part) = taken {
            work(part);
        }
    });
}

/// Runs both, at once where there are `threads` for both; each is told how many it may use itself.
pub fn join(threads: usize, one: impl FnOnce(usize) + Send, other: impl FnOnce(usize)) {
    if threads < 2 {
        one(1);
        return other(1);
    }
    std::thread::scope(|scope| {
        scope.spawn(|| one(threads / 2));
        other(threads - threads / 2);
    });
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_chunk_is_visited_once_whatever_the_thread_count() {
        for threads in [1, 2, 5] {
            let mut out = vec![0_usize; 103];
            for_each_chunk(&mut out, 10, threads, |i, c| c.iter_mut().for_each(|x| *x += i + 1));
            assert!(out.iter().enumerate().all(|(k, &x)| x == k / 10 + 1));
        }
    }
    #[test]
    fn both_halves_are_done_with_all_threads_between_them() {
        for threads in [1, 2, 5] {
            let (mut one, mut other) = (0, 0);
            join(threads, |share| one = share, |share| other = share);
            assert_eq!(one + other, threads.max(2));
        }
    }
}
