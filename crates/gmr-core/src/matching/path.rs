//! Reference paths: speed and turn rate constant piece by piece, in closed form.
//!
//! From a start `p0` with heading `th0`, at speed `v` and turn rate `w`,
//! `p(t) = p0 + v t sinc(w t / 2) [sin(th0 + d + w t / 2), cos(th0 + d + w t / 2)]`, heading `th0 + w t`; `d` is the
//! angle from where somebody faces to where they go, 0 for whoever walks ahead.
//! No radius appears, so a straight line is the case w = 0; each piece starts where the one before ends, so a change
//! of speed moves nothing. Source: Abichequer Sangalli et al., "A new framework for the evaluation of locomotive
//! motion datasets through motion matching techniques", section 3.4, with v = radius w written without the radius.

use std::f64::consts::TAU;
use std::fmt;

use super::ground::{Placement, direction, sin_cos};

/// A stretch of constant speed and turn rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Segment {
    /// Seconds, above 0.
    pub duration: f64,
    /// Metres a second along the way.
    pub speed: f64,
    /// Radians a second, positive to the left.
    pub turn_rate: f64,
    /// Radians from the heading to the way, positive to the left: 0 is ahead, half a turn is backwards.
    pub drift: f64,
}

/// A path made of segments; the last goes on for ever.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferencePath {
    segments: Vec<Segment>,
    starts: Vec<f64>,
    places: Vec<Placement>,
}

impl ReferencePath {
    /// The path that leaves `start` and runs through `segments` one after the other.
    ///
    /// # Errors
    /// When there is no segment, or a number of one is out of bounds.
    pub fn new(start: Placement, segments: &[Segment]) -> Result<Self, PathError> {
        check(segments)?;
        let (mut starts, mut places) = (Vec::new(), Vec::new());
        let (mut time, mut place) = (0.0, start);
        for segment in segments {
            starts.push(time);
            places.push(place);
            time += segment.duration;
            place = arc(place, segment, segment.duration);
        }
        Ok(Self { segments: segments.to_vec(), starts, places })
    }

    /// Number of the segment that is active at `time`; a segment's first moment is its own.
    #[must_use]
    pub fn active(&self, time: f64) -> usize {
        self.starts.partition_point(|&start| start <= time).saturating_sub(1)
    }

    /// The segment of that number.
    ///
    /// # Panics
    /// When there is no such segment.
    #[must_use]
    pub fn segment(&self, index: usize) -> &Segment {
        &self.segments[index]
    }

    /// Where the path is at `time` seconds; before 0 the first segment is continued backwards.
    #[must_use]
    pub fn at(&self, time: f64) -> Placement {
        let active = self.active(time);
        arc(self.places[active], &self.segments[active], time - self.starts[active])
    }

    /// Sum of the durations in seconds.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.segments.iter().map(|segment| segment.duration).sum()
    }
}

/// Where somebody who leaves `start` at the segment's speed and turn rate is after `time` seconds.
#[must_use]
pub fn arc(start: Placement, segment: &Segment, time: f64) -> Placement {
    let half_turn = 0.5 * segment.turn_rate * time;
    let chord = segment.speed * time * sinc(half_turn);
    Placement {
        position: start.position + direction(start.heading + segment.drift + half_turn) * chord,
        heading: start.heading + segment.turn_rate * time,
    }
}

/// `sin x / x`, 1 at 0.
#[must_use]
pub fn sinc(x: f64) -> f64 {
    // Below this the next term of 1 - x^2/6 is less than half a unit in the last place.
    if x.abs() < 1e-4 { 1.0 - x * x / 6.0 } else { sin_cos(x).0 / x }
}

/// Turn rates beyond this (rad/s) are taken for degrees written as radians.
const MAX_TURN_RATE: f64 = 100.0;
const MAX_SPEED: f64 = 1000.0;
const MAX_SECONDS: f64 = 1e5;

fn check(segments: &[Segment]) -> Result<(), PathError> {
    if segments.is_empty() {
        return Err(PathError::Empty);
    }
    let mut seconds = 0.0;
    for (index, segment) in segments.iter().enumerate() {
        seconds += segment.duration;
        let bound = |what, found: f64, fits: bool| {
            if fits { Ok(()) } else { Err(PathError::OutOfBounds { index, what, found }) }
        };
        bound("duration", segment.duration, segment.duration > 0.0 && seconds <= MAX_SECONDS)?;
        bound("speed", segment.speed, segment.speed.abs() <= MAX_SPEED)?;
        bound("turn rate", segment.turn_rate, segment.turn_rate.abs() <= MAX_TURN_RATE)?;
        bound("drift", segment.drift, segment.drift.abs() <= TAU)?;
    }
    Ok(())
}

/// Segments of which no path can be made.
#[derive(Debug, Clone, PartialEq)]
pub enum PathError {
    /// There are none.
    Empty,
    /// A number is not finite or beyond what a path can hold.
    OutOfBounds {
        /// Number of the segment.
        index: usize,
        /// Which number of it.
        what: &'static str,
        /// Its value.
        found: f64,
    },
}

impl fmt::Display for PathError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => write!(f, "a path needs at least one segment"),
            Self::OutOfBounds { index, what, found } => write!(
                f,
                "segment {index} of the path has {what} {found}; durations are above 0 s and sum to at most \
                 {MAX_SECONDS} s, speeds are within {MAX_SPEED} m/s, turn rates within {MAX_TURN_RATE} rad/s, drifts \
                 within a turn"
            ),
        }
    }
}

impl std::error::Error for PathError {}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec2;
    use proptest::prelude::*;

    fn segments() -> impl Strategy<Value = Vec<Segment>> {
        let turn_rate = prop_oneof![Just(0.0), -3.0..3.0_f64, -1e-6..1e-6_f64];
        let segment = (0.05..4.0_f64, -2.0..5.0_f64, turn_rate, prop_oneof![Just(0.0), -4.0..4.0_f64])
            .prop_map(|(duration, speed, turn_rate, drift)| Segment { duration, speed, turn_rate, drift });
        prop::collection::vec(segment, 1..5)
    }

    fn start() -> impl Strategy<Value = Placement> {
        (-5.0..5.0, -5.0..5.0, -7.0..7.0)
            .prop_map(|(x, z, heading)| Placement { position: DVec2::new(x, z), heading })
    }

    /// Midpoint rule, the velocity being speed times the direction of the way.
    fn integrate(start: Placement, segments: &[Segment], time: f64, steps_a_piece: usize) -> Placement {
        let mut place = start;
        let mut left = time;
        for (index, segment) in segments.iter().enumerate() {
            let last = index + 1 == segments.len();
            let span = if last { left } else { left.min(segment.duration) };
            let dt = span / steps_a_piece as f64;
            for _ in 0..steps_a_piece {
                let middle = place.heading + 0.5 * dt * segment.turn_rate;
                let way = middle + segment.drift;
                place.position += DVec2::new(way.sin(), way.cos()) * segment.speed * dt;
                place.heading += segment.turn_rate * dt;
            }
            left -= span;
        }
        place
    }

    proptest! {
        #[test]
        fn the_closed_form_agrees_with_numerical_integration(
            start in start(), segments in segments(), time in 0.0..20.0_f64,
        ) {
            let path = ReferencePath::new(start, &segments).unwrap();
            let expected = integrate(start, &segments, time, 4000);
            let found = path.at(time);
            prop_assert!((found.position - expected.position).length() < 1e-4, "{found:?} {expected:?}");
            prop_assert!((found.heading - expected.heading).abs() < 1e-9);
        }

        #[test]
        fn nothing_moves_at_a_switch(start in start(), segments in segments()) {
            let path = ReferencePath::new(start, &segments).unwrap();
            let mut time = 0.0;
            for segment in &segments {
                time += segment.duration;
                let (before, after) = (path.at(time - 1e-9), path.at(time + 1e-9));
                prop_assert!((before.position - after.position).length() < 1e-7);
                prop_assert!((before.heading - after.heading).abs() < 1e-7);
            }
        }

        #[test]
        fn a_vanishing_turn_rate_is_the_straight_line(start in start(), speed in 0.0..5.0, turn_rate in -1e-9..1e-9_f64) {
            let bent = arc(start, &Segment { duration: 1.0, speed, turn_rate, drift: 0.0 }, 10.0);
            let straight = start.position + direction(start.heading) * speed * 10.0;
            prop_assert!((bent.position - straight).length() < 1e-6);
        }

        #[test]
        fn a_full_turn_closes_the_circle_and_half_of_one_spans_its_diameter(
            start in start(), speed in 0.1..5.0, turn_rate in prop_oneof![0.1..3.0, -3.0..-0.1_f64],
        ) {
            let segment = Segment { duration: 1.0, speed, turn_rate, drift: 0.0 };
            let turn = TAU / f64::abs(turn_rate);
            let diameter = 2.0 * speed / f64::abs(turn_rate);
            prop_assert!((arc(start, &segment, turn).position - start.position).length() < 1e-12 * diameter.max(1.0));
            let half = (arc(start, &segment, turn / 2.0).position - start.position).length();
            prop_assert!((half - diameter).abs() < 1e-12 * diameter.max(1.0));
        }
    }

    #[test]
    fn sinc_has_no_seam_where_the_series_takes_over() {
        let (below, above) = (sinc(1e-4 * (1.0 - 1e-12)), sinc(1e-4 * (1.0 + 1e-12)));
        assert!((below - above).abs() < 3e-16);
        assert_eq!(sinc(0.0), 1.0);
    }

    #[test]
    fn a_positive_turn_rate_bends_towards_positive_x() {
        let segment = Segment { duration: 1.0, speed: 1.0, turn_rate: 1.0, drift: 0.0 };
        assert!(arc(Placement::default(), &segment, 0.5).position.x > 0.0);
    }

    #[test]
    fn whoever_drifts_to_the_left_goes_to_positive_x_and_faces_ahead() {
        let segment = Segment { duration: 1.0, speed: 2.0, turn_rate: 0.0, drift: TAU / 4.0 };
        let place = arc(Placement::default(), &segment, 1.5);
        assert!((place.position - DVec2::new(3.0, 0.0)).length() < 1e-12);
        assert_eq!(place.heading, 0.0);
    }

    #[test]
    fn a_segment_begins_at_its_first_moment() {
        let segment = |speed| Segment { duration: 3.0, speed, turn_rate: 0.0, drift: 0.0 };
        let path = ReferencePath::new(Placement::default(), &[segment(1.0), segment(2.0)]).unwrap();
        assert_eq!(
            [path.active(-1.0), path.active(2.999), path.active(3.0), path.active(99.0)],
            [0, 0, 1, 1]
        );
        assert_eq!(path.duration(), 6.0);
    }

    #[test]
    fn numbers_that_make_no_path_are_refused_by_name() {
        let good = Segment { duration: 1.0, speed: 1.0, turn_rate: 0.0, drift: 0.0 };
        let refused = |bad| ReferencePath::new(Placement::default(), &[good, bad]).unwrap_err();
        for (bad, name) in [
            (Segment { duration: 0.0, ..good }, "duration"),
            (Segment { duration: f64::INFINITY, ..good }, "duration"),
            (Segment { duration: f64::NAN, ..good }, "duration"),
            (Segment { speed: f64::NAN, ..good }, "speed"),
            (Segment { turn_rate: 200.0, ..good }, "turn rate"),
            (Segment { drift: f64::NAN, ..good }, "drift"),
        ] {
            assert!(matches!(refused(bad), PathError::OutOfBounds { index: 1, what, .. } if what == name));
        }
        assert_eq!(ReferencePath::new(Placement::default(), &[]), Err(PathError::Empty));
    }
}
