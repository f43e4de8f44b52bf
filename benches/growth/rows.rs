//! What was measured, as rows of `out/bench.json` and as tables.

use serde_json::{Value, json};

use super::{
    measured::{Measured, State, Step},
    sum,
};

/// One specimen in one state on some threads.
pub struct Row {
    pub state: State,
    pub threads: u32,
    measured: Measured,
    /// How much longer a grain-step takes than in the smallest specimen.
    growth: Option<f64>,
    /// How many times faster than on one thread.
    speed_up: Option<f64>,
}

impl Row {
    pub fn new(state: State, threads: u32, measured: Measured) -> Self {
        Self { state, threads, measured, growth: None, speed_up: None }
    }

    /// Of two worlds that began alike. Where threads share cores with others, single steps are
    /// short by chance: then the world counts that took less in all.
    pub fn better(mut self, other: Self) -> Self {
        let (own, others) = (&mut self.measured.steps, &other.measured.steps);
        if matches!(self.state, State::ShakenBusy | State::ShakenOneCore) {
            if sum(others) < sum(own) {
                own.clone_from(others);
            }
        } else {
            for (own, other) in own.iter_mut().zip(others) {
                *own = own.shorter(other);
            }
        }
        self
    }

    fn mean(&self, of: impl Fn(&Step) -> f64) -> f64 {
        self.measured.steps.iter().map(of).sum::<f64>() / self.measured.steps.len() as f64
    }

    fn step(&self) -> f64 {
        self.mean(Step::took)
    }

    fn per_grain(&self) -> f64 {
        self.step() / self.measured.grains as f64
    }

    /// Share of a step that one thread does, and by how much faster a step should be on each
    /// number of threads; known from one thread alone.
    fn expected(&self) -> Option<(f64, [(u32, f64); 3])> {
        if self.threads != 1 {
            return None;
        }
        let (all, shared) = (self.mean(|s| s.whole), self.mean(|s| s.shared));
        let on = std::array::from_fn(|n| {
            let left = self.mean(|s| s.shared_on[n].1);
            (self.measured.steps[0].shared_on[n].0, all / (all - shared + left))
        });
        Some((1.0 - shared / all, on))
    }

    pub fn json(&self) -> Value {
        let ms = |n: usize| 1e3 * self.mean(|s| s.phases[n]);
        let expected = self.expected();
        let on = expected.map(|(_, on)| {
            on.iter().map(|(threads, times)| (threads.to_string(), json!(times))).collect::<Value>()
        });
        json!({
            "grains": self.measured.grains,
            "specimens": 1,
            "state": self.state,
            "threads": self.threads,
            "rate_hz": self.measured.rate_hz,
            "ms_per_step": 1e3 * self.step(),
            "us_per_grain_step": 1e6 * self.per_grain(),
            "growth": self.growth,
            "phases": {
                "broadphase_ms": ms(0),
                "collision_ms": ms(1),
                "solver_ms": ms(2),
                "integration_ms": ms(3),
            },
            "serial_share": expected.map(|(share, _)| share),
            "expected_speed_up": on,
            "speed_up": self.speed_up,
            "contacts_per_grain": self.measured.contacts_per_grain,
            "memory_kib_per_grain": self.measured.memory_kib_per_grain,
        })
    }
}

/// Fills in what follows from several rows.
pub fn compare(rows: &mut [Row]) {
    let known: Vec<(State, u32, usize, f64)> =
        rows.iter().map(|r| (r.state, r.threads, r.measured.grains, r.per_grain())).collect();
    for row in rows {
        let (state, threads, grains) = (row.state, row.threads, row.measured.grains);
        let smallest = known.iter().filter(|k| k.0 == state && k.1 == threads).min_by_key(|k| k.2);
        row.growth = smallest.map(|k| row.per_grain() / k.3);
        let alone = known.iter().find(|k| k.0 == state && k.1 == 1 && k.2 == grains);
        row.speed_up = alone.filter(|_| threads > 1).map(|k| k.3 / row.per_grain());
    }
}

/// All rows for people.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:16} {:>7} {:>7} {:>9} {:>8} {:>7} {:>28} {:>8} {:>20} {:>8} {:>8} {:>8}\n",
        "state",
        "grains",
        "threads",
        "ms a step",
        "µs/grain",
        "growth",
        "broadph. coll. solver integ.",
        "serial %",
        "faster on 2 / 8 / 16",
        "measured",
        "contacts",
        "KiB"
    );
    let number = |value: Option<f64>, places: usize| {
        value.map_or_else(|| "-".to_owned(), |v| format!("{v:.places$}"))
    };
    for row in rows {
        let share = |n: usize| format!("{:.0}", 100.0 * row.mean(|s| s.phases[n]) / row.step());
        let phases = format!("{} {} {} {} %", share(0), share(1), share(2), share(3));
        let expected = row.expected();
        let on = expected.map_or_else(
            || "-".to_owned(),
            |(_, on)| on.map(|(_, times)| format!("{times:.2}")).join(" / "),
        );
        text += &format!(
            "{:16} {:>7} {:>7} {:>9.3} {:>8.2} {:>7} {phases:>28} {:>8} {on:>20} {:>8} {:>8.2} \
             {:>8}\n",
            row.state.to_string(),
            row.measured.grains,
            row.threads,
            1e3 * row.step(),
            1e6 * row.per_grain(),
            number(row.growth, 2),
            number(expected.map(|(share, _)| 100.0 * share), 1),
            number(row.speed_up, 2),
            row.measured.contacts_per_grain,
            number(row.measured.memory_kib_per_grain, 1),
        );
    }
    text
}
