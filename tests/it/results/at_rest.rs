//! The script of `make at-rest`, on runs whose readings are made up.

use std::{fmt::Write as _, fs, process::Command};

use super::{list, root};
use crate::program::{Folder, script};

/// Readings of a run in which the plate sinks by so many mm in a second, of a stage that begins at
/// 3 s and lasts for so long; the readings lie between the times that the table asks for.
fn series(sinks: f64, lasts_s: f64) -> String {
    let mut text = String::from("time_s,stage,plate_height_mm,mean_surface_mm\n2.9,2,200,190\n");
    let mut time = 0.0;
    while time <= lasts_s {
        let [plate, surface] = [180.0 - sinks * time, 170.0 - 0.5 * sinks * time];
        writeln!(text, "{},3,{plate},{surface}", 3.0 + time).expect("a text grows");
        time += 0.3;
    }
    text
}

/// Law: the table has what plate and surface have sunk by 5 s and 20 s, on straight lines between
/// readings, with a point in every locale; a run that ends before is an error and leaves no
/// table.
#[test]
fn the_table_of_specimens_left_alone_has_what_sank_by_the_times() {
    let folder = Folder::new();
    // awk and seq read and write numbers as the locale does; this one need not be installed.
    let program = folder.path("pluvia");
    script(&program, "#!/bin/sh\n[ \"$LC_ALL\" = C ]\n");
    let table = |lasts_s: [f64; 3]| {
        let groups = [("rest", 1.0), ("shaken", 0.5), ("rest", 0.0)];
        for ((of, sinks), lasts_s) in groups.into_iter().zip(lasts_s) {
            for c in 1..=3 {
                let point = if sinks > 0.0 { 1 } else { 2 };
                let run = folder.path(&format!("{of}/runs/point-000{point}-c{c}"));
                fs::create_dir_all(&run).expect("made");
                fs::write(run.join("series.csv"), series(sinks, lasts_s)).expect("written");
            }
        }
        let mut bash = Command::new("bash");
        bash.arg(root().join("scripts/at-rest.sh")).arg(folder.path(""));
        bash.env("PLUVIA", &program).env("LC_ALL", "de_DE.UTF-8");
        bash.output().expect("bash starts").status.success()
    };
    assert!(table([21.0; 3]), "law: whole runs make tables");
    let got = folder.text("tables/stock-at-rest.csv");
    let kept = |file: &str| fs::read_to_string(root().join(list::FOLDER).join(file));
    let header =
        |file: &str| kept(file).expect("kept").lines().next().expect("a header").to_owned();
    let row = "5.0000,20.0000,25.0000,10.0000,2.5000,10.0000,5.0000,0.0000";
    let expected = format!("{}\n1,{row}\n2,{row}\n3,{row}\n", header("stock-at-rest.csv"));
    assert_eq!(got, expected, "law: in the columns of the table that is kept");
    let over_time = folder.text("tables/stock-at-rest-series.csv");
    let lines: Vec<&str> = over_time.lines().collect();
    assert_eq!(lines[0], header("stock-at-rest-series.csv"), "law: the columns that are kept");
    assert_eq!(lines.len(), 52, "law: every 0.4 s to 20 s");
    let second = "0.4,0.400,0.400,0.400,0.200,0.200,0.200,0.000";
    assert_eq!(lines[2], second, "law: between readings");
    for file in ["stock-at-rest.csv", "stock-at-rest-series.csv"] {
        fs::remove_file(folder.path("tables").join(file)).expect("removed");
    }
    for lasts_s in [[19.0, 21.0, 21.0], [21.0, 19.0, 21.0], [21.0, 21.0, 19.0]] {
        assert!(!table(lasts_s), "law: a run that ends before 20 s is an error, got {lasts_s:?}");
        let made = folder.path("tables/stock-at-rest.csv").exists();
        assert!(!made, "law: no table of runs that lasted {lasts_s:?} s, got one");
    }
}
