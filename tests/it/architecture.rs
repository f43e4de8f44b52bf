//! The rules of `ARCHITECTURE.md`, checked from the source text: which module
//! may use which, which file of a module which, where the engine's names and
//! `unsafe` may stand, how long a file may be, and that it says first what it is.

mod cycles;
mod imports;
mod tokens;

use std::path::Path;

use super::program::page;
use tokens::{Token, tokens};

/// Rows of the layout table in `ARCHITECTURE.md`. A module uses only modules
/// of rows above its own, and those of its own row that `SAME_ROW` names.
const ROWS: [&[&str]; 10] = [
    &["units", "geometry", "motion", "scale", "caught", "input", "plain", "in_order"],
    &["scenario"],
    &["grains", "apparatus"],
    &["world", "specimen"],
    &["protocol"],
    &["measure"],
    &["record", "report"],
    &["study", "verify", "export", "picture", "viewer"],
    &["paper"],
    &["cli", "main"],
];

/// Uses allowed within a row, as (user, used).
const SAME_ROW: [(&str, &str); 11] = [
    ("geometry", "units"),
    ("motion", "geometry"),
    ("motion", "units"),
    ("grains", "apparatus"),
    ("specimen", "world"),
    ("report", "record"),
    ("picture", "export"),
    ("study", "picture"),
    ("viewer", "export"),
    ("viewer", "picture"),
    ("main", "cli"),
];

/// The only place for `unsafe`, for cxx and for Bullet's own names.
const ENGINE_FOLDER: &str = "src/world/bullet/";
/// The program that uses what stands there alone, under sanitizers.
const BRIDGE_ALONE: &str = "tests/sanitizers/bridge/";
/// The only place for rapier's own names.
const RAPIER_FOLDER: &str = "src/world/rapier/";
/// The one other file that may use parry, for its tree of boxes.
const RAYS: &str = "src/picture/scene.rs";
/// The one file outside that may name what the engines' folders offer.
const SEAM: &str = "src/world/mod.rs";

const LONGEST_RUST_FILE: usize = 500;
const LONGEST_CPP_FILE: usize = 400;
/// `main.rs` is under 40 lines.
const LONGEST_MAIN: usize = 39;

/// Every rule on one file; `path` is relative to the crate with forward
/// slashes. A fault reads "path:line: what is wrong".
fn faults(path: &str, text: &str) -> Vec<String> {
    let mut faults = too_long(path, text);
    if path.ends_with(".rs") {
        let tokens = tokens(text);
        faults.extend(engine_names(path, &tokens));
        faults.extend(rapier_names(path, &tokens));
        if path.starts_with("src/") {
            faults.extend(upward_imports(path, &tokens));
        }
    }
    faults.extend(says_nothing(path, text));
    faults
}

/// A file without a first line that says what it is.
fn says_nothing(path: &str, text: &str) -> Option<String> {
    let rust = path.ends_with(".rs");
    if rust && !path.starts_with("src/") && !path.starts_with("fuzz/") {
        return None;
    }
    let mark = if rust { "//!" } else { "//" };
    let said = text.lines().next().and_then(|line| line.strip_prefix(mark));
    let says = said.is_some_and(|words| !words.trim().is_empty());
    (!says).then(|| format!("{path}:1: a file begins with a `{mark}` line that says what it is"))
}

fn too_long(path: &str, text: &str) -> Vec<String> {
    let limit = match path {
        "src/main.rs" => LONGEST_MAIN,
        _ if path.starts_with("src/") => LONGEST_RUST_FILE,
        _ if path.starts_with("cpp/") => LONGEST_CPP_FILE,
        _ => return Vec::new(),
    };
    let lines = text.lines().count();
    if lines <= limit {
        return Vec::new();
    }
    vec![format!("{path}:{limit}: the file has {lines} lines, allowed are {limit}")]
}

fn engine_names(path: &str, tokens: &[Token]) -> Vec<String> {
    if path.starts_with(ENGINE_FOLDER) || path.starts_with(BRIDGE_ALONE) {
        return Vec::new();
    }
    // Tests may name the backend they test; the seam must.
    let may_name_backend = path == SEAM || !path.starts_with("src/");
    let mut faults = Vec::new();
    let mut lint_level = "";
    for (i, token) in tokens.iter().enumerate() {
        let text = token.text.as_str();
        if matches!(text, "allow" | "expect" | "warn" | "deny" | "forbid") {
            lint_level = text;
        }
        let beside_colons = [i.wrapping_sub(1), i + 1]
            .iter()
            .any(|&j| tokens.get(j).is_some_and(|t| t.text == "::"));
        let switched_off = text == "unsafe_code" && matches!(lint_level, "allow" | "expect");
        let foreign = text == "unsafe"
            || text == "cxx"
            || switched_off
            || capital_follows(text, "bt")
            || !may_name_backend
                && (capital_follows(text, "Bullet") || text == "bullet" && beside_colons);
        if foreign {
            faults.push(format!("{path}:{}: `{text}` belongs under {ENGINE_FOLDER}", token.line));
        }
    }
    faults
}

/// Rapier is an ordinary crate: its names are those that come from its two
/// crates, and the backend's.
fn rapier_names(path: &str, tokens: &[Token]) -> Vec<String> {
    if path.starts_with(RAPIER_FOLDER) {
        return Vec::new();
    }
    let may_name_backend = path == SEAM || !path.starts_with("src/");
    let foreign = |text: &str| {
        text.starts_with("rapier3d")
            || text.starts_with("parry3d") && path != RAYS
            || !may_name_backend && text.starts_with("RapierBackend")
    };
    let followed = |i: usize, next: &str| tokens.get(i + 1).is_some_and(|t| t.text == next);
    let path_to_backend = |i: usize| {
        let after_world = i >= 2 && tokens[i - 1].text == "::" && tokens[i - 2].text == "world";
        tokens[i].text == "rapier" && followed(i, "::") && after_world
    };
    (0..tokens.len())
        .filter(|&i| foreign(&tokens[i].text) || !may_name_backend && path_to_backend(i))
        .map(|i| {
            let Token { text, line, .. } = &tokens[i];
            format!("{path}:{line}: `{text}` belongs under {RAPIER_FOLDER}")
        })
        .collect()
}

fn capital_follows(word: &str, prefix: &str) -> bool {
    word.strip_prefix(prefix).is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_uppercase()))
}

fn row(module: &str) -> Option<usize> {
    ROWS.iter().position(|row| row.contains(&module))
}

fn upward_imports(path: &str, tokens: &[Token]) -> Vec<String> {
    let module = imports::module_path(path);
    // lib.rs declares the modules and belongs to no row.
    let Some(user) = module.first() else { return Vec::new() };
    let Some(own_row) = row(user) else {
        return vec![format!("{path}:1: module `{user}` stands in no row of ROWS")];
    };
    let mut faults = Vec::new();
    for import in imports::imports(&module, tokens) {
        let used = import.module.as_str();
        let place = format!("{path}:{}", import.line);
        match row(used) {
            _ if used == user => {}
            None => faults.push(format!("{place}: uses `{used}`, which stands in no row of ROWS")),
            Some(r) if r < own_row => {}
            Some(r) if r == own_row && SAME_ROW.contains(&(user, used)) => {}
            Some(r) => faults.push(format!(
                "{place}: `{user}` (row {own_row}) uses `{used}` (row {r}); only rows above and \
                 the pairs in SAME_ROW are allowed"
            )),
        }
    }
    faults
}

/// Paths (relative, forward slashes) and texts of the files below the given folders.
pub fn files(folders: &[&str], extensions: &[&str]) -> Vec<(String, String)> {
    fn walk(folder: &Path, found: &mut Vec<std::path::PathBuf>) {
        let Ok(entries) = std::fs::read_dir(folder) else { return };
        for entry in entries {
            let entry = entry.expect("a folder entry can be read");
            let (path, kind) = (entry.path(), entry.file_type().expect("its kind"));
            // What a link leads to stands in its own place.
            if kind.is_dir() {
                walk(&path, found);
            } else if kind.is_file() {
                found.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = Vec::new();
    for folder in folders {
        walk(&root.join(folder), &mut paths);
    }
    paths.sort();
    paths.retain(|p| p.extension().is_some_and(|e| extensions.iter().any(|x| e == *x)));
    paths
        .into_iter()
        .map(|path| {
            let text = std::fs::read_to_string(&path)
                .unwrap_or_else(|e| panic!("{} cannot be read: {e}", path.display()));
            let relative = path.strip_prefix(root).expect("walked from the root");
            (relative.to_string_lossy().replace('\\', "/"), text)
        })
        .collect()
}

#[test]
fn the_source_keeps_the_rules() {
    let folders = ["src", "cpp", "tests", "benches", "python/src", "fuzz/fuzz_targets"];
    let files = files(&folders, &["rs", "h", "cpp"]);
    assert!(files.len() >= 10, "expected the whole source, found only {} files", files.len());
    let faults: Vec<String> = files.iter().flat_map(|(path, text)| faults(path, text)).collect();
    assert!(faults.is_empty(), "expected no faults, got {}:\n{}", faults.len(), faults.join("\n"));
}

#[test]
fn files_of_a_module_use_each_other_one_way() {
    let edges = cycles::Sources::new(&files(&["src"], &["rs"])).edges();
    let all: Vec<&(String, String)> = edges.keys().collect();
    let found = cycles::on_cycles(&all);
    let told: Vec<String> = found
        .into_iter()
        .map(|edge| format!("{} uses `{}` of {}", edge.0, edges[edge], edge.1))
        .collect();
    assert!(told.is_empty(), "law: no file uses one that uses it, got\n{}", told.join("\n"));
}

/// Names of the functions in the block after each place where these words stand.
fn functions_after(words: &[&str], tokens: &[Token]) -> Vec<Vec<String>> {
    let stands = |place: &usize| {
        let mut each = words.iter().enumerate();
        each.all(|(n, word)| tokens.get(place + n).is_some_and(|token| token.text == *word))
    };
    let in_block = |place: usize| {
        let (mut depth, mut names) = (0, Vec::new());
        for (n, token) in tokens.iter().enumerate().skip(place) {
            match token.text.as_str() {
                "{" => depth += 1,
                "}" if depth == 1 => break,
                "}" => depth -= 1,
                "fn" if depth == 1 => names.extend(tokens.get(n + 1).map(|name| name.text.clone())),
                _ => {}
            }
        }
        names
    };
    (0..tokens.len()).filter(stands).map(in_block).collect()
}

/// Law: a world that stands before another hands on every call: the default of the trait, which is
/// for engines that lack something, would hide it.
#[test]
fn worlds_before_others_hand_on_every_call() {
    let trait_of = functions_after(&["trait", "World"], &tokens(&page(SEAM)));
    let [all] = &trait_of[..] else { panic!("one trait, got {trait_of:?}") };
    assert!(all.len() > 15, "the check sees the trait, got {all:?}");
    let mut seen = 0;
    for (path, text) in files(&["src", "tests", "benches"], &["rs"]) {
        if path.starts_with("src/world/") || !text.contains("impl World for") {
            continue;
        }
        for own in functions_after(&["impl", "World", "for"], &tokens(&text)) {
            seen += 1;
            let left: Vec<&String> = all.iter().filter(|name| !own.contains(name)).collect();
            assert!(left.is_empty(), "law: all are handed on, {path} leaves out {left:?}");
        }
    }
    assert_eq!(seen, 3, "the check sees the worlds of tests and of the referee");
}

/// Law: the programs of `benches/` are linked to what was built for pluvia, since they take only
/// crates that it takes, with the same features.
#[test]
fn programs_of_benches_take_crates_of_the_program() {
    let dependencies = |manifest: &str| -> Vec<String> {
        let text = page(manifest);
        let lines = text.lines().skip_while(|line| *line != "[dependencies]").skip(1);
        let lines = lines.take_while(|line| !line.starts_with('['));
        lines.filter(|line| !line.is_empty()).map(str::to_owned).collect()
    };
    let own = dependencies("Cargo.toml");
    let taken = dependencies("benches/programs/Cargo.toml");
    assert!(taken.len() > 1, "expected pluvia and crates, got {taken:?}");
    let foreign: Vec<&String> =
        taken.iter().filter(|line| !line.starts_with("pluvia =") && !own.contains(line)).collect();
    assert!(
        foreign.is_empty(),
        "law: each of these lines of benches/programs/Cargo.toml stands in Cargo.toml, too, got \
         {foreign:?}"
    );
}

#[test]
fn rows_are_those_of_the_house_tour() {
    let tour = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/ARCHITECTURE.md"))
        .expect("ARCHITECTURE.md is there");
    for (number, row) in ROWS.iter().enumerate() {
        let told: Vec<&str> = tour
            .lines()
            .filter_map(|line| line.strip_prefix(&format!("| {number} | ")))
            .filter_map(|line| line.split(" | ").next())
            .flat_map(|cell| cell.split(", "))
            .map(|name| name.trim().trim_matches('`').trim_end_matches('/'))
            .map(|name| name.trim_end_matches(".rs"))
            .collect();
        let mut expected = row.to_vec();
        let mut got = told.clone();
        expected.sort_unstable();
        got.sort_unstable();
        assert_eq!(
            got, expected,
            "row {number} of the table in ARCHITECTURE.md: got left, ROWS in this test says right"
        );
    }
}

#[test]
fn uses_within_a_row_run_one_way() {
    for (user, used) in SAME_ROW {
        assert_eq!(row(user), row(used), "`{user}` and `{used}` are not in one row");
        assert!(!SAME_ROW.contains(&(used, user)), "`{user}` and `{used}` use each other");
    }
}

#[cfg(test)]
mod tests {
    use super::faults;

    /// Expects as many faults as given in a file that is else in order.
    fn expect(count: usize, path: &str, code: &str) {
        let text = format!("//! Doc.\n{code}\n");
        let found = faults(path, &text);
        assert_eq!(
            found.len(),
            count,
            "expected {count} faults (right) in {path}:\n{code}\ngot (left): {found:#?}"
        );
    }

    #[test]
    fn downward_imports_are_allowed() {
        expect(0, "src/measure/mod.rs", "use crate::{geometry::{Point, Pose}, world::Contact};");
        expect(0, "src/protocol/pour.rs", "fn f() { crate::units::from_mm(1.0); }");
        expect(0, "src/study/mod.rs", "use super::scenario::Scenario; use self::jobs::Job;");
        expect(0, "src/lib.rs", "pub use crate::study::run;");
        expect(0, "src/main.rs", "fn main() { pluvia::cli::main() }");
    }

    #[test]
    fn upward_imports_are_caught() {
        expect(1, "src/geometry/mod.rs", "use crate::grains::Grain;");
        expect(1, "src/measure/overlap.rs", "use crate::{world::{Contact, World}, study::Run};");
        expect(1, "src/measure/overlap.rs", "fn f() { let x = crate::report::page(); }");
        expect(1, "src/measure/overlap.rs", "fn f() { print!(\"{}\", super::super::cli::NAME) }");
        expect(1, "src/units.rs", "mod tests { use super::super::paper::X; use super::mm; }");
        expect(1, "src/world/mod.rs", "use super::protocol;");
        expect(2, "src/grains/mod.rs", "use {crate::cli::a, pluvia::study::b, std::fs};");
        expect(1, "src/grains/mod.rs", "use crate::*;");
    }

    #[test]
    fn imports_within_a_row_are_those_listed() {
        expect(0, "src/specimen.rs", "use crate::world::BodyState;");
        expect(1, "src/world/mod.rs", "use crate::specimen::Specimen;");
        expect(0, "src/grains/mod.rs", "use crate::apparatus::Funnel;");
        expect(1, "src/apparatus/mod.rs", "use crate::grains::Grain;");
    }

    #[test]
    fn modules_without_a_row_are_caught() {
        expect(1, "src/helpers.rs", "");
        expect(1, "src/study/mod.rs", "use crate::helpers::help;");
    }

    #[test]
    fn imports_in_comments_and_strings_are_none() {
        expect(
            0,
            "src/geometry/mod.rs",
            "/// See [`crate::study`].\nconst A: &str = \"crate::cli\";",
        );
    }

    #[test]
    fn engine_names_stay_in_their_folder() {
        for code in ["unsafe impl Send for A {}", "use cxx::UniquePtr;", "type A = btVector3;"] {
            expect(0, "src/world/bullet/ffi.rs", code);
            expect(1, "src/world/mod.rs", code);
            expect(1, "src/protocol/mod.rs", code);
            expect(1, "tests/it/main.rs", code);
        }
        expect(1, "src/study/mod.rs", "#![allow(unsafe_code)]");
        expect(0, "src/lib.rs", "#![deny(unsafe_code)]");
        for code in ["use crate::world::bullet::info;", "fn f(world: BulletBackend) {}"] {
            expect(0, "src/world/mod.rs", code);
            expect(0, "tests/it/main.rs", code);
            expect(1, "src/protocol/mod.rs", code);
        }
        // What a person chooses in a scenario is no engine's name.
        expect(0, "src/study/mod.rs", "fn f() { (Backend::Bullet, bt, \"bullet\"); /* unsafe */ }");
    }

    #[test]
    fn rapiers_names_stay_in_its_folder() {
        for code in ["use rapier3d_f64::prelude::*;", "fn f(s: parry3d_f64::shape::Ball) {}"] {
            expect(0, "src/world/rapier/mod.rs", code);
            expect(1, "src/world/mod.rs", code);
            expect(1, "src/world/bullet/mod.rs", code);
            expect(1, "src/scenario/rapier.rs", code);
            expect(1, "tests/it/main.rs", code);
        }
        for code in ["use crate::world::rapier::info;", "fn f(world: RapierBackend) {}"] {
            expect(0, "src/world/mod.rs", code);
            expect(1, "src/protocol/mod.rs", code);
        }
        expect(0, "src/picture/scene.rs", "use parry3d_f64::partitioning::Bvh;");
        expect(1, "src/picture/mod.rs", "use parry3d_f64::partitioning::Bvh;");
        expect(1, "src/picture/scene.rs", "use rapier3d_f64::prelude::*;");
        // What a person chooses in a scenario is no engine's name.
        expect(0, "src/study/mod.rs", "fn f(e: &E) { (Backend::Rapier, e.rapier, \"rapier\"); }");
        expect(0, "src/scenario/mod.rs", "mod rapier; pub use rapier::RapierSettings;");
    }

    #[test]
    fn long_files_are_caught() {
        // `expect` adds one line before and ends the last.
        expect(0, "src/study/mod.rs", &"\n".repeat(498));
        expect(1, "src/study/mod.rs", &"\n".repeat(499));
        expect(0, "cpp/world.cpp", &"\n".repeat(398));
        expect(1, "cpp/world.cpp", &"\n".repeat(399));
        expect(0, "src/main.rs", &"\n".repeat(37));
        expect(1, "src/main.rs", &"\n".repeat(38));
    }

    #[test]
    fn files_without_a_leading_doc_are_caught() {
        let count = |text| faults("src/study/mod.rs", text).len();
        assert_eq!(count("//! Many runs.\n"), 0, "a leading doc is in order");
        assert_eq!(count("use std::fs;\n//! Many runs.\n"), 1, "the doc must come first");
        assert_eq!(count(""), 1, "an empty file has no doc");
        assert_eq!(count("//!\n"), 1, "an empty doc says nothing");
        assert_eq!(faults("fuzz/fuzz_targets/mesh.rs", "#![no_main]\n").len(), 1, "a fuzz target");
        assert_eq!(faults("tests/it/main.rs", "mod same;\n").len(), 0, "a test needs none");
    }

    /// Law: every C++ source and header begins with a comment that says what it is.
    #[test]
    fn cpp_files_without_a_leading_comment_are_caught() {
        for path in ["cpp/world.cpp", "cpp/world.h", "benches/referee/cone.cpp"] {
            let count = |text| faults(path, text).len();
            assert_eq!(count("// The bridge.\n#include <a.h>\n"), 0, "{path}: a comment is there");
            assert_eq!(count("#include <a.h>\n// The bridge.\n"), 1, "{path}: it must come first");
            assert_eq!(count("//\n#include <a.h>\n"), 1, "{path}: an empty one says nothing");
        }
    }
}
