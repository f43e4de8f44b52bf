//! From finished stages to `summary.json`.

use super::*;
use super::{
    accuracy::AtEnd,
    described::secondary_sieve,
    laboratory::laboratory_summary,
    standing::{
        Standing, angle_of_repose, empty_beside, heaped_above_rim, height_unless, passed_before,
        pressed_through, wall, withheld_figures, withheld_in_words,
    },
};
use crate::grains::MeshRecord;
use crate::measure::{coordination, touching_gap};
use crate::record::{
    GrainsSummary, RestTest, SecondarySieve, Settlement, ShapeSummary, SieveSummary, Sunk,
    VibrationSummary, mean_drop_mm,
};
use crate::scenario;

/// Times in s that differ by less are the same.
const ROUNDING: f64 = 1e-9;

/// A finished run: its summary, its specimen and its series.
pub struct Summarised {
    /// The figures.
    pub summary: Summary,
    /// The specimen at the end of the last stage.
    pub specimen: Specimen,
    /// What became of each of its grains, by which the summary counts them.
    pub fates: Vec<Fate>,
    /// All rows, stage by stage.
    pub series: Vec<SeriesRow>,
    /// What a laboratory of pieces was at each of the rows; none without pieces.
    pub laboratory: Vec<LaboratoryRow>,
    /// The rows of the rest test.
    pub rest_test: Vec<SeriesRow>,
    /// Void ratio by height and by radius at the end.
    pub void_profile: Vec<ProfileRow>,
}

/// Puts a run's stages together and measures its end.
pub fn summarise(
    run: &PlannedRun,
    setup: &Setup,
    nodes: &RunNodes,
    done: &[Arc<StoredStage>],
) -> Result<Summarised, StudyError> {
    let scenario = &run.scenario;
    let stages: Vec<&StoredStage> = nodes.stages.iter().map(|&n| &*done[n]).collect();
    let rest_test = nodes.rest_test.map(|n| &*done[n]);
    let specimen = inside::at_end(&run.grains, &stages);
    let container = container(setup, &specimen);
    let series = series(&stages, setup);
    let rest_rows = rest_test.map_or_else(Vec::new, |stage| rows(stage, setup));
    let known = described(&run.grains);
    let median = known.sieved.size_at_percent(50.0);
    let end = Standing::of(&specimen, &container, median, is_poured(&specimen.state))?;
    let poured = scenario
        .stages
        .iter()
        .zip(&stages)
        .find(|(spec, _)| matches!(spec, StageSpec::Pour { .. }))
        .map(|(_, stage)| {
            let poured = Specimen { grains: run.grains.clone(), state: stage.state.clone() };
            Standing::of(&poured, &self::container(setup, &poured), median, true)
        })
        .transpose()?;

    let surface_m = end.surface();
    let members = match setup.pieces.is_empty() {
        true => container.members(&specimen),
        false => specimen.present().collect(),
    };
    let pairs = pairs_within(&specimen, &members, touching_gap(&specimen.grains));
    let overlaps = overlap_statistics(&specimen, &pairs);
    let overlap = match members.is_empty() {
        true => Overlap::of_none(),
        false => Overlap {
            pairs: overlaps.overlapping,
            mean_percent: 100.0 * overlaps.mean,
            p99_percent: 100.0 * overlaps.p99,
            max_percent: 100.0 * overlaps.max,
            max_mm: to_mm(overlaps.max_depth),
        },
    };
    let specs = || scenario.stages.iter().zip(stages.iter().copied());
    let shaken: Vec<[f64; 2]> = specs().flat_map(|(spec, stage)| periods(spec, stage)).collect();
    let surface = settlement(&series, &shaken, |r| r.mean_surface_mm)?;
    // A plate may be laid after a vibration, which cannot have made it settle.
    let with_plate = specs().filter(|(_, stage)| begins_with_plate(stage));
    let shaken: Vec<[f64; 2]> = with_plate.flat_map(|(spec, stage)| periods(spec, stage)).collect();
    let plate = settlement(&series, &shaken, |r| r.plate_height_mm)?;
    let plate_tilt = shaken.last().and_then(|[_, end]| tilt::plate_tilt(&series, end + ROUNDING));
    let sunk = rest_test.map_or(&[][..], |stage| &stage.record.sunk);
    let rest_test_figures = self::rest_test(&rest_rows, sunk);
    let creep = checks::creep_um_per_s(&rest_rows, sunk).filter(|_| !members.is_empty());
    let all = stages.iter().copied().chain(rest_test);
    let mut warnings: Vec<String> =
        all.clone().flat_map(|s| s.record.warnings.iter().cloned()).collect();
    warnings.extend(scenario::warnings(scenario));
    warnings.extend(lids::too_wide(scenario));
    warnings.extend(of_grains(scenario, &run.grains));
    let settled = plate_tilt.zip(plate.as_ref()).zip(surface.as_ref());
    warnings
        .extend(settled.and_then(|((lies, plate), surface)| tilt::warning(lies, plate, surface)));
    warnings.extend(MeshRecord::notes(&run.grains.meshes));
    let angle_of_repose = angle_of_repose(&specimen)?.transpose().unwrap_or_else(|why| {
        warnings.push(format!("there is no angle of repose: {why}"));
        None
    });
    let standard = standard(&setup.scale);
    let at_end = AtEnd {
        grains: members.len(),
        overlap: (!pairs.is_empty()).then_some(&overlap),
        creep_um_per_s: creep,
    };
    let meets_standard = at_end.meets(&standard);
    if !meets_standard {
        warnings.extend(at_end.shortcomings(&standard, &scenario.engine));
    }
    let numbered = stages.iter().enumerate();
    let ends = numbered.map(|(n, stage)| (format!("stage {n}, {}", stage.record.stage), *stage));
    let of_rest_test = rest_test.map(|stage| ("the rest test".to_owned(), stage));
    let pressed = pressed_through(&run.grains, ends.chain(of_rest_test), setup);
    warnings.extend(pressed.warning());
    let records: Vec<&StageRecord> = all.clone().map(|s| &s.record).collect();
    let begun = nodes.begun.as_ref();
    let before = begun.map_or(0, |begun| passed_before(&begun.state));
    if before > 0 {
        warnings.push(format!(
            "grains had passed through a wall or the floor before the run began with its specimen: \
             {before}"
        ));
    }
    let checks = checks::of_run(records.iter().copied(), pressed.grains + before);
    if let Some(g) = checks.solver_residual.as_ref().filter(|g| g.passed == Some(false)) {
        warnings.push(format!(
            "the contacts were not solved well enough: the 99th percentile of the residual is \
             {:.3}, limit {:.3}; a smaller solver_tolerance or more sub-steps would help",
            g.worst.unwrap_or(f64::NAN),
            g.limit.unwrap_or(f64::NAN)
        ));
    }
    let laboratory_rows = super::laboratory::rows(&stages);
    warnings.extend(super::laboratory::never_filled(&setup.measures.regions, &laboratory_rows));
    let at_rest = inside::AtRest::of(setup, &specimen, rest_test);
    let end_of = (&at_rest.specimen, &at_rest.contacts[..]);
    let relative = |e: Option<f64>| Some(scenario.index_densities.as_ref()?.relative_density(e?));
    let beyond = |of: &str, e: Option<f64>| scenario.index_densities.as_ref()?.beyond(of, e?);
    warnings.extend(beyond("the specimen", end.void_ratio));
    let both = (&series[..], &laboratory_rows[..]);
    let mut laboratory = laboratory_summary(setup, &specimen, end_of, both, rest_test);
    let mut withheld = withheld_figures(&end, poured.as_ref());
    let boxes = super::laboratory::regions(setup);
    let summaries = laboratory.iter_mut().flat_map(|laboratory| &mut laboratory.regions);
    for (region, of) in summaries.zip(boxes) {
        region.relative_density = relative(region.void_ratio);
        let empty = || empty_beside(&specimen, &of, setup.scale.sizes.median);
        match (region.void_ratio.and_then(|_| empty()), region.relative_density) {
            (None, _) => warnings.extend(beyond(&format!("`{}`", region.name), region.void_ratio)),
            (Some(reason), Some(_)) => {
                region.relative_density = None;
                let field = format!("laboratory.regions.{}.relative_density", region.name);
                withheld.push(Withheld { field, reason });
            }
            (Some(reason), None) => warnings.push(format!(
                "the void ratio of the region `{}` counts empty space at the end: {reason}",
                region.name
            )),
        }
    }
    let coordination = coordination(&members, &pairs);
    let specified = run.grains.specified();
    let mut sieve = SieveSummary::of(&known.sieved, specified.as_ref());
    sieve.secondary = stages
        .last()
        .and_then(|last| secondary_sieve(&known.sieved, &specimen.state, &last.record));
    warnings.extend(sieve.secondary.as_ref().and_then(SecondarySieve::warning));
    let fates = fates_of(&specimen, &container, setup);
    let grains = grains_summary(&run.grains, &specimen, &container, &fates);
    let beside = || fallen::beside_container(scenario, &run.grains, &stages);
    let missing = grains.missing.or_else(beside);
    let heaped_above_rim = heaped_above_rim(scenario, setup, &specimen.state);
    let grains = GrainsSummary { missing, heaped_above_rim, ..grains };
    warnings.extend(grains.too_few_in_place(laboratory.is_some()));
    warnings.extend(fallen::unexplained(scenario, nodes.begun.as_deref(), &stages, rest_test));
    warnings.extend(withheld_in_words(&withheld));
    let summary = Summary {
        scenario: scenario.name.clone(),
        backend: crate::world::info(scenario.engine.backend),
        contact_solver: scenario.engine.solver_name().to_owned(),
        seed: scenario.seed,
        configuration: scenario.configuration,
        falling_height_mm: scenario.falling_height_mm(),
        grains,
        sieve_analysis: Some(sieve),
        shape: ShapeSummary::of(&known.shapes),
        withheld,
        standing_height_mm: height_unless(end.height, end.no_height.as_deref()),
        poured_height_mm: poured.as_ref().filter(|p| p.no_height.is_none()).map(|p| p.height),
        void_ratio: end.void_ratio,
        relative_density: relative(end.void_ratio),
        poured_void_ratio: poured.as_ref().and_then(|p| p.void_ratio),
        porosity: end.porosity,
        settlement_mm: plate,
        surface_settlement_mm: surface,
        plate_tilt_deg: plate_tilt,
        vibrations: vibrations(&scenario.stages, &stages, setup),
        angle_of_repose,
        laboratory,
        overlap,
        core: inside::core(setup, &at_rest, &container, surface_m)
            .filter(|_| end.void_ratio.is_some()),
        coordination_number: coordination.mean.unwrap_or(f64::NAN),
        coordination_distribution: coordination.distribution,
        contacts: at_rest.summary(setup),
        stages: inside::stage_summaries(
            &scenario.stages,
            &stages,
            begun.map(|begun| &begun.state),
            setup,
        ),
        begun_settling: begun.and_then(|begun| begun.record.settling),
        creep_um_per_s: creep,
        rest_test: rest_test_figures,
        meets_standard,
        valid: false,
        left_out_of_means: Vec::new(),
        checks: Some(checks),
        solver_residual: SolverResidual::of(
            all.clone().flat_map(|s| s.record.solver_residuals.iter().copied()),
        ),
        kinetic_energy_j: series.last().map_or(0.0, |r| r.kinetic_energy_j),
        simulated_s: all.clone().map(|s| s.record.simulated_s).sum(),
        steps: all.clone().map(|s| s.record.steps).sum(),
        wall_s: all.clone().map(|s| s.record.wall_s).sum(),
        engine_s: all.map(|s| s.record.engine_s).sum(),
        peak_memory_mib: peak_memory_mib(),
        warnings,
    }
    .judged();
    let void_profile = inside::void_profile(setup, &specimen, &container, surface_m);
    Ok(Summarised {
        summary,
        fates,
        series,
        laboratory: laboratory_rows,
        rest_test: rest_rows,
        void_profile,
        specimen,
    })
}

fn series(stages: &[&StoredStage], setup: &Setup) -> Vec<SeriesRow> {
    let numbered = |(number, stage): (usize, &&StoredStage)| {
        let rows = rows(stage, setup).into_iter();
        rows.map(move |row| SeriesRow { stage: number as u32, ..row })
    };
    stages.iter().enumerate().flat_map(numbered).collect()
}

/// Rows of a stage. One of a laboratory says 0 of the mean surface where it was stored when rows
/// still gave every stage one.
fn rows(stage: &StoredStage, setup: &Setup) -> Vec<SeriesRow> {
    let has_surface = setup.pieces.is_empty();
    let row = |row: &SeriesRow| SeriesRow {
        mean_surface_mm: row.mean_surface_mm.filter(|_| has_surface),
        mean_grain_height_mm: height_of_grains(row),
        ..*row
    };
    stage.series.iter().map(row).collect()
}

/// Mean height of the grains in mm; stored rows say 0 of that of no grain, as before the first has
/// fallen into the cylinder.
fn height_of_grains(row: &SeriesRow) -> Option<f64> {
    row.mean_grain_height_mm.filter(|mm| row.grains_in_cylinder > 0 || *mm != 0.0)
}

/// Beginning and end of each period of a stage's vibration, in the run's time.
fn periods(spec: &StageSpec, stage: &StoredStage) -> Vec<[f64; 2]> {
    let (Some(motion), Some(first)) = (spec.motion(), stage.series.first()) else {
        return Vec::new();
    };
    // The last sample may lie half a step before the stated end.
    let last = stage.series.last().map_or(first.time_s, |r| r.time_s);
    let period = |end: &f64| [first.time_s + end - motion.duration, (first.time_s + end).min(last)];
    motion.period_ends().iter().map(period).collect()
}

/// Whether the plate lay on the grains when a stage began.
fn begins_with_plate(stage: &StoredStage) -> bool {
    stage.series.first().is_some_and(|row| row.plate_height_mm.is_some())
}

/// What was vibrated, when, how, and how it came to rest.
fn vibrations(
    specs: &[StageSpec],
    stages: &[&StoredStage],
    setup: &Setup,
) -> Vec<VibrationSummary> {
    let vibrated = specs.iter().zip(stages).enumerate().filter_map(|(n, (spec, stage))| {
        Some(VibrationSummary {
            stage: n as u32,
            periods_s: periods(spec, stage),
            motion: motions::of_table(spec, setup)?,
            settling: stage.record.settling,
        })
    });
    vibrated.collect()
}

fn settlement(
    series: &[SeriesRow],
    periods: &[[f64; 2]],
    height_mm: impl Fn(&SeriesRow) -> Option<f64>,
) -> Result<Option<Settlement>, StudyError> {
    let Some([start, _]) = periods.first() else { return Ok(None) };
    let heights: Vec<(f64, f64)> = series
        .iter()
        .filter(|r| r.is_shaken())
        // The sum that gave the start may be a rounding above the first row's time.
        .filter(|r| r.time_s >= start - ROUNDING)
        .filter_map(|r| Some((r.time_s, from_mm(height_mm(r)?))))
        .collect();
    if heights.is_empty() {
        return Ok(None);
    }
    let s = measure::settlement(&heights, periods).map_err(StudyError::measure)?;
    Ok(Some(Settlement {
        final_mm: to_mm(s.at_end),
        end_of_shaking: Some(to_mm(s.end_of_shaking)),
        after_5_s: s.after_5_s.map(to_mm),
        share_after_5_s: s.share_after_5_s,
        after_each_period: s.after_each_period.into_iter().map(to_mm).collect(),
    }))
}

fn rest_test(series: &[SeriesRow], sunk: &[Sunk]) -> Option<RestTest> {
    let (first, last) = (series.first()?, series.last()?);
    let duration_s = last.time_s - first.time_s;
    let drop = |of: fn(&SeriesRow) -> Option<f64>| Some(of(first)? - of(last)?);
    (duration_s > 0.0).then(|| RestTest {
        duration_s,
        mean_grain_height_drop_mm: mean_drop_mm(first, last, sunk),
        mean_surface_drop_mm: drop(|row| row.mean_surface_mm),
        plate_drop_mm: drop(|row| row.plate_height_mm),
    })
}

/// Whether a specimen was poured into the cylinder, by a stage of the run or before it began: only
/// a pour puts the cylinder up.
fn is_poured(state: &SpecimenState) -> bool {
    state.cylinder
}

/// What became of each grain, by which summary and tables count them. In a laboratory of named
/// pieces, which has no cylinder, it is what its stages saw.
fn fates_of(specimen: &Specimen, container: &Container, setup: &Setup) -> Vec<Fate> {
    match specimen.state.pieces.is_empty() {
        true => fates(specimen, container, wall(setup)),
        false => specimen.state.bodies.iter().map(|grain| grain.fate).collect(),
    }
}

fn grains_summary(
    grains: &GrainSet,
    specimen: &Specimen,
    container: &Container,
    fates: &[Fate],
) -> GrainsSummary {
    let state = &specimen.state;
    let mass_inside = match state.pieces.is_empty() {
        true => measure::content(specimen, container).mass,
        false => specimen.present().map(|i| grains.grains[i].mass).sum(),
    };
    let count = |counted: &[Fate]| fates.iter().filter(|fate| counted.contains(fate)).count();
    let (in_cylinder, spilled) = (count(&[Fate::Present]), count(&[Fate::Spilled]));
    // By what stands: a run may have begun with a specimen that was poured, or piled up, before.
    let poured = match &state.base {
        // What rolls off the base was part of the pile.
        Some(_) => Some(in_cylinder + spilled),
        None => is_poured(state).then_some(in_cylinder),
    };
    GrainsSummary {
        count: grains.grains.len(),
        mass_g: to_g(grains.grains.iter().map(|g| g.mass).sum()),
        solids_volume_cm3: to_cm3(grains.grains.iter().map(|g| g.volume).sum()),
        in_cylinder,
        // The sum of no masses is −0.
        mass_in_cylinder_g: to_g(mass_inside) + 0.0,
        escaped: count(&[Fate::ThroughWall]),
        spilled,
        left_in_funnel: count(&[Fate::LeftInFunnel, Fate::Waiting]),
        heaped_above_rim: None,
        missing: poured.map(|there| grains.grains.len().saturating_sub(there)),
    }
}

/// Peak memory of this process in MiB; 0 where the system does not tell.
pub fn peak_memory_mib() -> f64 {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    status
        .lines()
        .find_map(|line| line.strip_prefix("VmHWM:"))
        .and_then(|rest| rest.split_whitespace().next()?.parse::<f64>().ok())
        .map_or(0.0, |kib| kib / 1024.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time_s: f64, plate_height_mm: f64) -> SeriesRow {
        SeriesRow {
            time_s,
            stage: 3,
            plate_height_mm: Some(plate_height_mm),
            settlement_mm: Some(178.0 - plate_height_mm),
            ..SeriesRow::default()
        }
    }

    /// Law: no grain has no mean height; those in the funnel have one though the cylinder is empty.
    #[test]
    fn no_grain_has_no_mean_height() {
        let of = |mm: f64, grains_in_cylinder: u32| {
            let mean_grain_height_mm = Some(mm);
            let row =
                SeriesRow { mean_grain_height_mm, grains_in_cylinder, ..SeriesRow::default() };
            height_of_grains(&row)
        };
        assert_eq!(of(0.0, 0), None, "law: the pour has begun, and nothing has fallen in");
        assert_eq!(of(204.8, 0), Some(204.8), "law: all grains, in the funnel");
        assert_eq!(of(31.1, 249), Some(31.1), "law: those in the cylinder");
    }

    #[test]
    fn the_first_row_counts_though_the_period_seems_to_begin_a_rounding_later() {
        // A vibration that began at 2.58333… s was measured from its second row on, 2.3 mm short.
        let first = 2.583_333_333_333_333_5_f64;
        let start = f64::from_bits(first.to_bits() + 2);
        let rows = [row(first, 178.0), row(first + 0.08, 175.7), row(first + 5.0, 163.0)];
        let periods = [[start, first + 5.0]];
        let got = settlement(&rows, &periods, |r| r.plate_height_mm)
            .expect("it can be measured")
            .expect("it was vibrated")
            .final_mm;
        assert!(
            (got - 15.0).abs() < 1e-9,
            "law: settlement = height at the beginning - height at the end, expected 15 mm, got \
             {got} mm, tolerance 1e-9 mm"
        );
    }
}
