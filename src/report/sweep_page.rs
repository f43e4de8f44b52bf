//! The page of a sweep, as Markdown and as HTML.

use std::fmt::Write;

use maud::{DOCTYPE, html};

use super::{
    Figure, MAIN_OUTCOMES, OUTCOMES, Sweep, SweepEstimate, SweepPoint, SweepRun,
    html::{figure_block, glue, head},
    sweep::{in_words, shown},
    text_table::{TextTable, in_markdown},
};
use crate::paper::text::{compact, number};
use crate::plain::plain;
use crate::record::{NO_VALID_RUN, left_out_in_words};

/// A table of the page.
struct Section {
    id: &'static str,
    title: &'static str,
    table: TextTable,
}

/// What the page says, without its form.
pub(super) struct Page {
    title: String,
    lead: String,
    good: bool,
    tables: Vec<Section>,
    figures: Vec<(String, String, String)>,
}

const HOW_TO_READ: &str = "Every point is run in the same configurations, each the same grains mixed anew. \
     Intervals hold 95 % of what the mean over configurations may be, by Student's t; sweep.json has those of the bootstrap \
     as well. A change for one unit is the slope of a line through each configuration's own results, its mean and interval \
     over configurations; where values were drawn from ranges, it is the coefficient in a linear model of all of them. \
     The test by ranks (Page 1963) asks whether results rise or fall from value to value without asking for a line. \
     A run is valid if it meets the accuracy standard and no run-time check found anything. Means and effects leave out runs that \
     are not valid, and runs of which too many grains are missing (docs/accuracy.md); each point says how many. \
     Configurations needed: so many would show a slope of this size among this scatter with a probability of 80 %.";

/// Puts the page together.
pub(super) fn page(of: &Sweep, figures: &[Figure]) -> Page {
    let failed = of.failed().count();
    let done = of.runs.len() - failed;
    let mut lead = format!(
        "{} points in {} configurations: {done} of {} runs have results",
        of.points.len(),
        of.configurations,
        of.planned
    );
    if failed > 0 {
        let _ = write!(lead, ", {failed} failed");
    }
    let below = of.runs.iter().filter(|r| r.meets_standard == Some(false)).count();
    if below > 0 {
        let do_not = if below == 1 { "does not" } else { "do not" };
        let _ = write!(lead, "; {below} {do_not} meet the accuracy standard for overlap and creep");
    }
    let not_valid = of.runs.iter().filter(|r| r.valid == Some(false)).count();
    let found = not_valid.saturating_sub(below);
    if found > 0 {
        let that_do = if found == 1 { "that does" } else { "that do" };
        let _ = write!(lead, "; in {found} {that_do} a run-time check found something");
    }
    if not_valid > 0 {
        let _ = write!(lead, "; not valid: {not_valid} of {done}");
    }
    let left_out = of.left_out().count();
    if left_out > 0 {
        let _ = write!(lead, "; {}", left_out_in_words(left_out, done));
    }
    lead.push('.');
    let mut tables = vec![effects(of), points(of)];
    if left_out > 0 {
        tables.push(runs_left_out(of));
    }
    if failed > 0 {
        tables.push(failures(of));
    }
    Page {
        title: format!("Sweep of {}", plain(&of.scenario)),
        lead,
        good: failed == 0 && not_valid == 0 && left_out == 0,
        tables,
        figures: figures
            .iter()
            .map(|f| (f.title.clone(), f.stem.clone(), f.caption.clone()))
            .collect(),
    }
}

fn texts<const N: usize>(of: [&str; N]) -> Vec<String> {
    of.map(str::to_owned).to_vec()
}

/// A probability for people.
fn probability(p: Option<f64>) -> String {
    match p {
        None => "–".to_owned(),
        Some(p) if p < 0.001 => "< 0.001".to_owned(),
        Some(p) => number(p, 3),
    }
}

/// How many runs are left out of a number; nothing where none is.
fn without(left_out: usize) -> String {
    if left_out > 0 { format!(" (left out: {left_out})") } else { String::new() }
}

fn effects(of: &Sweep) -> Section {
    let rows = of.effects.iter().map(|e| {
        let slope = match (e.slope, e.slope_half_width) {
            (Some(slope), Some(half)) => {
                format!("{} ± {}{}", compact(slope), compact(half), without(e.left_out))
            }
            (Some(slope), None) => format!("{}{}", compact(slope), without(e.left_out)),
            (None, _) if e.left_out > 0 && e.runs == 0 => NO_VALID_RUN.to_owned(),
            (None, _) if e.left_out > 0 => "too few valid runs".to_owned(),
            (None, _) => "–".to_owned(),
        };
        vec![
            e.factor.clone(),
            in_words(&e.outcome).to_owned(),
            slope,
            probability(e.slope_p),
            probability(e.page_p),
            e.configurations_needed.map_or_else(|| "–".to_owned(), |n| n.to_string()),
        ]
    });
    let header = texts([
        "factor",
        "result",
        "change for one unit",
        "p",
        "p by ranks",
        "configurations needed",
    ]);
    let table = TextTable { header, rows: rows.collect() };
    Section { id: "effects", title: "What each factor moves", table }
}

/// Mean of a point and half of its interval.
fn estimate(of: &SweepPoint, e: Option<&SweepEstimate>) -> String {
    let Some(e) = e else {
        let none = of.left_out > 0 && of.left_out == of.runs;
        return if none { NO_VALID_RUN } else { "–" }.to_owned();
    };
    match e.t_high {
        Some(high) => format!("{} ± {}", compact(e.mean), compact(high - e.mean)),
        None => compact(e.mean),
    }
}

fn points(of: &Sweep) -> Section {
    let outcomes: Vec<&(&str, &str)> = OUTCOMES[..MAIN_OUTCOMES]
        .iter()
        .filter(|(path, _)| of.runs.iter().any(|r| r.outcomes.contains_key(*path)))
        .collect();
    let mut header = texts(["point"]);
    header.extend(of.factors.iter().map(|f| f.path.clone()));
    header.extend(texts(["runs", "valid", "left out"]));
    header.extend(outcomes.iter().map(|(_, words)| (*words).to_owned()));
    let rows = of.points.iter().map(|p| {
        let mut row = vec![p.point.clone()];
        row.extend(p.values.iter().map(shown));
        let failed = if p.failed > 0 { format!(", {} failed", p.failed) } else { String::new() };
        row.push(format!("{}{failed}", p.runs));
        row.extend([p.valid.to_string(), p.left_out.to_string()]);
        row.extend(outcomes.iter().map(|(path, _)| estimate(p, p.outcomes.get(*path))));
        row
    });
    let table = TextTable { header, rows: rows.collect() };
    Section { id: "points", title: "Points", table }
}

fn failures(of: &Sweep) -> Section {
    let table = reasons(of, of.failed(), |r| r.failure.as_ref());
    Section { id: "failures", title: "Runs without result", table }
}

fn runs_left_out(of: &Sweep) -> Section {
    let table = reasons(of, of.left_out(), |r| r.left_out_of_means.as_ref());
    Section { id: "left-out", title: "Runs left out of means", table }
}

/// Runs with their values and what is against them.
fn reasons<'a>(
    of: &Sweep,
    runs: impl Iterator<Item = &'a SweepRun>,
    why: impl Fn(&SweepRun) -> Option<&String>,
) -> TextTable {
    let row = |r: &SweepRun| {
        let values: Vec<String> = of
            .factors
            .iter()
            .zip(&r.values)
            .map(|(f, v)| format!("{}={}", f.path, shown(v)))
            .collect();
        vec![r.run.clone(), values.join(" "), why(r).cloned().unwrap_or_default()]
    };
    TextTable { header: texts(["run", "values", "why"]), rows: runs.map(row).collect() }
}

impl Page {
    /// As Markdown.
    pub(super) fn markdown(&self) -> String {
        let mut text = format!("# {}\n\n{}\n", in_markdown(&self.title), self.lead);
        for section in &self.tables {
            let _ = write!(text, "\n## {}\n\n{}", section.title, section.table.markdown());
        }
        for (title, stem, caption) in &self.figures {
            let _ = write!(
                text,
                "\n![{}](figures/{stem}.png)\n\n{}\n",
                in_markdown(title),
                in_markdown(caption)
            );
        }
        let _ = write!(text, "\n## How to read it\n\n{HOW_TO_READ}\n");
        text
    }

    /// As a page that needs nothing else.
    pub(super) fn html(&self, figures: &[Figure]) -> String {
        html! {
            (DOCTYPE)
            html lang="en" {
                (head(&self.title))
                body {
                    header {
                        h1 { bdi { (self.title) } }
                        @if self.good { p.lead { (glue(&self.lead)) } }
                        @else { p.banner { (glue(&self.lead)) } }
                    }
                    main {
                        @for part in &self.tables {
                            section id=(part.id) {
                                h2 { (part.title) }
                                (part.table.html(None, str::to_owned))
                            }
                        }
                        section id="figures" {
                            h2 { "Figures" }
                            @for figure in figures { (figure_block(figure)) }
                        }
                        section id="reading" { h2 { "How to read it" } p { (HOW_TO_READ) } }
                    }
                }
            }
        }
        .into_string()
    }
}
