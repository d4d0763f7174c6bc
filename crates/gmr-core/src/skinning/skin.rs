//! What stays from frame to frame: vertices at rest and what they follow, laid out for blending.

use super::SkinError;
use super::arrangement::{Arrangement, Follows, Run, WIDEST, WINDOW, arrange};
use super::lines::{Points, Row, Wide};
use super::running::Signing;
use super::sets::Given;
use crate::error::ShapeError;

/// The most influences that a vertex can have.
const MOST: usize = 1 << 16;

/// A mesh at rest and the joints that its vertices follow.
#[derive(Debug, Clone)]
pub struct Skin {
    pub(super) vertex_count: usize,
    pub(super) joint_count: usize,
    pub(super) arrangement: Arrangement,
    /// Of each block.
    pub(super) positions: Vec<Points>,
    /// Of each block; empty where there are none.
    pub(super) normals: Vec<Points>,
    /// Of each block and influence, in the order of the sets' joints.
    pub(super) weights: Vec<Wide>,
    /// As the weights: which influence was given first, which second and so on. Empty where that is their order.
    pub(super) orders: Vec<[u16; WIDEST]>,
}

/// A vertex where it is laid out.
#[derive(Debug, Clone, Copy)]
pub(super) struct Lane<'a> {
    skin: &'a Skin,
    run: &'a Run,
    /// Which of the run's vertices it is.
    at: usize,
    /// The first vertex of the window.
    start: usize,
}

impl Skin {
    /// A skin of (V, 3) `vertices` that follow (V, K) `joints`, each below `joint_count`, by (V, K) `weights`.
    ///
    /// Weights are taken as they are: they should sum to 1. `normals` are (V, 3) where there are any. What has weight
    /// 0 is no influence, whatever joint it names.
    ///
    /// # Errors
    /// When a length does not fit, a vertex follows a joint that is not there or none at all, or a weight is negative
    /// or not finite.
    pub fn new(
        vertices: &[f32],
        normals: Option<&[f32]>,
        joints: &[i32],
        weights: &[f32],
        joint_count: usize,
    ) -> Result<Self, SkinError> {
        let vertex_count = vertices.len() / 3;
        ShapeError::check("vertices", 3 * vertex_count, vertices.len())?;
        ShapeError::check("weights", joints.len(), weights.len())?;
        let each = joints.len().checked_div(vertex_count).unwrap_or(0);
        ShapeError::check("joints", vertex_count * each, joints.len())?;
        if let Some(normals) = normals {
            ShapeError::check("normals", vertices.len(), normals.len())?;
        }
        if joint_count > 1 << 16 {
            return Err(SkinError::TooManyJoints { joint_count });
        }
        if each > MOST || u32::try_from(joints.len()).is_err() {
            return Err(SkinError::TooManyInfluences { each, vertex_count });
        }
        let given = Given { joints, weights, each };
        for vertex in 0..vertex_count {
            given.check(vertex, joint_count)?;
        }
        let mut skin = Self {
            vertex_count,
            joint_count,
            arrangement: arrange(vertex_count, joint_count, &given),
            positions: vec![],
            normals: vec![],
            weights: vec![],
            orders: vec![],
        };
        skin.positions = skin.arranged(vertices);
        skin.normals = normals.map_or(vec![], |normals| skin.arranged(normals));
        skin.weigh(&given);
        Ok(skin)
    }

    /// V.
    #[must_use]
    pub fn vertex_count(&self) -> usize {
        self.vertex_count
    }

    /// How many joints the transforms are of.
    #[must_use]
    pub fn joint_count(&self) -> usize {
        self.joint_count
    }

    /// Whether there are normals to be turned.
    #[must_use]
    pub fn has_normals(&self) -> bool {
        !self.normals.is_empty() || self.vertex_count == 0
    }

    /// (V, 3) `rows` in blocks.
    pub(super) fn arranged(&self, rows: &[f32]) -> Vec<Points> {
        let mut found = Vec::with_capacity(self.arrangement.places.len());
        for (start, runs) in self.windows() {
            let rows = &rows.as_chunks::<3>().0[start..];
            for places in runs.iter().flat_map(|run| self.arrangement.places_of(run)) {
                let points = places.map(|place| rows[place as usize]);
                found.push([0, 1, 2].map(|axis| Wide(points.map(|point| point[axis]))));
            }
        }
        found
    }

    /// Puts down the weights and in which order they were given.
    fn weigh(&mut self, given: &Given<'_>) {
        let count = self.arrangement.weights;
        let (mut weights, mut orders) = (vec![Wide([0.0; WIDEST]); count], vec![[0; WIDEST]; count]);
        let mut is_ascending = true;
        let mut influences = vec![];
        let mut at = 0;
        for (start, runs) in self.windows() {
            for run in runs {
                for places in self.arrangement.places_of(run) {
                    for (lane, &place) in places.iter().enumerate() {
                        given.influences(start + place as usize, &mut influences);
                        for (k, influence) in influences.iter().enumerate() {
                            weights[at + k].0[lane] = influence.weight;
                            orders[at + influence.given as usize][lane] = k as u16;
                            is_ascending &= influence.given as usize == k;
                        }
                    }
                    at += run.influence_count;
                }
            }
        }
        self.weights = weights;
        self.orders = if is_ascending { vec![] } else { orders };
    }

    /// The first vertex and the runs of each window.
    pub(super) fn windows(&self) -> impl Iterator<Item = (usize, &[Run])> {
        let Arrangement { windows, runs, .. } = &self.arrangement;
        windows.iter().zip((0..).step_by(WINDOW)).map(|(window, start)| (start, &runs[window.clone()]))
    }

    /// The vertices of a run of the window that begins with vertex `start`.
    pub(super) fn lanes<'a>(&'a self, start: usize, run: &'a Run) -> impl Iterator<Item = Lane<'a>> {
        (0..run.length).map(move |at| self.lane(start, run, at))
    }

    /// One of them.
    pub(super) fn lane<'a>(&'a self, start: usize, run: &'a Run, at: usize) -> Lane<'a> {
        Lane { skin: self, run, at, start }
    }

    /// Every vertex, in the caller's order.
    pub(super) fn lanes_by_vertex(&self) -> Vec<Lane<'_>> {
        let mut found: Vec<Lane<'_>> = self
            .windows()
            .flat_map(|(start, runs)| runs.iter().flat_map(move |run| self.lanes(start, run)))
            .collect();
        found.sort_unstable_by_key(|lane| lane.vertex());
        found
    }
}

impl Arrangement {
    fn places_of(&self, run: &Run) -> &[[u16; WIDEST]] {
        &self.places[run.block..][..run.block_count()]
    }
}

impl<'a> Lane<'a> {
    /// Which vertex it is.
    pub(super) fn vertex(self) -> usize {
        self.start + usize::from(self.skin.arrangement.places[self.run.block + self.block()][self.lane()])
    }

    /// Its own of `points`, or of `normals`.
    pub(super) fn point(self, points: &[Points]) -> [f32; 3] {
        let [x, y, z] = &points[self.run.block + self.block()];
        [x.0[self.lane()], y.0[self.lane()], z.0[self.lane()]]
    }

    /// How many joints it follows.
    pub(super) fn influence_count(self) -> usize {
        self.run.influence_count
    }

    /// The `k`-th joint that it follows, in ascending order.
    pub(super) fn joint(self, k: usize) -> u32 {
        let Arrangement { shared, own, .. } = &self.skin.arrangement;
        self.follows(&shared.joints, &own.joints, k)
    }

    /// The place among the pairs of its `k`-th joint beside its pivot.
    pub(super) fn paired(self, k: usize) -> u32 {
        let Arrangement { shared, own, .. } = &self.skin.arrangement;
        self.follows(&shared.paired, &own.paired, k)
    }

    fn follows(self, shared: &[u32], own: &[[u32; WIDEST]], k: usize) -> u32 {
        match self.run.follows {
            Follows::Same(start) => shared[start + k],
            Follows::Each(start) => own[start + self.block() * self.run.influence_count + k][self.lane()],
        }
    }

    /// How much it follows its `k`-th joint.
    pub(super) fn weight(self, k: usize) -> f32 {
        self.weights()[k].0[self.lane()]
    }

    /// Its signs where it follows `rows` by the sum so far.
    pub(super) fn signing(self, rows: &'a [Row]) -> Signing<'a> {
        let weights = self.weights();
        let orders = &self.skin.orders;
        let orders = if orders.is_empty() { orders } else { &orders[self.first_weight()..][..weights.len()] };
        Signing { rows, weights, orders, lane: self.lane() }
    }

    /// For each influence those of its block.
    fn weights(self) -> &'a [Wide] {
        &self.skin.weights[self.first_weight()..][..self.run.influence_count]
    }

    /// Which of the run's blocks holds it.
    fn block(self) -> usize {
        self.at / WIDEST
    }

    /// Which lane of the block it is.
    pub(super) fn lane(self) -> usize {
        self.at % WIDEST
    }

    fn first_weight(self) -> usize {
        self.run.weights + self.block() * self.run.influence_count
    }
}
