//! A table of texts, as Markdown and as HTML.

use std::fmt::Write;

use maud::{Markup, html};

use super::html::glue;
use crate::plain::plain;

/// A table with its header; all cells as text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(super) struct TextTable {
    /// Names of the columns.
    pub header: Vec<String>,
    /// Rows, each with as many cells.
    pub rows: Vec<Vec<String>>,
}

impl TextTable {
    /// As Markdown; bars within cells are kept from dividing them.
    pub(super) fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cells: Vec<String> =
                cells.iter().map(|c| in_markdown(c).replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let mut text = line(&self.header);
        // Writing to a string does not fail.
        let _ = writeln!(text, "|{}", " --- |".repeat(self.header.len()));
        text.extend(self.rows.iter().map(|row| line(row)));
        text
    }

    /// As HTML, its cells of a class of the page's style where one is given.
    pub(super) fn html(&self, class: Option<&str>, heading: impl Fn(&str) -> String) -> Markup {
        html! {
            div.scroll { table {
                thead { tr { @for name in &self.header { th class=[class] { bdi { (glue(&heading(name))) } } } } }
                tbody {
                    @for row in &self.rows {
                        tr { @for cell in row { td class=[class] { bdi { (glue(cell)) } } } }
                    }
                }
            } }
        }
    }
}

/// A text for Markdown: characters that mislead by their code points, and no tag of HTML, which
/// those who show Markdown would obey.
pub(super) fn in_markdown(text: &str) -> String {
    let text = plain(text);
    let mut shown = String::with_capacity(text.len());
    let mut rest = text.chars().peekable();
    while let Some(c) = rest.next() {
        let begins_tag = |next: &char| next.is_ascii_alphabetic() || "/!?".contains(*next);
        if c == '<' && rest.peek().is_some_and(begins_tag) {
            shown += "&lt;";
        } else {
            shown.push(c);
        }
    }
    shown
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_has_no_tags_of_names() {
        let name = "<img src=x onerror=alert(1)>\u{202e}a</b> p < 0.001";
        let expected = "&lt;img src=x onerror=alert(1)>\\u202ea&lt;/b> p < 0.001";
        assert_eq!(in_markdown(name), expected, "law: a tag is text, a comparison stays");
    }

    #[test]
    fn a_table_has_every_cell_once_in_both_forms() {
        let texts = |of: [&str; 2]| of.map(str::to_owned).to_vec();
        let table = TextTable { header: texts(["a", "b"]), rows: vec![texts(["1", "x|y"])] };
        assert_eq!(table.markdown(), "| a | b |\n| --- | --- |\n| 1 | x\\|y |\n");
        let html = table.html(Some("n"), str::to_uppercase).into_string();
        for piece in [
            "<th class=\"n\"><bdi>A</bdi></th>",
            "<td class=\"n\"><bdi>1</bdi></td>",
            "x|y</bdi></td>",
        ] {
            assert!(html.contains(piece), "law: {piece} is in {html}");
        }
        let plain = table.html(None, str::to_owned).into_string();
        assert!(
            plain.contains("<th><bdi>a</bdi></th>"),
            "law: no class where none is given: {plain}"
        );
    }
}
