//! Work cut into fixed pieces and shared among threads; the pieces, and so the bits, do not depend on how many.

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
    let chunk = chunk.max(1);
    let pieces = out.len().div_ceil(chunk);
    let slots: Vec<std::sync::Mutex<Option<&mut [T]>>> =
        out.chunks_mut(chunk).map(|c| std::sync::Mutex::new(Some(c))).collect();
    for_each_piece(pieces, threads, |i| {
        let taken = slots[i].lock().ok().and_then(|mut slot| slot.take());
        if let Some(c) = taken {
            work(i, c);
        }
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
}
