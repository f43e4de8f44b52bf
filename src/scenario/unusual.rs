//! What is typed, may be meant, and does not suit the grains: reported, not refused.

use super::validate::short;
use super::*;

/// A typed value is unusual when it is off from the automatic one by more than this factor.
const UNUSUAL: f64 = 4.0;

/// Overlap at the 99th percentile in multiples of σ d₅₀ / k, with the weight over the floor for σ: 1.9,
/// 2.0 and 2.5 with 5, 10 and 20 kN/m, means of twelve pours of 364 grains
/// (docs/results/engines/native-convergence.csv).
const OVERLAP_OF_STRESS: f64 = 2.2;

/// Largest overlap of the accuracy standard at the 99th percentile.
const OVERLAP_ALLOWED: f64 = 0.03;

/// Void ratio of a very loose specimen: more than the cylinder holds then may go over its rim.
const LOOSE: f64 = 1.1;

/// Opening of a funnel or a cylinder in median grain sizes below which it jams now and then.
pub(super) const JAMS_BELOW: f64 = 5.0;

/// Openings of a fraction's sieves, coarser over finer, above which its cells do not spread over it:
/// those of one cube have about one size, whatever its width.
const WIDE: f64 = 2.5;

/// A scenario and what its values are compared with.
struct Judged<'a> {
    engine: &'a EngineSettings,
    /// Its JSON.
    value: &'a Value,
    grading: Option<Grading>,
    scale: Scale,
}

/// What is typed in a scenario, of which `value` is the JSON, and does not suit its grains.
pub(super) fn unusual(scenario: &Scenario, value: &Value) -> Vec<Fault> {
    let grading = scenario.grading();
    let scale = match &grading {
        Some(grading) => grading.scale_for_filling(scenario.gravity_m_per_s2),
        None => scenario.scale(),
    };
    let judged = Judged { engine: &scenario.engine, value, grading, scale };
    let mut found = Vec::new();
    let faults = &mut Faults::of(&mut found);
    for field in BY_SIZE {
        judged.check_field(field, faults);
    }
    judged.check_unread(faults);
    unusual_fractions(scenario, faults);
    if let Some(grading) = grading {
        if !faults.has(STIFFNESS) {
            judged.check_load(&grading, faults);
        }
        judged.check_iterations(&grading, faults);
        judged.check_deposits(&grading, faults);
        unusual_apparatus(scenario, &grading, faults);
        unusual_pieces(scenario, &grading, faults);
        wide_deposits::check(scenario, &grading, faults);
    }
    // The run that they are of has reported them.
    let taken_over = scenario.begin.as_ref().map_or(&[][..], |begin| &begin.taken_over);
    found.retain(|fault| !taken_over.contains(&fault.path));
    found
}

impl Judged<'_> {
    /// What a field is where it is left out; of grains whose sizes are not known, by the law alone.
    fn automatic(&self, field: &BySize) -> f64 {
        let grading = self.grading.as_ref();
        let asked = grading.and_then(|of| by_scenario(field.path, self.value, of, &self.scale));
        let by_law = || field.default_value() * field.law.factor(&self.scale);
        within(field.path, asked.unwrap_or_else(by_law))
    }

    /// A value that is off by more than the factor, in either direction.
    fn check_field(&self, field: &BySize, faults: &mut Faults) {
        let BySize { path, of, low, high, .. } = *field;
        let Some(typed) = number_at(self.value, path) else { return };
        let automatic = self.automatic(field);
        let is_read = of(self.engine) && !self.is_unread(path, typed, automatic);
        let (is_low, is_high) = (typed < automatic / UNUSUAL, typed > automatic * UNUSUAL);
        let goes_wrong = if is_low { low } else { high };
        let allowed = format!("{} for these grains, or the field left out", short(automatic));
        let why = format!(
            "the value differs by more than a factor of {UNUSUAL} from what these grains ask for: \
             {goes_wrong}"
        );
        faults.add_if(is_read && (is_low || is_high), path, short(typed), allowed, why);
    }

    /// Whether contacts do without the distance: native ones go by the shorter of it and their own
    /// margin, Bullet's by a share of the radius where one is typed.
    fn is_unread(&self, path: &str, typed: f64, automatic: f64) -> bool {
        let relative = self.engine.stock.relative_contact_threshold > 0.0;
        let shorter = self.engine.is_native() && typed > automatic;
        path == "engine.contact_threshold_mm" && (relative || shorter)
    }

    /// Grains that would sink into each other by more than the accuracy standard allows.
    fn check_load(&self, grading: &Grading, faults: &mut Faults) {
        let typed = self.engine.native.contact_stiffness_n_per_m;
        let stress = largest_stress(self.value, grading, self.scale.gravity);
        let overlap = OVERLAP_OF_STRESS * stress * self.scale.sizes.median / typed;
        let least = stiffness(self.value, grading, &self.scale);
        let (stress, percent) = (short(stress), short(100.0 * overlap));
        let wrong = self.engine.is_native() && overlap > OVERLAP_ALLOWED;
        let stiffest = within(STIFFNESS, least);
        let allowed = match least > stiffest {
            true => format!(
                "less load, as the field takes {} N/m at most; are sizes and loads in the units \
                 that their fields name?",
                short(stiffest)
            ),
            false => format!("at least {} N/m, or the field left out", short(least)),
        };
        let why = format!(
            "contacts too soft for {stress} Pa at the bottom of the specimen: grains would overlap \
             by some {percent} % of their size"
        );
        faults.add_if(wrong, STIFFNESS, short(typed), allowed, why);
    }

    /// Iterations too few for the loads.
    fn check_iterations(&self, grading: &Grading, faults: &mut Faults) {
        let typed = f64::from(self.engine.native.iterations);
        let automatic = iterations(self.value, grading, &self.scale);
        let wrong = self.engine.is_native() && typed < automatic / UNUSUAL;
        let allowed = format!("{automatic} for these loads, or the field left out");
        let why = format!(
            "less by more than a factor of {UNUSUAL} than what these loads ask for: they are not \
             carried exactly, and the packing creeps numerically"
        );
        faults.add_if(wrong, ITERATIONS, short(typed), allowed, why);
    }

    /// Deposits before the first load that push overlaps apart at another speed than grains without a
    /// load do: one of their own, or the engine's.
    fn check_deposits(&self, grading: &Grading, faults: &mut Faults) {
        if !self.engine.is_native() {
            return;
        }
        let usual = speed_before_a_load(self.value, grading, &self.scale);
        let allowed = format!("{} for these grains", short(usual));
        let of_engine = self.engine.native.max_depenetration_velocity_m_per_s;
        let engine_is_told = faults.has(DEPENETRATION);
        for n in deposits_before_a_load(self.value) {
            let Some(own) = self.value["stages"][n][OWN_SPEED].as_f64() else {
                let wrong = of_engine > usual * UNUSUAL && !engine_is_told;
                let why = format!(
                    "left out, it is that of engine.native, {} m/s, more than {UNUSUAL} times what \
                     these grains ask for before a load: overlaps burst and throw grains apart",
                    short(of_engine)
                );
                faults.add_if(wrong, &own_speed(n), "", &*allowed, why);
                continue;
            };
            let (is_low, is_high) = (own < usual / UNUSUAL, own > usual * UNUSUAL);
            let goes_wrong = match is_low {
                true => "overlaps that impacts leave last",
                false => "overlaps burst and throw grains apart",
            };
            let why = format!(
                "the value differs by more than a factor of {UNUSUAL} from what these grains ask for \
                 before a load: {goes_wrong}"
            );
            faults.add_if(is_low || is_high, &own_speed(n), short(own), &*allowed, why);
        }
    }

    /// Speeds of deposits that only native contacts read.
    fn check_unread(&self, faults: &mut Faults) {
        if self.engine.is_native() {
            return;
        }
        let who = match self.engine.backend {
            Backend::Rapier => "rapier, whose own is engine.rapier.corrective_speed_m_per_s",
            Backend::Bullet => "stock Bullet contacts, which have none",
        };
        let stages = self.value["stages"].as_array().into_iter().flatten().enumerate();
        let typed = stages.filter_map(|(n, stage)| Some((n, stage[OWN_SPEED].as_f64()?)));
        for (n, speed) in typed {
            let allowed = "the field left out, or native contacts on Bullet";
            let why = format!("without effect: this speed is not read by {who}");
            faults.add(&own_speed(n), short(speed), allowed, why);
        }
    }
}

/// Path of the speed at which a deposit pushes overlaps apart.
fn own_speed(stage: usize) -> String {
    format!("stages[{stage}].{OWN_SPEED}")
}

/// Fractions over which cells do not spread; of a run's specimen, that run has reported them.
fn unusual_fractions(scenario: &Scenario, faults: &mut Faults) {
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { return };
    if scenario.begin.is_some() || sieved.shape == SievedShape::Spheres {
        return;
    }
    for (i, fraction) in sieved.sieve_table.iter().enumerate() {
        let SieveFraction { passing_mm, retained_mm, .. } = *fraction;
        let wrong = fraction.has_grains() && passing_mm > WIDE * retained_mm;
        let field = format!("grains.sieve_table[{i}].retained_mm");
        let least = format!("at least {} mm, or spheres", short(passing_mm / WIDE));
        let why = format!(
            "the fraction is too wide for cells: most grains have about its mean size, {} mm, and \
             few are finer; split it",
            short((passing_mm + retained_mm) / 2.0)
        );
        faults.add_if(wrong, &field, short(retained_mm), least, why);
    }
}

/// A cylinder that runs over, or a funnel that jams.
fn unusual_apparatus(scenario: &Scenario, grading: &Grading, faults: &mut Faults) {
    if !scenario.stages.iter().any(|s| s.name() == "pour") {
        return;
    }
    let mut faults = faults.at("apparatus");
    let (cylinder, funnel) = (&scenario.apparatus.cylinder, &scenario.apparatus.funnel);
    let area = PI / 4.0 * from_mm(cylinder.inner_diameter_mm).powi(2);
    let (height, there) = (to_mm(grading.solids * (1.0 + LOOSE) / area), cylinder.height_mm);
    let allowed = format!("at least {} mm", short(height));
    let why = format!(
        "grains may fall over the rim: a specimen with a void ratio of {LOOSE} stands higher than \
         the cylinder"
    );
    faults.add_if(height > there, "cylinder.height_mm", short(there), allowed, why);
    let least = JAMS_BELOW * to_mm(grading.sizes.median);
    let across = cylinder.inner_diameter_mm;
    let jams = "grains may bridge the cylinder or lie over its rim: it is";
    check_opening("cylinder.inner_diameter_mm", across, least, jams, &mut faults);
    let across = funnel.opening_diameter_mm;
    let jams = "the funnel may jam: its opening is";
    check_opening("funnel.opening_diameter_mm", across, least, jams, &mut faults);
}

/// An opening that jams, or nearly does.
fn check_opening(field: &str, across: f64, least: f64, jams: &str, faults: &mut Faults) {
    let message = format!("{jams} narrower than {JAMS_BELOW} median grain sizes");
    let allowed = format!("at least {} mm", short(least));
    faults.add_if(across < least, field, short(across), allowed, message);
}

/// Openings of pieces that jam, and containers that run over.
fn unusual_pieces(scenario: &Scenario, grading: &Grading, faults: &mut Faults) {
    let median = to_mm(grading.sizes.median);
    let least = JAMS_BELOW * median;
    for (i, piece) in scenario.pieces.iter().enumerate() {
        let reach = piece.shape.mesh.as_ref().map_or(f64::INFINITY, MeshPieceSpec::reach_mm);
        let found = format!("corners within {} mm of its origin", short(reach));
        let allowed = format!("more than the median grain size, {} mm", short(median));
        let why = "the mesh is smaller than a grain; of a file in metres `scale_to_mm` is 1000";
        faults.add_if(reach < median, &format!("pieces[{i}].shape.mesh"), found, allowed, why);
        let Some(hopper) = &piece.shape.hopper else { continue };
        let field = format!("pieces[{i}].shape.hopper.opening_diameter_mm");
        let jams = "the hopper may jam: its opening is";
        check_opening(&field, hopper.opening_diameter_mm, least, jams, faults);
    }
    // A floor, a hopper or a ramp beside them may take what does not go in.
    let holds: Vec<f64> = scenario.pieces.iter().filter_map(|p| p.shape.holds_mm3()).collect();
    let (room, needed) = (holds.iter().sum::<f64>(), grading.solids * 1e9 * (1.0 + LOOSE));
    let wrong = !holds.is_empty() && room < needed;
    let [found, least] = [room, needed].map(|mm3| format!("{} cm³", short(mm3 / 1e3)));
    let why = format!(
        "grains may fall over the rims: containers hold less than all grains take with a void \
         ratio of {LOOSE}"
    );
    faults.add_if(wrong, "pieces", found, format!("at least {least}"), why);
}
