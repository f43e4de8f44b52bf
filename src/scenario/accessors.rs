//! What others ask a scenario.

use std::sync::Arc;

use nalgebra::Unit;

use super::*;
use crate::geometry::Point;
use crate::motion::{Path, PieceMotion, TableMotion, Vertical, Waveform};

impl StageSpec {
    /// A vibration of one period, a sine from the middle with a half stroke in mm, a frequency in Hz
    /// and a length in s, and the longest time in s to come to rest: all else at its default.
    ///
    /// # Panics
    /// When a number is not finite.
    pub fn sine(frequency_hz: f64, amplitude_mm: f64, duration_s: f64, limit_s: f64) -> Self {
        let fields = json!({
            "stage": "vibrate", "frequency_hz": frequency_hz, "amplitude_mm": amplitude_mm,
            "duration_s": duration_s, "settle_limit_s": limit_s,
        });
        read(&fields).expect("a stage")
    }

    /// The plate laid on the axis, with a limit in s: all else at its default.
    ///
    /// # Panics
    /// When the number is not finite.
    pub fn top_plate(time_limit_s: f64) -> Self {
        let fields = json!({ "stage": "place_top_plate", "time_limit_s": time_limit_s });
        read(&fields).expect("a stage")
    }

    /// Name of the stage as in the file.
    pub fn name(&self) -> &'static str {
        match self {
            Self::FillFunnel { .. } => "fill_funnel",
            Self::SlowPluviation { .. } => "slow_pluviation",
            Self::Pour { .. } => "pour",
            Self::PlaceTopPlate { .. } => "place_top_plate",
            Self::Vibrate { .. } => "vibrate",
            Self::Deposit { .. } => "deposit",
            Self::Move { .. } => "move",
            Self::Press { .. } => "press",
            Self::Release { .. } => "release",
            Self::Remove { .. } => "remove",
            Self::Rest { .. } => "rest",
        }
    }

    /// The table's motion of a stage that vibrates; `None` of every other stage, and where
    /// the fields make no motion, which the checks of a scenario refuse.
    pub fn motion(&self) -> Option<TableMotion> {
        let Self::Vibrate(stage) = self else { return None };
        let frames_per_s = stage.video_frames.map(|v| v.frames_per_s);
        let (periods, rest) = (stage.periods, stage.rest_s);
        if stage.waveform == WaveformKind::File {
            let rows = stage.motion_rows.as_ref()?;
            let recorded =
                RecordedMotion::new(rows, stage.interpolation.unwrap_or_default()).ok()?;
            return Some(TableMotion {
                periods,
                rest,
                frames_per_s,
                duration: recorded.duration(),
                waveform: Waveform::Recorded(Arc::new(recorded)),
                ..TableMotion::sine(0.0, 0.0, 0.0)
            });
        }
        let half = match stage.stroke {
            StrokeKind::HalfStroke => 1.0,
            StrokeKind::FullStroke => 0.5,
        };
        let (frequency, amplitude) = (stage.frequency_hz?, from_mm(stage.amplitude_mm?) * half);
        Some(TableMotion {
            waveform: match stage.waveform {
                WaveformKind::SliderCrank => {
                    Waveform::SliderCrank { ratio: stage.crank_to_rod?, start: stage.start }
                }
                WaveformKind::Sine | WaveformKind::File => Waveform::Sine(stage.start),
            },
            periods,
            rest,
            ramp: stage.ramp_s,
            vertical: stage.vertical.map(|v| Vertical {
                amplitude: from_mm(v.amplitude_mm),
                frequency: v.frequency_hz.unwrap_or(frequency),
                phase: v.phase_deg.to_radians(),
            }),
            frames_per_s,
            ..TableMotion::sine(amplitude, frequency, stage.duration_s?)
        })
    }

    /// How pieces move in a stage that moves them; `None` of every other stage, and where
    /// the fields make no motion, which the checks of a scenario refuse.
    pub fn piece_motion(&self) -> Option<PieceMotion> {
        let Self::Move(stage) = self else { return None };
        let (velocity, rotation, sine) = (stage.velocity_mm_per_s, stage.rotation, stage.sine);
        let (until, ramp) = (&stage.until, stage.ramp_s);
        if let Some(rows) = &stage.motion_rows {
            let only = velocity.is_none() && rotation.is_none() && sine.is_none();
            let how = stage.interpolation.unwrap_or_default();
            let recorded = RecordedMotion::of_piece(rows, how).ok();
            let recorded = recorded.filter(|_| only && (ramp == 0.0 || until.is_some()))?;
            let duration = recorded.duration();
            let path = Path::Recorded { rows: Arc::new(recorded), slows_from: None };
            return Some(PieceMotion { path, duration, ramp });
        }
        let (path, travel) = match (velocity, rotation, sine) {
            (Some(velocity), None, None) => {
                let velocity = Vector::from(velocity.map(from_mm));
                let travel = stage.travel_mm.map(|mm| from_mm(mm) / velocity.norm());
                (Path::Velocity(velocity), travel)
            }
            (None, Some(turn), None) => {
                let axis = Unit::try_new(Vector::from(turn.axis), 0.0)?;
                let about = Point::from(turn.about_mm.map(from_mm));
                let speed = turn.deg_per_s.to_radians();
                let travel = stage.travel_deg.map(|deg| (deg / turn.deg_per_s).abs());
                (Path::Rotation { axis, about, speed }, travel)
            }
            (None, None, Some(sine)) => {
                let amplitude = Vector::from(sine.amplitude_mm.map(from_mm));
                (Path::Sine { amplitude, frequency: sine.frequency_hz }, None)
            }
            _ => return None,
        };
        // While it grows and dies away it covers half as much as at full speed.
        let limit = stage.time_limit_s.filter(|_| until.is_some());
        let duration = stage.duration_s.or(travel.map(|time| time + ramp)).or(limit)?;
        let sound = duration > 0.0 && duration.is_finite() && 2.0 * ramp <= duration;
        sound.then_some(PieceMotion { path, duration, ramp })
    }

    /// What may end the stage; none of one that has an end of its own.
    pub fn until(&self) -> Option<&UntilSpec> {
        match self {
            Self::Move(MoveSpec { until, .. })
            | Self::Press(PressSpec { until, .. })
            | Self::Release(ReleaseSpec { until, .. })
            | Self::Remove(RemoveSpec { until, .. }) => until.as_ref(),
            _ => None,
        }
    }

    /// Field and value, in s, of the longest time that the stage may take to settle, or a motion
    /// takes to come to rest after its end; none of one that only waits.
    pub(super) fn limit(&self) -> Option<(&'static str, f64)> {
        match *self {
            Self::FillFunnel { time_limit_s }
            | Self::SlowPluviation(SlowPluviationSpec { time_limit_s, .. })
            | Self::Pour { time_limit_s, .. }
            | Self::PlaceTopPlate(PlaceTopPlateSpec { time_limit_s, .. })
            | Self::Deposit(DepositSpec { time_limit_s, .. })
            | Self::Press(PressSpec { time_limit_s, .. })
            | Self::Release(ReleaseSpec { time_limit_s, .. })
            | Self::Remove(RemoveSpec { time_limit_s, .. }) => Some(("time_limit_s", time_limit_s)),
            Self::Vibrate(VibrateSpec { settle_limit_s, .. })
            | Self::Move(MoveSpec { settle_limit_s, .. }) => {
                Some(("settle_limit_s", settle_limit_s))
            }
            Self::Rest { .. } => None,
        }
    }

    /// Longest time in s that a motion may take to come to rest after its end; 0 of
    /// every other stage.
    pub fn settle_limit(&self) -> f64 {
        match self.limit() {
            Some(("settle_limit_s", limit)) => limit,
            _ => 0.0,
        }
    }

    /// Whether seed and configuration act on the stage: it mixes grains, or draws where the plate is
    /// laid.
    pub fn draws(&self) -> bool {
        match self {
            Self::FillFunnel { .. } | Self::SlowPluviation { .. } | Self::Deposit { .. } => true,
            Self::PlaceTopPlate(plate) => {
                plate.placement > 0 && (plate.offset_mm != Some(0.0) || plate.rotation_deg != 0.0)
            }
            Self::Pour { .. }
            | Self::Vibrate { .. }
            | Self::Move { .. }
            | Self::Press { .. }
            | Self::Release { .. }
            | Self::Remove { .. }
            | Self::Rest { .. } => false,
        }
    }

    /// Longest simulated time the stage can take, in s.
    pub fn longest(&self) -> f64 {
        let limit = self.limit().map_or(0.0, |(_, limit)| limit);
        match *self {
            // Plate, load, and no load settle one after the other.
            Self::PlaceTopPlate(ref plate) if plate.seating_load_n > 0.0 => 3.0 * limit,
            Self::Move { .. } => self.piece_motion().map_or(0.0, |m| m.duration) + limit,
            Self::Vibrate { .. } => self.motion().map_or(0.0, |m| m.total()) + limit,
            Self::Rest { duration_s } => duration_s,
            _ => limit,
        }
    }
}

impl SieveFraction {
    /// Number of grains as a plain quotient, n = V / (π/6 · d³): the volume of
    /// the fraction's solids over that of a sphere whose diameter is the mean
    /// of the two openings (paper, section 3: "the average size of polyhedrons
    /// ... was set by the average mesh openings of the two successive sieves").
    /// Total mass in g, density in kg/m³.
    pub fn grain_count(&self, total_mass_g: f64, density_kg_per_m3: f64) -> f64 {
        let volume = from_g(total_mass_g) * self.mass_percent / 100.0 / density_kg_per_m3;
        let size = from_mm(f64::midpoint(self.passing_mm, self.retained_mm));
        volume / (std::f64::consts::PI / 6.0 * size.powi(3))
    }
}

impl Scenario {
    /// What our lengths, speeds and times follow from: the sizes of the sieve table, or
    /// else the size that the engine is given.
    pub fn scale(&self) -> Scale {
        let gravity = self.gravity_m_per_s2;
        match self.grading_by_sieves() {
            Some(Grading { sizes, density, .. }) => Scale { sizes, density, gravity },
            None => Scale::of_smallest(from_mm(self.engine.grain_size_mm), gravity),
        }
    }

    /// What the sieve table says of the grains; `None` where there is none.
    pub(super) fn grading_by_sieves(&self) -> Option<Grading> {
        match &self.grains {
            GrainsSpec::Sieved(sieved) => Grading::of_table(sieved),
            GrainsSpec::Meshes(meshes) => meshes.as_sieved().and_then(|s| Grading::of_table(&s)),
            GrainsSpec::File(_) => None,
        }
    }

    /// What is known of the grains: by the sieve table, or as found when they were read.
    pub(super) fn grading(&self) -> Option<Grading> {
        self.grading_by_sieves().or(self.found)
    }

    /// Whether another seed or configuration gives another realisation: of a scenario that begins
    /// with a specimen only where a stage of its own draws.
    pub fn has_realisations(&self) -> bool {
        self.begin.is_none() || self.stages.iter().any(StageSpec::draws)
    }

    /// Whether the numbers of a field only name realisations: between two of them nothing rises.
    pub fn names_realisations(path: &str) -> bool {
        matches!(path, "seed" | "configuration")
    }

    /// Falling height of the pour in mm, where grains are poured.
    pub fn falling_height_mm(&self) -> Option<f64> {
        self.stages.iter().find_map(|stage| match stage {
            StageSpec::Pour { falling_height_mm, .. } => Some(*falling_height_mm),
            _ => None,
        })
    }

    /// The table's motion in the first stage that vibrates.
    pub fn motion(&self) -> Option<TableMotion> {
        self.stages.iter().find_map(StageSpec::motion)
    }

    /// Longest simulated time that stages and rest test can take, in s.
    pub fn longest(&self) -> f64 {
        self.stages.iter().map(StageSpec::longest).sum::<f64>() + self.rest_test_s
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario(stages: &str) -> Scenario {
        let text = format!(
            r#"{{ "name": "a", "stages": {stages}, "grains": {{ "total_mass_g": 2343,
              "density_kg_per_m3": 2673.9, "sieve_table": [
              {{ "passing_mm": 16, "retained_mm": 12.5, "mass_percent": 15 }},
              {{ "passing_mm": 12.5, "retained_mm": 8, "mass_percent": 85 }}] }} }}"#
        );
        serde_json::from_str(&text).expect("a scenario")
    }

    #[test]
    fn peak_speed_is_that_of_the_sinusoid() {
        let vibrate = |stroke: &str| {
            scenario(&format!(
                r#"[{{ "stage": "vibrate", "frequency_hz": 3, "amplitude_mm": 25,
                   "stroke": "{stroke}", "duration_s": 5, "periods": 4, "rest_s": 1 }}]"#
            ))
            .motion()
            .expect("it vibrates")
        };
        let (half, full) = (vibrate("half_stroke"), vibrate("full_stroke"));
        for (got, expected) in
            [(half.peak_speed(), 0.471_239), (full.peak_speed(), 0.235_619), (half.total(), 23.0)]
        {
            assert!(
                (got - expected).abs() < 1e-6,
                "law: 2πfA, and 4 periods with 3 rests; expected {expected}, got {got}, tolerance 1e-6"
            );
        }
    }

    /// Law: a stage draws where it mixes grains, or where a placement of the plate has limits to be
    /// drawn within.
    #[test]
    fn stages_that_draw_are_known() {
        let draws = |stage: &str| scenario(&format!("[{{ {stage} }}]")).stages[0].draws();
        for (stage, expected) in [
            (r#""stage": "fill_funnel""#, true),
            (
                r#""stage": "deposit", "at_mm": [0, 0, 9], "diameter_mm": 9, "rate_g_per_s": 1"#,
                true,
            ),
            (r#""stage": "pour", "falling_height_mm": 50"#, false),
            (r#""stage": "place_top_plate""#, false),
            (r#""stage": "place_top_plate", "placement": 1"#, true),
            (r#""stage": "place_top_plate", "placement": 1, "offset_mm": 0"#, true),
            (
                r#""stage": "place_top_plate", "placement": 1, "offset_mm": 0, "rotation_deg": 0"#,
                false,
            ),
            (r#""stage": "rest", "duration_s": 1"#, false),
        ] {
            assert_eq!(draws(stage), expected, "law: {stage}");
        }
    }

    #[test]
    fn what_is_written_does_not_depend_on_the_file() {
        let a = scenario(r#"[{ "stage": "pour", "falling_height_mm": 50 }]"#);
        let b = scenario(r#"[{ "falling_height_mm": 50.0, "stage": "pour", "time_limit_s": 6 }]"#);
        let c = scenario(r#"[{ "stage": "pour", "falling_height_mm": 51 }]"#);
        let text = |of: &Scenario| json!(of).to_string();
        assert_eq!(text(&a), text(&b), "equal scenarios, equal text");
        assert_ne!(text(&a), text(&c), "other scenarios, other text");
        assert_eq!(read(&json!(a)), Some(a.clone()), "law: it is read as the same");
        assert_eq!(a.falling_height_mm(), Some(50.0));
    }
}
