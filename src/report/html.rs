//! `report.html`: one page that needs nothing else.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{
    Figure, Picture, ReportInput,
    page::{Block, Page},
    sections, shortfalls, uncertainty,
};
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

/// The page: the paragraph, the scorecard and one figure; then everything else.
pub(super) fn page(input: &ReportInput, headline: Figure, figures: Vec<Figure>) -> Page {
    let title = if input.study.quick {
        "Gravel poured and vibrated: quick study"
    } else {
        "Gravel poured and vibrated: the paper's programme simulated"
    };
    let source = "Compared with Izadi & Bezuijen (2014), “Simulation of granular soil behaviour using \
                  the Bullet physics library”. Its figures were not available to us (only its text \
                  was).";
    let mut scorecard = sections::scorecard(input.scorecard);
    scorecard.push(Block::Figure(headline));
    let pictures = input.pictures.iter().map(|picture| Block::Html(picture_block(picture)));
    let head = [Block::Soft(source.to_owned()), Block::Lead(input.scorecard.paragraph.clone())];
    let said = "What the paper states, and what was found";
    Page::new(title, head)
        .section("scorecard", "Scorecard", scorecard)
        .figures("figures", "Figures", figures)
        .section("pictures", "Pictures", pictures)
        .section("claims", said, sections::claims(input.claims, input.beside))
        .section(
            "uncertainty",
            "How sure the numbers are",
            uncertainty::section(&crate::paper::uncertainty(&input.study)),
        )
        .section("runs", "Runs", sections::runs(&input.study))
        .section("shortfalls", "What falls short", [Block::List(shortfalls::list(input))])
        .section(
            "choices",
            "Parameters the paper does not give",
            [sections::choices(input.choices)],
        )
        .section("provenance", "Provenance", sections::provenance(input))
        .with_contents()
}

/// A name that somebody gave, isolated: whatever direction its letters have, the text around it
/// keeps its own.
pub(super) fn name(name: &str) -> Markup {
    html! { bdi { (plain(name)) } }
}

/// Keeps numbers and their units on one line, and shows characters that would turn the text's
/// direction by their code points.
pub(super) fn glue(text: &str) -> String {
    let text = &*plain_lines(text);
    const UNITS: [&str; 6] = [" %", " mm", " cm", " s ", " g ", " µm"];
    UNITS.iter().fold(text.to_owned(), |text, unit| {
        text.replace(unit, &format!("\u{a0}{}", unit.trim_start()))
    })
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

fn picture_block(picture: &Picture) -> Markup {
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
