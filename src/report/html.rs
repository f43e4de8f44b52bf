//! What pages as HTML are made of: a document that needs nothing else, names, texts and drawings.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Figure, Picture};
use crate::plain::{plain, plain_lines};

const CSS: &str = include_str!("report.css");

/// A whole document: its title, the style within, and what it shows.
pub(super) fn document(title: &str, body: &Markup) -> String {
    html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { (plain(title)) }
                style { (PreEscaped(CSS)) }
            }
            body { (body) }
        }
    }
    .into_string()
}

/// A name that somebody gave, isolated: whatever direction its letters have, the text around it
/// keeps its own.
pub(crate) fn name(name: &str) -> Markup {
    html! { bdi { (plain(name)) } }
}

/// Keeps numbers and their units on one line, and shows characters that would turn the text's
/// direction by their code points.
pub(crate) fn glue(text: &str) -> String {
    const UNITS: [&str; 4] = [" %", " mm", " cm", " µm"];
    let glued = UNITS.iter().fold(plain_lines(text).into_owned(), |text, unit| {
        text.replace(unit, &format!("\u{a0}{}", unit.trim_start()))
    });
    after_numbers(&glued)
}

/// Keeps units that may be words of their own on the line of the number before them, at the end of
/// a sentence, too.
fn after_numbers(text: &str) -> String {
    const UNITS: [&str; 6] = ["s", "g", "m", "N", "kPa", "Hz"];
    let mut glued = String::with_capacity(text.len());
    let mut rest = text;
    while let Some((before, after)) = rest.split_once(' ') {
        let end = after.find(|c: char| !c.is_alphabetic()).unwrap_or(after.len());
        let is_unit = UNITS.contains(&&after[..end]);
        let follows_number = before.ends_with(|c: char| c.is_ascii_digit());
        glued += before;
        glued.push(if is_unit && follows_number { '\u{a0}' } else { ' ' });
        rest = after;
    }
    glued + rest
}

/// A drawing with its title, its caption and links to its files in `figures/`.
fn block(
    stem: &str,
    title: &str,
    caption: &str,
    drawing: &Markup,
    files: &[(&str, &str)],
) -> Markup {
    html! {
        figure id=(stem) {
            h3 { bdi { (plain(title)) } }
            (drawing)
            figcaption {
                (glue(caption)) " "
                span.soft.files {
                    @for (n, (extension, name)) in files.iter().enumerate() {
                        @if n > 0 { " · " }
                        a href={ "figures/" (stem) "." (extension) } { (name) }
                    }
                }
            }
        }
    }
}

/// A picture with its title and caption.
pub(crate) fn picture_block(picture: &Picture) -> Markup {
    let Picture { stem, title, caption, .. } = picture;
    let drawing = html! {
        div.sheet { img src=(picture.as_data()) alt=(plain(title)); }
    };
    block(stem, title, caption, &drawing, &[("png", "PNG")])
}

/// A figure with its title and caption.
pub(super) fn figure_block(figure: &Figure) -> Markup {
    let Figure { stem, title, caption, svg, .. } = figure;
    let drawing = html! {
        div.sheet role="img" aria-label=(plain(title)) { (PreEscaped(svg.as_str())) }
    };
    let files = [("svg", "SVG"), ("png", "PNG"), ("csv", "numbers (CSV)")];
    block(stem, title, caption, &drawing, &files)
}

#[cfg(test)]
mod tests {
    use super::{CSS, glue};

    /// The line of a rule in the part of the style sheet that begins with these words.
    fn rule(part: &str, selector: &str) -> &'static str {
        let within = CSS.split_once(part).map_or("", |(_, within)| within);
        within.lines().find(|line| line.trim_start().starts_with(selector)).unwrap_or_default()
    }

    /// Law: a name of a row that is longer than its column breaks; it does not cover the numbers
    /// beside it.
    #[test]
    fn long_names_of_rows_break_on_a_narrow_page() {
        let names = rule("@media (max-width: 46rem)", ".scroll tbody th");
        for expected in ["white-space: normal", "overflow-wrap: break-word", "max-width"] {
            assert!(names.contains(expected), "law: expected `{expected}`, got `{names}`");
        }
    }

    /// Law: in print all sizes follow one, heads of tables are no larger than their numbers, and
    /// names break, so that no table makes the browser shrink the page.
    #[test]
    fn print_has_one_scale_of_sizes() {
        let print = |selector| rule("@media print", selector);
        for (selector, expected) in [
            ("html {", "font-size: 10pt"),
            ("body {", "font-size: 1rem"),
            (".scroll table, .scroll th, .scroll .verdict {", "font-size: 7pt"),
            (".scroll th, .scroll td, .scroll tbody th {", "white-space: normal"),
        ] {
            let got = print(selector);
            assert!(got.contains(expected), "law: `{expected}` of `{selector}`, got `{got}`");
        }
    }

    /// Law: what stands in brackets below a number of a wide table is no larger than the number.
    #[test]
    fn brackets_are_no_larger_than_their_number() {
        let got = rule(".scroll table", ".scroll .soft");
        assert!(got.contains("font-size: inherit"), "law: the table's own size, got `{got}`");
    }

    /// Law: a number and its unit stand on one line, whatever follows the unit.
    #[test]
    fn units_stay_with_their_numbers() {
        for (text, expected) in [
            ("Periods of 0.67 s.", "Periods of 0.67\u{a0}s."),
            ("2343 g, or 0.3 m/s", "2343\u{a0}g, or 0.3\u{a0}m/s"),
            ("after 5 s, mm", "after 5\u{a0}s,\u{a0}mm"),
            ("95 % of 14 mm", "95\u{a0}% of 14\u{a0}mm"),
            ("200 kPa (12 Hz)", "200\u{a0}kPa (12\u{a0}Hz)"),
            ("4 settled; Student's t, in s", "4 settled; Student's t, in s"),
            ("3  grains", "3  grains"),
        ] {
            assert_eq!(glue(text), expected, "law: of `{text}` (got left)");
        }
    }
}
