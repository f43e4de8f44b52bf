//! A specimen as one binary glTF 2.0 file (`.glb`), still or moving: a node a grain and a part of
//! the apparatus, a mesh a shape, a material a sieve fraction.

mod animation;
mod buffers;
mod materials;
mod meshes;
#[cfg(test)]
mod tests;

// What its parts are made of, too.
use serde_json::{Value, json};

use super::moments::{Moment, Moments};
use super::vtk::sieve_sizes;
use crate::geometry::Pose;
use crate::grains::grain_name;
use animation::Animation;
use buffers::*;
use materials::materials;
use meshes::Meshes;

/// A file that no glTF can hold.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[error("{bytes} bytes are more than a .glb file holds (4 GiB); export fewer frames with --every")]
pub struct GlbTooLarge {
    /// How long it would be.
    pub bytes: u64,
}

/// A glTF file and what it holds.
#[derive(Debug, Clone, PartialEq)]
pub struct Glb {
    /// The file.
    pub bytes: Vec<u8>,
    /// Grains in it.
    pub grains: usize,
    /// Keys of the animation; none in a still file.
    pub keys: usize,
}

/// Half the turn from z upwards to y upwards, as glTF has it.
const HALF_SQRT_2: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Writes the end of the last of the stages; with `every`, also how everything
/// got there, as an animation whose keys are about that time in s apart.
///
/// # Errors
/// When the file would be larger than the format allows.
pub fn glb(moments: &Moments, every: Option<f64>) -> Result<Glb, GlbTooLarge> {
    let all = moments.thinned(every.unwrap_or(f64::INFINITY));
    let taken = match every {
        Some(_) => &all[..],
        None => &all[all.len().saturating_sub(1)..],
    };
    let start = taken.first().map_or(0.0, |m| m.frame.time);
    let times = taken.iter().map(|m| [(m.frame.time - start) as f32]).collect();
    let mut file = File {
        taken,
        buffers: Buffers::default(),
        meshes: Meshes::default(),
        nodes: Vec::new(),
        animation: every.map(|_| Animation::new(times)),
    };
    let (materials, of_parts) = materials(&moments.grains);
    // The root turns z upwards into glTF's y upwards; then come two groups.
    file.nodes.push(json!({
        "name": moments.scenario,
        "rotation": numbers([-HALF_SQRT_2, 0.0, 0.0, HALF_SQRT_2]),
    }));
    let grains = file.grains(moments);
    let parts = file.parts(moments, of_parts);
    let mut groups = Vec::new();
    for (name, children) in [("grains", &grains), ("apparatus", &parts)] {
        if !children.is_empty() {
            file.nodes.push(json!({ "name": name, "children": children }));
            groups.push(file.nodes.len() - 1);
        }
    }
    if !groups.is_empty() {
        file.nodes[0]["children"] = groups.into();
    }
    let animation = file.animation.and_then(|a| a.finish("run"));
    let keys = if animation.is_some() { taken.len() } else { 0 };
    let stage = moments.stages.last().map_or("", |s| s.name.as_str());
    let mut document = json!({
        "asset": {
            "version": "2.0",
            "generator": concat!("pluvia ", env!("CARGO_PKG_VERSION")),
        },
        "scene": 0,
        "scenes": [{ "name": format!("{}, {stage}", moments.scenario), "nodes": [0] }],
        "nodes": file.nodes,
    });
    let (views, accessors, bytes) = file.buffers.finish();
    // glTF has no empty lists.
    for (name, list) in [
        ("materials", materials),
        ("meshes", file.meshes.list),
        ("animations", animation.into_iter().collect()),
        ("accessors", accessors),
        ("bufferViews", views),
    ] {
        if !list.is_empty() {
            document[name] = list.into();
        }
    }
    if !bytes.is_empty() {
        document["buffers"] = json!([{ "byteLength": bytes.len() }]);
    }
    let bytes = container(document.to_string().into_bytes(), bytes)?;
    Ok(Glb { bytes, grains: grains.len(), keys })
}

/// A file in the making.
struct File<'a> {
    taken: &'a [Moment<'a>],
    buffers: Buffers,
    meshes: Meshes,
    nodes: Vec<Value>,
    animation: Option<Animation>,
}

impl File<'_> {
    /// Adds a node where it was last; moving, if there is an animation.
    fn node(&mut self, mut node: Value, poses: &[Option<Pose>]) -> usize {
        let last = poses.iter().rev().flatten().next().copied().unwrap_or_else(Pose::identity);
        node["translation"] = numbers(last.translation.vector.iter().copied());
        node["rotation"] = numbers(last.rotation.coords.iter().copied());
        self.nodes.push(node);
        let index = self.nodes.len() - 1;
        if let Some(animation) = &mut self.animation {
            animation.node(index, poses, &mut self.buffers);
        }
        index
    }

    /// Nodes of the grains that were there at any of the moments.
    fn grains(&mut self, moments: &Moments) -> Vec<usize> {
        let sizes = sieve_sizes(&moments.grains);
        let mut nodes = Vec::new();
        for (n, grain) in moments.grains.grains.iter().enumerate() {
            let poses: Vec<Option<Pose>> = self.taken.iter().map(|m| m.frame.grains[n]).collect();
            if poses.iter().all(Option::is_none) {
                continue;
            }
            let mesh = self.meshes.of_shape(&grain.shape, grain.fraction, &mut self.buffers);
            let node = json!({
                "name": grain_name(n),
                "mesh": mesh,
                "extras": {
                    "grain": n,
                    "sieve_fraction": grain.fraction,
                    "sieve_size_m": number(sizes[n]),
                    "mass_kg": number(grain.mass),
                },
            });
            nodes.push(self.node(node, &poses));
        }
        nodes
    }

    /// Nodes of the parts of the apparatus that stood at any of the moments.
    fn parts(&mut self, moments: &Moments, material: usize) -> Vec<usize> {
        let mut nodes = Vec::new();
        for part in &moments.parts {
            let poses: Vec<Option<Pose>> = self.taken.iter().map(|m| part.pose(&m.frame)).collect();
            if poses.iter().all(Option::is_none) {
                continue;
            }
            let name = part.name.as_str();
            let mesh = self.meshes.of_faces(name, &part.faces, material, &mut self.buffers);
            nodes.push(self.node(json!({ "name": name, "mesh": mesh }), &poses));
        }
        nodes
    }
}

/// Text and bytes as the two chunks of a binary file (glTF 2.0, section 4.4).
fn container(mut text: Vec<u8>, mut bytes: Vec<u8>) -> Result<Vec<u8>, GlbTooLarge> {
    text.resize(text.len().next_multiple_of(4), b' ');
    bytes.resize(bytes.len().next_multiple_of(4), 0);
    let chunks = [(b"JSON", text), (b"BIN\0", bytes)];
    let chunks: Vec<_> = chunks.into_iter().filter(|(_, content)| !content.is_empty()).collect();
    let length = 12 + chunks.iter().map(|(_, content)| 8 + content.len()).sum::<usize>();
    let single = |n: usize| u32::try_from(n).map_err(|_| GlbTooLarge { bytes: n as u64 });
    let mut file = b"glTF".to_vec();
    file.extend(2u32.to_le_bytes());
    file.extend(single(length)?.to_le_bytes());
    for (kind, content) in chunks {
        file.extend(single(content.len())?.to_le_bytes());
        file.extend(kind);
        file.extend(content);
    }
    Ok(file)
}
