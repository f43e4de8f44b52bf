//! Index densities: the loosest and the densest state of a scenario's grains.
//!
//! After ASTM D4254 the loosest state is that of grains that are let fall into a mould from just
//! above what lies in it. The densest is that of grains vibrated vertically, as in ASTM D4253, which
//! does so at 60 Hz and 0.33 mm under 13.8 kPa for 8 minutes: too long to simulate, and in some
//! seconds it moves them little. Grains without any friction, poured, are a bound beside them. The
//! mould is as large as the grains fill; what differs from the standards is said in the result.

use std::path::{Path, PathBuf};

use serde::Serialize;
use serde_json::{Value, json};

use super::{
    RunOptions, StudyError,
    run::make_grains,
    variations::{Variation, Varied, carry_out_variations},
};
use crate::grains::GrainSet;
use crate::grains::load_scenario;
use crate::measure::{
    Container, HeightMap, height_cell, inference::MeanTest, statistics, void_ratio,
};
use crate::record::{FileError, RunRow, read_json, write_json};
use crate::scale::{Law, Scale};
use crate::scenario::Override;
use crate::specimen::{Specimen, SpecimenState};
use crate::units::{to_g, to_mm};

/// Height over diameter of the specimen in the mould, about that of the moulds of ASTM D4253.
const SLENDERNESS: f64 = 1.1;
/// Void ratio by which the mould is chosen.
const EXPECTED: f64 = 0.9;
/// A void ratio that no layer has: grains begin above what would then lie in the mould.
const LOOSER: f64 = 1.15;
/// Free fall onto the specimen in m: half an inch, ASTM D4254.
const FREE_FALL: f64 = 0.013;
const MOST_LAYERS: usize = 60;
/// How long grains without friction rest, in units of √(d/g), about six seconds for the paper's: they
/// slide on for so long, too slowly for the settling criterion to see.
const SLIPPERY_REST: f64 = 200.0;
/// How much stiffer contacts are where grains are thrown without a surcharge: the shock of a bed that
/// lands makes overlaps, which fall about as the root of the stiffness. Thirty times the usual kept them
/// within the accuracy standard at 8 mm and 12 Hz, not always at 10 mm.
const STIFFER: f64 = 30.0;
/// Steps in a cycle of the vibration.
const STEPS_PER_CYCLE: f64 = 40.0;

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
    /// Where to, how many at a time, whom to tell.
    pub run: RunOptions,
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
    /// By how much the vibrated specimens grew denser in the second half of the vibration.
    pub second_half: Vec<f64>,
    /// Where this is not what the standards ask for.
    pub departures: Vec<String>,
}

/// Finds index densities and writes `density.json`. What is stored is not done again.
///
/// # Errors
/// [`StudyError`]. A run that fails or does not count is reported among the failures.
pub fn index_densities(options: &DensityOptions) -> Result<IndexDensities, StudyError> {
    let loaded = load_scenario(&options.scenario, &options.changes)?.scenario;
    if loaded.begin.is_some() {
        let why = "index densities need a scenario with grains of its own, not one that begins \
                   with another run's specimen";
        return Err(StudyError::Scenario(why.to_owned()));
    }
    let grains = make_grains(&loaded)?;
    let stiffness = loaded.engine.native.contact_stiffness_n_per_m;
    let mould = Mould::of(&grains, &loaded.scale(), stiffness);
    let variations = mould.variations(options);
    let varied = Varied::load(&options.scenario, &options.changes, variations)?;
    let rows =
        carry_out_variations(&varied, options.configurations, &options.run, &mut |_| Ok(()))?;
    let state = |name: &str, method: String| mould.state(name, method, &rows, options);
    let DensityOptions { surcharge_kpa, frequency_hz, double_amplitude_mm, duration_s, .. } =
        options;
    let densest = format!(
        "vibrated vertically at {frequency_hz} Hz and {double_amplitude_mm} mm from end to end for \
         {duration_s} s under {surcharge_kpa} kPa"
    );
    let loosest = "let fall one by one from just above what lies in the mould".to_owned();
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
        mould_diameter_mm: to_mm(mould.diameter),
        means: states.map(|of| of.mean),
        intervals: states.map(interval),
        states,
        second_half: mould.second_half(&rows, options)?,
        departures: mould.departures(&grains, options),
    };
    write_json(&options.run.out.join("density.json"), &found)?;
    Ok(found)
}

/// The mould, and how grains get into it; lengths in m.
struct Mould {
    diameter: f64,
    /// Height of the specimen that is expected.
    filled: f64,
    /// Mean equivalent diameter of the grains.
    size: f64,
    /// Radius of the sphere about the longest grain.
    reach: f64,
    /// Mass of the grains in g.
    mass_g: f64,
    /// √(d/g) in s.
    time: f64,
    /// Stiffness of contacts in N/m that the scenario has.
    stiffness: f64,
}

impl Mould {
    fn of(grains: &GrainSet, scale: &Scale, stiffness: f64) -> Self {
        let bulk = (1.0 + EXPECTED) * grains.total_volume();
        let diameter = (4.0 * bulk / (std::f64::consts::PI * SLENDERNESS)).cbrt();
        let sizes = || grains.grains.iter().map(|g| g.equivalent_diameter);
        Self {
            diameter,
            filled: SLENDERNESS * diameter,
            size: sizes().sum::<f64>() / grains.grains.len().max(1) as f64,
            reach: grains.grains.iter().map(|g| g.shape.radius_about_origin()).fold(0.0, f64::max),
            mass_g: to_g(grains.total_mass()),
            time: Law::Time.unit(scale),
            stiffness,
        }
    }

    /// Layers of about one grain.
    fn layers(&self) -> usize {
        ((self.filled / self.size).ceil() as usize).clamp(1, MOST_LAYERS)
    }

    /// Deposits, one a layer, each from as low above the layer as it may be.
    fn deposits(&self) -> Vec<Value> {
        let count = self.layers();
        let layer = self.filled * (1.0 + LOOSER) / (1.0 + EXPECTED) / count as f64;
        let mass_g = self.mass_g / count as f64;
        (1..=count)
            .map(|n| {
                let height = n as f64 * layer + FREE_FALL + self.reach;
                let mut stage = json!({
                    "stage": "deposit",
                    "at_mm": [0, 0, rounded(height)],
                    "diameter_mm": rounded(self.diameter - self.reach),
                    "rate_g_per_s": 4.0 * mass_g,
                    "time_limit_s": 6,
                });
                if n < count {
                    stage["mass_g"] = mass_g.into();
                }
                stage
            })
            .collect()
    }

    fn variations(&self, options: &DensityOptions) -> Vec<Variation> {
        let set =
            |path: &str, value: Value| Override::new(&path.split('.').collect::<Vec<_>>(), value);
        let cylinder = rounded(self.diameter);
        let height = rounded(1.35 * self.filled + self.reach);
        let piece = json!([{ "name": "mould", "shape": {
            "cylinder": { "inner_diameter_mm": cylinder, "height_mm": height } } }]);
        let area = std::f64::consts::PI / 4.0 * self.diameter * self.diameter;
        let weight_g = 1e3 * 1e3 * options.surcharge_kpa * area / 9.81;
        let plate = json!({
            "diameter_mm": rounded(0.98 * self.diameter), "mass_g": weight_g.max(1.0),
        });
        let apparatus = json!({
            "cylinder": { "inner_diameter_mm": cylinder, "height_mm": height },
            "funnel": {
                "opening_diameter_mm": rounded(0.88 * self.diameter),
                "top_diameter_mm": rounded(2.4 * self.diameter),
            },
            "top_plate": plate,
        });
        let poured =
            [json!({ "stage": "fill_funnel" }), json!({ "stage": "pour", "falling_height_mm": 0 })];
        let vibrate = json!({
            "stage": "vibrate", "frequency_hz": options.frequency_hz, "amplitude_mm": 0,
            "vertical": { "amplitude_mm": options.double_amplitude_mm / 2.0 },
            "duration_s": options.duration_s, "ramp_s": 0.1,
        });
        let of = |name: &str, changes| Variation::new(name, "index densities", changes);
        let common = || vec![set("measures", json!({})), set("rest_test_s", json!(0.5))];
        let built_in = |stages: Vec<Value>| {
            let mut changes = common();
            changes.push(set("pieces", json!([])));
            changes.push(set("apparatus", apparatus.clone()));
            changes.push(set("stages", stages.into()));
            changes
        };
        let mut loosest = common();
        loosest.push(set("pieces", piece));
        loosest.push(set("stages", self.deposits().into()));
        let plated = (options.surcharge_kpa > 0.0).then(|| json!({ "stage": "place_top_plate" }));
        let mut densest = built_in(poured.iter().cloned().chain(plated).chain([vibrate]).collect());
        let rate = (STEPS_PER_CYCLE * options.frequency_hz).max(480.0);
        densest.push(set("engine.rate_hz", json!(rate)));
        if options.surcharge_kpa == 0.0 {
            let path = "engine.native.contact_stiffness_n_per_m";
            densest.push(set(path, json!(STIFFER * self.stiffness)));
        }
        let duration_s = (100.0 * SLIPPERY_REST * self.time).round() / 100.0;
        let resting = json!({ "stage": "rest", "duration_s": duration_s });
        let mut frictionless = built_in(poured.iter().cloned().chain([resting]).collect());
        for pair in ["grain_grain", "grain_wall", "grain_plate", "plate_wall"] {
            frictionless.push(set(&format!("contact.{pair}_friction"), json!(0)));
        }
        vec![of("loosest", loosest), of("densest", densest), of("frictionless", frictionless)]
    }

    /// Void ratios of the runs of a variation.
    fn state(
        &self,
        name: &str,
        method: String,
        rows: &[RunRow],
        options: &DensityOptions,
    ) -> Result<IndexState, StudyError> {
        let (mut values, mut failures) = (Vec::new(), Vec::new());
        for row in rows.iter().filter(|row| row.variation == name) {
            match self.void_ratio(row, &options.run.out)? {
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
        let folder = out.join("runs").join(&row.run);
        let file = folder.join("specimen.json");
        let state: SpecimenState = read_json(&file)?;
        let grains = crate::record::run_file(&folder, "grains.json");
        let json = read_json(&grains)?;
        let set = crate::grains::from_json(&json).map_err(|e| FileError::unfit(&grains, e))?;
        state.check(set.grains.len()).map_err(|e| FileError::unfit(&file, e))?;
        let specimen = Specimen { grains: set.into(), state };
        // Of the polygon's area; as high as it needs to be.
        let container =
            Container { centre_x: 0.0, radius: self.diameter / 2.0, height: 2.0 * self.filled };
        let missing = specimen.grains.grains.len() - container.members(&specimen).len();
        if 20 * missing > specimen.grains.grains.len() {
            return Ok(Err(format!("{missing} grains are not in the mould")));
        }
        let map = HeightMap::of(&specimen, &container, height_cell(&specimen.grains))
            .map_err(StudyError::measure)?;
        let voids = void_ratio(&specimen, &container, map.standing_height().mean_surface);
        Ok(voids.map(|v| v.void_ratio).ok_or_else(|| "there are no grains".to_owned()))
    }

    /// By how much specimens grew denser in the second half of their vibration: the void ratio
    /// falls as (1 + e) times the share by which the mean surface sinks.
    fn second_half(
        &self,
        rows: &[RunRow],
        options: &DensityOptions,
    ) -> Result<Vec<f64>, StudyError> {
        let mut found = Vec::new();
        for row in rows.iter().filter(|r| r.variation == "densest" && r.failure.is_none()) {
            let Ok(e) = self.void_ratio(row, &options.run.out)? else { continue };
            let file = options.run.out.join("runs").join(&row.run).join("series.csv");
            let text = crate::record::read_file(&file)?;
            let series = crate::record::series_from_csv(&text)
                .map_err(|why| FileError::unfit(&file, why))?;
            let last_stage = series.last().map(|r| r.stage);
            let shaken: Vec<_> = series.iter().filter(|r| Some(r.stage) == last_stage).collect();
            let Some((first, last)) = shaken.first().zip(shaken.last()) else { continue };
            let half = first.time_s + options.duration_s / 2.0;
            let Some(middle) = shaken.iter().find(|r| r.time_s >= half) else { continue };
            let surfaces = middle.mean_surface_mm.zip(last.mean_surface_mm);
            found.extend(surfaces.map(|(middle, last)| (1.0 + e) * (middle / last - 1.0)));
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
            "grains fall by 13 mm and some more, one by one, not from a spout that is drawn along \
             the surface"
                .to_owned(),
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

/// A length in mm to a hundredth.
fn rounded(length: f64) -> f64 {
    (to_mm(length) * 100.0).round() / 100.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::SievedGrains;

    fn gravel() -> GrainSet {
        let gravel: SievedGrains = serde_json::from_str(
            r#"{ "total_mass_g": 100, "density_kg_per_m3": 2650,
                 "sieve_table": [{ "passing_mm": 10, "retained_mm": 8, "mass_percent": 100 }] }"#,
        )
        .expect("a sieve table");
        crate::grains::generate(&gravel, 1).expect("grains")
    }

    #[test]
    fn the_mould_holds_the_grains_and_the_layers_hold_their_mass() {
        let grains = gravel();
        let mould = Mould::of(&grains, &Scale::PAPER, 10_000.0);
        let volume = std::f64::consts::PI / 4.0 * mould.diameter.powi(2) * mould.filled;
        let expected = 1.9 * grains.total_volume();
        assert!((volume / expected - 1.0).abs() < 1e-12, "law: e 0.9 fills it, got {volume} m³");
        let deposits = mould.deposits();
        assert_eq!(deposits.len(), mould.layers(), "law: a stage a layer");
        assert!(
            deposits.last().is_some_and(|d| d.get("mass_g").is_none()),
            "law: the last takes the rest"
        );
        let heights: Vec<f64> = deposits.iter().filter_map(|d| d["at_mm"][2].as_f64()).collect();
        let layer = to_mm(mould.filled * 2.15 / 1.9 / deposits.len() as f64);
        let (low, expected) = (heights[0] - layer, to_mm(FREE_FALL + mould.reach));
        assert!(
            (low - expected).abs() < 0.02,
            "law: the lowest corner 13 mm above a loose layer, expected {expected} mm, got {low} mm"
        );
        assert!(heights.windows(2).all(|w| w[1] > w[0]), "law: each from higher up");
    }
}
