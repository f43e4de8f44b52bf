//! Specimens that a sweep begins with and that are realisations of one experiment, made alike but
//! for chance: points that differ in them alone are one point.

use std::collections::btree_map::Entry;

use super::*;
use crate::scenario::BeginSpec;

/// Fields of a run's scenario that do not make its specimen one of another experiment.
const OF_CHANCE_OR_WORDS: [&str; 5] = ["name", "description", "notes", "seed", "configuration"];

/// Specimens that are realisations.
#[derive(Debug)]
pub(super) struct Specimens {
    /// Their place among the factors.
    place: usize,
    /// Their names as they were typed, in their order.
    names: Vec<Value>,
}

/// The specimens that are realisations; none where they are not varied.
///
/// # Errors
/// Why specimens that are varied are values to be compared, as those of any other field.
pub(super) fn realisations(
    options: &SweepOptions,
    points: &[Point],
    varied: &Varied,
) -> Result<Option<Specimens>, String> {
    let fields = options.names();
    let Some(place) = fields.iter().position(|field| *field == SPECIMEN) else {
        return Ok(None);
    };
    let names: Vec<Value> = each_once(points.iter().map(|point| point.values[place].clone()));
    if names.len() < 2 {
        return Ok(None);
    }
    if options.design == Design::OneAtATime {
        return Err("one field at a time is varied".to_owned());
    }
    if options.configurations > 1 {
        return Err("--configurations asks for several realisations of each".to_owned());
    }
    if let Some(other) = fields.iter().find(|field| Scenario::names_realisations(field)) {
        return Err(format!("`{other}` is varied, too"));
    }
    let specimens = Specimens { place, names };
    specimens.are_alike(points, varied)?;
    Ok(Some(specimens))
}

impl Specimens {
    /// Refuses specimens of one point that were not made alike, or are the same one.
    fn are_alike(&self, points: &[Point], varied: &Varied) -> Result<(), String> {
        let mut made: BTreeMap<&str, Value> = BTreeMap::new();
        let mut begun: Vec<(Vec<Value>, &BeginSpec)> = Vec::new();
        for (point, scenario) in points.iter().zip(varied.scenarios()) {
            let Some(begin) = &scenario.begin else { continue };
            if let Entry::Vacant(place) = made.entry(&begin.specimen) {
                place.insert(how_made(begin)?);
            }
            begun.push((self.without(&point.values), begin));
        }
        for (_, of_point) in grouped(begun) {
            for (n, begin) in of_point.iter().enumerate() {
                let both =
                    |other: &BeginSpec| format!("`{}` and `{}`", other.specimen, begin.specimen);
                let is_it = |other: &&&BeginSpec| other.specimen_sha256 == begin.specimen_sha256;
                if let Some(other) = of_point[..n].iter().find(is_it) {
                    return Err(format!("{} are one specimen", both(other)));
                }
                let first = of_point[0];
                if first.after != begin.after {
                    return Err(format!("{} have been through other stages", both(first)));
                }
                let (a, b) = (&made[first.specimen.as_str()], &made[begin.specimen.as_str()]);
                if let Some(field) = first_difference(a, b) {
                    return Err(format!("{} differ in `{field}` of their runs", both(first)));
                }
            }
        }
        Ok(())
    }

    /// How many there are.
    pub fn count(&self) -> u32 {
        u32::try_from(self.names.len()).unwrap_or(u32::MAX)
    }

    /// Their names as they were typed, in the order of their numbers.
    pub fn names(&self) -> &[Value] {
        &self.names
    }

    /// What there is of all factors but them.
    pub fn without<T: Clone>(&self, of_factors: &[T]) -> Vec<T> {
        let others = of_factors.iter().enumerate().filter(|(n, _)| *n != self.place);
        others.map(|(_, of)| of.clone()).collect()
    }

    /// The points that do not differ in them alone, each with the name of the first that is in it.
    pub fn points(&self, points: &[Point]) -> Vec<Point> {
        let mut together: Vec<Point> = Vec::new();
        for point in points {
            let values = self.without(&point.values);
            if together.iter().all(|known| known.values != values) {
                together.push(Point { values, ..point.clone() });
            }
        }
        together
    }

    /// A run as a realisation of its point among these.
    pub fn realised(&self, run: SweepRun, points: &[Point]) -> SweepRun {
        let values = self.without(&run.values);
        let point = points.iter().find(|point| point.values == values);
        let specimen = run.values.get(self.place).cloned();
        let number = self.names.iter().position(|name| Some(name) == specimen.as_ref());
        let number = number.and_then(|n| u32::try_from(n + 1).ok());
        SweepRun {
            point: point.map_or_else(|| run.point.clone(), |point| point.name.clone()),
            configuration: number.unwrap_or(run.configuration),
            specimen,
            values,
            ..run
        }
    }
}

/// What the run of a specimen was, chance and words aside.
fn how_made(begin: &BeginSpec) -> Result<Value, String> {
    let file = begin.folder().join("manifest.json");
    let manifest: Option<Value> = read_json(&file).ok();
    let mut scenario = manifest.map(|manifest| manifest["scenario"].clone()).unwrap_or_default();
    Scenario::remove_what_changes_no_bit(&mut scenario);
    let Value::Object(fields) = &mut scenario else {
        return Err(format!("{} does not say how it was made", file.display()));
    };
    fields.retain(|field, _| !OF_CHANCE_OR_WORDS.contains(&field.as_str()));
    Ok(scenario)
}

/// The first field in which two scenarios differ.
fn first_difference(a: &Value, b: &Value) -> Option<String> {
    let mut fields = [a, b].into_iter().filter_map(Value::as_object).flat_map(Map::keys);
    fields.find(|field| a.get(*field) != b.get(*field)).cloned()
}

#[cfg(test)]
mod tests {
    use super::super::{effects, points::points};
    use super::*;
    use crate::study::tests::bare_scenario;

    /// A sweep over two coefficients of restitution and three specimens of runs, whose descriptions
    /// stand for the hashes of these.
    struct Begun {
        options: SweepOptions,
        points: Vec<Point>,
        varied: Varied,
        _folder: tempfile::TempDir,
    }

    fn begun(design: Design, configurations: u32, change: impl Fn(&mut [Value])) -> Begun {
        let folder = tempfile::tempdir().expect("a folder");
        let place = |n: usize| folder.path().join(format!("run-{n}"));
        let mut runs = [1, 2, 3].map(|n| {
            json!({
                "name": format!("run-{n}"), "description": format!("sha-{n}"), "seed": n,
                "configuration": n, "grains": { "total_mass_g": 40 }
            })
        });
        change(&mut runs);
        for (n, run) in runs.iter().enumerate() {
            std::fs::create_dir(place(n)).expect("a folder");
            write_json(&place(n).join("manifest.json"), &json!({ "scenario": run }))
                .expect("written");
        }
        let names = [0, 1, 2].map(|n| place(n).display().to_string());
        let over = [
            "contact.restitution=0.1,0.3".to_owned(),
            format!("begin.specimen={}", names.join(",")),
        ];
        let options = SweepOptions {
            scenario: "s.json".into(),
            changes: Vec::new(),
            over: over.iter().map(|text| text.parse().expect("a factor")).collect(),
            parameters: Vec::new(),
            quick: false,
            ranges: Vec::new(),
            design,
            configurations,
            folder: PathBuf::new(),
        };
        let points =
            points(Design::Grid, &options.over, &[], &[], &bare_scenario()).expect("points");
        let scenario = |point: &Point| {
            let n = names.iter().position(|name| point.values[1] == *name).expect("a specimen");
            let begin = BeginSpec {
                specimen: names[n].clone(),
                specimen_sha256: runs[n]["description"].as_str().map(str::to_owned),
                stage: None,
                after: vec!["pour".to_owned()],
                key: None,
                taken_over: Vec::new(),
            };
            Scenario { begin: Some(begin), ..bare_scenario() }
        };
        let variation = |point: &Point| Variation::new(&point.name, "sweep", point.changes.clone());
        let all = points.iter().map(|point| (variation(point), scenario(point))).collect();
        let varied = Varied { base: bare_scenario(), all };
        Begun { options, points, varied, _folder: folder }
    }

    /// Law: specimens that were made alike but for chance are realisations of points that differ in
    /// them alone, and effects are of pairs that share a specimen.
    #[test]
    fn specimens_of_one_gravel_are_realisations() {
        let begun = begun(Design::Grid, 1, |_| ());
        let points = &begun.points;
        let found = realisations(&begun.options, points, &begun.varied);
        let of = found.expect("law: made alike").expect("law: they are varied");
        let merged = of.points(points);
        let names: Vec<&str> = merged.iter().map(|point| point.name.as_str()).collect();
        assert_eq!(names, ["point-0001", "point-0004"], "law: named after their first (got left)");
        let run = |(n, point): (usize, &Point)| SweepRun {
            run: format!("{}-c1", point.name),
            point: point.name.clone(),
            configuration: 1,
            values: point.values.clone(),
            outcomes: BTreeMap::from([(
                "void_ratio".to_owned(),
                2.0 * point.values[0].as_f64().expect("a number") + 0.1 * (n % 3) as f64,
            )]),
            ..SweepRun::counted()
        };
        let runs = points.iter().enumerate().map(run).map(|run| of.realised(run, &merged));
        let runs: Vec<SweepRun> = runs.collect();
        let got: Vec<(&str, &str, u32)> =
            runs.iter().map(|r| (r.run.as_str(), r.point.as_str(), r.configuration)).collect();
        let expected = [
            ("point-0001-c1", "point-0001", 1),
            ("point-0002-c1", "point-0001", 2),
            ("point-0003-c1", "point-0001", 3),
            ("point-0004-c1", "point-0004", 1),
            ("point-0005-c1", "point-0004", 2),
            ("point-0006-c1", "point-0004", 3),
        ];
        assert_eq!(got, expected, "law: run, point and number of the specimen (got left)");
        let specimens: Vec<&Value> = runs.iter().filter_map(|run| run.specimen.as_ref()).collect();
        let named: Vec<&Value> = of.names().iter().chain(of.names()).collect();
        assert_eq!(specimens, named, "law: each run names its specimen (got left)");
        assert_eq!(of.count(), 3);
        let factors = [SweepFactor {
            path: "contact.restitution".to_owned(),
            values: vec![json!(0.1), json!(0.3)],
            sampled: false,
            numeric: true,
        }];
        let effect = effects::effects(Design::Grid, &factors, &merged, &runs).remove(0);
        let slope = effect.slope.expect("law: a slope");
        assert!((slope - 2.0).abs() < 1e-9, "law: slope 2, got {slope}, tolerance 1e-9");
        let half = effect.slope_half_width.expect("law: three pairs give an interval");
        assert!(half < 1e-6, "law: specimens scatter, their pairs do not, got ± {half}");
        let rows = effects::point_rows(&merged, &runs);
        let counts: Vec<usize> = rows.iter().map(|row| row.outcomes["void_ratio"].count).collect();
        assert_eq!(counts, [3, 3], "law: three specimens a point (got left)");
    }

    /// Law: specimens that were made differently, are one, or have realisations of their own
    /// are values to be compared, and the reason is said.
    #[test]
    fn specimens_that_differ_in_more_than_chance_are_values() {
        let said = |of: &Begun| {
            realisations(&of.options, &of.points, &of.varied).map(|specimens| specimens.is_some())
        };
        let lighter = |runs: &mut [Value]| runs[2]["grains"]["total_mass_g"] = json!(30);
        let same = |runs: &mut [Value]| runs[1]["description"] = json!("sha-1");
        for (of, words) in [
            (begun(Design::Grid, 1, lighter), "differ in `grains` of their runs"),
            (begun(Design::Grid, 1, same), "are one specimen"),
            (begun(Design::OneAtATime, 1, |_| ()), "one field at a time is varied"),
            (begun(Design::Grid, 2, |_| ()), "--configurations asks for several realisations"),
        ] {
            let why = said(&of).expect_err("law: they are values");
            assert!(why.contains(words), "law: expected `{words}`, got `{why}`");
        }
        let mut other = begun(Design::Grid, 1, |_| ());
        other.options.over.remove(1);
        assert_eq!(said(&other), Ok(false), "law: where they are not varied there are none");
    }
}
