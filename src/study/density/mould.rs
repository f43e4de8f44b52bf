//! The mould that grains fill, and the scenarios that bring them into it.

use super::*;
use crate::plain::grams;
use crate::scale::Law;

/// Height over diameter of the specimen in the mould, about that of the moulds of ASTM D4253.
const SLENDERNESS: f64 = 1.1;
/// Void ratio by which the mould is chosen.
const EXPECTED: f64 = 0.9;
/// Free fall onto the specimen in m: half an inch, ASTM D4254.
const FREE_FALL: f64 = 0.013;
/// How far above the specimen the spheres around grains begin at least, in mean grains: where those
/// reach farther beyond their grains than that fall.
const LEAST_ABOVE: f64 = 0.05;
/// How long a layer one mean grain thick takes to be let go, in units of √(d/g), about two seconds
/// for the paper's grains: some fifty grains in forty times as long as one falls, so that one lands
/// before its neighbours come.
const LAYER_TIME: f64 = 64.0;
/// How many mean grains wide a mould is at least in which walls do not dominate.
const LEAST_ACROSS: f64 = 6.0;
/// How long grains without friction rest, in units of √(d/g), about six seconds for the paper's: they
/// slide on for so long, too slowly for the settling criterion to see.
const SLIPPERY_REST: f64 = 200.0;
/// How much stiffer contacts are where grains are thrown without a surcharge: the shock of a bed that
/// lands makes overlaps, which fall about as the root of the stiffness. Thirty times the usual kept them
/// within the accuracy standard at 8 mm and 12 Hz, not always at 10 mm.
const STIFFER: f64 = 30.0;
/// How long the amplitude of the vibration grows and dies away, in s; a slow one takes a cycle.
const RAMP: f64 = 0.1;
/// Steps in a cycle of the vibration.
const STEPS_PER_CYCLE: f64 = 40.0;

/// The mould, and how grains get into it; lengths in m.
pub(super) struct Mould {
    pub(super) diameter: f64,
    /// Height of the specimen that is expected.
    pub(super) filled: f64,
    /// Mean equivalent diameter of the grains.
    pub(super) size: f64,
    /// Radius of the sphere about the longest grain.
    reach: f64,
    /// From the sphere around a grain that is let go to where it meets one that lies there, so that
    /// grains themselves fall about [`FREE_FALL`] before they touch.
    pub(super) above: f64,
    /// Number of grains.
    count: usize,
    /// Mass of the grains in g.
    mass_g: f64,
    /// √(d/g) in s.
    time: f64,
    /// Size of the smallest grains in m.
    smallest: f64,
    /// m/s²
    gravity: f64,
    /// Stiffness of contacts in N/m that the scenario has.
    stiffness: f64,
}

impl Mould {
    /// That of grains whose contacts have a stiffness in N/m.
    pub(super) fn of(grains: &GrainSet, scale: &Scale, stiffness: f64) -> Self {
        let bulk = (1.0 + EXPECTED) * grains.total_volume();
        let diameter = (4.0 * bulk / (std::f64::consts::PI * SLENDERNESS)).cbrt();
        let count = grains.grains.len();
        let reaches = || grains.grains.iter().map(|g| g.shape.radius_about_origin());
        let mean = |all: f64| all / count.max(1) as f64;
        let size = mean(grains.grains.iter().map(|g| g.equivalent_diameter).sum());
        let beyond = mean(reaches().sum()) - size / 2.0;
        Self {
            diameter,
            filled: SLENDERNESS * diameter,
            size,
            reach: reaches().fold(0.0, f64::max),
            above: (FREE_FALL - 2.0 * beyond).max(LEAST_ABOVE * size),
            count,
            mass_g: to_g(grains.total_mass()),
            time: Law::Time.unit(scale),
            smallest: scale.sizes.smallest,
            gravity: scale.gravity,
            stiffness,
        }
    }

    /// What there is to say of a mould that is narrow for its grains.
    pub(super) fn narrow(&self) -> Option<String> {
        let across = self.diameter / self.size;
        let enough_g = self.mass_g * (LEAST_ACROSS / across).powi(3);
        (across < LEAST_ACROSS).then(|| {
            format!(
                "the mould is {across:.1} mean grains wide: below {LEAST_ACROSS} walls dominate, and \
                 grains may jam in the funnel above it; {} g of such grains make it wide enough",
                grams(enough_g)
            )
        })
    }

    /// How long all grains take to be let go, in s.
    fn pours_for(&self) -> f64 {
        LAYER_TIME * self.time * (self.filled / self.size).max(1.0)
    }

    /// How many grains fall at a time, on average.
    pub(super) fn in_the_air(&self) -> f64 {
        self.count as f64 / self.pours_for() * (2.0 * FREE_FALL / self.gravity).sqrt()
    }

    /// The deposit of all grains, which follows their surface.
    fn deposit(&self) -> Value {
        let pours_for = self.pours_for();
        json!({
            "stage": "deposit",
            "at_mm": [0, 0, rounded_up(self.above + self.reach)],
            "diameter_mm": rounded(self.diameter),
            "above_surface_mm": to_mm(self.above),
            "rate_g_per_s": self.mass_g / pours_for,
            // Grains wait for each other, and settle.
            "time_limit_s": (2.0 * pours_for + 6.0).ceil(),
        })
    }

    /// The scenarios of the three states.
    pub(super) fn variations(&self, options: &DensityOptions) -> Vec<Variation> {
        let set =
            |path: &str, value: Value| Override::new(&path.split('.').collect::<Vec<_>>(), value);
        let cylinder = rounded(self.diameter);
        let height = rounded(1.35 * self.filled + self.reach);
        let piece = json!([{ "name": "mould", "shape": {
            "cylinder": { "inner_diameter_mm": cylinder, "height_mm": height } } }]);
        let area = std::f64::consts::PI / 4.0 * self.diameter * self.diameter;
        let weight_g = 1e3 * 1e3 * options.surcharge_kpa * area / self.gravity;
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
            "duration_s": options.duration_s, "ramp_s": ramp_of(options),
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
        loosest.push(set("stages", json!([self.deposit()])));
        let plated = (options.surcharge_kpa > 0.0).then(|| json!({ "stage": "place_top_plate" }));
        let mut densest =
            built_in(poured.iter().cloned().chain(plated).chain([vibrate.clone()]).collect());
        densest.push(set("engine.rate_hz", json!(self.rate(options, height, &vibrate))));
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

    /// Step rate in Hz of a vibration, given as a stage, in a mould of a height in mm. Where fine
    /// grains that are poured, or the table, would move by more than twice their size in a step, it
    /// is higher.
    fn rate(&self, options: &DensityOptions, height_mm: f64, vibrate: &Value) -> f64 {
        let stage: Option<StageSpec> = serde_json::from_value(vibrate.clone()).ok();
        let shaken = stage.and_then(|stage| stage.motion()).map_or(0.0, |m| m.peak_speed());
        let fall = (2.0 * self.gravity * from_mm(height_mm)).sqrt();
        let resolved = fall.max(shaken) / (2.0 * self.smallest);
        let (frequency, rate) =
            (options.frequency_hz, (STEPS_PER_CYCLE * options.frequency_hz).max(480.0));
        // A cycle takes whole steps.
        if resolved > rate { (resolved / frequency).ceil() * frequency } else { rate }
    }
}

/// How long the amplitude grows and dies away, in s: a cycle at least, and nothing where there is no
/// time for that.
pub(super) fn ramp_of(options: &DensityOptions) -> f64 {
    let ramp = RAMP.max(1.0 / options.frequency_hz);
    if 2.0 * ramp <= options.duration_s { ramp } else { 0.0 }
}

/// A length in mm to a hundredth, no less than it is.
fn rounded_up(length: f64) -> f64 {
    (to_mm(length) * 100.0).ceil() / 100.0
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
    fn the_mould_holds_the_grains_which_begin_just_above_each_other() {
        let grains = gravel();
        let mould = Mould::of(&grains, &Scale::PAPER, 10_000.0);
        let volume = std::f64::consts::PI / 4.0 * mould.diameter.powi(2) * mould.filled;
        let expected = 1.9 * grains.total_volume();
        assert!((volume / expected - 1.0).abs() < 1e-12, "law: e 0.9 fills it, got {volume} m³");
        let deposit = mould.deposit();
        let of = |field: &str| deposit[field].as_f64().expect("a number");
        assert!(deposit.get("mass_g").is_none(), "law: one deposit takes all grains");
        // Of the spheres around two grains, which reach beyond them, and of the fall.
        let reach = |g: &crate::grains::Grain| g.shape.radius_about_origin();
        let beyond = |g: &crate::grains::Grain| reach(g) - g.equivalent_diameter / 2.0;
        let mean = grains.grains.iter().map(beyond).sum::<f64>() / grains.grains.len() as f64;
        let fall = of("above_surface_mm") + to_mm(2.0 * mean);
        assert!(
            (fall - 13.0).abs() < 1e-9,
            "law: balls as large as the grains fall 13 mm, got {fall} mm, tolerance 1e-9"
        );
        let lowest = deposit["at_mm"][2].as_f64().expect("a height");
        let longest = to_mm(grains.grains.iter().map(reach).fold(0.0, f64::max));
        let over = lowest - longest - of("above_surface_mm");
        assert!(
            (0.0..0.011).contains(&over),
            "law: the longest grain begins as far above the floor, got {over} mm more"
        );
        let pours_for = to_g(grains.total_mass()) / of("rate_g_per_s");
        assert!(
            of("time_limit_s") >= 2.0 * pours_for,
            "law: there is time for {pours_for} s of rain, got {} s",
            of("time_limit_s")
        );
        // As wide as the mould is in grains, so many fit side by side.
        let side_by_side = (mould.diameter / mould.size).powi(2);
        assert!(
            mould.in_the_air() < 0.05 * side_by_side,
            "law: few of {side_by_side} that fit side by side fall at a time, got {}",
            mould.in_the_air()
        );
    }

    /// Law: where spheres around large grains reach farther beyond them than the fall, they still
    /// begin above each other.
    #[test]
    fn large_grains_begin_just_above_each_other() {
        let coarse: SievedGrains = serde_json::from_str(
            r#"{ "total_mass_g": 8e5, "density_kg_per_m3": 2650, "sieve_table": [
                 { "passing_mm": 200, "retained_mm": 160, "mass_percent": 100 }] }"#,
        )
        .expect("a sieve table");
        let grains = crate::grains::generate(&coarse, 1).expect("grains");
        let mould = Mould::of(&grains, &Scale::PAPER, 10_000.0);
        let (got, expected) = (mould.above, LEAST_ABOVE * mould.size);
        assert!(
            (got / expected - 1.0).abs() < 1e-12,
            "law: a twentieth of a grain, expected {expected} m, got {got} m, tolerance 1e-12"
        );
    }

    /// Law: the weight of the plate is the surcharge on the area of the mould, whatever gravity is.
    #[test]
    fn a_surcharge_is_the_same_stress_under_another_gravity() {
        let options = DensityOptions {
            scenario: PathBuf::new(),
            changes: Vec::new(),
            configurations: 1,
            surcharge_kpa: 13.8,
            frequency_hz: 60.0,
            double_amplitude_mm: 0.33,
            duration_s: 1.0,
        };
        for gravity in [9.81, 1.62] {
            let scale = Scale { gravity, ..Scale::PAPER };
            let mould = Mould::of(&gravel(), &scale, 10_000.0);
            let variations = mould.variations(&options);
            let densest = variations.iter().find(|v| v.name == "densest").expect("the densest");
            let text = densest.changes.iter().find_map(|c| c.text().strip_prefix("apparatus="));
            let apparatus: Value = serde_json::from_str(text.expect("a mould")).expect("JSON");
            let mass_g = apparatus["top_plate"]["mass_g"].as_f64().expect("a mass");
            let area = std::f64::consts::PI / 4.0 * mould.diameter.powi(2);
            let got = 1e-6 * mass_g * gravity / area;
            assert!(
                (got - 13.8).abs() < 1e-9,
                "law: 13.8 kPa at {gravity} m/s², got {got}, tolerance 1e-9"
            );
        }
    }

    /// Law: few grains make a mould in which walls dominate, which is said with the mass that does
    /// not.
    #[test]
    fn a_narrow_mould_is_said_with_the_mass_that_is_enough() {
        let mould = Mould::of(&gravel(), &Scale::PAPER, 10_000.0);
        let across = mould.diameter / mould.size;
        assert!(across < LEAST_ACROSS, "a hundred grams are few, {across}");
        let enough = 100.0 * (LEAST_ACROSS / across).powi(3);
        let said = mould.narrow().expect("law: it is said");
        let words = [format!("{across:.1} mean grains"), format!("{enough:.1} g of such grains")];
        assert!(words.iter().all(|words| said.contains(words)), "law: {words:?}, got `{said}`");
        let wide = Mould { diameter: 1.01 * LEAST_ACROSS * mould.size, ..mould };
        assert_eq!(wide.narrow(), None, "law: this is wide enough");
    }
}
