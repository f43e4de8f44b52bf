//! Tests of the block that the page is given, read back by a reader of their own.

use std::sync::Arc;

use serde_json::Value;

use super::*;
use crate::geometry::{ConvexPolyhedron, Pose, Vector, testing::near};
use crate::grains::{Block, Grain, GrainSet};
use crate::protocol::Setup;
use crate::record::Frame;
use crate::scenario::Scenario;
use crate::specimen::SpecimenState;

/// Two cubes of 10 mm, one on the other, and one far away.
fn run() -> (Playback, Specimen) {
    let shape = Arc::new(ConvexPolyhedron::cuboid(Vector::repeat(0.01)).expect("a cube"));
    let grain = Grain {
        shape: shape.clone(),
        pose_in_block: Pose::identity(),
        volume: 1e-6,
        mass: 2.65e-3,
        inertia: Vector::repeat(4.4e-8),
        equivalent_diameter: 0.0124,
        fraction: 0,
    };
    let block = Block {
        passing: 0.0125,
        retained: 0.01,
        own_sizes: false,
        side: 0.01,
        origin: Vector::zeros(),
        points: vec![Vector::zeros(); 3],
        first_grain: 0,
        cells: vec![(*shape).clone(); 3],
    };
    let grains = Arc::new(GrainSet {
        grains: vec![grain; 3],
        blocks: vec![block],
        density: 2650.0,
        meshes: vec![],
    });
    let scenario: Scenario = serde_json::from_value(serde_json::json!({
        "name": "three",
        "grains": {
            "total_mass_g": 8, "density_kg_per_m3": 2650,
            "sieve_table": [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }]
        },
        "stages": [{ "stage": "fill_funnel" }]
    }))
    .expect("a scenario");
    let mut state = SpecimenState::before_everything(3);
    for (body, z) in state.bodies.iter_mut().zip([0.005, 0.015, 0.1]) {
        body.body.pose = Pose::translation(0.0, 0.0, z);
        body.body.linear_velocity = Vector::new(0.0, 0.0, -z);
    }
    state.cylinder = true;
    state.time = 0.25;
    let frames = vec![Frame { time: 0.125, ..Frame::of(&state) }, Frame::of(&state)];
    let stage = PlayedStage { name: "pour \"it\"".to_owned(), frames, kept: true };
    let setup = Setup::new(&scenario).expect("the paper's laboratory");
    let playback =
        Playback { scenario: "three".into(), setup, grains: grains.clone(), stages: vec![stage] };
    (playback, Specimen { grains, state })
}

/// A reader of its own, as the page has one.
struct Read {
    text: Value,
    body: Vec<u8>,
}

impl Read {
    fn new(bytes: &[u8]) -> Self {
        assert_eq!(&bytes[..8], MAGIC, "law: the block begins with its name");
        let length = u32::from_le_bytes(bytes[8..12].try_into().expect("four")) as usize;
        assert_eq!(length % 4, 0, "law: numbers are aligned, the text has {length} bytes");
        let text = serde_json::from_slice(&bytes[12..12 + length]).expect("JSON");
        Self { text, body: bytes[12 + length..].to_vec() }
    }

    fn words(&self, pointer: &str) -> Vec<[u8; 4]> {
        let section = self.text.pointer(pointer).unwrap_or_else(|| panic!("no {pointer}"));
        let number = |name: &str| section[name].as_u64().expect("a number") as usize;
        let (from, count) = (number("offset"), number("count"));
        let words = self.body[from..from + 4 * count].chunks_exact(4);
        words.map(|word| word.try_into().expect("four")).collect()
    }

    fn integers(&self, pointer: &str) -> Vec<u32> {
        self.words(pointer).into_iter().map(u32::from_le_bytes).collect()
    }

    fn floats(&self, pointer: &str) -> Vec<f32> {
        self.words(pointer).into_iter().map(f32::from_le_bytes).collect()
    }
}

#[test]
fn everything_of_the_run_is_in_the_block() {
    let (playback, end) = run();
    let data = encode(&playback, &[end]).expect("a block");
    assert_eq!((data.grains, data.stages, data.frames, data.kept), (3, 1, 2, true));
    let read = Read::new(&data.bytes);
    assert_eq!(read.text["stages"][0]["name"], "pour \"it\"");
    assert_eq!(read.text["fractions"][0]["grains"], 3);
    let got = (&read.text["fractions"][0]["colour"], &read.text["plate_colour"]);
    let (of_fractions, of_plate) = palette(&playback.grains);
    let expected = (&json!(of_fractions[0]), &json!(of_plate));
    assert_eq!(got, expected, "law: the colours of pictures (got left, expected right)");

    let constants = read.floats("/constants");
    assert_eq!(constants.len(), 3 * CONSTANTS);
    let expected = [0.0, 10.0, 2.65, 1000.0, 12.4];
    for (n, (&got, expected)) in constants.iter().zip(expected).enumerate() {
        near(&format!("constant {n} of a cube of 10 mm"), got.into(), expected, 0.01 * expected);
    }

    assert_eq!(read.integers("/stages/0/coordination"), [1, 1, 0], "law: two touch, one is alone");
    let velocities = read.floats("/stages/0/velocities_m_per_s");
    assert_eq!(velocities, [0.0, 0.0, -0.005, 0.0, 0.0, -0.015, 0.0, 0.0, -0.1]);

    let frame_bytes = read.text["frame_bytes"].as_u64().expect("a number") as usize;
    assert_eq!(frame_bytes, 40 + 3 * 20, "law: the layout of frames.bin");
    let offset = read.text["stages"][0]["frames"]["offset"].as_u64().expect("a number") as usize;
    let second = &read.body[offset + frame_bytes..][..8];
    let time = f64::from_le_bytes(second.try_into().expect("eight"));
    assert_eq!(time, 0.25, "law: the last frame is the end of the stage");
}

#[test]
fn shapes_are_closed_and_name_their_own_corners() {
    let (playback, end) = run();
    let read = Read::new(&encode(&playback, &[end]).expect("a block").bytes);
    let vertices = read.integers("/shapes/vertex_counts");
    let faces = read.integers("/shapes/face_counts");
    let sizes = read.integers("/shapes/face_sizes");
    let corners = read.integers("/shapes/corners");
    assert_eq!(vertices.len(), 3 + 4, "three grains, then cylinder, funnel, lid and plate");
    assert_eq!((vertices[0], faces[0]), (8, 6), "a cube");
    let coordinates = read.floats("/shapes/vertices_m").len();
    assert_eq!(coordinates, 3 * vertices.iter().sum::<u32>() as usize);
    let (mut face, mut corner) = (0, 0);
    for (shape, (&count, &has)) in vertices.iter().zip(&faces).enumerate() {
        for _ in 0..has {
            let size = sizes[face] as usize;
            assert!(size >= 3, "law: a face has three corners or more, got {size}");
            assert!(
                corners[corner..corner + size].iter().all(|&c| c < count),
                "law: shape {shape} uses its own {count} vertices"
            );
            face += 1;
            corner += size;
        }
    }
    assert_eq!((face, corner), (sizes.len(), corners.len()), "law: nothing is left over");
}
