//! Why runs of a sweep have no result, or one that does not count, or one without some of its values.

use super::*;
use crate::in_order::grouped;

/// What a reader must know of means over those runs that have a value.
const NOT_RANDOM: &str = "Means and effects of these results rest on the other runs. Runs without a value are not random: \
     it is withheld where the specimen would give it no meaning, as where it stands too low, so \
     that means over the others are biased.";

/// The values of all factors of a run.
fn values(of: &Sweep, run: &SweepRun) -> String {
    let each = of.factors.iter().zip(&run.values);
    let each = each.map(|(f, v)| format!("{}={}", f.path, shown(v)));
    let specimen = run.specimen.iter().map(|specimen| format!("{SPECIMEN}={}", shown(specimen)));
    specimen.chain(each).collect::<Vec<_>>().join(" ")
}

/// Runs with a reason each.
pub(super) fn reasons<'a>(
    of: &Sweep,
    runs: impl Iterator<Item = &'a SweepRun>,
    why: impl Fn(&SweepRun) -> Option<&String>,
) -> Table {
    table!(runs, |r| {
        "run" => &r.run,
        "values" => values(of, r),
        "why" => why(r),
    })
}

/// Over how many runs of a point a mean is, where that is not over all that count.
pub(super) fn if_not_all(of: &SweepPoint, count: usize) -> String {
    let counting = of.runs - of.left_out;
    if count >= counting {
        return String::new();
    }
    format!(" ({count} of {})", counted(counting, "run"))
}

/// How many runs an effect is without, and why, where it is without any.
pub(super) fn without(of: &SweepEffect) -> String {
    let all = [(of.left_out, "left out"), (of.withheld, "withheld")];
    let some = all.into_iter().filter(|(count, _)| *count > 0);
    let said: Vec<String> = some.map(|(count, why)| format!("{why}: {count}")).collect();
    if said.is_empty() { String::new() } else { format!(" ({})", said.join("; ")) }
}

/// What a run does not give, by reason, for its row in the table of runs.
pub(super) fn withheld_in_row(run: &SweepRun) -> String {
    let by_reason = grouped(run.withheld.iter().map(|of| (of.reason.as_str(), of.field.as_str())));
    let said = |(reason, fields): (&str, Vec<&str>)| format!("{}: {reason}", fields.join(", "));
    by_reason.into_iter().map(said).collect::<Vec<_>>().join("; ")
}

/// The runs that count and withhold a main result that others give, each with what and why, and what
/// that means; nothing where there are none.
pub(super) fn withheld(of: &Sweep) -> Vec<Block> {
    let main = main_outcomes(&of.runs);
    let mut table = Table::new(["run", "values", "result", "why it is withheld"]);
    for run in of.runs.iter().filter(|run| run.counts_in_means()) {
        let each = main
            .iter()
            .filter_map(|path| Some((run.why_withheld(path)?, in_words(path, &of.names))));
        for (why, results) in grouped(each) {
            table.row(row![&run.run, values(of, run), results.join(", "), why]);
        }
    }
    if table.is_empty() {
        return Vec::new();
    }
    vec![Block::Text(NOT_RANDOM.to_owned()), Block::Table(table)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Withheld;

    const VOIDS: &str = "void_ratio";

    fn run(number: u32, outcome: Option<f64>, withheld: bool) -> SweepRun {
        let reason = || "the mean surface stands 17.6 mm high".to_owned();
        let of = |field: &str| Withheld { field: field.to_owned(), reason: reason() };
        SweepRun {
            run: format!("point-0001-c{number}"),
            point: "point-0001".to_owned(),
            configuration: number,
            values: vec![1.into()],
            outcomes: outcome.map(|value| (VOIDS.to_owned(), value)).into_iter().collect(),
            withheld: if withheld { vec![of(VOIDS), of("porosity")] } else { Vec::new() },
            ..SweepRun::counted()
        }
    }

    fn sweep(runs: Vec<SweepRun>) -> Sweep {
        Sweep {
            scenario: "s".to_owned(),
            design: "grid",
            factors: vec![SweepFactor {
                path: "contact.restitution".to_owned(),
                values: vec![1.into()],
                sampled: false,
                numeric: true,
            }],
            configurations: 3,
            planned: runs.len(),
            runs,
            points: Vec::new(),
            effects: Vec::new(),
            specimens: Vec::new(),
            names: LaboratoryNames::default(),
        }
    }

    /// Law: what is withheld of some runs that count is said with its number, its reason, and that it
    /// is not random; where all withhold it, no mean is made of the others.
    #[test]
    fn withheld_values_are_said_with_their_reason() {
        let some = sweep(vec![run(1, Some(0.7), false), run(2, None, true)]);
        let got = withheld_in_words(&some).expect("law: one is withheld");
        assert_eq!(got, "withheld, and not at random: Void ratio in 1 of 2", "(got left)");
        let page = Page::new("p", []).section("withheld", "Withheld", withheld(&some)).markdown();
        for said in [
            "Runs without a value are not random",
            "| point-0001-c2 | contact.restitution=1 | Void ratio | the mean surface stands 17.6 mm high |",
        ] {
            assert!(page.contains(said), "law: `{said}`, got:\n{page}");
        }
        assert!(!page.contains("point-0001-c1"), "law: that one has its value, got:\n{page}");
        let in_row = withheld_in_row(&some.runs[1]);
        assert_eq!(
            in_row, "void_ratio, porosity: the mean surface stands 17.6 mm high",
            "law: all that is withheld, a reason once (got left)"
        );
        for of in [vec![run(1, Some(0.7), false)], vec![run(1, None, true), run(2, None, true)]] {
            let of = sweep(of);
            assert_eq!(withheld_in_words(&of), None, "law: no mean is of some of the runs");
            assert!(withheld(&of).is_empty(), "law: nor a section");
        }
        let mut out = some;
        out.runs[1].left_out_of_means = Some("not valid".to_owned());
        assert_eq!(withheld_in_words(&out), None, "law: what does not count is left out anyhow");
    }

    /// Law: a mean says over how many runs it is where these are not all that count, and an effect
    /// without how many it is.
    #[test]
    fn means_over_some_of_the_runs_say_so() {
        let point = |left_out: usize| SweepPoint {
            point: "point-0001".to_owned(),
            values: Vec::new(),
            runs: 3,
            valid: 3,
            left_out,
            failed: 0,
            outcomes: BTreeMap::new(),
        };
        for (left_out, count, expected) in
            [(0, 3, ""), (0, 2, " (2 of 3 runs)"), (1, 2, ""), (1, 0, " (0 of 2 runs)"), (3, 0, "")]
        {
            let got = if_not_all(&point(left_out), count);
            assert_eq!(got, expected, "law: {left_out} left out, {count} with a value (got left)");
        }
        let effect = |left_out, withheld| {
            without(&SweepEffect { left_out, withheld, ..SweepEffect::default() })
        };
        assert_eq!(effect(0, 0), "", "law: nothing where all runs are in it (got left)");
        assert_eq!(effect(1, 2), " (left out: 1; withheld: 2)", "law: both (got left)");
    }

    /// Law: a field that is withheld takes along what is in it, and nothing that only begins alike.
    #[test]
    fn parts_of_a_withheld_field_are_withheld() {
        let mut of = run(1, None, true);
        of.withheld[1].field = "poured_height_mm".to_owned();
        for (path, expected) in [
            ("void_ratio", true),
            ("poured_height_mm.mean_surface", true),
            ("void_ratio_of_others", false),
            ("poured_void_ratio", false),
        ] {
            let got = of.why_withheld(path).is_some();
            assert_eq!(got, expected, "law: `{path}` is withheld, expected {expected}, got {got}");
        }
    }
}
