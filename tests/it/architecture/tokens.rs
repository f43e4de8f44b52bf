//! Rust source as a plain list of tokens, without comments and literals.
//!
//! Enough to follow paths and `use` trees in macros too, which a parser of
//! whole files would skip.

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
    let mut scanner = Scanner { chars: source.chars().collect(), at: 0, line: 1 };
    let mut found = Vec::new();
    while let Some(token) = scanner.next_token() {
        found.push(token);
    }
    found
}

struct Scanner {
    chars: Vec<char>,
    at: usize,
    line: usize,
}

impl Scanner {
    fn peek(&self, ahead: usize) -> Option<char> {
        self.chars.get(self.at + ahead).copied()
    }

    fn advance(&mut self, count: usize) {
        for _ in 0..count {
            if self.peek(0) == Some('\n') {
                self.line += 1;
            }
            self.at += 1;
        }
    }

    /// Skips to just after the first place where `end` follows.
    fn skip_past(&mut self, end: &str) {
        let end: Vec<char> = end.chars().collect();
        while self.at < self.chars.len() && !self.chars[self.at..].starts_with(&end) {
            self.advance(1);
        }
        self.advance(end.len());
    }

    fn next_token(&mut self) -> Option<Token> {
        loop {
            let c = self.peek(0)?;
            match (c, self.peek(1)) {
                ('/', Some('/')) => self.skip_past("\n"),
                ('/', Some('*')) => self.skip_block_comment(),
                ('"', _) => self.skip_string(),
                ('\'', _) => self.skip_character_or_lifetime(),
                (':', Some(':')) => return Some(self.take(2)),
                _ if c.is_whitespace() => self.advance(1),
                _ if c.is_ascii_digit() => self.skip_number(),
                _ if c.is_alphabetic() || c == '_' => {
                    if !self.skip_prefixed_string() {
                        return Some(self.take_word());
                    }
                }
                _ => return Some(self.take(1)),
            }
        }
    }

    fn take(&mut self, length: usize) -> Token {
        let text = self.chars[self.at..self.at + length].iter().collect();
        let token = Token { text, line: self.line };
        self.advance(length);
        token
    }

    fn take_word(&mut self) -> Token {
        let length =
            self.chars[self.at..].iter().take_while(|c| c.is_alphanumeric() || **c == '_').count();
        self.take(length)
    }

    /// Block comments nest in Rust.
    fn skip_block_comment(&mut self) {
        let mut depth = 0;
        while let Some(c) = self.peek(0) {
            match (c, self.peek(1)) {
                ('/', Some('*')) => {
                    depth += 1;
                    self.advance(2);
                }
                ('*', Some('/')) => {
                    depth -= 1;
                    self.advance(2);
                    if depth == 0 {
                        return;
                    }
                }
                _ => self.advance(1),
            }
        }
    }

    fn skip_string(&mut self) {
        self.advance(1);
        while let Some(c) = self.peek(0) {
            match c {
                '\\' => self.advance(2),
                '"' => return self.advance(1),
                _ => self.advance(1),
            }
        }
    }

    /// Skips `b"..."`, `r#"..."#` and the like; tells whether there was one.
    /// A raw identifier (`r#type`) is left to be taken as `r`, `#`, `type`.
    fn skip_prefixed_string(&mut self) -> bool {
        let prefix: String =
            self.chars[self.at..].iter().take_while(|c| c.is_ascii_alphabetic()).collect();
        if !["b", "c", "r", "br", "cr"].contains(&prefix.as_str()) {
            return false;
        }
        let start = self.at + prefix.len();
        let hashes = self.chars[start..].iter().take_while(|c| **c == '#').count();
        let opens = self.chars.get(start + hashes) == Some(&'"');
        if prefix.ends_with('r') && opens {
            self.advance(prefix.len() + hashes + 1);
            self.skip_past(&format!("\"{}", "#".repeat(hashes)));
            return true;
        }
        if hashes == 0 && opens {
            self.advance(prefix.len());
            self.skip_string();
            return true;
        }
        false
    }

    fn skip_character_or_lifetime(&mut self) {
        match (self.peek(1), self.peek(2)) {
            (Some('\\'), _) => {
                self.advance(3);
                self.skip_past("'");
            }
            (_, Some('\'')) => self.advance(3),
            _ => {
                self.advance(1);
                let word = self.take_word();
                debug_assert!(!word.text.is_empty(), "a lifetime has a name");
            }
        }
    }

    /// Digits with suffixes and exponents, but neither the dots of a range nor
    /// a method call.
    fn skip_number(&mut self) {
        while let Some(c) = self.peek(0) {
            let fraction = c == '.' && self.peek(1).is_some_and(|d| d.is_ascii_digit());
            if !(c.is_alphanumeric() || c == '_' || fraction) {
                return;
            }
            self.advance(1);
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
            ["x", ".", ".", ".", "n", ".", "sqrt", "(", ")", "br", "r", "#", "type"]
        });
    }

    #[test]
    fn comments_and_literals_are_left_out() {
        let source = concat!(
            "a // unsafe\n /* unsafe /* nested */ unsafe */ b \"unsafe \\\" unsafe\" ",
            "c r#\"unsafe \" unsafe\"# d b\"unsafe\" 'u' '\\'' '\\u{75}' e b'u' &'life f"
        );
        let expected = ["a", "b", "c", "d", "e", "b", "&", "f"];
        assert_eq!(words(source), expected, "expected only the bare words of {source:?}");
    }

    #[test]
    fn lines_are_counted_through_comments_and_strings() {
        let found = tokens("a\n/* \n */ b \"\n\" c");
        let lines: Vec<usize> = found.iter().map(|t| t.line).collect();
        assert_eq!(lines, [1, 3, 4], "expected a, b, c on lines 1, 3, 4");
    }
}
