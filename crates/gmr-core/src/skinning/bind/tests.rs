//! Laws of binding, and its definition once more, dense and slow, as the oracle.

use glam::{DMat3, DQuat, DVec3};
use proptest::prelude::*;

use super::*;

/// A mesh beside a skeleton; joint 0 is the root.
#[derive(Debug, Clone)]
struct Scene {
    vertices: Vec<DVec3>,
    faces: Vec<i32>,
    places: Vec<DVec3>,
    parents: Vec<usize>,
}

impl Scene {
    /// A bone from each joint to each child; a leaf goes on as the bone before it.
    fn bones(&self) -> (Vec<[DVec3; 2]>, Vec<i32>, Vec<[bool; 2]>) {
        let (mut ends, mut joints, mut open) = (vec![], vec![], vec![]);
        for joint in 0..self.places.len() {
            let place = self.places[joint];
            let children = (1..self.places.len()).filter(|child| self.parents[*child] == joint);
            let mut tails: Vec<(DVec3, bool)> = children.map(|child| (self.places[child], false)).collect();
            if tails.is_empty() {
                let before = if joint == 0 { place - DVec3::Y } else { self.places[self.parents[joint]] };
                tails.push((2.0 * place - before, true));
            }
            let alone = joint == 0 && tails.len() == 1;
            for (tail, is_leaf) in tails {
                ends.push([place, tail]);
                joints.push(joint as i32);
                open.push([alone, is_leaf]);
            }
        }
        (ends, joints, open)
    }

    fn bound(&self, threads: usize) -> Bound {
        let (ends, joints, open) = self.bones();
        let flat = |side: usize| -> Vec<f64> { ends.iter().flat_map(|bone| bone[side].to_array()).collect() };
        let vertices: Vec<f64> = self.vertices.iter().flat_map(|vertex| vertex.to_array()).collect();
        bind(&Bind {
            vertices: &vertices,
            faces: &self.faces,
            heads: &flat(0),
            tails: &flat(1),
            joints: &joints,
            open: &open,
            threads,
        })
        .unwrap()
    }

    fn moved(&self, by: impl Fn(DVec3) -> DVec3) -> Self {
        let all = |places: &[DVec3]| places.iter().map(|place| by(*place)).collect();
        Self { vertices: all(&self.vertices), places: all(&self.places), ..self.clone() }
    }

    /// (V, J) weights and who is in no box, straight from the definition.
    fn defined(&self) -> (Vec<Vec<f64>>, Vec<u32>) {
        let (ends, joints, open) = self.bones();
        let middle = ends.iter().flatten().sum::<DVec3>() / (2 * ends.len()) as f64;
        let slack = 0.01 * ends.iter().flatten().map(|end| (*end - middle).length()).fold(0.0, f64::max);
        let s = |v: DVec3, b: usize| (v - ends[b][0]).dot((ends[b][1] - ends[b][0]).normalize());
        let length = |b: usize| (ends[b][1] - ends[b][0]).length();
        let on_line = |v: DVec3, b: usize, s: f64| (v - ends[b][0].lerp(ends[b][1], s / length(b))).length();
        let distance = |v: DVec3, b: usize| {
            let s = s(v, b);
            match s {
                s if s <= 0.0 => (v - ends[b][0]).length(),
                s if s >= length(b) => (v - ends[b][1]).length(),
                s => on_line(v, b, s),
            }
        };
        let nearest = |v: DVec3| {
            (0..ends.len()).fold(0, |best, b| if distance(v, b) < distance(v, best) { b } else { best })
        };
        let across: Vec<f64> = (0..ends.len())
            .map(|b| {
                let beside = self.vertices.iter().filter(|v| {
                    nearest(**v) == b
                        && (open[b][0] || s(**v, b) >= 0.0)
                        && (open[b][1] || s(**v, b) <= length(b))
                });
                let far = beside.map(|v| on_line(*v, b, s(*v, b))).reduce(f64::max);
                far.unwrap_or(0.35 * length(b)).max(1e-6 * length(b))
            })
            .collect();
        let gradient = |v: DVec3, b: usize| {
            let (s, l, m) = (s(v, b), length(b), 0.35 * length(b));
            let near = distance(v, nearest(v));
            let reach = 1.5 * near + slack;
            if on_line(v, b, s) >= 2.0 * across[b] || distance(v, b) > reach {
                return 0.0;
            }
            let beside = (2.0 - on_line(v, b, s) / across[b]).min(1.0);
            let share = if distance(v, b) > near { (reach - distance(v, b)) / (reach - near) } else { 1.0 };
            let rise = if open[b][0] { 1.0 } else { ((s + m) / (2.0 * m)).clamp(0.0, 1.0) };
            let fall = if open[b][1] { 1.0 } else { ((l + m - s) / (2.0 * m)).clamp(0.0, 1.0) };
            rise * fall * beside * share
        };
        let four_largest = |mut row: Vec<f64>| {
            let mut order: Vec<usize> = (0..row.len()).collect();
            order.sort_by(|a, b| row[*b].total_cmp(&row[*a]));
            order.iter().skip(4).for_each(|joint| row[*joint] = 0.0);
            let sum: f64 = row.iter().sum();
            row.iter().map(|weight| weight / sum.max(f64::MIN_POSITIVE)).collect::<Vec<f64>>()
        };
        let mut outside = vec![];
        let mut rows: Vec<Vec<f64>> = vec![];
        for (number, &v) in self.vertices.iter().enumerate() {
            let mut row = vec![0.0_f64; self.places.len()];
            for (b, joint) in joints.iter().enumerate() {
                let joint = *joint as usize;
                row[joint] = row[joint].max(gradient(v, b));
            }
            if row.iter().all(|weight| *weight == 0.0) {
                row[joints[nearest(v)] as usize] = 1.0;
                outside.push(number as u32);
            }
            rows.push(four_largest(row));
        }
        let before = rows.clone();
        for &v in &outside {
            let here = self.vertices[v as usize];
            let mut beside: Vec<DVec3> = vec![];
            for face in self.faces.chunks(3) {
                let corners: Vec<DVec3> = face.iter().map(|v| self.vertices[*v as usize]).collect();
                if corners.contains(&here) {
                    beside.extend(corners.iter().filter(|corner| **corner != here));
                }
            }
            beside.sort_by(|a, b| a.to_array().partial_cmp(&b.to_array()).unwrap());
            beside.dedup();
            let mut sum = before[v as usize].clone();
            for place in beside {
                let at = self.vertices.iter().position(|vertex| *vertex == place).unwrap();
                sum.iter_mut().zip(&before[at]).for_each(|(sum, weight)| *sum += weight);
            }
            rows[v as usize] = four_largest(sum);
        }
        (rows, outside)
    }
}

fn place(size: f64) -> impl Strategy<Value = DVec3> {
    prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
}

/// A bone's worth of a way; never short beside the others.
fn way() -> impl Strategy<Value = DVec3> {
    place(1.0).prop_map(|way| way.normalize_or(DVec3::Y) * (0.3 + way.length()))
}

fn scenes() -> impl Strategy<Value = Scene> {
    (1..9_usize, 1..40_usize, 0..60_usize).prop_flat_map(|(joint_count, vertex_count, face_count)| {
        let ways = prop::collection::vec((way(), any::<prop::sample::Index>()), joint_count);
        let vertices =
            prop::collection::vec((any::<prop::sample::Index>(), place(1.0), 0.1..3.0), vertex_count);
        let corners = prop::collection::vec(0..vertex_count as i32, 3 * face_count);
        (ways, vertices, corners).prop_map(|(ways, vertices, faces)| {
            let (mut places, mut parents) = (vec![DVec3::ZERO], vec![0]);
            for (way, parent) in &ways[1..] {
                let parent = parent.index(places.len());
                places.push(places[parent] + *way);
                parents.push(parent);
            }
            let near =
                vertices.iter().map(|(joint, way, far)| places[joint.index(places.len())] + *way * *far);
            let mut vertices: Vec<DVec3> = near.collect();
            let twins: Vec<DVec3> = vertices.iter().step_by(3).copied().collect();
            let faces = faces
                .iter()
                .zip(0..)
                .map(|(v, k)| if k % 2 == 0 && v % 3 == 0 { vertices.len() as i32 + v / 3 } else { *v });
            let faces = faces.collect();
            vertices.extend(twins);
            Scene { vertices, faces, places, parents }
        })
    })
}

fn dense(bound: &Bound, joint_count: usize) -> Vec<Vec<f64>> {
    let rows = bound.joints.as_chunks::<4>().0.iter().zip(bound.weights.as_chunks::<4>().0);
    rows.map(|(joints, weights)| {
        let mut row = vec![0.0; joint_count];
        joints.iter().zip(weights).for_each(|(joint, weight)| row[*joint as usize] += f64::from(*weight));
        row
    })
    .collect()
}

fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> f64 {
    let pairs = a.iter().flatten().zip(b.iter().flatten());
    pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

proptest! {
    #[test]
    fn binding_is_what_its_definition_says(scene in scenes()) {
        let (bound, (weights, outside)) = (scene.bound(1), scene.defined());
        prop_assert_eq!(&bound.outside, &outside);
        prop_assert!(apart(&dense(&bound, scene.places.len()), &weights) < 1e-6);
    }

    #[test]
    fn weights_are_not_negative_sum_to_one_and_come_strongest_first(scene in scenes()) {
        let bound = scene.bound(1);
        prop_assert_eq!(bound.weights.len(), 4 * scene.vertices.len());
        for (weights, joints) in bound.weights.as_chunks::<4>().0.iter().zip(bound.joints.as_chunks::<4>().0) {
            prop_assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-6);
            prop_assert!(weights[3] >= 0.0 && weights.is_sorted_by(|a, b| a >= b));
            for k in 0..4 {
                prop_assert!(weights[k] > 0.0 || joints[k] == 0);
                prop_assert!(weights[k] == 0.0 || !joints[..k].contains(&joints[k]));
                prop_assert!((0..scene.places.len() as i32).contains(&joints[k]));
            }
        }
    }

    #[test]
    fn a_rigid_motion_of_mesh_and_skeleton_changes_nothing(scene in scenes(), axis in place(1.0), way in place(9.0)) {
        let turn = DQuat::from_scaled_axis(3.0 * axis);
        let moved = scene.moved(|place| turn * place + way);
        let count = scene.places.len();
        prop_assert!(apart(&dense(&moved.bound(1), count), &dense(&scene.bound(1), count)) < 1e-6);
    }

    #[test]
    fn scale_changes_nothing(scene in scenes(), power in -40..40_i32) {
        prop_assert_eq!(scene.moved(|place| place * 2.0_f64.powi(power)).bound(1), scene.bound(1));
    }

    #[test]
    fn a_mirror_changes_nothing_to_the_bit(scene in scenes(), axis in 0..3_usize) {
        let mut mirror = DMat3::IDENTITY;
        mirror.col_mut(axis)[axis] = -1.0;
        prop_assert_eq!(scene.moved(|place| mirror * place).bound(1), scene.bound(1));
    }

    #[test]
    fn vertices_at_one_place_get_the_same_weights(scene in scenes()) {
        let bound = scene.bound(1);
        let rows: Vec<_> = bound.joints.chunks(4).zip(bound.weights.chunks(4)).collect();
        for (a, of_a) in scene.vertices.iter().zip(&rows) {
            for (b, of_b) in scene.vertices.iter().zip(&rows) {
                prop_assert!(a != b || of_a == of_b);
            }
        }
    }

    #[test]
    fn faces_change_only_what_is_in_no_box(scene in scenes()) {
        let (bound, loose) = (scene.bound(1), Scene { faces: vec![], ..scene.clone() }.bound(1));
        prop_assert_eq!(&bound.outside, &loose.outside);
        for v in (0..scene.vertices.len()).filter(|v| !bound.outside.contains(&(*v as u32))) {
            prop_assert_eq!(&bound.joints[4 * v..][..4], &loose.joints[4 * v..][..4]);
            prop_assert_eq!(&bound.weights[4 * v..][..4], &loose.weights[4 * v..][..4]);
        }
    }

    #[test]
    fn consecutive_bones_share_a_vertex_at_their_joint_half_and_half(a in way(), b in way(), aside in place(0.1)) {
        // The vertex lies in the plane that is across both bones.
        let across = a.cross(b);
        prop_assume!(across.length() > 0.01);
        let places = vec![-a, DVec3::ZERO, b, b + b];
        let vertex = across.normalize() * aside.length();
        let beside = [-0.5 * a, 0.5 * b].map(|middle| middle + 2.0 * vertex);
        let scene = Scene { vertices: vec![vertex, beside[0], beside[1]], faces: vec![], places, parents: vec![0, 0, 1, 2] };
        let weights = &dense(&scene.bound(1), 4)[0];
        prop_assert!((weights[0] - 0.5).abs() < 1e-6 && (weights[1] - 0.5).abs() < 1e-6, "{weights:?}");
    }

    #[test]
    fn a_vertex_in_the_middle_of_a_long_lone_bone_follows_it_alone(long in 4.0..50.0, aside in place(0.3)) {
        let places = [0.0, 1.0, 1.0 + long, 2.0 + long].map(|x| x * DVec3::X).to_vec();
        let vertex = (1.0 + 0.5 * long) * DVec3::X + aside;
        let scene = Scene { vertices: vec![vertex], faces: vec![], places, parents: vec![0, 0, 1, 2] };
        let bound = scene.bound(1);
        prop_assert_eq!((bound.joints[0], bound.weights[0]), (1, 1.0));
    }
}

#[test]
fn the_bits_do_not_depend_on_threads() {
    let places: Vec<DVec3> = (0..12).map(|k| DVec3::new(f64::from(k), f64::from(k * k % 5), 0.0)).collect();
    let parents = (0..12_usize).map(|k| k.saturating_sub(1)).collect();
    let vertices: Vec<DVec3> = (0..5000_u32)
        .map(f64::from)
        .map(|k| DVec3::new(k.rem_euclid(11.7), (0.7 * k).rem_euclid(5.3), (0.31 * k).rem_euclid(2.9) - 1.0))
        .collect();
    let faces = (0..15_000).map(|k| (k * 7) % 5000).collect();
    let scene = Scene { vertices, faces, places, parents };
    let alone = scene.bound(1);
    for threads in [0, 2, 3, 7] {
        assert_eq!(scene.bound(threads), alone);
    }
}

#[test]
fn smoothing_mends_the_edge_between_a_box_and_what_is_in_none() {
    // The second vertex is past the end of the second bone's box.
    let job = Bind {
        vertices: &[0.5, 0.1, 0.0, 9.0, 0.0, 0.0],
        faces: &[0, 1, 1],
        heads: &[0.0, 0.0, 0.0, 5.0, 0.0, 0.0],
        tails: &[1.0, 0.0, 0.0, 6.0, 0.0, 0.0],
        joints: &[2, 1],
        open: &[[false; 2]; 2],
        threads: 1,
    };
    let bound = bind(&job).unwrap();
    assert_eq!((bound.outside, bound.torn, bound.still_torn), (vec![1], 1, 0));
    assert_eq!(bound.joints, [2, 0, 0, 0, 1, 2, 0, 0]);
    assert_eq!(bound.weights, [1.0, 0.0, 0.0, 0.0, 0.5, 0.5, 0.0, 0.0]);
    let loose = bind(&Bind { faces: &[], ..job }).unwrap();
    assert_eq!(loose.weights[4..], [1.0, 0.0, 0.0, 0.0]);
}

#[test]
fn a_bone_without_length_takes_what_is_nearest_to_it() {
    let scene =
        Scene { vertices: vec![DVec3::X], faces: vec![0, 0, 0], places: vec![DVec3::ZERO], parents: vec![0] };
    let vertices: Vec<f64> = scene.vertices[0].to_array().to_vec();
    let zeros = [0.0; 3];
    let job = Bind {
        vertices: &vertices,
        faces: &scene.faces,
        heads: &zeros,
        tails: &zeros,
        joints: &[5],
        open: &[[true; 2]],
        threads: 1,
    };
    let bound = bind(&job).unwrap();
    assert_eq!((bound.joints[0], bound.weights[0], bound.outside), (5, 1.0, vec![0]));
}

#[test]
fn what_is_wrong_is_named() {
    let ok = Bind {
        vertices: &[0.0; 9],
        faces: &[0, 1, 2],
        heads: &[0.0; 3],
        tails: &[0.0, 1.0, 0.0],
        joints: &[0],
        open: &[[true; 2]],
        threads: 1,
    };
    assert!(bind(&ok).is_ok());
    let said = |job: Bind<'_>| bind(&job).unwrap_err().to_string();
    let nowhere = [0.0, 0.0, 0.0, 0.0, f64::NAN, 0.0];
    assert!(said(Bind { vertices: &nowhere, faces: &[], ..ok }).contains("vertex 1 lies at [0.0, NaN, 0.0]"));
    assert!(said(Bind { vertices: &[1e101, 0.0, 0.0], faces: &[], ..ok }).contains("vertex 0"));
    assert!(said(Bind { vertices: &[0.0; 8], ..ok }).contains("vertices"));
    assert!(said(Bind { faces: &[0, 1, 3], ..ok }).contains("triangle 0 names vertex 3, but there are 3"));
    assert!(said(Bind { faces: &[0, -1, 2], ..ok }).contains("vertex -1"));
    assert!(said(Bind { tails: &[f64::INFINITY, 0.0, 0.0], ..ok }).contains("bone 0, of joint 0"));
    assert!(said(Bind { joints: &[-1], ..ok }).contains("joint -1"));
    assert!(said(Bind { joints: &[], heads: &[], tails: &[], open: &[], ..ok }).contains("no bone"));
}
