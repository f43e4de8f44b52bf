//! One description of a table, a column a line; from it CSV for programs, Markdown and HTML for
//! readers.

use std::{fmt::Write as _, path::Path};

use maud::{Markup, PreEscaped, Render, html};

use super::{
    html::glue,
    text::{compact, number},
};
use crate::{
    measure::Estimate,
    plain::plain,
    record::{FileError, NO_VALID_RUN, write_csv},
};

/// A cell: its text, and what a page shows in its place where it can show more than text.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Cell {
    pub text: String,
    on_page: Option<String>,
    is_number: bool,
}

impl Cell {
    /// A number in words, aligned as numbers are.
    pub(crate) fn number(text: impl Into<String>) -> Self {
        Self { text: text.into(), is_number: true, ..Self::default() }
    }

    /// With these decimals; a dash where there is no value.
    pub(crate) fn fixed(value: impl Into<Option<f64>>, decimals: usize) -> Self {
        Self::number(value.into().map_or_else(dash, |v| number(v, decimals)))
    }

    /// With the digits that count; a dash where there is none.
    pub(crate) fn compact(value: impl Into<Option<f64>>) -> Self {
        Self::number(value.into().map_or_else(dash, compact))
    }

    /// The same cell, shown as this on a page.
    pub(crate) fn on_page(self, shown: &Markup) -> Self {
        Self { on_page: Some(shown.0.clone()), ..self }
    }

    /// A verdict in words, which a page shows as a badge of a class of the style sheet.
    pub(crate) fn badge(class: &str, text: impl Into<String>) -> Self {
        let text = text.into();
        let shown = html! { span.verdict.(class) { (text) } };
        Self { text, ..Self::default() }.on_page(&shown)
    }
}

/// What stands where there is no value.
pub(crate) fn dash() -> String {
    "–".to_owned()
}

/// The same, or that no run is valid, where that is why.
pub(crate) fn missing(no_run_is_valid: bool) -> String {
    if no_run_is_valid { NO_VALID_RUN.to_owned() } else { dash() }
}

/// A mean and, where it is known, how far it may be off.
fn plus_minus(mean: f64, off: Option<f64>, shown: impl Fn(f64) -> String) -> String {
    match off {
        Some(off) => format!("{} ± {}", shown(mean), shown(off)),
        None => shown(mean),
    }
}

/// A mean and half of its confidence interval, to the second digit of the latter: more would be no
/// finding.
pub(crate) fn mean_within(mean: f64, half: Option<f64>) -> String {
    match decimals_within(half) {
        Some(decimals) => plus_minus(mean, half, |v| number(v, decimals)),
        None => plus_minus(mean, half, compact),
    }
}

/// A value that scatters with a standard deviation, to the second digit of that.
pub(crate) fn scattered(value: f64, deviation: f64) -> String {
    match decimals_within(Some(deviation)) {
        Some(decimals) => number(value, decimals),
        None => compact(value),
    }
}

/// Decimals to the second digit of how far something may be off; none where that is not known, or
/// too little to be shown.
fn decimals_within(off: Option<f64>) -> Option<usize> {
    let decimals = 1.0 - off.filter(|off| *off > 0.0)?.log10().floor();
    (decimals <= 8.0).then(|| decimals.max(0.0) as usize)
}

/// From one value to another.
pub(crate) fn from_to(low: f64, high: f64) -> String {
    format!("{} to {}", compact(low), compact(high))
}

/// How many of something there are besides; nothing where there are none.
pub(crate) fn besides(count: usize, what: &str) -> String {
    if count > 0 { format!(", {count} {what}") } else { String::new() }
}

impl Render for Cell {
    fn render(&self) -> Markup {
        match &self.on_page {
            Some(shown) => PreEscaped(shown.clone()),
            None => html! { bdi { (glue(&self.text)) } },
        }
    }
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self { text, ..Self::default() }
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        text.to_owned().into()
    }
}

impl From<&String> for Cell {
    fn from(text: &String) -> Self {
        text.clone().into()
    }
}

impl From<bool> for Cell {
    fn from(answer: bool) -> Self {
        answer.to_string().into()
    }
}

/// Every digit, for programs; nothing where it is no finite number.
impl From<f64> for Cell {
    fn from(value: f64) -> Self {
        Self::number(if value.is_finite() { value.to_string() } else { String::new() })
    }
}

impl From<usize> for Cell {
    fn from(count: usize) -> Self {
        Self::number(count.to_string())
    }
}

impl From<u32> for Cell {
    fn from(count: u32) -> Self {
        Self::number(count.to_string())
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(value: Option<T>) -> Self {
        value.map_or_else(Self::default, Into::into)
    }
}

/// The cells of one row.
macro_rules! row {
    ($($cell:expr),* $(,)?) => { vec![$($crate::report::table::Cell::from($cell)),*] };
}

/// The table of some items: of each column its name, and what stands in it of an item.
macro_rules! table {
    ($items:expr, |$item:pat_param| { $($name:expr => $cell:expr),* $(,)? }) => {{
        let mut table = $crate::report::table::Table::new([$(String::from($name)),*]);
        for $item in $items {
            table.row($crate::report::table::row![$($cell),*]);
        }
        table
    }};
}

pub(crate) use {row, table};

/// The texts of one row of a file, each with the name of its column.
#[derive(Debug, Default)]
pub(crate) struct Record(pub Vec<(String, String)>);

impl Record {
    pub(crate) fn add(&mut self, name: impl Into<String>, cell: impl Into<Cell>) {
        self.0.push((name.into(), cell.into().text));
    }

    /// Adds a mean and its standard error.
    pub(crate) fn add_estimate(&mut self, name: &str, of: Option<Estimate>) {
        self.add(name, of.map(|e| e.mean));
        self.add(format!("{name}_standard_error"), of.and_then(|e| e.standard_error));
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
enum Row {
    Cells(Vec<Cell>),
    /// What the rows below it have in common.
    Part(String),
}

#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub(crate) struct Table {
    header: Vec<Cell>,
    rows: Vec<Row>,
    class: &'static str,
}

impl Table {
    pub(crate) fn new<T: Into<Cell>>(header: impl IntoIterator<Item = T>) -> Self {
        Self { header: header.into_iter().map(Into::into).collect(), ..Self::default() }
    }

    /// Names and values, without a header.
    pub(crate) fn of_pairs(pairs: impl IntoIterator<Item = (String, String)>) -> Self {
        table!(pairs, |(name, value)| { "" => name, "" => value })
    }

    /// Its classes in the style sheet; of class `cards` it is shown as a card a row where a
    /// page is narrow.
    pub(crate) fn class(self, class: &'static str) -> Self {
        Self { class, ..self }
    }

    pub(crate) fn row(&mut self, cells: Vec<Cell>) {
        self.rows.push(Row::Cells(cells));
    }

    /// A line above rows that belong together.
    pub(crate) fn part(&mut self, title: &str) {
        self.rows.push(Row::Part(title.to_owned()));
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// As CSV, where every row has as many cells as the header.
    pub(crate) fn csv(&self) -> Result<Vec<u8>, csv::Error> {
        let mut writer = csv::Writer::from_writer(Vec::new());
        writer.write_record(self.header.iter().map(|cell| &cell.text))?;
        for row in &self.rows {
            if let Row::Cells(cells) = row {
                writer.write_record(cells.iter().map(|cell| &cell.text))?;
            }
        }
        writer.into_inner().map_err(|e| e.into_error().into())
    }

    /// Writes a CSV file.
    pub(crate) fn write(&self, path: &Path) -> Result<(), FileError> {
        write_csv(path, self.csv())
    }

    /// Whether a column holds numbers: whether its first cell does.
    fn is_number(&self, column: usize) -> bool {
        let first = self.rows.iter().find_map(|row| match row {
            Row::Cells(cells) => cells.get(column),
            Row::Part(_) => None,
        });
        first.is_some_and(|cell| cell.is_number)
    }

    pub(crate) fn markdown(&self) -> String {
        let line = |cells: &[Cell]| {
            let cells: Vec<String> =
                cells.iter().map(|c| in_markdown(&c.text).replace('|', "\\|")).collect();
            format!("| {} |\n", cells.join(" | "))
        };
        let rule = |n| if self.is_number(n) { " ---: |" } else { " --- |" };
        let mut text = line(&self.header);
        // Writing to a string does not fail.
        let _ = writeln!(text, "|{}", (0..self.header.len()).map(rule).collect::<String>());
        for row in &self.rows {
            text += &match row {
                Row::Cells(cells) => line(cells),
                Row::Part(title) => {
                    let mut cells = vec![Cell::default(); self.header.len()];
                    cells[0] = format!("**{title}**").into();
                    line(&cells)
                }
            };
        }
        text
    }

    /// As a part of a page.
    pub(crate) fn html(&self) -> Markup {
        let is_cards = self.class.contains("cards");
        let class = |cell: &Cell| cell.is_number.then_some("n");
        let has_header = self.header.iter().any(|cell| !cell.text.is_empty());
        html! {
            div.scroll[!is_cards] { table class=[(!self.class.is_empty()).then_some(self.class)] {
                @if has_header {
                    thead { tr { @for (n, cell) in self.header.iter().enumerate() {
                        @let is_right = self.is_number(n) && (n > 0 || is_cards);
                        th class=[is_right.then_some("n")] { (cell) }
                    } } }
                }
                tbody { @for row in &self.rows { @match row {
                    Row::Part(title) => tr.part {
                        th scope="rowgroup" colspan=(self.header.len()) { (title) }
                    },
                    Row::Cells(cells) => tr { @for (n, cell) in cells.iter().enumerate() {
                        @if n == 0 && !is_cards {
                            th scope="row" { (cell) }
                        } @else {
                            td class=[class(cell)] data-label=[self.label(n)] { (cell) }
                        }
                    } },
                } } }
            } }
        }
    }

    /// What names a cell on a card, which has no header above it.
    fn label(&self, column: usize) -> Option<String> {
        let name = &self.header.get(column)?.text;
        let is_named = self.class.contains("cards") && column > 0 && !name.is_empty();
        is_named.then(|| plain(name).into_owned())
    }
}

/// A text in Markdown: characters that mislead by their code points, and nothing
/// that begins like a tag, so that a name cannot bring one in.
pub(crate) fn in_markdown(text: &str) -> String {
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
    fn a_mean_has_the_digits_that_its_interval_leaves() {
        for (mean, half, expected) in [
            (23.66, Some(8.104), "23.7 ± 8.1"),
            (0.82, Some(0.4298), "0.82 ± 0.43"),
            (2.171, Some(27.89), "2 ± 28"),
            (1234.6, Some(321.0), "1235 ± 321"),
            (166.0, None, "166"),
            (3.0, Some(0.0), "3 ± 0"),
            (3.0, Some(1e-9), "3 ± 1.00e\u{2212}9"),
            (3.0, Some(f64::NAN), "3 ± –"),
        ] {
            assert_eq!(mean_within(mean, half), expected, "law: {mean} within {half:?}");
        }
    }

    #[test]
    fn a_table_has_every_cell_once_in_every_form() {
        let mut table = table!([(1.5, "x|y"), (f64::NAN, "<b>")], |(number, text)| {
            "a" => number,
            "b" => text,
        });
        assert_eq!(table.csv().expect("CSV"), b"a,b\n1.5,x|y\n,<b>\n");
        table.part("more");
        table.row(row![Cell::fixed(2.0, 2), Cell::badge("within", "met")]);
        assert_eq!(
            table.markdown(),
            "| a | b |\n| ---: | --- |\n| 1.5 | x\\|y |\n|  | &lt;b> |\n| **more** |  |\n\
             | 2.00 | met |\n"
        );
        let html = table.html().into_string();
        for piece in [
            "<div class=\"scroll\">",
            "<th><bdi>a</bdi></th><th><bdi>b</bdi></th>",
            "<th scope=\"row\"><bdi>1.5</bdi></th><td><bdi>x|y</bdi></td>",
            "<bdi>&lt;b&gt;</bdi>",
            "colspan=\"2\">more</th>",
            "<span class=\"verdict within\">met</span>",
        ] {
            assert!(html.contains(piece), "law: {piece} is in {html}");
        }
        let cards = table.class("cards").html().into_string();
        assert!(cards.contains("<td data-label=\"b\">") && !cards.contains("scroll"), "{cards}");
    }
}
