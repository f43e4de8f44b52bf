//! Files for ParaView as they are read back, against what they were made from.

use std::{collections::BTreeMap, fs, io::Read, path::Path};

use flate2::read::ZlibDecoder;
use roxmltree::{Document, Node};

use super::*;
use crate::export::testing;
use crate::geometry::{Vector, volume_of_loops};
use crate::measure::{coordination, pairs_within, testing::assert_near, touching_gap};

/// A `.vtp` file as read back.
struct Read3d {
    time: f64,
    points: Vec<[f64; 3]>,
    /// Corners of each cell.
    cells: Vec<Vec<usize>>,
    kind: String,
    /// Of points and of cells; vectors lie flat.
    point_data: BTreeMap<String, Vec<f64>>,
    cell_data: BTreeMap<String, Vec<f64>>,
}

fn u64_at(bytes: &[u8], at: usize) -> u64 {
    u64::from_le_bytes(bytes[at..at + 8].try_into().expect("eight bytes"))
}

/// The numbers of an array, from the bytes after the underscore.
fn numbers(array: Node, appended: &[u8]) -> Vec<f64> {
    let offset: usize = array.attribute("offset").expect("an offset").parse().expect("a number");
    let [blocks, full, last] = [0, 8, 16].map(|at| u64_at(appended, offset + at));
    assert_eq!(last, 0, "law: blocks are full");
    let mut plain = Vec::new();
    let mut at = offset + 24 + 8 * blocks as usize;
    for block in 0..blocks as usize {
        let packed = u64_at(appended, offset + 24 + 8 * block) as usize;
        let mut content = Vec::new();
        ZlibDecoder::new(&appended[at..at + packed]).read_to_end(&mut content).expect("zlib");
        assert_eq!(content.len() as u64, full, "law: a block has the announced size");
        plain.extend(content);
        at += packed;
    }
    let four = plain.chunks_exact(4).map(|b| [b[0], b[1], b[2], b[3]]);
    match array.attribute("type") {
        Some("Int32") => four.map(|b| f64::from(i32::from_le_bytes(b))).collect(),
        Some("Float32") => four.map(|b| f64::from(f32::from_le_bytes(b))).collect(),
        other => panic!("arrays of type {other:?} are not written"),
    }
}

fn read(path: &Path) -> Read3d {
    let bytes = fs::read(path).expect("a file");
    let mark = b"<AppendedData encoding=\"raw\">\n_";
    let at = bytes.windows(mark.len()).position(|w| w == mark).expect("appended data");
    assert!(bytes.ends_with(b"\n</AppendedData>\n</VTKFile>\n"), "law: the file is whole");
    let appended = &bytes[at + mark.len()..];
    let head = String::from_utf8(bytes[..at].to_vec()).expect("text") + "</VTKFile>";
    let document = Document::parse(&head).expect("XML");
    let section = |name: &str| document.descendants().find(|n| n.has_tag_name(name));
    let arrays = |name: &str| -> BTreeMap<String, Vec<f64>> {
        let inside = section(name).into_iter().flat_map(|s| s.children());
        inside
            .filter(|n| n.has_tag_name("DataArray"))
            .map(|n| (n.attribute("Name").expect("a name").to_owned(), numbers(n, appended)))
            .collect()
    };
    let kind = ["Verts", "Lines", "Polys"].into_iter().find(|k| section(k).is_some());
    let kind = kind.expect("cells");
    let piece = section("Piece").expect("a piece");
    let count =
        |of: &str| -> usize { piece.attribute(of).expect("a count").parse().expect("a number") };
    let points = arrays("Points")["Points"].chunks_exact(3).map(|p| [p[0], p[1], p[2]]).collect();
    let topology = arrays(kind);
    let ends = topology["offsets"].iter().map(|&n| n as usize);
    let mut from = 0;
    let mut cells = Vec::new();
    for end in ends {
        cells.push(topology["connectivity"][from..end].iter().map(|&n| n as usize).collect());
        from = end;
    }
    let fields = section("FieldData").expect("fields");
    let time = fields.children().find(|n| n.has_tag_name("DataArray")).and_then(|n| n.text());
    let read = Read3d {
        time: time.expect("a time").trim().parse().expect("a number"),
        points,
        cells,
        kind: kind.to_owned(),
        point_data: arrays("PointData"),
        cell_data: arrays("CellData"),
    };
    assert_eq!(read.points.len(), count("NumberOfPoints"), "law: points as announced");
    assert_eq!(read.cells.len(), count(&format!("NumberOf{kind}")), "law: cells as announced");
    for (name, values) in &read.cell_data {
        assert_eq!(values.len(), read.cells.len(), "law: an entry of {name} a cell");
    }
    read
}

fn written() -> (tempfile::TempDir, Moments, VtkFiles) {
    let folder = tempfile::tempdir().expect("a folder");
    let moments = testing::moments(&[11, 6], 0.08);
    let files = write_vtk(&moments, 0.4, folder.path(), |_, _| true).expect("files").expect("all");
    (folder, moments, files)
}

#[test]
fn lists_name_every_file_with_its_time() {
    let (folder, moments, files) = written();
    let ends: Vec<f64> = moments.stages.iter().map(|s| s.end.time).collect();
    let taken: Vec<f64> = moments.thinned(0.4).iter().map(|m| m.frame.time).collect();
    let mut listed = 0;
    for (name, times) in
        [("grains", &taken), ("apparatus", &taken), ("contacts", &ends), ("force_chains", &ends)]
    {
        let path = folder.path().join(name).with_extension("pvd");
        assert!(files.lists.contains(&path), "{name}.pvd is listed");
        let text = fs::read_to_string(&path).expect("a list");
        let document = Document::parse(&text).expect("XML");
        let sets: Vec<Node> =
            document.descendants().filter(|n| n.has_tag_name("DataSet")).collect();
        assert_eq!(sets.len(), times.len(), "law: a file of {name} a moment");
        for (set, expected) in sets.iter().zip(times) {
            let time: f64 = set.attribute("timestep").expect("a time").parse().expect("a number");
            assert_near("time in the list in s", *expected, time, 0.0);
            let file = folder.path().join(set.attribute("file").expect("a path"));
            assert!(files.data.contains(&file), "{} is listed", file.display());
            assert_near("time in the file in s", *expected, read(&file).time, 0.0);
            listed += 1;
        }
    }
    assert_eq!(listed, files.data.len(), "law: no file but those listed");
    let size: u64 =
        files.data.iter().chain(&files.lists).map(|f| fs::metadata(f).expect("a file").len()).sum();
    assert_eq!(files.bytes, size, "law: the bytes are those of the files");
}

#[test]
fn grains_are_the_grains_with_what_is_known_of_them() {
    let (folder, moments, _) = written();
    let last = moments.thinned(0.4).len() - 1;
    let read = read(&folder.path().join(format!("grains/grains_{last:04}.vtp")));
    assert_eq!(read.kind, "Polys");
    let grains = &moments.grains.grains;
    let end = &moments.stages[1].end;
    let specimen = crate::specimen::Specimen { grains: moments.grains.clone(), state: end.clone() };
    let present: Vec<usize> = specimen.present().collect();
    let faces: usize = present.iter().map(|&n| grains[n].shape.faces().len()).sum();
    assert_eq!(read.cells.len(), faces, "law: a cell a face of the grains that take part");
    let solids: f64 = present.iter().map(|&n| grains[n].volume).sum();
    let enclosed = volume_of_loops(&read.cells, |n| Vector::from(read.points[n]));
    assert_near("volume of the grains in m³", solids, enclosed, 1e-5 * solids);
    let names: Vec<&str> = read.cell_data.keys().map(String::as_str).collect();
    assert_eq!(
        names,
        [
            "coordination_number",
            "displacement_m",
            "grain",
            "mass_kg",
            "sieve_fraction",
            "sieve_size_m",
            "speed_m_per_s"
        ]
    );
    let pairs = pairs_within(&specimen, &present, touching_gap(&specimen.grains));
    let mean = coordination(&present, &pairs).mean.expect("grains");
    let mut seen = BTreeMap::new();
    for (cell, &n) in read.cell_data["grain"].iter().enumerate() {
        let value = |name: &str| read.cell_data[name][cell];
        let grain = &grains[n as usize];
        assert_near("mass in kg", grain.mass, value("mass_kg"), 1e-6 * grain.mass);
        assert_near("fraction", grain.fraction as f64, value("sieve_fraction"), 0.0);
        let size = crate::grains::sieve_size(&grain.shape);
        assert_near("sieve size in m", size, value("sieve_size_m"), 1e-9);
        assert_near("speed in m/s", testing::SPEED, value("speed_m_per_s"), 1e-7);
        seen.insert(n as usize, value("coordination_number"));
    }
    assert_eq!(seen.keys().copied().collect::<Vec<_>>(), present, "law: the grains that are there");
    let got = seen.values().sum::<f64>() / seen.len() as f64;
    assert_near("mean coordination number", mean, got, 1e-12);
}

#[test]
fn apparatus_is_where_it_stands() {
    let (folder, moments, _) = written();
    let mut stood = Vec::new();
    for (n, moment) in moments.thinned(0.4).iter().enumerate() {
        let read = read(&folder.path().join(format!("apparatus/apparatus_{n:04}.vtp")));
        let mut parts: Vec<i64> = read.cell_data["part"].iter().map(|&p| p as i64).collect();
        parts.dedup();
        // The wall is as far to the left as to the right of the table's middle.
        let wall = read.cells.iter().zip(&read.cell_data["part"]).filter(|(_, p)| **p == 0.0);
        let x: Vec<f64> = wall.flat_map(|(c, _)| c.iter().map(|&i| read.points[i][0])).collect();
        let (low, high) = x.iter().fold((f64::MAX, f64::MIN), |(l, h), &x| (l.min(x), h.max(x)));
        assert_near("middle of the wall in m", moment.frame.table_x, (low + high) / 2.0, 1e-7);
        stood.push((moment.stage, parts));
    }
    assert_eq!(stood[0], (0, vec![0, 1, 2]), "law: cylinder, floor and funnel, no lid");
    assert_eq!(stood.last(), Some(&(1, vec![0, 1, 4])), "law: cylinder, floor and plate");
}

#[test]
fn contacts_bear_what_they_bear() {
    let (folder, moments, _) = written();
    let contacts = read(&folder.path().join("contacts/contacts_0001.vtp"));
    let data = &contacts.point_data;
    assert_eq!(contacts.kind, "Verts");
    assert_eq!(data["first"], [0.0, 2.0, 0.0, -1.0], "law: grains by number, the plate is -1");
    assert_eq!(data["second"], [2.0, 0.0, -3.0, 3.0], "law: the floor is -3");
    assert_eq!(data["force_n"], [5.0, 1.0, 2.0, 1.0], "law: |(3, 0, 4)| = 5 N, and so on");
    assert_eq!(data["normal_force_n"], [4.0, -1.0, 2.0, 1.0], "law: along the normal");
    assert_eq!(data["force_vector_n"][..3], [3.0, 0.0, 4.0]);

    let chains = read(&folder.path().join("force_chains/force_chains_0001.vtp"));
    assert_eq!(chains.kind, "Lines");
    let data = &chains.cell_data;
    assert_eq!(data["first"], [0.0, 0.0, 3.0], "law: two bodies, one line");
    assert_eq!(data["second"], [2.0, -3.0, -1.0]);
    // The second contact of 0 and 2 has the force on 2: on 0 it is (0, 0, 1).
    assert_near("|(3, 0, 5)| in N", 34f64.sqrt(), data["force_n"][0], 1e-6);
    assert_near("sum of both normal forces in N", 3.0, data["normal_force_n"][0], 1e-6);
    let bodies = &moments.stages[1].end.bodies;
    for (end, body) in [(0, 0), (1, 2)] {
        let got = nalgebra::Vector3::from(chains.points[chains.cells[0][end]]);
        let off = (got - bodies[body].body.pose.translation.vector).norm();
        assert_near("a line ends in a centroid, off in m", 0.0, off, 1e-7);
    }
    assert_eq!(chains.points[chains.cells[1][1]].map(|x| (x * 1e6).round()), [1e4, 0.0, 2e4]);
    assert_eq!(chains.point_data["force_n"].len(), 6, "law: an entry a point, for tubes");
}

#[test]
fn without_contacts_there_are_no_files_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut moments = testing::moments(&[3], 0.08);
    moments.stages[0].end.contacts.clear();
    let files = write_vtk(&moments, 0.4, folder.path(), |_, _| true).expect("files").expect("all");
    assert_eq!(files.lists.len(), 2, "grains and apparatus: {files:?}");
    assert!(!folder.path().join("contacts.pvd").exists());
}

/// Law: a run without contacts leaves none beside its grains, neither of a run that was exported
/// into the folder before; files of others stay.
#[test]
fn contacts_of_a_run_that_was_exported_before_are_removed() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut moments = testing::moments(&[3], 0.08);
    let write = |moments: &Moments| write_vtk(moments, 0.4, folder.path(), |_, _| true);
    write(&moments).expect("files");
    let there = |name: &str| folder.path().join(name).exists();
    assert!(there("contacts.pvd") && there("force_chains/force_chains_0000.vtp"), "law: written");
    fs::write(folder.path().join("contacts/mine.vtp"), "mine").expect("a file");
    moments.stages[0].end.contacts.clear();
    write(&moments).expect("files");
    for name in ["contacts.pvd", "contacts/contacts_0000.vtp", "force_chains.pvd", "force_chains"] {
        assert!(!there(name), "law: {name} is of another run");
    }
    assert!(there("grains.pvd") && there("contacts/mine.vtp"), "law: all else stays");
}

/// Law: an export that is stopped leaves no file that a program would open, and files of others.
#[test]
fn an_export_that_is_stopped_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let moments = testing::moments(&[11, 6], 0.08);
    fs::write(folder.path().join("mine.txt"), "mine").expect("a file");
    let mut asked = 0;
    let done = write_vtk(&moments, 0.4, folder.path(), |done, _| {
        asked += 1;
        done < 2
    });
    assert_eq!((done.expect("no error"), asked), (None, 3), "law: stopped after two moments");
    let entries = fs::read_dir(folder.path()).expect("a folder").flatten();
    let left: Vec<_> = entries.map(|entry| entry.file_name()).collect();
    assert_eq!(left, ["mine.txt"], "law: left what is there, right what stays");
}

/// Law: an export that fails leaves nothing either, and says what failed.
#[test]
fn an_export_that_fails_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let moments = testing::moments(&[3], 0.08);
    // Where the folder of a series would be made.
    fs::write(folder.path().join(CHAINS), "mine").expect("a file");
    let failed = write_vtk(&moments, 0.4, folder.path(), |_, _| true);
    let said = failed.expect_err("law: it fails").to_string();
    assert!(said.contains(CHAINS), "law: it names the folder, got {said}");
    let entries = fs::read_dir(folder.path()).expect("a folder").flatten();
    let left: Vec<_> = entries.map(|entry| entry.file_name()).collect();
    assert_eq!(left, [CHAINS], "law: left what is there, right what stays");
}

#[test]
fn a_file_without_cells_is_a_file() {
    let data = PolyData::new(xml::LINES);
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("none.vtp");
    fs::write(&path, data.to_bytes(1.5).expect("bytes")).expect("a file");
    let read = read(&path);
    assert_eq!((read.points.len(), read.cells.len(), read.time), (0, 0, 1.5));
}
