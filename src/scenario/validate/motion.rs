//! Whether the fields of a vibration make a motion.

use super::{Parts, fault, short};
use crate::motion::{LARGEST_CRANK, RecordedMotion, RowFault, TableMotion};
use crate::scenario::accessors::joined;
use crate::scenario::{Fault, InterpolationKind, StageSpec, StartPoint, StrokeKind, WaveformKind};

/// How far a period may be from a whole number of cycles, in cycles: decimals
/// of a fraction such as 0.6667 s at 3 Hz must do.
const CYCLE_TOLERANCE: f64 = 1e-3;

pub(super) fn check(parts: &Parts, faults: &mut Vec<Fault>) {
    let specs = parts.stages.iter().enumerate().filter_map(|(i, s)| Some((i, s.spec.as_ref()?)));
    for (i, spec) in specs {
        let stage = format!("stages[{i}]");
        check_fields(spec, &stage, faults);
        let Some(motion) = spec.motion() else { continue };
        check_cycles(spec, &motion, &stage, faults);
        check_ramp(&motion, &stage, faults);
    }
}

/// Fields that a waveform needs, and those that mean nothing with it.
fn check_fields(spec: &StageSpec, stage: &str, faults: &mut Vec<Fault>) {
    let StageSpec::Vibrate {
        waveform,
        start,
        frequency_hz,
        amplitude_mm,
        stroke,
        duration_s,
        ramp_s,
        crank_to_rod,
        motion_file,
        motion_rows,
        interpolation,
        vertical,
        ..
    } = spec
    else {
        return;
    };
    let recorded = *waveform == WaveformKind::File;
    let crank = *waveform == WaveformKind::SliderCrank;
    let name = match waveform {
        WaveformKind::Sine => "sine",
        WaveformKind::SliderCrank => "slider_crank",
        WaveformKind::File => "file",
    };
    let mut missing = |field: &str, allowed: &str| {
        faults.push(fault(
            &format!("{stage}.{field}"),
            String::new(),
            allowed.to_owned(),
            format!("a vibration with the waveform `{name}` needs it"),
        ));
    };
    let needed = [
        ("frequency_hz", frequency_hz.is_none(), "a number above 0 and at most 1000"),
        ("amplitude_mm", amplitude_mm.is_none(), "a number of at least 0 and at most 1000"),
        ("duration_s", duration_s.is_none(), "a number above 0 and at most 3600"),
    ];
    for (field, is_missing, allowed) in needed {
        if is_missing && !recorded {
            missing(field, allowed);
        }
    }
    if crank && crank_to_rod.is_none() {
        missing("crank_to_rod", &format!("a number above 0 and at most {LARGEST_CRANK}"));
    }
    if recorded && motion_file.is_none() && motion_rows.is_none() {
        missing("motion_file", "the path of a CSV with the columns time_s, x_mm, y_mm, z_mm");
    }
    let mut idle = |field: &str, found: String, why: &str| {
        faults.push(fault(
            &format!("{stage}.{field}"),
            found,
            "the field left out".into(),
            format!("it means nothing with the waveform `{name}`: {why}"),
        ));
    };
    let number = |of: &Option<f64>| of.map(|v| v.to_string());
    if recorded {
        let own = "a recorded motion has its own";
        for (field, value) in [
            ("frequency_hz", number(frequency_hz)),
            ("amplitude_mm", number(amplitude_mm)),
            ("duration_s", number(duration_s)),
            ("ramp_s", number(&Some(*ramp_s).filter(|r| *r != 0.0))),
            ("vertical", vertical.map(|v| v.amplitude_mm.to_string())),
        ] {
            if let Some(value) = value {
                idle(field, value, own);
            }
        }
        if *stroke != StrokeKind::HalfStroke {
            idle("stroke", "full_stroke".into(), own);
        }
        if *start != StartPoint::Middle {
            idle("start", "turning_point".into(), "it begins with its first row");
        }
        if motion_file.is_some() && motion_rows.is_some() {
            idle("motion_file", "both".into(), "`motion_rows` are there already");
        }
    } else {
        let none = "only `file` is recorded";
        if motion_file.is_some() {
            idle("motion_file", motion_file.clone().unwrap_or_default(), none);
        }
        if let Some(rows) = motion_rows {
            idle("motion_rows", format!("{} rows", rows.len()), none);
        }
        if let Some(how) = interpolation {
            idle("interpolation", format!("{how:?}").to_lowercase(), none);
        }
    }
    if let (false, Some(ratio)) = (crank, crank_to_rod) {
        idle("crank_to_rod", ratio.to_string(), "only `slider_crank` has a rod");
    }
    if let (true, Some(rows)) = (recorded, motion_rows) {
        check_rows(rows, *interpolation, &format!("{stage}.motion_rows"), faults);
    }
}

fn check_rows(
    rows: &[[f64; 4]],
    interpolation: Option<InterpolationKind>,
    path: &str,
    faults: &mut Vec<Fault>,
) {
    let Err(found) = RecordedMotion::new(rows, joined(interpolation)) else { return };
    report_rows(found, path, faults);
}

/// Faults of rows, each where it is.
pub(super) fn report_rows(found: Vec<RowFault>, path: &str, faults: &mut Vec<Fault>) {
    faults.extend(found.into_iter().map(|RowFault { row, what, found, allowed }| {
        let path = row.map_or(path.to_owned(), |n| format!("{path}[{n}]"));
        fault(&path, found, allowed.to_owned(), what)
    }));
}

/// A table stopped away from its place would jump there in one step.
fn check_cycles(spec: &StageSpec, motion: &TableMotion, stage: &str, faults: &mut Vec<Fault>) {
    let mut whole = |field: &str, found: f64, frequency: f64, message: &str| {
        let cycles = motion.duration * frequency;
        if (cycles - cycles.round()).abs() > CYCLE_TOLERANCE || cycles.round() < 1.0 {
            let (field, allowed) = match field {
                "duration_s" => (
                    field,
                    format!(
                        "a whole number of cycles of {} s, as {}",
                        short(1.0 / frequency),
                        short(cycles.round().max(1.0) / frequency)
                    ),
                ),
                _ => (
                    field,
                    format!(
                        "a whole number of cycles in {} s, as {} Hz",
                        short(motion.duration),
                        short(cycles.round().max(1.0) / motion.duration)
                    ),
                ),
            };
            faults.push(fault(&format!("{stage}.{field}"), found, allowed, message.into()));
        }
    };
    if motion.frequency > 0.0 {
        whole(
            "duration_s",
            motion.duration,
            motion.frequency,
            "a period of vibration must end where it began, in the middle of the stroke",
        );
    }
    if let StageSpec::Vibrate { vertical: Some(v), .. } = spec
        && let Some(frequency) = v.frequency_hz
    {
        whole(
            "vertical.frequency_hz",
            frequency,
            frequency,
            "a period of vibration must end where it began, also along z",
        );
    }
}

/// A shorter ramp would move the table faster than the sinusoid does; longer
/// ones would meet.
fn check_ramp(motion: &TableMotion, stage: &str, faults: &mut Vec<Fault>) {
    let cycle = 1.0 / motion.frequency;
    let longest = motion.duration / 2.0;
    if motion.ramp > 0.0 && !(cycle..=longest).contains(&motion.ramp) {
        let allowed = if cycle <= longest {
            format!(
                "0, or from one cycle, {} s, to half of duration_s, {} s",
                short(cycle),
                short(longest)
            )
        } else {
            "0: the period is too short for a ramp of one cycle at either end".to_owned()
        };
        faults.push(fault(
            &format!("{stage}.ramp_s"),
            motion.ramp,
            allowed,
            "the amplitude can neither grow within a part of a cycle, nor still grow when it begins to die \
             away"
                .into(),
        ));
    }
}
