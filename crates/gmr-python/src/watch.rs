//! Long work that Ctrl-C can stop: done on a thread of its own while the calling one listens.

use std::panic::resume_unwind;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use pyo3::prelude::*;

/// Time between two looks at signals and progress: short for a hand on the keyboard, long for a processor.
const INTERVAL: Duration = Duration::from_millis(50);

/// Runs `work` without the GIL; about every 50 ms raises what Python's signal handlers raise, and calls `tick`.
///
/// On an error of either `cancel` is called, and the error is returned once `work` has come back.
pub(crate) fn watched<T: Send>(
    py: Python<'_>,
    work: impl FnOnce() -> T + Send,
    cancel: impl Fn(),
    mut tick: impl FnMut() -> PyResult<()>,
) -> PyResult<T> {
    let finished = AtomicBool::new(false);
    let listener = thread::current();
    thread::scope(|scope| {
        let worker = scope.spawn(|| {
            let _bell = Bell { finished: &finished, listener: &listener };
            work()
        });
        let mut outcome = Ok(());
        while !finished.load(Ordering::Acquire) {
            py.detach(|| thread::park_timeout(INTERVAL));
            if outcome.is_ok() {
                outcome = py.check_signals().and_then(|()| tick());
                if outcome.is_err() {
                    cancel();
                }
            }
        }
        let result = py.detach(|| worker.join()).unwrap_or_else(|panic| resume_unwind(panic));
        outcome.map(|()| result)
    })
}

/// Wakes the listener when the work ends, by a panic too.
struct Bell<'a> {
    finished: &'a AtomicBool,
    listener: &'a thread::Thread,
}

impl Drop for Bell<'_> {
    fn drop(&mut self) {
        self.finished.store(true, Ordering::Release);
        self.listener.unpark();
    }
}
