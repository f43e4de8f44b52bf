//! What was measured, as rows of `out/bench.json` and as tables.

use std::{fmt, path::Path};

use pluvia::record::{create_folder, write_json};
use serde_json::{Value, json};

use super::measured::{Measured, State, Step, sum};

/// What is measured: one specimen in one state on some threads, or several such at once.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    pub state: State,
    /// Worlds at once, each in a process of its own and with the same specimen.
    pub specimens: usize,
    /// Of each world.
    pub threads: u32,
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { state, specimens, threads } = self;
        write!(f, "{state}, worlds: {specimens}, threads: {threads}")
    }
}

/// A kind as measured with some grains.
pub struct Row {
    pub kind: Kind,
    /// With several specimens, the steps of all.
    measured: Measured,
    /// Time of a step in s of the measurement that took least in all.
    fastest: f64,
    /// How much longer a step takes per grain than in the smallest specimen.
    growth: Option<f64>,
    /// Of several specimens: what a step takes per grain in one world alone on one thread, in s.
    alone: Option<f64>,
    /// How many times as many grain-steps per second as by one world alone on one thread.
    speed_up: Option<f64>,
}

impl Row {
    pub fn new(kind: Kind, measured: Measured) -> Self {
        let fastest = sum(&measured.steps) / measured.steps.len() as f64;
        Self { kind, measured, fastest, growth: None, alone: None, speed_up: None }
    }

    /// Of two measurements that began alike. Where threads share cores with others, single steps
    /// are short by chance: then the one counts that took less in all.
    pub fn better(mut self, other: Self) -> Self {
        let Kind { state, specimens, .. } = self.kind;
        self.fastest = self.fastest.min(other.fastest);
        let (own, others) = (&mut self.measured.steps, &other.measured.steps);
        if specimens > 1 || matches!(state, State::ShakenBusy | State::ShakenOneCore) {
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

    fn fastest_per_grain(&self) -> f64 {
        self.fastest / self.measured.grains as f64
    }

    /// Share of a step that one thread does, and by how much faster a step should be on each
    /// number of threads; known from one world alone on one thread.
    fn expected(&self) -> Option<(f64, [(u32, f64); 3])> {
        if (self.kind.specimens, self.kind.threads) != (1, 1) {
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
            "specimens": self.kind.specimens,
            "state": self.kind.state,
            "threads": self.kind.threads,
            "rate_hz": self.measured.rate_hz,
            "ms_per_step": 1e3 * self.step(),
            "us_per_grain_step": 1e6 * self.per_grain(),
            "growth": self.growth,
            "alone_us_per_grain_step": self.alone.map(|s| 1e6 * s),
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
    for n in 0..rows.len() {
        let (row, kind) = (&rows[n], rows[n].kind);
        let smallest = rows.iter().filter(|r| r.kind == kind).min_by_key(|r| r.measured.grains);
        let growth = smallest.map(|r| row.per_grain() / r.per_grain());
        let alone = Kind { specimens: 1, threads: 1, ..kind };
        let same = |r: &&Row| r.kind == alone && r.measured.grains == row.measured.grains;
        let same = rows.iter().find(same).filter(|_| kind != alone);
        // Whole measurements of several worlds are compared with a whole one.
        let is_one = kind.specimens == 1;
        let time = same.map(|r| if is_one { r.per_grain() } else { r.fastest_per_grain() });
        let speed_up = time.map(|alone| kind.specimens as f64 * alone / row.per_grain());
        let alone = time.filter(|_| !is_one);
        let row = &mut rows[n];
        (row.growth, row.alone, row.speed_up) = (growth, alone, speed_up);
    }
}

/// All rows for people.
pub fn table(rows: &[Row]) -> String {
    let mut text = format!(
        "{:16} {:>7} {:>7} {:>7} {:>9} {:>8} {:>7} {:>28} {:>8} {:>20} {:>8} {:>8} {:>8}\n",
        "state",
        "grains",
        "worlds",
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
            "{:16} {:>7} {:>7} {:>7} {:>9.3} {:>8.2} {:>7} {phases:>28} {:>8} {on:>20} {:>8} \
             {:>8.2} {:>8}\n",
            row.kind.state.to_string(),
            row.measured.grains,
            row.kind.specimens,
            row.kind.threads,
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

/// Writes rows, with the folder of their file. Where none was measured, earlier ones stay.
pub fn write(rows: &[Row], out: &Path) -> Result<(), String> {
    if rows.is_empty() {
        let why = "nothing was measured: there are 364, 1456, 10000 and 100000 grains, and busy \
                   states of 1456 alone";
        return Err(format!("{why}; {} is not written", out.display()));
    }
    if let Some(folder) = out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        create_folder(folder).map_err(|e| e.to_string())?;
    }
    let json: Vec<Value> = rows.iter().map(Row::json).collect();
    write_json(out, &json).map_err(|e| e.to_string())
}
