//! `report.html`: one page that needs nothing else.

use maud::{DOCTYPE, Markup, PreEscaped, html};

use super::{Figure, Picture, ReportInput, scorecard, sections, shortfalls, uncertainty};
use crate::plain::{plain, plain_lines};

const CSS: &str = include_str!("report.css");

/// The head of every page: its title, and the style within.
pub(super) fn head(title: &str) -> Markup {
    html! {
        head {
            meta charset="utf-8";
            meta name="viewport" content="width=device-width, initial-scale=1";
            title { (plain(title)) }
            style { (PreEscaped(CSS)) }
        }
    }
}

/// The page: the paragraph, the scorecard and one figure; then everything else.
pub(super) fn page(input: &ReportInput, headline: &Figure, figures: &[Figure]) -> String {
    let title = if input.study.quick {
        "Gravel poured and vibrated: quick study"
    } else {
        "Gravel poured and vibrated: the paper's programme simulated"
    };
    html! {
        (DOCTYPE)
        html lang="en" {
            (head(title))
            body {
                header {
                    h1 { (title) }
                    p.soft {
                        "Compared with Izadi & Bezuijen (2014), “Simulation of granular soil "
                        "behaviour using the Bullet physics library”. Its figures were not available to "
                        "us (only its text was)."
                    }
                    p.lead { (glue(&input.scorecard.paragraph)) }
                }
                main {
                    section id="scorecard" {
                        h2 { "Scorecard" }
                        (scorecard::section(input.scorecard))
                        (figure_block(headline))
                        (contents(!input.pictures.is_empty()))
                    }
                    section id="figures" {
                        h2 { "Figures" }
                        @for figure in figures { (figure_block(figure)) }
                    }
                    @if !input.pictures.is_empty() {
                        section id="pictures" {
                            h2 { "Pictures" }
                            @for picture in input.pictures { (picture_block(picture)) }
                        }
                    }
                    section id="claims" {
                        h2 { "What the paper states, and what was found" }
                        (sections::claims(input.claims, input.beside))
                    }
                    section id="uncertainty" {
                        h2 { "How sure the numbers are" }
                        (uncertainty::section(&crate::paper::uncertainty(&input.study)))
                    }
                    section id="runs" {
                        h2 { "Runs" }
                        (sections::runs(&input.study))
                    }
                    section id="shortfalls" {
                        h2 { "What falls short" }
                        (list(&shortfalls::list(input)))
                    }
                    section id="choices" {
                        h2 { "Parameters the paper does not give" }
                        (sections::choices(input.choices))
                    }
                    section id="provenance" {
                        h2 { "Provenance" }
                        (sections::provenance(input))
                    }
                }
            }
        }
    }
    .into_string()
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

fn contents(pictures: bool) -> Markup {
    let mut entries = vec![
        ("scorecard", "Scorecard"),
        ("figures", "Figures"),
        ("claims", "Every statement"),
        ("uncertainty", "How sure"),
        ("runs", "Runs"),
        ("shortfalls", "What falls short"),
        ("choices", "Our choices"),
        ("provenance", "Provenance"),
    ];
    if pictures {
        entries.insert(2, ("pictures", "Pictures"));
    }
    html! {
        nav aria-label="Contents" {
            ul { @for (id, name) in entries { li { a href={ "#" (id) } { (name) } } } }
        }
    }
}

fn list(items: &[String]) -> Markup {
    html! { ul { @for item in items { li { bdi { (glue(item)) } } } } }
}

fn picture_block(picture: &Picture) -> Markup {
    html! {
        figure id=(picture.stem) {
            h3 { bdi { (plain(&picture.title)) } }
            div.sheet { img src=(picture.as_data()) alt=(plain(&picture.title)); }
            figcaption {
                (glue(&picture.caption)) " "
                span.soft.files { a href={ "figures/" (picture.stem) ".png" } { "PNG" } }
            }
        }
    }
}

pub(super) fn figure_block(figure: &Figure) -> Markup {
    let file = |extension: &str| format!("figures/{}.{extension}", figure.stem);
    html! {
        figure id=(figure.stem) {
            h3 { bdi { (plain(&figure.title)) } }
            div.sheet role="img" aria-label=(plain(&figure.title)) { (PreEscaped(figure.svg.as_str())) }
            figcaption {
                (glue(&figure.caption)) " "
                span.soft.files {
                    a href=(file("svg")) { "SVG" } " · "
                    a href=(file("png")) { "PNG" } " · "
                    a href=(file("csv")) { "numbers (CSV)" }
                }
            }
        }
    }
}
