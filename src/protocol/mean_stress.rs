//! Keeps the mean stress of a region: multiplies the forces on pressed pieces by a common factor.
//!
//! The stress of a frictional packing is in proportion to the forces that confine it, so the
//! factor that would restore the mean stress p to its target p₀ at once is p₀/p. At every look p
//! is smoothed exponentially over a window, and the factor goes so far towards that as the time
//! since the last look is part of the window. Both together are a damped oscillator of the
//! window's frequency and half of the critical damping, as steady as the grains themselves.

use super::*;
use crate::scenario::{KeepMeanStressSpec, RegionSpec};
use crate::specimen::Region;

/// Least and largest factor on the forces: beyond, grains do not take part any more.
const LIMITS: [f64; 2] = [0.1, 10.0];

/// Largest change of the factor from one look to the next, as a share of it. A packing answers
/// within some inertial times d √(ρ/p), 5 ms of 9 mm under 10 kPa: over a look of 20 ms it
/// follows quasi-statically. A dense one at a strain rate of 0.2 s⁻¹ asks for no less.
const LARGEST_CHANGE: f64 = 0.1;

#[derive(Debug, Clone, PartialEq)]
pub(super) struct StressKeeper {
    region: Region,
    name: String,
    /// Numbers of the pieces that keep it.
    pieces: Vec<usize>,
    /// Time in s over which it is smoothed and restored.
    window: f64,
}

/// A mean stress that is kept, and what the forces have become for it.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct KeptStress {
    /// What it is to be, in Pa.
    pub target_pa: f64,
    /// What it is, smoothed, in Pa.
    pub smoothed_pa: f64,
    /// The forces over those with which the stage began.
    pub factor: f64,
    /// Whether the factor has come to a limit.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub limited: bool,
}

/// A region as a scenario has it.
pub fn region(spec: &RegionSpec) -> Region {
    let mm = |place: [f64; 3]| Vector::from(place.map(from_mm));
    Region { low: mm(spec.low_mm), high: mm(spec.high_mm) }
}

impl StressKeeper {
    /// By what a scenario says, for a stage that begins with a specimen.
    ///
    /// # Errors
    /// Why it cannot be kept.
    pub(super) fn of(
        spec: &KeepMeanStressSpec,
        setup: &Setup,
        specimen: &Specimen,
    ) -> Result<(Self, KeptStress), &'static str> {
        let named = setup.measures.regions.iter().find(|region| region.name == spec.region);
        let region = region(named.ok_or("there is no region of that name")?);
        let pieces = setup.numbers(&spec.pieces);
        let pieces = pieces.ok_or("a piece that is to keep a mean stress is not there")?;
        let by_force = |n: &usize| {
            let piece = &specimen.state.pieces[*n];
            piece.present && piece.press.is_some_and(|press| press.turns.is_none())
        };
        if !pieces.iter().all(by_force) {
            return Err("no force presses a piece that is to keep a mean stress");
        }
        let target = region.mean_stress_of(&specimen.state);
        if !(target > 0.0) {
            return Err("nothing is pressed in the region whose mean stress is to be kept");
        }
        let kept =
            KeptStress { target_pa: target, smoothed_pa: target, factor: 1.0, limited: false };
        Ok((Self { region, name: spec.region.clone(), pieces, window: spec.window_s }, kept))
    }

    /// Takes the mean stress of a moment into account, `every` seconds after the look before, and
    /// says what forces the pieces shall have until the next; `began` has those with which the
    /// stage began. What a reader must know is given back.
    pub(super) fn look(
        &self,
        kept: &mut KeptStress,
        began: &[PieceState],
        state: &mut SpecimenState,
        every: f64,
    ) -> Option<String> {
        let is_first = kept.follow(self.region.mean_stress_of(state), every, self.window);
        for &n in &self.pieces {
            let Some(press) = &mut state.pieces[n].press else { continue };
            let Some(before) = began[n].press else { continue };
            press.target_n = before.target_n * kept.factor;
            // It gets there when the next look is taken.
            press.rate_n_per_s = (press.target_n - press.force_n).abs() / every;
        }
        is_first.then(|| {
            format!(
                "the mean stress of `{}` cannot be kept: the forces of its pieces have come to {} \
                 times what they were, the limit",
                self.name, kept.factor
            )
        })
    }
}

impl KeptStress {
    /// Takes a mean stress in Pa into account, found `every` seconds after the one before. Whether
    /// the factor comes to a limit for the first time.
    fn follow(&mut self, found_pa: f64, every: f64, window: f64) -> bool {
        // Where no contact reaches into the region for a moment, nothing is known.
        if !(found_pa > 0.0) {
            return false;
        }
        let share = every / window;
        self.smoothed_pa += (found_pa - self.smoothed_pa) * (1.0 - (-share).exp());
        let change = (self.target_pa / self.smoothed_pa).powf(share.min(1.0));
        let most = 1.0 + LARGEST_CHANGE;
        let wanted = self.factor * change.clamp(1.0 / most, most);
        let [low, high] = LIMITS;
        self.factor = wanted.clamp(low, high);
        let is_first = self.factor != wanted && !self.limited;
        self.limited |= is_first;
        is_first
    }

    /// Whether a stage can go on from it.
    pub(super) fn check(&self) -> Result<(), String> {
        let stresses = [self.target_pa, self.smoothed_pa];
        let [low, high] = LIMITS;
        let sound = stresses.iter().all(|p| *p > 0.0 && p.is_finite());
        match sound && self.factor >= low && self.factor <= high {
            true => Ok(()),
            false => Err("`kept_stress` is no stress that can be kept".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const TARGET: f64 = 10e3;

    fn begun() -> KeptStress {
        KeptStress { target_pa: TARGET, smoothed_pa: TARGET, factor: 1.0, limited: false }
    }

    /// Law: where the stress is in proportion to the forces, and something else doubles or halves
    /// it, it is what it was within a few windows, and stays so.
    #[test]
    fn a_stress_that_follows_the_forces_comes_back() {
        for beside in [0.5, 2.0] {
            let mut kept = begun();
            for _ in 0..100 {
                let found = TARGET * beside * kept.factor;
                assert!(!kept.follow(found, 0.02, 0.1), "law: far from the limits");
            }
            let found = beside * kept.factor;
            assert!((found - 1.0).abs() < 1e-3, "law: p = p₀, got {found} of it");
        }
    }

    #[test]
    fn the_factor_changes_little_at_a_time_and_within_limits() {
        for (found, limit) in [(1e-6 * TARGET, LIMITS[1]), (1e6 * TARGET, LIMITS[0])] {
            let mut kept = begun();
            let mut told = 0;
            for _ in 0..100 {
                let before = kept.factor;
                told += u32::from(kept.follow(found, 0.02, 0.1));
                let change = (kept.factor / before).max(before / kept.factor);
                assert!(
                    change <= 1.0 + LARGEST_CHANGE + 1e-12,
                    "law: 10 % at a time, got {change}"
                );
            }
            assert_eq!((kept.factor, told), (limit, 1), "law: to the limit, which is said once");
        }
    }

    #[test]
    fn where_nothing_is_pressed_nothing_changes() {
        for found in [0.0, -5.0, f64::NAN] {
            let mut kept = begun();
            assert!(!kept.follow(found, 0.02, 0.1));
            assert_eq!(kept, begun(), "law: of {found} Pa nothing follows");
        }
        let mut kept = begun();
        kept.follow(2.0 * TARGET, 1.0, 0.02);
        assert_eq!(kept.factor, 1.0 / 1.1, "law: a window shorter than a look is no fault");
    }

    #[test]
    fn what_no_stage_comes_to_is_refused() {
        assert_eq!(begun().check(), Ok(()));
        for (target_pa, smoothed_pa, factor) in
            [(0.0, 1.0, 1.0), (1.0, f64::NAN, 1.0), (1.0, 1.0, 11.0), (1.0, 1.0, 0.0)]
        {
            let kept = KeptStress { target_pa, smoothed_pa, factor, limited: false };
            assert!(kept.check().is_err(), "law: {kept:?} is none");
        }
    }
}
