//! Index densities: the loosest and the densest state of a scenario's grains.
//!
//! After ASTM D4254 the loosest state is that of grains that are let fall into a mould from just
//! above what lies in it, whose surface the height follows. The densest is that of grains vibrated
//! vertically, as in ASTM D4253, which does so at 60 Hz and 0.33 mm under 13.8 kPa for 8 minutes:
//! too long to simulate, and in some seconds it moves them little. Grains without any friction,
//! poured, are a bound beside them. The mould is as large as the grains fill; what differs from the
//! standards is said in the result.

mod faults;
mod mould;

use super::begin::{GRAINS_FILE, read_grains};
use super::*;
use crate::measure::statistics;
use crate::protocol::Fall;
use crate::record::{read_file, run_file, series_from_csv};
use mould::Mould;

/// How index densities are found.
pub struct DensityOptions {
    /// The scenario's file, of which grains, contact and engine are taken.
    pub scenario: PathBuf,
    /// Changes in it.
    pub changes: Vec<Override>,
    /// Configurations, each a new random arrangement of the same grains.
    pub configurations: u32,
    /// Surcharge on the vibrated specimen in kPa.
    pub surcharge_kpa: f64,
    /// Frequency of the vibration in Hz.
    pub frequency_hz: f64,
    /// Double amplitude (end to end) of the vibration in mm.
    pub double_amplitude_mm: f64,
    /// How long it is vibrated, in s.
    pub duration_s: f64,
}

/// A state of grains in several configurations.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IndexState {
    /// How it was made.
    pub method: String,
    /// Mean void ratio.
    pub mean: Option<f64>,
    /// Half of its 95 % confidence interval by Student's t.
    pub half_width_95: Option<f64>,
    /// Each configuration.
    pub values: Vec<f64>,
    /// Why configurations have no value: they failed, or are left out of means.
    pub failures: Vec<String>,
}

/// Of each state: something.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OfStates<T> {
    /// The loosest.
    pub e_max: T,
    /// The densest.
    pub e_min: T,
    /// Without friction: a bound that no grain with friction reaches by itself.
    pub frictionless: T,
}

impl<T> OfStates<T> {
    /// What a function makes of each.
    fn map<U>(&self, of: impl Fn(&T) -> U) -> OfStates<U> {
        OfStates {
            e_max: of(&self.e_max),
            e_min: of(&self.e_min),
            frictionless: of(&self.frictionless),
        }
    }
}

/// `density.json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct IndexDensities {
    /// Name of the scenario whose grains these are.
    pub scenario: String,
    /// Number of grains.
    pub grains: usize,
    /// Inner diameter of the mould in mm.
    pub mould_diameter_mm: f64,
    /// Mean void ratios.
    #[serde(flatten)]
    pub means: OfStates<Option<f64>>,
    /// Their 95 % confidence intervals by Student's t, from low to high.
    pub intervals: OfStates<Option<[f64; 2]>>,
    /// How each was made, and every configuration.
    pub states: OfStates<IndexState>,
    /// How far grains of the loosest state sank from where they were let go to where they lie: the
    /// mean over realisations, and the largest; none where no run counts.
    pub fall: Option<Fall>,
    /// By how much the vibrated specimens grew denser in the second half of the vibration, in
    /// motion.
    pub second_half: Vec<f64>,
    /// Where this is not what the standards ask for.
    pub departures: Vec<String>,
}

/// Makes grains, mould and stages of a search for index densities, which leaves `density.json` and
/// `runs/<name>/`. A run that fails or does not count is reported among the failures.
///
/// # Errors
/// [`StudyError`]: faults of the scenario, or of what was asked for.
pub fn density(options: DensityOptions) -> Result<Study<IndexDensities>, StudyError> {
    let loaded = load_scenario(&options.scenario, &options.changes)?.scenario;
    if loaded.begin.is_some() {
        let why = "index densities need a scenario with grains of its own, not one that begins \
                   with another run's specimen";
        return refused(why.to_owned());
    }
    let grains = make_grains(&loaded)?;
    let stiffness = loaded.engine.native.contact_stiffness_n_per_m;
    let mould = Mould::of(&grains, &loaded.scale(), stiffness);
    let told = |variation: &Variation, fault| {
        faults::told(&variation.name, fault, &options, grains.grains.len(), &mould)
    };
    let variations = mould.variations(&options);
    let varied = Varied::load_told(&options.scenario, &options.changes, variations, told);
    let varied = varied.map_err(faults::without_repeats)?;
    let question = json!({
        "scenario": in_question(&varied.base),
        "surcharge_kpa": options.surcharge_kpa,
        "frequency_hz": options.frequency_hz,
        "double_amplitude_mm": options.double_amplitude_mm,
        "seconds": options.duration_s,
        (AT_LEAST): { "configurations": options.configurations },
    });
    Ok(Study {
        command: "density",
        question,
        // Nobody typed its moulds and stages.
        scenarios: Vec::new(),
        conclude: Box::new(move |run| mould.find(&options, &grains, &varied, run)),
    })
}

impl Mould {
    /// Finds the index densities.
    fn find(
        &self,
        options: &DensityOptions,
        grains: &GrainSet,
        varied: &Varied,
        run: &RunOptions,
    ) -> Result<IndexDensities, StudyError> {
        if let Some(narrow) = self.narrow() {
            run.progress.message(&format!("warning: {narrow}"));
        }
        let rows = carry_out_variations(varied, options.configurations, run, &mut |_| Ok(()))?;
        let state = |name: &str, method: String| self.state(name, method, &rows, &run.out);
        let DensityOptions { surcharge_kpa, frequency_hz, double_amplitude_mm, duration_s, .. } =
            options;
        let densest = format!(
            "vibrated vertically at {frequency_hz} Hz and {double_amplitude_mm} mm from end to end for \
             {duration_s} s under {surcharge_kpa} kPa"
        );
        let fall = self.fall(&rows, &run.out)?;
        let loosest = format!(
            "let fall from just above what lies in the mould, whose surface the height follows{}",
            fall.map_or_else(String::new, |fall| format!(
                ": to where they lie, centres sank by {:.1} mm in the mean and by {:.1} mm at most",
                fall.mean_mm, fall.largest_mm
            ))
        );
        let states = OfStates {
            e_max: state("loosest", loosest)?,
            e_min: state("densest", densest)?,
            frictionless: state("frictionless", "poured without any friction".to_owned())?,
        };
        let interval = |of: &IndexState| {
            of.mean.zip(of.half_width_95).map(|(mean, half)| [mean - half, mean + half])
        };
        let found = IndexDensities {
            scenario: varied.base.name.clone(),
            grains: grains.grains.len(),
            mould_diameter_mm: to_mm(self.diameter),
            means: states.map(|of| of.mean),
            intervals: states.map(interval),
            states,
            fall,
            second_half: self.second_half(&rows, options, &run.out)?,
            departures: self.departures(grains, options),
        };
        write_json(&run.out.join("density.json"), &found)?;
        Ok(found)
    }

    /// Void ratios of the runs of a variation.
    fn state(
        &self,
        name: &str,
        method: String,
        rows: &[RunRow],
        out: &Path,
    ) -> Result<IndexState, StudyError> {
        let (mut values, mut failures) = (Vec::new(), Vec::new());
        for row in rows.iter().filter(|row| row.variation == name) {
            match self.void_ratio(row, out)? {
                Ok(value) => values.push(value),
                Err(why) => failures.push(format!("{}: {why}", row.run)),
            }
        }
        let half_width_95 = MeanTest::of(&values, 0.95).map(|test| test.half_width);
        Ok(IndexState { method, mean: statistics::mean(&values), half_width_95, values, failures })
    }

    /// Void ratio up to the mean surface, or why there is none.
    fn void_ratio(&self, row: &RunRow, out: &Path) -> Result<Result<f64, String>, StudyError> {
        if let Some(why) = row.failure.clone().or_else(|| row.why_left_out()) {
            return Ok(Err(why));
        }
        let folder = folder_of(out, &row.run);
        let file = folder.join("specimen.json");
        let state: SpecimenState = read_json(&file)?;
        let set = read_grains(&run_file(&folder, GRAINS_FILE))?;
        state.check(set.grains.len()).map_err(|e| FileError::unfit(&file, e))?;
        let specimen = Specimen { grains: set.into(), state };
        // Of the polygon's area; as high as it needs to be.
        let container =
            Container { centre_x: 0.0, radius: self.diameter / 2.0, height: 2.0 * self.filled };
        let missing = specimen.grains.grains.len() - container.members(&specimen).len();
        if 20 * missing > specimen.grains.grains.len() {
            let are = in_number(missing, "is", "are");
            return Ok(Err(format!("{} {are} not in the mould", counted(missing, "grain"))));
        }
        let map =
            HeightMap::of(&specimen, &container, height_cell_over(&container, &specimen.grains))
                .map_err(StudyError::measure)?;
        let voids = void_ratio(&specimen, &container, map.standing_height().mean_surface);
        Ok(voids.map(|v| v.void_ratio).ok_or_else(|| "there are no grains".to_owned()))
    }

    /// How far grains of the loosest state sank from where they were let go, in runs that count.
    fn fall(&self, rows: &[RunRow], out: &Path) -> Result<Option<Fall>, StudyError> {
        let mut falls = Vec::new();
        for row in rows.iter().filter(|row| row.variation == "loosest") {
            if self.void_ratio(row, out)?.is_ok() {
                let file = folder_of(out, &row.run).join("summary.json");
                let summary: Summary = read_json(&file)?;
                falls.extend(summary.stages.iter().filter_map(|stage| stage.fall));
            }
        }
        let means: Vec<f64> = falls.iter().map(|fall| fall.mean_mm).collect();
        let largest_mm = falls.iter().map(|fall| fall.largest_mm).reduce(f64::max);
        let mean_mm = statistics::mean(&means);
        Ok(mean_mm.zip(largest_mm).map(|(mean_mm, largest_mm)| Fall { mean_mm, largest_mm }))
    }

    /// By how much specimens grew denser in the second half of their vibration: the void ratio
    /// falls as (1 + e) times the share by which the mean surface sinks.
    fn second_half(
        &self,
        rows: &[RunRow],
        options: &DensityOptions,
        out: &Path,
    ) -> Result<Vec<f64>, StudyError> {
        let mut found = Vec::new();
        for row in rows.iter().filter(|r| r.variation == "densest" && r.failure.is_none()) {
            let Ok(e) = self.void_ratio(row, out)? else { continue };
            let file = folder_of(out, &row.run).join("series.csv");
            let series = series_from_csv(&read_file(&file)?);
            let series = series.map_err(|why| FileError::unfit(&file, why))?;
            let last_stage = series.last().map(|r| r.stage);
            let shaken: Vec<_> = series.iter().filter(|r| Some(r.stage) == last_stage).collect();
            let Some(first) = shaken.first() else { continue };
            let surface = |r: &&SeriesRow| Some((r.time_s - first.time_s, r.mean_surface_mm?));
            let surfaces: Vec<(f64, f64)> = shaken.iter().filter_map(surface).collect();
            let sunk = sunk_in_motion(&surfaces, options.duration_s, mould::ramp_of(options));
            found.extend(sunk.map(|share| (1.0 + e) * share));
        }
        Ok(found)
    }

    fn departures(&self, grains: &GrainSet, options: &DensityOptions) -> Vec<String> {
        let across = self.diameter / self.size;
        vec![
            format!(
                "the mould is {:.0} mm wide, {across:.1} mean grains; {} grains fill it",
                to_mm(self.diameter),
                grains.grains.len()
            ),
            "the surface is not struck off level: volumes reach to the mean surface".to_owned(),
            format!(
                "grains begin at random places over the mould, the sphere around each {:.1} mm \
                 above where it meets one beneath, and {:.1} of them fall at a time on average, \
                 not from a spout that is drawn along the surface",
                to_mm(self.above),
                self.in_the_air()
            ),
            format!(
                "vibrated for {} s at {} Hz and {} mm under {} kPa, where ASTM D4253 asks for 8 minutes \
                 at 60 Hz and 0.33 mm under 13.8 kPa",
                options.duration_s,
                options.frequency_hz,
                options.double_amplitude_mm,
                options.surcharge_kpa
            ),
        ]
    }
}

/// The share by which the surface of a shaken bed sank over half of a vibration: from its mean over
/// the second quarter to that over the last, before the amplitude dies away; of times in s since
/// the vibration began, with heights. Shaken beds heave, and fall together as the table stops: a bed
/// in motion compares with a bed in motion alone.
fn sunk_in_motion(surfaces: &[(f64, f64)], duration_s: f64, ramp_s: f64) -> Option<f64> {
    let mean = |from: f64, to: f64| {
        let within = surfaces.iter().filter(|(time, _)| (from..to).contains(time));
        statistics::mean(&within.map(|(_, surface)| *surface).collect::<Vec<_>>())
    };
    let middle = mean(0.25 * duration_s, 0.5 * duration_s)?;
    let last = mean(0.75 * duration_s, duration_s - ramp_s)?;
    Some(middle / last - 1.0)
}

#[cfg(test)]
mod tests {
    use serde_json::{Value, json};

    use super::*;

    /// Law: slow vibrations grow within a cycle, and those that are short do not; falls and tables
    /// are resolved for sand, too. What cannot be made is said in terms of what was asked.
    #[test]
    fn what_is_asked_for_makes_sound_scenarios() {
        let folder = tempfile::tempdir().expect("a folder");
        let scenario = |name: &str, grains: Value| {
            let path = folder.path().join(name);
            let text =
                json!({ "name": "a", "grains": grains, "stages": [{ "stage": "fill_funnel" }] });
            std::fs::write(&path, text.to_string()).expect("written");
            path
        };
        let grains = |mass: f64, [coarse, fine]: [f64; 2]| {
            json!({ "total_mass_g": mass, "density_kg_per_m3": 2650, "sieve_table":
                [{ "passing_mm": coarse, "retained_mm": fine, "mass_percent": 100 }] })
        };
        let gravel = scenario("gravel.json", grains(100.0, [10.0, 8.0]));
        let sand = scenario("sand.json", grains(0.0063, [0.25, 0.2]));
        let study = |scenario: &Path, frequency_hz: f64, amplitude_mm: f64, duration_s: f64| {
            let options = DensityOptions {
                scenario: scenario.to_owned(),
                changes: Vec::new(),
                configurations: 1,
                surcharge_kpa: 0.0,
                frequency_hz,
                double_amplitude_mm: amplitude_mm,
                duration_s,
            };
            density(options).map(drop).map_err(|e| e.to_string())
        };
        for (frequency, duration) in [(12.0, 8.0), (5.0, 1.0), (1.0, 1.0), (60.0, 1.0)] {
            let got = study(&gravel, frequency, 1.0, duration);
            assert_eq!(got, Ok(()), "law: {frequency} Hz for {duration} s is possible");
        }
        for amplitude in [1.0, 8.0] {
            assert_eq!(study(&sand, 12.0, amplitude, 8.0), Ok(()), "law: sand by {amplitude} mm");
        }
        let told = study(&gravel, 12.0, 1.0, 1.03).expect_err("law: no whole number of cycles");
        assert!(told.starts_with("--seconds: ") && told.contains("found 1.03"), "got `{told}`");
        assert!(!told.contains("--set"), "law: nobody typed the stages, got `{told}`");
        let told = study(&gravel, 12.0, 1.0, 3600.0).expect_err("law: it takes too long");
        assert!(told.starts_with("--seconds: ") && told.contains("too long"), "got `{told}`");
        let few = scenario("few.json", grains(4.0, [10.0, 8.0]));
        let told = study(&few, 12.0, 1.0, 8.0).expect_err("law: too few for a mould");
        let is_of_grains = told.contains("few.json: grains: there are too few grains");
        assert!(is_of_grains && !told.contains("--set"), "law: in the user's terms, got `{told}`");
        assert_eq!(told.matches("too few").count(), 1, "law: it is said once, got `{told}`");
    }

    /// Law: a bed that heaves as much at half time as later on has come to its end, however far it
    /// falls together as the table stops; one that sinks on has not.
    #[test]
    fn a_bed_sinks_on_where_its_surface_falls_in_motion() {
        let (duration, ramp) = (8.0, 0.1);
        let bed = |sinks_by: f64| -> Vec<(f64, f64)> {
            let height = |time: f64| match time < duration {
                true => 62.0 + 2.0 * (std::f64::consts::TAU * 12.0 * time).sin() - sinks_by * time,
                false => 50.0,
            };
            (0..=104).map(|n| 0.08 * f64::from(n)).map(|time| (time, height(time))).collect()
        };
        for (sinks_by, expected) in [(0.0, 0.0), (0.5, 60.52 / 58.54 - 1.0)] {
            let got = sunk_in_motion(&bed(sinks_by), duration, ramp).expect("it is known");
            assert!(
                (got - expected).abs() < 3e-3,
                "law: {sinks_by} mm/s, expected {expected}, got {got}, tolerance 0.003"
            );
        }
        assert_eq!(sunk_in_motion(&bed(0.0), 0.2, ramp), None, "law: too short to know");
    }
}
