//! Binary glTF as it is read back, against what it was made from.

use std::collections::BTreeSet;

use gltf::{Gltf, animation::util::ReadOutputs};
use nalgebra::{Quaternion, UnitQuaternion};

use super::*;
use crate::export::testing;
use crate::geometry::Vector;
use crate::measure::testing::assert_near;

/// Reads a file; the crate checks it on the way.
fn read(file: &Glb) -> Gltf {
    Gltf::from_slice(&file.bytes).expect("a sound glTF file")
}

/// How far a node's place is from a pose: m and rad.
fn off(translation: [f32; 3], [x, y, z, w]: [f32; 4], pose: &Pose) -> (f64, f64) {
    let at = Vector::from(translation.map(f64::from));
    let [x, y, z, w] = [x, y, z, w].map(f64::from);
    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    ((at - pose.translation.vector).norm(), turn.angle_to(&pose.rotation))
}

#[test]
fn a_still_file_is_the_end_of_the_last_stage() {
    let moments = testing::moments(&[11, 6], 0.08);
    let made = glb(&moments, None).expect("a file");
    let file = read(&made);
    let end = &moments.stages[1].end;
    assert_eq!((made.keys, file.animations().count()), (0, 0), "law: nothing moves");
    let names: BTreeSet<&str> = file.nodes().filter_map(|n| n.name()).collect();
    for name in ["made up", "grains", "apparatus", "cylinder", "floor", "top_plate"] {
        assert!(names.contains(name), "`{name}` is missing in {names:?}");
    }
    assert!(!names.contains("funnel"), "law: the funnel was taken away");
    let grains: Vec<_> =
        file.nodes().filter(|n| n.name().is_some_and(|n| n.starts_with("grain_"))).collect();
    assert_eq!(grains.len(), end.bodies.len() - 1, "law: one grain is gone");
    assert_eq!(made.grains, grains.len());
    let mut solids = 0.0;
    for node in &grains {
        let number: usize = node.name().expect("a name")[6..].parse().expect("its number");
        let (translation, rotation, scale) = node.transform().decomposed();
        let (way, turn) = off(translation, rotation, &end.bodies[number].body.pose);
        assert_near("place of a grain, off in m", 0.0, way, 1e-7);
        assert_near("turn of a grain, off in rad", 0.0, turn, 1e-6);
        assert_eq!(scale, [1.0; 3]);
        let grain = &moments.grains.grains[number];
        let primitive = node.mesh().expect("a mesh").primitives().next().expect("triangles");
        assert_eq!(primitive.material().index(), Some(grain.fraction), "law: by sieve fraction");
        let reader = primitive.reader(|_| file.blob.as_deref());
        let vector = |p: [f32; 3]| Vector::from(p.map(f64::from));
        let points: Vec<Vector> = reader.read_positions().expect("positions").map(vector).collect();
        let normals: Vec<Vector> = reader.read_normals().expect("normals").map(vector).collect();
        let corners: Vec<usize> =
            reader.read_indices().expect("corners").into_u32().map(|n| n as usize).collect();
        for t in corners.chunks_exact(3) {
            let [a, b, c] = [points[t[0]], points[t[1]], points[t[2]]];
            solids += a.dot(&b.cross(&c)) / 6.0;
            let area = (b - a).cross(&(c - a));
            let along = area.dot(&normals[t[0]]);
            assert_near("normals stand on their faces, m²", area.norm(), along, 1e-9);
        }
    }
    let expected: f64 =
        (0..end.bodies.len()).filter(|&n| n != 1).map(|n| moments.grains.grains[n].volume).sum();
    assert_near("volume of the grains in m³", expected, solids, 1e-5 * expected);
    let names: Vec<&str> = file.materials().filter_map(|m| m.name()).collect();
    assert_eq!(names, ["sieve 12.5 to 16 mm", "sieve 10 to 12.5 mm", "apparatus"]);
    let clear = file.materials().last().expect("the apparatus'");
    assert_eq!(clear.alpha_mode(), gltf::material::AlphaMode::Blend, "law: it can be seen through");
}

#[test]
fn the_root_turns_z_up_into_y_up() {
    let file = read(&glb(&testing::moments(&[3], 0.08), None).expect("a file"));
    let root = file.scenes().next().and_then(|s| s.nodes().next()).expect("a root");
    let (_, [x, y, z, w], _) = root.transform().decomposed();
    let [x, y, z, w] = [x, y, z, w].map(f64::from);
    let turn = UnitQuaternion::new_normalize(Quaternion::new(w, x, y, z));
    let off = (turn * Vector::z() - Vector::y()).norm();
    assert_near("z becomes y, off by", 0.0, off, 1e-6);
    let off = (turn * Vector::x() - Vector::x()).norm();
    assert_near("x stays x, off by", 0.0, off, 1e-6);
}

#[test]
fn grains_of_one_shape_share_their_mesh() {
    let mut moments = testing::moments(&[3], 0.08);
    let meshes = |moments: &Moments| read(&glb(moments, None).expect("a file")).meshes().count();
    let before = meshes(&moments);
    let set = std::sync::Arc::make_mut(&mut moments.grains);
    let (shape, fraction) = (set.grains[0].shape.clone(), set.grains[0].fraction);
    set.grains[2].shape = std::sync::Arc::new((*shape).clone());
    set.grains[2].fraction = fraction;
    assert_eq!(meshes(&moments), before - 1, "law: a mesh a shape");
}

#[test]
fn an_animation_passes_through_the_frames() {
    let moments = testing::moments(&[11, 6], 0.08);
    let made = glb(&moments, Some(0.08)).expect("a file");
    let file = read(&made);
    let taken = moments.thinned(0.08);
    assert_eq!(made.keys, taken.len());
    assert_eq!(file.animations().count(), 1);
    let mut channels = BTreeSet::new();
    for channel in file.animations().next().expect("an animation").channels() {
        let name = channel.target().node().name().expect("a name").to_owned();
        let reader = channel.reader(|_| file.blob.as_deref());
        let times: Vec<f32> = reader.read_inputs().expect("times").collect();
        assert_eq!(times.len(), taken.len(), "law: a key a moment");
        assert_eq!(times[0], 0.0, "law: time begins at 0");
        let last = taken.last().expect("a moment").frame.time - taken[0].frame.time;
        assert_near("length in s", last, f64::from(times[times.len() - 1]), 1e-6);
        let pose = |moment: &Moment| match name.strip_prefix("grain_") {
            Some(n) => moment.frame.grains[n.parse::<usize>().expect("its number")],
            None => {
                let part = moments.parts.iter().find(|p| p.name == name);
                part.expect("a part").pose(&moment.frame)
            }
        };
        match reader.read_outputs().expect("values") {
            ReadOutputs::Translations(places) => {
                let places: Vec<[f32; 3]> = places.collect();
                assert_eq!(places.len(), taken.len());
                for (at, moment) in places.into_iter().zip(&taken) {
                    if let Some(pose) = pose(moment) {
                        let unturned = Pose::from(pose.translation);
                        let (way, _) = off(at, [0.0, 0.0, 0.0, 1.0], &unturned);
                        assert_near("place in a frame, off in m", 0.0, way, 1e-7);
                    }
                }
                channels.insert((name, "translation"));
            }
            ReadOutputs::Rotations(turns) => {
                let turns: Vec<[f32; 4]> = turns.into_f32().collect();
                let jump =
                    turns.windows(2).any(|t| (0..4).map(|i| t[0][i] * t[1][i]).sum::<f32>() < 0.0);
                assert!(!jump, "law: quaternions take the short way");
                for (turn, moment) in turns.into_iter().zip(&taken) {
                    if let Some(pose) = pose(moment) {
                        let at = pose.translation.vector;
                        let at = [at.x as f32, at.y as f32, at.z as f32];
                        let (_, angle) = off(at, turn, &pose);
                        assert_near("turn in a frame, off in rad", 0.0, angle, 1e-5);
                    }
                }
                channels.insert((name, "rotation"));
            }
            ReadOutputs::Scales(sizes) => {
                for (size, moment) in sizes.zip(&taken) {
                    let expected = if pose(moment).is_some() { [1.0; 3] } else { [0.0; 3] };
                    assert_eq!(size, expected, "law: {name} has no size where it is not there");
                }
                channels.insert((name, "scale"));
            }
            ReadOutputs::MorphTargetWeights(_) => panic!("nothing changes its shape"),
        }
    }
    let has = |name: &str, what| channels.contains(&(name.to_owned(), what));
    assert!(has("grain_00000", "translation") && has("grain_00000", "rotation"));
    assert!(!has("grain_00000", "scale"), "law: what is always there keeps its size");
    assert!(has("cylinder", "translation") && !has("cylinder", "rotation"), "{channels:?}");
    assert!(has("funnel", "scale") && has("top_plate", "scale"), "law: they come and go");
}

#[test]
fn a_container_is_two_chunks() {
    let file = container(b"{}".to_vec(), vec![7; 5]).expect("a small file");
    assert_eq!(file.len(), 12 + 8 + 4 + 8 + 8, "law: chunks are filled to multiples of four");
    assert_eq!(&file[12..24], b"\x04\0\0\0JSON{}  ", "law: text is filled with spaces");
    assert_eq!(&file[24..32], b"\x08\0\0\0BIN\0");
    let alone = container(b"{}".to_vec(), Vec::new()).expect("a small file");
    assert_eq!(alone.len(), 24, "law: no empty chunk");
}
