//! Every waveform against its formula; peaks and jumps against what they are by hand.

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use super::*;
use crate::geometry::testing::near;

/// The paper's intermittent vibration with rests of one second.
fn paper() -> TableMotion {
    TableMotion { periods: 4, rest: 1.0, ..TableMotion::sine(0.025, 3.0, 5.0) }
}

fn ramped() -> TableMotion {
    TableMotion { ramp: 1.0, ..paper() }
}

fn of(waveform: Waveform) -> TableMotion {
    TableMotion { waveform, ..paper() }
}

fn crank(ratio: f64, start: Start) -> TableMotion {
    of(Waveform::SliderCrank { ratio, start })
}

fn upright() -> TableMotion {
    let vertical = Some(Vertical { amplitude: 0.003, frequency: 6.0, phase: 0.7 });
    TableMotion { vertical, ..ramped() }
}

fn recorded(rows: &[[f64; 4]], how: Interpolation) -> TableMotion {
    let motion = RecordedMotion::new(rows, how).expect("a motion");
    TableMotion {
        waveform: Waveform::Recorded(Arc::new(motion)),
        periods: 2,
        rest: 0.5,
        ..TableMotion::sine(0.0, 0.0, rows[rows.len() - 1][0] - rows[0][0])
    }
}

/// Two cycles of A (1 − cos) with A 10 mm at 2 Hz, 100 rows a second, from 3 s on, along x; half of it along y.
fn bumps(how: Interpolation) -> TableMotion {
    let rows: Vec<[f64; 4]> = (0..=100)
        .map(|n| {
            let t = f64::from(n) / 100.0;
            let x = 10.0 * (1.0 - (TAU * 2.0 * t).cos());
            [3.0 + t, 5.0 + x, -x / 2.0, 0.0]
        })
        .collect();
    recorded(&rows, how)
}

fn every() -> Vec<(&'static str, TableMotion)> {
    vec![
        ("sine", paper()),
        ("ramped", ramped()),
        ("turning point", of(Waveform::Sine(Start::TurningPoint))),
        ("crank from the middle", crank(0.3, Start::Middle)),
        ("crank from the turning point", crank(0.5, Start::TurningPoint)),
        ("ramped crank", TableMotion { ramp: 1.0, ..crank(0.25, Start::TurningPoint) }),
        ("vertical", upright()),
        ("cubic", bumps(Interpolation::Cubic)),
        ("linear", bumps(Interpolation::Linear)),
    ]
}

#[test]
fn velocity_and_acceleration_are_derivatives_of_displacement() {
    let h = 1e-5;
    for (name, motion) in every() {
        // Away from rows and from the ends of periods and ramps.
        for share in [0.0131, 0.0437, 0.1711, 0.2237, 0.4333] {
            let t = share * motion.total();
            let [before, here, after] = [t - h, t, t + h].map(|t| motion.displacement(t));
            let speed = (after - before) / (2.0 * h);
            let got = motion.velocity(t, h);
            assert!(
                (got - speed).norm() < 1e-6,
                "law: v = dx/dt, {name} at {t} s, expected {speed}, got {got}, tolerance 1e-6 m/s"
            );
            let bend = (after - here * 2.0 + before) / (h * h);
            let got = motion.acceleration(t);
            assert!(
                (got - bend).norm() < 2e-3,
                "law: a = d²x/dt², {name} at {t} s, expected {bend}, got {got}, tolerance 2e-3 m/s²"
            );
        }
    }
}

#[test]
fn displacements_are_those_of_the_formulas() {
    let (a, theta) = (0.025, TAU * 3.0 * 0.07);
    let (ratio, phi) = (0.3_f64, theta - (0.15_f64).acos());
    // The slider's place by the triangle of crank and rod, from the middle of its stroke.
    let slider = |phi: f64, ratio: f64| {
        let rod = 1.0 / ratio;
        phi.cos() + (rod * rod - phi.sin().powi(2)).sqrt() - rod
    };
    for (name, motion, expected) in [
        ("sin", paper(), a * theta.sin()),
        ("1 − cos", of(Waveform::Sine(Start::TurningPoint)), a * (1.0 - theta.cos())),
        ("crank, middle", crank(ratio, Start::Middle), a * slider(phi, ratio)),
        ("crank, turning", crank(ratio, Start::TurningPoint), a * (1.0 - slider(theta, ratio))),
    ] {
        for period in 0..3 {
            let got = motion.displacement(0.07 + 6.0 * f64::from(period)).x;
            assert!((got - expected).abs() < 1e-12, "law: {name}, expected {expected}, got {got}");
        }
    }
    let up = TableMotion { ramp: 0.0, ..upright() };
    let got = up.displacement(0.07).z;
    let expected = 0.003 * ((TAU * 6.0 * 0.07 + 0.7).sin() - 0.7_f64.sin());
    assert!((got - expected).abs() < 1e-12, "law: A (sin(ωt + φ) − sin φ), {expected}, got {got}");
}

#[test]
fn every_period_begins_at_the_table_s_place_and_but_for_a_recording_s_rest_ends_there() {
    for (name, motion) in every() {
        let begin = motion.displacement(0.0).norm();
        let end = motion.displacement(motion.duration - 1e-12).norm();
        assert!(begin < 1e-15 && end < 1e-9, "law: {name}, from {begin} to {end} m off");
        for rest in [motion.duration + 1e-9, motion.total(), motion.total() + 1.0, -1.0] {
            assert_eq!(motion.displacement(rest), Vector::zeros(), "{name} at rest at {rest} s");
            assert_eq!(motion.velocity(rest, 1e-3), Vector::zeros(), "{name} at rest at {rest} s");
        }
    }
    assert_eq!(paper().total(), 23.0);
    assert_eq!(paper().period_ends(), [5.0, 11.0, 17.0, 23.0]);
}

#[test]
fn strokes_reach_from_end_to_end() {
    for (name, motion, low, high) in [
        ("middle", paper(), -0.025, 0.025),
        ("turning point", of(Waveform::Sine(Start::TurningPoint)), 0.0, 0.05),
        ("crank", crank(0.3, Start::Middle), -0.025, 0.025),
        ("crank, turning point", crank(0.3, Start::TurningPoint), 0.0, 0.05),
    ] {
        let xs: Vec<f64> = (0..5000).map(|n| motion.displacement(f64::from(n) * 1e-3).x).collect();
        let (least, most) = xs.iter().fold((0.0_f64, 0.0_f64), |(l, h), x| (l.min(*x), h.max(*x)));
        assert!(
            (least - low).abs() < 1e-5 && (most - high).abs() < 1e-5,
            "law: {name} from {low} to {high} m, got {least} to {most}"
        );
    }
}

#[test]
fn no_motion_is_faster_than_its_peak_speed() {
    for (name, motion) in every() {
        let points = 40_000;
        let at = |n: u32| motion.velocity(motion.total() * f64::from(n) / f64::from(points), 1e-3);
        let fastest = (0..points).map(|n| at(n).norm()).fold(0.0, f64::max);
        let peak = motion.peak_speed();
        assert!(
            fastest <= peak * (1.0 + 1e-12) && fastest > 0.6 * peak,
            "law: {name} has speeds up to {peak} m/s and near it, got {fastest} m/s"
        );
    }
}

#[test]
fn a_ramp_leaves_the_middle_as_it_is() {
    for middle in [1.0, 2.3, 4.0, 8.1] {
        assert_eq!(ramped().displacement(middle), paper().displacement(middle), "at {middle} s");
    }
    let t = 0.5 + 1.0 / 12.0;
    let half = ramped().displacement(t).x / paper().displacement(t).x;
    let expected = 0.5 * (1.0 - (PI * t).cos());
    near("(1 - cos πt/r)/2", half, expected, 1e-12);
}

#[test]
fn peaks_and_jumps_are_those_by_hand() {
    const STEP: f64 = 1.0 / 480.0;
    let omega = TAU * 3.0;
    let (v, a) = (0.025 * omega, 0.025 * omega * omega);
    let framed = TableMotion { frames_per_s: Some(25.0), ..paper() };
    // Two frames about the middle of the stroke are the farthest apart.
    let frame = (1..=125)
        .map(|n| {
            let x = |n: i32| 0.025 * (omega * f64::from(n) / 25.0).sin();
            (x(n) - x(n - 1)).abs()
        })
        .fold(0.0, f64::max);
    for (name, motion, peak_speed, peak_acceleration, velocity_jump, position_jump) in [
        ("sine", paper(), v, a, v, 0.0),
        ("turning point", of(Waveform::Sine(Start::TurningPoint)), v, a, 0.0, 0.0),
        // 1.087 g and 1.177 g at r/l 0.2 and 0.3.
        ("crank 0.2", crank(0.2, Start::TurningPoint), f64::NAN, 1.2 * a, 0.0, 0.0),
        ("crank 0.3", crank(0.3, Start::TurningPoint), f64::NAN, 1.3 * a, 0.0, 0.0),
        ("frames", framed, v, a, frame / STEP, frame),
    ] {
        let facts = MotionFacts::of(&motion, STEP);
        for (what, expected, got, tolerance) in [
            ("peak speed", peak_speed, facts.peak_speed_m_per_s, 1e-9),
            ("peak acceleration", peak_acceleration, facts.peak_acceleration_m_per_s2, 1e-9),
            ("in g", peak_acceleration / 9.80665, facts.peak_acceleration_g, 1e-9),
            ("jump of velocity", velocity_jump, facts.largest_velocity_jump_m_per_s, 1e-9),
            ("jump of position", 1e3 * position_jump, facts.largest_position_jump_mm, 1e-9),
        ] {
            assert!(
                expected.is_nan() || (got - expected).abs() < tolerance,
                "law: {what} of {name}, expected {expected}, got {got}, tolerance {tolerance}"
            );
        }
    }
    // What has no formula is within a hundred thousandth of a finer search.
    for (name, motion) in
        [("ramped", ramped()), ("vertical", upright()), ("crank", crank(0.5, Start::Middle))]
    {
        let facts = MotionFacts::of(&motion, STEP);
        let at = |n: u32| motion.duration * f64::from(n) / 400_000.0;
        let finer = (0..400_000).map(|n| motion.acceleration(at(n)).norm()).fold(0.0, f64::max);
        let got = facts.peak_acceleration_m_per_s2;
        assert!((got / finer - 1.0).abs() < 1e-5, "law: {name}, searched {finer}, got {got}");
        let finer = (0..400_000).map(|n| motion.velocity(at(n), STEP).norm()).fold(0.0, f64::max);
        let got = facts.peak_speed_m_per_s;
        assert!((got / finer - 1.0).abs() < 1e-5, "law: {name}, searched {finer}, got {got}");
    }
    let ramp = MotionFacts::of(&ramped(), STEP);
    assert!(ramp.largest_velocity_jump_m_per_s < 1e-9, "law: a ramp has no jump, {ramp:?}");
    let line = MotionFacts::of(&paper(), STEP).line();
    for words in ["sine from the middle", "0.471 m/s", "0.906 g", "velocity jumps by up to 0.471"] {
        assert!(line.contains(words), "{words} is not in: {line}");
    }
    assert!(!line.contains("position jumps"), "{line}");
}

/// Law: pieces have v, v π/(2r) in a ramp r; ω r and ω² r; ωA and ω²A; and of rows what a table has
/// of them, but stay where they end.
#[test]
fn peaks_and_jumps_of_pieces_are_those_by_hand() {
    let velocity = Path::Velocity(Vector::new(0.03, 0.0, -0.04));
    let axis = nalgebra::Unit::new_normalize(Vector::new(0.0, 2.0, 0.0));
    let rotation = Path::Rotation { axis, about: crate::geometry::Point::origin(), speed: -3.0 };
    let sine = Path::Sine { amplitude: Vector::new(0.0, 0.003, 0.004), frequency: 4.0 };
    let rows = [[0.0; 4], [1.0, 1.0, 0.0, 0.0], [2.0, 3.0, 0.0, 0.0]];
    let of_rows = |how: Interpolation| Path::Recorded {
        rows: Arc::new(RecordedMotion::of_piece(&rows, how).expect("a motion")),
        slows_from: None,
    };
    let omega = TAU * 4.0;
    // The spline through 0, 1, 3 mm with h = 1 s: M₁ = 6 (2 − 1)/4 mm/s², at its end 2 + M₁/6 mm/s.
    for (name, path, ramp, speed, acceleration, jump) in [
        ("velocity", velocity.clone(), 0.0, 0.05, 0.0, 0.05),
        ("velocity, ramped", velocity, 0.1, 0.05, 0.05 * PI / 0.2, 0.0),
        ("rotation", rotation, 0.0, 1.5, 4.5, 1.5),
        ("sine", sine, 0.0, 0.005 * omega, 0.005 * omega * omega, 0.005 * omega),
        ("rows", of_rows(Interpolation::Cubic), 0.0, 2.25e-3, 1.5e-3, 2.25e-3),
        ("straight rows", of_rows(Interpolation::Linear), 0.0, 2e-3, 0.0, 2e-3),
    ] {
        let motion = PieceMotion { path, duration: 2.0, ramp };
        let facts = MotionFacts::of_pieces(&motion, 0.5);
        near(&format!("speed, {name}"), facts.peak_speed_m_per_s, speed, 1e-12);
        near(
            &format!("acceleration, {name}"),
            facts.peak_acceleration_m_per_s2,
            acceleration,
            1e-9,
        );
        near(&format!("jump, {name}"), facts.largest_velocity_jump_m_per_s, jump, 1e-12);
        assert_eq!(facts.largest_position_jump_mm, 0.0, "law: they stay where they end, {name}");
    }
    // Half of the ramp gives the growth, its end the centripetal acceleration.
    let path = Path::Rotation { axis, about: crate::geometry::Point::origin(), speed: 2.0 };
    let motion = PieceMotion { path, duration: 2.0, ramp: 0.01 };
    let facts = MotionFacts::of_pieces(&motion, 0.5);
    let (growth, centripetal) = (PI / 0.02, 2.0 * 0.25);
    near("ramped rotation", facts.peak_acceleration_m_per_s2, growth.hypot(centripetal), 1e-2);
    let line = MotionFacts::of_pieces(&motion, 0.5).line();
    assert!(line.starts_with("rotation, at the farthest point, ramps of 0.01 s; peak"), "{line}");
    let path = Path::Velocity(Vector::new(0.1, 0.0, 0.0));
    let shift = PieceMotion { path, duration: 1.0, ramp: 0.0 };
    let line = MotionFacts::of_pieces(&shift, 0.0).line();
    assert!(
        line.contains("peak speed 0.100 m/s") && line.contains("jumps by up to 0.100"),
        "{line}"
    );
}

/// Law: within a ramp r much shorter than a cycle a sine that ends at its turning point has
/// A π/(2r) and A π²/(2r²), one that ends in its middle A ω π²/(2r).
#[test]
fn peaks_within_a_short_ramp_are_seen() {
    let (a, ramp, omega) = (0.01, 1e-3, PI);
    let turning = (a * PI / (2.0 * ramp), a * PI * PI / (2.0 * ramp * ramp));
    let middle = (a * omega, a * omega * PI * PI / (2.0 * ramp));
    for (duration, speed, acceleration) in
        [(2.5, Some(turning.0), turning.1), (2.0, None, middle.1), (20.0, None, middle.1)]
    {
        let path = Path::Sine { amplitude: Vector::new(0.0, 0.0, -a), frequency: 0.5 };
        let motion = PieceMotion { path, duration, ramp };
        let facts = MotionFacts::of_pieces(&motion, 0.0);
        let got = facts.peak_acceleration_m_per_s2;
        near(&format!("acceleration, {duration} s"), got, acceleration, 5e-3 * acceleration);
        if let Some(speed) = speed {
            near("speed at the end", facts.peak_speed_m_per_s, speed, 1e-3 * speed);
        }
        assert!(facts.peak_speed_m_per_s > middle.0, "law: above A ω, {duration} s");
        assert!(facts.found_by.contains("a cycle and a ramp"), "{}", facts.found_by);
    }
}

#[test]
fn the_largest_acceleration_of_a_crank_is_at_its_outer_dead_centre() {
    for ratio in [0.01, 0.1, 0.25, 0.3, 0.4, LARGEST_CRANK] {
        let motion = crank(ratio, Start::TurningPoint);
        let a = 0.025 * (TAU * 3.0_f64).powi(2);
        let at = |n: u32| motion.acceleration(f64::from(n) / 3.0 / 10_000.0).norm();
        let most = (0..10_000).map(at).fold(0.0, f64::max);
        let expected = a * (1.0 + ratio);
        near(&format!("Aω²(1 + λ) at λ {ratio}"), most, expected, 1e-9 * expected);
    }
}

#[test]
fn video_frames_hold_a_pose_and_jump_to_the_next_in_one_step() {
    let motion = TableMotion { frames_per_s: Some(25.0), ..TableMotion::sine(0.025, 3.0, 2.0) };
    let smooth = TableMotion { frames_per_s: None, ..motion.clone() };
    const STEP: f64 = 1.0 / 480.0;
    let mut jumps = 0;
    for n in 1..=960_u32 {
        let time = f64::from(n) * STEP;
        // 19.2 steps a frame: the frame under way is the next that is not past.
        let frame = (f64::from(n) * 25.0 / 480.0 - 1e-9).ceil();
        let got = motion.displacement(time).x;
        let expected = if frame >= 50.0 { 0.0 } else { smooth.displacement(frame / 25.0).x };
        near(&format!("the pose of frame {frame} at step {n}"), got, expected, 1e-12);
        let velocity = motion.velocity(time, STEP).x;
        let way = got - motion.displacement(time - STEP).x;
        assert!((velocity * STEP - way).abs() < 1e-15, "law: the whole displacement in one step");
        jumps += u32::from(way.abs() > 1e-12);
        assert!(velocity.abs() <= motion.peak_speed_in_steps(STEP), "law: the peak is one");
    }
    assert_eq!(jumps, 50, "law: one jump a frame in 2 s at 25 a second");
    assert!(motion.peak_speed_in_steps(STEP) > 15.0 * motion.peak_speed());
    assert_eq!(motion.fastest_component(), None, "law: looked at in every step");
}

/// Law: of frames that pass faster than steps, jumps are those from step to step, and no step is
/// faster than the peak: 3 of 1000 frames a second may pass in a step of 1/480 s.
#[test]
fn jumps_of_frames_that_steps_pass_over_are_those_of_steps() {
    const STEP: f64 = 1.0 / 480.0;
    let motion = TableMotion { frames_per_s: Some(1000.0), ..TableMotion::sine(0.025, 3.0, 5.0) };
    let place = |n: u32| motion.displacement(f64::from(n) * STEP).x;
    let farthest = (1..=2400).map(|n| (place(n) - place(n - 1)).abs()).fold(0.0, f64::max);
    let facts = MotionFacts::of(&motion, STEP);
    near("jump of the position in mm", facts.largest_position_jump_mm, 1e3 * farthest, 1e-9);
    near("of the velocity", facts.largest_velocity_jump_m_per_s, farthest / STEP, 1e-9);
    let peak = motion.peak_speed_in_steps(STEP);
    near("3 frames of 1 ms in a step", peak, 3e-3 * motion.peak_speed() / STEP, 1e-12);
    assert!(farthest / STEP <= peak, "law: at most {peak} m/s, got {}", farthest / STEP);
}

#[test]
fn a_cubic_recording_follows_a_smooth_motion_and_a_linear_one_its_chords() {
    let smooth = |t: f64| 0.010 * (1.0 - (TAU * 2.0 * t).cos());
    let (cubic, linear) = (bumps(Interpolation::Cubic), bumps(Interpolation::Linear));
    for t in [0.2341, 0.5077, 0.7553] {
        let got = cubic.displacement(t);
        // The largest error of a spline, 5/384 h⁴ω⁴A, is 3.2e-8 m.
        assert!(
            (got.x - smooth(t)).abs() < 3.3e-8,
            "law: the motion at {t} s, {}, got {}",
            smooth(t),
            got.x
        );
        assert!((got.y + got.x / 2.0).abs() < 1e-12, "law: y is −x/2");
        let (low, high) = ((t * 100.0).floor() / 100.0, (t * 100.0).ceil() / 100.0);
        let chord = smooth(low) + (smooth(high) - smooth(low)) * (t - low) / (high - low);
        let got = linear.displacement(t).x;
        assert!((got - chord).abs() < 1e-12, "law: the chord at {t} s, {chord}, got {got}");
    }
    for how in [Interpolation::Cubic, Interpolation::Linear] {
        let motion = bumps(how);
        assert_eq!((motion.duration, motion.total()), (1.0, 2.5), "law: two periods and a rest");
        for n in 0..100 {
            let t = f64::from(n) / 100.0;
            let got = motion.displacement(t).x;
            assert!(
                (got - smooth(t)).abs() < 1e-12,
                "law: through row {n}, {}, got {got}",
                smooth(t)
            );
        }
    }
    // Three rows by hand: h = 1 s, M = (0, −3, 0) mm/s² through 0, 1, 0 mm.
    let hand = recorded(
        &[[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]],
        Interpolation::Cubic,
    );
    let facts = MotionFacts::of(&hand, 0.01);
    assert!((facts.peak_acceleration_m_per_s2 - 3e-3).abs() < 1e-15, "{facts:?}");
    assert!((facts.peak_speed_m_per_s - 1.5e-3).abs() < 1e-15, "law: 1.5 mm/s at either end");
    let got = hand.displacement(0.5).x;
    assert!((got - 0.6875e-3).abs() < 1e-15, "law: 1.5 t − t³/2, got {got}");
    for (periods, rest, expected) in [(1, 0.0, 1.5e-3), (2, 0.5, 1.5e-3), (2, 0.0, 3e-3)] {
        let facts = MotionFacts::of(&TableMotion { periods, rest, ..hand.clone() }, 0.01);
        let got = facts.largest_velocity_jump_m_per_s;
        assert!(
            (got - expected).abs() < 1e-15,
            "law: {periods} periods, {rest} s of rest between, jump by {expected} m/s, got {got}"
        );
    }
    let straight = recorded(
        &[[0.0, 0.0, 0.0, 0.0], [1.0, 1.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]],
        Interpolation::Linear,
    );
    let facts = MotionFacts::of(&straight, 0.01);
    assert!((facts.largest_velocity_jump_m_per_s - 2e-3).abs() < 1e-15, "law: from 1 to −1 mm/s");
    assert_eq!(facts.peak_acceleration_m_per_s2, 0.0);
    assert_eq!(bumps(Interpolation::Cubic).moves_along_y_z(), [true, false]);
}

#[test]
fn rows_that_make_no_motion_are_refused_with_their_place() {
    let sound = [[0.0, 0.0, 0.0, 0.0], [1.0, 5.0, 0.0, 0.0], [2.0, 0.0, 0.0, 0.0]];
    assert!(RecordedMotion::new(&sound, Interpolation::Cubic).is_ok());
    type Craft = fn(&mut Vec<[f64; 4]>);
    let crafted: [(&str, Option<usize>, Craft); 10] = [
        ("too few", None, |r| r.truncate(1)),
        ("too many", None, |r| r.resize(MOST_ROWS + 1, [0.0; 4])),
        ("finite", Some(1), |r| r[1][2] = f64::NAN),
        ("finite", Some(2), |r| r[2][0] = f64::INFINITY),
        ("does not grow", Some(1), |r| r[1][0] = 0.0),
        ("does not grow", Some(2), |r| r[2][0] = 0.5),
        // The square of such a speed is no finite number.
        ("too soon", Some(1), |r| r[1][0] = f64::MIN_POSITIVE),
        ("too soon", Some(2), |r| r[2][0] = 1.0 + 1e-12),
        ("far", Some(1), |r| r[1][1] = 1e9),
        ("ends far", Some(2), |r| r[2][1] = 0.2),
    ];
    for (words, row, craft) in crafted {
        let mut rows = sound.to_vec();
        craft(&mut rows);
        let faults = RecordedMotion::new(&rows, Interpolation::Linear).expect_err("law: refused");
        assert!(
            faults.iter().any(|f| f.what.contains(words) && f.row == row),
            "law: {words} at {row:?}, got {faults:?}"
        );
    }
    let mut both = sound.to_vec();
    (both[1][1], both[2][0]) = (f64::NAN, 0.0);
    let faults = RecordedMotion::new(&both, Interpolation::Cubic).expect_err("law: refused");
    assert_eq!(faults.len(), 2, "law: all faults at once, got {faults:?}");
}

#[test]
fn csv_is_read_by_its_header_and_refused_with_its_lines() {
    let rows =
        rows_from_csv("\u{feff}x_mm, time_s ,z_mm\n1,0,2\n 3 ,0.5,4\n".as_bytes()).expect("rows");
    assert_eq!(rows, [[0.0, 1.0, 0.0, 2.0], [0.5, 3.0, 0.0, 4.0]]);
    for (text, words) in [
        ("time_s\n0\n1\n", "no column `x_mm`"),
        ("time_s,x_mm,w\n0,1,2\n", "\"w\""),
        ("time_s,x_mm,x_mm\n0,1,2\n", "there twice"),
        ("0,x_mm\n1,2\n", "no column `time_s`"),
        ("time_s,x_mm\n0,one\n", "line 2: `x_mm` is no number"),
        ("time_s,x_mm\n0,1\n1\n", "line: 3"),
        ("", "no column"),
        ("\0\0\u{1}", "is not known"),
    ] {
        let said = rows_from_csv(text.as_bytes()).expect_err("law: refused").join("; ");
        assert!(said.contains(words), "law: {text:?} is refused with {words:?}, got {said}");
    }
    assert!(rows_from_csv(b"time_s,x_mm\n0,\xff\n").is_err(), "law: no text, no motion");
    let of_header = |text: &str| rows_from_csv(text.as_bytes()).expect_err("law: refused").len();
    assert_eq!(of_header("time_s\n0\n"), 1, "law: what is lacking is one fault");
    assert_eq!(of_header("time_s,x_mm,x_mm\n0,1,2\n"), 1, "law: a column twice is one fault");
    assert_eq!(of_header("a,b,c,d,e,f,g,x_mm,time_s\n"), 5, "law: the first few are named");
    let many: String = std::iter::once("time_s,x_mm\n".to_owned())
        .chain((0..MOST_ROWS + 5).map(|n| format!("{n},0\n")))
        .collect();
    let rows = rows_from_csv(many.as_bytes()).expect("rows");
    assert_eq!(rows.len(), MOST_ROWS + 1, "law: read no further than needed to refuse it");
    let faults = RecordedMotion::new(&rows, Interpolation::Linear).expect_err("law: refused");
    assert_eq!(faults[0].found, "more than 100000 rows", "law: what was read is not all of it");
}

#[test]
fn a_csv_of_other_marks_or_without_a_header_has_one_fault_that_says_so() {
    for (text, words) in [
        ("time_s;x_mm;y_mm\n0,0;0,0;0,0\n0,1;1,5;0,0\n", "semicolons separate the columns"),
        ("time_s\tx_mm\n0\t0\n", "tabs separate the columns"),
        ("0.0,0.0,0.0\n0.1,1.5,0.0\n", "the first line holds numbers"),
    ] {
        let faults = rows_from_csv(text.as_bytes()).expect_err("law: refused");
        assert_eq!(faults.len(), 1, "law: one mistake is one fault, got {faults:?}");
        assert!(faults[0].contains(words), "law: {text:?} is refused with {words:?}");
    }
}
