//! Progress on the terminal: bars where there is one, plain lines where not.

use std::{
    collections::HashMap,
    io::IsTerminal,
    sync::{Mutex, MutexGuard, PoisonError},
    time::{Duration, Instant},
};

use indicatif::{MultiProgress, ProgressBar, ProgressStyle};

use crate::protocol::Progress;

/// Time between two plain lines about the same stage.
const PLAIN_INTERVAL: Duration = Duration::from_secs(10);

/// Bars count thousandths of a second of simulated time.
const TICKS: f64 = 1000.0;

/// Progress on stderr.
pub(super) struct Terminal {
    bars: Option<MultiProgress>,
    stages: Mutex<HashMap<u64, Stage>>,
}

struct Stage {
    name: String,
    bar: Option<ProgressBar>,
    begun: Instant,
    told: Instant,
}

impl Terminal {
    /// Bars when stderr is a terminal, plain lines when not.
    pub(super) fn new() -> Self {
        let bars = std::io::stderr().is_terminal().then(MultiProgress::new);
        Self { bars, stages: Mutex::new(HashMap::new()) }
    }

    fn stages(&self) -> MutexGuard<'_, HashMap<u64, Stage>> {
        self.stages.lock().unwrap_or_else(PoisonError::into_inner)
    }

    fn style() -> ProgressStyle {
        ProgressStyle::with_template("{prefix:<36} {bar:24} {percent:>3} %  eta {eta:>5}  {msg}")
            .unwrap_or_else(|_| ProgressStyle::default_bar())
    }
}

impl Progress for Terminal {
    fn begin_stage(&self, id: u64, name: &str, expected: f64) {
        let bar = self.bars.as_ref().map(|bars| {
            let bar = ProgressBar::new((expected * TICKS) as u64).with_style(Self::style());
            bar.set_prefix(name.to_owned());
            bars.add(bar)
        });
        if bar.is_none() {
            eprintln!("{name}: begun");
        }
        let now = Instant::now();
        self.stages().insert(id, Stage { name: name.to_owned(), bar, begun: now, told: now });
    }

    fn update(&self, id: u64, simulated: f64, note: &str) {
        let mut stages = self.stages();
        let Some(stage) = stages.get_mut(&id) else { return };
        match &stage.bar {
            Some(bar) => {
                bar.set_position((simulated * TICKS) as u64);
                bar.set_message(note.to_owned());
            }
            None if stage.told.elapsed() >= PLAIN_INTERVAL => {
                stage.told = Instant::now();
                let gap = if note.is_empty() { "" } else { ", " };
                eprintln!("{}: {simulated:.2} s{gap}{note}", stage.name);
            }
            None => {}
        }
    }

    fn end_stage(&self, id: u64) {
        let Some(stage) = self.stages().remove(&id) else { return };
        match stage.bar {
            Some(bar) => bar.finish_and_clear(),
            None => eprintln!(
                "{}: ended after {:.0} s",
                stage.name,
                stage.begun.elapsed().as_secs_f64()
            ),
        }
    }

    fn message(&self, text: &str) {
        match &self.bars {
            // A terminal that cannot be written to hears nothing.
            Some(bars) => drop(bars.println(text)),
            None => eprintln!("{text}"),
        }
    }
}
