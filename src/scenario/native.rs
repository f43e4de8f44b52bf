//! Settings of the native contact solver as a person types them.

use super::*;

parts! {
/// How soft contacts are in the native contact solver: an implicit spring and
/// damper in every contact point. The rate and the speed below which nothing
/// rebounds are those of the engine settings; its `iterations` are for stock Bullet contacts.
#[serde(default)]
pub struct NativeSettings {
    /// Sub-steps of the solver in a second of simulated time, at least:
    /// contacts are found once a step, and solved in as many sub-steps of equal
    /// length as it takes. Lower: impacts, shaking and high stacks are followed more
    /// coarsely; higher: slower.
    pub substep_rate_hz: f64 = 1440.0, from 30.0 to 1e6;
    /// Iterations over all contacts in a sub-step, alternately forwards and backwards, at
    /// least: they go on until `solver_tolerance` is met, up to 256 times forwards and
    /// backwards, or as many as are asked for where that is more. Fewer: high stacks and loads
    /// are not carried exactly, and creep numerically; more: slower.
    pub iterations: u32 = 8, from 1 to 10000;
    /// Share of what contacts change of a body in a sub-step, on average, by which the
    /// last iteration may still change any body, in the kinetic norm. Lower: forces
    /// are found more exactly, by more iterations; 1: no more than `iterations`, but after
    /// impacts and among few contacts.
    pub solver_tolerance: f64 = 0.002, from 0.0 to 1.0;
    /// Stiffness of a contact point in N/m. Lower: grains sink in further, by
    /// their load over it; higher: more iterations are needed for the load to
    /// get through the packing. 10000 N/m make a grain of 1.6 g on four points
    /// sink by 0.4 µm.
    pub contact_stiffness_n_per_m: f64 = 10000.0, from 0.001 to 1e9;
    /// Damping ratio of the spring with the bodies it stands between. Lower
    /// than 1: contacts swing; higher: overlaps last longer.
    pub contact_damping_ratio: f64 = 1.0, from 0.0 to 100.0;
    /// Largest speed in m/s at which an overlap is pushed apart. It limits the force of a
    /// contact, too, to this speed times stiffness and sub-step, plus the damper's part.
    /// Lower: overlaps last, and grains give way under a load; higher: overlaps burst.
    pub max_depenetration_velocity_m_per_s: f64 = 0.3,
        schemars(extend("exclusiveMinimum" = 0.0), range(max = 100.0));
    /// Threads that compute one world: they find its contacts, solve them and move its bodies.
    /// Left out, they are the cores that other stages of the same command leave free
    /// (`--jobs`), as far as the grains keep them busy. They change no bit of the result: of what
    /// is kept of a run, the scenario in its manifest alone has them, where they are typed.
    #[serde(skip_serializing)]
    pub threads: Option<u32> = None, from 1 to 1024;
    /// Whether steps may go without the threads where these make them no faster: of threads
    /// that nobody typed.
    #[schemars(skip)]
    #[serde(skip)]
    pub may_leave_threads: bool = false;
    /// Use the instructions that every processor has, not the fastest of this
    /// one: slower, and the same bits.
    #[serde(skip_serializing)]
    pub portable: bool = false;
    /// Contacts solved at once: 8, in single precision, or 1, in double,
    /// which is slower and there to compare with.
    pub contacts_at_once: u32 = 8, schemars(extend("enum" = [1, 8]));
    /// Simulated time in s after which a stage is stored on its way, read back
    /// and carried on in a world built anew, so that an interrupted run goes on
    /// from there. Left out, it is what a core does in about a minute, by the
    /// number of grains and the rate. It changes the bits of a stage that takes
    /// longer, not what is simulated.
    pub checkpoint_every_s: Option<f64> = None, skip "Option::is_none", above 0.0 to 1e6;
}
}

impl NativeSettings {
    /// Sub-steps of a step at a rate in steps per second.
    pub fn substeps(&self, rate_hz: f64) -> u32 {
        // What is a whole number but for rounding is that number.
        let count = (self.substep_rate_hz / rate_hz - 1e-9).ceil();
        count.clamp(1.0, 1e6) as u32
    }
}

/// Settings that change no bit of a result: what is written of settings has none of them, so that
/// neither the key of a stage nor a comparison of runs depends on them.
const CHANGE_NO_BIT: [&str; 2] = ["threads", "portable"];

impl Scenario {
    /// Its JSON with those settings that change no bit, where they are typed: what repeats a run
    /// as it was asked for. [`Scenario::remove_what_changes_no_bit`] takes them out again.
    pub fn as_typed(&self) -> Value {
        let mut value = json!(self);
        let NativeSettings { threads, portable, .. } = self.engine.native;
        if let Some(threads) = threads {
            value["engine"]["native"]["threads"] = json!(threads);
        }
        if portable {
            value["engine"]["native"]["portable"] = json!(true);
        }
        value
    }

    /// Makes a scenario's JSON from [`Scenario::as_typed`] one that can be compared with others.
    pub fn remove_what_changes_no_bit(scenario: &mut Value) {
        if let Some(Value::Object(native)) = scenario.pointer_mut("/engine/native") {
            native.retain(|field, _| !CHANGE_NO_BIT.contains(&field.as_str()));
        }
    }
}

/// Grains that keep a thread busy. Fewer are done sooner than a thread comes to help: on two threads,
/// 364 grains at rest take longer than on one (`make bench`).
const GRAINS_PER_THREAD: usize = 700;

/// Threads of a world of a number of grains where none are typed and `cores` are free.
pub fn automatic_threads(cores: usize, grains: usize) -> u32 {
    u32::try_from(cores.min(grains / GRAINS_PER_THREAD).clamp(1, 1024)).unwrap_or(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Law: the scenario of a manifest has the threads that were typed, and all else is written
    /// as if none were.
    #[test]
    fn typed_threads_stand_in_the_manifest_alone() {
        let scenario = |native: Value| -> Scenario {
            let value = json!({
                "name": "s", "grains": { "file": "g.json" }, "engine": { "native": native },
                "stages": [{ "stage": "fill_funnel" }],
            });
            serde_json::from_value(value).expect("a scenario")
        };
        let plain = scenario(json!({}));
        for (native, expected) in [
            (json!({ "threads": 2, "portable": true }), [json!(2), json!(true)]),
            (json!({ "threads": 3 }), [json!(3), Value::Null]),
            (json!({}), [Value::Null, Value::Null]),
        ] {
            let typed = scenario(native);
            assert_eq!(json!(typed), json!(plain), "law: elsewhere they are not written");
            let mut kept = typed.as_typed();
            let got = CHANGE_NO_BIT.map(|field| kept["engine"]["native"][field].clone());
            assert_eq!(got, expected, "law: what was typed is kept");
            let back: Scenario = serde_json::from_value(kept.clone()).expect("law: it is read");
            assert_eq!(back, typed, "law: it repeats the run");
            Scenario::remove_what_changes_no_bit(&mut kept);
            assert_eq!(kept, json!(plain), "law: without them it is every other's");
        }
    }

    #[test]
    fn sub_steps_are_never_longer_than_asked_for() {
        let settings = NativeSettings { substep_rate_hz: 1920.0, ..Default::default() };
        for (rate_hz, expected) in [
            (240.0, 8),
            (480.0, 4),
            (500.0, 4),
            (1000.0, 2),
            (1920.0, 1),
            (5000.0, 1),
            (0.0, 1000000),
        ] {
            let got = settings.substeps(rate_hz);
            assert_eq!(
                got, expected,
                "law: the least number of sub-steps of 1/1920 s or less, at {rate_hz} Hz"
            );
        }
    }
}
