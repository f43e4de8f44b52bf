//! Whether the fields of a vibration make a motion.

use super::*;
use crate::motion::{LARGEST_CRANK, RowFault, Start};

/// How far a period, of the table or of pieces, may be from a whole number of cycles, in cycles:
/// decimals of a fraction such as 0.6667 s at 3 Hz must do.
pub(super) const CYCLE_TOLERANCE: f64 = 1e-3;

pub(super) fn check(parts: &Parts, faults: &mut Faults) {
    for (i, spec) in parts.specs() {
        let StageSpec::Vibrate(stage) = spec else { continue };
        let mut faults = faults.at(format!("stages[{i}]"));
        check_fields(stage, &mut faults);
        let Some(motion) = spec.motion() else { continue };
        check_cycles(stage, &motion, &mut faults);
        check_ramp(&motion, &mut faults);
    }
}

/// Fields that a waveform needs, and those that mean nothing with it.
fn check_fields(stage: &VibrateSpec, faults: &mut Faults) {
    let recorded = stage.waveform == WaveformKind::File;
    let crank = stage.waveform == WaveformKind::SliderCrank;
    let name = match stage.waveform {
        WaveformKind::Sine => "sine",
        WaveformKind::SliderCrank => "slider_crank",
        WaveformKind::File => "file",
    };
    let number = |value: Option<f64>| value.map(|v| v.to_string());
    let rod = format!("a number above 0 and at most {LARGEST_CRANK}");
    let table = "the path of a CSV with the columns time_s, x_mm, y_mm, z_mm";
    let has_rows = stage.motion_file.is_some() || stage.motion_rows.is_some();
    let amplitude_range = "a number of at least 0 and at most 1000";
    let frequency_range = "a number above 0 and at most 1000";
    for (needed, field, is_there, allowed) in [
        (!recorded, "frequency_hz", stage.frequency_hz.is_some(), frequency_range),
        (!recorded, "amplitude_mm", stage.amplitude_mm.is_some(), amplitude_range),
        (!recorded, "duration_s", stage.duration_s.is_some(), "a number above 0 and at most 3600"),
        (crank, "crank_to_rod", stage.crank_to_rod.is_some(), rod.as_str()),
        (recorded, "motion_file", has_rows, table),
    ] {
        let message = format!("a vibration with the waveform `{name}` needs it");
        faults.add_if(needed && !is_there, field, "", allowed, message);
    }
    let own = "a recorded motion has its own";
    let first = "it begins with its first row";
    let both =
        stage.motion_rows.as_ref().and(stage.motion_file.as_ref()).map(|_| "both".to_owned());
    let rows = stage.motion_rows.as_ref().map(|rows| counted(rows.len(), "row"));
    let how = stage.interpolation.map(|how| format!("{how:?}").to_lowercase());
    let full = (stage.stroke != StrokeKind::HalfStroke).then(|| "full_stroke".to_owned());
    let turning = (stage.start != Start::Middle).then(|| "turning_point".to_owned());
    let none = "only `file` is recorded";
    // Fields that are there, and with which motion they mean nothing.
    for (idle, field, found, why) in [
        (recorded, "frequency_hz", number(stage.frequency_hz), own),
        (recorded, "amplitude_mm", number(stage.amplitude_mm), own),
        (recorded, "duration_s", number(stage.duration_s), own),
        (recorded, "ramp_s", number(Some(stage.ramp_s).filter(|ramp| *ramp != 0.0)), own),
        (recorded, "vertical", number(stage.vertical.map(|v| v.amplitude_mm)), own),
        (recorded, "stroke", full, own),
        (recorded, "start", turning, first),
        (recorded, "motion_file", both, "`motion_rows` are there already"),
        (!recorded, "motion_file", stage.motion_file.clone(), none),
        (!recorded, "motion_rows", rows, none),
        (!recorded, "interpolation", how, none),
        (!crank, "crank_to_rod", number(stage.crank_to_rod), "only `slider_crank` has a rod"),
    ] {
        let why = format!("it means nothing with the waveform `{name}`: {why}");
        faults.idle(field, found.filter(|_| idle), why);
    }
    if let (true, Some(rows)) = (recorded, &stage.motion_rows)
        && let Err(found) = RecordedMotion::new(rows, stage.interpolation.unwrap_or_default())
    {
        report_rows(found, faults);
    }
}

/// Faults of the rows of a stage's recorded motion, each where it is.
pub(super) fn report_rows(found: Vec<RowFault>, faults: &mut Faults) {
    for RowFault { row, what, found, allowed } in found {
        let row = row.map_or(String::new(), |n| format!("[{n}]"));
        faults.add(&format!("motion_rows{row}"), found, allowed, what);
    }
}

/// A table stopped away from its place would jump there in one step.
fn check_cycles(stage: &VibrateSpec, motion: &TableMotion, faults: &mut Faults) {
    // Cycles within a period, and their whole number.
    let cycles = |frequency: f64| {
        let cycles = motion.duration * frequency;
        let broken = (cycles - cycles.round()).abs() > CYCLE_TOLERANCE || cycles.round() < 1.0;
        (broken, cycles.round().max(1.0))
    };
    if motion.frequency > 0.0 {
        let (broken, whole) = cycles(motion.frequency);
        let (cycle, period) =
            (short(1.0 / motion.frequency), as_typed(nine_digits(whole / motion.frequency)));
        let allowed = match (whole / motion.frequency).is_finite() {
            true => format!("a whole number of cycles of {cycle} s, as {period}"),
            false => "none with this `frequency_hz`, of which no cycle ends".to_owned(),
        };
        let why = "a period of vibration must end where it began, in the middle of the stroke";
        faults.add_if(broken, "duration_s", motion.duration, allowed, why);
    }
    if let Some(frequency) = stage.vertical.and_then(|v| v.frequency_hz) {
        let (broken, whole) = cycles(frequency);
        let (period, near) =
            (short(motion.duration), as_typed(nine_digits(whole / motion.duration)));
        let allowed = format!("a whole number of cycles in {period} s, as {near} Hz");
        let why = "a period of vibration must end where it began, also along z";
        faults.add_if(broken, "vertical.frequency_hz", frequency, allowed, why);
    }
}

/// A shorter ramp would move the table faster than the sinusoid does; longer
/// ones would meet.
fn check_ramp(motion: &TableMotion, faults: &mut Faults) {
    let (cycle, longest) = (1.0 / motion.frequency, motion.duration / 2.0);
    let allowed = if cycle <= longest {
        let (cycle, longest) = (no_less(cycle), no_more(longest));
        format!("0, or from one cycle, {cycle} s, to half of duration_s, {longest} s")
    } else {
        "0: the period is too short for a ramp of one cycle at either end".to_owned()
    };
    let wrong = motion.ramp > 0.0 && !(cycle..=longest).contains(&motion.ramp);
    let why = "the amplitude can neither grow within a part of a cycle, nor still grow when it \
               begins to die away";
    faults.add_if(wrong, "ramp_s", motion.ramp, allowed, why);
}
