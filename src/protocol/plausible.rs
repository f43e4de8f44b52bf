//! Whether a state that was read from a file can be that of a specimen in this laboratory.

use super::*;
use crate::plain::{components, counted};

/// How far the length of a quaternion may be from 1: engines keep some in single precision.
const UNIT: f64 = 1e-3;

/// Share of the energy of a free fall from the rim that what fell over it has at
/// least: it may have rubbed along the wall.
const FALL_SHARE: f64 = 0.1;

/// What every state of a world is checked against, on a table whose peak speed is given in m/s:
/// what it meets may leave with twice that.
pub(super) fn check(setup: &Setup, table_peak: f64) -> RunTimeCheck {
    // Falling heights, tables and apparatus are typed, and may be large for small grains.
    RunTimeCheck {
        speed: scale::LARGEST_SPEED.no_less(&setup.scale) + 2.0 * table_peak,
        angular_speed: scale::LARGEST_SPIN.at(&setup.scale),
        distance: scale::LARGEST_DISTANCE.no_less(&setup.scale),
    }
}

/// Whether a specimen whose state has passed [`SpecimenState::check`] can be one of this
/// laboratory: a state for each grain, all numbers finite, nothing too fast or too far, nothing
/// inside or behind walls. The check before it also says whether contacts and fixed grains are of
/// grains that are there.
///
/// The funnel, where it stands, has a collar of a height in m; the table's peak speed is in m/s.
///
/// # Errors
/// What is wrong, in words.
pub fn plausible(
    setup: &Setup,
    specimen: &Specimen,
    collar_m: f64,
    table_peak: f64,
) -> Result<(), String> {
    let Specimen { grains, state } = specimen;
    let (found, expected) = (state.bodies.len(), grains.grains.len());
    if found != expected {
        let [bodies, of] = [(found, "body"), (expected, "grain")].map(|(n, one)| counted(n, one));
        return Err(format!("it has {bodies} for {of}"));
    }
    finite(state)?;
    let of_grains = state.bodies.iter().map(|g| (g.fate == Fate::Present).then_some(g.body));
    let snapshot: Snapshot = of_grains.chain([state.top_plate]).collect();
    let name = |index: usize| match index < expected {
        true => name_of(&Party::Grain(index), setup),
        false => name_of(&Party::Other(Other::TopPlate), setup),
    };
    check(setup, table_peak).check(&snapshot, state.time, name).map_err(|e| e.to_string())?;
    let funnel = |f: crate::specimen::FunnelState| {
        Funnel::new(&setup.funnel, f.opening_height, collar_m).map_err(|e| e.to_string())
    };
    let funnel = state.funnel.map(funnel).transpose()?;
    let pieces = setup.pieces.len();
    if !state.pieces.is_empty() && state.pieces.len() != pieces {
        let found = state.pieces.len();
        let found = counted(found, "piece");
        return Err(format!("it has {found} of apparatus, and the scenario {pieces}"));
    }
    let mut walls = Whereabouts::of(setup, specimen, funnel.as_ref());
    if pieces > 0 {
        // They may be anywhere: a stage that moves them knows how low they reach.
        walls.floor_at(-f64::MAX);
    }
    for index in specimen.present() {
        let body = &state.bodies[index].body;
        let at = level(body.pose.translation.vector, state);
        // What went over the rim falls beside the walls until it is taken away.
        let fallen = (walls.rim(at.z) - at.z).max(0.0) * setup.gravity;
        let down = -body.linear_velocity.z;
        let falls = down > 0.0 && down * down / 2.0 >= FALL_SHARE * fallen;
        if at.z < walls.lowest() || walls.is_outside(&at, state.table_x) && !falls {
            let (grain, [x, y, z]) = (grain_name(index), components::<3>((at * 1e3).into()));
            return Err(format!("{grain} is outside of the apparatus, at ({x}, {y}, {z}) mm"));
        }
    }
    Ok(())
}

/// Whether those numbers are finite and in range that [`SpecimenState::check`] does not look at.
fn finite(state: &SpecimenState) -> Result<(), String> {
    let body = |b: &BodyState| {
        let pose = &b.pose;
        let length = pose.rotation.quaternion().norm();
        let vectors = [&pose.translation.vector, &b.linear_velocity, &b.angular_velocity];
        (length - 1.0).abs() <= UNIT && vectors.iter().all(|v| v.iter().all(|x| x.is_finite()))
    };
    if let Some(index) = state.bodies.iter().position(|g| !body(&g.body)) {
        let grain = grain_name(index);
        return Err(format!("place, orientation or velocity of {grain} is no number"));
    }
    if !state.top_plate.as_ref().is_none_or(body) {
        return Err("place, orientation or velocity of the top plate is no number".to_owned());
    }
    if !(state.time >= 0.0 && state.time.is_finite() && state.table().norm().is_finite()) {
        return Err("its time, or where the table is, is no number".to_owned());
    }
    let contact = |c: &SavedContact| c.warm_start >= 0.0 && c.warm_start.is_finite();
    if let Some(index) = state.contacts.iter().position(|c| !contact(c)) {
        return Err(format!(
            "contact {index} is of a grain that is not there, or holds what is no number"
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::protocol::testing::*;
    use crate::scale::Scale;
    use crate::specimen::FunnelState;

    /// Some grains in the cylinder, on a grid, not touching its walls.
    fn laboratory() -> (Setup, Specimen) {
        let grains = json!({ "total_mass_g": 20, "density_kg_per_m3": 2673.9 });
        let scenario = scenario_of(json!({ "grains": grains }));
        let mut specimen = specimen_of(&scenario, 1);
        specimen.state.cylinder = true;
        for (n, grain) in specimen.state.bodies.iter_mut().enumerate() {
            let pose = Pose::translation(0.0, 0.0, 0.01 + 0.015 * n as f64);
            grain.body = BodyState::at_rest(pose);
        }
        (Setup::new(&scenario).expect("a laboratory"), specimen)
    }

    #[test]
    fn what_can_be_passes() {
        let (setup, sound) = laboratory();
        plausible(&setup, &sound, 0.0, 0.0).expect("law: grains in the cylinder can be");
        let mut falling = sound.clone();
        let beside = &mut falling.state.bodies[0].body;
        *beside = BodyState::at_rest(Pose::translation(0.2, 0.0, 0.02));
        beside.linear_velocity.z = -1.0;
        plausible(&setup, &falling, 0.0, 0.0).expect("law: what went over the rim falls beside it");
        let mut gone = sound;
        gone.state.bodies[0].fate = Fate::Spilled;
        gone.state.bodies[0].body.pose.translation.vector.z = -5.0;
        plausible(&setup, &gone, 0.0, 0.0).expect("law: a grain that was taken away is anywhere");
    }

    fn contact(warm_start: f64) -> SavedContact {
        SavedContact {
            between: [Party::Grain(0), Party::Grain(1)],
            point_m: Vector::zeros(),
            normal: Vector::z(),
            force_n: Vector::z(),
            warm_start,
            feature: [0; 2],
        }
    }

    #[test]
    fn what_cannot_be_is_named() {
        type Craft = fn(&mut SpecimenState);
        let crafted: [(&str, Craft); 18] = [
            ("1 body", |s| s.bodies.truncate(1)),
            ("bodies", |s| s.bodies.push(s.bodies[0])),
            ("grain_00001", |s| s.bodies[1].body.linear_velocity.x = f64::NAN),
            ("orientation", |s| s.bodies[1].body.pose.rotation.as_mut_unchecked().coords *= 2.0),
            ("grain_00001 at", |s| s.bodies[1].body.linear_velocity.x = 100.0),
            ("has a speed of 100 m/s", |s| s.bodies[1].body.linear_velocity.x = 100.0),
            ("distance", |s| s.bodies[1].body.pose.translation.vector.x = 1e3),
            ("outside", |s| s.bodies[1].body.pose.translation.vector.x = 0.2),
            ("outside", |s| {
                s.bodies[1].body.pose.translation.vector.x = 0.2;
                s.bodies[1].body.linear_velocity.z = -3e-10; // as of one at rest
            }),
            ("outside", |s| s.bodies[1].body.pose.translation.vector.z = -0.3),
            ("outside", |s| s.table_x = 0.5),
            ("time", |s| s.time = f64::INFINITY),
            ("time", |s| s.time = -1.0),
            ("table", |s| s.table_x = f64::NAN),
            ("top plate", |s| {
                let mut plate = s.bodies[0].body;
                plate.angular_velocity.y = f64::NAN;
                s.top_plate = Some(plate);
            }),
            // Falling, but below everything.
            ("outside", |s| {
                s.bodies[1].body.pose.translation.vector.z = -0.3;
                s.bodies[1].body.linear_velocity.z = -3.0;
            }),
            ("contact 0", |s| s.contacts.push(contact(f64::NAN))),
            ("contact 0", |s| s.contacts.push(contact(-0.1))),
        ];
        for (index, (word, craft)) in crafted.into_iter().enumerate() {
            let (setup, mut specimen) = laboratory();
            craft(&mut specimen.state);
            let said = plausible(&setup, &specimen, 0.0, 0.0).expect_err("law: it cannot be");
            assert!(said.contains(word), "law: case {index} names {word}, got {said}");
        }
    }

    /// Law: places in a laboratory of sand have their digits in messages.
    #[test]
    fn a_place_in_a_small_laboratory_has_digits() {
        let (mut setup, mut specimen) = laboratory();
        setup.cylinder.radius = 1e-4;
        setup.funnel.wall_thickness_mm = 0.01;
        let at = &mut specimen.state.bodies[1].body.pose.translation.vector;
        *at = Vector::new(1.2346e-3, -2e-5, 0.0);
        let said = plausible(&setup, &specimen, 0.0, 0.0).expect_err("law: it is in no cylinder");
        assert!(said.contains("grain_00001"), "law: it is named, got {said}");
        assert!(said.contains("at (1.235, -0.02, 0) mm"), "law: not (1.2, -0.0, 0.0), got {said}");
    }

    #[test]
    fn limits_follow_the_size_and_are_no_less_than_the_papers() {
        let (mut setup, sound) = laboratory();
        // Speeds by √d, distances by d: for grains 25 times as large 100 m/s and 500 m.
        for (larger, speed, distance, can) in [
            (1.0, 19.0, 19.0, true),
            (1.0, 21.0, 0.0, false),
            (1.0, 0.0, 21.0, false),
            (1.0 / 16.0, 19.0, 19.0, true),
            (25.0, 99.0, 499.0, true),
            (25.0, 101.0, 0.0, false),
            (25.0, 0.0, 501.0, false),
        ] {
            setup.scale = Scale::of_smallest(0.008 * larger, Scale::PAPER.gravity);
            let mut body = sound.state.bodies[0].body;
            body.pose.translation.vector = Vector::new(distance, 0.0, 0.0);
            body.linear_velocity = Vector::new(0.0, speed, 0.0);
            let name = |n| format!("grain {n}");
            let got = check(&setup, 0.0).check(&vec![Some(body)], 0.0, name).is_ok();
            assert_eq!(got, can, "law: at {larger} times the size, {speed} m/s at {distance} m");
        }
    }

    #[test]
    fn a_filled_funnel_can_be_and_grains_beside_it_cannot() {
        let (setup, mut specimen) = laboratory();
        let opening_height = setup.cylinder.height;
        specimen.state.cylinder = false;
        specimen.state.funnel = Some(FunnelState { opening_height, lid: true });
        for grain in &mut specimen.state.bodies {
            grain.body.pose.translation.vector.z += opening_height;
        }
        plausible(&setup, &specimen, 0.0, 0.0).expect("law: grains in the funnel can be");
        let at = &mut specimen.state.bodies[0].body.pose.translation.vector;
        (at.x, at.z) = (1.0, opening_height + 0.05);
        plausible(&setup, &specimen, 0.0, 0.0).expect_err("law: nothing stands beside the funnel");
    }
}
