"""An interrupt of the terminal goes to all processes of a command; only the command itself answers it."""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import resource_tracker

__all__ = ["interrupts_held"]


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Interrupts of this thread wait meanwhile; processes and threads that it starts never get any, unless
    they let them in again (:func:`signal.pthread_sigmask`)."""
    if not hasattr(signal, "pthread_sigmask"):
        yield
        return
    # Else it is started meanwhile, and lets interrupts in when it has been.
    resource_tracker.ensure_running()
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)
