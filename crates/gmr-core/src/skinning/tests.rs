//! The laws of blending, on random skins.

use glam::{DAffine3, DMat3, DMat4, DQuat, DVec3, Vec3};
use proptest::prelude::*;

use super::*;
use crate::Isa;

const METHODS: [&str; 4] = ["linear", "pivot", "running", "centers"];

/// A random skin, and transforms for it.
#[derive(Debug, Clone)]
struct Scene {
    vertices: Vec<f32>,
    normals: Vec<f32>,
    joints: Vec<i32>,
    weights: Vec<f32>,
    centers: Vec<f32>,
    transforms: Vec<DAffine3>,
    joint_count: usize,
    frame_count: usize,
}

impl Scene {
    fn skin(&self) -> Skin {
        Skin::new(&self.vertices, Some(&self.normals), &self.joints, &self.weights, self.joint_count).unwrap()
    }

    fn method(&self, name: &str) -> Method<'_> {
        match name {
            "linear" => Method::Linear,
            "pivot" => Method::DualQuaternion(Hemisphere::Pivot),
            "running" => Method::DualQuaternion(Hemisphere::Running),
            _ => Method::Centers(&self.centers),
        }
    }

    /// Positions and normals.
    fn blended(&self, isa: Isa, method: &str, threads: usize) -> [Vec<f32>; 2] {
        let skin = self.skin();
        let transforms: Vec<f64> =
            self.transforms.iter().flat_map(|t| DMat4::from(*t).transpose().to_cols_array()).collect();
        let mut positions = vec![f32::NAN; self.frame_count * self.vertices.len()];
        let mut normals = positions.clone();
        let job = Blend {
            skin: &skin,
            transforms: &transforms,
            frame_count: self.frame_count,
            method: self.method(method),
            threads,
        };
        blend_on(isa, &job, Blended { positions: &mut positions, normals: Some(&mut normals) }).unwrap();
        [positions, normals]
    }

    fn vertex_count(&self) -> usize {
        self.vertices.len() / 3
    }
}

fn rotation() -> impl Strategy<Value = DQuat> + Clone {
    prop::array::uniform4(-1.0_f64..1.0)
        .prop_filter("no direction", |q| q.iter().map(|c| c * c).sum::<f64>() > 1e-2)
        .prop_map(|q| DQuat::from_array(q).normalize())
}

fn rigid() -> impl Strategy<Value = DAffine3> + Clone {
    (rotation(), prop::array::uniform3(-2.0_f64..2.0))
        .prop_map(|(q, t)| DAffine3::from_rotation_translation(q, DVec3::from(t)))
}

fn stretching() -> impl Strategy<Value = DAffine3> + Clone {
    (rigid(), prop::array::uniform9(-0.3_f64..0.3)).prop_map(|(rigid, bend)| DAffine3 {
        matrix3: rigid.matrix3 * (DMat3::IDENTITY + DMat3::from_cols_array(&bend)),
        translation: rigid.translation,
    })
}

fn scene(transform: impl Strategy<Value = DAffine3> + Clone) -> impl Strategy<Value = Scene> {
    (1_usize..70, 1_usize..7, 1_usize..6, 1_usize..19).prop_flat_map(
        move |(vertices, joints, influences, frames)| {
            let numbers = |count: usize| prop::collection::vec(-1.0_f32..1.0, count);
            (
                numbers(3 * vertices),
                prop::collection::vec(0.1_f32..1.0, 3 * vertices),
                prop::collection::vec(0..joints as i32, vertices * influences),
                prop::collection::vec(0.05_f32..1.0, vertices * influences),
                numbers(3 * vertices),
                prop::collection::vec(transform.clone(), frames * joints),
            )
                .prop_map(move |(vertices, normals, mut of, weights, centers, transforms)| {
                    // A joint that a vertex follows twice is followed once, and once not at all.
                    let mut weights = weights;
                    for (joints_of, weights) in of.chunks_mut(influences).zip(weights.chunks_mut(influences))
                    {
                        for k in 0..influences {
                            if joints_of[..k].contains(&joints_of[k]) {
                                (weights[k], joints_of[k]) = (0.0, -7);
                            }
                        }
                        let sum: f32 = weights.iter().sum();
                        weights.iter_mut().for_each(|w| *w /= sum);
                    }
                    let normals =
                        normals.as_chunks::<3>().0.iter().flat_map(|n| Vec3::from(*n).normalize().to_array());
                    Scene {
                        normals: normals.collect(),
                        vertices,
                        joints: of,
                        weights,
                        centers,
                        transforms,
                        joint_count: joints,
                        frame_count: frames,
                    }
                })
        },
    )
}

fn points(numbers: &[f32]) -> Vec<DVec3> {
    numbers.as_chunks::<3>().0.iter().map(|p| Vec3::from(*p).as_dvec3()).collect()
}

fn bits(numbers: &[f32]) -> Vec<u32> {
    numbers.iter().map(|x| x.to_bits()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(48))]

    #[test]
    fn every_instruction_set_and_thread_count_gives_the_bits_of_the_definition(scene in scene(stretching())) {
        for method in METHODS {
            let [positions, normals] = scene.blended(Isa::Scalar, method, 1);
            for (isa, threads) in Isa::available().flat_map(|isa| [(isa, 1), (isa, 3)]) {
                let found = scene.blended(isa, method, threads);
                prop_assert_eq!(bits(&found[0]), bits(&positions), "{} {}", isa, method);
                prop_assert_eq!(bits(&found[1]), bits(&normals), "{} {}", isa, method);
            }
        }
    }

    #[test]
    fn linear_blending_is_the_weighted_sum_of_moved_vertices(scene in scene(stretching())) {
        let [positions, normals] = scene.blended(Isa::current(), "linear", 1).map(|numbers| points(&numbers));
        let (vertices, rest_normals) = (points(&scene.vertices), points(&scene.normals));
        let influences = scene.joints.len() / scene.vertex_count();
        for frame in 0..scene.frame_count {
            for (v, vertex) in vertices.iter().enumerate() {
                let mut sum = DMat4::ZERO;
                for k in v * influences..(v + 1) * influences {
                    if scene.weights[k] > 0.0 {
                        let joint = frame * scene.joint_count + scene.joints[k] as usize;
                        sum += DMat4::from(scene.transforms[joint]) * f64::from(scene.weights[k]);
                    }
                }
                let at = frame * vertices.len() + v;
                prop_assert!(positions[at].abs_diff_eq(sum.transform_point3(*vertex), 2e-6));
                let linear = DMat3::from_mat4(sum);
                if linear.determinant().abs() > 1e-2 {
                    let normal = (linear.inverse().transpose() * rest_normals[v]).normalize();
                    prop_assert!(normals[at].abs_diff_eq(normal, 1e-3), "{} {}", normals[at], normal);
                }
            }
        }
    }

    #[test]
    fn what_moves_as_one_body_moves_as_that_body(mut scene in scene(rigid()), body in stretching()) {
        scene.transforms.fill(body);
        for method in METHODS {
            let [positions, normals] = scene.blended(Isa::current(), method, 1).map(|numbers| points(&numbers));
            for (k, (position, normal)) in positions.iter().zip(normals).enumerate() {
                let v = k % scene.vertex_count();
                let vertex = points(&scene.vertices)[v];
                prop_assert!(position.abs_diff_eq(body.transform_point3(vertex), 1e-5), "{}", method);
                let turned = (body.matrix3.inverse().transpose() * points(&scene.normals)[v]).normalize();
                prop_assert!(normal.abs_diff_eq(turned, 1e-4), "{}", method);
            }
        }
    }

    #[test]
    fn dual_quaternion_blending_keeps_distances_of_what_shares_its_weights(mut scene in scene(rigid())) {
        let influences = scene.joints.len() / scene.vertex_count();
        for v in 1..scene.vertex_count() {
            scene.joints.copy_within(0..influences, v * influences);
            scene.weights.copy_within(0..influences, v * influences);
        }
        for method in ["pivot", "running"] {
            let positions = points(&scene.blended(Isa::current(), method, 1)[0]);
            let vertices = points(&scene.vertices);
            for (k, position) in positions.iter().enumerate() {
                let (first, v) = (k / vertices.len() * vertices.len(), k % vertices.len());
                let (now, rest) = ((*position - positions[first]).length(), (vertices[v] - vertices[0]).length());
                prop_assert!((now - rest).abs() < 1e-4, "{}: {} for {}", method, now, rest);
            }
        }
    }

    #[test]
    fn normals_stay_of_length_one(scene in scene(rigid())) {
        for method in ["pivot", "running", "centers"] {
            for normal in points(&scene.blended(Isa::current(), method, 1)[1]) {
                prop_assert!((normal.length() - 1.0).abs() < 1e-4, "{}", method);
            }
        }
    }
}

/// A vertex beside the axis of two joints that share it, the second twisted.
fn twisted(method: &str, angle: f64) -> DVec3 {
    let scene = Scene {
        vertices: vec![1.0, 0.5, 0.0],
        normals: vec![1.0, 0.0, 0.0],
        joints: vec![0, 1],
        weights: vec![0.5, 0.5],
        centers: vec![0.0, 0.5, 0.0],
        transforms: vec![DAffine3::IDENTITY, DAffine3::from_rotation_y(angle)],
        joint_count: 2,
        frame_count: 1,
    };
    points(&scene.blended(Isa::current(), method, 1)[0])[0]
}

#[test]
fn linear_blending_collapses_in_a_twist_and_the_others_do_not() {
    for degrees in [10.0_f64, 90.0, 170.0] {
        let angle = degrees.to_radians();
        let radius = |method| DVec3 { y: 0.0, ..twisted(method, angle) }.length();
        assert!((radius("linear") - (0.5 * angle).cos()).abs() < 1e-6);
        for method in ["pivot", "running", "centers"] {
            assert!((radius(method) - 1.0).abs() < 1e-6, "{method} at {degrees}");
        }
    }
}

/// A crowd of vertices, each of which follows one of some sets of up to `most` joints; of one number everything else
/// follows.
fn crowd(vertex_count: usize, set_count: usize, most: usize, seed: u64) -> Scene {
    let mut state = seed;
    let mut random = |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let joint_count = most + 3;
    let sets: Vec<Vec<i32>> = (0..set_count)
        .map(|_| {
            let mut joints: Vec<i32> = (0..joint_count as i32).collect();
            (0..most).for_each(|k| joints.swap(k, k + random(joint_count - k)));
            joints[..1 + random(most)].to_vec()
        })
        .collect();
    let (mut joints, mut weights) = (vec![], vec![]);
    for _ in 0..vertex_count {
        let mut set = sets[random(set_count)].clone();
        let turn = random(set.len());
        set.rotate_left(turn);
        let mut row: Vec<f32> = set.iter().map(|_| 0.01 + random(1000) as f32 / 1000.0).collect();
        let sum: f32 = row.iter().sum();
        row.iter_mut().for_each(|weight| *weight /= sum);
        row.resize(most, 0.0);
        set.resize(most, -1);
        joints.extend(set);
        weights.extend(row);
    }
    let mut numbers =
        |count: usize| -> Vec<f32> { (0..count).map(|_| random(2000) as f32 / 1000.0 - 1.0).collect() };
    let (vertices, centers) = (numbers(3 * vertex_count), numbers(3 * vertex_count));
    let transforms = numbers(12 * joint_count)
        .chunks(12)
        .map(|m| DAffine3 {
            matrix3: DMat3::from_cols_array(&std::array::from_fn(|k| m[k].into())),
            translation: DVec3::new(m[9].into(), m[10].into(), m[11].into()),
        })
        .collect();
    let normals = [0.6, 0.0, -0.8].repeat(vertex_count);
    Scene { vertices, normals, joints, weights, centers, transforms, joint_count, frame_count: 1 }
}

impl Scene {
    /// The same with one vertex alone.
    fn alone(&self, vertex: usize) -> Self {
        let each = self.joints.len() / self.vertex_count();
        let three = |numbers: &[f32]| numbers[3 * vertex..][..3].to_vec();
        Self {
            vertices: three(&self.vertices),
            normals: three(&self.normals),
            centers: three(&self.centers),
            joints: self.joints[each * vertex..][..each].to_vec(),
            weights: self.weights[each * vertex..][..each].to_vec(),
            ..self.clone()
        }
    }
}

/// Few and many vertices, sets and influences; whole windows of vertices and what is left of them.
const CROWDS: [(usize, usize, usize); 11] = [
    (1, 1, 1),
    (7, 1, 4),
    (8, 1, 3),
    (16, 1, 2),
    (17, 2, 4),
    (300, 5, 4),
    (300, 300, 4),
    (300, 6, 9),
    (4095, 40, 4),
    (4096, 4096, 4),
    (4113, 3, 7),
];

#[test]
fn crowds_move_alike_on_every_instruction_set_and_thread_count() {
    for (seed, (vertices, sets, influences)) in (0..).zip(CROWDS) {
        let mut scene = crowd(vertices, sets, influences, seed);
        let further: Vec<DAffine3> = scene.transforms.iter().rev().copied().collect();
        (1..18).for_each(|_| scene.transforms.extend(&further));
        scene.frame_count = 18;
        for method in METHODS {
            let [positions, normals] = scene.blended(Isa::Scalar, method, 1);
            for (isa, threads) in Isa::available().flat_map(|isa| [(isa, 1), (isa, 3)]) {
                let found = scene.blended(isa, method, threads);
                assert!(bits(&found[0]) == bits(&positions), "{isa} {method}, crowd {seed}");
                assert!(bits(&found[1]) == bits(&normals), "{isa} {method}, crowd {seed}");
            }
        }
    }
}

#[test]
fn threads_that_share_the_vertices_of_a_frame_give_the_same() {
    let scene = crowd(70_000, 50, 4, 5);
    for method in METHODS {
        let expected = scene.blended(Isa::Scalar, method, 1);
        assert!(scene.blended(Isa::current(), method, 3).map(|n| bits(&n)) == expected.map(|n| bits(&n)));
    }
}

#[test]
fn a_vertex_moves_in_a_crowd_as_it_does_alone() {
    for (seed, (vertices, sets, influences)) in (0..).zip(CROWDS) {
        let scene = crowd(vertices, sets, influences, seed);
        for method in METHODS {
            let [positions, normals] = scene.blended(Isa::current(), method, 1);
            for vertex in (0..vertices).step_by(1 + vertices / 100) {
                let alone = scene.alone(vertex).blended(Isa::current(), method, 1);
                let place = 3 * vertex..3 * vertex + 3;
                assert_eq!(
                    bits(&alone[0]),
                    bits(&positions[place.clone()]),
                    "{method}, vertex {vertex}, crowd {seed}"
                );
                assert_eq!(bits(&alone[1]), bits(&normals[place]), "{method}, vertex {vertex}, crowd {seed}");
            }
        }
    }
}

#[test]
fn in_which_order_influences_are_given_matters_to_the_running_sum_alone() {
    let scene = crowd(500, 20, 4, 11);
    let mut turned = scene.clone();
    turned.joints.chunks_mut(4).for_each(|joints| joints.reverse());
    turned.weights.chunks_mut(4).for_each(|weights| weights.reverse());
    for method in METHODS {
        let given = scene.blended(Isa::current(), method, 1).map(|numbers| bits(&numbers));
        let reversed = turned.blended(Isa::current(), method, 1).map(|numbers| bits(&numbers));
        assert_eq!(given == reversed, method != "running", "{method}");
    }
}

#[test]
fn nan_stays_with_the_vertices_that_follow_it() {
    for (seed, (vertices, sets, influences)) in (0..).zip(CROWDS) {
        let mut scene = crowd(vertices, sets, influences, seed);
        let sound = scene.transforms.clone();
        scene.transforms[1].translation.x = f64::NAN;
        scene.transforms.extend(sound);
        scene.frame_count = 2;
        let follows = |vertex: usize| {
            let row = vertex * influences..(vertex + 1) * influences;
            row.clone().any(|k| scene.joints[k] == 1 && scene.weights[k] > 0.0)
        };
        for (method, isa) in METHODS.into_iter().flat_map(|m| Isa::available().map(move |isa| (m, isa))) {
            let positions = points(&scene.blended(isa, method, 1)[0]);
            for (k, position) in positions.iter().enumerate() {
                let expected = k < vertices && follows(k);
                assert_eq!(position.is_nan(), expected, "{method} {isa}, vertex {k}, crowd {seed}");
            }
        }
    }
}

#[test]
fn wrong_skins_are_refused_in_words() {
    let vertices = [0.0; 6];
    let refused = |joints: &[i32], weights: &[f32]| {
        Skin::new(&vertices, None, joints, weights, 2).expect_err("refused").to_string()
    };
    assert!(refused(&[0, 2], &[1.0, 1.0]).starts_with("vertex 1 follows joint 2, but there are 2"));
    assert!(refused(&[0, -1], &[1.0, 1.0]).starts_with("vertex 1 follows joint -1"));
    assert!(refused(&[0, 1], &[1.0, f32::NAN]).starts_with("vertex 1 has the weight NaN"));
    assert!(refused(&[0, 1], &[-0.5, 1.0]).starts_with("vertex 0 has the weight -0.5"));
    assert!(refused(&[0, 1], &[1.0, 0.0]).starts_with("vertex 1 follows no joint"));
    assert!(refused(&[0, 1, 0], &[1.0, 0.0, 1.0]).contains("joints holds 3 elements where 2 are needed"));
    assert!(Skin::new(&vertices, None, &[0, 5], &[1.0, 0.0], 1).is_err());
    assert!(Skin::new(&vertices, None, &[0, 9, 0, 9], &[1.0, 0.0, 1.0, 0.0], 1).is_ok());
    assert!(Skin::new(&[], None, &[], &[], 0).is_ok());
}

#[test]
fn projective_transforms_and_missing_normals_are_refused() {
    let skin = Skin::new(&[0.0; 3], None, &[0], &[1.0], 1).unwrap();
    let mut transforms = DMat4::IDENTITY.to_cols_array().repeat(2);
    let (mut positions, mut normals) = ([0.0; 6], [0.0; 6]);
    let blended = |transforms: &[f64], normals: Option<&mut [f32]>, positions: &mut [f32]| {
        let job = Blend { skin: &skin, transforms, frame_count: 2, method: Method::Linear, threads: 1 };
        blend(&job, Blended { positions, normals })
    };
    assert_eq!(blended(&transforms, Some(&mut normals), &mut positions), Err(SkinError::NoNormals));
    // A translation in the last row is that of a transform for row vectors.
    transforms[16 + 12] = 3.0;
    let expected = Err(SkinError::NotAffine { frame: 1, joint: 0 });
    assert_eq!(blended(&transforms, None, &mut positions), expected);
    assert!(blended(&transforms[..16], None, &mut positions).is_err());
}

/// The sums as the paper writes them: every vertex with every triangle, no weight rounded.
fn centers_by_definition(scene: &Scene, faces: &[i32]) -> Vec<DVec3> {
    let influences = scene.joints.len() / scene.vertex_count();
    let dense = |v: usize| {
        let mut row = vec![0.0; scene.joint_count];
        for k in v * influences..(v + 1) * influences {
            if scene.weights[k] > 0.0 {
                row[scene.joints[k] as usize] += f64::from(scene.weights[k]);
            }
        }
        row
    };
    let vertices = points(&scene.vertices);
    (0..vertices.len())
        .map(|v| {
            let u = dense(v);
            let (mut moment, mut total) = (DVec3::ZERO, 0.0);
            for corners in faces.as_chunks::<3>().0 {
                let [a, b, c] = corners.map(|corner| vertices[corner as usize]);
                let area = 0.5 * (b - a).cross(c - a).length();
                let rows = corners.map(|corner| dense(corner as usize));
                let w: Vec<f64> =
                    (0..scene.joint_count).map(|j| rows.iter().map(|r| r[j]).sum::<f64>() / 3.0).collect();
                for (j, k) in
                    (0..u.len()).flat_map(|j| (0..u.len()).map(move |k| (j, k))).filter(|(j, k)| j != k)
                {
                    let apart = (u[j] * w[k] - u[k] * w[j]) / 0.1;
                    let share = u[j] * u[k] * w[j] * w[k] * (-apart * apart).exp() * area;
                    total += share;
                    moment += share * (a + b + c) / 3.0;
                }
            }
            if total > 0.0 { moment / total } else { vertices[v] }
        })
        .collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn centers_are_those_of_the_definition(scene in scene(rigid()), corners in prop::collection::vec(0_i32..1000, 30)) {
        let count = scene.vertex_count() as i32;
        let faces: Vec<i32> = corners.iter().map(|c| c % count).collect();
        let skin = scene.skin();
        let found = centers_of_rotation(&skin, &faces, 1).unwrap();
        prop_assert_eq!(bits(&found), bits(&centers_of_rotation(&skin, &faces, 3).unwrap()));
        for (found, expected) in points(&found).iter().zip(centers_by_definition(&scene, &faces)) {
            // Weights are rounded to 1/256, and the share of a far triangle changes fast with them.
            prop_assert!(found.abs_diff_eq(expected, 0.1), "{} {}", found, expected);
        }
    }
}

#[test]
fn faces_outside_the_skin_are_refused() {
    let skin = Skin::new(&[0.0; 9], None, &[0; 3], &[1.0; 3], 1).unwrap();
    let refused = centers_of_rotation(&skin, &[0, 1, 3], 1).expect_err("refused").to_string();
    assert_eq!(refused, "triangle 0 names vertex 3, but there are 3");
}
