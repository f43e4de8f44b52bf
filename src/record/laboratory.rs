//! What is recorded of a laboratory of pieces: loads, flows, void ratios.

use nalgebra::Matrix3;

use super::*;
use crate::geometry::Vector;
use crate::measure::Stress;

/// One moment of a laboratory, beside a row of the series.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LaboratoryRow {
    /// Of each piece, in the order of the scenario; null for one that is removed.
    pub pieces: Vec<Option<PieceRow>>,
    /// Mass in g that went through each opening since the row before.
    pub passed_g: Vec<f64>,
    /// Void ratio in each region; null where no grain is.
    pub void_ratios: Vec<Option<f64>>,
    /// Stress in each region in kPa, compression positive: xx, yy, zz, xy, xz, yz. Null where the
    /// engine gave no contacts; empty where the stage was stored before this was recorded.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub stresses_kpa: Vec<Option<[f64; 6]>>,
}

/// A piece at a moment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct PieceRow {
    /// Where the origin of its frame is, in mm.
    pub at_mm: [f64; 3],
    /// Force of the grains on it in N, mean since the row before, or since the joint of two
    /// checkpoint segments where that is later.
    pub force_n: [f64; 3],
    /// Moment of that force about the origin of its frame in N m.
    pub moment_n_m: [f64; 3],
    /// Force in N and stress in kPa by which it is pressed; none where it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub pressed: Option<[f64; 2]>,
    /// Moment in N m by which it is turned about its axis, and by how many degrees it has been
    /// since; none where it is not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub turned: Option<[f64; 2]>,
    /// Rotation in degrees of a piece that moves freely since the laboratory was set up, along the
    /// axis about which it is, right-handed; none of every other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub rotation_deg: Option<[f64; 3]>,
}

/// Rows of a stage so far, and what has passed since the last of them.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct LaboratorySeries {
    /// The rows.
    pub rows: Vec<LaboratoryRow>,
    /// Mass in g through each opening since the last row.
    pub pending_g: Vec<f64>,
}

impl LaboratorySeries {
    /// Whether it holds nothing.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }
}

/// `laboratory` in `summary.json`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct LaboratorySummary {
    /// The pieces, in the order of the scenario.
    pub pieces: Vec<PieceSummary>,
    /// Named groups of pieces.
    #[serde(default)]
    pub groups: Vec<GroupSummary>,
    /// All that the pieces carry against all that the grains weigh.
    pub balance: Balance,
    /// Flow through openings.
    pub openings: Vec<OpeningSummary>,
    /// Void ratio, stress and fabric of regions at the end.
    pub regions: Vec<RegionSummary>,
}

/// A piece at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PieceSummary {
    /// Its name.
    pub name: String,
    /// Whether it still stands.
    pub present: bool,
    /// Force of the grains on it in N: mean of the second half of the rest at the end where
    /// one is run, or else of the last sample interval.
    pub force_n: [f64; 3],
    /// Moment about the origin of its frame in N m, likewise.
    pub moment_n_m: [f64; 3],
    /// Where the origin of its frame is, in mm.
    pub at_mm: [f64; 3],
}

/// Pieces taken together, at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct GroupSummary {
    /// Its name.
    pub name: String,
    /// Names of its pieces.
    pub pieces: Vec<String>,
    /// Force of the grains on those that stand, in N, as of a piece.
    pub force_n: [f64; 3],
    /// Moment about the mean of their origins in N m, likewise.
    pub moment_n_m: [f64; 3],
    /// That mean, in mm; null where none of them stands.
    pub at_mm: Option<[f64; 3]>,
}

/// Flow through an opening.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct OpeningSummary {
    /// Its name.
    pub name: String,
    /// Mass that went through in its direction, less what came back, in g.
    pub passed_g: f64,
    /// Mean rate between the moments at which a tenth and nine tenths had passed, in g/s;
    /// null where nothing did, or all of that between two samples.
    pub rate_g_per_s: Option<f64>,
}

/// A region at the end.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct RegionSummary {
    /// Its name.
    pub name: String,
    /// Its void ratio; null where no grain is.
    pub void_ratio: Option<f64>,
    /// Mean stress of the contacts in it, at the end of the rest test where one is run; null where
    /// the engine gave no contacts.
    pub stress: Option<StressSummary>,
    /// Fabric of the contacts between grains in it, likewise; null where there are none.
    pub fabric: Option<FabricSummary>,
    /// Its relative density, 0 of the loosest and 1 of the densest state, where the scenario
    /// gives `index_densities`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_density: Option<f64>,
}

/// What the columns of a laboratory are named by, in the order of its rows.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct LaboratoryNames {
    /// Pieces.
    pub pieces: Vec<String>,
    /// Groups, with the numbers of their pieces.
    pub groups: Vec<(String, Vec<usize>)>,
    /// Openings.
    pub openings: Vec<String>,
    /// Regions.
    pub regions: Vec<String>,
}

/// Pieces taken together: their mean place, the force on all of them, and its moment about that
/// place; none where none of them stands.
pub fn of_group(pieces: &[Option<PieceRow>], numbers: &[usize]) -> Option<PieceRow> {
    let there: Vec<&PieceRow> = numbers.iter().filter_map(|&n| pieces.get(n)?.as_ref()).collect();
    if there.is_empty() {
        return None;
    }
    let sum = |of: fn(&PieceRow) -> [f64; 3]| -> Vector {
        there.iter().map(|piece| Vector::from(of(piece))).sum()
    };
    let at_mm = sum(|piece| piece.at_mm) / there.len() as f64;
    let moment = |piece: &&PieceRow| {
        let arm = (Vector::from(piece.at_mm) - at_mm).map(from_mm);
        Vector::from(piece.moment_n_m) + arm.cross(&Vector::from(piece.force_n))
    };
    Some(PieceRow {
        at_mm: at_mm.into(),
        force_n: sum(|piece| piece.force_n).into(),
        moment_n_m: there.iter().map(moment).sum::<Vector>().into(),
        pressed: there[0].pressed.filter(|_| there.len() == 1),
        turned: there[0].turned.filter(|_| there.len() == 1),
        rotation_deg: there[0].rotation_deg.filter(|_| there.len() == 1),
    })
}

/// Adds the columns of a laboratory to a table that has a row for each of its rows: of every
/// piece and group place, force and moment, of every opening what passed since the row before,
/// and of every region the void ratio and, where they are known, the stresses.
///
/// # Errors
/// The reader's and the writer's; there are none of what this program wrote.
pub fn with_laboratory(
    table: &[u8],
    names: &LaboratoryNames,
    rows: &[LaboratoryRow],
) -> Result<Vec<u8>, csv::Error> {
    let stresses = rows.iter().any(|row| !row.stresses_kpa.is_empty());
    let own = |row: &LaboratoryRow, k: usize, (_, values): &Own| {
        Some(values(row.pieces.get(k)?.as_ref()?)?.to_vec())
    };
    let has = |(k, of): &(usize, &Own)| rows.iter().any(|row| own(row, *k, of).is_some());
    let all = OWN.iter().flat_map(|of| (0..names.pieces.len()).map(move |k| (k, of)));
    let owned: Vec<(usize, &Own)> = all.filter(has).collect();
    let mut columns = Vec::new();
    for name in names.pieces.iter().chain(names.groups.iter().map(|(name, _)| name)) {
        for (quantity, unit) in [("", "mm"), ("_force", "n"), ("_moment", "n_m")] {
            columns.extend(["x", "y", "z"].map(|k| format!("{name}{quantity}_{k}_{unit}")));
        }
    }
    for (k, (ends, _)) in &owned {
        columns.extend(ends.iter().map(|end| format!("{}_{end}", names.pieces[*k])));
    }
    columns.extend(names.openings.iter().map(|name| format!("{name}_passed_g")));
    columns.extend(names.regions.iter().map(|name| format!("{name}_void_ratio")));
    for name in names.regions.iter().filter(|_| stresses) {
        columns.extend(STRESSES.map(|ij| format!("{name}_stress_{ij}_kpa")));
        columns.extend(INVARIANTS.map(|of| format!("{name}_stress_{of}_kpa")));
    }
    let cells = |n: usize| {
        let row = rows.get(n);
        let mut cells: Vec<Option<f64>> = Vec::with_capacity(columns.len());
        let single = (0..names.pieces.len()).map(|k| vec![k]);
        for numbers in single.chain(names.groups.iter().map(|(_, numbers)| numbers.clone())) {
            let piece = row.and_then(|row| of_group(&row.pieces, &numbers));
            let numbers = piece.map(|p| [p.at_mm, p.force_n, p.moment_n_m]);
            cells.extend((0..9).map(|k| numbers.map(|n| n[k / 3][k % 3])));
        }
        for (k, of) in &owned {
            let values = row.and_then(|row| own(row, *k, of));
            cells.extend((0..of.0.len()).map(|i| values.as_ref().map(|own| own[i])));
        }
        for k in 0..names.openings.len() {
            cells.push(row.and_then(|row| row.passed_g.get(k).copied()));
        }
        for k in 0..names.regions.len() {
            cells.push(row.and_then(|row| row.void_ratios.get(k).copied().flatten()));
        }
        for k in (0..names.regions.len()).filter(|_| stresses) {
            let stress = row.and_then(|row| row.stresses_kpa.get(k).copied().flatten());
            cells.extend((0..STRESSES.len()).map(|k| stress.map(|stress| stress[k])));
            let both = stress.map(|stress| invariants(&stress));
            cells.extend((0..INVARIANTS.len()).map(|k| both.map(|both| both[k])));
        }
        cells
    };
    with_columns(table, &columns, cells)
}

/// What only some pieces have at some times: how the names of its columns end, and its values.
type Own = (&'static [&'static str], fn(&PieceRow) -> Option<&[f64]>);

static OWN: [Own; 3] = [
    (&["pressed_n", "pressed_kpa"], |piece| piece.pressed.as_ref().map(<[f64; 2]>::as_slice)),
    (&["pressed_n_m", "turned_deg"], |piece| piece.turned.as_ref().map(<[f64; 2]>::as_slice)),
    (&["rotation_x_deg", "rotation_y_deg", "rotation_z_deg"], |piece| {
        piece.rotation_deg.as_ref().map(<[f64; 3]>::as_slice)
    }),
];

/// The components of a stress in a row.
const STRESSES: [&str; 6] = ["xx", "yy", "zz", "xy", "xz", "yz"];

/// What of a stress does not depend on the axes: p and q.
const INVARIANTS: [&str; 2] = ["mean", "deviatoric"];

/// Mean stress and deviatoric stress √(3/2 s:s) of a stress by its components.
fn invariants(&[xx, yy, zz, xy, xz, yz]: &[f64; 6]) -> [f64; 2] {
    let tensor = Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz);
    let stress = Stress::of(&tensor);
    [stress.mean(), stress.deviatoric()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Pose;
    use crate::record::{FrameWriter, frames::read_frames};
    use crate::specimen::{PieceState, SpecimenState};

    #[test]
    fn frames_hold_pieces_after_the_grains() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut frames = FrameWriter::new(folder.path(), 3, 2).expect("a file");
        let mut state = SpecimenState::before_everything(3);
        let piece = PieceState::standing(Pose::translation(0.25, 0.0, -0.5));
        state.pieces = vec![piece, PieceState { present: false, ..piece }];
        frames.add(&state, 1.5);
        frames.add(&state, 2.5);
        let path = folder.path().join("frames.bin");
        let hash = frames.keep(&path).expect("kept");
        let read = read_frames(&path, &hash).expect("read");
        assert_eq!(read.len(), 2, "law: as many as written");
        assert_eq!((read[1].grains.len(), read[1].time), (3, 2.5));
        assert_eq!(read[1].pieces, [Some(piece.pose), None], "law: where it is; one was removed");
    }

    #[test]
    fn columns_are_added_row_by_row_and_what_is_missing_is_empty() {
        let piece =
            PieceRow { at_mm: [1.0, 2.0, 3.0], force_n: [0.0, 0.0, -5.5], ..PieceRow::default() };
        let row = |there: bool| LaboratoryRow {
            pieces: vec![there.then_some(piece)],
            passed_g: vec![2.5],
            void_ratios: vec![None],
            ..LaboratoryRow::default()
        };
        let names = LaboratoryNames {
            pieces: vec!["box".to_owned()],
            groups: Vec::new(),
            openings: vec!["mouth".to_owned()],
            regions: vec!["core".to_owned()],
        };
        let text = |rows: &[LaboratoryRow], names: &LaboratoryNames| {
            let csv = with_laboratory(b"time_s\n0\n1\n", names, rows).expect("CSV");
            String::from_utf8(csv).expect("text")
        };
        let expected = "time_s,box_x_mm,box_y_mm,box_z_mm,box_force_x_n,box_force_y_n,box_force_z_n,\
             box_moment_x_n_m,box_moment_y_n_m,box_moment_z_n_m,mouth_passed_g,core_void_ratio\n\
             0,1,2,3,0,0,-5.5,0,0,0,2.5,\n1,,,,,,,,,,2.5,\n";
        assert_eq!(text(&[row(true), row(false)], &names), expected);
        let stressed =
            LaboratoryRow { stresses_kpa: vec![Some([1.0, 2.0, 3.0, 1.0, 3.0, 4.0])], ..row(true) };
        let names = LaboratoryNames { regions: vec!["core".to_owned()], ..Default::default() };
        // s = (−1, 0, 1) and 1, 3, 4 aside: q² = 3/2 (2 + 2 · 26) = 81.
        let expected = "time_s,core_void_ratio,core_stress_xx_kpa,core_stress_yy_kpa,\
             core_stress_zz_kpa,core_stress_xy_kpa,core_stress_xz_kpa,core_stress_yz_kpa,\
             core_stress_mean_kpa,core_stress_deviatoric_kpa\n\
             0,,1,2,3,1,3,4,2,9\n1,,,,,,,,,\n";
        assert_eq!(text(&[stressed, row(true)], &names), expected);
    }

    /// Law: two forces of 3 N and 1 N down at x = 0 and x = 1 m are 4 N, with the moment of an arm
    /// about x = 0.5 m; pieces that are gone do not count.
    #[test]
    fn a_group_has_the_force_and_the_moment_of_its_pieces() {
        let piece = |x: f64, force: f64| PieceRow {
            at_mm: [x, 0.0, 0.0],
            force_n: [0.0, 0.0, -force],
            moment_n_m: [0.0, 0.25, 0.0],
            ..PieceRow::default()
        };
        let pieces = [Some(piece(0.0, 3.0)), Some(piece(1000.0, 1.0)), None];
        let got = of_group(&pieces, &[0, 1, 2]).expect("two of them stand");
        assert_eq!((got.at_mm, got.force_n), ([500.0, 0.0, 0.0], [0.0, 0.0, -4.0]));
        // (−0.5, 0, 0) × (0, 0, −3) + (0.5, 0, 0) × (0, 0, −1) = (0, −1.5 + 0.5, 0).
        assert_eq!(got.moment_n_m, [0.0, 0.5 - 1.0, 0.0]);
        assert_eq!(of_group(&pieces, &[2]), None);
        assert_eq!(of_group(&pieces, &[1]), pieces[1], "law: a group of one is that piece");
    }

    #[test]
    fn a_piece_that_is_pressed_at_any_time_has_columns_of_its_load() {
        let free = |rotation_deg, pressed| LaboratoryRow {
            pieces: vec![Some(PieceRow { pressed, rotation_deg, ..PieceRow::default() })],
            ..LaboratoryRow::default()
        };
        let row = |pressed| free(None, pressed);
        let names = LaboratoryNames { pieces: vec!["lid".to_owned()], ..Default::default() };
        let rows = [row(None), row(Some([80.0, 12.5]))];
        let got = with_laboratory(b"time_s\n0\n1\n", &names, &rows).expect("CSV");
        let text = String::from_utf8(got).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert!(lines[0].ends_with("lid_moment_z_n_m,lid_pressed_n,lid_pressed_kpa"), "{text}");
        assert!(lines[1].ends_with(",0,,"), "law: empty while it is not pressed, got {text}");
        assert!(lines[2].ends_with(",0,80,12.5"), "law: force and stress, got {text}");
        let got = with_laboratory(b"time_s\n0\n", &names, &[row(None)]).expect("CSV");
        let text = String::from_utf8(got).expect("text");
        assert!(!text.contains("pressed"), "law: no columns of what never is, got {text}");
        let rows = [row(Some([80.0, 12.5])), free(Some([0.5, -1.5, 90.0]), None)];
        let got = with_laboratory(b"time_s\n0\n1\n", &names, &rows).expect("CSV");
        let text = String::from_utf8(got).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        let columns = "lid_pressed_kpa,lid_rotation_x_deg,lid_rotation_y_deg,lid_rotation_z_deg";
        assert!(lines[0].ends_with(columns), "law: those of a free piece, got {text}");
        assert!(lines[1].ends_with(",80,12.5,,,"), "law: empty while it is not free, got {text}");
        assert!(lines[2].ends_with(",0,,,0.5,-1.5,90"), "law: its rotation, got {text}");
    }
}
