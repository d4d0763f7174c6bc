"""C3D files whose parameters say absurd things, read one by one in processes with limits.

A small file with analog values and rotations, and files of the user's, are changed in one to four places,
which leave them C3D files: a parameter's value becomes an extreme one, its type, a dimension or its name
another, a count of the header any number. Each is read in a process of its own that may take 5 seconds and a
gigabyte, and must be read or refused in one short sentence. What is not is written to ``c3d-finding-N.c3d``.

    python fuzz/c3d_parameters.py --count 3000 recordings/*.c3d
"""

from __future__ import annotations

import argparse
import os
import random
import resource
import signal
import sys
import tempfile
import warnings
from collections import Counter
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent.parent / "tests"))

import ezc3d  # noqa: F401  here, so that no child has to

from c3d_files import changed, with_everything
from gmr.errors import FormatError
from gmr.formats.c3d import read_c3d

SECONDS = 5
BYTES = 2**30
LONGEST_MESSAGE = 1000
READ, REFUSED, FOUND = 0, 1, 2


def main() -> int:
    """Changes and reads so many files; 1 where one of them is a finding."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("files", nargs="*", type=Path, help="to be changed, beside a small one")
    parser.add_argument("--count", type=int, default=3000, help="changed files, of all files together")
    parser.add_argument("--seed", type=int, default=0)
    chosen = parser.parse_args()
    numbers = random.Random(chosen.seed)
    with tempfile.TemporaryDirectory() as folder:
        small = with_everything(Path(folder) / "small.c3d")
        contents = [path.read_bytes() for path in (small, *chosen.files)]
    ends: Counter[str] = Counter()
    for number in range(chosen.count):
        data = contents[number % len(contents)]
        for _ in range(numbers.randint(1, 4)):
            data = changed(data, numbers.randrange(2**16), numbers.randrange(6), numbers.randrange(2**16))
        end = end_of_reading(data)
        ends[end] += 1
        if end not in ("read", "refused"):
            kept = Path(f"c3d-finding-{number}.c3d")
            kept.write_bytes(data)
            print(f"{kept}: {end}, from {('small.c3d', *chosen.files)[number % len(contents)]}", flush=True)
    print(", ".join(f"{count} {end}" for end, count in ends.most_common()))
    return int(not set(ends) <= {"read", "refused"})


def end_of_reading(data: bytes) -> str:
    """How a process ends that reads the file: "read", "refused", or what went wrong."""
    child = os.fork()
    if child == 0:
        resource.setrlimit(resource.RLIMIT_AS, (BYTES, BYTES))
        signal.alarm(SECONDS)
        os._exit(attempt(data))
    _, status = os.waitpid(child, 0)
    if os.WIFSIGNALED(status):
        return f"killed by {signal.Signals(os.WTERMSIG(status)).name}"
    return {READ: "read", REFUSED: "refused"}.get(os.WEXITSTATUS(status), "raised")


def attempt(data: bytes) -> int:
    """Reads the file once, its warnings not shown."""
    warnings.simplefilter("ignore")
    try:
        markers = read_c3d(data, name="changed.c3d")
    except FormatError as error:
        return REFUSED if len(str(error)) <= LONGEST_MESSAGE else FOUND
    except BaseException as error:
        print(f"{type(error).__name__}: {error}", flush=True)
        return FOUND
    return READ if markers.positions.nbytes <= 8 * len(data) else FOUND


if __name__ == "__main__":
    sys.exit(main())
