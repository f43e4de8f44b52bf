//! Marks in pages: numbers between `<!--r KEY-->` and `<!--/r-->`, tables between
//! `<!-- results: NAME -->` and `<!-- /results -->`. What is between them is the generator's.

use super::{tables, value::Results};

const BEGIN: &str = "<!--r ";
const END: &str = "<!--/r-->";
const TABLE: &str = "<!-- results: ";
const TABLE_END: &str = "<!-- /results -->";

/// A mark whose text is not what its results give, or that cannot be filled.
#[derive(Debug, PartialEq, Eq)]
pub struct Fault {
    /// Line of the page, from 1.
    pub line: usize,
    /// The key, or the name of the table.
    pub key: String,
    /// What its results give, or why they give nothing.
    pub expected: Result<String, String>,
    /// What the page says.
    pub got: String,
}

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { line, key, expected, got } = self;
        match expected {
            Ok(expected) => write!(f, "{line}: `{key}`: expected `{expected}`, got `{got}`"),
            Err(why) => write!(f, "{line}: `{key}`: {why}"),
        }
    }
}

/// The page with every mark filled, and what was not so before.
pub fn filled(page: &str, results: &Results) -> (String, Vec<Fault>) {
    let (mut out, mut faults) = (String::new(), Vec::new());
    let mut rest = page;
    while let Some((at, mark)) = next(rest) {
        let line = page[..page.len() - rest.len() + at].matches('\n').count() + 1;
        let (begin, end, closing) = match mark {
            Mark::Number => (BEGIN, END, "-->"),
            Mark::Table => (TABLE, TABLE_END, " -->\n"),
        };
        let after = &rest[at + begin.len()..];
        let parts = after.split_once(closing).and_then(|(key, after)| {
            let (got, after) = after.split_once(end)?;
            Some((key, got, after))
        });
        let Some((key, got, after)) = parts else {
            let got = after.chars().take(60).collect();
            let expected = Err(format!("the mark is not ended by `{end}`"));
            faults.push(Fault { line, key: begin.trim().to_owned(), expected, got });
            break;
        };
        let before = page[..page.len() - rest.len() + at].rsplit('\n').next().unwrap_or_default();
        let expected = match mark {
            // Markdown takes such a line for HTML, which ends the paragraph.
            Mark::Number if before.trim().is_empty() => {
                Err("a mark must not begin a line".to_owned())
            }
            Mark::Number => results.quote(key),
            Mark::Table => tables::named(key, results),
        };
        out += &rest[..at];
        out += begin;
        out += key;
        out += closing;
        out += expected.as_deref().unwrap_or(got);
        out += end;
        if expected.as_deref() != Ok(got) {
            let (expected, got) = match (mark, expected) {
                (Mark::Table, Ok(expected)) => first_difference(&expected, got),
                (_, expected) => (expected, got.to_owned()),
            };
            faults.push(Fault { line, key: key.to_owned(), expected, got });
        }
        rest = after;
    }
    (out + rest, faults)
}

/// The page without what marks hold, with as many lines.
pub fn without(page: &str) -> String {
    let (mut out, mut rest) = (String::new(), page);
    while let Some((at, mark)) = next(rest) {
        let end = if mark == Mark::Number { END } else { TABLE_END };
        out += &rest[..at];
        let Some((held, after)) = rest[at..].split_once(end) else { return out + &rest[at..] };
        out.extend(held.chars().filter(|c| *c == '\n'));
        rest = after;
    }
    out + rest
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Mark {
    Number,
    Table,
}

fn next(text: &str) -> Option<(usize, Mark)> {
    let found = [(text.find(BEGIN), Mark::Number), (text.find(TABLE), Mark::Table)];
    found.into_iter().filter_map(|(at, mark)| Some((at?, mark))).min_by_key(|(at, _)| *at)
}

fn first_difference(expected: &str, got: &str) -> (Result<String, String>, String) {
    let line = |text: &str, n| text.lines().nth(n).unwrap_or("(nothing)").to_owned();
    let lines = expected.lines().count().max(got.lines().count());
    let n = (0..lines).find(|n| line(expected, *n) != line(got, *n)).unwrap_or(0);
    (Ok(line(expected, n)), line(got, n))
}
