//! Convex meshes are kept as they are; others become their hulls.

use super::*;
use crate::grains::{Grain, GrainSet};

/// Grains in the same order, equal within a tolerance relative to their size.
fn same_grains(law: &str, got: &GrainSet, expected: &GrainSet, tolerance: f64) {
    assert_eq!(got.grains.len(), expected.grains.len(), "{law}: number of grains");
    for (i, (g, e)) in got.grains.iter().zip(&expected.grains).enumerate() {
        let size = e.equivalent_diameter;
        near(&format!("{law}: volume of grain {i}"), g.volume, e.volume, tolerance * e.volume);
        let of = |grain: &Grain| (grain.inertia / grain.volume) / size.powi(2);
        let off = (of(g) - of(e)).amax();
        near(&format!("{law}: moments of grain {i}"), off, 0.0, tolerance * 1e4);
        near(
            &format!("{law}: largest radius of grain {i}"),
            g.shape.radius_about_origin(),
            e.shape.radius_about_origin(),
            tolerance * size,
        );
    }
}

#[test]
fn meshes_written_are_grains_read_back() {
    let folder = tempfile::tempdir().unwrap();
    let grains = generate(&few_grains(), 7).unwrap();
    let mut written = Vec::new();
    write_obj(&grains, &mut written).unwrap();
    let obj = file(folder.path(), "grains.obj", &written);
    written.clear();
    write_ply(&grains, &mut written).unwrap();
    let ply = file(folder.path(), "grains.ply", &written);
    for path in [obj, ply] {
        let in_metres = MeshGrains {
            mesh_unit: MeshUnit::M,
            density_kg_per_m3: grains.density,
            ..spec(std::slice::from_ref(&path))
        };
        let back = from_meshes(&in_metres, 1).unwrap_or_else(|e| panic!("{path}: {e}"));
        same_grains(&path, &back, &grains, 1e-12);
        near("mass, kg", back.total_mass(), grains.total_mass(), 1e-12);
        for (record, grain) in back.meshes.iter().zip(&grains.grains) {
            let expected = (grain.shape.vertices().len(), grain.shape.faces().len());
            assert_eq!((record.vertices, record.faces), expected, "faces are as in the file");
            assert!(!record.hull && record.convexity == 1.0 && record.grains == 1, "{record:?}");
        }
        assert!(MeshRecord::notes(&back.meshes).is_empty(), "nothing to note");
    }
}

/// Law: a disc of 300 corners comes back from PLY, whose usual count of corners ends at 255.
#[test]
fn faces_of_many_corners_come_back_from_ply() {
    let folder = tempfile::tempdir().unwrap();
    let corner = |i: u32| {
        let angle = std::f64::consts::TAU * f64::from(i) / 300.0;
        (0.01 * angle.cos(), 0.01 * angle.sin())
    };
    let polygon: Vec<(f64, f64)> = (0..300).map(corner).collect();
    let disc = ConvexPolyhedron::prism(&polygon, 0.0, 0.004).unwrap();
    let mut grains = generate(&few_grains(), 7).unwrap();
    grains.blocks.truncate(1);
    grains.blocks[0].cells = vec![disc.clone()];
    let mut written = Vec::new();
    write_ply(&grains, &mut written).unwrap();
    let path = file(folder.path(), "disc.ply", &written);
    let objects = super::super::read::objects(Path::new(&path)).expect("law: it can be read");
    assert_eq!(objects.len(), 1, "law: one grain");
    assert_eq!(objects[0].vertices, disc.vertices(), "law: the corners that were written");
    assert_eq!(objects[0].faces, disc.faces(), "law: the faces that were written");
}

#[test]
fn single_precision_triangles_become_faces_again() {
    let folder = tempfile::tempdir().unwrap();
    let grains = generate(&few_grains(), 7).unwrap();
    let mut files = Vec::new();
    // One file a grain: in one STL file, cells that touch cannot be told apart.
    for (i, grain) in grains.grains.iter().enumerate() {
        let mut one =
            GrainSet { grains: vec![], blocks: grains.blocks[..1].to_vec(), ..grains.clone() };
        one.blocks[0].cells = vec![grain.shape.transformed(&grain.pose_in_block)];
        let mut written = Vec::new();
        write_stl(&one, &mut written).unwrap();
        files.push(file(folder.path(), &format!("{i:03}.stl"), &written));
    }
    let pattern = format!("{}/*.stl", folder.path().display());
    let spec = MeshGrains {
        mesh_unit: MeshUnit::M,
        density_kg_per_m3: grains.density,
        hull: true,
        ..spec(&[pattern])
    };
    let back = from_meshes(&spec, 1).unwrap();
    same_grains("STL", &back, &grains, 1e-5);
    let mut regained = 0;
    for (record, grain) in back.meshes.iter().zip(&grains.grains) {
        regained += usize::from(record.faces == grain.shape.faces().len());
        assert!(record.convexity > 0.99999, "convex within rounding: {record:?}");
    }
    let all = grains.grains.len();
    assert!(regained * 10 >= all * 9, "{regained} of {all} grains have their faces again");
    for grain in &back.grains {
        grain.shape.sanity_check().unwrap();
    }
}

#[test]
fn a_triangulated_box_is_a_box_in_every_format() {
    let folder = tempfile::tempdir().unwrap();
    let obj = cuboid_obj([10.0, 20.0, 30.0], [5.0, 0.0, -3.0]);
    let mut triangles = Vec::new();
    let vertices: Vec<&str> = obj.lines().filter_map(|l| l.strip_prefix("v ")).collect();
    for line in obj.lines().filter_map(|l| l.strip_prefix("f ")) {
        let c: Vec<usize> = line.split(' ').map(|w| w.parse::<usize>().unwrap() - 1).collect();
        triangles.extend([[c[0], c[1], c[2]], [c[0], c[2], c[3]]]);
    }
    let mut ascii = String::from("SOLID box\n");
    let mut binary = b"solid made by a program that calls binary files so".to_vec();
    binary.resize(80, 0);
    binary.extend((triangles.len() as u32).to_le_bytes());
    for t in &triangles {
        ascii += "FACET NORMAL nan nan nan\n OUTER LOOP\n";
        binary.extend([0; 12]);
        for &v in t {
            ascii += &format!("  VERTEX {}\n", vertices[v]);
            for c in vertices[v].split(' ') {
                binary.extend(c.parse::<f32>().unwrap().to_le_bytes());
            }
        }
        binary.extend([0; 2]);
        ascii += " ENDLOOP\nENDFACET\n";
    }
    ascii += "ENDSOLID box\n";
    let fan: String = triangles
        .iter()
        .map(|t| format!("f {}//1 -{} {}/2/3\n", t[0] + 1, 8 - t[1], t[2] + 1))
        .collect();
    let mut fanned = obj.lines().take(8).collect::<Vec<_>>().join("\n");
    fanned = format!("mtllib a.mtl\n{fanned}\nvn 0 0 1\no stone \\\n  one\nusemtl red\n{fan}");
    for (name, content) in [
        ("box.obj", obj.clone().into_bytes()),
        ("fan.OBJ", fanned.into_bytes()),
        ("ascii.stl", ascii.into_bytes()),
        ("binary.stl", binary),
    ] {
        let path = file(folder.path(), name, content);
        let set = from_meshes(&spec(&[path]), 1).unwrap_or_else(|e| panic!("{name}: {e}"));
        let record = &set.meshes[0];
        assert_eq!((record.vertices, record.faces), (8, 6), "{name}: a box, {record:?}");
        near(&format!("{name}: volume"), set.grains[0].volume, 6e-6, 1e-17);
        near(&format!("{name}: sieve size"), record.sieve_size, 0.02, 2e-4);
        let (retained, passing) = (set.blocks[0].retained, set.blocks[0].passing);
        assert!(
            retained <= 0.02 * (1.0 + 1e-9) && passing >= 0.02 * (1.0 - 1e-9),
            "{name}: law: 20 mm lie between the sieves, got {retained} and {passing} m"
        );
    }
}

/// A cube of 20 mm with a dent: its top face goes down to a point.
fn dented(depth: f64) -> String {
    let top = "f 5 6 8 7\n";
    let obj = cuboid_obj([20.0; 3], [0.0; 3]).replace(top, "");
    let (vertices, faces) = obj.split_at(obj.find('f').unwrap());
    format!(
        "o dented\n{vertices}v 10 10 {}\n{faces}f 5 6 9\nf 6 8 9\nf 8 7 9\nf 7 5 9\n",
        20.0 - depth
    )
}

#[test]
fn a_dent_is_filled_only_when_asked_or_small() {
    let folder = tempfile::tempdir().unwrap();
    // The dent is a pyramid: a third of its height times the face.
    let deep = file(folder.path(), "deep.obj", dented(12.0));
    let error = from_meshes(&spec(std::slice::from_ref(&deep)), 1).unwrap_err();
    let words =
        ["deep.obj", "dented", "not convex", "25 % more volume", "80 %", "99 %", "\"hull\": true"];
    assert_holds(&error.to_string(), &words);
    let asked = MeshGrains { hull: true, ..spec(&[deep]) };
    let set = from_meshes(&asked, 1).unwrap();
    let record = &set.meshes[0];
    near("volume of the mesh, m³", record.mesh_volume, 6.4e-6, 1e-17);
    near("volume of the hull, m³", record.volume, 8e-6, 1e-16);
    near("percent that the hull adds", record.hull_adds_percent(), 25.0, 1e-9);
    assert!(record.hull && record.vertices == 8 && record.faces == 6, "{record:?}");
    let notes = MeshRecord::notes(&set.meshes).join("\n");
    assert!(notes.contains("1 of 1 mesh,") && notes.contains("25 %"), "{notes}");

    let shallow = file(folder.path(), "shallow.obj", dented(0.5));
    let set = from_meshes(&spec(&[shallow]), 1).expect("99.2 % of the hull is enough");
    assert!(set.meshes[0].hull, "it is its hull: {:?}", set.meshes[0]);
    near("convexity", set.meshes[0].convexity, 1.0 - 0.5 / 60.0, 1e-9);
}

/// A ball of a number of rings of triangles, radius 10 mm, as a scan would have it.
fn ball(rings: usize) -> String {
    let mut text = String::from("v 0 0 10\n");
    let count = 2 * rings;
    for ring in 1..rings {
        let polar = std::f64::consts::PI * ring as f64 / rings as f64;
        for i in 0..count {
            let angle = std::f64::consts::TAU * i as f64 / count as f64;
            let (x, y) = (polar.sin() * angle.cos(), polar.sin() * angle.sin());
            text += &format!("v {} {} {}\n", 10.0 * x, 10.0 * y, 10.0 * polar.cos());
        }
    }
    text += "v 0 0 -10\n";
    let at = |ring: usize, i: usize| 2 + (ring - 1) * count + i % count;
    let last = 2 + (rings - 1) * count;
    for i in 0..count {
        text += &format!("f 1 {} {}\n", at(1, i), at(1, i + 1));
        for ring in 1..rings - 1 {
            text += &format!("f {} {} {}\n", at(ring, i), at(ring + 1, i), at(ring + 1, i + 1));
            text += &format!("f {} {} {}\n", at(ring, i), at(ring + 1, i + 1), at(ring, i + 1));
        }
        text += &format!("f {last} {} {}\n", at(rings - 1, i + 1), at(rings - 1, i));
    }
    text
}

#[test]
fn fine_scans_are_simplified_and_say_what_it_cost() {
    let folder = tempfile::tempdir().unwrap();
    // 25 000 triangles.
    let path = file(folder.path(), "ball.obj", ball(80));
    let mut before = f64::INFINITY;
    for most in [16, 64, 200] {
        let spec = MeshGrains { largest_vertex_count: most, ..spec(std::slice::from_ref(&path)) };
        let set = from_meshes(&spec, 1).unwrap();
        let record = &set.meshes[0];
        assert!(record.vertices <= most as usize, "{} of {most} vertices", record.vertices);
        assert!(record.hull && record.left_out > 0.0 && record.left_out < before, "{record:?}");
        let change = record.volume_change_percent();
        assert!(change < 0.0, "an inscribed shape is smaller: {change} %");
        near(
            "change of volume in percent",
            change,
            100.0 * (set.grains[0].volume / record.mesh_volume - 1.0),
            1e-9,
        );
        assert!(MeshRecord::notes(&set.meshes).join(" ").contains("simplified"));
        before = record.left_out;
        if most == 64 {
            assert!((-15.0..-5.0).contains(&change), "64 vertices in a ball: {change} %");
        }
    }
}

/// Law: what a hull adds to one mesh is no change of another, which was simplified; and notes count
/// meshes, of which any number of grains may be made.
#[test]
fn the_note_of_simplified_hulls_speaks_of_these_alone() {
    let folder = tempfile::tempdir().unwrap();
    let deep = file(folder.path(), "deep.obj", dented(12.0));
    let fine = file(folder.path(), "ball.obj", ball(20));
    let spec = MeshGrains { hull: true, count: Some(9), ..spec(&[deep, fine]) };
    let set = from_meshes(&spec, 1).unwrap();
    let [deep, fine] = &set.meshes[..] else { panic!("two meshes: {:?}", set.meshes) };
    assert!(deep.left_out == 0.0 && fine.left_out > 0.0, "the ball alone: {:?}", set.meshes);
    let notes = MeshRecord::notes(&set.meshes);
    assert!(notes[0].contains("2 of 2 meshes") && notes[0].contains("25 %"), "{notes:?}");
    let change = rounded(fine.volume_change_percent());
    assert!(notes[1].ends_with(&format!("at most {change} %")), "{change} %: {notes:?}");
}

#[test]
fn objects_and_solids_are_grains_and_surfaces_may_be() {
    let folder = tempfile::tempdir().unwrap();
    let (a, b) = (cuboid_obj([10.0; 3], [0.0; 3]), cuboid_obj([20.0; 3], [50.0, 0.0, 0.0]));
    let second = after(1, &b);
    for key in ["o", "g"] {
        let text = format!("{key} small\n{a}{key} large\n{second}");
        let path = file(folder.path(), &format!("two-{key}.obj"), text);
        let set = from_meshes(&spec(&[path]), 1).unwrap();
        let names: Vec<&str> = set.meshes.iter().map(|s| s.object.as_str()).collect();
        assert_eq!(names, ["small", "large"], "each `{key}` is a grain");
        near("volume of the second, m³", set.grains[1].volume, 8e-6, 1e-17);
    }
    let joined = file(folder.path(), "joined.obj", format!("{a}{second}"));
    let error = from_meshes(&spec(std::slice::from_ref(&joined)), 1).unwrap_err().to_string();
    assert_holds(&error, &["several surfaces", "2 surfaces", "\"split_surfaces\": true"]);
    let set = from_meshes(&MeshGrains { split_surfaces: true, ..spec(&[joined]) }, 1).unwrap();
    assert_eq!(set.grains.len(), 2, "both surfaces are grains");
    assert_eq!(set.meshes[1].object, "object 1, surface 2");
}

/// Law: flat plates with finely rounded edges become grains of fewer vertices. With the first
/// rounding alone the hulls of about a third keep a facet that is turned round.
#[test]
fn flat_plates_of_many_vertices_become_simpler() {
    let most = 280;
    let spec = MeshGrains { largest_vertex_count: most, ..spec(&[]) };
    for n in 0..32 {
        let plate = crate::geometry::testing::flat_plate(n);
        let plate = ConvexPolyhedron::of_rounded(plate, 1e-5).unwrap();
        let (vertices, faces) = (plate.vertices().to_vec(), plate.faces().to_vec());
        assert!(vertices.len() > most as usize, "plate {n} has {} vertices", vertices.len());
        let volume = crate::geometry::enclosed_volume(&vertices, &faces);
        let surface = Surface { vertices, faces, volume };
        let (shape, record) = super::super::shape::convex(&surface, &spec)
            .unwrap_or_else(|e| panic!("law: plate {n}: expected a grain, got: {}", e.message));
        let got = shape.vertices().len();
        assert!(got <= most as usize, "law: expected {most} vertices at most, got {got}");
        assert!(record.hull, "law: it is a hull, got {record:?}");
    }
}
