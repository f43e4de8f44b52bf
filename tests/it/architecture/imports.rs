//! Which modules of the crate a file uses, from its tokens.

use super::tokens::Token;

/// A use of a module that stands directly below the crate's root.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Import {
    /// `world` for `crate::world::bullet::info`; `*` for everything.
    pub module: String,
    /// Counted from 1.
    pub line: usize,
}

/// The module that a file is: `src/world/run_time_check.rs` is `world`, `run_time_check`;
/// `src/lib.rs` is the root, which has no name.
pub fn module_path(path: &str) -> Vec<String> {
    let inside = path.trim_start_matches("src/").trim_end_matches(".rs");
    let inside = inside.trim_end_matches("/mod");
    if inside == "lib" {
        return Vec::new();
    }
    inside.split('/').map(str::to_owned).collect()
}

/// Every path that starts at `crate`, `pluvia`, `self` or `super`, in `use`
/// trees as well as in expressions, reduced to the module below the root.
pub fn imports(file: &[String], tokens: &[Token]) -> Vec<Import> {
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let mut here = file.to_vec();
    // Depth of braces at which each inline module began.
    let mut inline: Vec<usize> = Vec::new();
    let mut depth = 0;
    let mut found = Vec::new();
    for i in 0..tokens.len() {
        match text(i) {
            "{" => {
                depth += 1;
                if i >= 2 && text(i - 2) == "mod" {
                    here.push(text(i - 1).to_owned());
                    inline.push(depth);
                }
            }
            "}" => {
                if inline.last() == Some(&depth) {
                    inline.pop();
                    here.pop();
                }
                depth = depth.saturating_sub(1);
            }
            head @ ("crate" | "pluvia" | "self" | "super") if text(i + 1) == "::" => {
                // Not the start of a path, unless it is written `::pluvia`.
                let continues = i > 0
                    && text(i - 1) == "::"
                    && (head != "pluvia" || i > 1 && is_word(text(i - 2)));
                if !continues {
                    found.extend(below_root(&here, tokens, i));
                }
            }
            _ => {}
        }
    }
    found
}

fn is_word(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphanumeric() || c == '_') && text != "use"
}

/// What the path that starts at `start` names directly below the root.
fn below_root(here: &[String], tokens: &[Token], start: usize) -> Vec<Import> {
    let text = |i: usize| tokens.get(i).map_or("", |t| t.text.as_str());
    let import =
        |module: &str, i: usize| Import { module: module.to_owned(), line: tokens[i].line };
    let mut base = match text(start) {
        "crate" | "pluvia" => Vec::new(),
        "self" => here.to_vec(),
        _ => parent(here),
    };
    let mut at = start + 2;
    while text(at) == "super" && text(at + 1) == "::" {
        base = parent(&base);
        at += 2;
    }
    if let Some(module) = base.first() {
        return vec![import(module, start)];
    }
    if text(at) != "{" {
        return vec![import(text(at), at.min(tokens.len() - 1))];
    }
    // A group: the first word of each of its items.
    let mut found = Vec::new();
    let mut depth = 0;
    let mut item_begins = false;
    for i in at..tokens.len() {
        match text(i) {
            "{" => {
                depth += 1;
                item_begins = depth == 1;
            }
            "}" if depth == 1 => break,
            "}" => depth -= 1,
            "," => item_begins = depth == 1,
            module if item_begins => {
                found.push(import(module, i));
                item_begins = false;
            }
            _ => {}
        }
    }
    found
}

fn parent(module: &[String]) -> Vec<String> {
    module[..module.len().saturating_sub(1)].to_vec()
}

#[cfg(test)]
mod tests {
    use super::super::tokens::tokens;
    use super::{imports, module_path};

    fn found(path: &str, code: &str) -> Vec<String> {
        imports(&module_path(path), &tokens(code)).into_iter().map(|i| i.module).collect()
    }

    #[test]
    fn files_are_modules() {
        assert!(module_path("src/lib.rs").is_empty(), "lib.rs is the root");
        assert_eq!(module_path("src/main.rs"), ["main"]);
        assert_eq!(module_path("src/specimen.rs"), ["specimen"]);
        assert_eq!(module_path("src/world/mod.rs"), ["world"]);
        assert_eq!(module_path("src/world/bullet/ffi.rs"), ["world", "bullet", "ffi"]);
    }

    #[test]
    fn nested_groups_give_the_first_word_of_each_item() {
        let code = "use crate::{a::{b, c::{d, e}}, f, g::*, h as i,};";
        assert_eq!(found("src/world/mod.rs", code), ["a", "f", "g", "h"]);
    }

    #[test]
    fn paths_are_followed_from_where_they_stand() {
        let code = "use super::a; mod tests { use super::b; use super::super::c; } use super::d;";
        assert_eq!(found("src/world/mod.rs", code), ["a", "world", "c", "d"]);
        assert_eq!(found("src/world/run_time_check.rs", code), ["world"; 4]);
        assert_eq!(
            found("src/main.rs", "use ::pluvia::a; pluvia::b(); x::pluvia::c()"),
            ["a", "b"]
        );
        assert_eq!(found("src/world/mod.rs", "pub(crate) fn f(&self) { self.g(); Self::h() }"), {
            [""; 0]
        });
    }

    #[test]
    fn lines_are_those_of_the_names() {
        let found = imports(&module_path("src/lib.rs"), &tokens("use crate::{\n  a,\n  b,\n};"));
        let lines: Vec<usize> = found.iter().map(|i| i.line).collect();
        assert_eq!(lines, [2, 3], "expected a on line 2 and b on line 3");
    }
}
