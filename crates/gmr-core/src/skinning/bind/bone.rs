//! A bone, and the box round it.
//!
//! Along the bone the box reaches `m = 0.35 l` beyond each end, l being the length. Across, it is round: r being as far
//! as the farthest vertex whose nearest bone this is and that projects onto it, it holds all of a vertex within r, and
//! none at 2 r. So no direction across the bone is chosen, and a turned skeleton has the same boxes turned; and no
//! weight jumps at an edge of a box, for it has fallen to 0 there.
//!
//! At an open end, where no other bone meets this one, the box and what projects onto it go on for ever. A bone
//! without length has no direction, hence no box.

use glam::DVec3;

/// How far a box reaches beyond the ends of its bone, and across where no vertex says: in lengths.
const MARGIN: f64 = 0.35;

/// The least radius of a box, in lengths, so that rounding throws nothing out that lies on the bone.
const THINNEST: f64 = 1e-6;

/// A segment that turns with a joint.
#[derive(Debug, Clone, Copy)]
pub(super) struct Bone {
    pub(super) head: DVec3,
    pub(super) tail: DVec3,
    /// Of length 1; 0 where the bone has no length.
    pub(super) direction: DVec3,
    pub(super) length: f64,
    pub(super) joint: i32,
    /// At the head, at the tail.
    pub(super) open: [bool; 2],
}

impl Bone {
    pub(super) fn new(head: DVec3, tail: DVec3, joint: i32, open: [bool; 2]) -> Self {
        let length = head.distance(tail);
        let direction = (tail - head).normalize_or_zero();
        Self { head, tail, direction, length, joint, open }
    }

    /// `s = (v - h) . d`
    pub(super) fn projection(&self, vertex: DVec3) -> f64 {
        (vertex - self.head).dot(self.direction)
    }

    /// The squared distance from the bone's line.
    pub(super) fn aside_squared(&self, vertex: DVec3, projection: f64) -> f64 {
        (vertex - self.head - projection * self.direction).length_squared()
    }

    /// The squared distance from the segment. Beyond an end it is that from the end itself, so that bones that meet
    /// there are equally far, to the bit.
    pub(super) fn distance_squared(&self, vertex: DVec3) -> f64 {
        let projection = self.projection(vertex);
        if projection <= 0.0 {
            vertex.distance_squared(self.head)
        } else if projection >= self.length {
            vertex.distance_squared(self.tail)
        } else {
            self.aside_squared(vertex, projection)
        }
    }

    fn holds(&self, projection: f64) -> bool {
        (projection >= 0.0 || self.open[0]) && (projection <= self.length || self.open[1])
    }
}

/// A bone with the size of its box.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boxed {
    pub(super) bone: Bone,
    margin: f64,
    /// r: how far from the bone's line its own vertices are; negative where there is no box.
    radius: f64,
}

impl Boxed {
    /// `g = clamp((s + m) / 2m, 0, 1) clamp((l + m - s) / 2m, 0, 1) clamp((2r - a) / r, 0, 1)`, without the factor of
    /// an open end, a being how far the vertex is from the bone's line.
    pub(super) fn gradient(&self, vertex: DVec3) -> f64 {
        let (bone, margin) = (&self.bone, self.margin);
        let s = bone.projection(vertex);
        let across = 2.0 - bone.aside_squared(vertex, s).sqrt() / self.radius;
        if self.radius < 0.0 || across <= 0.0 {
            return 0.0;
        }
        let rise = if bone.open[0] { 1.0 } else { ((s + margin) / (2.0 * margin)).clamp(0.0, 1.0) };
        let fall =
            if bone.open[1] { 1.0 } else { ((bone.length + margin - s) / (2.0 * margin)).clamp(0.0, 1.0) };
        rise * fall * across.min(1.0)
    }
}

/// The bone nearest to a vertex; of equally near ones the first.
#[derive(Debug, Clone, Copy)]
pub(super) struct Near {
    pub(super) bone: u32,
    pub(super) distance_squared: f64,
}

impl Default for Near {
    fn default() -> Self {
        Self { bone: 0, distance_squared: f64::INFINITY }
    }
}

/// The boxes that fit what is nearest to each bone.
pub(super) fn boxes(vertices: &[DVec3], bones: &[Bone], near: &[Near]) -> Vec<Boxed> {
    let mut farthest: Vec<Option<f64>> = vec![None; bones.len()];
    for (vertex, near) in vertices.iter().zip(near) {
        let (bone, farthest) = (&bones[near.bone as usize], &mut farthest[near.bone as usize]);
        let projection = bone.projection(*vertex);
        if bone.holds(projection) {
            let aside = bone.aside_squared(*vertex, projection);
            *farthest = Some(farthest.map_or(aside, |known| known.max(aside)));
        }
    }
    bones
        .iter()
        .zip(farthest)
        .map(|(bone, farthest)| {
            let radius = farthest.map_or(MARGIN * bone.length, f64::sqrt).max(THINNEST * bone.length);
            let radius = if bone.length > 0.0 { radius } else { -1.0 };
            Boxed { bone: *bone, margin: MARGIN * bone.length, radius }
        })
        .collect()
}

/// How much farther than the nearest bone another may be.
#[derive(Debug, Clone, Copy)]
pub(super) struct Reach {
    slack: f64,
}

impl Reach {
    const TIMES: f64 = 1.5;

    /// A centimetre for a human, whose joints lie up to about a metre from their middle.
    const SLACK: f64 = 0.01;

    pub(super) fn of(bones: &[Bone]) -> Self {
        let ends = || bones.iter().flat_map(|bone| [bone.head, bone.tail]);
        let middle = ends().sum::<DVec3>() / (2 * bones.len()) as f64;
        let size = ends().map(|end| end.distance(middle)).fold(0.0, f64::max);
        Self { slack: Self::SLACK * size }
    }

    /// The part of its gradient that a bone keeps at a distance: all where it is the nearest, less the farther it
    /// is, none from 1.5 times as far on. So no weight jumps where a bone comes within reach.
    pub(super) fn share(self, near: Near, distance_squared: f64) -> f64 {
        let (nearest, distance) = (near.distance_squared.sqrt(), distance_squared.sqrt());
        if distance <= nearest {
            return 1.0;
        }
        let end = Self::TIMES * nearest + self.slack;
        ((end - distance) / (end - nearest)).max(0.0)
    }
}
