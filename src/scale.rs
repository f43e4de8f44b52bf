//! One scale: every length, speed, time and stiffness that is ours follows from
//! the size of the grains and gravity.
//!
//! What falls and collides under gravity is similar at every size when lengths
//! grow with the grain size d, times with √(d/g), speeds with √(g d) and
//! stiffnesses with ρ g d² (Froude's law; contacts then give way by the same
//! share of a grain). A [`Quantity`] is such a number: its value for the paper's
//! gravel, with which it was found, and the law by which it grows. For the
//! paper's gravel every quantity has that value to the last bit.

use std::collections::BTreeMap;

use serde::Serialize;

/// Difference of sums of masses, and of openings, as a fraction of them, that is none.
const ROUNDING: f64 = 1e-9;

/// Sizes of grains in m, as sieves measure them.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct GrainSizes {
    /// Opening of the finest sieve that retains grains.
    pub smallest: f64,
    /// Size than which half of the mass is finer, between two sieves in
    /// proportion to the logarithm of the opening.
    pub median: f64,
    /// Opening of the coarsest sieve that grains pass.
    pub largest: f64,
}

/// Mass between two sieves: openings in m, mass in any unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SieveMass {
    /// Opening of the sieve that the grains pass.
    pub passing: f64,
    /// Opening of the sieve that retains them.
    pub retained: f64,
    /// Their mass.
    pub mass: f64,
}

impl GrainSizes {
    /// The paper's gravel: 15 % from 12.5 to 16 mm, 51.95 % from 10 to 12.5 mm and
    /// 33.05 % from 8 to 10 mm (`scenarios/paper/pluviation.json`).
    pub const PAPER: Self =
        Self { smallest: 0.008, median: 0.010_755_221_034_089_258, largest: 0.016 };

    /// Sizes of grains that are `larger` times as large.
    pub fn times(self, larger: f64) -> Self {
        let Self { smallest, median, largest } = self;
        Self { smallest: smallest * larger, median: median * larger, largest: largest * larger }
    }

    /// Sizes of grains that were sieved; `None` where no fraction has openings and a mass
    /// above zero.
    pub fn of(fractions: &[SieveMass]) -> Option<Self> {
        let mut sound: Vec<&SieveMass> = fractions
            .iter()
            .filter(|f| {
                let all_finite = [f.passing, f.retained, f.mass].iter().all(|x| x.is_finite());
                all_finite && f.retained > 0.0 && f.passing > f.retained && f.mass > 0.0
            })
            .collect();
        sound.sort_by(|a, b| a.retained.total_cmp(&b.retained));
        let half = sound.iter().map(|f| f.mass).sum::<f64>() / 2.0;
        let mut finer = 0.0;
        let median = sound.iter().enumerate().find_map(|(n, f)| {
            let share = (half - finer) / f.mass;
            finer += f.mass;
            // A last digit of the sums must not lead to the other side of a gap.
            let next = sound.get(n + 1);
            let ends = next.is_none_or(|next| next.retained > f.passing * (1.0 + ROUNDING));
            let most = if ends { 1.0 + ROUNDING } else { 1.0 };
            let ratio = f.passing / f.retained;
            (share <= most).then(|| f.retained * ratio.powf(share.clamp(0.0, 1.0)))
        })?;
        let largest = sound.iter().map(|f| f.passing).fold(0.0, f64::max);
        Some(Self { smallest: sound[0].retained, median, largest })
    }
}

/// What our lengths, speeds, times and stiffnesses follow from.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Scale {
    /// Sizes of the grains.
    pub sizes: GrainSizes,
    /// Density of the solids in kg/m³.
    pub density: f64,
    /// Gravitational acceleration in m/s².
    pub gravity: f64,
}

impl Scale {
    /// The paper's gravel on earth (paper, section 3: 2673.9 kg/m³).
    pub const PAPER: Self = Self { sizes: GrainSizes::PAPER, density: 2673.9, gravity: 9.81 };

    /// The paper's gravel enlarged until its smallest grains have a size in m, where
    /// no more is known; gravity in m/s².
    pub fn of_smallest(smallest: f64, gravity: f64) -> Self {
        let paper = GrainSizes::PAPER;
        let sizes = GrainSizes { smallest, ..paper.times(smallest / paper.smallest) };
        Self { sizes, gravity, ..Self::PAPER }
    }
}

/// How a quantity grows with the scale.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Law {
    /// A length, with the smallest grains: d.
    Fine,
    /// A length, with the largest grains: d.
    Coarse,
    /// The inverse of a length, with the smallest grains: 1/d.
    PerLength,
    /// A speed, with the smallest grains: √(g d).
    Speed,
    /// A time, with the smallest grains: √(d/g).
    Time,
    /// A frequency, with the smallest grains: √(g/d).
    Rate,
    /// A stiffness, with the median grains: ρ g d².
    Stiffness,
}

impl Law {
    /// Its value at a scale over that for the paper's gravel, which is exactly 1 there.
    pub fn factor(self, scale: &Scale) -> f64 {
        let paper = Scale::PAPER;
        let finer = scale.sizes.smallest / paper.sizes.smallest;
        let heavier = scale.gravity / paper.gravity;
        match self {
            Self::Fine => finer,
            Self::Coarse => scale.sizes.largest / paper.sizes.largest,
            Self::PerLength => 1.0 / finer,
            Self::Speed => (finer * heavier).sqrt(),
            Self::Time => (finer / heavier).sqrt(),
            Self::Rate => (heavier / finer).sqrt(),
            Self::Stiffness => {
                let denser = scale.density / paper.density;
                (scale.sizes.median / paper.sizes.median).powi(2) * denser * heavier
            }
        }
    }

    /// What it grows with at a scale, in SI units: what makes a quantity a number without
    /// unit when divided by it.
    pub fn unit(self, scale: &Scale) -> f64 {
        let Scale { sizes, density, gravity } = *scale;
        let d = sizes.smallest;
        match self {
            Self::Fine => d,
            Self::Coarse => sizes.largest,
            Self::PerLength => 1.0 / d,
            Self::Speed => (gravity * d).sqrt(),
            Self::Time => (d / gravity).sqrt(),
            Self::Rate => (gravity / d).sqrt(),
            Self::Stiffness => density * gravity * sizes.median.powi(2),
        }
    }

    /// That unit as a formula.
    pub fn formula(self) -> &'static str {
        match self {
            Self::Fine => "d",
            Self::Coarse => "D",
            Self::PerLength => "1/d",
            Self::Speed => "√(g d)",
            Self::Time => "√(d/g)",
            Self::Rate => "√(g/d)",
            Self::Stiffness => "ρ g d₅₀²",
        }
    }
}

/// One of our numbers, which follows from the scale.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quantity {
    /// Its name, with its unit at the end.
    pub name: &'static str,
    /// Its value for the paper's gravel, in SI units.
    pub paper: f64,
    /// How it grows.
    pub law: Law,
    /// What it is, and why it is so large.
    pub why: &'static str,
}

impl Quantity {
    /// Its value at a scale, in SI units.
    pub fn at(&self, scale: &Scale) -> f64 {
        self.paper * self.law.factor(scale)
    }

    /// The same of a limit that must not fall below its value for the paper's gravel.
    pub fn no_less(&self, scale: &Scale) -> f64 {
        self.at(scale).max(self.paper)
    }

    /// Its value over the unit of its law.
    pub fn number(&self) -> f64 {
        self.paper / self.law.unit(&Scale::PAPER)
    }
}

macro_rules! quantities {
    ($($id:ident = $law:ident $paper:literal, $name:literal, $why:literal;)*) => {
        $(
            #[doc = $why]
            pub const $id: Quantity =
                Quantity { name: $name, paper: $paper, law: Law::$law, why: $why };
        )*
        /// All of them, in the order of the page that lists them.
        pub const ALL: &[Quantity] = &[$($id),*];
    };
}

quantities! {
    CONTACT_MARGIN = Fine 0.2e-3, "contact_margin_m",
        "Gap up to which contacts are prepared; more finds contacts without load.";
    CLOSED_GAP = Fine 0.01e-3, "closed_gap_m",
        "Gap up to which a contact without impact counts as closed.";
    UNSOLVED_GAP = Fine 0.02e-3, "unsolved_gap_m",
        "Overlap that a sub-step may add at a contact before the solver iterates further.";
    HYSTERESIS = Fine 0.02e-3, "hysteresis_m",
        "Advantage that a feature of two hulls needs to replace the last one; with 0 specimens \
         sink at rest.";
    HOLD = Fine 0.02e-3, "hold_m",
        "Displacement up to which features are kept without a search.";
    FACE_PREFERENCE = Fine 0.005e-3, "face_preference_m",
        "Advantage that edges need over a face: more than rounding, less than matters as depth.";
    MATCH_DISTANCE = Fine 1e-3, "match_distance_m",
        "Distance within which a contact point is one of the last step.";
    BOX_SLACK = Fine 1e-3, "box_slack_m",
        "Margin of broadphase boxes. Larger: more pairs; smaller: more boxes to renew.";
    BROADPHASE_MARGIN = Fine 0.5e-3, "broadphase_margin_m",
        "Margin of the broadphase's leaves with stock Bullet contacts.";
    RAIN_CLEARANCE = Fine 0.25e-3, "rain_clearance_m",
        "Clearance around bounding spheres of grains placed to fall, more than engines pad shapes \
         by.";
    COLLAR_CLEARANCE = Fine 2e-3, "collar_clearance_m",
        "Clearance between funnel collar and grains placed in it.";
    PLATE_RELEASE = Fine 0.1e-3, "plate_release_m",
        "Release height of the top plate above the highest grain; it lands with 44 mm/s.";
    TOUCHING_GAP = Fine 0.1e-3, "touching_gap_m",
        "Gap up to which grains count as touching: more than the play of contacts at rest.";
    HEIGHT_CELL = Fine 1e-3, "height_cell_m",
        "Cell size of the height map.";
    MERGE_DISTANCE = Fine 1e-6, "merge_distance_m",
        "Length up to which edges of Voronoi cells are merged to a point.";
    BLOCK_GAP = Fine 10e-3, "block_gap_m",
        "Gap between the blocks that grains are cut from, in `grains.json`.";
    RIM_ZONE = Coarse 15e-3, "rim_zone_m",
        "Zone below rims and above openings in which a grain whose centre is out of line may lean \
         on the edge.";
    FALL_BELOW = Coarse 50e-3, "fall_below_m",
        "Distance below the lowest floor up to which grains are followed.";
    FLOOR_THICKNESS = Coarse 20e-3, "floor_thickness_m",
        "Thickness of a pile's floor, without effect.";
    LANDED_AFTER = Time 0.05, "landed_after_s",
        "Time after its fall at which a grain fed to a pile counts as landed.";
    CHECK_INTERVAL = Time 0.02, "check_interval_s",
        "Interval of the run-time checks.";
    SLOW = Speed 0.02, "slow_m_per_s",
        "Speed below which a grain belongs to the pile.";
    CREEP_LIMIT = Speed 5e-6, "creep_limit_m_per_s",
        "Numerical creep that the accuracy standard allows.";
    LARGEST_SPIN = Rate 4000.0, "largest_spin_rad_per_s",
        "Angular speed beyond which a state is unphysical.";
    LARGEST_SPEED = Speed 20.0, "largest_speed_m_per_s",
        "Speed beyond which a state is unphysical; at least the paper's value.";
    LARGEST_DISTANCE = Coarse 20.0, "largest_distance_m",
        "Distance from the cylinder's floor beyond which a state is unphysical; at least the \
         paper's value.";
    HIGHEST_PILE = Coarse 100.0, "highest_pile_m",
        "Upper end of a pile's height map.";
    OVERLAP_INTERVAL = Time 2.0, "overlap_interval_s",
        "Interval of overlap checks; one costs a hundredth of a simulated second.";
    SHORTEST_REST = Time 1.0, "shortest_rest_s",
        "Shortest rest between periods of vibration in which numerical creep is measured.";
    FRAME_EARLY = Time 2e-3, "frame_early_s",
        "How much earlier than due a frame may be recorded: about an engine step.";
}

/// A load on a specimen in grain sizes of solid weight up to which the default stiffness
/// holds: the paper's specimen and plate press with 8.
pub const STRESS_OF_DEFAULT: f64 = 10.0;

/// Most iterations in a sub-step that a load asks for: beyond them those that `solver_tolerance`
/// adds suffice. Below, they grow with the stress as the stiffness does, since a force has the more
/// contacts to go through: with the 8 of the default, 1456 grains that stood 42 layers high between
/// frictionless walls had a numerical creep of 10 to 50 µm/s, with 24 none, in less time.
pub const MOST_ITERATIONS_OF_LOAD: f64 = 40.0;

/// By how much overlaps are pushed apart faster where a load presses more than that. The limit of
/// the speed is one of the force, v (c + h k) with damping c and sub-step h: by default ten times
/// the mean force of a contact under the stress that the stiffness follows from. Grains at the ends
/// of force chains bear more, and would sink into each other without end.
pub const FASTER_UNDER_LOAD: f64 = 10.0;

/// Length of a sub-step under a load, at most, in inertial times d √(ρ/P) of the smallest grains under
/// the largest stress. The moment arms of a contact are those at the beginning of the sub-step; with
/// longer ones grains that bear large forces swing instead of standing, and a specimen sinks without
/// end. Ours: a specimen of 534 grains under 200 kPa lay still with 0.19, and sank with 0.38.
pub const SUBSTEP_OF_INERTIAL_TIME: f64 = 0.2;

/// Share of the settling criterion's root mean square speed with which a pile is at rest. Ours: one
/// grain that still rolls down a flank would else not count among all that are at rest.
pub const RMS_OF_PILE: f64 = 0.25;

/// The same of the largest speed.
pub const LARGEST_OF_PILE: f64 = 0.1;

/// Widest opening of the funnel that is filled in, in cylinder diameters.
pub const OPENING_OF_CYLINDER: f64 = 0.9;

/// Limits of what is typed beside the grains: they are [`Quantity::no_less`] than for the paper's
/// gravel.
const NO_LESS: [Quantity; 2] = [LARGEST_SPEED, LARGEST_DISTANCE];

/// All quantities as a table in Markdown, for `docs/scale.md`.
pub fn table() -> String {
    let mut text =
        "| quantity | for the paper's gravel | law | what it is |\n| --- | --- | --- | --- |\n"
            .to_owned();
    for q in ALL {
        let unit = q.law.formula();
        // Four digits, in plain notation.
        let number: f64 = format!("{:.3e}", q.number()).parse().unwrap_or(f64::NAN);
        text += &format!("| `{}` | {} | {number} {unit} | {} |\n", q.name, q.paper, q.why);
    }
    text
}

/// Reads all quantities at a scale, with what they follow from; in SI units.
pub fn read_back(scale: &Scale) -> BTreeMap<String, f64> {
    let Scale { sizes, density, gravity } = *scale;
    let used = |q: &Quantity| if NO_LESS.contains(q) { q.no_less(scale) } else { q.at(scale) };
    let all = ALL.iter().map(|q| (q.name, used(q))).chain([
        ("smallest_grain_size_m", sizes.smallest),
        ("median_grain_size_m", sizes.median),
        ("largest_grain_size_m", sizes.largest),
        ("density_kg_per_m3", density),
        ("gravity_m_per_s2", gravity),
    ]);
    all.map(|(name, value)| (name.to_owned(), value)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn paper_sieves(larger: f64) -> [SieveMass; 3] {
        [(16.0, 12.5, 15.0), (12.5, 10.0, 51.95), (10.0, 8.0, 33.05)].map(
            |(passing, retained, mass)| SieveMass {
                passing: 1e-3 * passing * larger,
                retained: 1e-3 * retained * larger,
                mass,
            },
        )
    }

    #[test]
    fn the_papers_gravel_is_the_measure() {
        let sizes = GrainSizes::of(&paper_sieves(1.0)).expect("it has sizes");
        assert_eq!(sizes, GrainSizes::PAPER, "law: the constant is what its sieves give");
        for q in ALL {
            let got = q.at(&Scale::PAPER);
            assert_eq!(
                got.to_bits(),
                q.paper.to_bits(),
                "law: {} has its own value, to the bit",
                q.name
            );
        }
    }

    #[test]
    fn quantities_over_their_units_are_the_same_at_every_scale() {
        for (larger, gravity, density) in [(0.1, 9.81, 2673.9), (5.0, 1.62, 2650.0)] {
            let sizes = GrainSizes::of(&paper_sieves(larger)).expect("it has sizes");
            let scale = Scale { sizes, density, gravity };
            for q in ALL {
                let (expected, got) = (q.number(), q.at(&scale) / q.law.unit(&scale));
                assert!(
                    (got / expected - 1.0).abs() < 1e-12,
                    "law: {} is a number without unit; at {larger}: expected {expected}, got {got}, \
                     tolerance 1e-12 of it",
                    q.name
                );
            }
            let stiffness = Law::Stiffness;
            let (expected, got) =
                (stiffness.unit(&scale) / stiffness.unit(&Scale::PAPER), stiffness.factor(&scale));
            assert!((got / expected - 1.0).abs() < 1e-12, "law: ρ g d², {expected}, got {got}");
        }
    }

    #[test]
    fn limits_of_what_is_typed_are_read_back_as_they_are_used() {
        for (larger, speed, distance) in [(1.0 / 16.0, 20.0, 20.0), (25.0, 100.0, 500.0)] {
            let scale = Scale::of_smallest(0.008 * larger, Scale::PAPER.gravity);
            let all = read_back(&scale);
            for (name, expected) in
                [("largest_speed_m_per_s", speed), ("largest_distance_m", distance)]
            {
                let got = all[name];
                assert!(
                    (got / expected - 1.0).abs() < 1e-12,
                    "law: {name} at {larger} times the size: expected {expected}, got {got}"
                );
            }
            let slow = SLOW.at(&scale);
            assert_eq!(all[SLOW.name].to_bits(), slow.to_bits(), "law: others by their law");
        }
    }

    /// Law: where half of the mass is below a gap, the median is where the gap begins, whatever the
    /// masses are that make that half.
    #[test]
    fn last_digits_of_masses_do_not_cross_a_gap() {
        for [b, c, d] in [[20.0, 20.0, 10.0], [17.2, 20.9, 11.9], [10.4, 17.4, 22.2]] {
            let rows = [(16.0, 8.0, 50.0), (4.0, 2.0, b), (2.0, 1.0, c), (1.0, 0.5, d)];
            let sieves = rows.map(|(passing, retained, mass)| SieveMass {
                passing: 1e-3 * passing,
                retained: 1e-3 * retained,
                mass,
            });
            let got = GrainSizes::of(&sieves).expect("it has sizes").median;
            assert!(
                (got / 0.004 - 1.0).abs() < 1e-9,
                "law: half of {b} + {c} + {d} and 50 is finer than 4 mm, got {got} m"
            );
        }
    }

    #[test]
    fn faulty_fractions_have_no_size() {
        let fraction = SieveMass { passing: 0.002, retained: 0.001, mass: 1.0 };
        let one = GrainSizes::of(&[fraction]).expect("it has sizes");
        let middle = (0.001_f64 * 0.002).sqrt();
        assert!((one.median / middle - 1.0).abs() < 1e-12, "law: half-way in the logarithm");
        for bad in [
            SieveMass { passing: 0.001, ..fraction },
            SieveMass { retained: 0.0, ..fraction },
            SieveMass { mass: 0.0, ..fraction },
            SieveMass { mass: f64::NAN, ..fraction },
        ] {
            assert_eq!(GrainSizes::of(&[bad]), None, "{bad:?} has no size");
            assert_eq!(GrainSizes::of(&[bad, fraction]), Some(one), "{bad:?} is left out");
        }
    }
}
