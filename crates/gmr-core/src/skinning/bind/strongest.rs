//! The joints that a vertex follows most.

use super::INFLUENCES;

/// Up to four joints with their weights, the strongest first; joint 0 where the weight is 0.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct Strongest {
    pub(super) joints: [i32; INFLUENCES],
    pub(super) weights: [f64; INFLUENCES],
}

impl Strongest {
    /// Takes a joint that is none of these, if it weighs more than one of them; of equal ones the first stays.
    pub(super) fn add(&mut self, joint: i32, weight: f64) {
        let place = self.weights.partition_point(|known| *known >= weight);
        if place < INFLUENCES && weight > 0.0 {
            self.joints[place..].rotate_right(1);
            self.weights[place..].rotate_right(1);
            self.joints[place] = joint;
            self.weights[place] = weight;
        }
    }

    /// Makes the weights sum to 1, where there are any.
    pub(super) fn normalize(&mut self) {
        let sum: f64 = self.weights.iter().sum();
        if sum > 0.0 {
            self.weights = self.weights.map(|weight| weight / sum);
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.weights[0] <= 0.0
    }

    pub(super) fn iter(&self) -> impl Iterator<Item = (i32, f64)> {
        self.joints.into_iter().zip(self.weights).filter(|(_, weight)| *weight > 0.0)
    }

    pub(super) fn shares_a_joint_with(&self, other: &Self) -> bool {
        self.iter().any(|(joint, _)| other.iter().any(|(of_other, _)| of_other == joint))
    }
}
