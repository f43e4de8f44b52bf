//! Rust source as a plain list of tokens, without comments and literals.
//!
//! Enough to follow paths and `use` trees in macros too, which a parser of
//! whole files would skip.

use proc_macro2::{Spacing, TokenStream, TokenTree};

/// A word (identifier, keyword), `::`, or any other single character.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Token {
    pub text: String,
    /// Counted from 1.
    pub line: usize,
}

/// Splits Rust source into tokens; comments, strings, characters, numbers and
/// lifetimes are left out.
pub fn tokens(source: &str) -> Vec<Token> {
    let stream: TokenStream = source.parse().expect("it is Rust");
    let mut found = Vec::new();
    add(stream, &mut found);
    found
}

fn add(stream: TokenStream, found: &mut Vec<Token>) {
    let mut trees = stream.into_iter().peekable();
    while let Some(tree) = trees.next() {
        let line = tree.span().start().line;
        let mut token = |text: &str, line| found.push(Token { text: text.to_owned(), line });
        match tree {
            TokenTree::Group(group) => {
                let (open, close) = match group.delimiter() {
                    proc_macro2::Delimiter::Parenthesis => ("(", ")"),
                    proc_macro2::Delimiter::Brace => ("{", "}"),
                    proc_macro2::Delimiter::Bracket => ("[", "]"),
                    proc_macro2::Delimiter::None => ("", ""),
                };
                let (first, last) = (group.span_open().start().line, group.span_close().end().line);
                token(open, first);
                // Words of documentation are literals.
                add(group.stream(), found);
                found.push(Token { text: close.to_owned(), line: last });
            }
            TokenTree::Ident(word) => token(&word.to_string(), line),
            // A lifetime is its mark and its name.
            TokenTree::Punct(mark) if mark.as_char() == '\'' => drop(trees.next()),
            TokenTree::Punct(mark) => {
                let twice = mark.as_char() == ':' && mark.spacing() == Spacing::Joint;
                let follows =
                    |tree: &TokenTree| matches!(tree, TokenTree::Punct(p) if p.as_char() == ':');
                if twice && trees.peek().is_some_and(follows) {
                    trees.next();
                    token("::", line);
                } else {
                    token(&mark.as_char().to_string(), line);
                }
            }
            TokenTree::Literal(_) => {}
        }
    }
}

#[cfg(test)]
mod tests {
    use super::tokens;

    fn words(source: &str) -> Vec<String> {
        tokens(source).into_iter().map(|t| t.text).collect()
    }

    #[test]
    fn code_is_kept() {
        assert_eq!(words("use a::{b, c};"), ["use", "a", "::", "{", "b", ",", "c", "}", ";"]);
        assert_eq!(words("x.0..n 1.5e3_f64.sqrt() br r#type"), {
            ["x", ".", ".", ".", "n", ".", "sqrt", "(", ")", "br", "r#type"]
        });
    }

    #[test]
    fn comments_and_literals_are_left_out() {
        let source = concat!(
            "a // unsafe\n /* unsafe /* nested */ unsafe */ b \"unsafe \\\" unsafe\" ",
            "c r#\"unsafe \" unsafe\"# d b\"unsafe\" 'u' '\\'' '\\u{75}' e b'u' &'life f"
        );
        let expected = ["a", "b", "c", "d", "e", "&", "f"];
        assert_eq!(words(source), expected, "expected only the bare words of {source:?}");
    }

    #[test]
    fn lines_are_counted_through_comments_and_strings() {
        let found = tokens("a\n/* \n */ b \"\n\" c");
        let lines: Vec<usize> = found.iter().map(|t| t.line).collect();
        assert_eq!(lines, [1, 3, 4], "expected a, b, c on lines 1, 3, 4");
    }
}
