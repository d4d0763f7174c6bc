"""A recording of markers: cutting, units, axes, and that nothing changes it."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import gmr
from gmr.demo import demo_folder
from gmr.markers import Event, Markers, Up
from gmr.markers.axes import AXES, axis_vector
from marker_scene import worn

axes = st.sampled_from(AXES)


def small(up: str | None = "+Z") -> Markers:
    places = np.random.default_rng(0).normal(size=(10, 3, 3))
    known = None if up is None else Up(up, "the test says so")
    return Markers(("A", "B", "B"), places, 0.01, unit=0.001, up=known, name="small.c3d")


@given(was=axes, wanted=axes)
def test_turning_keeps_every_distance_and_takes_up_to_the_axis(was: str, wanted: str) -> None:
    markers = small(was)
    turned = markers.with_up(wanted)
    assert turned.up is not None
    assert turned.up.axis == wanted
    before, after = markers.positions.reshape(-1, 3), turned.positions.reshape(-1, 3)
    turn = np.linalg.lstsq(before, after, rcond=None)[0].T
    assert np.linalg.det(turn) == pytest.approx(1)
    np.testing.assert_allclose(turn @ turn.T, np.eye(3), atol=1e-12)
    np.testing.assert_allclose(turn @ axis_vector(was), axis_vector(wanted), atol=1e-12)


@given(was=axes, wanted=axes)
def test_turning_back_gives_the_same_recording(was: str, wanted: str) -> None:
    markers = small(was)
    assert markers.with_up(wanted).with_up(was) == markers


def test_turning_says_what_it_did() -> None:
    assert small().with_up().history == (
        "turned so that +Z, which was up, is +Y: (x, y, z) became (x, z, -y)",
    )
    assert small("+Y").with_up().history == ()


def test_a_recording_that_does_not_know_its_up_asks_for_it() -> None:
    with pytest.raises(gmr.GmrError, match=r"small\.c3d does not say which way is up"):
        small(None).with_up()
    assert small(None).with_up(was="+Z").positions[0, 0, 1] == small().positions[0, 0, 2]
    with pytest.raises(gmr.GmrError, match="there is no axis 'up'; use one of"):
        small().with_up("up")


def test_units_change_numbers_and_keep_lengths() -> None:
    metres = small().to_unit("m")
    assert metres.unit == 1
    np.testing.assert_allclose(metres.positions * 1000, small().positions)
    with pytest.raises(gmr.GmrError, match="does not say in what unit it is"):
        small().with_unit(None).to_unit("m")


def test_slices_are_frames_and_crops_are_seconds() -> None:
    markers = small()
    np.testing.assert_array_equal(markers[2:6].positions, markers.positions[2:6])
    assert markers.crop(0.02, 0.06) == markers[2:6]
    assert markers[::2].frame_time == 0.02
    assert markers[2:6].history == ("frames 2 to 5 taken",)
    with pytest.raises(TypeError, match="cut by a slice"):
        markers[3]  # type: ignore[index]
    with pytest.raises(gmr.GmrError, match="backwards"):
        markers[::-1]


@given(st.data())
def test_events_stay_at_their_frames_however_a_recording_is_cut(data: st.DataObject) -> None:
    frames = data.draw(st.lists(st.integers(-5, 25), max_size=6))
    events = tuple(Event(str(frame), "", 0.1 * frame) for frame in frames)
    markers = Markers(("A",), np.zeros((20, 1, 3)), 0.1, events=events)
    start, stop, step = data.draw(st.tuples(st.integers(0, 20), st.integers(0, 20), st.integers(1, 3)))
    whole = (start, stop, step) == (0, 20, 1)
    found = {(event.label, round(event.seconds, 9)) for event in markers[start:stop:step].events}
    kept = [frame for frame in frames if whole or start <= frame < stop]
    assert found == {(str(frame), round(0.1 * (frame - start), 9)) for frame in kept}


def test_events_of_a_crop_are_told_from_its_first_frame() -> None:
    events = (Event("strike", "Left", 0.25), Event("off", "Left", 1.5))
    markers = Markers(("A",), np.zeros((200, 1, 3)), 0.01, events=events)
    (event,) = markers.crop(1.0, 2.0).events
    assert (event.label, event.context) == ("off", "Left")
    assert event.seconds == pytest.approx(0.5)
    assert Markers(("A",), np.zeros((9, 1, 3)), 0.0, events=events)[3:].events == events


def test_markers_are_chosen_by_label_or_place() -> None:
    markers = small()
    np.testing.assert_array_equal(markers.select(["A", 2]).positions, markers.positions[:, [0, 2]])
    with pytest.raises(gmr.GmrError, match="2 markers are labelled 'B': say which by index, 1, 2"):
        markers.select(["B"])
    with pytest.raises(gmr.GmrError, match=r"no marker 'L_FLA'; did you mean '.*'L_FAL'"):
        worn().index("L_FLA")
    with pytest.raises(gmr.GmrError, match="there is no marker 3; the recording has markers 0 to 2"):
        markers.index(3)


def test_nobody_can_change_a_recording() -> None:
    markers = small()
    for array in (markers.positions, markers.visible):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 0
    places = np.zeros((2, 1, 3))
    made = Markers(("A",), places, 0.01)
    places[:] = 7
    assert not made.positions.any()


def test_arrays_that_do_not_fit_are_refused() -> None:
    with pytest.raises(gmr.GmrError, match=r"shape \(4, 2, 3\); 3 labels need"):
        Markers(("A", "B", "C"), np.zeros((4, 2, 3)), 0.01)
    with pytest.raises(gmr.GmrError, match="residuals have the shape"):
        Markers(("A",), np.zeros((4, 1, 3)), 0.01, residuals=np.zeros((4, 2)))
    with pytest.raises(gmr.GmrError, match="a frame cannot last -1"):
        Markers(("A",), np.zeros((4, 1, 3)), -1)


def test_worn_markers_keep_their_distance_from_the_joint_that_wears_them() -> None:
    walk = gmr.read(demo_folder() / "07_01.bvh")
    markers = gmr.markers.wear(walk, {"knee": ("LeftLeg", (1.0, 2.0, 2.0)), "joint": ("LeftLeg", (0, 0, 0))})
    apart = np.linalg.norm(np.diff(markers.positions, axis=1), axis=2)
    np.testing.assert_allclose(apart, 3.0)
    np.testing.assert_allclose(
        markers.positions[:, 1], walk.positions(dtype=np.float64, joints=["LeftLeg"])[:, 0]
    )
