//! What the files show: grains, apparatus, contacts, force chains.

use std::{collections::BTreeMap, sync::Arc};

use rayon::prelude::*;

use super::xml::{LINES, POLYS, PolyData, VERTS, Values};
use crate::export::moments::Moment;
use crate::export::parts::Part;
use crate::geometry::{Point, Vector};
use crate::grains::{GrainSet, sieve_size};
use crate::measure::neighbours;
use crate::protocol::Setup;
use crate::specimen::{Other, Party, SavedContact, SpecimenState};

/// The side of the square opening that each grain passes, in m.
pub fn sieve_sizes(grains: &GrainSet) -> Vec<f64> {
    grains.grains.par_iter().map(|g| sieve_size(&g.shape)).collect()
}

/// The grains that take part: their faces, each with what is known of its grain.
pub fn grains(moment: &Moment, set: &Arc<GrainSet>, sizes: &[f64]) -> PolyData {
    let specimen = moment.specimen(set);
    let present: Vec<usize> = specimen.present().collect();
    let mut data = PolyData::new(POLYS);
    let mut faces = Vec::with_capacity(present.len());
    for &n in &present {
        let shape = &set.grains[n].shape;
        let pose = &specimen.state.bodies[n].body.pose;
        let numbers: Vec<usize> =
            shape.vertices().iter().map(|v| data.point(&(pose * v))).collect();
        for face in shape.faces() {
            data.cell(face.iter().map(|&v| numbers[v as usize]));
        }
        faces.push(shape.faces().len());
    }
    let touching = neighbours(&specimen);
    let ints = |of: &dyn Fn(usize) -> i32| Values::ints(present.iter().map(|&n| of(n)));
    let floats = |of: &dyn Fn(usize) -> Option<f64>| Values::floats(present.iter().map(|&n| of(n)));
    let of_grains = [
        ("grain", ints(&|n| n as i32)),
        ("sieve_fraction", ints(&|n| set.grains[n].fraction as i32)),
        ("sieve_size_m", floats(&|n| Some(sizes[n]))),
        ("mass_kg", floats(&|n| Some(set.grains[n].mass))),
        ("speed_m_per_s", floats(&|n| moment.speed(n))),
        ("displacement_m", floats(&|n| moment.displacement(n))),
        ("coordination_number", ints(&|n| touching[n] as i32)),
    ];
    data.cell_data =
        of_grains.into_iter().map(|(name, values)| (name, values.repeated(&faces))).collect();
    data
}

/// The parts of the apparatus that stand; `part` counts them in their order.
pub fn apparatus(moment: &Moment, parts: &[Part]) -> PolyData {
    let mut data = PolyData::new(POLYS);
    let mut kinds = Vec::new();
    for (number, part) in parts.iter().enumerate() {
        let Some(pose) = part.pose(&moment.frame) else { continue };
        for face in &part.faces {
            let corners: Vec<usize> = face.iter().map(|p| data.point(&(pose * p))).collect();
            data.cell(corners.into_iter());
            kinds.push(number as i32);
        }
    }
    data.cell_data = vec![("part", Values::ints(kinds))];
    data
}

/// A grain's number, or a negative one for what is no grain: -1 top plate, -2 cylinder, -3 floor,
/// -4 funnel or lid, -5 a pile's base; -10 and below the pieces of a laboratory.
pub fn party_number(setup: &Setup, party: Party) -> i32 {
    let floor = setup.cylinder.pieces.len().saturating_sub(1);
    match party {
        Party::Grain(n) => n as i32,
        Party::Other(Other::TopPlate) => -1,
        Party::Other(Other::Cylinder(n)) if n == floor => -3,
        Party::Other(Other::Cylinder(_)) => -2,
        Party::Other(Other::Funnel(_)) => -4,
        Party::Other(Other::Base(_)) => -5,
        Party::Other(Other::Piece(piece, _)) => -10 - piece as i32,
    }
}

/// The force across a contact along its normal, in N; positive where it pushes.
fn normal_force(contact: &SavedContact) -> f64 {
    contact.force_n.dot(&contact.normal)
}

/// The loaded contacts as points, with force and normal.
pub fn contacts(setup: &Setup, state: &SpecimenState) -> PolyData {
    let mut data = PolyData::new(VERTS);
    for contact in &state.contacts {
        let number = data.point(&Point::from(contact.point_m));
        data.cell(std::iter::once(number));
    }
    let all = || state.contacts.iter();
    let party = |which: usize| Values::ints(all().map(|c| party_number(setup, c.between[which])));
    data.point_data = vec![
        ("first", party(0)),
        ("second", party(1)),
        ("force_n", Values::floats(all().map(|c| Some(c.force_n.norm())))),
        ("normal_force_n", Values::floats(all().map(|c| Some(normal_force(c))))),
        ("force_vector_n", Values::vectors(all().map(|c| c.force_n))),
        ("normal", Values::vectors(all().map(|c| c.normal))),
    ];
    data
}

/// Two bodies that bear on each other, with all their contacts.
#[derive(Debug, Default)]
struct Bond {
    /// On the first.
    force: Vector,
    normal_force: f64,
    points: Vec<Vector>,
}

/// Lines of force: one for every two bodies that bear on each other, between their centroids; where
/// one is no grain, from the grain's centroid to the mean point of contact.
pub fn chains(setup: &Setup, state: &SpecimenState) -> PolyData {
    let mut bonds: BTreeMap<[Party; 2], Bond> = BTreeMap::new();
    for contact in &state.contacts {
        let [a, b] = contact.between;
        let (between, force) =
            if a <= b { ([a, b], contact.force_n) } else { ([b, a], -contact.force_n) };
        let bond = bonds.entry(between).or_default();
        bond.force += force;
        bond.normal_force += normal_force(contact);
        bond.points.push(contact.point_m);
    }
    let mut data = PolyData::new(LINES);
    for (between, bond) in &bonds {
        let mean = bond.points.iter().sum::<Vector>() / bond.points.len() as f64;
        let ends = between.map(|party| match party {
            Party::Grain(n) => state.bodies[n].body.pose.translation.vector,
            Party::Other(_) => mean,
        });
        let numbers = ends.map(|end| data.point(&Point::from(end)));
        data.cell(numbers.into_iter());
    }
    let party = |which: usize| {
        Values::ints(bonds.keys().map(|between| party_number(setup, between[which])))
    };
    data.cell_data = vec![
        ("first", party(0)),
        ("second", party(1)),
        ("force_n", Values::floats(bonds.values().map(|b| Some(b.force.norm())))),
        ("normal_force_n", Values::floats(bonds.values().map(|b| Some(b.normal_force)))),
    ];
    // Tubes take their width from points: each line has two of its own.
    let twice = vec![2; data.cells()];
    data.point_data =
        data.cell_data.iter().map(|(name, values)| (*name, values.repeated(&twice))).collect();
    data
}
