//! The Python package is of the program's version, and built of what the program is built of.
//! What it does is tested by `make test-python`.

use std::collections::BTreeMap;

use super::program::page as read;

fn version(manifest: &str) -> String {
    let line = manifest.lines().find_map(|l| l.strip_prefix("version = "));
    line.expect("a manifest has a version").to_owned()
}

/// Versions and dependencies by the names of packages, as a lock file has them.
fn packages(lock: &str) -> BTreeMap<String, Vec<(String, Vec<String>)>> {
    let mut found: BTreeMap<_, Vec<_>> = BTreeMap::new();
    for package in lock.split("[[package]]\n").skip(1) {
        let field = |name: &str| {
            let value = package.lines().find_map(|l| l.strip_prefix(&format!("{name} = ")));
            value.unwrap_or_default().trim_matches('"').to_owned()
        };
        let uses = package.lines().filter_map(|l| l.strip_prefix(" \""));
        let uses = uses.map(|l| l.split(['"', ' ']).next().unwrap_or_default().to_owned());
        found.entry(field("name")).or_default().push((field("version"), uses.collect()));
    }
    found
}

/// What is wrong with the lock of the package beside that of the program.
fn faults(program: &str, package: &str) -> Vec<String> {
    let (program, package) = (packages(program), packages(package));
    let mut faults = Vec::new();
    let mut shared = 0;
    for (name, versions) in &package {
        let Some(own) = program.get(name) else { continue };
        shared += 1;
        for (version, _) in versions {
            if !own.iter().any(|(known, _)| known == version) {
                faults.push(format!("{name} {version} is another version than the program's"));
            }
        }
    }
    let uses = |of: &BTreeMap<String, Vec<(String, Vec<String>)>>| {
        of.get("pluvia").map(|versions| versions[0].1.clone()).unwrap_or_default()
    };
    for missing in uses(&package).iter().filter(|name| !uses(&program).contains(name)) {
        faults.push(format!("{missing} is used there alone"));
    }
    assert!(shared > 50, "expected the program's crates in both, found {shared}");
    faults
}

#[test]
fn versions_are_one() {
    assert_eq!(
        version(&read("Cargo.toml")),
        version(&read("python/Cargo.toml")),
        "law: one version"
    );
}

/// Law: what a wheel holds are the versions that the program's tests run with.
#[test]
fn locked_versions_are_one() {
    let (program, package) = (read("Cargo.lock"), read("python/Cargo.lock"));
    let found = faults(&program, &package);
    assert!(
        found.is_empty(),
        "{}\nTry: cp Cargo.lock python/ && cargo metadata --manifest-path python/Cargo.toml",
        found.join("\n")
    );
    let other =
        package.replacen("name = \"adler2\"\nversion = \"", "name = \"adler2\"\nversion = \"9", 1);
    assert_eq!(faults(&program, &other).len(), 1, "law: the check finds a version of its own");
}
