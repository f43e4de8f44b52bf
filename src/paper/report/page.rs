//! `report.html`: one page that needs nothing else.

use super::*;
use crate::report::html::picture_block;

/// The page: what is reproduced and why not, the scorecard and one figure; then everything else.
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
    let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
    let mut head = vec![Block::Soft(source.to_owned())];
    if !input.changes.is_empty() {
        head.push(Block::Banner(format!(
            "This is not the default programme. Changed in all of its scenarios: {}.",
            input.changes.join("; ")
        )));
    }
    head.extend(lines(&input.scorecard.paragraph).into_iter().map(Block::Lead));
    head.extend(lines(&input.scorecard.reasons).into_iter().map(Block::Text));
    let numbered = "A figure with a number shows what the paper's figure of that number shows, drawn from \
                    these runs; so do the pictures.";
    let numbered = (!figures.is_empty()).then(|| Block::Soft(numbered.to_owned()));
    let figures = figures.into_iter().map(Block::Figure);
    let said = "What the paper states, and what was found";
    Page::new(title, head)
        .section("scorecard", "Scorecard", scorecard)
        .section("figures", "Figures", numbered.into_iter().chain(figures))
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
