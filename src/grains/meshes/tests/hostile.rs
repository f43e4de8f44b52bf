//! Files that nobody should write: each is answered with what is wrong.

use super::*;

fn said(name: &str, content: impl AsRef<[u8]>) -> String {
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), name, content);
    let error = from_meshes(&spec(&[path]), 1).expect_err(name);
    assert!(!error.faults().is_empty(), "{name} is a fault, exit code 2: {error}");
    for fault in error.faults() {
        assert!(fault.file.ends_with(name), "the file is named: {fault}");
    }
    error.to_string()
}

fn expect(name: &str, content: impl AsRef<[u8]>, words: &[&str]) {
    assert_holds(&said(name, content), words);
}

#[test]
fn files_that_are_no_meshes() {
    expect("a.stl", "", &["the file is empty", "0 bytes"]);
    expect("a.obj", "", &["the file is empty"]);
    expect("a.obj", "# nothing\nv 1 2 3\n", &["holds no faces"]);
    expect("a.step", "x", &["format", ".step", ".obj, .stl or .ply"]);
    expect("a.obj", [0xff, 0xfe, 0x00], &["not text"]);
    expect("a.stl", "short", &["too short", "5 bytes"]);
    expect("a.stl", [7; 200], &["damaged", "200 bytes", "117901063 triangles"]);
    expect("a.ply", "ply or not", &["no PLY file"]);
    expect("a.ply", "", &["the file is empty"]);
}

#[test]
fn damaged_stl() {
    let mut binary = vec![b' '; 80];
    binary.extend(3_u32.to_le_bytes());
    binary.extend([0; 120]);
    expect("a.stl", &binary, &["announces 3 triangles", "234 bytes", "204 bytes"]);
    let mut huge = vec![b' '; 80];
    huge.extend(u32::MAX.to_le_bytes());
    expect("a.stl", &huge, &["announces 4294967295 triangles"]);
    let facet = |v: &str| {
        format!(
            "solid a\nfacet normal 0 0 1\nouter loop\nvertex {v}\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"
        )
    };
    expect("a.stl", facet("nan 0 0"), &["solid 1 (a)", "NaN", "finite"]);
    expect("a.stl", facet("0 0"), &["solid 1 (a)", "vertex"]);
    expect("a.stl", "solid a\nfacet normal 0 0 1\n", &["solid 1 (a)", "EOF"]);
    let mut nan = vec![b' '; 80];
    nan.extend(1_u32.to_le_bytes());
    nan.extend([0; 12]);
    for c in [f32::NAN, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0] {
        nan.extend(c.to_le_bytes());
    }
    nan.extend([0; 2]);
    expect("a.stl", &nan, &["solid 1", "no finite number", "NaN"]);
}

/// Law: many binary files begin with `solid`; one that is cut short is binary still.
#[test]
fn a_binary_stl_cut_short_is_not_read_as_text() {
    let mut cut = b"solid a".to_vec();
    cut.resize(80, b' ');
    cut.extend(3_u32.to_le_bytes());
    cut.extend([0; 120]);
    expect("a.stl", &cut, &["damaged", "announces 3 triangles", "234 bytes", "204 bytes"]);
}

#[test]
fn damaged_obj() {
    expect("a.obj", "v 1 2\n", &["line 1", "lacks a coordinate", "`v 1 2`"]);
    expect("a.obj", "v 1 2 x\n", &["line 1", "lacks a coordinate"]);
    let cube = cuboid_obj([10.0; 3], [0.0; 3]);
    for bad in ["99", "0", "-9", "9223372036854775807", "-9223372036854775808", "1e3", "x"] {
        let text = format!("{cube}f 1 2 {bad}\n");
        expect("a.obj", text, &["line 15", "not there", bad, "1 to 8"]);
    }
    expect("a.obj", format!("{cube}f 1 2\n"), &["line 15", "too few corners"]);
    let nan = cube.replacen("v 0 0 0", "v NaN 0 0", 1);
    expect("a.obj", nan, &["object 1", "vertex 0", "NaN"]);
    let infinite = cube.replacen("v 0 0 0", "v 1e999 0 0", 1);
    expect("a.obj", infinite, &["vertex 0", "inf"]);
}

/// Law: a fault stands in the line that its statement begins in, also after statements of several
/// lines; a comment is one line, whatever it ends in.
#[test]
fn statements_of_several_lines_are_counted_as_lines() {
    let cube = cuboid_obj([10.0; 3], [0.0; 3]);
    let long = cube.replacen("v 0 0 0\n", "v 0 \\\n 0 \\\r\n 0\n", 1);
    assert_eq!(long.lines().count(), cube.lines().count() + 2);
    for bad in ["f 1 2 99\n", "f 1 2 \\\n99\n"] {
        expect("a.obj", format!("{long}{bad}"), &["line 17", "not there", "99"]);
    }
    let folder = tempfile::tempdir().unwrap();
    // A comment may also end a statement.
    let ended = cube.replace("f 2 4 8 6\n", "f 2 4 8 6 # the last 1\n");
    for text in [long, format!("# C:\\scans\\\n{cube}"), ended] {
        let path = file(folder.path(), "a.obj", &text);
        let set = from_meshes(&spec(&[path]), 1).unwrap_or_else(|e| panic!("{text}: {e}"));
        near("volume of the cube, m³", set.grains[0].volume, 1e-6, 1e-18);
    }
}

#[test]
fn damaged_ply() {
    let header = |vertices: &str, faces: &str| {
        format!(
            "ply\nformat ascii 1.0\nelement vertex {vertices}\nproperty float x\nproperty float y\n\
             property float z\nelement face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
    };
    expect("a.ply", header("99999999999", "1"), &["vertex", "99999999999", "more"]);
    expect("a.ply", header("3", "1"), &["no PLY file"]);
    let points = "0 0 0\n1 0 0\n0 1 0\n";
    expect("a.ply", header("3", "1") + points + "3 0 1 7\n", &["face 0", "7", "0 to 2"]);
    expect("a.ply", header("3", "1") + points + "3 0 1 -1\n", &["face 0", "-1"]);
    expect("a.ply", header("3", "1") + points + "2 0 1\n", &["face 0", "too few"]);
    expect("a.ply", header("3", "0") + points, &["no faces"]);
    let empty = "ply\nformat binary_little_endian 1.0\nelement vertex 5\nend_header\n12345678";
    expect("a.ply", empty, &["vertex", "with a property"]);
    let no_z = "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n";
    expect("a.ply", no_z, &["vertex 0 lacks a coordinate"]);
}

#[test]
fn surfaces_that_enclose_nothing_sound() {
    let cube = cuboid_obj([10.0; 3], [0.0; 3]);
    let open = cube.replace("f 2 4 8 6\n", "");
    expect("a.obj", open, &["object 1", "open", "4 of 12 edges", "closed surface"]);
    let inside_out = with_corners(&cube, <[usize]>::reverse);
    expect("a.obj", inside_out, &["inside out", "-1000 mm³", "flip"]);
    let one_turned = cube.replace("f 2 4 8 6\n", "f 6 8 4 2\n");
    expect("a.obj", one_turned, &["opposite senses", "4 of 12 edges"]);
    let doubled = cube.clone() + "f 2 4 8 6\n";
    expect("a.obj", doubled, &["more than two faces", "4 of 12 edges"]);
    expect("a.obj", cuboid_obj([10.0, 10.0, 0.0001], [0.0; 3]), &["no volume to speak of"]);
    let flat = "v 0 0 0\nv 10 0 0\nv 0 10 0\nf 1 2 3\nf 3 2 1\n";
    expect("a.obj", flat, &["no volume to speak of", "0 mm³"]);
    let far = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1e300\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n";
    expect("a.obj", far, &["object 1", "vertex 3 lies too far away", "(0, 0, ", "at most 1e90"]);
    expect("a.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n", &["object 1"]);
}

#[test]
fn two_grains_in_one_solid() {
    let mut stl = String::from("solid both\n");
    for x in [0.0, 50.0] {
        let corners = [[x, 0.0, 0.0], [x + 9.0, 0.0, 0.0], [x, 9.0, 0.0], [x, 0.0, 9.0]];
        for face in [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]] {
            stl += "facet normal 0 0 0\nouter loop\n";
            for c in face.map(|v| corners[v]) {
                stl += &format!("vertex {} {} {}\n", c[0], c[1], c[2]);
            }
            stl += "endloop\nendfacet\n";
        }
    }
    stl += "endsolid both\n";
    expect("a.stl", &stl, &["solid 1 (both)", "several surfaces", "2 surfaces", "split_surfaces"]);
    let folder = tempfile::tempdir().unwrap();
    let path = file(folder.path(), "a.stl", stl);
    let split = MeshGrains { split_surfaces: true, ..spec(&[path]) };
    assert_eq!(from_meshes(&split, 1).unwrap().grains.len(), 2, "where asked for, two grains");
}

#[test]
fn units_that_cannot_be() {
    // 10 m, and 10 µm: as millimetres they would be gravel.
    expect(
        "a.obj",
        cuboid_obj([10_000.0; 3], [0.0; 3]),
        &["10000 mm", "\"um\" would give 10 mm", "0.05 to 1000 mm"],
    );
    expect("a.obj", cuboid_obj([0.01; 3], [0.0; 3]), &["0.01 mm", "\"m\" would give 10 mm"]);
}

#[test]
fn all_faults_at_once_and_files_that_are_not_there() {
    let folder = tempfile::tempdir().unwrap();
    let bad = file(folder.path(), "bad.obj", "v 1\n");
    let open =
        file(folder.path(), "open.obj", cuboid_obj([10.0; 3], [0.0; 3]).replace("f 2 4 8 6\n", ""));
    let missing = folder.path().join("missing.stl").to_str().unwrap().to_owned();
    let pattern = format!("{}/*.ply", folder.path().display());
    let error =
        from_meshes(&spec(&[bad, missing.clone(), open, pattern, "[".into()]), 1).unwrap_err();
    assert_eq!(error.faults().len(), 5, "{error}");
    let said = error.to_string();
    for words in [
        "bad.obj",
        "missing.stl: the file cannot be read",
        "open.obj: object 1",
        "*.ply: the file cannot be read: no file has such a name",
        "grains.meshes[4]",
        "no pattern",
    ] {
        assert!(said.contains(words), "`{words}` in: {said}");
    }
    let error = from_meshes(&spec(&[missing]), 1).unwrap_err();
    assert!(
        matches!(&error, ScenarioErrors::Unreadable { file, .. } if file.ends_with("missing.stl")),
        "{error}"
    );
}

/// The same tetrahedron in every format.
fn sound_files() -> Vec<(&'static str, Vec<u8>)> {
    let corners = ["0 0 0", "9 0 0", "0 9 0", "0 0 9"];
    let faces = [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
    let mut obj = String::from("o t\n");
    let mut ply = String::from(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n\
         property float z\nelement face 4\nproperty list uchar int vertex_indices\nend_header\n",
    );
    for corner in corners {
        obj += &format!("v {corner}\n");
        ply += &format!("{corner}\n");
    }
    let mut text = String::from("solid t\n");
    let mut binary = vec![b' '; 80];
    binary.extend(4_u32.to_le_bytes());
    for face in faces {
        obj += &format!("f {} {} {}\n", face[0] + 1, face[1] + 1, face[2] + 1);
        ply += &format!("3 {} {} {}\n", face[0], face[1], face[2]);
        text += "facet normal 0 0 0\nouter loop\n";
        binary.extend([0; 12]);
        for corner in face.map(|v| corners[v]) {
            text += &format!("vertex {corner}\n");
            for c in corner.split(' ') {
                binary.extend(c.parse::<f32>().unwrap().to_le_bytes());
            }
        }
        text += "endloop\nendfacet\n";
        binary.extend([0; 2]);
    }
    text += "endsolid t\n";
    let head = "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty double x\n\
                property double y\nproperty double z\nelement face 4\n\
                property list uint uint vertex_index\nend_header\n";
    let mut big = head.as_bytes().to_vec();
    for corner in corners {
        corner.split(' ').for_each(|c| big.extend(c.parse::<f64>().unwrap().to_be_bytes()));
    }
    for face in faces {
        big.extend(3_u32.to_be_bytes());
        face.iter().for_each(|&v| big.extend((v as u32).to_be_bytes()));
    }
    vec![
        ("t.obj", obj.into_bytes()),
        ("t.ply", ply.into_bytes()),
        ("big.ply", big),
        ("t.stl", text.into_bytes()),
        ("binary.stl", binary),
    ]
}

#[test]
fn sound_files_are_read() {
    let folder = tempfile::tempdir().unwrap();
    for (name, content) in sound_files() {
        let path = file(folder.path(), name, content);
        let set = from_meshes(&spec(&[path]), 1).unwrap_or_else(|e| panic!("{name}: {e}"));
        near(&format!("{name}: volume"), set.grains[0].volume, 1e-9 * 729.0 / 6.0, 1e-18);
    }
}

/// Law: neither a mark before a text nor the character set of a name is part of the shape.
#[test]
fn marks_and_foreign_characters_do_no_harm() {
    let folder = tempfile::tempdir().unwrap();
    let files = sound_files();
    let content = |name: &str| {
        let (_, content) = files.iter().find(|file| file.0 == name).expect("a file of that name");
        String::from_utf8(content.clone()).expect("text")
    };
    let (obj, stl) = (content("t.obj"), content("t.stl"));
    let marked = |text: &str| format!("\u{feff}{text}").into_bytes();
    let unnamed = marked(&obj.replace("o t\n", ""));
    // In ISO 8859-1.
    let mut foreign = b"solid K\xf6rper\n".to_vec();
    foreign.extend(stl.replacen("solid t\n", "", 1).bytes());
    for (name, content, object) in [
        ("named.obj", marked(&obj), "t"),
        ("unnamed.obj", unnamed, "object 1"),
        ("marked.stl", marked(&stl), "solid 1 (t)"),
        ("foreign.stl", foreign, "solid 1 (K\u{fffd}rper)"),
    ] {
        let path = file(folder.path(), name, content);
        let set = from_meshes(&spec(&[path]), 1).unwrap_or_else(|e| panic!("{name}: {e}"));
        near(&format!("{name}: volume"), set.grains[0].volume, 1e-9 * 729.0 / 6.0, 1e-18);
        assert_eq!(set.meshes[0].object, object, "law: {name}: the name stays");
    }
}

proptest::proptest! {
    #![proptest_config(proptest::prelude::ProptestConfig::with_cases(60))]

    /// Whatever becomes of the bytes of a file: an answer, not a panic.
    #[test]
    fn spoiled_files_do_no_harm(
        which in 0_usize..5, cut in 0.0..1.5, at in proptest::collection::vec(
            (0.0..1.0, proptest::prelude::any::<u8>()), 0..8),
        hull: bool, split_surfaces: bool,
    ) {
        let (name, mut content) = sound_files().swap_remove(which);
        for (place, byte) in at {
            let place = (place * content.len() as f64) as usize;
            // Digits, minus signs and newlines spoil text most.
            content[place] = match byte % 4 { 0 => byte, 1 => b'0' + byte % 10, 2 => b'-', _ => b'\n' };
        }
        content.truncate((cut * content.len() as f64) as usize);
        let folder = tempfile::tempdir().unwrap();
        let path = file(folder.path(), name, content);
        match from_meshes(&MeshGrains { hull, split_surfaces, ..spec(&[path]) }, 1) {
            Ok(set) => proptest::prop_assert!(set.total_volume() > 0.0),
            Err(error) => proptest::prop_assert!(!error.to_string().is_empty()),
        }
    }
}

/// Law: a wrong unit is one mistake and one fault of a file, however many grains it holds; other
/// faults of that file are reported as well.
#[test]
fn a_wrong_unit_is_one_fault_of_a_file() {
    let grains = |n: usize| -> String {
        let cube = cuboid_obj([0.01; 3], [0.0; 3]);
        (0..n).map(|k| format!("o grain_{k}\n{}", after(k, &cube))).collect()
    };
    let folder = tempfile::tempdir().unwrap();
    let faults = |n: usize, more: &str| {
        let path = file(folder.path(), "a.obj", grains(n) + more);
        from_meshes(&spec(&[path]), 1).expect_err("law: refused").faults().to_vec()
    };
    let [one] = &faults(1, "")[..] else { panic!("law: one grain has one fault") };
    assert!(one.message.contains("\"m\" would give 10 mm"), "{one}");
    assert!(!one.message.contains("likewise"), "law: there are no others: {one}");
    let [one] = &faults(40, "")[..] else { panic!("law: forty grains have one fault") };
    assert!(one.message.contains("likewise 39 more"), "law: the others are counted: {one}");
    assert_eq!(one.path, "grain_0", "law: the first is named");
    let open = "o open\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 321 322 323\n";
    let both = faults(40, open);
    assert!(both.len() > 1, "law: another fault stays beside it: {both:?}");
}
