//! `scripts/notices.py` writes the copyright notices and licences of every crate that the program
//! links, and `scripts/package.sh` packs them.

use std::{
    collections::{BTreeMap, BTreeSet},
    fs,
    path::Path,
    process::{Command, Output},
};

use super::program::{Folder, page, root, said, script, skipped};

/// Whether the script can run here; says aloud where it cannot.
fn can_run() -> bool {
    let asked = |program: &str, args: &[&str]| Command::new(program).args(args).output().ok();
    let sysroot = asked("rustc", &["--print", "sysroot"]).map(|found| found.stdout);
    let sysroot = String::from_utf8(sysroot.unwrap_or_default()).expect("a path");
    let lacking = if asked("python3", &["--version"]).is_none() {
        Some("there is no python3")
    } else if !Path::new(sysroot.trim()).join("share/doc/rust/COPYRIGHT-library.html").exists() {
        Some("rustc came without the notices of its library")
    } else {
        None
    };
    lacking.inspect(|why| skipped("scripts/notices.py", why)).is_none()
}

/// The notices that packages hold: the function of `scripts/package.sh` that fills both, with a
/// program that has no more than a name.
fn packed() -> String {
    let folder = Folder::new();
    let version = env!("CARGO_PKG_VERSION");
    script(
        &folder.path("pluvia"),
        &format!(
            "#!/bin/sh\ncase $1 in\n--version) echo pluvia {version} ;;\n\
             man) echo page >\"$3/pluvia.1\" ;;\nesac\n"
        ),
    );
    script(&folder.path("strip"), "#!/bin/sh\n");
    let text = page("scripts/package.sh");
    let (functions, _) = text.split_once("\ncase ").expect("what it does stands at its end");
    let path = std::env::var("PATH").expect("a path");
    let output = Command::new("bash")
        .current_dir(root())
        .arg("-c")
        .arg(format!("{functions}\nfill \"$1/bin\" \"$1/man\" \"$1/share\" \"$1/doc\""))
        .args(["scripts/package.sh", &folder.out("packed")])
        .env("PLUVIA", folder.path("pluvia"))
        .env("PATH", format!("{}:{path}", folder.out("")))
        .output()
        .expect("bash");
    assert!(output.status.success(), "law: packages are filled: {}", said(&output));
    fs::read_to_string(folder.path("packed/doc/THIRD-PARTY-NOTICES")).unwrap_or_default()
}

/// Crates whose code a program has, as `NAME-VERSION`, by the paths of sources that are in it: those
/// of a registry, and those of Rust's standard library.
fn linked(program: &[u8]) -> (BTreeSet<String>, BTreeSet<String>) {
    let parts: Vec<&[u8]> = program.split(|byte| *byte == b'/').collect();
    let (mut crates, mut standard) = (BTreeSet::new(), BTreeSet::new());
    for parts in parts.windows(4) {
        // Beside paths of files there are those of folders, which end where their names do.
        let of_name = |byte: &&u8| byte.is_ascii_alphanumeric() || b"_.+-".contains(*byte);
        let name = |at: usize| -> String {
            parts[at].iter().take_while(of_name).map(|byte| char::from(*byte)).collect()
        };
        if parts[0].ends_with(b"registry") && parts[1] == b"src" {
            crates.insert(name(3));
        } else if parts[0].ends_with(b"rust") && parts[1] == b"deps" {
            standard.insert(name(2));
        }
    }
    (crates, standard)
}

/// The list of the notices, without its head.
fn list(notices: &str) -> Vec<&str> {
    let list = notices.split("\n==================== Text ").next().unwrap_or_default();
    list.lines().skip(1).filter(|line| !line.is_empty()).collect()
}

/// What is wrong with the notices of a program that has code of these crates.
fn faults(notices: &str, crates: &BTreeSet<String>, standard: &BTreeSet<String>) -> Vec<String> {
    let list = list(notices);
    let texts = notices.split("\n==================== Text ").skip(1);
    let texts: BTreeMap<&str, &str> =
        texts.filter_map(|text| text.split_once(" ====================\n")).collect();
    let mut faults = Vec::new();
    for line in &list {
        let numbers = line.rsplit(" | ").next().unwrap_or_default().split(' ');
        let words: Vec<usize> = numbers
            .map(|number| texts.get(number).map_or(0, |text| text.split_whitespace().count()))
            .collect();
        // A licence has more words than that.
        if words.contains(&0) || words.iter().all(|words| *words < 80) {
            faults.push(format!("`{line}` has texts of {words:?} words"));
        }
    }
    let title = |line: &str| line.split(' ').take(2).collect::<Vec<_>>().join("-");
    let titles: Vec<String> = list.iter().map(|line| title(line)).collect();
    faults.extend(crates.iter().filter(|name| !titles.contains(name)).cloned());
    let library = list.iter().find(|line| line.starts_with("std ")).copied().unwrap_or_default();
    let held = |name: &String| {
        library
            .split([' ', ','])
            .any(|word| !word.is_empty() && name.starts_with(&format!("{word}-")))
    };
    faults.extend(standard.iter().filter(|name| !held(name)).map(|name| format!("std's {name}")));
    let names = list.iter().filter(|line| !line.starts_with("std "));
    if !names.map(|line| line.split(' ').next()).is_sorted() {
        faults.push("crates are not in the order of their names".to_owned());
    }
    faults
}

/// Law: what packages hold names every crate whose code is in the program, those of Rust's standard
/// library, too, with a licence each; no crate that builds or tests it alone; and the font.
#[test]
fn packages_hold_the_notices_of_every_linked_crate() {
    if !can_run() {
        return;
    }
    let (crates, standard) = linked(&fs::read(env!("CARGO_BIN_EXE_pluvia")).expect("the program"));
    let got = (crates.len(), standard.len());
    assert!(got.0 > 50 && got.1 > 2, "law: the program says which crates it has, got {got:?}");
    let notices = packed();
    let found = faults(&notices, &crates, &standard);
    assert!(found.is_empty(), "law: each is named with its texts, got {found:#?}");
    for name in ["bindgen", "cc", "criterion", "pluvia", "proptest", "syn"] {
        let line = list(&notices).into_iter().find(|line| line.starts_with(&format!("{name} ")));
        assert_eq!(line, None, "law: {name} is not named (got left, expected right)");
    }
    for expected in ["Copyright (c) 2003 by Bitstream", "The Rust Project Developers"] {
        assert!(notices.contains(expected), "law: expected `{expected}` among the notices");
    }
    let without = |what: &str| faults(&notices.replace(what, "\n"), &crates, &standard);
    for what in ["\nserde_json ", "\n==================== Text 1 ", "gimli, "] {
        assert!(!without(what).is_empty(), "law: the check finds that `{what}` is not there");
    }
}

/// Writes the notices of the package `top` in a folder.
fn of_top(folder: &Folder) -> Output {
    Command::new("python3")
        .current_dir(root())
        .args(["scripts/notices.py", &folder.out("top/Cargo.toml"), &folder.out("notices")])
        .output()
        .expect("python3")
}

/// A package `top` that links `left` and `right`, and is built by `tools`; none has a licence file.
fn crates_under(licence: &str) -> Folder {
    let folder = Folder::new();
    let mut lock = "version = 4\n".to_owned();
    for name in ["left", "right", "tools", "top"] {
        fs::create_dir_all(folder.path(&format!("{name}/src"))).expect("a folder");
        fs::write(folder.path(&format!("{name}/src/lib.rs")), "").expect("written");
        let (uses, locked) = if name == "top" {
            (
                "[dependencies]\nleft.path = \"../left\"\nright.path = \"../right\"\n\
                 [build-dependencies]\ntools.path = \"../tools\"\n",
                "dependencies = [\n \"left\",\n \"right\",\n \"tools\",\n]\n",
            )
        } else {
            ("", "")
        };
        let package = format!("name = \"{name}\"\nversion = \"0.2.0\"\n");
        let more =
            format!("edition = \"2024\"\nauthors = [\"A. Author\"]\nlicense = \"{licence}\"\n");
        fs::write(
            folder.path(&format!("{name}/Cargo.toml")),
            format!("[package]\n{package}{more}{uses}"),
        )
        .expect("written");
        lock += &format!("\n[[package]]\n{package}{locked}");
    }
    fs::write(folder.path("top/Cargo.lock"), lock).expect("written");
    folder
}

/// Law: a crate without a licence file has the standard text with its authors, and is refused by
/// name where that text is not known.
#[test]
fn a_crate_without_a_licence_file_has_the_standard_text_or_is_refused() {
    if !can_run() {
        return;
    }
    let folder = crates_under("EUPL-1.2");
    let output = of_top(&folder);
    let (got, expected) = (said(&output), "error: crate left 0.2.0 (EUPL-1.2) has no licence file");
    assert!(!output.status.success(), "law: it is refused, got {}", output.status);
    // Cargo may have said before that it waits for another.
    let says = got.lines().any(|line| line.starts_with(expected));
    assert!(says, "law: expected `{expected}`, got `{got}`");
    assert!(!folder.path("notices").exists(), "law: no file is left");

    let folder = crates_under("Apache-2.0 WITH LLVM-exception OR MIT");
    let output = of_top(&folder);
    assert!(output.status.success(), "law: MIT is known: {}", said(&output));
    let notices = folder.text("notices");
    let crates: BTreeSet<String> = ["left-0.2.0", "right-0.2.0"].map(str::to_owned).into();
    let found = faults(&notices, &crates, &BTreeSet::new());
    assert!(found.is_empty(), "law: both have a text, got {found:#?}");
    let expected = "\nCopyright (c) A. Author\n";
    assert!(notices.contains(expected), "law: expected `{expected}` in\n{notices}");
    assert!(!notices.contains("\ntools "), "law: what builds it is not named, got\n{notices}");
}

/// Law: texts of the same words are one, notices are beside licences, and a path in the place of a
/// licence is none.
#[test]
fn equal_texts_are_one() {
    if !can_run() {
        return;
    }
    let folder = crates_under("EUPL-1.2");
    let write = |name: &str, text: &str| fs::write(folder.path(name), text).expect("written");
    write("left/LICENSE", &"some words\n".repeat(50));
    write("right/LICENSE", "../LICENSE");
    assert!(!of_top(&folder).status.success(), "law: a path is no licence");
    write("right/src/LICENCE.txt", &"some\n  words ".repeat(50));
    write("right/NOTICE", "More words\n");
    let output = of_top(&folder);
    assert!(output.status.success(), "law: each has a licence file: {}", said(&output));
    let notices = folder.text("notices");
    let named = list(&notices);
    let expected = ["left 0.2.0 | EUPL-1.2 | 1", "right 0.2.0 | EUPL-1.2 | 1 2"];
    assert_eq!(named[..2], expected, "law: texts by number (got left, expected right)");
}
