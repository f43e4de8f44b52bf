//! Observes and sums up a laboratory of pieces.

use super::*;
use crate::geometry::Pose;
use crate::measure::{Region, steady_rate};
use crate::record::{
    Balance, GroupSummary, LaboratoryNames, LaboratorySeries, LaboratorySummary, OpeningSummary,
    PieceRow, PieceSummary, RegionSummary, of_group,
};
use crate::scenario::{GroupSpec, RegionSpec};
use crate::specimen::{Opening, PieceState, centroids};
use crate::units::to_kpa;

/// Writes rows of what the pieces carry, what flows, and how dense regions are.
#[derive(Debug, Default)]
pub(super) struct LaboratoryRecorder {
    regions: Vec<Region>,
    openings: Vec<Opening>,
    /// Where the pieces are when the laboratory is set up.
    set_up: Vec<Pose>,
    /// Where the grains were when flow was last looked at.
    before: Vec<Option<Vector>>,
    observes: bool,
    grains: Option<Arc<GrainSet>>,
}

impl LaboratoryRecorder {
    /// Of a laboratory; one without pieces writes nothing.
    pub(super) fn new(setup: &Setup) -> Self {
        let measures = &setup.measures;
        Self {
            regions: regions(setup),
            openings: measures.openings.iter().map(crate::protocol::opening).collect(),
            set_up: setup.pieces.iter().map(|piece| piece.at).collect(),
            observes: !setup.pieces.is_empty(),
            ..Self::default()
        }
    }

    pub(super) fn observe(&mut self, specimen: &Specimen, series: &mut LaboratorySeries) {
        if !self.observes {
            return;
        }
        self.grains.get_or_insert_with(|| specimen.grains.clone());
        self.look_at_flow(specimen, series);
        let row = LaboratoryRow {
            pieces: specimen.state.pieces.iter().zip(&self.set_up).map(piece_row).collect(),
            passed_g: std::mem::take(&mut series.pending_g),
            void_ratios: self.regions.iter().map(|r| void_ratio_in(specimen, r)).collect(),
            stresses_kpa: self.regions.iter().map(|r| stress_kpa(specimen, r)).collect(),
        };
        series.rows.push(row);
    }

    /// Adds up what has passed since it last looked.
    pub(super) fn look_at_flow(&mut self, specimen: &Specimen, series: &mut LaboratorySeries) {
        if !self.observes || self.openings.is_empty() {
            return;
        }
        series.pending_g.resize(self.openings.len(), 0.0);
        for (opening, sum) in self.openings.iter().zip(&mut series.pending_g) {
            *sum += to_g(opening.mass_passed(&self.before, specimen));
        }
        self.before = centroids(specimen);
    }

    /// Notes where a grain begins to fall: it may pass an opening before the next look.
    pub(super) fn let_go(&mut self, grain: usize, at: &Vector) {
        if let Some(place) = self.before.get_mut(grain) {
            *place = Some(*at);
        }
    }

    /// Looks at flow where a segment ends, so that a stage that goes on there misses none of it.
    pub(super) fn leg_ends(&mut self, state: &SpecimenState, series: &mut LaboratorySeries) {
        if let Some(grains) = self.grains.clone() {
            self.look_at_flow(&Specimen { grains, state: state.clone() }, series);
        }
    }

    /// Goes on with grains where they are now.
    pub(super) fn go_on(&mut self, specimen: &Specimen) {
        self.before = centroids(specimen);
        self.grains = self.observes.then(|| specimen.grains.clone());
    }
}

/// The regions of a laboratory, in m.
pub(super) fn regions(setup: &Setup) -> Vec<Region> {
    setup.measures.regions.iter().map(crate::protocol::region).collect()
}

/// Stress of a region in kPa, in the order of a row.
fn stress_kpa(specimen: &Specimen, region: &Region) -> Option<[f64; 6]> {
    let tensor = stress_in(specimen, region)?.tensor;
    let components = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    Some(components.map(|at| 1e-3 * tensor[at]))
}

fn piece_row((piece, set_up): (&PieceState, &Pose)) -> Option<PieceRow> {
    piece.present.then(|| PieceRow {
        at_mm: piece.pose.translation.vector.map(to_mm).into(),
        force_n: piece.force_n.into(),
        moment_n_m: piece.moment_n_m.into(),
        pressed: piece
            .press
            .filter(|p| p.turns.is_none())
            .map(|p| [p.force_n, to_kpa(p.force_n / p.area_m2)]),
        turned: piece.press.and_then(|p| Some([p.force_n, p.turns?.turned_rad.to_degrees()])),
        rotation_deg: piece.free.map(|_| {
            let since = piece.pose.rotation * set_up.rotation.inverse();
            since.scaled_axis().map(f64::to_degrees).into()
        }),
    })
}

/// What the columns are named by.
pub(super) fn names(scenario: &Scenario) -> LaboratoryNames {
    let measures = &scenario.measures;
    let number = |name: &String| scenario.pieces.iter().position(|piece| piece.name == *name);
    let numbers = |group: &GroupSpec| group.pieces.iter().filter_map(number).collect();
    LaboratoryNames {
        pieces: scenario.pieces.iter().map(|piece| piece.name.clone()).collect(),
        groups: measures.groups.iter().map(|group| (group.name.clone(), numbers(group))).collect(),
        openings: measures.openings.iter().map(|opening| opening.name.clone()).collect(),
        regions: measures.regions.iter().map(|region| region.name.clone()).collect(),
    }
}

/// The rows of all stages, and those of the rest at the end.
pub(super) fn rows(stages: &[&StoredStage]) -> Vec<LaboratoryRow> {
    stages.iter().flat_map(|stage| stage.record.laboratory.iter().cloned()).collect()
}

/// Sums a laboratory up; none where there are no pieces. `at_end` is the specimen at rest with its
/// loaded contacts.
pub(super) fn laboratory_summary(
    setup: &Setup,
    specimen: &Specimen,
    (at_end, contacts): (&Specimen, &[LoadedContact]),
    (series, rows): (&[SeriesRow], &[LaboratoryRow]),
    rest_test: Option<&StoredStage>,
) -> Option<LaboratorySummary> {
    if setup.pieces.is_empty() {
        return None;
    }
    let rest_test = rest_test.map_or(&[][..], |stage| &stage.record.laboratory);
    let at_rest = match rest_test.len() {
        0 | 1 => &rows[rows.len().saturating_sub(1)..],
        count => &rest_test[count / 2..],
    };
    let mean = |n: usize, of: fn(&PieceRow) -> [f64; 3]| {
        let found = at_rest.iter().filter_map(|row| row.pieces.get(n)?.as_ref());
        let (sum, count) = found.fold((Vector::zeros(), 0.0), |(sum, count), row| {
            (sum + Vector::from(of(row)), count + 1.0)
        });
        if count > 0.0 { sum / count } else { sum }
    };
    let pieces: Vec<PieceSummary> = setup
        .pieces
        .iter()
        .zip(&specimen.state.pieces)
        .enumerate()
        .map(|(n, (piece, state))| PieceSummary {
            name: piece.name.clone(),
            present: state.present,
            force_n: mean(n, |row| row.force_n).into(),
            moment_n_m: mean(n, |row| row.moment_n_m).into(),
            at_mm: state.pose.translation.vector.map(to_mm).into(),
        })
        .collect();
    let means: Vec<Option<PieceRow>> = pieces
        .iter()
        .map(|piece| {
            let PieceSummary { at_mm, force_n, moment_n_m, .. } = *piece;
            let row = PieceRow { at_mm, force_n, moment_n_m, ..PieceRow::default() };
            piece.present.then_some(row)
        })
        .collect();
    let group = |group: &GroupSpec| {
        let number = |name: &String| setup.pieces.iter().position(|piece| piece.name == *name);
        let numbers: Vec<usize> = group.pieces.iter().filter_map(number).collect();
        let together = of_group(&means, &numbers);
        GroupSummary {
            name: group.name.clone(),
            pieces: group.pieces.clone(),
            force_n: together.map_or([0.0; 3], |row| row.force_n),
            moment_n_m: together.map_or([0.0; 3], |row| row.moment_n_m),
            at_mm: together.map(|row| row.at_mm),
        }
    };
    let groups = setup.measures.groups.iter().map(group).collect();
    let mass: f64 = specimen.present().map(|i| specimen.grains.grains[i].mass).sum();
    let force: Vector = pieces.iter().map(|piece| Vector::from(piece.force_n)).sum();
    let balance = balance(mass * setup.gravity, &force);
    let flow = |n: usize| -> Vec<(f64, f64)> {
        let passed = rows.iter().map(|row| row.passed_g.get(n).copied().unwrap_or(0.0));
        series.iter().map(|row| row.time_s).zip(passed).collect()
    };
    let measures = &setup.measures;
    let openings = measures.openings.iter().enumerate().map(|(n, opening)| OpeningSummary {
        name: opening.name.clone(),
        passed_g: flow(n).iter().map(|(_, mass)| mass).sum(),
        rate_g_per_s: steady_rate(&flow(n)),
    });
    let ends = rows.last().map_or(&[][..], |row| &row.void_ratios);
    let regions = measures.regions.iter().zip(regions(setup)).zip(ends);
    let regions = regions.map(|((spec, region), void_ratio)| RegionSummary {
        name: spec.name.clone(),
        void_ratio: *void_ratio,
        relative_density: None,
        stress: stress_in(at_end, &region).map(|stress| StressSummary::of(&stress)),
        fabric: fabric(contacts_of_grains_in(contacts, &region)).map(|f| FabricSummary::of(&f)),
    });
    Some(LaboratorySummary {
        balance,
        openings: openings.collect(),
        regions: regions.collect(),
        groups,
        pieces,
    })
}

/// A warning of each region in which no grain was at any sample: why it has no void ratio.
pub(super) fn never_filled(regions: &[RegionSpec], rows: &[LaboratoryRow]) -> Vec<String> {
    let was_filled =
        |n: usize| rows.iter().any(|row| matches!(row.void_ratios.get(n), Some(Some(_))));
    let never = regions.iter().enumerate().filter(|(n, _)| !rows.is_empty() && !was_filled(*n));
    let warning = |(_, region): (usize, &RegionSpec)| {
        format!(
            "no grain was in the region `{}` at any sample, so it has no void ratio: it may lie \
             away from where grains come",
            region.name
        )
    };
    never.map(warning).collect()
}

/// Weight in N against the force of grains on all pieces in N.
pub(super) fn balance(weight_n: f64, force: &Vector) -> Balance {
    // The sum of no weights is −0.
    let [weight_n, carried_n] = [weight_n, -force.z].map(|force| force + 0.0);
    let difference_percent = (weight_n > 0.0).then(|| 100.0 * (carried_n / weight_n - 1.0));
    Balance { weight_n, carried_n, sideways_n: force.xy().norm(), difference_percent }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: a region in which a grain was once has a void ratio to show; of one in which none ever
    /// was it is said why it has none.
    #[test]
    fn a_region_away_from_all_grains_is_warned_of() {
        let regions = ["filled", "emptied", "far"].map(|name| RegionSpec {
            name: name.to_owned(),
            low_mm: [0.0; 3],
            high_mm: [1.0; 3],
        });
        let row = |void_ratios: [Option<f64>; 3]| LaboratoryRow {
            void_ratios: void_ratios.to_vec(),
            ..LaboratoryRow::default()
        };
        let rows = [row([Some(0.8), Some(0.9), None]), row([Some(0.7), None, None])];
        let got = never_filled(&regions, &rows);
        assert_eq!(got.len(), 1, "law: of one of the three, got {got:?}");
        assert!(got[0].contains("the region `far`"), "law: it is named, got {got:?}");
        assert!(never_filled(&regions, &[]).is_empty(), "law: without a sample nothing is known");
    }

    #[test]
    fn a_balance_tells_what_is_missing() {
        let of = balance(20.0, &Vector::new(3.0, -4.0, -19.0));
        assert_eq!((of.carried_n, of.sideways_n), (19.0, 5.0), "law: down is positive");
        let off = of.difference_percent.expect("a difference");
        assert!((off + 5.0).abs() < 1e-12, "law: 5 % too little, got {off} %");
        let empty = balance(-0.0, &Vector::zeros());
        assert_eq!(empty.difference_percent, None, "law: no grains");
        let signs = [empty.weight_n, empty.carried_n].map(f64::is_sign_negative);
        assert_eq!(signs, [false; 2], "law: nothing is 0, not −0");
    }
}
