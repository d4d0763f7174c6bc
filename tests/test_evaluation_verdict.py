"""The verdict on made-up datasets of which everything is known."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from gmr.evaluation.clip_sentences import clip_sentences
from gmr.evaluation.coverage import coverage_table
from gmr.evaluation.result import Verdict
from gmr.evaluation.scenario import Trial, constant_trials
from gmr.evaluation.seen_sentences import seen_sentences
from gmr.evaluation.transitions import transitions_of
from gmr.evaluation.trials import trials_table
from gmr.evaluation.usage import clips_table, play_counts, usage_table
from gmr.evaluation.verdict import verdict
from gmr.table import Table
from locomotion import Arc, Gait, frames_of, walked

GRID = constant_trials((1.0, 1.5, 2.0, 2.5, 3.0), (-100.0, -50.0, 0.0, 50.0, 100.0))
EVERYTHING = {
    f"{speed:g}_{turn:g}.bvh": Arc(4.0, speed, turn)
    for speed in (1.0, 1.5, 2.0, 2.5, 3.0)
    for turn in (-100.0, -50.0, 0.0, 50.0, 100.0)
}


def judged(
    clips: dict[str, Arc],
    answer: Callable[[float, float], Gait] = Gait,
    tracking: str = "time",
    grid: Sequence[Trial] = GRID,
    **said: object,
) -> Verdict:
    frames = frames_of(clips)
    log = walked(grid, frames, answer)
    counts = play_counts(log, frames)
    return verdict(
        trials_table("set", grid, tracking, log, transitions_of(log, frames), frames),
        coverage_table("set", frames),
        clips_table("set", counts, frames),
        usage_table("set", "constant", "time", counts, frames),
        **said,  # type: ignore[arg-type]
    )


def test_a_perfect_dataset_is_told_so() -> None:
    said = judged(EVERYTHING)
    assert said.headline == (
        "This dataset does what it is asked in all 25 trials: "
        "going straight and turning up to 100 degrees/s either way at 1 to 3 m/s."
    )
    assert "Straight ahead it keeps 1 to 3 m/s throughout." in said.sentences
    assert "Nothing on this grid needs another capture." in said.sentences
    assert "fails" not in str(said)


def test_a_span_with_successes_in_it_says_how_many_trials_fail_of_how_many() -> None:
    def answer(speed: float, turn: float) -> Gait:
        return Gait(speed, turn if abs(turn) < 75 and speed == 2.0 else 0.0)

    said = judged({"straight.bvh": Arc(4.0, 2.0, 0.0)}, answer)
    failure = next(sentence for sentence in said.sentences if sentence.startswith("It fails when"))
    assert "by 50 to 100 degrees/s at 1 to 3 m/s (18 of 20 trials)" in failure


def test_each_trial_that_fails_is_told_once() -> None:
    def answer(speed: float, turn: float) -> Gait:
        fails = abs(turn) == 100 or (speed, abs(turn)) == (1.0, 50.0) or (speed, turn) == (2.0, 50.0)
        return Gait(speed, 0.0 if fails else turn)

    said = judged({"straight.bvh": Arc(4.0, 2.0, 0.0)}, answer)
    told = [sentence for sentence in said.sentences if sentence.startswith("It fails when")]
    assert "turning either way by 100 degrees/s at 1 to 3 m/s (10 trials)" in told[0]
    assert "turning either way by 50 degrees/s at 1 m/s (2 trials)" in told[1]
    assert "1 more trial fails here and there." in said.sentences


def test_a_dataset_of_straight_clips_is_told_so() -> None:
    straight = {name: arc for name, arc in EVERYTHING.items() if not arc.turn_rate_deg}
    said = judged(straight, lambda speed, turn: Gait(speed, 0.0))
    assert said.headline == (
        "This dataset does what it is asked in 5 of 25 trials (20%); "
        "it is good for going straight at 1 to 3 m/s."
    )
    assert (
        "The clips only go straight: 0 seconds of their 20 seconds turn by more than 12.5 degrees/s."
        in said.sentences
    )
    failure = next(sentence for sentence in said.sentences if sentence.startswith("It fails when"))
    assert failure.startswith(
        "It fails when turning either way by 50 to 100 degrees/s at 1 to 3 m/s (20 trials): "
        "no clip moves like that, and the character turns 75 degrees/s too slowly"
    )
    assert (
        "Capture next: turns to the left and to the right at "
        "a walk (1 to 1.5 m/s, circles of 0.57 to 1.7 m radius), "
        "a jog (2 m/s, circles of 1.1 to 2.3 m radius) and "
        "a run (2.5 to 3 m/s, circles of 1.4 to 3.4 m radius)." in said.sentences
    )
    assert "With mirrored copies of the clips (--mirror), turns to one side are enough." in said.sentences
    assert "Every clip is played at least once." in said.sentences


def test_clips_that_stand_are_told_so_and_not_to_go_straight() -> None:
    said = judged({"idle.bvh": Arc(4.0, 0.02, 0.0)}, lambda speed, turn: Gait(0.02, 0.0))
    told = next(sentence for sentence in said.sentences if sentence.startswith("The clips stand"))
    assert told.startswith("The clips stand: 0 seconds of their 4 seconds go 0.1 m/s or more.")
    assert "exported in place" in told
    assert "only go straight" not in str(said)


def test_clips_that_hold_nothing_of_the_grid_are_told_by_what_they_do_and_how_much_they_are_played() -> None:
    walks = {f"walks/{name}": arc for name, arc in EVERYTHING.items()}
    others = {
        "dance/spin.bvh": Arc(9.0, 0.2, 250.0),
        "dance/back.bvh": Arc(5.0, 1.0, 0.0, backwards=True),
        "play/stand.bvh": Arc(8.0, 0.01),
        "play/back.bvh": Arc(4.0, 2.0, 0.0, backwards=True),
    }
    runs = {"runs/fast.bvh": Arc(6.0, 5.0)}
    said = judged({**walks, **others, **runs})
    (told,) = [
        sentence
        for sentence in said.sentences
        if "stand, turn on the spot or go sideways or backwards" in sentence
    ]
    assert told.startswith(
        "3 clips of 30 (17 seconds, 13% of the material) mostly stand, turn on the spot or go sideways or "
        "backwards (play/stand.bvh, dance/back.bvh and play/back.bvh): each goes forward for less than half "
        "of its time, and for less than 1 second at the speeds and turn rates of the grid. These 3 are "
    )
    assert told.endswith("clips that go forward for longer are not counted here, whatever else they hold.")
    assert "fast.bvh" not in told
    assert "stand, turn on the spot or go sideways or backwards" not in str(judged({**walks, **runs}))
    del others["dance/spin.bvh"]
    assert "stand, turn on the spot or go sideways or backwards" not in str(judged(others))
    alone = judged({**EVERYTHING, "stand.bvh": Arc(3.0, 0.01)}, grid=GRID[:1])
    (told,) = [
        sentence
        for sentence in alone.sentences
        if "stands, turns on the spot or goes sideways or backwards" in sentence
    ]
    assert told.startswith("1 clip of 26 (3 seconds, 3% of the material) mostly stands, turns")
    assert "(stand.bvh): it goes forward for less than half" in told
    assert "of the grid. It is never shown;" in told


def test_feet_that_stand_still_slide_by_nothing() -> None:
    slide = {"foot_slide_mm": np.array([1e-10]), "foot_slide_own_mm": np.array([0.04])}
    jerk = {"jerk_at_jumps": np.array([0.0]), "jerk_between_jumps": np.array([1.0])}
    which = {"scenario": np.array(["constant"]), "tracking": np.array(["time"])}
    (told,) = seen_sentences(Table({**which, **slide, **jerk}))
    assert told.startswith("A foot slides 0 mm while it is down")
    assert told.endswith("own frames slide 0 mm.")


def test_a_hole_at_one_speed_is_named() -> None:
    holed = {name: arc for name, arc in EVERYTHING.items() if arc.speed != 2.0}
    said = judged(holed, lambda speed, turn: Gait(1.5 if speed == 2.0 else speed, turn))
    assert "Straight ahead it keeps 1, 1.5, 2.5 and 3 m/s, but not 2 m/s." in said.sentences
    straight = next(sentence for sentence in said.sentences if "going straight at 2 m/s" in sentence)
    assert "(1 trial): no clip moves like that, and the character goes 0.5 m/s too slowly" in straight
    assert (
        "Capture next: turns to the left and to the right at a jog (2 m/s, circles of 1.1 to 2.3 m radius); "
        "straight lines at a jog (2 m/s)." in said.sentences
    )


def test_a_speed_that_is_held_without_a_clip_of_it_is_named() -> None:
    holed = {name: arc for name, arc in EVERYTHING.items() if arc.speed != 2.0}
    said = judged(holed)
    assert "Straight ahead it keeps 1 to 3 m/s throughout." in said.sentences
    assert (
        "It keeps 2 m/s straight ahead only by switching between slower and faster clips: "
        "they hold less than 1 second of such movement." in said.sentences
    )


def test_turns_that_hold_without_a_clip_of_them_are_named() -> None:
    lacking = ("2.5_50.bvh", "3_50.bvh", "1_-100.bvh")
    said = judged({name: arc for name, arc in EVERYTHING.items() if name not in lacking})
    assert (
        "3 of the 25 trials that it does are turns of which the clips hold less than 1 second (2 of them "
        "turning left by 50 degrees/s at 2.5 to 3 m/s): it puts them together from pieces of other movements."
    ) in said.sentences
    assert "puts them together" not in str(judged(EVERYTHING))


def test_what_only_one_side_lacks_is_named_with_its_side() -> None:
    left_only = {name: arc for name, arc in EVERYTHING.items() if arc.turn_rate_deg >= 0}
    said = judged(left_only, lambda speed, turn: Gait(speed, max(turn, 0.0)))
    assert said.headline.endswith(
        "it is good for going straight and turning up to 100 degrees/s to the left at 1 to 3 m/s."
    )
    assert "The clips turn left for 40 seconds but right for only 0 seconds." in said.sentences
    assert any("turning right, though not left, by 50 to 100 degrees/s" in text for text in said.sentences)
    assert any(text.startswith("Turns that fail to one side only need no capture") for text in said.sentences)
    assert not any(text.startswith("Capture next") for text in said.sentences)


def test_nothing_is_said_of_a_side_that_was_not_asked_for() -> None:
    asked = constant_trials((1.0, 2.0), (0.0, 50.0))
    said = judged({"a.bvh": Arc(40.0, 1.0)}, lambda speed, turn: Gait(speed, 0.0), grid=asked)
    assert any("when turning left by 50 degrees/s at 1 to 2 m/s" in text for text in said.sentences)
    assert any(
        text.startswith("Capture next: turns to the left at a walk (1 m/s,") for text in said.sentences
    )
    assert "right" not in str(said)


def test_a_mirrored_dataset_is_not_told_to_be_mirrored() -> None:
    clips = {"a.bvh": Arc(40.0, 1.0), "a.bvh (mirrored)": Arc(40.0, 1.0, mirrored=True)}
    said = judged(clips, lambda speed, turn: Gait(speed, max(turn, 0.0)))
    assert "--mirror" not in str(said)
    assert any(text.startswith("Capture next: turns to the right at a walk") for text in said.sentences)


def test_walking_backwards_does_not_count_as_covering_a_speed() -> None:
    clips = {name: arc._replace(backwards=arc.speed == 1.0) for name, arc in EVERYTHING.items()}
    said = judged(clips, lambda speed, turn: Gait(max(speed, 1.5), turn))
    assert any("at 1 m/s" in text and "no clip moves like that" in text for text in said.sentences)


def test_failing_where_there_are_clips_does_not_ask_for_more_of_them() -> None:
    said = judged(EVERYTHING, lambda speed, turn: Gait(min(speed, 2.0), turn))
    assert not any(sentence.startswith("Capture next") for sentence in said.sentences)
    assert any(
        sentence.startswith("Every movement that fails is in the clips") for sentence in said.sentences
    )
    failure = next(sentence for sentence in said.sentences if sentence.startswith("It fails when"))
    assert "32 seconds of the clips move like that" in failure
    assert "goes 0.75 m/s too slowly" in failure


def test_a_dataset_that_holds_nothing_is_told_so() -> None:
    said = judged({"still.bvh": Arc(20.0, 0.0)}, lambda speed, turn: Gait(0.0, 0.0))
    assert (
        said.headline
        == "This dataset does what it is asked in none of 25 trials: it cannot follow any path of this grid."
    )
    assert "Straight ahead it keeps no speed of the grid." in said.sentences
    assert "All of the time is played from the one clip, still.bvh." in said.sentences


def test_straying_from_the_path_fails_only_where_the_path_is_tracked() -> None:
    def slow(speed: float, turn: float) -> Gait:
        return Gait(0.9 * speed, turn)

    timed = judged(EVERYTHING, slow)
    assert "all 25" not in timed.headline
    strays = next(sentence for sentence in timed.sentences if sentence.startswith("It fails when"))
    assert "keeps its speed and turn rate but strays" in strays
    assert "m from its path in the median (" in strays
    free = judged(EVERYTHING, slow, tracking="velocity")
    assert free.headline.startswith("This dataset does what it is asked in all 25 trials")
    assert free.sentences[0] == (
        "What is asked counts as done when, on average, the character's speed is within 15% of the speed "
        "asked for, and its turn rate within 10 degrees/s."
    )
    assert timed.sentences[0] == (
        "What is asked counts as done when, on average, the character is within 0.5 m of where the planned "
        "path has it at that time, its speed is within 15% of the speed asked for, and its turn rate within "
        "10 degrees/s."
    )
    lost = judged(EVERYTHING, lambda speed, turn: Gait(0.5 * speed, turn), tracking="velocity")
    told = "the character goes 1 m/s too slowly in the median (0.5 to 1.5)."
    assert any(text.endswith(told) for text in lost.sentences)


def test_one_side_of_the_turns_is_enough_where_clips_are_mirrored() -> None:
    clips = {"a.bvh": Arc(40.0, 1.0), "a.bvh (mirrored)": Arc(40.0, 1.0, mirrored=True)}
    said = judged(clips, lambda speed, _: Gait(speed, 0.0))
    assert any(
        text.startswith("Capture next: turns to the left or to the right at a walk")
        for text in said.sentences
    )
    assert "--mirror" not in str(said)


def test_clips_that_carry_and_clips_never_played_are_named_with_their_mirrored_copies() -> None:
    clips = {
        "long.bvh": Arc(30.0, 1.0),
        "short.bvh": Arc(5.0, 1.0),
        "long.bvh (mirrored)": Arc(30.0, 1.0, mirrored=True),
        "short.bvh (mirrored)": Arc(5.0, 1.0, mirrored=True),
        "spare.bvh": Arc(90.0, 1.0, mirrored=False),
        "spare.bvh (mirrored)": Arc(90.0, 1.0, mirrored=True),
    }
    said = judged(clips)
    assert "A single clip of 3, long.bvh, is played for 83% of the time." in said.sentences
    never = "1 clip of 3 is never played (90 seconds, 72% of the material): spare.bvh."
    assert never in said.sentences


def test_many_unused_clips_are_counted_and_the_longest_named() -> None:
    used = {"used.bvh": Arc(40.0, 1.0)}
    unused = {f"unused_{index}.bvh": Arc(2.0 + index, 1.0) for index in range(5)}
    said = judged(used | unused)
    assert (
        "5 clips of 6 are never played (20 seconds, 33% of the material): "
        "unused_4.bvh, unused_3.bvh, unused_2.bvh and 2 more." in said.sentences
    )


def test_notes_and_broken_files_come_last() -> None:
    said = judged(
        EVERYTHING, notes=("The files are taken to be in centimetres.",), failed={"bad.bvh": "empty"}
    )
    assert said.sentences[-2:] == (
        "The files are taken to be in centimetres.",
        "1 file could not be used and was left out: bad.bvh.",
    )


@pytest.mark.parametrize("seed", range(5))
def test_the_same_tables_give_the_same_words(seed: int) -> None:
    noise = np.random.default_rng(seed).normal(size=1000)

    def erratic(speed: float, turn: float) -> Gait:
        which = int(speed * 10 + turn) % 1000
        return Gait(abs(speed + noise[which]), turn + 20 * noise[which])

    assert judged(EVERYTHING, erratic) == judged(EVERYTHING, erratic)


def test_clips_are_named_without_the_folder_that_all_are_in() -> None:
    clips = {
        "set/walk/a.bvh": Arc(40.0, 1.0),
        "set/walk/b.bvh": Arc(5.0, 1.0),
        "set/run/a.bvh": Arc(4.0, 1.0),
    }
    sentences = judged(clips).sentences
    assert "A single clip of 3, walk/a.bvh, is played for 100% of the time." in sentences
    assert (
        "2 clips of 3 are never played (9 seconds, 18% of the material): walk/b.bvh and run/a.bvh."
        in sentences
    )


def shares_by_folder(played: dict[str, float]) -> list[str]:
    clips = Table(
        {
            "clip": np.array(list(played), object),
            "mirrored": np.array([name.endswith("(mirrored)") for name in played]),
            "seconds": np.ones(len(played)),
            "played_share": np.array(list(played.values())),
        }
    )
    frames = {"frame": np.zeros(len(played), int), "count": np.ones(len(played), int)}
    said = clip_sentences(clips, Table({"clip": clips["clip"], **frames, "seconds": clips["seconds"]}))
    return [sentence for sentence in said if sentence.startswith("By sub-folder")]


def test_where_there_are_sub_folders_their_shares_of_the_playing_are_told() -> None:
    played = {"set/climb/a.bvh": 0.15, "set/climb/b.bvh": 0.1, "set/climb/b.bvh (mirrored)": 0.15}
    played |= {"set/walk/a.bvh": 0.1, "set/walk/slow/a.bvh": 0.2, "set/a.bvh": 0.1}
    assert shares_by_folder(played) == [
        "By sub-folder: 40% of the time is played from climb, 30% from walk and 10% from clips in none."
    ]
    played |= {f"set/{folder}/a.bvh": 0.05 for folder in ("dance", "play", "run", "stairs")}
    assert shares_by_folder(played | {"set/idle/a.bvh": 0.0}) == [
        "By sub-folder: 40% of the time is played from climb, 30% from walk, 10% from clips in none and 20% "
        "from the other 5."
    ]
    assert shares_by_folder({"set/a.bvh": 0.5, "set/b.bvh": 0.5}) == []
    assert shares_by_folder({"a/take.bvh": 0.5, "b/take.bvh": 0.5}) == []
