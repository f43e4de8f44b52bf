//! Pieces of a laboratory, the stages that speak of them, and what is measured there.

use super::mean_stress::{Hold, Holds, any_of, follow};
use super::*;
use crate::geometry::ConvexPolyhedron;
use crate::scale::LARGEST_DISTANCE;
use crate::scenario::sizes_of_pieces::lowest_mm;
use crate::scenario::unusual::JAMS_BELOW;
use crate::units::to_g;

/// Stages of the built-in apparatus.
pub(super) const BUILT_IN: [&str; 5] =
    ["fill_funnel", "slow_pluviation", "pour", "place_top_plate", "vibrate"];

/// Stages of a laboratory of pieces.
pub(super) const OF_PIECES: [&str; 5] = ["deposit", "move", "press", "release", "remove"];

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    check_pieces(parts, faults);
    check_names_of_stages(parts, faults);
    if let Some(measures) = parts.measures.as_ref() {
        check_measures(parts, measures, faults);
    }
    for (i, spec) in parts.specs() {
        let mut faults = faults.at(format!("stages[{i}]"));
        match spec {
            StageSpec::Deposit(deposit) => {
                check_height(parts, i, &deposit.at_mm, &mut faults);
                check_deposit(parts, deposit, &mut faults);
            }
            StageSpec::Press(PressSpec { loads, ramp_s, time_limit_s, until, .. }) => {
                loads::check(parts, loads, &mut faults);
                let wrong = until.is_none() && *time_limit_s > 0.0 && ramp_s > time_limit_s;
                let allowed = format!("at most {} s, `time_limit_s`", no_more(*time_limit_s));
                let why = "the stage would end before the load is whole";
                faults.add_if(wrong, "ramp_s", ramp_s, allowed, why);
            }
            StageSpec::Release(stage) => {
                loads::check_release(parts, &stage.pieces, &mut faults);
            }
            _ => {}
        }
    }
    moves::check(parts, faults);
    check_who_stands(parts, faults);
    check_what_waits(parts, faults);
    until::check(parts, faults);
    mean_stress::check(parts, faults);
}

/// Whose place columns of `series.csv` give already.
const TABLE: &str = "table";

/// Whether a name can be a part of the name of a column.
fn is_plain(name: &str) -> bool {
    name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_'))
}

fn check_pieces(parts: &Parts, faults: &mut Faults) {
    let mut known = HashSet::new();
    for (i, piece) in parts.pieces() {
        let mut faults = faults.at(format!("pieces[{i}]"));
        let (name, shown) = (&piece.name, Value::from(piece.name.as_str()));
        if !is_plain(name) {
            let message = "the name cannot be that of columns";
            faults.add("name", shown, "letters, digits, `-` and `_`", message);
        } else if name == TABLE {
            faults.add("name", shown, "another name", "columns of this name are not a piece's");
        } else if !known.insert(name) {
            faults.add("name", shown, "a unique name", "two pieces have this name");
        }
        check_place(parts, piece.at_mm, &mut faults);
        check_shape(&piece.shape, &mut faults);
        check_passage(parts, piece, &mut faults);
    }
}

/// An upright hopper that the coarsest grains cannot leave, as the funnel of the built-in apparatus must
/// let them. Not where deposits choose among sizes, whose coarsest may be kept from it, nor of the pieces
/// of a begun specimen.
fn check_passage(parts: &Parts, piece: &PieceSpec, faults: &mut Faults) {
    let Some(hopper) = &piece.shape.hopper else { return };
    let [about_x, about_y, _] = piece.rotation_deg;
    let chooses = |spec: &StageSpec| matches!(spec, StageSpec::Deposit(d) if d.sizes_mm.is_some());
    let is_judged = about_x == 0.0
        && about_y == 0.0
        && parts.begun_after.is_none()
        && !parts.specs().any(|(_, spec)| chooses(spec));
    let Some(coarsest) = parts.coarsest_mm().filter(|_| is_judged) else { return };
    let opening = hopper.opening_diameter_mm;
    let least = as_typed(coarsest);
    let allowed =
        format!("more than {least} mm, and {JAMS_BELOW} median grain sizes or more against jams");
    let why = "no grain of the coarsest fraction can leave the hopper";
    let wrong = opening <= coarsest;
    faults.add_if(wrong, "shape.hopper.opening_diameter_mm", opening, allowed, why);
}

/// A place that is near enough to the origin for what is there to be simulated.
fn check_place(parts: &Parts, at_mm: [f64; 3], faults: &mut Faults) {
    let (Some(grading), Some(gravity)) = (&parts.grading, parts.gravity) else { return };
    let largest = LARGEST_DISTANCE.no_less(&grading.scale_for_filling(gravity));
    let distance = at_mm.iter().map(|x| from_mm(*x).powi(2)).sum::<f64>().sqrt();
    let allowed = format!("at most {} mm from the origin", no_more(to_mm(largest)));
    let why = "it lies farther away than bodies are followed";
    faults.add_if(distance > largest, "at_mm", format!("{at_mm:?}"), allowed, why);
}

fn check_shape(shape: &ShapeSpec, faults: &mut Faults) {
    let given = shape.kinds();
    let allowed =
        "one of `box`, `cylinder`, `plate`, `disc`, `hopper`, `wedge`, `drum`, `mesh` and `vane`";
    faults.add_if(given.len() != 1, "shape", given.join(", "), allowed, "a piece has one shape");
    if let Some(hopper) = &shape.hopper {
        let (opening, top) = (hopper.opening_diameter_mm, hopper.top_diameter_mm);
        let allowed = format!("more than the diameter of its opening, {opening} mm");
        let why = "the hopper is no wider at the top than at its opening";
        faults.add_if(top <= opening, "shape.hopper.top_diameter_mm", top, allowed, why);
        let collar = hopper.collar_mm;
        // Other sizes have this as the lower end of their range.
        let wrong = collar > 0.0 && collar < 0.001;
        let allowed = "0, or at least 0.001 mm";
        let why = "the collar is too low for faces with an area";
        faults.add_if(wrong, "shape.hopper.collar_mm", collar, allowed, why);
    }
    if let Some(drum) = &shape.drum {
        let (radius, high) = (drum.inner_diameter_mm / 2.0, drum.lifter_mm);
        let wrong = drum.lifters > 0 && high >= radius;
        let allowed = format!("less than {radius} mm, the inner radius");
        let why = "the bars reach the axis of the drum";
        faults.add_if(wrong, "shape.drum.lifter_mm", high, allowed, why);
    }
    if let Some(vane) = &shape.vane {
        let wrong = vane.diameter_mm / 2.0 <= vane.core_mm();
        let allowed = "blades thinner than they are long";
        let why = "nothing is left between the blades";
        faults.add_if(wrong, "shape.vane.blade_mm", vane.blade_mm, allowed, why);
    }
    if let Some(mesh) = &shape.mesh {
        check_mesh(mesh, &mut faults.at("shape.mesh"));
    }
    let none = shape.r#box.as_ref().is_some_and(|b| b.open.len() == 6);
    faults.add_if(none, "shape.box.open", "6 sides", "fewer than 6", "nothing is left of the box");
}

/// A mesh from a file, or its parts, each of which is convex.
fn check_mesh(mesh: &MeshPieceSpec, faults: &mut Faults) {
    let sources = given(&[("file", mesh.file.is_some()), ("parts", mesh.parts.is_some())]);
    let (wrong, found) = (sources.len() != 1, sources.join(", "));
    faults.add_if(wrong, "file", found, "`file` or `parts`", "a mesh has one source");
    let scale = mesh.scale_to_mm.filter(|_| mesh.parts.is_some());
    faults.idle("scale_to_mm", scale, "`parts` are in mm");
    for (n, part) in mesh.parts().iter().enumerate() {
        let corners = part.vertices_mm.iter().map(|v| Point::from(v.map(from_mm))).collect();
        if let Err(error) = ConvexPolyhedron::new(corners, part.faces.clone()) {
            let field = format!("parts[{n}]");
            faults.add(&field, error, "a closed convex surface", "the part cannot be used");
        }
    }
}

/// Which stages go with the apparatus.
fn check_names_of_stages(parts: &Parts, faults: &mut Faults) {
    let own = parts.has_pieces();
    let none = !parts.may_have_pieces();
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(name) = stage.name.as_deref() else { continue };
        let mut faults = faults.at(format!("stages[{i}]"));
        let (allowed, why) = match () {
            () if own && BUILT_IN.contains(&name) => (
                "`deposit`, `move`, `press`, `release`, `remove` and `rest`",
                "is done with the built-in apparatus, in whose place `pieces` stand",
            ),
            () if none && OF_PIECES.contains(&name) => {
                ("it in a scenario with `pieces`", "is done with pieces, and there are none")
            }
            _ => continue,
        };
        faults.add("stage", Value::from(name), allowed, format!("`{name}` {why}"));
    }
    let filled = parts.has_stage("deposit") || parts.begun_after.is_some();
    let wrong = own && !filled && parts.stages.iter().all(|s| s.known().is_some());
    let why = "no grain would get into the laboratory";
    faults.add_if(wrong, "stages", "no `deposit`", "at least one", why);
}

fn check_deposit(parts: &Parts, deposit: &DepositSpec, faults: &mut Faults) {
    let DepositSpec { how, at_mm, area_mm, diameter_mm, rate_g_per_s, .. } = *deposit;
    let DepositSpec { sizes_mm, mass_g, time_limit_s, .. } = *deposit;
    check_place(parts, at_mm, faults);
    let areas = given(&[("area_mm", area_mm.is_some()), ("diameter_mm", diameter_mm.is_some())]);
    let (wrong, allowed) = (areas.len() != 1, "`area_mm` or `diameter_mm`");
    faults.add_if(wrong, "area_mm", areas.join(", "), allowed, "a deposit has one area");
    if let Some(sides) = area_mm.filter(|sides| !sides.iter().all(|side| *side > 0.0)) {
        faults.add("area_mm", format!("{sides:?}"), "numbers above 0", "the area is none");
    }
    let is_rain = how == DepositKind::Rain;
    let missing = is_rain && rate_g_per_s.is_none();
    faults.add_if(missing, "rate_g_per_s", "", "a number above 0", "rain needs its rate");
    let rate = rate_g_per_s.filter(|_| !is_rain);
    faults.idle("rate_g_per_s", rate, "grains of a lattice begin all at once");
    let above = deposit.above_surface_mm.filter(|_| !is_rain);
    faults.idle("above_surface_mm", above, "grains of a lattice begin all at once");
    // All that there is, where the stage is the only one that takes some of it.
    let deposits = parts.specs().filter(|(_, spec)| matches!(spec, StageSpec::Deposit { .. }));
    let alone = deposits.count() == 1 && parts.begun_after.is_none() && sizes_mm.is_none();
    let all_g = parts.grading.filter(|_| alone).map(|all| to_g(all.solids * all.density));
    let mass = mass_g.map_or(all_g, |own| all_g.map_or(Some(own), |all| Some(own.min(all))));
    if let Some((mass, rate)) = mass.zip(rate_g_per_s.filter(|rate| is_rain && *rate > 0.0)) {
        let wrong = mass / rate > time_limit_s;
        let allowed = format!("more than {} s", no_less(mass / rate));
        let why = format!("{} g at {} g/s take longer", short(mass), short(rate));
        faults.add_if(wrong, "time_limit_s", time_limit_s, allowed, why);
    }
    let Some([low, high]) = sizes_mm else { return };
    let (found, why) = (format!("[{low}, {high}]"), "no grain is of that size");
    if !(low >= 0.0 && low < high) {
        return faults.add("sizes_mm", found, "two openings, the finer first", why);
    }
    let table: Vec<&SieveFraction> = parts.sieved.iter().flat_map(with_grains).collect();
    let fits = |f: &SieveFraction| f.retained_mm >= low && f.passing_mm <= high;
    let between: Vec<String> =
        table.iter().map(|f| format!("[{}, {}]", f.retained_mm, f.passing_mm)).collect();
    let allowed = format!("openings around one of the fractions {}", between.join(", "));
    faults.add_if(
        !table.is_empty() && !table.iter().copied().any(fits),
        "sizes_mm",
        found,
        allowed,
        why,
    );
}

/// Whether a deposit, as the stage of a number, lies where pieces may catch its grains. Once stages
/// have moved pieces, only a run shows where they are.
fn check_height(parts: &Parts, stage: usize, at_mm: &[f64; 3], faults: &mut Faults) {
    let moves_none =
        |stage: &Stage| matches!(stage.name.as_deref(), Some("deposit" | "rest" | "remove"));
    let stand = parts.stages[..stage].iter().all(moves_none) && parts.begun_after.is_none();
    if !(stand && parts.names_of_pieces().is_some()) {
        return;
    }
    let Some(lowest) = lowest_mm(parts.pieces().map(|(_, piece)| piece)) else { return };
    let allowed = format!("a height of more than {} mm", no_less(lowest));
    let why = "the grains begin below all pieces, and nothing catches them";
    faults.add_if(at_mm[2] < lowest, "at_mm", format!("{at_mm:?}"), allowed, why);
}

const TWICE: &str = "the piece is named twice";

/// Whether the pieces that stages speak of stand then.
fn check_who_stands(parts: &Parts, faults: &mut Faults) {
    let Some(known) = parts.names_of_pieces().filter(|_| parts.has_pieces()) else { return };
    let mut removed: HashSet<&str> = HashSet::new();
    let mut holds = Holds::new();
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(spec) = &stage.spec else {
            // It may hold any piece again.
            holds.clear();
            continue;
        };
        let mut faults = faults.at(format!("stages[{i}]"));
        check_what_is_left(&known, spec, &mut holds, &mut faults);
        let of_load = |k: usize| format!("loads[{k}].piece");
        let of_piece = |k: usize| format!("pieces[{k}]");
        let (names, field): (Vec<&String>, &dyn Fn(usize) -> String) = match spec {
            StageSpec::Move(MoveSpec { pieces, .. })
            | StageSpec::Release(ReleaseSpec { pieces, .. })
            | StageSpec::Remove(RemoveSpec { pieces, .. }) => (pieces.iter().collect(), &of_piece),
            StageSpec::Press(PressSpec { loads, .. }) => {
                (loads.iter().map(|load| &load.piece).collect(), &of_load)
            }
            _ => continue,
        };
        for (k, name) in names.iter().enumerate() {
            let message = match () {
                () if names[..k].contains(name) && !matches!(spec, StageSpec::Press { .. }) => {
                    faults.add(&field(k), Value::from(name.as_str()), "each piece once", TWICE);
                    continue;
                }
                () if !known.contains(&name.as_str()) => "there is no such piece",
                () if removed.contains(name.as_str()) => "the piece was removed before",
                () => continue,
            };
            let standing: Vec<&str> =
                known.iter().filter(|name| !removed.contains(**name)).copied().collect();
            let allowed = any_of(&standing, "none: all pieces are removed before");
            faults.add(&field(k), Value::from(name.as_str()), allowed, message);
        }
        if let StageSpec::Remove(stage) = spec {
            removed.extend(stage.pieces.iter().map(String::as_str));
        }
    }
}

/// Whether a stage finds a piece that it can move, and leaves one that carries what moves freely;
/// `holds` is what earlier stages have made of the pieces of these names, then this one as well.
fn check_what_is_left<'a>(
    known: &[&str],
    spec: &'a StageSpec,
    holds: &mut Holds<'a>,
    faults: &mut Faults,
) {
    let all = |holds: &Holds, are: fn(Hold) -> bool| {
        known.iter().all(|name| holds.get(*name).is_some_and(|hold| are(*hold)))
    };
    if let StageSpec::Move(MoveSpec { pieces, .. }) = spec {
        let wrong = pieces.is_empty() && all(holds, |hold| hold != Hold::Held);
        let allowed = "names of pieces that stand";
        let why =
            "without names it moves all that is neither pressed nor free, and nothing is left";
        faults.add_if(wrong, "pieces", "no names", allowed, why);
    }
    follow(spec, holds);
    if let StageSpec::Release(ReleaseSpec { pieces, .. }) = spec {
        let wrong = all(holds, |hold| matches!(hold, Hold::Free | Hold::Removed));
        let allowed = "fewer than all pieces, with those that earlier stages let go";
        let why = "nothing is left that could carry what moves freely";
        faults.add_if(wrong, "pieces", pieces.join(", "), allowed, why);
    }
}

/// Whether grains wait for each deposit: a lattice takes all that do, where neither a mass nor
/// sizes are given. Of a rain those may be left for which it had no time or no room.
fn check_what_waits(parts: &Parts, faults: &mut Faults) {
    let takes_all = |spec: &StageSpec| match spec {
        StageSpec::Deposit(DepositSpec { how, mass_g, sizes_mm, .. }) => {
            *how == DepositKind::Lattice && mass_g.is_none() && sizes_mm.is_none()
        }
        _ => false,
    };
    let Some((all, _)) = parts.specs().find(|(_, spec)| takes_all(spec)) else { return };
    for (i, spec) in parts.specs().filter(|(i, _)| *i > all) {
        let wrong = matches!(spec, StageSpec::Deposit(_));
        let found = Value::from(spec.name());
        let allowed = format!("`mass_g` or `sizes_mm` in stages[{all}]");
        let why = format!("no grain waits any more: the lattice of stages[{all}] takes all");
        faults.add_if(wrong, &format!("stages[{i}].stage"), found, allowed, why);
    }
}

fn check_measures(parts: &Parts, measures: &MeasuresSpec, faults: &mut Faults) {
    let wrong = !measures.is_empty() && !parts.may_have_pieces();
    let found = "regions, openings or groups";
    let why = "these are measured in a laboratory of `pieces`";
    faults.add_if(wrong, "measures", found, "the field left out", why);
    let mut faults = faults.at("measures");
    for (i, region) in measures.regions.iter().enumerate() {
        let (low, high) = (&region.low_mm, &region.high_mm);
        let wrong = !low.iter().zip(high).all(|(l, h)| l < h);
        let found = format!("{high:?}");
        let allowed = "a corner above and beyond `low_mm` in every direction";
        let why = "the region holds nothing";
        faults.add_if(wrong, &format!("regions[{i}].high_mm"), found, allowed, why);
    }
    check_groups(parts, measures, &mut faults);
    for (i, opening) in measures.openings.iter().enumerate() {
        let field = format!("openings[{i}].direction");
        faults.not_zero(&field, opening.direction, "the opening has no direction");
    }
    let regions = measures.regions.iter().map(|r| &r.name).enumerate();
    let openings = measures.openings.iter().map(|o| &o.name).enumerate();
    let groups = measures.groups.iter().map(|g| &g.name).enumerate();
    let all = regions.map(|(i, name)| ("regions", i, name));
    let all = all.chain(openings.map(|(i, name)| ("openings", i, name)));
    let all = all.chain(groups.map(|(i, name)| ("groups", i, name)));
    let mut known = HashSet::new();
    let pieces: HashSet<&String> = parts.pieces().map(|(_, piece)| &piece.name).collect();
    for (list, i, name) in all {
        let is_new = known.insert(name);
        let (allowed, why) = match () {
            () if !is_plain(name) => {
                ("letters, digits, `-` and `_`", "the name cannot be that of columns")
            }
            () if name == TABLE => ("another name", "columns of this name are the table's"),
            () if pieces.contains(name) => ("another name", "a piece has this name"),
            () if !is_new => {
                ("a unique name", "a region, an opening or a group before has this name")
            }
            () => continue,
        };
        let field = format!("{list}[{i}].name");
        faults.add(&field, Value::from(name.as_str()), allowed, why);
    }
}

/// Whether the pieces of groups are there, each once.
fn check_groups(parts: &Parts, measures: &MeasuresSpec, faults: &mut Faults) {
    let Some(known) = parts.names_of_pieces().filter(|_| parts.has_pieces()) else { return };
    for (i, group) in measures.groups.iter().enumerate() {
        let mut faults = faults.at(format!("groups[{i}]"));
        for (k, name) in group.pieces.iter().enumerate() {
            let (allowed, message) = match () {
                () if !known.contains(&name.as_str()) => {
                    (known.join(", "), "there is no such piece")
                }
                () if group.pieces[..k].contains(name) => {
                    ("each piece once".to_owned(), "the piece is in the group already")
                }
                () => continue,
            };
            let field = format!("pieces[{k}]");
            faults.add(&field, Value::from(name.as_str()), allowed, message);
        }
    }
}

impl Parts {
    /// Whether the scenario has an apparatus of its own.
    pub(super) fn has_pieces(&self) -> bool {
        !self.pieces.is_empty()
    }

    /// Whether it has, or may have one that could not be read or looked up.
    fn may_have_pieces(&self) -> bool {
        self.has_pieces() || self.are_pieces_unread || self.begins_with_unknown()
    }

    /// The pieces that could be read, with their numbers.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (usize, &PieceSpec)> {
        self.pieces.iter().enumerate().filter_map(|(i, piece)| Some((i, piece.as_ref()?)))
    }

    /// Whether there are pieces of all these names.
    pub(super) fn have(&self, names: &[String]) -> bool {
        names.iter().all(|name| self.pieces().any(|(_, piece)| piece.name == *name))
    }

    /// Names of the pieces; none where one could not be read, which may have any name.
    pub(super) fn names_of_pieces(&self) -> Option<Vec<&str>> {
        self.pieces.iter().map(|piece| Some(piece.as_ref()?.name.as_str())).collect()
    }
}
