"""Work for other processes to do, which they find here by its name."""

from __future__ import annotations

import os
import signal
import time
from pathlib import Path

from gmr import FormatError


def square(number: int) -> int:
    return number * number


def process_of(number: int) -> int:
    time.sleep(0.05)
    return os.getpid()


def die_once(folder: str, number: int) -> int:
    """The square; the process that is first to do number 3 is killed over it."""
    if number == 3:
        try:
            (Path(folder) / "died").touch(exist_ok=False)
        except FileExistsError:
            return square(number)
        os.kill(os.getpid(), signal.SIGKILL)
    return square(number)


def die_always(number: int) -> int:
    if number == 3:
        os.kill(os.getpid(), signal.SIGKILL)
    return square(number)


def refuse_three(number: int) -> int:
    if number == 3:
        raise FormatError("no third", file="three.bvh", line=3)
    return square(number)


def count(folder: str, number: int) -> int:
    """The square, and a mark of having been at work."""
    time.sleep(0.02)
    (Path(folder) / f"{number}").touch()
    return square(number)


class Shared:
    """What jobs share; it tells each process how often it was unpacked there."""

    unpacked = 0

    def __init__(self, factor: int, room: bytes = b"") -> None:
        self.factor, self.room = factor, room

    def __setstate__(self, state: dict[str, object]) -> None:
        self.__dict__.update(state)
        type(self).unpacked += 1


def scaled(shared: Shared, number: int) -> tuple[int, int]:
    """The number times what is shared, and how often that was unpacked here."""
    return number * shared.factor, type(shared).unpacked


def scaled_slowly(shared: Shared, number: int) -> int:
    time.sleep(0.02)
    return number * shared.factor


def unsendable(number: int) -> object:
    return lambda: number


class UnsendableError(Exception):
    def __init__(self, what: str) -> None:
        super().__init__(what)
        self.held = lambda: what


def refuse_unsendably(number: int) -> int:
    raise UnsendableError("no third")


def turned(many: bytes) -> bytes:
    return many[::-1]


def die_once_scaled(shared: tuple[str, int], number: int) -> int:
    """As :func:`die_once`, times what is shared."""
    folder, factor = shared
    return factor * die_once(folder, number)


def count_scaled(shared: tuple[str, int, bytes], number: int) -> int:
    """As :func:`count`, times what is shared."""
    folder, factor, _ = shared
    return factor * count(folder, number)
