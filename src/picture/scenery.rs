//! A moment of a run as a scene: grains, walls, plate and ground.

use super::*;
use crate::apparatus::Piece;
use crate::export::{Carrier, as_state, standing};
use crate::protocol::Setup;

/// How cylinder and funnel are shown.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, clap::ValueEnum)]
pub enum Walls {
    /// As glass.
    #[default]
    Transparent,
    /// The near half cut away.
    Cut,
    /// Left out.
    Hidden,
}

/// Drawn thickness of walls, in inner radii of the cylinder. The simulated walls are thicker
/// outwards, so that no grain can pass them; their inner faces are where they are drawn.
const WALL_THICKNESS: f64 = 0.05;

/// Length of glass that lets 1/e of the light through, in drawn thicknesses.
const GLASS_DEPTH: f64 = 9.0;

/// Drawn thickness of walls in a laboratory, in m.
fn wall_thickness(setup: &Setup) -> f64 {
    WALL_THICKNESS * setup.cylinder.radius
}

/// Length of glass that lets 1/e of the light through, in m.
pub fn glass_depth(setup: &Setup) -> f64 {
    GLASS_DEPTH * wall_thickness(setup)
}

/// Everything there is at a moment; `colours` has one entry a grain.
pub fn scene_of(
    setup: &Setup,
    grains: &GrainSet,
    frame: &Frame,
    walls: Walls,
    view: &View,
    colours: &[Colour],
) -> Result<Scene, PictureError> {
    let mut bodies = Vec::new();
    for ((grain, pose), colour) in grains.grains.iter().zip(&frame.grains).zip(colours) {
        if let Some(pose) = pose {
            bodies.push(Body::new(Solid::new(&grain.shape, pose), *colour));
        }
    }
    if let Some(pose) = &frame.top_plate {
        bodies.push(Body::new(Solid::new(&setup.plate.shape, pose), Colour::PLATE));
    }
    let thickness = wall_thickness(setup);
    let mut ground = None;
    let pieces = standing(setup, grains, &as_state(frame)).map_err(PictureError::Apparatus)?;
    let of_laboratory = pieces.iter().filter(|standing| standing.carrier == Carrier::Kinematic);
    let middle = middle_of(of_laboratory.map(|standing| &standing.piece));
    for standing in pieces {
        let whole = Solid::new(&standing.piece.shape, &standing.piece.pose);
        let axis = match standing.name.starts_with("cylinder") {
            true => Vector::new(frame.table_x, 0.0, 0.0),
            false => Vector::zeros(),
        };
        match standing.name.as_str() {
            "floor" => {
                ground = Some(whole.low.z);
                bodies.push(Body::new(whole, Colour::FLOOR));
            }
            "lid" => {
                let bottom = Plane { normal: -Vector::z(), offset: thickness - whole.high.z };
                let low = Point::new(whole.low.x, whole.low.y, whole.high.z - thickness);
                let raised = |v: &mut Point| v.z = v.z.max(low.z);
                let mut thin = Solid { low, ..whole.cut(bottom) };
                thin.outline.iter_mut().for_each(raised);
                bodies.push(Body::new(thin, Colour::FLOOR));
            }
            // Which side of a piece is inside is not known: its parts are drawn whole.
            _ if standing.carrier == Carrier::Kinematic => {
                let name = standing.name.rsplit_once('_').map(|(piece, _)| piece);
                let of = setup.pieces.iter().find(|piece| Some(piece.name.as_str()) == name);
                let middle = of.is_none_or(|piece| piece.is_wall).then_some(&middle);
                bodies.extend(of_piece(whole, &standing.piece, middle, walls, view));
            }
            // What a pile lies on is no wall: it is drawn whole, and stays.
            name if name.starts_with("base_") => {
                ground = Some(ground.map_or(whole.low.z, |low: f64| low.min(whole.low.z)));
                bodies.push(Body::new(whole, Colour::FLOOR));
            }
            _ if walls == Walls::Hidden => {}
            _ => bodies.extend(wall(&standing.piece, whole, &axis, thickness, walls, view)),
        }
    }
    Ok(Scene::new(bodies, ground))
}

/// The middle of the box around some pieces; the origin without any.
fn middle_of<'a>(pieces: impl Iterator<Item = &'a Piece>) -> Vector {
    let solids = pieces.map(|piece| Solid::new(&piece.shape, &piece.pose));
    let boxes = solids.map(|solid| [solid.low, solid.high]);
    let whole = boxes.reduce(|[a, b], [low, high]| [a.inf(&low), b.sup(&high)]);
    whole.map_or_else(Vector::zeros, |[low, high]| (low.coords + high.coords) / 2.0)
}

/// A part of a piece of a laboratory; none where it is cut away, being nearer to the camera
/// than the middle of all of them, which a piece that stands among the grains does not get: it is
/// neither cut nor glass.
fn of_piece(
    whole: Solid,
    piece: &Piece,
    middle: Option<&Vector>,
    walls: Walls,
    view: &View,
) -> Option<Body> {
    match walls {
        Walls::Hidden => None,
        Walls::Transparent => {
            Some(Body { glass: middle.is_some(), ..Body::new(whole, Colour::WALL) })
        }
        Walls::Cut => {
            let size = whole.high - whole.low;
            // Last digits do not tell two sides apart that are as far away as the middle.
            let nearer = |m: &Vector| view.level().dot(&(piece.pose.translation.vector - m));
            let near = middle.is_some_and(|middle| nearer(middle) > 1e-6 * size.norm());
            // A floor stays: it hides nothing.
            let floor = size.z < size.x.min(size.y);
            (floor || !near).then(|| Body::new(whole, Colour::WALL))
        }
    }
}

/// A piece of a round wall, thinned from outside; none where it is cut away.
fn wall(
    piece: &Piece,
    whole: Solid,
    axis: &Vector,
    thickness: f64,
    walls: Walls,
    view: &View,
) -> Option<Body> {
    let thin = thinned(piece, whole, axis, thickness);
    if walls == Walls::Transparent {
        return Some(Body { glass: true, ..Body::new(thin, Colour::WALL) });
    }
    // The half towards the camera goes.
    let plane = Plane { normal: view.level(), offset: view.level().dot(axis) };
    let behind = |v: &Point| plane.normal.dot(&(piece.pose * v).coords) < plane.offset;
    if !piece.shape.vertices().iter().any(behind) {
        return None;
    }
    let sections_from = thin.planes.len();
    Some(Body { sections_from, ..Body::new(thin.cut(plane), Colour::WALL) })
}

/// What of a piece lies within a thickness (m) of its face towards the axis.
fn thinned(piece: &Piece, whole: Solid, axis: &Vector, thickness: f64) -> Solid {
    let inwards = axis - piece.pose.translation.vector;
    let inwards = Vector::new(inwards.x, inwards.y, 0.0);
    let towards = |n: usize| whole.planes[n].normal.dot(&inwards);
    let inner = (0..whole.planes.len()).max_by(|&a, &b| towards(a).total_cmp(&towards(b)));
    let Some(inner) = inner else { return whole };
    let face = whole.planes[inner];
    let outer = Plane { normal: -face.normal, offset: thickness - face.offset };
    // A box around the inner face with room for the thickness, within the old one.
    let corners = piece.shape.faces()[inner].iter();
    let corners = corners.map(|&c| piece.pose * piece.shape.vertices()[c as usize]);
    let (low, high) = corners.fold((whole.high, whole.low), |(lo, hi), p| (lo.inf(&p), hi.sup(&p)));
    // The slope of a funnel's wall makes it wider than thick on the level.
    let slope = face.normal.xy().norm().max(0.1);
    let room = Vector::new(1.5, 1.5, 0.0) * thickness / slope;
    let (low, high) = ((low - room).sup(&whole.low), (high + room).inf(&whole.high));
    whole.cut(outer).boxed(low, high)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use serde_json::json;

    use super::super::solid::{Ray, stretch};
    use super::*;
    use crate::apparatus::{Cylinder, Funnel};
    use crate::scenario::{CylinderSpec, FunnelSpec, Scenario};
    use crate::specimen::{Base, SpecimenState};

    fn across(solid: &Solid, height: f64, angle: f64) -> Option<(f64, f64)> {
        let direction = Vector::new(angle.cos(), angle.sin(), 0.0);
        let ray = Ray { origin: Vector::new(0.0, 0.0, height), direction };
        stretch(&solid.planes, &ray).map(|s| (s.enters, s.leaves))
    }

    #[test]
    fn walls_keep_their_inner_face_and_lose_their_outside() {
        let cylinder = Cylinder::new(&CylinderSpec::default()).expect("a cylinder");
        let funnel = Funnel::new(&FunnelSpec::default(), 0.25, 0.0).expect("a funnel");
        for (pieces, height) in [(&cylinder.pieces[..48], 0.1), (&funnel.pieces[..], 0.27)] {
            for piece in pieces {
                let whole = Solid::new(&piece.shape, &piece.pose);
                let thin = thinned(piece, whole.clone(), &Vector::zeros(), 0.003);
                let at = piece.pose.translation.vector;
                let angle = at.y.atan2(at.x);
                let (was, is) = (across(&whole, height, angle), across(&thin, height, angle));
                let (was, is) = (was.expect("a wall"), is.expect("a wall"));
                assert_eq!(was.0, is.0, "law: the inner face stays");
                let slope = thin.planes.last().expect("a plane").normal.xy().norm();
                let width = (is.1 - is.0) * slope;
                assert!((width - 0.003).abs() < 1e-12, "law: 3 mm thick, got {width}");
                let outside = Point::from(is.1 * Vector::new(angle.cos(), angle.sin(), 0.0));
                let boxed = (0..2).all(|k| {
                    thin.low[k] <= outside[k] + 1e-12 && outside[k] <= thin.high[k] + 1e-12
                });
                assert!(boxed, "law: the box holds what is left");
            }
        }
    }

    #[test]
    fn the_near_half_is_cut_away() {
        let cylinder = Cylinder::new(&CylinderSpec::default()).expect("a cylinder");
        let view = View { azimuth_deg: 30.0, elevation_deg: 10.0 };
        let walls: Vec<Body> = cylinder.pieces[..48]
            .iter()
            .filter_map(|p| {
                let whole = Solid::new(&p.shape, &p.pose);
                wall(p, whole, &Vector::zeros(), 0.003, Walls::Cut, &view)
            })
            .collect();
        assert!((24..=26).contains(&walls.len()), "law: half of 48 pieces, got {}", walls.len());
        let from_camera =
            Ray { origin: 10.0 * view.level() + 0.1 * Vector::z(), direction: -view.level() };
        let first = walls
            .iter()
            .filter_map(|b| stretch(&b.solid.planes, &from_camera))
            .map(|s| s.enters)
            .fold(f64::MAX, f64::min);
        assert!(first > 10.0, "law: nothing stands before the axis, met at {first} of 10 m");
    }

    /// A laboratory of one piece without grains, from the front and 10° above.
    fn of_a_piece(piece: &serde_json::Value, walls: Walls) -> Scene {
        in_a_stage(piece, &json!({ "stage": "rest", "duration_s": 1 }), walls)
    }

    /// The same with a stage.
    fn in_a_stage(piece: &serde_json::Value, stage: &serde_json::Value, walls: Walls) -> Scene {
        let scenario: Scenario = serde_json::from_value(json!({
            "name": "piece",
            "grains": { "total_mass_g": 8, "density_kg_per_m3": 2650, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "pieces": [piece],
            "stages": [stage],
        }))
        .expect("a scenario");
        let setup = Setup::new(&scenario).expect("a laboratory");
        let mut frame = Frame::of(&SpecimenState::before_everything(0));
        (frame.cylinder, frame.pieces) = (false, vec![Some(setup.pieces[0].at)]);
        let no_grains =
            GrainSet { grains: vec![], blocks: vec![], density: 2650.0, meshes: vec![] };
        let view = View { azimuth_deg: 0.0, elevation_deg: 10.0 };
        scene_of(&setup, &no_grains, &frame, walls, &view, &[]).expect("a scene")
    }

    /// Law: a piece of a laboratory is shown as one, whatever its name: its part `base_00` is no
    /// floor of a pile.
    #[test]
    fn a_piece_with_the_name_of_a_base_is_a_piece() {
        let plate = json!({ "name": "base", "shape": { "plate": { "size_mm": [90, 90, 10] } } });
        for (walls, expected) in [(Walls::Hidden, None), (Walls::Transparent, Some(true))] {
            let scene = of_a_piece(&plate, walls);
            let glass = scene.bodies.first().map(|body| body.glass);
            assert_eq!(glass, expected, "law: whether it is glass, {walls:?}");
        }
    }

    /// Law: of a box its near wall is cut away, wherever the laboratory stands.
    #[test]
    fn the_near_wall_of_a_laboratory_is_cut_away() {
        for y_mm in [-300.0, 0.0, 137.3] {
            let piece = json!({ "name": "box", "at_mm": [70, y_mm, 0],
                "shape": { "box": { "inner_mm": [90, 80, 70], "wall_mm": 10 } } });
            let scene = of_a_piece(&piece, Walls::Cut);
            let got = scene.bodies.len();
            assert_eq!(got, 4, "law: floor, back and both sides, at y = {y_mm} mm, got {got}");
            let front = y_mm / 1000.0 - 0.04;
            let is_front = |body: &Body| body.solid.high.y < front + 1e-6;
            assert!(!scene.bodies.iter().any(is_front), "law: no front, at y = {y_mm} mm");
        }
    }

    /// Law: what moves freely, or stands among the grains, is no glass: a block was hardly seen.
    #[test]
    fn a_free_block_and_a_vane_are_no_glass() {
        let release = json!({ "stage": "release", "pieces": ["it"] });
        let rest = json!({ "stage": "rest", "duration_s": 1 });
        let block = json!({ "plate": { "size_mm": [40, 40, 40] } });
        let vane = json!({ "vane": { "diameter_mm": 36, "height_mm": 24 } });
        for (shape, stage, expected) in
            [(&block, &rest, true), (&block, &release, false), (&vane, &rest, false)]
        {
            let piece = json!({ "name": "it", "shape": shape });
            let scene = in_a_stage(&piece, stage, Walls::Transparent);
            let glass = scene.bodies.iter().any(|body| body.glass);
            assert_eq!(glass, expected, "law: whether {shape} is glass in {stage}");
        }
    }

    /// Law: what stands among the grains is whole in a picture that is cut: a vane had lost its near
    /// blades.
    #[test]
    fn a_vane_keeps_its_near_blades() {
        let vane = json!({ "name": "vane", "shape": { "vane": { "diameter_mm": 36,
            "height_mm": 24, "blades": 3, "blade_mm": 3 } } });
        let [cut, whole] =
            [Walls::Cut, Walls::Transparent].map(|walls| of_a_piece(&vane, walls).bodies.len());
        assert_eq!(cut, whole, "law: every part of the vane");
    }

    /// Law: what a pile lies on is drawn as it is, however walls are shown: taken
    /// for a wall, its floor was cut to a strip.
    #[test]
    fn the_base_of_a_pile_is_whole() {
        let mut frame = Frame::of(&SpecimenState::before_everything(0));
        frame.cylinder = false;
        frame.base = Some(Arc::new(Base { radius: 0.1, friction: None, fixed_grains: vec![] }));
        let scenario: Scenario = serde_json::from_value(json!({
            "name": "pile",
            "grains": { "total_mass_g": 8, "density_kg_per_m3": 2650, "sieve_table":
                [{ "passing_mm": 12.5, "retained_mm": 10, "mass_percent": 100 }] },
            "stages": [{ "stage": "slow_pluviation", "base_diameter_mm": 200 }],
        }))
        .expect("a scenario");
        let setup = Setup::new(&scenario).expect("a laboratory");
        let no_grains =
            GrainSet { grains: vec![], blocks: vec![], density: 2650.0, meshes: vec![] };
        let view = View { azimuth_deg: 0.0, elevation_deg: 10.0 };
        for walls in [Walls::Transparent, Walls::Cut, Walls::Hidden] {
            let scene = scene_of(&setup, &no_grains, &frame, walls, &view, &[]).expect("a scene");
            assert_eq!(scene.bodies.len(), 1, "law: the floor alone, {walls:?}");
            let Body { solid, glass, .. } = &scene.bodies[0];
            assert!(!glass, "law: it is no glass, {walls:?}");
            let width = solid.high.x - solid.low.x;
            assert!(width > 0.199, "law: 200 mm wide, got {width} m, {walls:?}");
        }
    }
}
