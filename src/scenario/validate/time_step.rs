//! Whether the time step can resolve the motion.
//!
//! An engine of this kind sees bodies only at the ends of steps. Two laws
//! follow. A body that moves by more than its own size in a step passes with
//! its centre through the centre of what it meets, and is then pushed out on
//! the far side; the native contact solver prepares contacts within a speculative
//! margin, and stops bodies at the surface, but it looks from where the bodies
//! stand: twice the size is the limit set to it. And a sinusoid taken at N points a cycle is off in
//! acceleration, (2π/N)²/12 of it, which is 0.2 % for N = 40.

use super::*;
use crate::scenario::sizes_of_pieces::lowest_mm;
use crate::units::from_deg;

/// Fewest steps in a cycle of vibration; see the module's text.
const STEPS_A_CYCLE: f64 = 40.0;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    check_threshold(parts, faults);
    if !parts.engine.as_ref().is_some_and(|e| e.allow_coarse_steps) {
        find_coarse_steps(parts, faults);
    }
}

/// Least step rate in Hz at which nothing whose speed is known beforehand moves by more than the
/// size of the smallest grains in a step, and vibration is followed; `None` where nothing moves.
/// `found` is what is known of grains that have no sieve table.
pub(in crate::scenario) fn least_rate_hz(value: &Value, found: Option<&Grading>) -> Option<f64> {
    let parts = Parts::of(value, found);
    let followed = parts.specs().map(|(_, spec)| STEPS_A_CYCLE * cycles_per_s(spec));
    let followed = followed.filter(|rate| *rate > 0.0);
    let size = from_mm(parts.finest_mm()?);
    let passed = motions(&parts).into_iter().map(|m| m.speed / size);
    followed.chain(passed).filter(|rate| rate.is_finite()).max_by(f64::total_cmp)
}

/// What the time step cannot resolve: faults, unless `engine.allow_coarse_steps`
/// lets them pass.
pub(super) fn find_coarse_steps(parts: &Parts, faults: &mut Faults) {
    let Some(engine) = parts.engine.as_ref().filter(|engine| engine.rate_hz > 0.0) else { return };
    let rate = engine.rate_hz;
    find_coarse_frames(parts, faults);
    let (_, highest) = allowed(RATE);
    // `what` says how the motion is resolved at a rate in Hz.
    let too_slow = |at_least: f64, stage, what: &dyn Fn(f64) -> String, faults: &mut Faults| {
        if at_least > highest {
            let why = format!("a motion that no step rate resolves: {}", what(highest));
            let allowed = format!("a motion that {highest} Hz can resolve");
            return faults.add(&format!("stages[{stage}]"), "", allowed, why);
        }
        let message = format!("a time step that cannot resolve the motion: {}", what(rate));
        faults.add(RATE, rate, format!("at least {} Hz", at_least.ceil()), message);
    };
    for (i, stage) in parts.specs() {
        let frequency = cycles_per_s(stage);
        let what = |rate| {
            let (frequency, steps) = (short(frequency), no_more(rate / frequency));
            format!(
                "a vibration of {frequency} Hz has {steps} steps a cycle, it needs {STEPS_A_CYCLE}"
            )
        };
        if rate < STEPS_A_CYCLE * frequency {
            too_slow(STEPS_A_CYCLE * frequency, i, &what, faults);
        }
    }
    let fastest = motions(parts).into_iter().max_by(|a, b| a.speed.total_cmp(&b.speed));
    let Some(Fast { stage, speed, what }) = fastest else { return };
    let mut step = speed / rate;
    let has_margin = engine.is_native();
    let (sizes, than) = if has_margin { (2.0, "twice ") } else { (1.0, "") };
    if let Some(size) = parts.finest_mm()
        && step > sizes * from_mm(size)
    {
        let what = |rate| {
            let (way, size) = (no_less(to_mm(speed / rate)), as_typed(size));
            format!(
                "{what} moves {way} mm in a step, more than {than}the smallest grain's size, \
                 {size} mm"
            )
        };
        too_slow(speed / (sizes * from_mm(size)), stage, &what, faults);
        // The walls are judged at the rate that is asked for.
        step = from_mm(size);
    }
    if has_margin {
        return;
    }
    // What is past the middle of a wall at the end of a step is pushed outwards.
    for (path, thickness) in walls(parts) {
        let (way, least) = (no_less(to_mm(step)), no_less(2.0 * to_mm(step)));
        let least_rate = (2.0 * speed / from_mm(thickness)).ceil();
        let allowed = format!("at least {least} mm, or {RATE} of at least {least_rate} Hz");
        let why = format!(
            "a wall through which grains can pass: {what} moves {way} mm in a step, more than \
             half of its thickness"
        );
        faults.add_if(step > from_mm(thickness) / 2.0, &path, thickness, allowed, why);
    }
}

/// Cycles per second of a stage's fastest sinusoid, of the table or of pieces; 0 of every other
/// stage, and of a recorded motion, of which only the speed is judged.
pub(super) fn cycles_per_s(stage: &StageSpec) -> f64 {
    if let StageSpec::Move(MoveSpec { sine: Some(sine), .. }) = stage {
        return sine.frequency_hz;
    }
    let Some(motion) = stage.motion() else { return 0.0 };
    motion.frequency.max(motion.vertical.map_or(0.0, |v| v.frequency))
}

/// Tables that are set from frame to frame by more than a grain, in one step of any length.
fn find_coarse_frames(parts: &Parts, faults: &mut Faults) {
    let Some(size) = parts.finest_mm() else { return };
    for (i, spec) in parts.specs() {
        let Some(motion) = spec.motion() else { continue };
        let Some(rate) = motion.frames_per_s else { continue };
        let way = motion.peak_speed() / rate;
        let least = (motion.peak_speed() / from_mm(size)).ceil();
        let why = format!(
            "frames that cannot resolve the motion: the shaking table is set by {} in one \
             step, more than the smallest grain's size, {} mm",
            match to_mm(way).is_finite() {
                true => format!("up to {} mm", no_less(to_mm(way))),
                false => "more than a number holds".to_owned(),
            },
            as_typed(size)
        );
        let field = format!("stages[{i}].video_frames.frames_per_s");
        let frames = in_number(least as usize, "frame", "frames");
        let allowed = format!("at least {least} {frames} a second");
        faults.add_if(way > from_mm(size), &field, rate, allowed, why);
    }
}

fn walls(parts: &Parts) -> Vec<(String, f64)> {
    if parts.has_pieces() {
        let of_piece = |(i, piece): (usize, &PieceSpec)| {
            let (field, thickness) = piece.shape.wall_mm()?;
            Some((format!("pieces[{i}].shape.{field}"), thickness))
        };
        return parts.pieces().filter_map(of_piece).collect();
    }
    let cylinder = parts.cylinder.as_ref().map(|c| ("cylinder", c.wall_thickness_mm));
    let funnel = parts.funnel.as_ref().map(|f| ("funnel", f.wall_thickness_mm));
    let walls = cylinder.into_iter().chain(funnel).filter(|(_, thickness)| *thickness > 0.0);
    walls.map(|(of, mm)| (format!("apparatus.{of}.wall_thickness_mm"), mm)).collect()
}

/// A fast motion.
struct Fast {
    /// Number of its stage.
    stage: usize,
    /// m/s
    speed: f64,
    what: String,
}

/// The fastest motion of each stage that is known beforehand. Speeds that are not finite follow from
/// numbers beyond the ranges of their fields, which are faults already.
fn motions(parts: &Parts) -> Vec<Fast> {
    // The first grains to fall in a stage meet what is at the bottom with v = √(2gh).
    let fall = |stage: usize, height_mm: f64, what: &str| {
        let gravity = parts.gravity.filter(|g| *g > 0.0)?;
        let speed = (2.0 * gravity * from_mm(height_mm)).sqrt();
        let what = format!("a grain that fell {} mm {what}", short(height_mm));
        speed.is_finite().then_some(Fast { stage, speed, what })
    };
    let motion = |i: usize, spec: &StageSpec| match spec {
        StageSpec::FillFunnel { .. } => {
            let funnel = parts.funnel.as_ref()?;
            let radii = (funnel.top_diameter_mm - funnel.opening_diameter_mm) / 2.0;
            let height = radii / from_deg(funnel.half_angle_deg).tan();
            fall(i, height, "from the funnel's top to its lid")
        }
        StageSpec::SlowPluviation(stage) => {
            fall(i, stage.drop_height_mm, "from the spout to the pile")
        }
        // Grains leave the funnel's mouth nearly at rest.
        StageSpec::Pour { falling_height_mm, .. } => {
            let height = falling_height_mm + parts.cylinder.as_ref()?.height_mm;
            fall(i, height, "from the funnel to the cylinder's floor")
        }
        StageSpec::Vibrate { .. } => {
            let motion = spec.motion()?;
            let speed = motion.peak_speed();
            let what = "the shaking table at its fastest".to_owned();
            // What is set from frame to frame covers that displacement in a step of whatever length.
            let moves = speed.is_finite() && motion.frames_per_s.is_none();
            moves.then_some(Fast { stage: i, speed, what })
        }
        StageSpec::Deposit(stage) => {
            let lowest = lowest_mm(parts.pieces().map(|(_, piece)| piece))?;
            let above = stage.above_surface_mm.unwrap_or(0.0);
            fall(i, (stage.at_mm[2] - lowest).max(above), "from the deposit to the lowest piece")
        }
        StageSpec::Move { .. } => {
            let motion = spec.piece_motion()?;
            let farthest = parts.pieces().map(|(_, piece)| {
                let origin = Point::from(piece.at_mm.map(from_mm));
                motion.from_axis(&origin) + from_mm(piece.shape.reach_mm())
            });
            let speed = motion.peak_speed(farthest.fold(0.0, f64::max));
            let what = "a piece at its fastest".to_owned();
            speed.is_finite().then_some(Fast { stage: i, speed, what })
        }
        StageSpec::Release(stage) => {
            let lowest = lowest_mm(parts.pieces().map(|(_, piece)| piece))?;
            let named = parts.pieces().filter(|(_, piece)| stage.pieces.contains(&piece.name));
            let highest = named.map(|(_, piece)| piece.at_mm[2]).fold(lowest, f64::max);
            let what = "a piece that is let go and falls to the lowest".to_owned();
            Some(Fast { what, ..fall(i, highest - lowest, "")? })
        }
        StageSpec::Press(stage) => {
            let what = "a piece that is pressed on".to_owned();
            Some(Fast { stage: i, speed: from_mm(stage.approach_mm_per_s), what })
        }
        _ => None,
    };
    parts.specs().filter_map(|(i, spec)| motion(i, spec)).collect()
}

fn check_threshold(parts: &Parts, faults: &mut Faults) {
    let (Some(engine), Some(finest)) = (&parts.engine, parts.finest_mm()) else { return };
    let threshold = engine.contact_threshold_mm;
    let wrong = engine.stock.relative_contact_threshold == 0.0 && threshold >= finest;
    let allowed = format!("less than the smallest grain's size, {} mm", as_typed(finest));
    let why = "contacts would be kept over a distance longer than a grain";
    faults.add_if(wrong, "engine.contact_threshold_mm", threshold, allowed, why);
}
