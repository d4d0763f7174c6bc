"""What all tests share: real files to read, and how long hypothesis may search."""

from __future__ import annotations

import signal
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile(
    "default", deadline=None, max_examples=60, suppress_health_check=[HealthCheck.too_slow]
)
settings.register_profile("thorough", deadline=None, max_examples=2000)
settings.load_profile("default")

# A shell that runs the tests in the background has them ignore Ctrl-C; what they start would inherit it.
signal.signal(signal.SIGINT, signal.default_int_handler)

DATA = Path(__file__).parent / "data"


@pytest.fixture(scope="session")
def data() -> Path:
    """The folder of small real files; see its README for where they come from."""
    return DATA


@pytest.fixture(scope="session")
def walk_path() -> Path:
    """A walk of CMU's: 60 frames, dummies, a T-pose before the first frame."""
    return DATA / "cmu_07_01.bvh"
