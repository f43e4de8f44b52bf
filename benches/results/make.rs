//! Computing results: commands in a folder that resumes, and the files that they leave for
//! `docs/results/`.

use std::{
    fs,
    path::{Path, PathBuf},
    process::{Command, Stdio},
    time::{SystemTime, UNIX_EPOCH},
};

use pluvia::study::STAGE_FORMAT;

use super::{
    builds::{self, Build},
    list::{FOLDER, KEPT, Kept, Made},
    pictures::PICTURES,
};

/// What the last command of a result printed.
const PRINTED_JSON: &str = "printed.json";

/// What `make results` was called with, and is not for the targets that it calls.
const OWN: [&str; 5] = ["ARGS", "MAKEFLAGS", "MAKEOVERRIDES", "MFLAGS", "MAKELEVEL"];

/// Every result with its build, what is missing of it, and its command.
pub fn list(root: &Path) -> Result<String, String> {
    let builds = builds::read(root)?;
    let mut text = String::new();
    for kept in KEPT {
        let build = builds::of(&builds, kept.name).map_or_else(
            || "of no known build".to_owned(),
            |Build { day, format, .. }| format!("of {day}, format {format}"),
        );
        let age = if is_older(&builds, kept) { ": OLDER" } else { "" };
        let missing = missing(root, kept);
        let missing = match missing.is_empty() {
            true => String::new(),
            false => format!("; missing: {}", missing.join(", ")),
        };
        text += &format!(
            "{}: {} ({build}, today {STAGE_FORMAT}{age}{missing})\n",
            kept.name, kept.what
        );
        match &kept.made {
            Made::Pluvia(commands) => {
                for command in *commands {
                    text += &format!("    pluvia {command}    [{}]\n", kept.takes);
                }
            }
            Made::Make(target) => text += &format!("    make {target}    [{}]\n", kept.takes),
            Made::Once(command) => {
                text += &format!("    by hand or by an earlier build: {command}\n")
            }
        }
    }
    Ok(text)
}

/// Files of a result that are not there.
fn missing(root: &Path, kept: &Kept) -> Vec<&'static str> {
    let there = |file: &str| root.join(FOLDER).join(file).exists();
    kept.files.iter().map(|f| f.0).filter(|file| !there(file)).collect()
}

/// Whether a result is of an older build than this.
fn is_older(builds: &[Build], kept: &Kept) -> bool {
    builds::of(builds, kept.name).is_none_or(|build| build.is_older(STAGE_FORMAT))
}

/// Which results are asked for.
#[derive(Debug, Default)]
pub struct Asked {
    /// These, whatever is there of them; empty: those with missing files.
    pub only: Vec<String>,
    /// Those of older builds as well.
    pub older: bool,
    /// Those of make targets as well.
    pub targets: bool,
}

/// What comes of it.
pub struct Chosen {
    /// Results to compute.
    pub to_make: Vec<&'static Kept>,
    /// Which of those asked for are not computed, and why, a line each.
    pub left: Vec<String>,
}

/// Refuses names of no result.
pub fn known(option: &str, names: &[String]) -> Result<(), String> {
    let is_known = |name: &&String| KEPT.iter().any(|kept| kept.name == name.as_str());
    match names.iter().find(|name| !is_known(name)) {
        None => Ok(()),
        Some(name) => {
            let known: Vec<&str> = KEPT.iter().map(|k| k.name).collect();
            let known = known.join(", ");
            Err(format!("{option}: no result is named {name}; allowed are {known}"))
        }
    }
}

/// Results to compute, and those that are not though they are asked for.
pub fn chosen(root: &Path, asked: &Asked) -> Result<Chosen, String> {
    known("--only", &asked.only)?;
    let builds = builds::read(root)?;
    let is_wanted = |kept: &Kept| match asked.only.is_empty() {
        true => !missing(root, kept).is_empty() || asked.older && is_older(&builds, kept),
        false => asked.only.iter().any(|name| name == kept.name),
    };
    let mut chosen = Chosen { to_make: Vec::new(), left: Vec::new() };
    for kept in KEPT.iter().filter(|kept| is_wanted(kept)) {
        let Kept { name, takes, .. } = kept;
        match &kept.made {
            Made::Once(command) => {
                let why =
                    format!("{name}: not made: it was by hand or by an earlier build ({command})");
                chosen.left.push(why);
            }
            Made::Make(target) if asked.only.is_empty() && !asked.targets => {
                chosen.left.push(format!(
                    "{name}: not made unasked: takes {takes} (`make {target}`; --only {name} or \
                     --targets calls it)"
                ));
            }
            Made::Pluvia(_) | Made::Make(_) => chosen.to_make.push(kept),
        }
    }
    Ok(chosen)
}

/// Records that results are of this build; refuses those whose files are not there.
pub fn built(root: &Path, names: &[String]) -> Result<(), String> {
    known("--built", names)?;
    for kept in KEPT.iter().filter(|kept| names.iter().any(|name| name == kept.name)) {
        let missing = missing(root, kept);
        if !missing.is_empty() {
            let files = missing.join(", ");
            return Err(format!("--built: {}: not in {FOLDER}: {files}", kept.name));
        }
    }
    let now = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    for name in names {
        let (day, format) = (builds::day(now), STAGE_FORMAT.to_string());
        builds::record(root, Build { name: name.clone(), day, format })?;
    }
    Ok(())
}

/// Computes results.
pub struct Maker<'a> {
    /// Root of the tree.
    pub root: &'a Path,
    /// Folder of runs.
    pub out: &'a Path,
    /// The program.
    pub program: &'a Path,
}

impl Maker<'_> {
    /// Runs the commands of a result, keeps its files, and records its build.
    pub fn make(&self, kept: &Kept) -> Result<(), String> {
        let name = kept.name;
        // Studies do not go on with runs of another build.
        let out = self.root.join(self.out).join(format!("format-{STAGE_FORMAT}")).join(name);
        println!("{name}: {} ({})", kept.what, kept.takes);
        match &kept.made {
            Made::Pluvia(commands) => {
                for command in *commands {
                    let printed = self.run(command, &[("OUT", &out)])?;
                    fs::create_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
                    let to = out.join(PRINTED_JSON);
                    fs::write(&to, printed).map_err(|e| format!("{}: {e}", to.display()))?;
                }
            }
            Made::Make(target) => self.target(target, &out)?,
            Made::Once(command) => {
                return Err(format!(
                    "{name}: it was made by hand or by an earlier build ({command})"
                ));
            }
        }
        let place = |file: &str| self.root.join(FOLDER).join(file);
        let copies: Vec<(PathBuf, PathBuf)> = kept
            .files
            .iter()
            .filter(|(_, from)| !from.is_empty())
            .map(|(file, from)| (self.place(&kept.made, from, &out), place(file)))
            .collect();
        // All or none: a result is of one build.
        if let Some((from, _)) = copies.iter().find(|(from, _)| !from.is_file()) {
            return Err(format!(
                "{name}: {} is not there; none of its files is kept",
                from.display()
            ));
        }
        for (from, to) in &copies {
            copy(from, to)?;
        }
        let is_by_hand = copies.len() < kept.files.len() && !matches!(kept.made, Made::Make(_));
        for (file, _) in kept.files.iter().filter(|(_, from)| is_by_hand && from.is_empty()) {
            println!("{name}: {} is edited by hand from {}", place(file).display(), out.display());
        }
        if is_by_hand {
            println!("{name}: once it is, record its build by --built {name}");
            return Ok(());
        }
        built(self.root, &[name.to_owned()])?;
        println!("{name}: kept");
        Ok(())
    }

    /// Where a command has left a file.
    fn place(&self, made: &Made, from: &str, out: &Path) -> PathBuf {
        match (made, from.strip_prefix("OUT/")) {
            (Made::Make(_), Some(from)) => out.join(from),
            (Made::Make(_), None) => self.root.join(from),
            _ => out.join(from),
        }
    }

    /// Calls a make target.
    fn target(&self, target: &str, out: &Path) -> Result<(), String> {
        let mut shell = Command::new("sh");
        shell.arg("-c").arg(format!("make OUT=\"$OUT\" {target}"));
        shell.current_dir(self.root).env("OUT", out);
        for variable in OWN {
            shell.env_remove(variable);
        }
        let status = shell.status().map_err(|e| format!("sh: {e}"))?;
        if status.success() { Ok(()) } else { Err(format!("`make {target}`: {status}")) }
    }

    /// Draws the pictures anew, of runs that resume. One that fails does not keep the others from
    /// being drawn.
    pub fn pictures(&self) -> Result<(), String> {
        let mut failed = Vec::new();
        for (picture, scenario, command) in PICTURES {
            match self.picture(picture, scenario, command) {
                Ok(to) => println!("{}: drawn", to.display()),
                Err(why) => {
                    eprintln!("error: {why}");
                    failed.push(*picture);
                }
            }
        }
        if failed.is_empty() { Ok(()) } else { Err(format!("not drawn: {}", failed.join(", "))) }
    }

    /// Draws a picture of a scenario's run; where it is.
    fn picture(&self, picture: &str, scenario: &str, command: &str) -> Result<PathBuf, String> {
        let name = Path::new(scenario).file_stem().unwrap_or_default();
        let run = self.root.join(self.out).join("pictures").join(name);
        self.run(&format!("run {scenario} --out RUN"), &[("RUN", &run)])?;
        let to = self.root.join("docs/pictures").join(picture);
        self.run(&format!("{command} --force"), &[("RUN", &run), ("PICTURE", &to)])?;
        Ok(to)
    }

    /// Runs a command; what it prints.
    fn run(&self, command: &str, places: &[(&str, &Path)]) -> Result<Vec<u8>, String> {
        // Files that are kept name what they are about by its place in the tree.
        let within = |path: &Path| path.strip_prefix(self.root).unwrap_or(path).to_path_buf();
        let words = command.split_whitespace().map(|word| {
            places
                .iter()
                .fold(word.to_owned(), |word, (name, path)| placed(&word, name, &within(path)))
        });
        let output = Command::new(self.root.join(self.program))
            .current_dir(self.root)
            .args(words)
            .stderr(Stdio::inherit())
            .output()
            .map_err(|e| format!("{}: {e}", self.program.display()))?;
        // 1: done, but an expectation was missed, which is a result, too.
        match output.status.code() {
            Some(0 | 1) => Ok(output.stdout),
            _ => Err(format!("`pluvia {command}`: {}", output.status)),
        }
    }
}

/// A word of a command with the place that `name` stands for, wherever a path in it begins with this.
fn placed(word: &str, name: &str, place: &Path) -> String {
    let path = |path: &str| match path.strip_prefix(name) {
        Some("") => place.display().to_string(),
        Some(rest) if rest.starts_with('/') => format!("{}{rest}", place.display()),
        _ => path.to_owned(),
    };
    let list = |list: &str| list.split(',').map(path).collect::<Vec<_>>().join(",");
    match word.split_once('=') {
        Some((field, values)) => format!("{field}={}", list(values)),
        None => path(word),
    }
}

/// Copies a file, and makes the folder that it goes to.
fn copy(from: &Path, to: &Path) -> Result<(), String> {
    let folder = to.parent().ok_or("a file has a folder")?;
    fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
    fs::copy(from, to).map_err(|e| format!("{}: {e}", from.display()))?;
    Ok(())
}
