//! Measured numbers in pages outside of marks.
//!
//! What counts: a decimal number with a unit of results, a whole one with a unit that only results
//! have here (%, µm/s, °, MiB, minutes), what has a ±, a decimal where the line speaks of void
//! ratios, decimals in cells of tables, and the format of a build, which `builds.csv` knows. What
//! does not: what the paper states and what is typed ([`TYPED`]), and whole numbers of mm, s, Hz:
//! sizes, times and rates that are typed.
//!
//! `docs/results/unmarked.csv` allows them by section, with at most how many and why.

use std::collections::BTreeMap;

/// Units whose decimal numbers are measured, the longer ones first.
const UNITS: &[&str] = &[
    "mm/s", "µm/s", "mm", "µm", "cm³", "ms", "µs", "ns", "s", "MiB", "KiB", "GiB", "%", "°",
    "minutes", "hours",
];

/// Of these whole numbers are measured, too.
const OF_RESULTS: &[&str] = &["mm/s", "µm/s", "MiB", "KiB", "GiB", "%", "°", "minutes"];

/// What the paper states or scenarios type, and the limits of the accuracy standard.
const TYPED: &[&str] = &[
    // The paper: friction, restitution, their products, repose, settlement, density, sampling.
    "0.793", "0.315", "0.629", "0.099", "38.40", "38.4", "38.42", "14", "19.61", "80", "85",
    "2673.9", "0.08", "2.5", "11 %", "12.5",
    // Sieves and grading of the paper's gravel as typed.
    "11.2", "51.95", "33.05", "31.5", "6.3", "4.75", "0.075",
    // Confidence; the accuracy standard.
    "95", "0.5", "3 %", "5 µm/s", "0.1 mm", // Defaults of settings.
    "0.002", "0.0025", "0.02 mm", "1.5 s",
];

/// How many measured numbers without a mark stand in each section of a page; sections by their
/// headings, what stands above the first under an empty one.
pub fn unmarked(page: &str) -> BTreeMap<String, Vec<String>> {
    let mut found: BTreeMap<String, Vec<String>> = BTreeMap::new();
    let (mut section, mut fenced) = (String::new(), false);
    for line in super::marks::without(page).lines() {
        if line.trim_start().starts_with("```") {
            fenced = !fenced;
        } else if !fenced && line.starts_with('#') {
            line.trim_start_matches('#').trim().clone_into(&mut section);
        } else if !fenced {
            let numbers = measured(&bare(line));
            if !numbers.is_empty() {
                found.entry(section.clone()).or_default().extend(numbers);
            }
        }
    }
    found
}

/// A line without inline code, comments and targets of links.
fn bare(line: &str) -> String {
    let mut text: String = line.split('`').step_by(2).collect::<Vec<_>>().join(" code ");
    for (begin, end) in [("<!--", "-->"), ("](", ")")] {
        while let Some(at) = text.find(begin) {
            let to = text[at..].find(end).map_or(text.len(), |n| at + n + end.len());
            text.replace_range(at..to, " ");
        }
    }
    text
}

/// Measured numbers of a line, each with its unit.
fn measured(line: &str) -> Vec<String> {
    let (cells, void) = (line.starts_with('|'), line.contains("void ratio"));
    let chars: Vec<char> = line.chars().collect();
    let (mut found, mut at) = (Vec::new(), 0);
    while at < chars.len() {
        let follows_word =
            at > 0 && (chars[at - 1].is_alphanumeric() || "._-/²³^".contains(chars[at - 1]));
        if !chars[at].is_ascii_digit() || follows_word {
            at += 1;
            continue;
        }
        let mut to = at;
        while to < chars.len()
            && (chars[to].is_ascii_digit()
                || chars[to] == '.' && chars.get(to + 1).is_some_and(char::is_ascii_digit))
        {
            to += 1;
        }
        let number: String = chars[at..to].iter().collect();
        let rest: String = chars[to..].iter().collect();
        let plus_minus = rest.starts_with(" ±");
        let unit = UNITS.iter().find(|unit| {
            // The number's own, or that of the range or the list that it stands in.
            let mut tail = rest.as_str();
            loop {
                tail = tail.trim_start_matches([' ', '\u{a0}']);
                if let Some(after) = tail.strip_prefix(**unit) {
                    break !after.starts_with(|c: char| c.is_alphanumeric() || c == '/');
                }
                let between = ["±", "to ", "/", ", ", "and ", "…"];
                let Some(after) = between.iter().find_map(|b| tail.strip_prefix(b)) else {
                    break false;
                };
                let after = after.trim_start_matches([' ', '−']);
                let next = after.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
                if next.len() == after.len() {
                    break false;
                }
                tail = next;
            }
        });
        let before: String = chars[..at].iter().collect();
        let of_build = before.ends_with("ormat ") || before.ends_with("ormats ");
        let decimal = number.contains('.') && number.matches('.').count() == 1;
        let counts = match unit {
            Some(unit) => decimal || plus_minus || OF_RESULTS.contains(unit),
            None => plus_minus || decimal && (cells || void),
        };
        let text = unit.map_or_else(|| number.clone(), |unit| format!("{number} {unit}"));
        let is_typed = TYPED.contains(&number.as_str()) || TYPED.contains(&text.as_str());
        if of_build {
            found.push(format!("format {text}"));
        } else if counts && !is_typed {
            found.push(text);
        }
        at = to;
    }
    found
}

/// A row of `docs/results/unmarked.csv`.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct Allowed {
    /// Page, from the root of the tree.
    pub page: String,
    /// Heading of the section; empty above the first.
    pub section: String,
    /// At most how many.
    pub most: usize,
    /// What kind of numbers they are.
    pub kind: Kind,
    /// Where they come from.
    pub why: String,
}

/// Why a section may quote numbers without marks.
#[derive(Debug, Clone, Copy, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Kind {
    /// What is typed, or follows from it by arithmetic.
    Input,
    /// Rules, limits and examples of this program.
    Definition,
    /// Quoted from a paper, a standard or another program.
    Source,
    /// Printed by a command as it stands there: the page is a results file.
    Printed,
    /// Measured by a build of then, no file of which is kept; the section says so.
    Earlier,
}

/// What a section of kind `earlier` must say.
pub const EARLIER: &str = "of an earlier build";

/// What is wrong between the pages and the list.
pub fn faults(pages: &[(String, String)], allowed: &[Allowed]) -> Vec<String> {
    let mut faults = Vec::new();
    let mut used = vec![false; allowed.len()];
    for (page, text) in pages {
        for (section, numbers) in unmarked(text) {
            let at = allowed.iter().position(|a| a.page == *page && a.section == section);
            let most = at.map_or(0, |at| allowed[at].most);
            if let Some(at) = at {
                used[at] = true;
            }
            if numbers.len() > most {
                faults.push(format!(
                    "{page}, section `{section}`: {} measured numbers without a mark, {most} are \
                     allowed: {}",
                    numbers.len(),
                    numbers.join("; ")
                ));
            }
        }
        for row in allowed.iter().filter(|a| a.page == *page && a.kind == Kind::Earlier) {
            if !section_text(text, &row.section).contains(EARLIER) {
                faults.push(format!(
                    "{page}, section `{}`: it does not say that its numbers are {EARLIER}",
                    row.section
                ));
            }
        }
    }
    for (row, _) in allowed.iter().zip(used).filter(|(_, used)| !used) {
        faults.push(format!(
            "unmarked.csv allows {}, section `{}`, which quotes nothing unmarked",
            row.page, row.section
        ));
    }
    faults
}

/// The text of a section, line breaks as spaces.
fn section_text(page: &str, section: &str) -> String {
    let (mut inside, mut fenced, mut found) = (section.is_empty(), false, String::new());
    for line in page.lines() {
        if line.starts_with("```") {
            fenced = !fenced;
        }
        if !fenced && line.starts_with('#') {
            inside = line.trim_start_matches('#').trim() == section;
        } else if inside {
            found += line;
            found.push(' ');
        }
    }
    found
}

/// The list with no more allowed than there is: what was marked or taken out stays so.
pub fn lowered(pages: &[(String, String)], allowed: &[Allowed]) -> Vec<Allowed> {
    let count = |row: &Allowed| {
        let (_, text) = pages.iter().find(|(page, _)| *page == row.page)?;
        unmarked(text).get(&row.section).map(Vec::len)
    };
    allowed
        .iter()
        .filter_map(|row| Some(Allowed { most: row.most.min(count(row)?), ..row.clone() }))
        .collect()
}
