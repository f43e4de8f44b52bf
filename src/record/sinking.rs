//! How far grains sink in a rest in which some leave or come: the mean height over whoever is there
//! moves with them though nothing sinks.

use super::*;

/// How far the grains sank that were there both at a moment of a rest and at a later one.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Sunk {
    /// Time of the row at the earlier moment in s.
    pub from_s: f64,
    /// Time of the row at the later one in s.
    pub to_s: f64,
    /// By how much their mean height fell, in mm; none where no grain was there at both.
    pub drop_mm: Option<f64>,
}

/// What is known of the rests of a stage, of which one may be under way.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Sinking {
    /// The drops of rests in which the grains were not the same, up to the last row of each.
    pub sunk: Vec<Sunk>,
    /// Heights at those rows of the rest under way from which a drop may be asked for.
    held: Vec<Heights>,
}

/// Heights of the grains at a row.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Heights {
    time_s: f64,
    /// Grains in ascending order, with the heights of their centroids in m.
    of: Vec<(usize, f64)>,
}

impl Sinking {
    /// Whether nothing is known.
    pub fn is_empty(&self) -> bool {
        self.sunk.is_empty() && self.held.is_empty()
    }

    /// Another rest begins, or none is under way.
    pub fn begin(&mut self) {
        self.held.clear();
    }

    /// Takes a row of the rest under way into account: its time in s, and the grains there, in
    /// ascending order, with the heights of their centroids in m. `may_be_first` says whether a
    /// drop may be asked for that begins here.
    pub fn note(&mut self, time_s: f64, there: Vec<(usize, f64)>, may_be_first: bool) {
        for first in &self.held {
            // Of each only the drop up to the last row is wanted.
            self.sunk.retain(|sunk| sunk.from_s != first.time_s);
            let same = first.of.iter().map(|(n, _)| n).eq(there.iter().map(|(n, _)| n));
            if !same {
                let drop_mm = mean_drop(&first.of, &there).map(to_mm);
                self.sunk.push(Sunk { from_s: first.time_s, to_s: time_s, drop_mm });
            }
        }
        if may_be_first {
            self.held.push(Heights { time_s, of: there });
        }
    }
}

/// Mean drop in m of the grains that are in both lists; none of none.
fn mean_drop(before: &[(usize, f64)], after: &[(usize, f64)]) -> Option<f64> {
    let drop = |&(grain, height): &(usize, f64)| {
        let found = after.binary_search_by_key(&grain, |(n, _)| *n).ok()?;
        Some(height - after[found].1)
    };
    let drops: Vec<f64> = before.iter().filter_map(drop).collect();
    (!drops.is_empty()).then(|| drops.iter().sum::<f64>() / drops.len() as f64)
}

/// By how much in mm the grains sank from one row of a rest to a later one. Where some left or came
/// in between, it is that of the grains there at both; where a stage was stored before this was
/// recorded, the drop of the mean over whoever was there. None where no grain was there at both.
pub fn mean_drop_mm(from: &SeriesRow, to: &SeriesRow, sunk: &[Sunk]) -> Option<f64> {
    match sunk.iter().find(|sunk| sunk.from_s == from.time_s && sunk.to_s == to.time_s) {
        Some(sunk) => sunk.drop_mm,
        None => Some(from.mean_grain_height_mm? - to.mean_grain_height_mm?),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(time_s: f64, mean_mm: f64) -> SeriesRow {
        SeriesRow { time_s, mean_grain_height_mm: Some(mean_mm), ..SeriesRow::default() }
    }

    /// Law: what leaves or comes moves no mean; the drop is that of the grains there at both
    /// moments, here of 1 and 2 mm. With the same grains nothing is kept, and the rows tell.
    #[test]
    fn grains_that_leave_or_come_do_not_sink() {
        let mut sinking = Sinking::default();
        sinking.note(1.0, vec![(0, 0.010), (1, 0.020), (2, 0.090)], true);
        sinking.note(2.0, vec![(0, 0.0095), (1, 0.019), (2, 0.090)], false);
        assert!(sinking.sunk.is_empty(), "law: the same grains");
        let rows = [row(1.0, 40.0), row(2.0, 39.5), row(3.0, 15.0)];
        let of_rows = mean_drop_mm(&rows[0], &rows[1], &sinking.sunk);
        assert_eq!(of_rows, Some(0.5), "law: the rows' means");
        sinking.note(3.0, vec![(0, 0.009), (1, 0.018), (7, 0.5)], false);
        assert_eq!(sinking.sunk.len(), 1, "law: up to the last row alone");
        let got = mean_drop_mm(&rows[0], &rows[2], &sinking.sunk).expect("law: two are there");
        assert!((got - 1.5).abs() < 1e-9, "law: 1.5 mm, got {got} mm, tolerance 1e-9 mm");
        sinking.note(4.0, vec![(8, 0.1)], false);
        let none = mean_drop_mm(&rows[0], &row(4.0, 100.0), &sinking.sunk);
        assert_eq!(none, None, "law: nobody was there at both");
        let kept = serde_json::to_string(&sinking).expect("JSON");
        assert_eq!(serde_json::from_str::<Sinking>(&kept).ok(), Some(sinking), "law: read as kept");
    }
}
