//! Scripts that state the version of a tool look at the one that is there, and say which it is.

use std::{fs, os::unix::fs::symlink, process::Command};

use super::program::{Folder, page, root, said, script};

/// Has `pinned` hold two packages in the environment `e` of a folder, with the programs of its `bin`
/// first, where pip finds that what is there will do, or not: what it says, and what was asked for.
fn pinned_in(folder: &Folder, will_do: bool) -> (String, String) {
    let path = std::env::var("PATH").expect("a path");
    let output = Command::new("bash")
        .current_dir(root())
        .args(["-euo", "pipefail", "-c"])
        .arg(". scripts/pinned.sh; pinned \"$1\" 'mkdocs==1.6.*' 'markdown>=3'")
        .args(["bash", &folder.out("e")])
        .env("PATH", format!("{}:{path}", folder.out("bin")))
        .env("HELD", if will_do { "0" } else { "1" })
        .env("ASKED", folder.path("asked"))
        .output()
        .expect("bash");
    assert!(output.status.success(), "law: it ends well: {}", said(&output));
    let asked = fs::read_to_string(folder.path("asked")).unwrap_or_default();
    (said(&output), asked)
}

/// The same in an environment that has pip.
fn pinned(will_do: bool) -> (String, String) {
    let folder = Folder::new();
    fs::create_dir_all(folder.path("e/bin")).expect("a folder");
    script(
        &folder.path("e/bin/python"),
        "#!/bin/sh\ncase \"$*\" in\n*--no-index*) exit \"$HELD\" ;;\n*show*) echo Version: 1.0 ;;\n\
         *--version) ;;\n*) echo \"$*\" >>\"$ASKED\" ;;\nesac\n",
    );
    pinned_in(&folder, will_do)
}

/// Law: a package of another version is replaced, with both versions said; one that will do is not
/// asked for again.
#[test]
fn packages_of_other_versions_are_replaced() {
    let (said, asked) = pinned(true);
    assert_eq!((said.as_str(), asked.as_str()), ("", ""), "law: nothing is said or asked for");
    let (said, asked) = pinned(false);
    let expected = "has 1.0 mkdocs, 1.0 markdown: installing mkdocs==1.6.* markdown>=3";
    assert!(said.contains(expected), "law: expected `{expected}`, got `{said}`");
    let expected = "install --quiet mkdocs==1.6.* markdown>=3";
    assert!(asked.contains(expected), "law: expected `{expected}`, got `{asked}`");
}

/// Law: an environment without pip, as one whose making was interrupted, is made anew.
#[test]
fn an_environment_without_pip_is_made_anew() {
    let folder = Folder::new();
    for name in ["e/bin", "bin"] {
        fs::create_dir_all(folder.path(name)).expect("a folder");
    }
    script(&folder.path("e/bin/python"), "#!/bin/sh\nexit 1\n");
    script(
        &folder.path("bin/python3"),
        "#!/bin/sh\necho \"$*\" >>\"$ASKED\"\necho '#!/bin/sh' >\"$4/bin/python\"\n",
    );
    let (_, got) = pinned_in(&folder, true);
    let expected = format!("-m venv --clear {}\n", folder.out("e"));
    assert_eq!(got, expected, "law: it is made once (got left, expected right)");
}

/// Lines of a script that have pip install versions.
fn versions_by_pip(text: &str) -> Vec<String> {
    let joined = text.replace("\\\n", " ");
    let is_it = |line: &&str| {
        let states = ["==", ">=", " -r "].iter().any(|of| line.contains(of));
        line.contains("pip") && line.contains(" install ") && states
    };
    joined.lines().filter(is_it).map(str::to_owned).collect()
}

/// Law: scripts that have pip install stated versions do so by `pinned`, which looks at those that are
/// there; but for the peers' one, which looks itself.
#[test]
fn stated_versions_are_those_that_are_there() {
    let found =
        versions_by_pip("\"$venv/bin/pip\" install -q \\\n    a==1\npip install -r b.txt\n");
    assert_eq!(found.len(), 2, "law: the check finds faults");
    let entries = fs::read_dir(root().join("scripts")).expect("a folder");
    let names = entries.map(|entry| entry.expect("an entry").file_name());
    for name in names.map(|name| name.to_string_lossy().into_owned()) {
        if name.ends_with(".sh") && !["pinned.sh", "peers.sh"].contains(&name.as_str()) {
            let found = versions_by_pip(&page(&format!("scripts/{name}")));
            assert!(found.is_empty(), "law: scripts/{name} uses `pinned`, got {found:#?}");
        }
    }
}

/// Law: a compiler that is too old is refused with its version and the one that is needed, and a
/// command that can be typed here: without rustup that of its installation.
#[test]
fn an_old_compiler_is_refused_with_both_versions() {
    let needed = env!("CARGO_PKG_RUST_VERSION");
    for (rustup, command) in
        [(true, "rustup update stable\n"), (false, "| sh -s -- -y && . \"$HOME/.cargo/env\"\n")]
    {
        let folder = Folder::new();
        script(&folder.path("cargo"), "#!/bin/sh\necho 'cargo 1.63.0 (fd9c4297c 2022-07-01)'\n");
        if rustup {
            script(&folder.path("rustup"), "#!/bin/sh\n");
        }
        // Nothing else of this machine: it may have another rustup.
        for name in ["dirname", "head", "sed", "sort"] {
            symlink(format!("/usr/bin/{name}"), folder.path(name)).expect("linked");
        }
        let output = Command::new("/bin/bash")
            .current_dir(root())
            .arg("scripts/setup.sh")
            .env("PATH", folder.out(""))
            .env("HOME", folder.path("home"))
            .env_remove("CARGO_HOME")
            .output()
            .expect("bash");
        let expected = format!("cargo is 1.63.0, and Pluvia needs {needed} or newer. Try: ");
        let got = said(&output);
        assert!(!output.status.success(), "law: it is refused, got {}", output.status);
        assert!(got.contains(&expected), "law: expected `{expected}`, got `{got}`");
        assert!(got.ends_with(command), "law: rustup: {rustup}: `{command}`, got `{got}`");
    }
}
