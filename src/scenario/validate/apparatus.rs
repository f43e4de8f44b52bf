//! Sizes of cylinder, funnel and plate against each other and the grains.

use super::*;
use crate::scenario::unusual::JAMS_BELOW;
use crate::scenario::volumes_of_pieces::flats;

/// Length of the longest grain over the opening of the coarsest sieve. Voronoi
/// cells of a 16 mm sieve are up to 32 to 38 mm long: a sieve measures the
/// width of a grain, not its length.
const LONGEST_GRAIN: f64 = 2.4;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    if !parts.has_pieces() {
        check_cylinder(parts, &mut faults.at("apparatus.cylinder"));
        check_funnel(parts, &mut faults.at("apparatus.funnel"));
        check_plate(parts, &mut faults.at("apparatus.top_plate"));
    }
}

/// Whether no grain comes into the cylinder or the funnel: all that is done builds a pile, or leaves
/// one alone.
fn is_pile(parts: &Parts) -> bool {
    let pile = "slow_pluviation";
    let begun = parts.begun_after.iter().flatten().any(|name| name == pile);
    let of_pile = |stage: &Stage| matches!(stage.known(), Some("slow_pluviation" | "rest"));
    (begun || parts.has_stage(pile)) && parts.stages.iter().all(of_pile)
}

fn check_cylinder(parts: &Parts, faults: &mut Faults) {
    let Some(cylinder) = parts.cylinder.as_ref().filter(|_| !is_pile(parts)) else { return };
    let Some(coarsest) = parts.coarsest_mm() else { return };
    let (across, longest) = (cylinder.inner_diameter_mm, LONGEST_GRAIN * coarsest);
    let why = format!(
        "the cylinder is narrower than a grain: those that pass {} mm are up to {LONGEST_GRAIN} \
         times as long",
        as_typed(coarsest)
    );
    faults.add_if(across < longest, "inner_diameter_mm", across, as_longest(longest), why);
    // A mixture of sizes packs denser than this only by crushing.
    let Some(grading) = &parts.grading else { return };
    let height = grading.solids / (PI / 4.0 * from_mm(across).powi(2));
    let is_higher = height.is_finite() && height > from_mm(cylinder.height_mm);
    let wrong = is_higher && parts.has_stage("pour");
    let allowed = format!("more than {} mm", no_less(height * 1e3));
    let why = "the cylinder has less room than the grains have volume, voids not counted";
    faults.add_if(wrong, "height_mm", cylinder.height_mm, allowed, why);
}

/// What is allowed where the longest grains, of a length in mm, must have room.
fn as_longest(longest: f64) -> String {
    format!("at least {} mm, the length of the longest grains", no_less(longest))
}

fn check_funnel(parts: &Parts, faults: &mut Faults) {
    let Some(funnel) = &parts.funnel else { return };
    let (opening, top) = (funnel.opening_diameter_mm, funnel.top_diameter_mm);
    let allowed = format!("more than the diameter of its opening, {opening} mm");
    let why = "the funnel is no wider at the top than at its opening";
    faults.add_if(top <= opening, "top_diameter_mm", top, allowed, why);
    if let Some(coarsest) = parts.coarsest_mm().filter(|_| !is_pile(parts)) {
        let least = as_typed(coarsest);
        let allowed = format!(
            "more than {least} mm, and {JAMS_BELOW} median grain sizes or more against jams"
        );
        let why = "no grain of the coarsest fraction can leave the funnel";
        faults.add_if(opening <= coarsest, "opening_diameter_mm", opening, allowed, why);
        let longest = LONGEST_GRAIN * coarsest;
        let wrong = top > opening && top < longest;
        let why = "the funnel is narrower than a grain";
        faults.add_if(wrong, "top_diameter_mm", top, as_longest(longest), why);
    }
    let Some(cylinder) = &parts.cylinder else { return };
    let inner = cylinder.inner_diameter_mm;
    let wrong = opening > inner && parts.has_stage("pour");
    let allowed = format!("at most the cylinder's inner diameter, {inner} mm");
    let why = "the funnel's opening is wider than the cylinder: grains would fall beside it";
    faults.add_if(wrong, "opening_diameter_mm", opening, allowed, why);
}

/// The plate's corners must pass the flats of the wall, however it turns.
fn check_plate(parts: &Parts, faults: &mut Faults) {
    let (Some(cylinder), Some(plate)) = (&parts.cylinder, &parts.top_plate) else { return };
    if !parts.has_stage("place_top_plate") || plate.sides < 3 || cylinder.wall_pieces < 3 {
        return;
    }
    let corner = flats(plate.sides, 1.0) / (PI / f64::from(plate.sides)).cos();
    let widest = cylinder.inner_diameter_mm * flats(cylinder.wall_pieces, 1.0) / corner;
    let allowed = format!("less than {} mm, at which its corners touch the wall", no_more(widest));
    let across = plate.diameter_mm;
    let why = "the top plate does not fit into the cylinder";
    faults.add_if(across >= widest, "diameter_mm", across, allowed, why);
}
