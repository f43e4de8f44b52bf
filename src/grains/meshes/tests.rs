//! Grains from meshes: what comes back is what was written, what is wrong is
//! told, and what is drawn weighs what was asked for.

mod drawn;
mod hostile;
mod kept;

use std::path::Path;

use super::*;
use crate::grains::{
    generate,
    tests::{few_grains, near},
    write_obj, write_ply, write_stl,
};
use crate::plain::assert_holds;

/// Meshes of a folder, in mm, taken once each.
fn spec(meshes: &[String]) -> MeshGrains {
    MeshGrains {
        meshes: meshes.to_vec(),
        mesh_unit: MeshUnit::Mm,
        density_kg_per_m3: 2650.0,
        hull: false,
        split_surfaces: false,
        largest_vertex_count: 64,
        total_mass_g: None,
        sieve_table: Vec::new(),
        count: None,
    }
}

/// Writes a file and names it.
fn file(folder: &Path, name: &str, content: impl AsRef<[u8]>) -> String {
    let path = folder.join(name);
    std::fs::write(&path, content).expect("a file in a temporary folder");
    path.to_str().expect("UTF-8").to_owned()
}

/// A box as OBJ, outward faces, at a place.
pub(super) fn cuboid_obj(sides: [f64; 3], at: [f64; 3]) -> String {
    let mut text = String::new();
    for i in 0..8 {
        let c: Vec<f64> =
            (0..3).map(|k| at[k] + if i >> k & 1 == 1 { sides[k] } else { 0.0 }).collect();
        text += &format!("v {} {} {}\n", c[0], c[1], c[2]);
    }
    text + "f 1 3 4 2\nf 5 6 8 7\nf 1 2 6 5\nf 3 7 8 4\nf 1 5 7 3\nf 2 4 8 6\n"
}

/// The same file with the corners of each face changed.
pub(super) fn with_corners(obj: &str, change: impl Fn(&mut [usize])) -> String {
    let changed = |line: &str| {
        let Some(corners) = line.strip_prefix("f ") else { return format!("{line}\n") };
        let mut corners: Vec<usize> = corners.split(' ').map(|c| c.parse().unwrap()).collect();
        change(&mut corners);
        format!("f {}\n", corners.iter().map(usize::to_string).collect::<Vec<_>>().join(" "))
    };
    obj.lines().map(changed).collect()
}

/// A box of eight corners that come after those of other boxes.
pub(super) fn after(boxes: usize, obj: &str) -> String {
    with_corners(obj, |corners| corners.iter_mut().for_each(|corner| *corner += 8 * boxes))
}

#[test]
fn numbers_for_people_are_short() {
    for (value, expected) in [
        (0.0, "0"),
        (12.345, "12.3"),
        (0.050_000_1, "0.05"),
        (1000.0, "1000"),
        (123_456.0, "123456"),
        (1.234e-9, "1.23e-9"),
        (-0.5, "-0.5"),
    ] {
        assert_eq!(rounded(value), expected, "three significant digits of {value}");
    }
}
