//! Sizes of cylinder, funnel and plate against each other and the grains.

use std::f64::consts::PI;

use super::*;

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

fn check_cylinder(parts: &Parts, faults: &mut Faults) {
    let Some(cylinder) = &parts.cylinder else { return };
    let Some(coarsest) = parts.coarsest_mm() else { return };
    let (across, longest) = (cylinder.inner_diameter_mm, LONGEST_GRAIN * coarsest);
    faults.add_if(
        across < longest,
        "inner_diameter_mm",
        across,
        format!("at least {} mm, the length of the longest grains", short(longest)),
        format!(
            "the cylinder is narrower than a grain: those that pass {coarsest} mm are up to \
        {LONGEST_GRAIN} times as long"
        ),
    );
    // A mixture of sizes packs denser than this only by crushing.
    let Some(grading) = &parts.grading else { return };
    let height = grading.solids / (PI / 4.0 * from_mm(across).powi(2));
    let is_higher = height.is_finite() && height > from_mm(cylinder.height_mm);
    faults.add_if(
        is_higher && parts.has_stage("pour"),
        "height_mm",
        cylinder.height_mm,
        format!("more than {} mm", short(height * 1e3)),
        "the cylinder has less room than the grains have volume, voids not counted",
    );
}

fn check_funnel(parts: &Parts, faults: &mut Faults) {
    let Some(funnel) = &parts.funnel else { return };
    let (opening, top) = (funnel.opening_diameter_mm, funnel.top_diameter_mm);
    faults.add_if(
        top <= opening,
        "top_diameter_mm",
        top,
        format!("more than the diameter of its opening, {opening} mm"),
        "the funnel is no wider at the top than at its opening",
    );
    if let Some(coarsest) = parts.coarsest_mm() {
        faults.add_if(
            opening <= coarsest,
            "opening_diameter_mm",
            opening,
            format!("more than {coarsest} mm, and 7 to 8 grains wide against jams"),
            "no grain of the coarsest fraction can leave the funnel",
        );
        let longest = LONGEST_GRAIN * coarsest;
        faults.add_if(
            top > opening && top < longest,
            "top_diameter_mm",
            top,
            format!("at least {} mm, the length of the longest grains", short(longest)),
            "the funnel is narrower than a grain",
        );
    }
    let Some(cylinder) = &parts.cylinder else { return };
    faults.add_if(
        opening > cylinder.inner_diameter_mm && parts.has_stage("pour"),
        "opening_diameter_mm",
        opening,
        format!("at most the cylinder's inner diameter, {} mm", cylinder.inner_diameter_mm),
        "the funnel's opening is wider than the cylinder: grains would fall beside it",
    );
}

/// Distance from the axis to the flats of a regular polygon with the area of a
/// circle, over the circle's radius: from N tan(π/N) · w² = π r².
fn flat(sides: u32) -> f64 {
    let n = f64::from(sides);
    (PI / (n * (PI / n).tan())).sqrt()
}

/// The plate's corners must pass the flats of the wall, however it turns.
fn check_plate(parts: &Parts, faults: &mut Faults) {
    let (Some(cylinder), Some(plate)) = (&parts.cylinder, &parts.top_plate) else { return };
    if !parts.has_stage("place_top_plate") || plate.sides < 3 || cylinder.wall_pieces < 3 {
        return;
    }
    let corner = flat(plate.sides) / (PI / f64::from(plate.sides)).cos();
    let widest = cylinder.inner_diameter_mm * flat(cylinder.wall_pieces) / corner;
    faults.add_if(
        plate.diameter_mm >= widest,
        "diameter_mm",
        plate.diameter_mm,
        format!("less than {} mm, at which its corners touch the wall", short(widest)),
        "the top plate does not fit into the cylinder",
    );
}
