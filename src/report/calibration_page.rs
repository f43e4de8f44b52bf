//! The page of a calibration, as Markdown and as HTML.

use std::fmt::Write;

use maud::{DOCTYPE, Markup, html};

use super::{
    Calibration, CalibrationEnding, CalibrationValue, Figure, FrictionIdentity,
    calibration::{target_in_words, with_unit},
    figures::capital,
    html::{figure_block, glue, head},
    text_table::{TextTable, in_markdown},
};
use crate::paper::{
    constants::ANGLE_OF_REPOSE_DEG,
    text::{compact, number},
};
use crate::record::NO_VALID_RUN;

/// What the page says, without its form.
pub(super) struct Page {
    title: String,
    lead: String,
    good: bool,
    /// Name and value.
    found: Vec<(String, String)>,
    values: TextTable,
    notes: Vec<String>,
    figure: (String, String, String),
}

const HEADER: [&str; 6] = ["value", "runs", "mean", "± 95 %", "standard deviation", "in the line"];

const HOW_TO_READ: &str = "Every value is run in the same configurations, each the same grains mixed anew. A \
     line is fitted to each configuration's results near the solution; the configurations' lines \
     are a sample, and the interval holds all values at which Student's t-test does not refuse \
     that their mean is the wanted result (Fieller 1954). Runs that are not valid, or of which too many \
     grains are missing, are left out as runs that failed are (docs/accuracy.md). It says what chance in mixing does, not \
     what a time step, an engine or a model does.";

/// Puts the page together.
pub(super) fn page(of: &Calibration, figure: &Figure) -> Page {
    Page {
        title: format!("Calibration: {} by {}", target_in_words(&of.target), of.unknown_in_words()),
        lead: format!("{}.", capital(&of.statement)),
        good: of.ending == CalibrationEnding::Found,
        found: found(of),
        values: TextTable {
            header: HEADER.map(str::to_owned).to_vec(),
            rows: of.values.iter().map(|v| value_row(v, of).to_vec()).collect(),
        },
        notes: of.notes.iter().map(|n| format!("{}.", capital(n))).collect(),
        figure: (figure.title.clone(), figure.stem.clone(), figure.caption.clone()),
    }
}

/// Name and value of what was found.
pub fn found(of: &Calibration) -> Vec<(String, String)> {
    let unit = |v: f64| with_unit(&compact(v), &of.unit);
    let mut rows = vec![
        (format!("{} wanted", target_in_words(&of.target)), unit(of.wanted)),
        (
            "searched".to_owned(),
            format!("{} from {} to {}", of.unknown_in_words(), of.between.low, of.between.high),
        ),
    ];
    let mut row = |name: &str, value: String| rows.push((name.to_owned(), value));
    if let Some(s) = of.solution {
        row(&format!("{} needed", of.unknown_in_words()), compact(s.value));
        row(
            "its 95 % confidence interval",
            s.interval_95.map_or_else(
                || "none: the slope cannot be told from zero".to_owned(),
                |i| format!("{} to {}", compact(i.low), compact(i.high)),
            ),
        );
        row(
            &format!("{} there", target_in_words(&of.target)),
            with_unit(
                &format!("{} ± {}", compact(of.wanted), compact(s.result_half_width_95)),
                &of.unit,
            ),
        );
        let per_unit = with_unit(
            &format!("{} ± {}", compact(s.slope), compact(s.slope_half_width_95)),
            &of.unit,
        );
        row("change for one unit", format!("{per_unit}, {} configurations", s.configurations));
    }
    if let Some(scatter) = of.scatter {
        row("scatter of a single run (standard deviation)", unit(scatter));
    }
    if let Some(tolerance) = of.tolerance {
        let whence = if of.tolerance_given { "given" } else { "that of a single run" };
        row("tolerance", format!("{} ({whence})", unit(tolerance)));
    }
    let mut runs = format!("{} of at most {}", of.runs.len(), of.most_runs);
    let left_out = of.runs.iter().filter(|r| r.is_left_out()).count();
    if left_out > 0 {
        let _ = write!(runs, ", {left_out} left out");
    }
    row("runs", runs);
    if let Some(identity) = &of.identity {
        identity_rows(of, identity, &mut row);
    }
    rows
}

/// The assumption of the paper, beside what was found.
fn identity_rows(of: &Calibration, of_it: &FrictionIdentity, row: &mut impl FnMut(&str, String)) {
    row(
        "friction in the paper",
        format!("{} for {ANGLE_OF_REPOSE_DEG}° (section 3)", compact(of_it.paper_friction)),
    );
    row(
        "friction if angle of repose = atan μ",
        format!("{} (Lambe & Whitman 1979)", compact(of_it.friction)),
    );
    if let Some(angle) = of_it.friction_angle_found_degrees {
        row("angle of friction of what was found", format!("{}°", number(angle, 1)));
    }
    if let (Some(there), Some(difference), Some(half), Some(p)) =
        (of_it.degrees_there, of_it.difference_degrees, of_it.difference_half_width_95, of_it.p)
    {
        let verdict = match (p < 0.05, difference > 0.0) {
            (true, true) => "steeper than the assumption has it",
            (true, false) => "flatter than the assumption has it",
            (false, _) => "the assumption cannot be refused",
        };
        let p = if p < 0.001 { "p < 0.001".to_owned() } else { format!("p {}", number(p, 3)) };
        row(
            &format!("angle of repose at {}", compact(of_it.tried)),
            format!(
                "{}°, less its angle of friction {} ± {}° ({p}): {verdict}",
                number(there, 1),
                number(difference, 1),
                number(half, 1)
            ),
        );
    }
    if let Some(inside) = of_it.inside_interval {
        let does = if inside { "holds" } else { "does not hold" };
        row("the interval found", format!("{does} tan {}°", compact(of.wanted)));
    }
}

fn value_row(v: &CalibrationValue, of: &Calibration) -> [String; 6] {
    let shown = |value: Option<f64>| {
        value.map_or_else(|| "–".to_owned(), |v| with_unit(&compact(v), &of.unit))
    };
    let mut failed =
        if v.failed > 0 { format!(", {} without result", v.failed) } else { String::new() };
    if v.left_out > 0 {
        let _ = write!(failed, ", {} left out", v.left_out);
    }
    let none = v.left_out > 0 && v.left_out + v.failed == v.runs;
    [
        v.value.to_string(),
        format!("{}{failed}", v.runs),
        if none { NO_VALID_RUN.to_owned() } else { shown(v.mean) },
        shown(v.half_width_95),
        shown(v.standard_deviation),
        if v.in_fit { "yes" } else { "" }.to_owned(),
    ]
}

impl Page {
    /// As Markdown.
    pub(super) fn markdown(&self) -> String {
        let mut text = format!(
            "# {}\n\n{}\n\n| | |\n| --- | --- |\n",
            in_markdown(&self.title),
            in_markdown(&self.lead)
        );
        for (name, value) in &self.found {
            let _ = writeln!(text, "| {} | {} |", in_markdown(name), in_markdown(value));
        }
        let _ = write!(text, "\n## Values tried\n\n{}", self.values.markdown());
        if !self.notes.is_empty() {
            text += "\n## To be known\n\n";
            for note in &self.notes {
                let _ = writeln!(text, "- {}", in_markdown(note));
            }
        }
        let (title, stem, caption) = &self.figure;
        let _ = write!(
            text,
            "\n![{}](figures/{stem}.png)\n\n{}\n",
            in_markdown(title),
            in_markdown(caption)
        );
        let _ = write!(text, "\n## How to read it\n\n{HOW_TO_READ}\n");
        text
    }

    /// As a page that needs nothing else.
    pub(super) fn html(&self, figure: &Figure) -> String {
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
                        section id="found" { h2 { "What was found" } (self.found_table()) }
                        @if !self.notes.is_empty() {
                            section id="notes" {
                                h2 { "To be known" }
                                ul { @for note in &self.notes { li { bdi { (glue(note)) } } } }
                            }
                        }
                        section id="figure" { h2 { "Figure" } (figure_block(figure)) }
                        section id="values" {
                            h2 { "Values tried" }
                            (self.values.html(Some("n"), capital))
                        }
                        section id="reading" { h2 { "How to read it" } p { (HOW_TO_READ) } }
                    }
                }
            }
        }
        .into_string()
    }

    fn found_table(&self) -> Markup {
        html! {
            div.scroll { table { tbody {
                @for (name, value) in &self.found {
                    tr { th { bdi { (glue(&capital(name))) } } td { bdi { (glue(value)) } } }
                }
            } } }
        }
    }
}
