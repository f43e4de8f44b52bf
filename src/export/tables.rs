//! Tables of a specimen in SI units: grains, loaded contacts, touching pairs.

use serde::Serialize;

use super::exchange::party_name;
use crate::measure::{TOUCHING_GAP, pairs_within};
use crate::protocol::Setup;
use crate::record::to_csv;
use crate::specimen::{Fate, Specimen};

/// One grain.
#[derive(Debug, Serialize)]
struct GrainRow {
    grain: usize,
    fate: Fate,
    mass_kg: f64,
    volume_m3: f64,
    equivalent_diameter_m: f64,
    x_m: f64,
    y_m: f64,
    z_m: f64,
    quaternion_x: f64,
    quaternion_y: f64,
    quaternion_z: f64,
    quaternion_w: f64,
    velocity_x_m_per_s: f64,
    velocity_y_m_per_s: f64,
    velocity_z_m_per_s: f64,
    angular_velocity_x_rad_per_s: f64,
    angular_velocity_y_rad_per_s: f64,
    angular_velocity_z_rad_per_s: f64,
}

/// One loaded contact.
#[derive(Debug, Serialize)]
struct ContactRow {
    first: String,
    second: String,
    x_m: f64,
    y_m: f64,
    z_m: f64,
    normal_x: f64,
    normal_y: f64,
    normal_z: f64,
    force_x_n: f64,
    force_y_n: f64,
    force_z_n: f64,
}

/// Two grains that touch.
#[derive(Debug, Serialize)]
struct PairRow {
    first: usize,
    second: usize,
    gap_m: f64,
    overlap_percent: f64,
}

/// One row a grain, also for those that left the apparatus (where they were
/// last seen): centroid, orientation of the principal axes, velocities in
/// world axes.
///
/// # Errors
/// As [`to_csv`].
pub fn grains_csv(specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let grains = specimen.grains.grains.iter().zip(&specimen.state.bodies);
    to_csv(grains.enumerate().map(|(n, (grain, state))| {
        let body = &state.body;
        let (at, q) = (body.pose.translation.vector, body.pose.rotation.coords);
        let (v, w) = (body.linear_velocity, body.angular_velocity);
        GrainRow {
            grain: n,
            fate: state.fate,
            mass_kg: grain.mass,
            volume_m3: grain.volume,
            equivalent_diameter_m: grain.equivalent_diameter,
            x_m: at.x,
            y_m: at.y,
            z_m: at.z,
            quaternion_x: q.x,
            quaternion_y: q.y,
            quaternion_z: q.z,
            quaternion_w: q.w,
            velocity_x_m_per_s: v.x,
            velocity_y_m_per_s: v.y,
            velocity_z_m_per_s: v.z,
            angular_velocity_x_rad_per_s: w.x,
            angular_velocity_y_rad_per_s: w.y,
            angular_velocity_z_rad_per_s: w.z,
        }
    }))
}

/// One row a loaded contact: point midway between the surfaces, unit normal
/// from the second to the first, force on the first. Where the
/// engine gave no contacts, the file is empty.
///
/// # Errors
/// As [`to_csv`].
pub fn contacts_csv(setup: &Setup, specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    to_csv(specimen.state.contacts.iter().map(|c| ContactRow {
        first: party_name(setup, c.between[0]),
        second: party_name(setup, c.between[1]),
        x_m: c.point_m.x,
        y_m: c.point_m.y,
        z_m: c.point_m.z,
        normal_x: c.normal.x,
        normal_y: c.normal.y,
        normal_z: c.normal.z,
        force_x_n: c.force_n.x,
        force_y_n: c.force_n.y,
        force_z_n: c.force_n.z,
    }))
}

/// One row for every two grains that touch, measured outside any engine: gap,
/// negative where they overlap, and the overlap in percent of the mean of
/// their equivalent diameters (0 where they do not).
///
/// # Errors
/// As [`to_csv`].
pub fn pairs_csv(specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let present: Vec<usize> = specimen.present().collect();
    let grains = &specimen.grains.grains;
    to_csv(pairs_within(specimen, &present, TOUCHING_GAP).iter().map(|p| {
        let sizes = grains[p.a].equivalent_diameter + grains[p.b].equivalent_diameter;
        let overlap_percent = 100.0 * (-p.gap).max(0.0) / (sizes / 2.0);
        PairRow { first: p.a, second: p.b, gap_m: p.gap, overlap_percent }
    }))
}
