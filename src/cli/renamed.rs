//! Commands and options that had another name once: each is refused with the name of today.

use std::ffi::OsStr;

/// Old names of commands and new ones.
const COMMANDS: [(&str, &str); 1] = [("readings", "interpretations")];
/// A command, an old option of it and the new one.
const OPTIONS: [(&str, &str, &str); 2] = [
    ("reproduce", "--reading", "--interpretation"),
    ("calibrate", "--replicates", "--realisations"),
];

/// What to say of the words of a command line, the program's name not among them; nothing
/// where none has another name now.
pub(super) fn refused<S: AsRef<OsStr>>(words: &[S]) -> Option<String> {
    let mut words = words.iter().filter_map(|word| word.as_ref().to_str());
    let command = words.find(|word| !word.starts_with('-'))?;
    if let Some((old, new)) = COMMANDS.iter().find(|(old, _)| *old == command) {
        return Some(format!("`pluvia {old}` is now called `pluvia {new}`"));
    }
    let options: Vec<&str> = words.take_while(|word| *word != "--").collect();
    OPTIONS.iter().filter(|(of, ..)| *of == command).find_map(|(of, old, new)| {
        let asked = |word: &&str| word.split('=').next() == Some(*old);
        let text = format!("`{old}` of `pluvia {of}` is now called `{new}`");
        options.iter().any(asked).then_some(text)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: old names are refused with the new ones; others are left alone.
    #[test]
    fn old_commands_and_options_are_refused_with_the_new_name() {
        let said = |line: &str| refused(&line.split(' ').collect::<Vec<_>>());
        for (line, new) in [
            ("readings --quick", "pluvia interpretations"),
            ("--quiet readings", "pluvia interpretations"),
            ("reproduce --reading full_stroke", "`--interpretation`"),
            ("reproduce --quick --reading=full_stroke", "`--interpretation`"),
            ("calibrate s.json --replicates 3", "`--realisations`"),
        ] {
            let said = said(line).unwrap_or_default();
            assert!(said.contains(new), "law: `{line}` is refused with {new}, got `{said}`");
        }
        for line in [
            "interpretations",
            "reproduce --interpretation x",
            "run readings",
            "calibrate s.json --realisations 3",
            "reproduce -- --reading",
        ] {
            assert_eq!(said(line), None, "law: `{line}` has no old name");
        }
    }
}
