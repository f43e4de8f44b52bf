//! What the program says to a terminal, to a pipe, and to a shell.

use std::{
    fs,
    path::Path,
    process::{Command, Output},
};

use super::{
    program::{self, Folder, assert_holds},
    small,
};

fn pluvia(args: &[&str], variables: &[(&str, &str)]) -> Output {
    let mut command = program::pluvia();
    for variable in ["NO_COLOR", "CLICOLOR", "CLICOLOR_FORCE"] {
        command.env_remove(variable);
    }
    command.args(args).envs(variables.iter().copied()).output().expect("it starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8(bytes.to_vec()).expect("UTF-8")
}

const ESCAPE: char = '\x1b';

#[test]
#[ignore = "slow: make test-all"]
fn pipes_get_plain_lines_and_no_colours() {
    let folder = Folder::new();
    let scenario = folder.scenario("small.json", &small::scenario(20.0, 0.25, 0.0));
    let args = ["run", &scenario, "--out", &folder.out("run")];

    let output = pluvia(&args, &[]);
    let (said, printed) = (text(&output.stderr), text(&output.stdout));
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(!said.contains(ESCAPE) && !said.contains('\r'), "law: plain lines, got {said:?}");
    assert!(!printed.contains(ESCAPE), "law: no colours in a pipe, got {printed:?}");
    assert_holds(&said, &["pour", "begins, about", "ended after", "; in all", "s done"]);
    assert!(printed.contains("accuracy standard"), "{printed}");

    // The same run again is read from its folder: no stage begins.
    let again = pluvia(&args, &[("CLICOLOR_FORCE", "1")]);
    assert!(!text(&again.stderr).contains("begins"), "law: what is done is not done again");
    let coloured = text(&again.stdout);
    assert!(coloured.contains(ESCAPE), "law: colours where they are asked for, got {coloured:?}");
    let refused = pluvia(&args, &[("NO_COLOR", "1")]);
    assert!(!text(&refused.stdout).contains(ESCAPE), "law: NO_COLOR is respected");
    let error = pluvia(&["run", "none.json", "--out", args[3]], &[]);
    assert!(text(&error.stderr).starts_with("error: "), "{}", text(&error.stderr));
}

/// Names of the subcommands, as `pluvia --help` lists them.
fn subcommands() -> Vec<String> {
    let help = text(&pluvia(&["--help"], &[]).stdout);
    let listed = help.split_once("Commands:").expect("commands").1;
    let listed = listed.split_once("Options:").expect("options").0;
    let names = listed.lines().filter(|l| l.starts_with("  ") && !l.starts_with("   "));
    let names: Vec<String> =
        names.filter_map(|l| l.split_whitespace().next()).map(str::to_owned).collect();
    assert!(names.len() > 10, "law: every subcommand is listed, got {names:?}");
    names
}

#[test]
fn shells_learn_every_subcommand() {
    let folder = tempfile::tempdir().expect("a folder");
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = pluvia(&["completions", shell], &[]);
        assert_eq!(output.status.code(), Some(0), "{shell}: {}", text(&output.stderr));
        let script = text(&output.stdout);
        for name in subcommands() {
            assert!(script.contains(&name), "the script for {shell} lacks {name}");
        }
        assert!(script.contains("animate"), "the script for {shell} lacks options");
        if shell == "bash" {
            let path = folder.path().join("pluvia.bash");
            fs::write(&path, &script).expect("a file");
            assert!(accepted_by_bash(&path), "law: bash accepts the script");
            fs::write(&path, script + "\nif").expect("a file");
            assert!(!accepted_by_bash(&path), "the check finds faults");
        }
    }
    let output = pluvia(&["completions", "abacus"], &[]);
    assert_eq!(output.status.code(), Some(2), "no such shell: {}", text(&output.stderr));
}

fn accepted_by_bash(script: &Path) -> bool {
    Command::new("bash").arg("-n").arg(script).output().expect("bash starts").status.success()
}

#[test]
fn every_subcommand_has_a_manual_page() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().to_str().expect("UTF-8");
    let output = pluvia(&["man", "--out", path], &[]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
    let pages = subcommands().into_iter().filter(|name| name != "help");
    let pages = pages.map(|name| format!("pluvia-{name}.1")).chain(["pluvia.1".to_owned()]);
    for page in pages {
        let content = fs::read_to_string(folder.path().join(&page));
        let content = content.unwrap_or_else(|e| panic!("{page}: {e}"));
        assert!(content.contains(".TH"), "{page} is a manual page");
        assert!(text(&output.stdout).contains(&page), "{page} is told of");
    }
    let alone = pluvia(&["man"], &[]);
    assert!(text(&alone.stdout).contains(".TH"), "law: without --out the page is printed");
}
