//! Whether a sweep changes a value twice: of two changes of it a run has only the last, and tables
//! would show the other as if it had been run.

use super::*;

/// Refuses fields that are varied twice, however their paths are written, fields that are varied
/// together with a part of them, be it by `--set`, and changes of fields that every run has a value
/// of by `--over`.
pub(super) fn refuse(options: &SweepOptions) -> Result<(), StudyError> {
    // A parameter that changes several fields has a name in place of a path.
    let is_no_path =
        |name: &str| options.parameters.iter().any(|p| p.path.is_empty() && p.name == name);
    let mut known: Vec<(&str, Option<Override>)> = Vec::new();
    for name in options.names() {
        let place: Option<Override> =
            if is_no_path(name) { None } else { format!("{name}=0").parse().ok() };
        for (other, others_place) in &known {
            if *other == name {
                return refused(format!("`{name}` is varied twice"));
            }
            if let (Some(place), Some(others_place)) = (&place, others_place) {
                apart((name, place), (*other, others_place))?;
            }
        }
        known.push((name, place));
    }
    for change in &options.changes {
        let around = known
            .iter()
            .find(|(_, place)| place.as_ref().is_some_and(|place| change.is_part_of(place)));
        if let Some((name, _)) = around {
            return refused(format!(
                "--set {}: it would be lost, for `{name}` is varied and replaced as a whole; put it \
                 into the values of `{name}`",
                change.text()
            ));
        }
        // One at a time a field is varied around its value; of a range that says whether numbers
        // are whole.
        let varied = options.over.iter().filter(|_| options.design != Design::OneAtATime);
        let lost = varied
            .zip(&known)
            .find(|(_, (_, place))| place.as_ref().is_some_and(|place| change.is_where(place)));
        if let Some((factor, _)) = lost {
            return refused(format!(
                "{}: it would be lost, for every run has a value of `{}` by --over; leave it out, or \
                 add it to these values",
                change.text(),
                factor.path
            ));
        }
    }
    Ok(())
}

/// Refuses values of `configuration` that lie closer together than the number of realisations at
/// each point, which count up from there: one run would belong to two points.
pub(super) fn refuse_shared_realisations(
    names: &[&str],
    points: &[Point],
    count: u32,
) -> Result<(), StudyError> {
    let Some(n) = names.iter().position(|name| *name == "configuration") else {
        return Ok(());
    };
    let mut begins: Vec<u64> = points.iter().filter_map(|point| point.values[n].as_u64()).collect();
    begins.sort_unstable();
    begins.dedup();
    let shared = begins.windows(2).find(|pair| pair[1] - pair[0] < u64::from(count));
    shared.map_or(Ok(()), |pair| {
        refused(format!(
            "`configuration` is varied from {} to {} while --configurations takes {count} from each \
             of them: some runs would belong to two points (allowed: values at least {count} apart)",
            pair[0], pair[1]
        ))
    })
}

/// Refuses points that are the same run: nothing that a result depends on differs.
pub(super) fn refuse_same_runs(points: &[Point], varied: &Varied) -> Result<(), StudyError> {
    let changed = |point: &Point| match point.changes.as_slice() {
        [] => "the scenario as it is".to_owned(),
        changes => changes.iter().map(Override::text).collect::<Vec<_>>().join(" "),
    };
    let mut known: BTreeMap<String, &Point> = BTreeMap::new();
    for (point, scenario) in points.iter().zip(varied.scenarios()) {
        let mut run = in_question(scenario);
        if let Some(fields) = run.as_object_mut() {
            fields.remove("name");
        }
        if let Some(other) = known.insert(run.to_string(), point) {
            return refused(format!(
                "{} ({}) and {} ({}) are the same run: nothing that a result depends on differs; \
                 vary other fields or values, or take realisations with --configurations",
                other.name,
                changed(other),
                point.name,
                changed(point)
            ));
        }
    }
    Ok(())
}

/// Refuses two fields of which one is the other, or part of it.
fn apart(
    (name, place): (&str, &Override),
    (other, others_place): (&str, &Override),
) -> Result<(), StudyError> {
    if place.is_where(others_place) {
        return refused(format!(
            "`{name}` is varied twice: `{other}` is the same field; give it all its values at once"
        ));
    }
    if !place.overlaps(others_place) {
        return Ok(());
    }
    let (part, whole) = if place.is_part_of(others_place) { (name, other) } else { (other, name) };
    refused(format!(
        "`{part}` is part of `{whole}`, and both are varied: the table would show values that no \
         run had; vary single fields, or `{whole}` alone"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::sensitivity::Parameter;
    use crate::study::sweep::Design;

    fn options(over: &[&str], ranges: &[&str], set: &[&str]) -> SweepOptions {
        SweepOptions {
            scenario: "s.json".into(),
            changes: set.iter().map(|text| text.parse().expect("a change")).collect(),
            over: over.iter().map(|text| text.parse().expect("a factor")).collect(),
            parameters: Vec::new(),
            quick: false,
            ranges: ranges.iter().map(|text| text.parse().expect("a range")).collect(),
            design: Design::Grid,
            configurations: 1,
            folder: PathBuf::new(),
        }
    }

    /// Law: a value is varied once; the message names both paths as they were typed.
    #[test]
    fn a_value_that_is_changed_twice_is_refused() {
        let cases: [(SweepOptions, [&str; 2]); 9] = [
            (options(&["seed=1", "seed=2"], &[], &[]), ["`seed`", "varied twice"]),
            (
                options(&["stages[1].x=1,200", "stages.1.x=3,4"], &[], &[]),
                ["`stages.1.x` is varied twice", "`stages[1].x`"],
            ),
            (
                options(&["stages.1.x=1,200"], &["stages[1].x=3..4"], &[]),
                ["`stages[1].x` is varied twice", "`stages.1.x`"],
            ),
            (
                options(
                    &["contact={\"restitution\":0.1}", "contact.restitution=0.2,0.3"],
                    &[],
                    &[],
                ),
                ["`contact.restitution` is part of `contact`", "both are varied"],
            ),
            (
                options(
                    &["contact.restitution=0.2,0.3", "contact={\"restitution\":0.1}"],
                    &[],
                    &[],
                ),
                ["`contact.restitution` is part of `contact`", "both are varied"],
            ),
            (
                options(&["stages[0]={}"], &["stages.0.x=3..4"], &[]),
                ["`stages.0.x` is part of `stages[0]`", "both are varied"],
            ),
            (
                options(&["contact={\"restitution\":0.1}"], &[], &["contact.restitution=0.2"]),
                ["--set contact.restitution=0.2", "`contact` is varied"],
            ),
            (
                options(&["seed=7", "stages[1].x=1,2"], &[], &["stages.1.x=3"]),
                ["stages.1.x=3: it would be lost", "`stages[1].x` by --over"],
            ),
            (
                options(&["begin.specimen=a,b"], &[], &["begin.specimen=b"]),
                ["begin.specimen=b: it would be lost", "`begin.specimen` by --over"],
            ),
        ];
        for (options, words) in cases {
            let said = refuse(&options).expect_err("law: refused").to_string();
            for word in words {
                assert!(said.contains(word), "law: `{word}` is said, got `{said}`");
            }
        }
    }

    /// Law: realisations count up from each value; none belongs to two points.
    #[test]
    fn realisations_of_two_points_are_apart() {
        let points = |values: &[u64]| -> Vec<Point> {
            let point =
                |v: &u64| Point { values: vec!["a".into(), (*v).into()], ..Point::default() };
            values.iter().map(point).collect()
        };
        let names = ["other", "configuration"];
        let far = points(&[101, 1, 1, 6]);
        let fine = refuse_shared_realisations(&names, &far, 5);
        assert!(fine.is_ok(), "law: 1 to 5, 6 to 10 and 101 to 105 share none, got {fine:?}");
        let said = refuse_shared_realisations(&names, &far, 6).expect_err("law: 6 is in two");
        for word in ["from 1 to 6", "takes 6", "at least 6 apart"] {
            assert!(said.to_string().contains(word), "law: `{word}` is said, got `{said}`");
        }
        assert!(refuse_shared_realisations(&["a", "b"], &far, 9).is_ok(), "law: others are free");
    }

    /// Law: the sensitivity design of this project can be carried out as a sweep, both of its
    /// specimens, with several realisations.
    #[test]
    fn the_shipped_design_is_a_sweep() {
        let design =
            Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/studies/sensitivity.json");
        for quick in [true, false] {
            let options = SweepOptions::of_design(&design, quick, &[], Some(5)).expect("a design");
            let study = SweepStudy::new(options).map(|study| study.points.len());
            let said = study.as_ref().err().map(ToString::to_string);
            assert!(said.is_none(), "law: quick {quick} is accepted, got {said:?}");
        }
    }

    /// Law: fields that only look alike, a value to vary around, and names of parameters are no
    /// second change.
    #[test]
    fn what_is_changed_once_is_accepted() {
        let apart = ["stages[1].x=1", "stages[2].x=1", "contact.restitution=1", "seed=1"];
        let set = ["contact.friction=0.2", "contact={\"restitution\":0.1}", "stages[3].x=1"];
        let mut options = options(&apart, &["stages.3.x=1..2"], &set);
        assert!(refuse(&options).is_ok(), "law: {:?}", refuse(&options));
        options.changes.push("seed=2".parse().expect("a change"));
        options.design = Design::OneAtATime;
        assert!(refuse(&options).is_ok(), "law: a value to vary around: {:?}", refuse(&options));
        let name = "contact".to_owned();
        options.parameters = vec![Parameter { name, ..Parameter::default() }];
        assert!(refuse(&options).is_ok(), "law: a name is no path: {:?}", refuse(&options));
    }
}
