//! Pieces of a laboratory, the stages that speak of them, and what is measured there.

use std::collections::HashSet;

use serde_json::Value;

use super::{Parts, fault, loads, moves, until};
use crate::geometry::{ConvexPolyhedron, Point};
use crate::scenario::{
    DepositKind, Fault, MeasuresSpec, MeshPieceSpec, PieceSpec, ShapeSpec, StageSpec,
};
use crate::units::from_mm;

/// Stages of the built-in apparatus.
const BUILT_IN: [&str; 5] =
    ["fill_funnel", "slow_pluviation", "pour", "place_top_plate", "vibrate"];

/// Stages of a laboratory of pieces.
const OF_PIECES: [&str; 5] = ["deposit", "move", "press", "release", "remove"];

pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    check_pieces(parts, faults);
    check_names_of_stages(parts, faults);
    if let Some(measures) = parts.measures.as_ref() {
        check_measures(parts, measures, faults);
    }
    let specs = parts.stages.iter().enumerate().filter_map(|(i, s)| Some((i, s.spec.as_ref()?)));
    for (i, spec) in specs {
        let mut add = |field: &str, found: String, allowed: &str, message: &str| {
            let path = format!("stages[{i}].{field}");
            faults.push(fault(&path, found, allowed.into(), message.into()));
        };
        match spec {
            StageSpec::Deposit { .. } => check_deposit(spec, &mut add),
            StageSpec::Press { loads, .. } => loads::check(parts, loads, &mut add),
            StageSpec::Release { pieces, .. } => loads::check_release(parts, pieces, &mut add),
            _ => {}
        }
    }
    moves::check(parts, faults);
    check_who_stands(parts, faults);
    until::check(parts, faults);
}

fn check_pieces(parts: &Parts, faults: &mut Vec<Fault>) {
    let mut known = HashSet::new();
    for (i, piece) in parts.pieces() {
        let mut add = |field: &str, found: String, allowed: &str, message: &str| {
            let path = format!("pieces[{i}].{field}");
            faults.push(fault(&path, found, allowed.into(), message.into()));
        };
        let name = &piece.name;
        let shown = || Value::from(name.as_str()).to_string();
        if !name.chars().all(|c| c.is_ascii_alphanumeric() || matches!(c, '-' | '_')) {
            add(
                "name",
                shown(),
                "letters, digits, `-` and `_`",
                "the name cannot be that of columns",
            );
        } else if !known.insert(name) {
            add("name", shown(), "a name of its own", "two pieces have this name");
        }
        check_shape(&piece.shape, &mut add);
    }
}

fn check_shape(shape: &ShapeSpec, add: &mut impl FnMut(&str, String, &str, &str)) {
    let given = shape.kinds().len();
    if given != 1 {
        add(
            "shape",
            format!("{given} shapes"),
            "one of `box`, `cylinder`, `plate`, `disc`, `hopper`, `wedge`, `drum`, `mesh` and `vane`",
            "a piece has one shape",
        );
    }
    if let Some(hopper) = &shape.hopper
        && hopper.top_diameter_mm <= hopper.opening_diameter_mm
    {
        add(
            "shape.hopper.top_diameter_mm",
            hopper.top_diameter_mm.to_string(),
            &format!("more than the diameter of its opening, {} mm", hopper.opening_diameter_mm),
            "the hopper is no wider at the top than at its opening",
        );
    }
    if let Some(drum) = &shape.drum
        && drum.lifters > 0
        && drum.lifter_mm >= drum.inner_diameter_mm / 2.0
    {
        add(
            "shape.drum.lifter_mm",
            drum.lifter_mm.to_string(),
            &format!("less than {} mm, the inner radius", drum.inner_diameter_mm / 2.0),
            "the bars reach the axis of the drum",
        );
    }
    if let Some(vane) = &shape.vane
        && vane.diameter_mm / 2.0 <= vane.core_mm()
    {
        add(
            "shape.vane.blade_mm",
            vane.blade_mm.to_string(),
            "blades thinner than they are long",
            "nothing is left between the blades",
        );
    }
    if let Some(mesh) = &shape.mesh {
        check_mesh(mesh, add);
    }
    if shape.r#box.as_ref().is_some_and(|b| b.open.len() == 6) {
        add("shape.box.open", "6 sides".into(), "fewer than 6", "nothing is left of the box");
    }
}

/// A mesh from a file, or its parts, each of which is convex.
fn check_mesh(mesh: &MeshPieceSpec, add: &mut impl FnMut(&str, String, &str, &str)) {
    if mesh.file.is_some() == mesh.parts.is_some() {
        add("shape.mesh.file", String::new(), "`file` or `parts`", "a mesh has one source");
    }
    if let (Some(scale), Some(_)) = (mesh.scale_to_mm, &mesh.parts) {
        let message = "`parts` are in mm";
        add("shape.mesh.scale_to_mm", scale.to_string(), "the field left out", message);
    }
    for (n, part) in mesh.parts().iter().enumerate() {
        let corners = part.vertices_mm.iter().map(|v| Point::from(v.map(from_mm))).collect();
        if let Err(error) = ConvexPolyhedron::new(corners, part.faces.clone()) {
            let field = format!("shape.mesh.parts[{n}]");
            add(&field, error.to_string(), "a closed convex surface", "the part cannot be used");
        }
    }
}

/// Which stages go with the apparatus.
fn check_names_of_stages(parts: &Parts, faults: &mut Vec<Fault>) {
    let own = parts.has_pieces();
    for (i, stage) in parts.stages.iter().enumerate() {
        let Some(name) = stage.name.as_deref() else { continue };
        let path = format!("stages[{i}].stage");
        if own && BUILT_IN.contains(&name) {
            faults.push(fault(
                &path,
                Value::from(name),
                "`deposit`, `move`, `press`, `release`, `remove` and `rest`".into(),
                format!(
                    "`{name}` is done with the built-in apparatus, in whose place `pieces` stand"
                ),
            ));
        }
        if !own && OF_PIECES.contains(&name) {
            faults.push(fault(
                &path,
                Value::from(name),
                "it in a scenario with `pieces`".into(),
                format!("`{name}` is done with pieces, and there are none"),
            ));
        }
    }
    let filled = parts.has_stage("deposit") || parts.begun_after.is_some();
    if own && !filled && parts.stages.iter().all(|s| s.name.is_some()) {
        faults.push(fault(
            "stages",
            "no `deposit`",
            "at least one".into(),
            "no grain would get into the laboratory".into(),
        ));
    }
}

fn check_deposit(spec: &StageSpec, add: &mut impl FnMut(&str, String, &str, &str)) {
    let StageSpec::Deposit { how, area_mm, diameter_mm, rate_g_per_s, sizes_mm, .. } = spec else {
        return;
    };
    if area_mm.is_some() == diameter_mm.is_some() {
        add("area_mm", String::new(), "`area_mm` or `diameter_mm`", "a deposit has one area");
    }
    if let Some(sides) = area_mm.filter(|sides| !sides.iter().all(|side| *side > 0.0)) {
        add("area_mm", format!("{sides:?}"), "numbers above 0", "the area is none");
    }
    match (how, rate_g_per_s) {
        (DepositKind::Rain, None) => {
            add("rate_g_per_s", String::new(), "a number above 0", "rain needs its rate");
        }
        (DepositKind::Lattice, Some(rate)) => add(
            "rate_g_per_s",
            rate.to_string(),
            "the field left out",
            "grains of a lattice begin all at once",
        ),
        _ => {}
    }
    if let Some([low, high]) = sizes_mm.filter(|[low, high]| !(*low >= 0.0 && low < high)) {
        add(
            "sizes_mm",
            format!("[{low}, {high}]"),
            "two openings, the finer first",
            "no grain is of that size",
        );
    }
}

/// Whether the pieces that stages speak of stand then.
fn check_who_stands(parts: &Parts, faults: &mut Vec<Fault>) {
    let known: Vec<&str> = parts.pieces().map(|(_, piece)| piece.name.as_str()).collect();
    // A piece that cannot be read may have any name.
    if !parts.has_pieces() || known.len() < parts.pieces.len() {
        return;
    }
    let mut removed: HashSet<&str> = HashSet::new();
    for (i, stage) in parts.stages.iter().enumerate() {
        let field = |k: usize| format!("stages[{i}].pieces[{k}]");
        let of_load = |k: usize| format!("stages[{i}].loads[{k}].piece");
        let (names, path, takes): (Vec<&String>, &dyn Fn(usize) -> String, bool) = match &stage.spec
        {
            Some(StageSpec::Move { pieces, .. }) => (pieces.iter().collect(), &field, false),
            Some(StageSpec::Release { pieces, .. }) => (pieces.iter().collect(), &field, false),
            Some(StageSpec::Remove { pieces, .. }) => (pieces.iter().collect(), &field, true),
            Some(StageSpec::Press { loads, .. }) => {
                (loads.iter().map(|load| &load.piece).collect(), &of_load, false)
            }
            _ => continue,
        };
        for (k, name) in names.iter().enumerate() {
            let message = match () {
                () if !known.contains(&name.as_str()) => "there is no such piece",
                () if removed.contains(name.as_str()) => "the piece was removed before",
                () => continue,
            };
            let standing: Vec<&str> =
                known.iter().filter(|name| !removed.contains(**name)).copied().collect();
            faults.push(fault(
                &path(k),
                Value::from(name.as_str()),
                standing.join(", "),
                message.into(),
            ));
        }
        if takes {
            removed.extend(names.iter().map(|name| name.as_str()));
        }
    }
}

fn check_measures(parts: &Parts, measures: &MeasuresSpec, faults: &mut Vec<Fault>) {
    if !measures.is_empty() && !parts.has_pieces() {
        faults.push(fault(
            "measures",
            "regions, openings or groups",
            "the field left out".into(),
            "these are measured in a laboratory of `pieces`".into(),
        ));
    }
    for (i, region) in measures.regions.iter().enumerate() {
        if !region.low_mm.iter().zip(&region.high_mm).all(|(low, high)| low < high) {
            faults.push(fault(
                &format!("measures.regions[{i}].high_mm"),
                format!("{:?}", region.high_mm),
                "a corner above and beyond `low_mm` in every direction".into(),
                "the region holds nothing".into(),
            ));
        }
    }
    check_groups(parts, measures, faults);
    for (i, opening) in measures.openings.iter().enumerate() {
        if opening.direction.iter().all(|x| *x == 0.0) {
            faults.push(fault(
                &format!("measures.openings[{i}].direction"),
                "0",
                "not all of it 0".into(),
                "the opening has no direction".into(),
            ));
        }
    }
    let regions = measures.regions.iter().map(|r| ("regions", &r.name));
    let openings = measures.openings.iter().map(|o| ("openings", &o.name));
    let groups = measures.groups.iter().map(|g| ("groups", &g.name));
    let mut known = HashSet::new();
    // Groups have the columns that pieces have.
    let pieces: HashSet<&String> = parts.pieces().map(|(_, piece)| &piece.name).collect();
    for (list, name) in regions.chain(openings).chain(groups) {
        if !known.insert(name)
            || (list == "groups" && pieces.contains(name))
            || !name.chars().all(|c| c.is_ascii_alphanumeric() || "-_".contains(c))
        {
            faults.push(fault(
                &format!("measures.{list}"),
                Value::from(name.as_str()),
                "names of their own, of letters, digits, `-` and `_`".into(),
                "results could not be told apart by this name".into(),
            ));
        }
    }
}

/// Whether the pieces of groups are there, each once.
fn check_groups(parts: &Parts, measures: &MeasuresSpec, faults: &mut Vec<Fault>) {
    let known: Vec<&str> = parts.pieces().map(|(_, piece)| piece.name.as_str()).collect();
    // A piece that cannot be read may have any name.
    if !parts.has_pieces() || known.len() < parts.pieces.len() {
        return;
    }
    for (i, group) in measures.groups.iter().enumerate() {
        for (k, name) in group.pieces.iter().enumerate() {
            let message = match () {
                () if !known.contains(&name.as_str()) => "there is no such piece",
                () if group.pieces[..k].contains(name) => "the piece is in the group already",
                () => continue,
            };
            faults.push(fault(
                &format!("measures.groups[{i}].pieces[{k}]"),
                Value::from(name.as_str()),
                known.join(", "),
                message.into(),
            ));
        }
    }
}

impl Parts {
    /// Whether the scenario has an apparatus of its own.
    pub(super) fn has_pieces(&self) -> bool {
        !self.pieces.is_empty()
    }

    /// The pieces that could be read, with their numbers.
    pub(super) fn pieces(&self) -> impl Iterator<Item = (usize, &PieceSpec)> {
        self.pieces.iter().enumerate().filter_map(|(i, piece)| Some((i, piece.as_ref()?)))
    }
}
