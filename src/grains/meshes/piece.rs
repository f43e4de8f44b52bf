//! Meshes as pieces of a laboratory: every closed surface is a convex part.

use super::*;
use crate::scenario::{MOST_PARTS, MeshPart};

/// Most corners of a part.
const MOST_VERTICES: u32 = 1000;

/// How far inside its hull a face of a part may lie, as a fraction of the part's size: the rounding
/// of files, not a hole or a dent.
const WITHIN: f64 = 1e-4;

/// What to do with a part that is not convex.
const SPLIT: &str = "convex surfaces that are not joined: split it into convex parts, in Blender \
                     for instance by Mesh > Bisect with Fill and Separate, as objects of one OBJ file";

/// The convex parts of a mesh file, lengths multiplied by a number to be mm.
///
/// # Errors
/// Every fault of the file, with the object in it as path.
pub fn parts_of_piece(file: &Path, scale_to_mm: f64) -> Result<Vec<MeshPart>, Vec<Fault>> {
    let objects = read::objects(file).map_err(|error| match error {
        ReadError::Fault(fault) => vec![fault],
        ReadError::Unreadable(reason) => {
            let message = format!("the mesh cannot be read: {reason}");
            vec![Fault::new(message, file.display(), "an OBJ, STL or PLY file")]
        }
    })?;
    // Lengths stay those of the file.
    let spec = MeshGrains {
        meshes: Vec::new(),
        mesh_unit: MeshUnit::M,
        density_kg_per_m3: 1.0,
        hull: false,
        split_surfaces: true,
        largest_vertex_count: MOST_VERTICES,
        total_mass_g: None,
        sieve_table: Vec::new(),
        count: None,
    };
    let (mut parts, mut faults) = (Vec::new(), Vec::new());
    for object in objects {
        let found = each_surface(&object, &spec, scale_to_mm, |surface, _| {
            let split = |fault| Fault { allowed: SPLIT.to_owned(), ..fault };
            let (shape, record) = shape::convex(surface, &spec).map_err(split)?;
            check_hull(surface, &shape, &record)?;
            let vertices = shape.vertices().iter().map(|v| (v.coords * scale_to_mm).into());
            let (vertices_mm, faces) = (vertices.collect(), shape.faces().to_vec());
            parts.push(MeshPart { vertices_mm, faces });
            Ok(())
        });
        faults.extend(found.into_iter().map(|fault| Fault {
            message: fault.message.replace("the grain", "the surface"),
            ..fault
        }));
    }
    if parts.len() > MOST_PARTS {
        let found = format!("{} parts", parts.len());
        let allowed = format!("at most {MOST_PARTS}");
        faults.push(Fault::new("the mesh has too many parts", found, allowed));
    }
    if faults.is_empty() { Ok(parts) } else { Err(faults) }
}

/// Refuses a hull that is not the part itself: grains may be simpler than their scans, pieces not.
fn check_hull(
    surface: &Surface,
    shape: &ConvexPolyhedron,
    record: &MeshRecord,
) -> Result<(), Fault> {
    if record.left_out > 0.0 {
        return Err(Fault::new(
            "the surface has too many corners",
            format!("{} corners", surface.vertices.len()),
            format!("at most {MOST_VERTICES}"),
        ));
    }
    let slack = WITHIN * extent(&surface.vertices);
    let planes: Vec<(Vector, f64)> =
        (0..shape.faces().len()).filter_map(|face| shape.plane(face)).collect();
    let on_hull = |face: &Vec<u32>| {
        let at = |v: &u32| surface.vertices[*v as usize].coords;
        planes.iter().any(|(n, d)| face.iter().all(|v| (n.dot(&at(v)) - d).abs() <= slack))
    };
    // What is not replaced by its hull is convex.
    if !record.hull || surface.faces.iter().all(on_hull) {
        return Ok(());
    }
    let more = rounded(record.hull_adds_percent());
    let message = format!("the surface is not convex: its hull has {more} % more volume");
    Err(Fault::new(message, "faces inside of its hull", SPLIT))
}

#[cfg(test)]
mod tests {
    use super::super::tests::{after, cuboid_obj, with_corners};
    use super::*;

    /// An OBJ file of blocks between two corners, in one object or each in its own.
    fn obj(blocks: &[[[f64; 3]; 2]], apart: bool) -> String {
        let mut text = String::new();
        for (n, [low, high]) in blocks.iter().enumerate() {
            if apart || n == 0 {
                text += &format!("o part_{n}\n");
            }
            let sides = [0, 1, 2].map(|axis| high[axis] - low[axis]);
            text += &after(n, &cuboid_obj(sides, *low));
        }
        text
    }

    fn read(name: &str, content: &str) -> Result<Vec<MeshPart>, Vec<Fault>> {
        let folder = tempfile::tempdir().expect("a folder");
        let file = folder.path().join(name);
        std::fs::write(&file, content).expect("written");
        parts_of_piece(&file, 10.0)
    }

    #[test]
    fn every_closed_surface_is_a_part_in_mm() {
        let apart = [[[0.0; 3], [1.0, 2.0, 3.0]], [[5.0, 0.0, 0.0], [6.0, 1.0, 1.0]]];
        // Parts that touch are no one surface where they are objects of their own.
        let touching = [[[0.0; 3], [1.0, 2.0, 3.0]], [[1.0, 0.0, 0.0], [2.0, 2.0, 3.0]]];
        for (blocks, own) in [(apart, false), (apart, true), (touching, true)] {
            let parts = read("a.obj", &obj(&blocks, own)).unwrap_or_else(|e| panic!("{e:?}"));
            assert_eq!(parts.len(), 2, "law: two surfaces, two parts");
            for (part, [low, high]) in parts.iter().zip(&blocks) {
                assert_eq!((part.vertices_mm.len(), part.faces.len()), (8, 6), "law: a block");
                for axis in 0..3 {
                    let at = part.vertices_mm.iter().map(|v| v[axis]);
                    assert_eq!(at.clone().fold(f64::MAX, f64::min), 10.0 * low[axis]);
                    assert_eq!(at.fold(f64::MIN, f64::max), 10.0 * high[axis]);
                }
            }
        }
    }

    /// Law: a cube of one unit of 10 mm that is turned inside out encloses −1000 mm³, and a sheet of
    /// it a volume in mm³, too.
    #[test]
    fn volumes_are_given_in_the_unit_of_the_file() {
        let cube = obj(&[[[0.0; 3], [1.0; 3]]], false);
        let inside_out = with_corners(&cube, <[usize]>::reverse);
        let found = read("cube.obj", &inside_out).expect_err("law: it is inside out");
        let Fault { message, found, .. } = &found[0];
        assert!(message.contains("inside out") && found == "-1000 mm³", "{message}, got {found}");
        let sheet = obj(&[[[0.0; 3], [1.0, 1.0, 1e-5]]], false);
        let found = read("sheet.obj", &sheet).expect_err("law: it has no volume to speak of");
        let Fault { found, allowed, .. } = &found[0];
        assert_eq!((found.as_str(), allowed.as_str()), ("0.01 mm³", "more than 0.1 mm³"));
    }

    /// Law: a part is what its mesh is. A hole or a dent is refused however small its share of the
    /// volume; what rounding of a file makes of a plane is not.
    #[test]
    fn small_holes_and_dents_are_not_filled() {
        let mut plate = "o plate\n".to_owned();
        for (low, high) in [(0.0, 100.0), (47.5, 52.5)] {
            for z in [0, 10] {
                for (x, y) in [(low, low), (high, low), (high, high), (low, high)] {
                    plate += &format!("v {x} {y} {z}\n");
                }
            }
        }
        for n in 0..4 {
            let m = (n + 1) % 4;
            plate += &format!("f {} {} {} {}\n", 1 + n, 1 + m, 5 + m, 5 + n);
            plate += &format!("f {} {} {} {}\n", 9 + m, 9 + n, 13 + n, 13 + m);
            plate += &format!("f {} {} {} {}\n", 5 + n, 5 + m, 13 + m, 13 + n);
            plate += &format!("f {} {} {} {}\n", 1 + m, 1 + n, 9 + n, 9 + m);
        }
        let dented = |depth: f64| {
            let top = "f 5 6 9\nf 6 8 9\nf 8 7 9\nf 7 5 9\n";
            let centre = format!("v 50 50 {}\nf 1 3 4 2\n", 100.0 - depth);
            let cube = cuboid_obj([100.0; 3], [0.0; 3]).replace("f 5 6 8 7\n", top);
            cube.replace("f 1 3 4 2\n", &centre)
        };
        // 0.25 % of a plate, 0.17 % of a cube: both hold more than 99 % of their hulls.
        for (name, text) in [("plate.obj", plate), ("dent.obj", dented(0.5))] {
            let found = read(name, &text).expect_err("law: refused");
            let Fault { message, allowed, .. } = &found[0];
            assert!(message.contains("not convex"), "law: {name}, got {found:?}");
            assert!(allowed.contains("split it into convex parts"), "law: what to do, {allowed}");
        }
        let parts = read("rounded.obj", &dented(0.005)).unwrap_or_else(|e| panic!("{e:?}"));
        assert_eq!(parts[0].vertices_mm.len(), 8, "law: a cube");
    }

    /// Law: a part has up to 1000 corners; one with more is refused, not made simpler.
    #[test]
    fn parts_of_too_many_corners_are_refused() {
        let prism = |sides: usize| {
            let mut text = String::new();
            let angle = |n: usize| std::f64::consts::TAU * n as f64 / sides as f64;
            for z in [0, 4] {
                for (sin, cos) in (0..sides).map(|n| angle(n).sin_cos()) {
                    text += &format!("v {} {} {z}\n", 10.0 * cos, 10.0 * sin);
                }
            }
            let polygon = |corners: Vec<usize>| {
                let corners: Vec<String> = corners.iter().map(usize::to_string).collect();
                format!("f {}\n", corners.join(" "))
            };
            text += &polygon((1..=sides).rev().collect());
            text += &polygon((sides + 1..=2 * sides).collect());
            for n in 1..=sides {
                let next = n % sides + 1;
                text += &polygon(vec![n, next, sides + next, sides + n]);
            }
            text
        };
        let parts = read("500.obj", &prism(500)).unwrap_or_else(|e| panic!("{e:?}"));
        assert_eq!(parts[0].vertices_mm.len(), 1000, "law: as many are kept");
        let found = read("600.obj", &prism(600)).expect_err("law: refused");
        let Fault { message, found, .. } = &found[0];
        assert!(message.contains("too many corners") && found == "1200 corners", "{message}");
    }

    #[test]
    fn what_is_not_convex_is_refused_with_what_to_do() {
        // An L: a hexagon in x and y drawn along z.
        let corners = [(0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2)];
        let mut text = "o bracket\n".to_owned();
        for z in [0, 1] {
            for (x, y) in corners {
                text += &format!("v {x} {y} {z}\n");
            }
        }
        text += "f 4 3 2 1\nf 6 5 4 1\nf 7 8 9 10\nf 7 10 11 12\n";
        for n in 1..=6 {
            let next = n % 6 + 1;
            text += &format!("f {n} {next} {} {}\n", next + 6, n + 6);
        }
        let found = read("l.obj", &text).expect_err("law: it is concave");
        assert_eq!(found.len(), 1, "{found:?}");
        let Fault { path, message, allowed, .. } = &found[0];
        assert!(path == "bracket" && message.contains("not convex"), "law: which, {found:?}");
        assert!(allowed.contains("split it into convex parts"), "law: what to do, {allowed}");
        let none = parts_of_piece(Path::new("/no/such/file.stl"), 1.0).expect_err("law: not there");
        assert!(none[0].message.contains("cannot be read"), "{none:?}");
        assert!(read("a.txt", "x").is_err(), "law: the ending tells the format");
    }
}
