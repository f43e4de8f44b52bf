//! Tables of a specimen: grains, loaded contacts, touching pairs. Grains are named and quantities
//! have the units as in the run's own tables: mm, mm³, g, mm/s, and N.

use super::*;
use crate::measure::{pairs_within, touching_gap};
use crate::record::to_csv;
use crate::units::{to_g, to_mm, to_mm3};

#[derive(Debug, Serialize)]
struct GrainRow {
    grain: String,
    fate: Fate,
    mass_g: f64,
    volume_mm3: f64,
    equivalent_diameter_mm: f64,
    x_mm: f64,
    y_mm: f64,
    z_mm: f64,
    rotation_x: f64,
    rotation_y: f64,
    rotation_z: f64,
    rotation_w: f64,
    velocity_x_mm_per_s: f64,
    velocity_y_mm_per_s: f64,
    velocity_z_mm_per_s: f64,
    angular_velocity_x_rad_per_s: f64,
    angular_velocity_y_rad_per_s: f64,
    angular_velocity_z_rad_per_s: f64,
}

#[derive(Debug, Default, Serialize)]
struct ContactRow {
    first: String,
    second: String,
    x_mm: f64,
    y_mm: f64,
    z_mm: f64,
    normal_x: f64,
    normal_y: f64,
    normal_z: f64,
    force_x_n: f64,
    force_y_n: f64,
    force_z_n: f64,
}

#[derive(Debug, Default, Serialize)]
struct PairRow {
    first: String,
    second: String,
    gap_mm: f64,
    overlap_percent: f64,
}

/// Rows as CSV; where there are none, the header alone.
fn with_header<T: Serialize + Default>(
    rows: impl IntoIterator<Item = T>,
) -> Result<Vec<u8>, csv::Error> {
    let table = to_csv(rows)?;
    if !table.is_empty() {
        return Ok(table);
    }
    let sample = to_csv([T::default()])?;
    Ok(sample.split_inclusive(|byte| *byte == b'\n').next().unwrap_or_default().to_vec())
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
            grain: grain_name(n),
            fate: state.fate,
            mass_g: to_g(grain.mass),
            volume_mm3: to_mm3(grain.volume),
            equivalent_diameter_mm: to_mm(grain.equivalent_diameter),
            x_mm: to_mm(at.x),
            y_mm: to_mm(at.y),
            z_mm: to_mm(at.z),
            rotation_x: q.x,
            rotation_y: q.y,
            rotation_z: q.z,
            rotation_w: q.w,
            velocity_x_mm_per_s: to_mm(v.x),
            velocity_y_mm_per_s: to_mm(v.y),
            velocity_z_mm_per_s: to_mm(v.z),
            angular_velocity_x_rad_per_s: w.x,
            angular_velocity_y_rad_per_s: w.y,
            angular_velocity_z_rad_per_s: w.z,
        }
    }))
}

/// One row a loaded contact: point midway between the surfaces, unit normal
/// from the second to the first, force on the first. Where the
/// engine gave no contacts, the header alone.
///
/// # Errors
/// As [`to_csv`].
pub fn contacts_csv(setup: &Setup, specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let row = |c: &SavedContact| ContactRow {
        first: party_name(setup, c.between[0]),
        second: party_name(setup, c.between[1]),
        x_mm: to_mm(c.point_m.x),
        y_mm: to_mm(c.point_m.y),
        z_mm: to_mm(c.point_m.z),
        normal_x: c.normal.x,
        normal_y: c.normal.y,
        normal_z: c.normal.z,
        force_x_n: c.force_n.x,
        force_y_n: c.force_n.y,
        force_z_n: c.force_n.z,
    };
    with_header(specimen.state.contacts.iter().map(row))
}

/// One row for every two grains that touch, measured outside any engine: gap,
/// negative where they overlap, and the overlap in percent of the mean of
/// their equivalent diameters (0 where they do not). Where none do, the header
/// alone.
///
/// # Errors
/// As [`to_csv`].
pub fn pairs_csv(specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let present: Vec<usize> = specimen.present().collect();
    let grains = &specimen.grains.grains;
    let touching = pairs_within(specimen, &present, touching_gap(&specimen.grains));
    let rows = touching.iter().map(|p| {
        let sizes = grains[p.a].equivalent_diameter + grains[p.b].equivalent_diameter;
        let overlap_percent = 100.0 * (-p.gap).max(0.0) / (sizes / 2.0);
        PairRow {
            first: grain_name(p.a),
            second: grain_name(p.b),
            gap_mm: to_mm(p.gap),
            overlap_percent,
        }
    });
    with_header(rows)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_table_without_rows_has_the_header_of_one_with_them() {
        let pair = || PairRow { first: grain_name(0), second: grain_name(1), ..PairRow::default() };
        let text = |rows: Vec<PairRow>| {
            String::from_utf8(with_header(rows).expect("a table")).expect("UTF-8")
        };
        let (none, one) = (text(Vec::new()), text(vec![pair()]));
        assert_eq!(none, "first,second,gap_mm,overlap_percent\n", "law: the header alone");
        assert_eq!(one.lines().next(), none.lines().next(), "law: of the same columns");
        let contacts = with_header(Vec::<ContactRow>::new()).expect("a table");
        let expected = "first,second,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z,\
                        force_x_n,force_y_n,force_z_n\n";
        assert_eq!(contacts, expected.as_bytes(), "law: of contacts");
    }
}
