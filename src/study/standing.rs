//! How a specimen stands: its height and void ratio, and why they are withheld; a pile's angle of
//! repose; and grains that something pressed through a floor or a wall.

use super::*;
use crate::measure::{grains_span, pile_surface};
use crate::record::{AngleOfRepose, AzimuthAngle, StandingHeight};
use crate::specimen::Region;

/// Standing height and void ratio of a specimen.
pub(super) struct Standing {
    /// Its heights in mm.
    pub height: StandingHeight,
    /// Why the height is withheld.
    pub no_height: Option<String>,
    /// Why void ratio and porosity are withheld.
    pub no_voids: Option<String>,
    /// Void ratio up to the mean surface.
    pub void_ratio: Option<f64>,
    /// Porosity, likewise.
    pub porosity: Option<f64>,
}

impl Standing {
    /// Of a specimen that was poured into a cylinder, or was not; the median sieve size of its
    /// grains in m.
    pub(super) fn of(
        specimen: &Specimen,
        container: &Container,
        median: f64,
        is_poured: bool,
    ) -> Result<Self, StudyError> {
        let height =
            HeightMap::of(specimen, container, height_cell_over(container, &specimen.grains))
                .map_err(StudyError::measure)?
                .standing_height();
        // A pile has no walls that its voids could be counted within; of a laboratory the void
        // ratio is that of its regions.
        let has_walls = specimen.state.base.is_none() && specimen.state.pieces.is_empty();
        let voids =
            has_walls.then(|| void_ratio(specimen, container, height.mean_surface)).flatten();
        let inside = container.members(specimen).len();
        let no_height = match inside {
            _ if is_poured => no_height(inside, specimen.grains.grains.len()),
            _ if has_walls => Some("nothing has been poured into the cylinder".to_owned()),
            0 if !specimen.state.pieces.is_empty() => {
                Some("no grain is left above z = 0".to_owned())
            }
            _ => None,
        };
        let no_voids = no_height
            .clone()
            .filter(|_| has_walls && is_poured)
            .or_else(|| voids.and_then(|_| no_voids(height.mean_surface, median)));
        let voids = voids.filter(|_| no_voids.is_none());
        Ok(Self {
            no_height,
            no_voids,
            height: StandingHeight {
                mean_surface: to_mm(height.mean_surface),
                p95: to_mm(height.p95),
                highest: to_mm(height.highest),
            },
            void_ratio: voids.map(|v| v.void_ratio),
            porosity: voids.map(|v| v.porosity),
        })
    }

    /// Height of the mean surface in m; 0 where it is withheld.
    pub(super) fn surface(&self) -> f64 {
        if self.no_height.is_some() { 0.0 } else { from_mm(self.height.mean_surface) }
    }
}

/// What is not given of the end and of the end of pouring.
pub(super) fn withheld_figures(end: &Standing, poured: Option<&Standing>) -> Vec<Withheld> {
    let fields = [
        ("standing_height_mm", end.no_height.as_ref()),
        ("void_ratio", end.no_voids.as_ref()),
        ("porosity", end.no_voids.as_ref()),
        ("poured_height_mm", poured.and_then(|p| p.no_height.as_ref())),
        ("poured_void_ratio", poured.and_then(|p| p.no_voids.as_ref())),
    ];
    let of = |(field, why): (&str, Option<&String>)| {
        Some(Withheld { field: field.to_owned(), reason: why?.clone() })
    };
    fields.into_iter().filter_map(of).collect()
}

/// What is not given, in sentences: a reason that several figures have stands once.
pub(super) fn withheld_in_words(withheld: &[Withheld]) -> Vec<String> {
    let by_reason = grouped(withheld.iter().map(|of| (of.reason.as_str(), of.field.as_str())));
    let said = |(reason, fields): (&str, Vec<&str>)| {
        let are = if fields.len() == 1 { "is" } else { "are" };
        format!("{} {are} withheld: {reason}", fields.join(", "))
    };
    by_reason.into_iter().map(said).collect()
}

/// Share of the grains that must lie in the cylinder for a height to be that of the specimen.
/// Ours: of fewer a height tells how many came, not how they lie. Far below the share that a run
/// needs to count in means ([`crate::record::MOST_MISSING`]).
const LEAST_PRESENT: f64 = 0.5;

/// Why heights of a poured specimen are no heights of it; none where they are. `inside` grains
/// of `count` lie in the cylinder.
fn no_height(inside: usize, count: usize) -> Option<String> {
    ((inside as f64) < LEAST_PRESENT * count as f64).then(|| {
        let lie = in_number(inside, "lies", "lie");
        let are = in_number(inside, "it is", "they are");
        let of = counted(count, "grain");
        format!("only {inside} of {of} {lie} in the cylinder: {are} not the specimen")
    })
}

/// Why the density of the grains in a region is not that of its void ratio; none where it is. More
/// than a median grain, a size in m, of empty space on a side of them is no void between grains.
pub(super) fn empty_beside(specimen: &Specimen, region: &Region, median: f64) -> Option<String> {
    let grains = grains_span(specimen, region)?;
    let (before, behind) = (grains.low - region.low, region.high - grains.high);
    let sides = [
        (before.x, "beyond the outermost grain in it towards -x"),
        (behind.x, "beyond the outermost grain in it towards +x"),
        (before.y, "beyond the outermost grain in it towards -y"),
        (behind.y, "beyond the outermost grain in it towards +y"),
        (before.z, "below the lowest grain in it"),
        (behind.z, "above the highest grain in it"),
    ];
    let (empty, place) = sides.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    (empty > median).then(|| format!("the region reaches {:.1} mm {place}", to_mm(empty)))
}

/// Median grains that a layer must be high for a void ratio. Ours: only from three on does a grain
/// lie between one on the floor and one at the surface. Of a lower layer every grain touches the
/// floor or the surface, so that the figure is that of these two and not of the grains between.
const LEAST_LAYERS: f64 = 3.0;

/// Why a void ratio to a mean surface height makes no sense; none where it does. Height and median
/// sieve size of the grains in m.
fn no_voids(mean_surface: f64, median: f64) -> Option<String> {
    (mean_surface < LEAST_LAYERS * median).then(|| {
        format!(
            "the mean surface stands {:.1} mm high, below {LEAST_LAYERS} median grains of {:.1} mm: \
             hardly a grain lies between the floor and the surface",
            to_mm(mean_surface),
            to_mm(median)
        )
    })
}

/// A height where there is no reason against it.
pub(super) fn height_unless(height: StandingHeight, reason: Option<&str>) -> StandingHeight {
    if reason.is_some() { StandingHeight::withheld() } else { height }
}

/// The angle of repose of a specimen on a base, or why it has none; `None` without a base.
pub(super) fn angle_of_repose(
    specimen: &Specimen,
) -> Result<Option<Result<AngleOfRepose, MeasureError>>, StudyError> {
    let Some(surface) = pile_surface(specimen).map_err(StudyError::measure)? else {
        return Ok(None);
    };
    let fallen_off = specimen.state.bodies.iter().filter(|g| g.fate == Fate::Spilled).count();
    Ok(Some(surface.repose().map(|pile| {
        AngleOfRepose {
            degrees: pile.angle.to_degrees(),
            standard_deviation_degrees: pile.standard_deviation.to_degrees(),
            confidence_low_degrees: pile.confidence.0.to_degrees(),
            confidence_high_degrees: pile.confidence.1.to_degrees(),
            by_volume_degrees: pile.by_volume.to_degrees(),
            pile_height_mm: to_mm(pile.height),
            base_radius_mm: to_mm(pile.base_radius),
            flank_radii_mm: [to_mm(pile.flank.0), to_mm(pile.flank.1)],
            volume_cm3: to_cm3(pile.volume),
            axis_mm: [to_mm(pile.axis.0), to_mm(pile.axis.1)],
            fallen_off,
            by_azimuth: pile
                .sectors
                .iter()
                .map(|s| AzimuthAngle {
                    azimuth_degrees: s.azimuth.to_degrees(),
                    degrees: s.angle.map(f64::to_degrees),
                    toe_radius_mm: s.toe.map(to_mm),
                })
                .collect(),
        }
    })))
}

/// Grains that lay with their centroid in a floor or a wall when a stage ended, and that no stage
/// itself saw pass.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Pressed {
    /// How many they are.
    pub grains: usize,
    /// How many lay there at the end of which stage; stages without any are missing.
    at_ends: Vec<(String, usize)>,
}

impl Pressed {
    /// What a reader must know; none where no grain was pressed.
    pub(super) fn warning(&self) -> Option<String> {
        if self.grains == 0 {
            return None;
        }
        let (who, them) = (counted(self.grains, "grain"), in_number(self.grains, "it", "them"));
        let ends = self.at_ends.iter().map(|(end, grains)| format!("{grains} at the end of {end}"));
        let ends = ends.collect::<Vec<_>>().join(", ");
        Some(format!(
            "{who} lay with the centroid below the floor or in a wall ({ends}): something pressed \
             {them} through it"
        ))
    }
}

/// Finds grains that were pressed through a floor or a wall in stages, each with what it is called.
pub(super) fn pressed_through<'a>(
    grains: &Arc<GrainSet>,
    stages: impl Iterator<Item = (String, &'a StoredStage)>,
    setup: &Setup,
) -> Pressed {
    // Pieces of a laboratory are no cylinder: whether grains pass them is watched stage by stage.
    if !setup.pieces.is_empty() {
        return Pressed::default();
    }
    let mut pressed = vec![false; grains.grains.len()];
    let mut ends: Vec<(String, Vec<usize>)> = Vec::new();
    for (name, stage) in stages {
        let specimen = Specimen { grains: grains.clone(), state: stage.state.clone() };
        let there = fates(&specimen, &container(setup, &specimen), wall(setup));
        let mut lie_there = Vec::new();
        for (n, (grain, fate)) in specimen.state.bodies.iter().zip(&there).enumerate() {
            match grain.fate {
                Fate::Present if *fate == Fate::ThroughWall => {
                    pressed[n] = true;
                    lie_there.push(n);
                }
                // Seen by the stage.
                Fate::ThroughWall => pressed[n] = false,
                _ => {}
            }
        }
        ends.push((name, lie_there));
    }
    let unseen = |of: Vec<usize>| of.into_iter().filter(|n| pressed[*n]).count();
    let at_ends = ends.into_iter().map(|(name, of)| (name, unseen(of)));
    Pressed {
        at_ends: at_ends.filter(|(_, grains)| *grains > 0).collect(),
        grains: pressed.iter().filter(|pressed| **pressed).count(),
    }
}

/// Grains that had passed through a floor or a wall when a run began with their specimen.
pub(super) fn passed_before(begun: &SpecimenState) -> usize {
    begun.bodies.iter().filter(|grain| grain.fate == Fate::ThroughWall).count()
}

/// Grains that lay heaped above the rim when the funnel was taken away, below its opening; none where
/// there were none, or another run poured, from a height that is not known here.
pub(super) fn heaped_above_rim(
    scenario: &Scenario,
    setup: &Setup,
    state: &SpecimenState,
) -> Option<usize> {
    let opening = setup.cylinder.height + from_mm(scenario.falling_height_mm()?);
    let taken = state.bodies.iter().filter(|grain| grain.fate == Fate::LeftInFunnel);
    let heaped = taken.filter(|grain| grain.body.pose.translation.z < opening).count();
    (heaped > 0).then_some(heaped)
}

/// Thickness of walls and floors in m, as grains on their way are held to have passed them.
pub(super) fn wall(setup: &Setup) -> f64 {
    from_mm(setup.funnel.wall_thickness_mm)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::measure::testing::{cube, specimen_of};
    use crate::specimen::FunnelState;
    use crate::study::tests::{planned, scenario};

    /// Law: what is said of pressed grains says when they lay there.
    #[test]
    fn pressed_grains_are_reported_with_the_stage_at_whose_end_they_lay_there() {
        assert_eq!(Pressed::default().warning(), None, "law: none, no warning");
        let at_ends = vec![("stage 2, press".to_owned(), 7), ("stage 3, rest".to_owned(), 1)];
        let said = Pressed { grains: 7, at_ends }.warning().expect("law: a warning");
        let expected = "7 grains lay with the centroid below the floor or in a wall (7 at the end \
                        of stage 2, press, 1 at the end of stage 3, rest): something pressed them \
                        through it";
        assert_eq!(said, expected);
    }

    /// Law: a grain that was gone through a wall before a run began counts, not one that fell over
    /// the rim.
    #[test]
    fn grains_that_passed_a_wall_before_the_run_began_are_known() {
        let mut begun = SpecimenState::before_everything(4);
        begun.bodies[0].fate = Fate::ThroughWall;
        begun.bodies[1].fate = Fate::ThroughWall;
        begun.bodies[2].fate = Fate::Spilled;
        assert_eq!(passed_before(&begun), 2, "law: two of three that are gone");
    }

    /// Law: of the grains that went with the funnel those below its opening were heaped above the rim.
    #[test]
    fn grains_below_the_funnels_opening_were_heaped() {
        let scenario = scenario(50.0);
        let setup = Setup::new(&scenario).expect("a laboratory");
        let mut state = SpecimenState::before_everything(4);
        for (grain, above_rim) in state.bodies.iter_mut().zip([0.01, 0.049, 0.051, 0.01]) {
            grain.fate = Fate::LeftInFunnel;
            grain.body.pose = Pose::translation(0.0, 0.0, setup.cylinder.height + above_rim);
        }
        state.bodies[3].fate = Fate::Spilled;
        let got = heaped_above_rim(&scenario, &setup, &state);
        assert_eq!(got, Some(2), "law: two of three, the opening is 50 mm above the rim");
        state.bodies.truncate(0);
        assert_eq!(heaped_above_rim(&scenario, &setup, &state), None, "law: none, no field");
    }

    /// Law: grains that are still in the funnel do not stand 0 mm high: they have no height, and
    /// the reason is given; once they are poured they have one.
    #[test]
    fn what_has_not_been_poured_has_no_height() {
        let run = planned(scenario(50.0));
        let container = Container { centre_x: 0.0, radius: 0.1, height: 0.2 };
        let mut state = SpecimenState::before_everything(run.grains.grains.len());
        for (is_poured, height) in [(false, 0.5), (true, 0.02)] {
            state.cylinder = is_poured;
            state.funnel = (!is_poured).then_some(FunnelState { opening_height: 0.2, lid: true });
            for grain in &mut state.bodies {
                grain.body.pose = Pose::translation(0.0, 0.0, height);
            }
            let specimen = Specimen { grains: run.grains.clone(), state: state.clone() };
            let got = Standing::of(&specimen, &container, 0.01, is_poured).expect("measured");
            let why = got.no_height.as_deref();
            assert_eq!(why.is_none(), is_poured, "law: a height once poured, got {why:?}");
            let fields: Vec<String> =
                withheld_figures(&got, None).into_iter().map(|withheld| withheld.field).collect();
            let is_named = fields.iter().any(|field| field == "standing_height_mm");
            assert_eq!(is_named, !is_poured, "law: with a reason, got {fields:?}");
            assert_eq!(got.surface() > 0.0, is_poured, "law: a surface once poured");
        }
    }

    /// Law: a single layer has no void ratio, three median grains have one.
    #[test]
    fn void_ratios_of_a_single_layer_are_withheld() {
        for (grains, is_withheld) in [(0.4, true), (1.2, true), (2.9, true), (3.0, false)] {
            let why = no_voids(grains * 0.01, 0.01);
            assert_eq!(why.is_some(), is_withheld, "law: {grains} grains high, got {why:?}");
        }
        let why = no_voids(0.012, 0.01).expect("law: withheld");
        let said = "the mean surface stands 12.0 mm high, below 3 median grains of 10.0 mm";
        assert!(why.starts_with(said), "law: with height and limit, got {why}");
    }

    /// Law: space between grains, and up to a median grain beside them, is void; more on any side is
    /// empty, as where a region reaches over a wall, below the floor or above the surface.
    #[test]
    fn a_region_beside_its_grains_is_partly_empty() {
        let at = |x: f64, z: f64| (cube(0.01), Pose::translation(x, 0.0, z));
        let specimen = specimen_of(vec![at(0.0, 0.0), at(0.03, 0.0), at(0.0, 0.03)]);
        // They reach from -5 to 35 mm along x and z, from -5 to 5 mm along y.
        let [from, to] = [[-5.0, -5.0, -5.0], [35.0, 5.0, 35.0]].map(|of| Vector::from(of) * 1e-3);
        let of = |low: [f64; 3], high: [f64; 3]| {
            let region = Region {
                low: from - Vector::from(low) * 1e-3,
                high: to + Vector::from(high) * 1e-3,
            };
            empty_beside(&specimen, &region, 0.01)
        };
        assert_eq!(of([0.0; 3], [0.0; 3]), None, "law: 20 mm between two grains are void");
        assert_eq!(of([9.0; 3], [9.0; 3]), None, "law: less than a grain beside them");
        assert_eq!(of([-3.0; 3], [-3.0; 3]), None, "law: a region within");
        for (low, high, expected) in [
            ([0.0, 0.0, 9.0], [0.0, 0.0, 12.0], "12.0 mm above the highest grain"),
            ([0.0, 0.0, 12.0], [9.0, 9.0, 9.0], "12.0 mm below the lowest grain"),
            ([12.0, 0.0, 0.0], [20.0, 0.0, 0.0], "20.0 mm beyond the outermost"),
            ([0.0, 12.0, 0.0], [0.0, 0.0, 11.0], "grain in it towards -y"),
        ] {
            let got = of(low, high).expect("law: it is partly empty");
            assert!(got.contains(expected), "law: expected `{expected}`, got `{got}`");
        }
    }

    /// Law: a reason is said once, with all figures that are withheld for it.
    #[test]
    fn a_reason_that_several_figures_have_is_said_once() {
        let withheld = |field: &str, reason: &str| Withheld {
            field: field.to_owned(),
            reason: reason.to_owned(),
        };
        assert_eq!(withheld_in_words(&[]), [""; 0], "law: nothing of nothing");
        let all = [
            withheld("void_ratio", "a low layer"),
            withheld("laboratory.regions.core.relative_density", "empty above"),
            withheld("porosity", "a low layer"),
            withheld("poured_void_ratio", "a low layer"),
        ];
        let expected = [
            "void_ratio, porosity, poured_void_ratio are withheld: a low layer",
            "laboratory.regions.core.relative_density is withheld: empty above",
        ];
        assert_eq!(withheld_in_words(&all), expected);
    }

    /// Law: 5 of 230 grains are no specimen; half of them are.
    #[test]
    fn heights_of_a_few_grains_are_withheld() {
        assert!(no_height(5, 230).is_some_and(|why| why.contains("5 of 230")));
        assert_eq!(no_height(115, 230), None, "law: half of them");
        assert_eq!(no_height(0, 0), None, "law: nothing is missing of nothing");
        let height = StandingHeight { mean_surface: 1.0, p95: 2.0, highest: 3.0 };
        assert_eq!(height_unless(height, None), height, "law: a height that makes sense is kept");
        let written = serde_json::to_value(height_unless(height, Some("few"))).expect("JSON");
        assert!(written["mean_surface"].is_null(), "law: null in files, got {written}");
        let read: StandingHeight = serde_json::from_value(written).expect("read again");
        assert_eq!(read.mean(), None, "law: and none when read again");
    }
}
