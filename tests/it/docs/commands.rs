//! Commands that pages and choices show, as the program's command line and its scenarios take them:
//! they are parsed whole and their changes laid over scenarios; nothing runs.

use std::{fs, mem, path::Path};

use clap::{ArgMatches, error::ErrorKind};
use pluvia::grains::load_scenario;
use pluvia::scenario::Override;
use pluvia::study::{Factor, SampledRange};
use serde_json::Value;

use super::markdown::{blocks, spans};
use super::{documents, read, root};

/// The words of a command as a shell divides them, up to a comment, a pipe or another file.
fn words(line: &str) -> Vec<String> {
    let mut found = Vec::new();
    let (mut word, mut within, mut quote) = (String::new(), false, None);
    for c in line.chars() {
        match quote {
            Some(open) if c == open => quote = None,
            Some(_) => word.push(c),
            None if c.is_whitespace() => {
                if within {
                    found.push(mem::take(&mut word));
                }
                within = false;
            }
            None if !within && "#|>".contains(c) => break,
            None if "'\"".contains(c) => (within, quote) = (true, Some(c)),
            None => {
                within = true;
                word.push(c);
            }
        }
    }
    if within {
        found.push(word);
    }
    found
}

/// A command or a part of one, and where it stands.
enum Shown {
    /// A command that a reader types.
    Whole(String),
    /// A command of running text, which may leave out what the program asks for.
    Mentioned(String),
    /// `--set path=value` or `--over path=values` alone.
    Change(String),
}

/// What a page shows: lines of shell blocks, examples of the program's help, code in its text.
fn shown(text: &str) -> Vec<Shown> {
    let bare = |line: &str| line.trim().replace("target/release/pluvia ", "pluvia ");
    let joined = |language: &str| blocks(text, language).join("\n").replace("\\\n", " ");
    let typed = joined("sh");
    let helped = joined("text");
    let typed = typed.lines().map(bare).filter(|line| line.starts_with("pluvia "));
    let helped = helped.lines().filter(|line| line.starts_with("  pluvia ")).map(bare);
    let mut found: Vec<Shown> = typed.chain(helped).map(Shown::Whole).collect();
    for span in spans(text) {
        let span = bare(&span);
        if span.starts_with("pluvia ") {
            found.push(Shown::Mentioned(span));
        } else if span.starts_with("--set ") || span.starts_with("--over ") {
            found.push(Shown::Change(span));
        }
    }
    found
}

/// A word in the place of a value that readers put in: `NAME`, `N`.
fn is_placeholder(word: &str) -> bool {
    !word.is_empty()
        && word.chars().all(|c| c.is_ascii_uppercase() || c.is_ascii_digit())
        && word.starts_with(|c: char| c.is_ascii_uppercase())
}

/// Whether a path names a file of the tree: no placeholder, nor a file that readers write.
fn is_of_tree(path: &str) -> bool {
    let stem = Path::new(path).file_stem().unwrap_or_default().to_string_lossy();
    path.starts_with("scenarios/") && !is_placeholder(&stem)
}

/// What the program says against a command; nothing where it takes it.
fn fault(shown: &Shown) -> Option<String> {
    let (line, is_whole) = match shown {
        Shown::Whole(line) => (line, true),
        Shown::Mentioned(line) => (line, false),
        // `--set path=value` shows the form.
        Shown::Change(change) if change.contains(" path=") || !change.contains('=') => return None,
        Shown::Change(change) => {
            return fault(&Shown::Mentioned(format!("pluvia sweep SCENARIO.json {change}")));
        }
    };
    // A single capital stands for a number.
    let mut words = words(line);
    for word in &mut words {
        if word.len() == 1 && is_placeholder(word) {
            "1".clone_into(word);
        }
    }
    let there = |word: &&String| root().join(word).exists();
    if let Some(file) = words.iter().filter(|word| is_of_tree(word)).find(|word| !there(word)) {
        return Some(format!("{line}: there is no {file}"));
    }
    let parsed = pluvia::cli::command_line().try_get_matches_from(&words);
    let said = match parsed {
        Ok(matches) => return refused_change(&matches).map(|said| format!("{line}: {said}")),
        Err(said) => said,
    };
    match said.kind() {
        ErrorKind::DisplayHelp => None,
        // The rest is checked up to what is left out.
        ErrorKind::MissingRequiredArgument if !is_whole => {
            words.push("--help".to_owned());
            let parsed = pluvia::cli::command_line().try_get_matches_from(&words);
            let said = parsed.err().filter(|said| said.kind() != ErrorKind::DisplayHelp)?;
            Some(format!("{line}: {said}"))
        }
        ErrorKind::DisplayHelpOnMissingArgumentOrSubcommand if !is_whole => None,
        _ => Some(format!("{line}: {said}")),
    }
}

/// The texts that were given to an option or argument of a command, none where it has none.
fn given(of: &ArgMatches, name: &str) -> Vec<String> {
    let raw = of.try_get_raw(name).ok().flatten();
    raw.into_iter().flatten().map(|text| text.to_string_lossy().into_owned()).collect()
}

/// What a command's scenarios say against its changes.
fn refused_change(matches: &ArgMatches) -> Option<String> {
    let (name, of) = matches.subcommand()?;
    let changes = match changes(of) {
        Ok(changes) => changes,
        Err(said) => return Some(said),
    };
    let scenario = given(of, "scenario").pop();
    let is_quick = of.try_get_one::<bool>("quick").ok().flatten() == Some(&true);
    let files = match (scenario, name) {
        (Some(file), _) if is_of_tree(&file) => vec![file],
        (None, "reproduce") if is_quick => ["pluviation", "vibration", "repose"]
            .map(|n| format!("scenarios/quick/{n}.json"))
            .into(),
        (None, "reproduce") => {
            let names = ["pluviation", "vibration-continuous", "vibration-intermittent", "repose"];
            names.map(|name| format!("scenarios/paper/{name}.json")).into()
        }
        // A scenario of the reader's: some scenario takes it.
        _ => return changes.iter().find_map(|of_run| refused_by_all(of_run)),
    };
    let mut runs = files.iter().flat_map(|file| changes.iter().map(move |of_run| (file, of_run)));
    runs.find_map(|(file, of_run)| refused_by(file, of_run))
}

/// The changes of each run of a command that gives a run one value of one field beside those of
/// `--set`.
fn changes(of: &ArgMatches) -> Result<Vec<Vec<Override>>, String> {
    let change = |text: &str| text.parse::<Override>().map_err(|e| e.to_string());
    let set: Vec<Override> =
        given(of, "set").iter().map(|text| change(text)).collect::<Result<_, _>>()?;
    let mut varied = Vec::new();
    for text in given(of, "over") {
        varied.extend(text.parse::<Factor>()?.values.into_iter().map(|(_, change)| change));
    }
    for text in given(of, "range") {
        let range: SampledRange = text.parse()?;
        for end in [range.low, range.high] {
            varied.push(change(&format!("{}={end}", range.path))?);
        }
    }
    for (path, between) in given(of, "unknown").iter().zip(given(of, "between")) {
        for end in between.split("..") {
            varied.push(change(&format!("{path}={end}"))?);
        }
    }
    let mut runs = vec![set.clone()];
    runs.extend(varied.into_iter().map(|change| {
        // The file of a placeholder is not there: its path is checked by leaving it out.
        let is_file = change.text().split('=').nth(1).is_some_and(is_placeholder);
        let bare = format!("{}=null", change.path()).parse::<Override>().ok().filter(|_| is_file);
        set.iter().cloned().chain([bare.unwrap_or(change)]).collect()
    }));
    Ok(runs)
}

fn refused_by(file: &str, changes: &[Override]) -> Option<String> {
    let said = load_scenario(&root().join(file), changes).err()?.to_string();
    // A specimen to begin with is made by commands before.
    let is_to_be_made = said.contains("begin.specimen") && said.contains("is not there");
    (!is_to_be_made).then(|| format!("{file}: {said}"))
}

/// What the first scenario says, where none takes the changes.
fn refused_by_all(changes: &[Override]) -> Option<String> {
    if changes.is_empty() {
        return None;
    }
    let mut first = None;
    for folder in ["quick", "paper", "laboratory"] {
        let folder = format!("scenarios/{folder}");
        let entries = fs::read_dir(root().join(&folder)).expect("a folder of scenarios");
        let names = entries.map(|entry| entry.expect("an entry").file_name());
        let mut names: Vec<_> = names.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort();
        for name in names {
            let said = refused_by(&format!("{folder}/{name}"), changes)?;
            first = first.or(Some(said));
        }
    }
    first
}

fn refused(text: &str) -> Vec<String> {
    shown(text).iter().filter_map(fault).collect()
}

/// Law: the program takes every command and every change that a page shows, with all its options
/// and paths.
#[test]
fn commands_that_pages_show_are_taken() {
    let page = |line: &str| format!("```sh\n{line}\n```\n");
    let quick = "pluvia run scenarios/quick/vibration.json --out b";
    for right in [
        page(&format!("{quick} --set stages.3.ramp_s=0.5 # within 2 s")),
        page("pluvia sweep mine.json --over 'stages.0.at_mm=[0, 0, 90]' | sort"),
        "`pluvia run`, `--set path=value`, `pluvia stage DIR --task N`".to_owned(),
        "`--over\nbegin.specimen=RUN1,RUN2`".to_owned(),
    ] {
        let got = refused(&right);
        assert!(got.is_empty(), "law: `{right}` is taken, got {got:#?}");
    }
    for wrong in [
        page("pluvia run a.json --uot b"),
        page("pluvia rnu a.json"),
        page("target/release/pluvia view \\\n  --x"),
        page("pluvia run a.json"),
        page("pluvia run scenarios/quick/none.json --out b"),
        page(&format!("{quick} --set stages.3.ramp=0.5")),
        page(&format!("{quick} --set stages.3.ramp_s=slowly")),
        page("pluvia run mine.json --out b --set engine.rate=960"),
        page("pluvia sweep scenarios/quick/vibration.json --over contact.restitution=0.3,7"),
        page("pluvia reproduce --set stages.3.ramp_s=1"),
        "```text\nExample:\n  pluvia sweep --samples latin-hypercube:20\n```\n".to_owned(),
        "`pluvia run --uot`".to_owned(),
        "`--set engine.rate=960`".to_owned(),
    ] {
        let got = refused(&wrong);
        assert_eq!(got.len(), 1, "law: the check finds one fault in `{wrong}`, got {got:#?}");
    }
    let mut count = 0;
    for document in documents() {
        let text = read(&document);
        // The changelog's text names what was refused or had another name.
        let is_history = document == "CHANGELOG.md";
        let shown = shown(&text).into_iter();
        let shown: Vec<_> = shown.filter(|s| !is_history || matches!(s, Shown::Whole(_))).collect();
        let refused: Vec<_> = shown.iter().filter_map(fault).collect();
        assert!(refused.is_empty(), "law: the program takes what {document} shows: {refused:#?}");
        count += shown.len();
    }
    assert!(count > 150, "expected the commands of all pages, found {count}");
}

/// Commands in brackets of a text, and how often it names `--set` outside of them.
fn advised(text: &str) -> (Vec<Shown>, usize) {
    let (mut commands, mut alone) = (Vec::new(), 0);
    for part in text.split(['(', ')']) {
        if part.starts_with("pluvia ") {
            commands.push(Shown::Whole(part.to_owned()));
        } else {
            alone += part.matches("--set").count();
        }
    }
    (commands, alone)
}

/// Law: what a choice of the paper's report advises to set is taken by the command that it names.
#[test]
fn changes_that_choices_advise_are_taken() {
    let (commands, alone) =
        advised("a ramp (--set, ramp_s) or (pluvia reproduce --set stages.3.ramp_s=1)");
    assert_eq!((commands.len(), alone), (1, 1), "law: the check finds a change without a command");
    assert!(fault(&commands[0]).is_some(), "law: the programme has scenarios of two stages");

    let choices: Vec<Value> =
        serde_json::from_str(&read("src/paper/report/choices.json")).expect("JSON");
    let mut count = 0;
    for choice in &choices {
        for text in ["value", "reason", "sensitivity"].map(|field| choice[field].as_str()) {
            let text = text.unwrap_or_else(|| panic!("law: {choice} has texts"));
            let (commands, alone) = advised(text);
            assert_eq!(alone, 0, "law: `{text}` names the command of each --set");
            let refused: Vec<_> = commands.iter().filter_map(fault).collect();
            assert!(refused.is_empty(), "law: what `{text}` advises is taken, got {refused:#?}");
            count += commands.len();
        }
    }
    assert!(count > 0, "law: the ramp of the table is advised with its command");
}
