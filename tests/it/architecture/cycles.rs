//! Which files of a module use each other, from their tokens: named imports, paths, and names that
//! come through `use super::*` and re-exports.
//!
//! It finds hardly any use that is not there (names of generics, and of constants in functions),
//! and may miss some: methods that a file adds to a type of another, macros, and lower-case names
//! that the file also gives to something of its own. A module's `mod.rs` only puts its files
//! together, and tests are left out; the files of a folder `a/` beside `a.rs` count as parts of it.

use std::collections::{BTreeMap, HashMap, HashSet};

use super::tokens::tokens;

/// What begins an item with a name.
const ITEMS: [&str; 8] = ["fn", "struct", "enum", "trait", "type", "const", "static", "union"];

/// A file of the source without its tests; modules are named as `scenario/validate/until`.
struct Source {
    words: Vec<String>,
    /// What it defines outside of every block.
    items: HashSet<String>,
    /// Paths that it imports, and as what: `*` for everything.
    uses: Vec<(Vec<String>, String)>,
}

/// The files below `src/` that are no tests.
pub struct Sources {
    files: BTreeMap<String, Source>,
    /// Those that are a `mod.rs`.
    faces: HashSet<String>,
}

impl Sources {
    /// From paths such as `src/grains/sieve.rs` and the files' texts.
    pub fn new(files: &[(String, String)]) -> Self {
        let mut tests = Vec::new();
        let mut faces = HashSet::new();
        let mut sources = BTreeMap::new();
        for (path, text) in files {
            let Some(inside) = path.strip_prefix("src/").and_then(|p| p.strip_suffix(".rs")) else {
                continue;
            };
            let words: Vec<String> = tokens(text).into_iter().map(|token| token.text).collect();
            let module = match inside.strip_suffix("/mod") {
                Some(module) => {
                    faces.insert(module.to_owned());
                    module
                }
                None if inside == "lib" => "",
                None => inside,
            };
            let words = without_tests(&words, module, &mut tests);
            if !matches!(module, "" | "main") {
                let (items, uses) = (items(&words), uses(&words));
                sources.insert(module.to_owned(), Source { words, items, uses });
            }
        }
        let is_test = |module: &String| {
            // `#[path = "x_tests.rs"] mod tests;` is noted by its other name.
            module.ends_with("_tests")
                || tests.iter().any(|test: &String| {
                    let inside = module.strip_prefix(test.as_str());
                    inside.is_some_and(|inside| inside.is_empty() || inside.starts_with('/'))
                })
        };
        sources.retain(|module: &String, _| !is_test(module));
        Self { files: sources, faces }
    }

    /// Uses of one file by another of the same module, with a name that is used.
    pub fn edges(&self) -> BTreeMap<(String, String), String> {
        let mut edges = BTreeMap::new();
        let files = self.files.iter().filter(|(module, _)| !self.faces.contains(*module));
        for (module, source) in files {
            for (used, name) in self.used_by(module, source) {
                if self.faces.contains(&used) || !self.files.contains_key(&used) {
                    continue;
                }
                let (from, to) = (self.node(module), self.node(&used));
                if from != to && first(from) == first(to) {
                    edges.entry((from.to_owned(), to.to_owned())).or_insert(name);
                }
            }
        }
        edges
    }

    /// The modules where what a file uses is defined.
    fn used_by(&self, module: &str, source: &Source) -> Vec<(String, String)> {
        let words = &source.words;
        let word = |i: usize| words.get(i).map_or("", String::as_str);
        let (own, variants) = (own_names(words), variants(words));
        let mut known: HashMap<&str, Option<String>> = HashMap::new();
        let mut found = Vec::new();
        for (path, name) in source.uses.iter().filter(|(_, name)| name != "*") {
            let used = self.followed(module, path, &mut HashSet::new());
            found.extend(used.map(|used| (used, name.clone())));
        }
        let mut at = 0;
        while at < words.len() {
            if begins_use(words, at) {
                while at < words.len() && word(at) != ";" {
                    at += 1;
                }
                continue;
            }
            let (name, here) = (word(at), at);
            let (before, after) = (if at > 0 { word(at - 1) } else { "" }, word(at + 1));
            at += 1;
            let inner = ITEMS.contains(&before) || matches!(before, "." | "::" | "let" | "mod");
            if !is_word(name) || inner || variants.contains(&here) {
                continue;
            }
            if matches!(name, "crate" | "super" | "self") {
                if after == "::" {
                    let mut path = vec![name.to_owned()];
                    let mut next = at;
                    while word(next) == "::" && is_word(word(next + 1)) {
                        path.push(word(next + 1).to_owned());
                        next += 2;
                    }
                    let used = self.followed(module, &path, &mut HashSet::new());
                    found.extend(used.zip(path.pop()));
                }
                continue;
            }
            let alone = matches!(before, "(" | ",") && matches!(after, ")" | ",");
            let called = matches!(after, "(" | "::") || alone;
            let is_type = name.starts_with(|c: char| c.is_ascii_uppercase());
            let may_use = is_type || called && !own.contains(name);
            if !may_use {
                continue;
            }
            let define = || self.defined(module, name, &mut HashSet::new());
            let Some(used) = known.entry(name).or_insert_with(define).clone() else { continue };
            let defines = self.files.get(&used).is_some_and(|file| file.items.contains(name));
            let is_module = last(&used) == name && !defines;
            if !is_module || after == "::" {
                found.push((used, name.to_owned()));
            }
        }
        found
    }

    /// Where what a name stands for in a module is defined.
    fn defined(
        &self,
        module: &str,
        name: &str,
        seen: &mut HashSet<(String, String)>,
    ) -> Option<String> {
        let source = self.files.get(module)?;
        if !seen.insert((module.to_owned(), name.to_owned())) {
            return None;
        }
        if source.items.contains(name) {
            return Some(module.to_owned());
        }
        let below = child(module, name);
        if self.files.contains_key(&below) {
            return Some(below);
        }
        for (path, _) in source.uses.iter().filter(|(_, as_name)| as_name == name) {
            if let Some(used) = self.followed(module, path, seen) {
                return Some(used);
            }
        }
        for (path, _) in source.uses.iter().filter(|(_, as_name)| as_name == "*") {
            let from = self.followed(module, path, seen).filter(|from| from != module);
            if let Some(used) = from.and_then(|from| self.defined(&from, name, seen)) {
                return Some(used);
            }
        }
        None
    }

    /// Where what a path in a module leads to is defined.
    fn followed(
        &self,
        module: &str,
        path: &[String],
        seen: &mut HashSet<(String, String)>,
    ) -> Option<String> {
        let supers = path.iter().take_while(|word| *word == "super").count();
        let (mut at, mut rest) = match path.first()?.as_str() {
            "crate" => (String::new(), &path[1..]),
            "self" => (module.to_owned(), &path[1..]),
            "super" => ((0..supers).fold(module, |at, _| parent(at)).to_owned(), &path[supers..]),
            name if self.files.contains_key(&child(module, name)) => (module.to_owned(), path),
            _ => return None,
        };
        while let Some((name, after)) = rest.split_first() {
            let below = child(&at, name);
            if !self.files.contains_key(&below) {
                break;
            }
            (at, rest) = (below, after);
        }
        match rest.first().map(String::as_str) {
            None | Some("*") => Some(at),
            Some(name) => self.defined(&at, name, seen),
        }
    }

    /// The file that a module counts as.
    fn node<'m>(&self, module: &'m str) -> &'m str {
        let mut above = module.match_indices('/').map(move |(end, _)| &module[..end]);
        let is_file = |above: &str| self.files.contains_key(above) && !self.faces.contains(above);
        above.find(|above| is_file(above)).unwrap_or(module)
    }
}

/// The edges that lie on a cycle.
pub fn on_cycles<'e>(edges: &[&'e (String, String)]) -> Vec<&'e (String, String)> {
    let mut uses: HashMap<&str, Vec<&str>> = HashMap::new();
    for (from, to) in edges {
        uses.entry(from).or_default().push(to);
    }
    let reaches = |from: &str, goal: &str| {
        let mut seen = HashSet::new();
        let mut open = vec![from];
        while let Some(at) = open.pop() {
            if at == goal {
                return true;
            }
            if seen.insert(at) {
                open.extend(uses.get(at).into_iter().flatten().copied());
            }
        }
        false
    };
    edges.iter().copied().filter(|(from, to)| reaches(to, from)).collect()
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_ascii_alphabetic() || c == '_')
}

fn child(module: &str, name: &str) -> String {
    if module.is_empty() { name.to_owned() } else { format!("{module}/{name}") }
}

fn parent(module: &str) -> &str {
    module.rsplit_once('/').map_or("", |(parent, _)| parent)
}

fn first(module: &str) -> &str {
    module.split('/').next().unwrap_or_default()
}

fn last(module: &str) -> &str {
    module.rsplit('/').next().unwrap_or_default()
}

/// Words without what is compiled for tests alone; the modules that are files of tests are noted.
fn without_tests(words: &[String], module: &str, tests: &mut Vec<String>) -> Vec<String> {
    let mark = ["#", "[", "cfg", "(", "test", ")", "]"];
    let mut kept = Vec::new();
    let mut at = 0;
    while at < words.len() {
        if !words[at..].iter().take(mark.len()).eq(mark.iter()) {
            kept.push(words[at].clone());
            at += 1;
            continue;
        }
        at += mark.len();
        let mut depth = 0_i32;
        while let Some(word) = words.get(at).map(String::as_str) {
            match word {
                "mod" if depth == 0 => tests.extend(words.get(at + 1).map(|n| child(module, n))),
                "(" | "[" | "{" => depth += 1,
                ")" | "]" | "}" => depth -= 1,
                _ => {}
            }
            if depth < 0 {
                break;
            }
            at += 1;
            if depth == 0 && matches!(word, "}" | ";") {
                break;
            }
        }
    }
    kept
}

fn items(words: &[String]) -> HashSet<String> {
    let mut items = HashSet::new();
    let mut depth = 0_i32;
    for (at, word) in words.iter().enumerate() {
        match word.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            kind if depth == 0 && ITEMS.contains(&kind) => {
                let name = words.get(at + 1);
                let name = name.filter(|n| is_word(n) && !ITEMS.contains(&n.as_str()));
                items.extend(name.cloned());
            }
            _ => {}
        }
    }
    items
}

fn begins_use(words: &[String], at: usize) -> bool {
    let begins = [";", "}", "{", ")", "pub", "]"];
    words[at] == "use" && (at == 0 || begins.contains(&words[at - 1].as_str()))
}

fn uses(words: &[String]) -> Vec<(Vec<String>, String)> {
    let mut found = Vec::new();
    let mut at = 0;
    while at < words.len() {
        if begins_use(words, at) {
            at = add_tree(words, at + 1, &[], &mut found);
        }
        at += 1;
    }
    found
}

/// Adds the imports of a tree that begins at a word, below a path; gives where it ends.
fn add_tree(
    words: &[String],
    mut at: usize,
    below: &[String],
    found: &mut Vec<(Vec<String>, String)>,
) -> usize {
    let mut path = below.to_vec();
    while let Some(word) = words.get(at) {
        match word.as_str() {
            "{" => {
                while words.get(at).is_some_and(|word| word != "}") {
                    at = add_tree(words, at + 1, &path, found);
                }
                return at + 1;
            }
            "as" => {
                found.extend(words.get(at + 1).map(|name| (path, name.clone())));
                return at + 2;
            }
            "," | ";" | "}" => {
                if path.len() > below.len() {
                    if path.last().is_some_and(|last| last == "self") {
                        path.pop();
                    }
                    found.extend(path.last().cloned().map(|name| (path, name)));
                }
                return at;
            }
            "::" => {}
            _ => path.push(word.clone()),
        }
        at += 1;
    }
    at
}

/// Where in the words the variants of enums are named.
fn variants(words: &[String]) -> HashSet<usize> {
    let mut found = HashSet::new();
    let mut at = 0;
    while at < words.len() {
        if words[at] == "enum" {
            while at < words.len() && words[at] != "{" {
                at += 1;
            }
            let (mut depth, mut begins) = (0, false);
            while at < words.len() {
                match words[at].as_str() {
                    "(" | "[" | "{" => {
                        depth += 1;
                        begins |= depth == 1;
                    }
                    ")" | "]" | "}" => {
                        depth -= 1;
                        if depth == 0 {
                            break;
                        }
                    }
                    "," if depth == 1 => begins = true,
                    word if depth == 1 && begins && is_word(word) => {
                        found.insert(at);
                        begins = false;
                    }
                    _ => {}
                }
                at += 1;
            }
        }
        at += 1;
    }
    found
}

/// Lower-case names that a file gives to values, arguments, fields and functions of its own.
fn own_names(words: &[String]) -> HashSet<&str> {
    let word = |i: usize| words.get(i).map_or("", String::as_str);
    let mut names = HashSet::new();
    for at in 0..words.len() {
        let before = if at > 0 { word(at - 1) } else { "" };
        let named = matches!(before, "let" | "mut" | "ref" | "fn");
        if is_word(word(at)) && (named || matches!(word(at + 1), ":" | "@")) {
            names.insert(word(at));
        }
        // A pattern is no longer than this.
        let ends: &[&str] = match word(at) {
            "let" => &["=", ";"],
            "for" => &["in", "{"],
            "|" => &["|", ";", "{"],
            _ => continue,
        };
        let pattern = (at + 1..at + 41).map(word).take_while(|word| !ends.contains(word));
        names.extend(pattern.filter(|word| is_word(word)));
    }
    names
}

#[cfg(test)]
mod tests {
    use super::{Sources, on_cycles};

    /// Edges on cycles of files with these texts, as `user used`.
    fn cycles(files: &[(&str, &str)]) -> Vec<String> {
        let owned = |(path, text): &(&str, &str)| (format!("src/{path}.rs"), (*text).to_owned());
        let files: Vec<(String, String)> = files.iter().map(owned).collect();
        let edges = Sources::new(&files).edges();
        let all: Vec<_> = edges.keys().collect();
        on_cycles(&all).into_iter().map(|(user, used)| format!("{user} {used}")).collect()
    }

    const FACE: &str = "mod one; mod two; pub use one::One; use {one::*, two::*};";

    #[test]
    fn cycles_through_globs_and_re_exports_are_found() {
        let both = ["m/one m/two", "m/two m/one"];
        for (one, two) in [
            ("use super::*; pub struct One(Two);", "use super::*; pub struct Two(Box<One>);"),
            ("use super::two::two; pub fn one() { two() }", "pub fn two() { super::one::one() }"),
            ("use super::*; pub fn one() { two() }", "use super::*; pub fn two() { one() }"),
            (
                "use super::*; pub struct One; const N: u8 = END;",
                "use crate::m::One; const END: u8 = 0;",
            ),
        ] {
            let found = cycles(&[("m/mod", FACE), ("m/one", one), ("m/two", two)]);
            assert_eq!(found, both, "law: a cycle is found in\n{one}\n{two}");
        }
    }

    #[test]
    fn names_of_a_file_s_own_variants_and_tests_are_no_uses() {
        let one = "use super::*; pub struct One; pub fn fill() {}";
        let user = "use super::*; pub struct Two(One);";
        for own in [
            "enum Kind { Two, Other { one: u8 } }",
            "fn f(two: u8) { two(two) }",
            "struct Two; struct S { one: Two }",
            "#[cfg(test)] mod tests { use super::super::two::Two; fn f() -> Two { Two } }",
            "fn f() { self.two(); Kind::Two }",
            "trait Kind { type Two; }",
        ] {
            let text = format!("{one} {own}");
            let found = cycles(&[("m/mod", FACE), ("m/one", &text), ("m/two", user)]);
            assert_eq!(found, [""; 0], "law: no use of `two` in `{own}`");
        }
    }

    #[test]
    fn the_files_of_a_folder_beside_a_file_are_parts_of_it() {
        let files = [
            ("m/mod", "mod one;"),
            ("m/one", "mod part; pub use part::Part; pub struct One(Part);"),
            ("m/one/part", "use super::One; pub struct Part(Box<One>);"),
        ];
        assert_eq!(cycles(&files), [""; 0], "law: one unit");
    }
}
