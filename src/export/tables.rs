//! Tables of a specimen: grains, loaded contacts, touching pairs. Grains are named and quantities
//! have the units as in the run's own tables: mm, mm³, g, mm/s, and N.

use super::*;
use crate::measure::{pairs_within, touching_gap};
use crate::record::csv_of;
use crate::units::{to_g, to_mm, to_mm3};

/// Columns of [`grains_csv`], in the order of its cells.
const GRAINS: &str = "grain,fate,mass_g,volume_mm3,equivalent_diameter_mm,x_mm,y_mm,z_mm,\
                      rotation_x,rotation_y,rotation_z,rotation_w,\
                      velocity_x_mm_per_s,velocity_y_mm_per_s,velocity_z_mm_per_s,\
                      angular_velocity_x_rad_per_s,angular_velocity_y_rad_per_s,\
                      angular_velocity_z_rad_per_s";

/// Columns of [`contacts_csv`], in the order of its cells.
const CONTACTS: &str = "first,second,x_mm,y_mm,z_mm,normal_x,normal_y,normal_z,\
                        force_x_n,force_y_n,force_z_n";

/// Columns of [`pairs_csv`], in the order of its cells.
const PAIRS: &str = "first,second,gap_mm,overlap_percent";

fn in_mm(of: &Vector) -> [f64; 3] {
    [to_mm(of.x), to_mm(of.y), to_mm(of.z)]
}

/// One row a grain, also for those that left the apparatus (where they were last seen): centroid,
/// orientation of the principal axes, velocities in world axes.
///
/// # Errors
/// The writer's; writing to memory does not fail.
pub fn grains_csv(specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let grains = specimen.grains.grains.iter().zip(&specimen.state.bodies);
    let rows = grains.enumerate().map(|(n, (grain, state))| {
        let body = &state.body;
        let (q, w) = (body.pose.rotation.coords, body.angular_velocity);
        (
            (grain_name(n), state.fate),
            [to_g(grain.mass), to_mm3(grain.volume), to_mm(grain.equivalent_diameter)],
            in_mm(&body.pose.translation.vector),
            [q.x, q.y, q.z, q.w],
            in_mm(&body.linear_velocity),
            [w.x, w.y, w.z],
        )
    });
    csv_of(GRAINS, rows)
}

/// One row a loaded contact: point midway between the surfaces, unit normal from the second to the
/// first, force on the first. Where the engine gave no contacts, the header alone.
///
/// # Errors
/// The writer's; writing to memory does not fail.
pub fn contacts_csv(setup: &Setup, specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let row = |c: &SavedContact| {
        let names = c.between.map(|party| party_name(setup, party));
        let (n, f) = (c.normal, c.force_n);
        (names, in_mm(&c.point_m), [n.x, n.y, n.z], [f.x, f.y, f.z])
    };
    csv_of(CONTACTS, specimen.state.contacts.iter().map(row))
}

/// One row for every two grains that touch, measured outside any engine: gap, negative where they
/// overlap, and the overlap in percent of the mean of their equivalent diameters (0 where they do
/// not). Where none do, the header alone.
///
/// # Errors
/// The writer's; writing to memory does not fail.
pub fn pairs_csv(specimen: &Specimen) -> Result<Vec<u8>, csv::Error> {
    let present: Vec<usize> = specimen.present().collect();
    let grains = &specimen.grains.grains;
    let touching = pairs_within(specimen, &present, touching_gap(&specimen.grains));
    let rows = touching.iter().map(|p| {
        let sizes = grains[p.a].equivalent_diameter + grains[p.b].equivalent_diameter;
        let overlap_percent = 100.0 * (-p.gap).max(0.0) / (sizes / 2.0);
        (grain_name(p.a), grain_name(p.b), to_mm(p.gap), overlap_percent)
    });
    csv_of(PAIRS, rows)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::export::testing;

    /// Law: cells stand below the names of their columns.
    #[test]
    fn cells_stand_below_the_names_of_their_columns() {
        let check = |table: Result<Vec<u8>, csv::Error>, expected: &[(&str, f64)]| {
            let text = String::from_utf8(table.expect("a table")).expect("UTF-8");
            let mut lines = text.lines().map(|line| line.split(',').collect::<Vec<&str>>());
            let (names, cells) = (lines.next().expect("a header"), lines.next().expect("a row"));
            for (name, value) in expected {
                let place = names.iter().position(|n| n == name).expect("a column");
                let cell: f64 = cells[place].parse().expect("a number");
                assert_eq!(cell, *value, "law: of the column {name}");
            }
        };
        let moments = testing::moments(&[3], 0.08);
        let state = moments.stages[0].end.clone();
        let specimen = Specimen { grains: moments.grains.clone(), state };
        let (grain, body) = (&specimen.grains.grains[0], &specimen.state.bodies[0].body);
        let of_grain = [
            ("mass_g", to_g(grain.mass)),
            ("volume_mm3", to_mm3(grain.volume)),
            ("equivalent_diameter_mm", to_mm(grain.equivalent_diameter)),
            ("x_mm", to_mm(body.pose.translation.vector.x)),
            ("z_mm", to_mm(body.pose.translation.vector.z)),
            ("rotation_z", body.pose.rotation.coords.z),
            ("rotation_w", body.pose.rotation.coords.w),
            ("velocity_z_mm_per_s", to_mm(body.linear_velocity.z)),
            ("angular_velocity_z_rad_per_s", body.angular_velocity.z),
        ];
        check(grains_csv(&specimen), &of_grain);
        let contact = &specimen.state.contacts[0];
        let of_contact = [
            ("x_mm", to_mm(contact.point_m.x)),
            ("z_mm", to_mm(contact.point_m.z)),
            ("normal_z", contact.normal.z),
            ("force_x_n", contact.force_n.x),
            ("force_z_n", contact.force_n.z),
        ];
        check(contacts_csv(&moments.setup, &specimen), &of_contact);
    }

    #[test]
    fn a_table_without_rows_has_the_header_of_one_with_them() {
        let text = |rows: Vec<([String; 2], f64)>| {
            let table = csv_of("first,second,gap_mm", rows).expect("a table");
            String::from_utf8(table).expect("UTF-8")
        };
        let (none, one) = (text(Vec::new()), text(vec![([0, 1].map(grain_name), -0.5)]));
        assert_eq!(none, "first,second,gap_mm\n", "law: the header alone");
        let expected = "first,second,gap_mm\ngrain_00000,grain_00001,-0.5\n";
        assert_eq!(one, expected, "law: of the same columns");
    }
}
