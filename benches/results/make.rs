//! Computing results: commands of the program in a folder that resumes, and the files that they
//! leave for `docs/results/`.

use std::{
    fs,
    path::Path,
    process::{Command, Stdio},
};

use super::list::{FOLDER, KEPT, Kept, Made, PICTURES};

/// What the last command of a result printed.
const PRINTED_JSON: &str = "printed.json";

/// Prints every result with its build, its command and what is missing.
pub fn list(root: &Path) {
    for kept in KEPT {
        let missing = missing(root, kept);
        let state = if missing.is_empty() {
            format!("of {}, format {}", kept.build.day, kept.build.format)
        } else {
            format!("missing: {}", missing.join(", "))
        };
        println!("{}: {} ({state})", kept.name, kept.what);
        match &kept.made {
            Made::Pluvia(commands) => {
                for command in *commands {
                    println!("    pluvia {command}    [{}]", kept.takes);
                }
            }
            Made::Make(target) => println!("    make {target}    [{}]", kept.takes),
            Made::Once(command) => println!("    not repeatable: {command}"),
        }
    }
}

/// Files of a result that are not there.
fn missing(root: &Path, kept: &Kept) -> Vec<&'static str> {
    let there = |file: &str| root.join(FOLDER).join(file).exists();
    kept.files.iter().map(|f| f.0).filter(|file| !there(file)).collect()
}

/// Results to compute: those named, or those with missing files.
pub fn chosen(root: &Path, only: &[String]) -> Result<Vec<&'static Kept>, String> {
    let unknown: Vec<&str> = only
        .iter()
        .map(String::as_str)
        .filter(|name| !KEPT.iter().any(|k| k.name == *name))
        .collect();
    if !unknown.is_empty() {
        let known: Vec<&str> = KEPT.iter().map(|k| k.name).collect();
        let [unknown, known] = [unknown, known].map(|names| names.join(", "));
        return Err(format!("--only: no result is named {unknown}; allowed are {known}"));
    }
    let wanted = |k: &&Kept| {
        if only.is_empty() {
            !missing(root, k).is_empty()
        } else {
            only.iter().any(|n| n == k.name)
        }
    };
    Ok(KEPT.iter().filter(wanted).collect())
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
    /// Runs the commands of a result and keeps its files.
    pub fn make(&self, kept: &Kept) -> Result<(), String> {
        let name = kept.name;
        let commands = match &kept.made {
            Made::Pluvia(commands) => *commands,
            Made::Make(target) => return Err(format!("{name}: `make {target}` makes it")),
            Made::Once(command) => {
                return Err(format!("{name}: today's code cannot repeat it ({command})"));
            }
        };
        let out = self.root.join(self.out).join(name);
        println!("{name}: {} ({})", kept.what, kept.takes);
        for command in commands {
            let printed = self.run(command, &[("OUT", &out)])?;
            fs::create_dir_all(&out).map_err(|e| format!("{}: {e}", out.display()))?;
            let to = out.join(PRINTED_JSON);
            fs::write(&to, printed).map_err(|e| format!("{}: {e}", to.display()))?;
        }
        for (file, from) in kept.files {
            let to = self.root.join(FOLDER).join(file);
            if from.is_empty() {
                println!("{name}: {} is edited by hand from {}", to.display(), out.display());
                continue;
            }
            let folder = to.parent().ok_or("a file has a folder")?;
            fs::create_dir_all(folder).map_err(|e| format!("{}: {e}", folder.display()))?;
            let from = out.join(from);
            fs::copy(&from, &to).map_err(|e| format!("{}: {e}", from.display()))?;
        }
        println!("{name}: kept; put its build into benches/results/list.rs");
        Ok(())
    }

    /// Draws the pictures anew, of runs that resume.
    pub fn pictures(&self) -> Result<(), String> {
        for (picture, scenario, command) in PICTURES {
            let name = Path::new(scenario).file_stem().unwrap_or_default();
            let run = self.root.join(self.out).join("pictures").join(name);
            self.run(&format!("run {scenario} --out RUN"), &[("RUN", &run)])?;
            let to = self.root.join("docs/pictures").join(picture);
            self.run(&format!("{command} --force"), &[("RUN", &run), ("PICTURE", &to)])?;
            println!("{}: drawn", to.display());
        }
        Ok(())
    }

    /// Runs a command; what it prints.
    fn run(&self, command: &str, places: &[(&str, &Path)]) -> Result<Vec<u8>, String> {
        let words = command.split_whitespace().map(|word| {
            let place = places.iter().find(|(name, _)| *name == word);
            place.map_or_else(|| word.into(), |(_, path)| path.as_os_str().to_owned())
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
