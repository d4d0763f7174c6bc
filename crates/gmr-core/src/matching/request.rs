//! What is asked of the character: a place on its reference path at each time, or only a speed and a turn rate.

use std::fmt;
use std::str::FromStr;

use super::ground::{Placement, direction};
use super::path::{ReferencePath, arc};
use glam::DVec2;

/// What the trajectory part of a query aims at.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Tracking {
    /// Where the reference will be at those times: an error made is an error to mend (closed loop).
    Time,
    /// The active speed and turn rate, from the character's own place and heading: an error made is forgotten, and a
    /// coming switch is not foreseen (open loop).
    Velocity,
}

impl Tracking {
    /// Where the character should be `ahead` seconds after `time`, seen from `character`, where it is at `time`.
    #[must_use]
    pub fn target(self, path: &ReferencePath, time: f64, character: &Placement, ahead: f64) -> Target {
        match self {
            Self::Time => Target::seen_from(character, &path.at(time + ahead)),
            Self::Velocity => {
                let segment = path.segment(path.active(time));
                Target::seen_from(&Placement::default(), &arc(Placement::default(), segment, ahead))
            }
        }
    }
}

/// A place to be at, in the character's frame (x left, z forward).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Metres.
    pub position: DVec2,
    /// Unit vector.
    pub facing: DVec2,
}

impl Target {
    /// `place` in the frame of `character`.
    #[must_use]
    pub fn seen_from(character: &Placement, place: &Placement) -> Self {
        Self {
            position: character.unrotate(place.position - character.position),
            facing: direction(place.heading - character.heading),
        }
    }
}

impl FromStr for Tracking {
    type Err = UnknownTracking;

    fn from_str(name: &str) -> Result<Self, Self::Err> {
        match name {
            "time" => Ok(Self::Time),
            "velocity" => Ok(Self::Velocity),
            _ => Err(UnknownTracking { asked: name.to_owned() }),
        }
    }
}

/// A name of no [`Tracking`].
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownTracking {
    /// The name.
    pub asked: String,
}

impl fmt::Display for UnknownTracking {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "unknown tracking '{}'; use 'time' or 'velocity'", self.asked)
    }
}

impl std::error::Error for UnknownTracking {}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::matching::path::Segment;
    use proptest::prelude::*;

    proptest! {
        /// On the path and on time there is nothing to mend, so both ask for the same.
        #[test]
        fn on_the_reference_both_ask_for_the_same(
            speed in 0.0..4.0, turn_rate in -2.0..2.0, time in 0.0..30.0, ahead in 0.0..1.0,
        ) {
            let segment = Segment { duration: 99.0, speed, turn_rate, drift: 0.0 };
            let path = ReferencePath::new(Placement::default(), &[segment]).unwrap();
            let [closed, open] = [Tracking::Time, Tracking::Velocity].map(|t| t.target(&path, time, &path.at(time), ahead));
            prop_assert!((closed.position - open.position).length() < 1e-12);
            prop_assert!((closed.facing - open.facing).length() < 1e-12);
        }
    }

    #[test]
    fn closed_loop_asks_to_catch_up_and_open_loop_does_not() {
        let path = ReferencePath::new(
            Placement::default(),
            &[Segment { duration: 9.0, speed: 2.0, turn_rate: 0.0, drift: 0.0 }],
        )
        .unwrap();
        let late = Placement { position: DVec2::new(1.0, -3.0), heading: 0.0 };
        let target = |tracking: Tracking| tracking.target(&path, 0.0, &late, 0.5).position;
        assert_eq!(target(Tracking::Time), DVec2::new(-1.0, 4.0));
        assert_eq!(target(Tracking::Velocity), DVec2::new(0.0, 1.0));
    }

    #[test]
    fn a_switch_is_foreseen_in_closed_loop_only() {
        let segment = |speed| Segment { duration: 1.0, speed, turn_rate: 0.0, drift: 0.0 };
        let path = ReferencePath::new(Placement::default(), &[segment(1.0), segment(3.0)]).unwrap();
        let target = |tracking: Tracking| tracking.target(&path, 0.5, &path.at(0.5), 1.0).position.y;
        assert_eq!([target(Tracking::Time), target(Tracking::Velocity)], [2.0, 1.0]);
    }

    #[test]
    fn names_are_those_of_the_tables() {
        assert_eq!("velocity".parse(), Ok(Tracking::Velocity));
        assert!("speed".parse::<Tracking>().unwrap_err().to_string().contains("'time' or 'velocity'"));
    }
}
