//! The grains as meshes for other programs, each at its place in its block, in metres.

use std::fmt::{Display, Write as _};
use std::io::{BufWriter, Write};

use super::*;
use crate::plain::counted;

fn cells(grains: &GrainSet) -> impl Iterator<Item = &ConvexPolyhedron> + Clone + '_ {
    grains.blocks.iter().flat_map(|block| &block.cells)
}

/// Writes a Wavefront OBJ file: one object a grain, polygonal faces, metres.
///
/// # Errors
/// When writing fails.
pub fn write_obj(grains: &GrainSet, mut into: impl Write) -> std::io::Result<()> {
    let title = format!("{}, lengths in metres", counted(cells(grains).count(), "grain"));
    let named = cells(grains).enumerate().map(|(index, cell)| (grain_name(index), cell));
    into.write_all(obj_of(&title, named).as_bytes())
}

/// A Wavefront OBJ file of shapes with their names, where they are.
pub fn obj_of<'a, N: Display>(
    title: &str,
    shapes: impl Iterator<Item = (N, &'a ConvexPolyhedron)>,
) -> String {
    let mut text = format!("# {title}\n");
    // OBJ numbers vertices from 1, through the whole file.
    let mut first = 1;
    // Writing into a string cannot fail.
    for (name, shape) in shapes {
        let _ = writeln!(text, "o {name}");
        for v in shape.vertices() {
            let _ = writeln!(text, "v {} {} {}", v.x, v.y, v.z);
        }
        for face in shape.faces() {
            text.push('f');
            for corner in face {
                let _ = write!(text, " {}", first + *corner as usize);
            }
            text.push('\n');
        }
        first += shape.vertices().len();
    }
    text
}

/// Writes a PLY file (text): all grains in one mesh with polygonal faces,
/// each face with the number of its grain; metres.
///
/// # Errors
/// When writing fails.
pub fn write_ply(grains: &GrainSet, into: impl Write) -> std::io::Result<()> {
    write_ply_of(cells(grains).enumerate(), into)
}

/// The same of shapes with the numbers of their grains, where they are.
///
/// # Errors
/// When writing fails.
pub fn write_ply_of<'a>(
    shapes: impl Iterator<Item = (usize, &'a ConvexPolyhedron)> + Clone,
    into: impl Write,
) -> std::io::Result<()> {
    let mut out = BufWriter::new(into);
    let all = || shapes.clone().map(|(_, shape)| shape);
    let vertices: usize = all().map(|c| c.vertices().len()).sum();
    let faces: usize = all().map(|c| c.faces().len()).sum();
    let most = all().flat_map(ConvexPolyhedron::faces).map(Vec::len).max().unwrap_or(0);
    // Numbers of corners are bytes where they fit.
    let size = if most > usize::from(u8::MAX) { "uint" } else { "uchar" };
    writeln!(
        out,
        "ply\nformat ascii 1.0\ncomment {}, lengths in metres\nelement vertex {vertices}\n\
         property double x\nproperty double y\nproperty double z\nelement face {faces}\n\
         property list {size} int vertex_indices\nproperty int grain\nend_header",
        counted(all().count(), "grain")
    )?;
    for v in all().flat_map(ConvexPolyhedron::vertices) {
        writeln!(out, "{} {} {}", v.x, v.y, v.z)?;
    }
    let mut first = 0;
    for (index, cell) in shapes {
        for face in cell.faces() {
            write!(out, "{}", face.len())?;
            for corner in face {
                write!(out, " {}", first + *corner as usize)?;
            }
            writeln!(out, " {index}")?;
        }
        first += cell.vertices().len();
    }
    out.flush()
}

/// Writes a binary STL file: the triangles of all grains, metres (STL itself
/// knows no unit, and holds single precision).
///
/// # Errors
/// When writing fails.
pub fn write_stl(grains: &GrainSet, into: impl Write) -> std::io::Result<()> {
    write_stl_of(cells(grains), into)
}

/// The same of shapes where they are.
///
/// # Errors
/// When writing fails.
pub fn write_stl_of<'a>(
    shapes: impl Iterator<Item = &'a ConvexPolyhedron> + Clone,
    into: impl Write,
) -> std::io::Result<()> {
    let mut out = BufWriter::new(into);
    // Readers take a file for the text form if it begins with "solid".
    let mut header = [b' '; 80];
    let title = b"grains, lengths in metres";
    header[..title.len()].copy_from_slice(title);
    out.write_all(&header)?;
    let triangles: usize = shapes.clone().map(|c| c.triangles().count()).sum();
    let triangles = u32::try_from(triangles)
        .map_err(|_| std::io::Error::other("STL cannot hold more than 2³² triangles"))?;
    out.write_all(&triangles.to_le_bytes())?;
    for triangle in shapes.flat_map(ConvexPolyhedron::triangles) {
        let [a, b, c] = triangle;
        let normal = (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_default();
        for point in [Point::from(normal), a, b, c] {
            for coordinate in point.iter() {
                out.write_all(&(*coordinate as f32).to_le_bytes())?;
            }
        }
        out.write_all(&[0; 2])?;
    }
    out.flush()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grains::generate;
    use crate::grains::tests::{few_grains, near};

    fn numbers<T: std::str::FromStr>(line: &str) -> Vec<T> {
        line.split_whitespace().filter_map(|w| w.parse().ok()).collect()
    }

    fn same_volume(format: &str, got: f64, grains: &GrainSet, tolerance: f64) {
        let expected = grains.total_volume();
        near(&format!("volume enclosed by the {format}"), got, expected, tolerance * expected);
    }

    #[test]
    fn the_helper_can_fail() {
        let grains = generate(&few_grains(), 1).unwrap();
        for factor in [0.9, 1.1] {
            let wrong = grains.total_volume() * factor;
            assert!(std::panic::catch_unwind(|| same_volume("", wrong, &grains, 0.01)).is_err());
        }
    }

    #[test]
    fn obj_has_an_object_a_grain_and_all_the_volume() {
        let grains = generate(&few_grains(), 1).unwrap();
        let mut bytes = Vec::new();
        write_obj(&grains, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let lines = |prefix: &'static str| text.lines().filter(move |l| l.starts_with(prefix));
        assert_eq!(lines("o ").count(), grains.grains.len(), "one object a grain");
        let points: Vec<Point> =
            lines("v ").map(|l| Point::from_slice(&numbers::<f64>(l))).collect();
        let faces: Vec<Vec<usize>> =
            lines("f ").map(|l| numbers::<usize>(l).iter().map(|n| n - 1).collect()).collect();
        same_volume("OBJ", volume_of_loops(&faces, |v| points[v].coords), &grains, 1e-12);
    }

    /// Law: the type that is announced holds the number of corners of every face.
    #[test]
    fn ply_announces_faces_of_more_corners_than_a_byte_counts() {
        for (sides, size) in [(255, "uchar"), (256, "uint"), (300, "uint")] {
            let corner = |n: u32| {
                let angle = std::f64::consts::TAU * f64::from(n) / f64::from(sides);
                (0.01 * angle.cos(), 0.01 * angle.sin())
            };
            let outline: Vec<(f64, f64)> = (0..sides).map(corner).collect();
            let disc = ConvexPolyhedron::prism(&outline, 0.0, 0.01).expect("a disc");
            let mut bytes = Vec::new();
            write_ply_of(std::iter::once((0, &disc)), &mut bytes).expect("written");
            let text = String::from_utf8(bytes).expect("text");
            let announced = format!("property list {size} int vertex_indices\n");
            assert!(text.contains(&announced), "law: {size} for {sides} corners");
            let row = format!("\n{sides} ");
            assert_eq!(text.matches(&row).count(), 2, "law: two faces of {sides} corners");
        }
    }

    #[test]
    fn ply_announces_what_it_holds() {
        let grains = generate(&few_grains(), 1).unwrap();
        let mut bytes = Vec::new();
        write_ply(&grains, &mut bytes).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let (header, body) = text.split_once("end_header\n").unwrap();
        let announced = |what: &str| -> usize {
            let line = header.lines().find(|l| l.starts_with(what)).unwrap();
            numbers(line)[0]
        };
        let rows: Vec<&str> = body.lines().collect();
        let (v, f) = (announced("element vertex"), announced("element face"));
        assert_eq!(rows.len(), v + f, "rows after the header");
        let points: Vec<Point> =
            rows[..v].iter().map(|l| Point::from_slice(&numbers::<f64>(l))).collect();
        let faces: Vec<Vec<usize>> = rows[v..]
            .iter()
            .map(|l| {
                let row = numbers::<usize>(l);
                assert_eq!(row.len(), row[0] + 2, "count, corners, grain: {l}");
                row[1..=row[0]].to_vec()
            })
            .collect();
        same_volume("PLY", volume_of_loops(&faces, |v| points[v].coords), &grains, 1e-12);
    }

    #[test]
    fn stl_has_the_announced_length_and_outward_normals() {
        let grains = generate(&few_grains(), 1).unwrap();
        let mut bytes = Vec::new();
        write_stl(&grains, &mut bytes).unwrap();
        let count = u32::from_le_bytes(bytes[80..84].try_into().unwrap()) as usize;
        assert_eq!(bytes.len(), 84 + 50 * count, "84 bytes and 50 a triangle");
        let mut volume = 0.0;
        for record in bytes[84..].chunks(50) {
            let f: Vec<f64> = record[..48]
                .chunks(4)
                .map(|b| f64::from(f32::from_le_bytes(b.try_into().unwrap())))
                .collect();
            let [n, a, b, c] =
                [0, 3, 6, 9].map(|i| nalgebra::Vector3::from_row_slice(&f[i..i + 3]));
            let area = (b - a).cross(&(c - a));
            assert!(n.dot(&area) >= 0.0, "normal {n} against the winding {area}");
            volume += a.dot(&b.cross(&c)) / 6.0;
        }
        same_volume("STL", volume, &grains, 1e-5);
    }
}
