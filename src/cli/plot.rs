//! `pluvia plot` draws any columns of a run's tables against each other.

use super::picture::prepare;
use super::*;
use crate::export::refuse_no_run;
use crate::record::refuse_no_folder;
use crate::report::{ChartColumn, ColumnChart, ColumnRange, ColumnTable, svg_to_png};
use crate::scenario::{MeantStage, renamed_result};

/// Plot any columns of a run's tables against each other
#[derive(Debug, Args)]
#[command(after_help = "\
A row is a point; where rows follow each other in time, a line joins them. Columns of different
units get separate panels. The names and ranges of all columns: --list.

Examples:
  pluvia plot out/first --list
  pluvia plot out/shaken --x time_s --y settlement_mm,surface_settlement_mm --out out/settled.svg
  pluvia plot out/hopper --x time_s --y gate_force_z_n,hopper_force_z_n --stage deposit \\
      --out out/force.png
  pluvia plot out/first --file grains --x equivalent_diameter_mm --y sphericity --out out/shape.svg
  pluvia plot out/first --file void_profile --where by=radius --x middle_mm --y void_ratio \\
      --out out/e.svg")]
pub(super) struct PlotArgs {
    /// Folder of a run, or any other with tables of Pluvia (CSV)
    #[arg(value_name = "RUN_DIR")]
    run: PathBuf,
    /// The table: series, rest_test, grains, void_profile, distributions, sieve or another CSV file
    /// of the folder
    #[arg(long, value_name = "TABLE", default_value = "series")]
    file: String,
    /// The column along the horizontal axis
    #[arg(long, value_name = "COLUMN", required_unless_present = "list")]
    x: Option<String>,
    /// The columns along the vertical axis, separated by commas
    #[arg(
        long,
        value_name = "COLUMN,...",
        value_delimiter = ',',
        value_parser = column_name,
        required_unless_present = "list"
    )]
    y: Vec<String>,
    /// Use only rows of one stage: its number from 0, its name (of all stages of that name), or
    /// `rest_test`
    #[arg(long, allow_negative_numbers = true)]
    stage: Option<String>,
    /// Use only rows in which the column has this value (repeatable)
    #[arg(long = "where", value_name = "COLUMN=VALUE")]
    conditions: Vec<String>,
    /// Logarithmic horizontal axis
    #[arg(long)]
    log_x: bool,
    /// Logarithmic vertical axis
    #[arg(long)]
    log_y: bool,
    /// Draw points without lines
    #[arg(long)]
    points: bool,
    /// File for the figure; its folder is created if needed, and an existing file is kept
    #[arg(long, value_name = "FILE.svg|FILE.png", required_unless_present = "list")]
    out: Option<PathBuf>,
    /// Replace the file if it exists already
    #[arg(long)]
    force: bool,
    /// Print the columns of the table with their ranges without drawing anything
    #[arg(long, conflicts_with_all = ["x", "y", "out", "force", "log_x", "log_y", "points"])]
    list: bool,
}

#[derive(Serialize)]
struct Drawn {
    #[serde(serialize_with = "json_path")]
    table: PathBuf,
    rows: usize,
    x: String,
    y: Vec<String>,
    #[serde(serialize_with = "json_path")]
    file: PathBuf,
    bytes: usize,
}

/// The name of a column among others, without the spaces after a comma.
fn column_name(text: &str) -> Result<String, String> {
    match text.trim() {
        "" => Err("the name of a column is missing beside a comma".to_owned()),
        name => Ok(name.to_owned()),
    }
}

/// The table of the rest test, and how its stage is asked for.
const REST_TEST: &str = "rest_test";

/// What `--list` prints.
#[derive(Serialize)]
struct Listed {
    #[serde(serialize_with = "json_path")]
    table: PathBuf,
    rows: usize,
    columns: Vec<ColumnRange>,
}

pub(super) fn run(args: &PlotArgs, context: &Context) -> Result<ExitStatus, CliError> {
    context.stop_without_stages();
    let file = args.file.strip_suffix(".csv").unwrap_or(&args.file);
    let of_series = ["series", REST_TEST].contains(&file);
    let rest_test = args.stage.as_deref() == Some(REST_TEST) && of_series;
    let name = if rest_test { REST_TEST } else { file };
    let path = table_path(&args.run, name)?;
    let whole = ColumnTable::read(&path, &read_file(&path)?)?;
    let stage = args.stage.as_deref().filter(|_| !rest_test);
    let mut faults = Vec::new();
    let chosen = rows(args, &path, &whole, stage, &mut faults)?;
    if args.list {
        all_at_once(faults)?;
        return list(context, path, &chosen);
    }
    let (Some(x), Some(out)) = (&args.x, &args.out) else {
        return Err(CliError::Usage("--x, --y and --out are needed".to_owned()));
    };
    faults.extend(ends_in(out, "--out", &["svg", "png"]).err().map(|fault| fault.to_string()));
    // Of rows that are asked for in vain nothing can be said.
    let shown = if faults.is_empty() { &chosen } else { &whole };
    let chart = chart(args, &path, shown, x, faults)?;
    let failed = |reason: String| CliError::Usage(format!("{}: {reason}", plain_path(&path)));
    let svg = chart.svg().map_err(failed)?;
    let is_svg = out.extension().is_some_and(|e| e.eq_ignore_ascii_case("svg"));
    let content = if is_svg { svg.into_bytes() } else { svg_to_png(&svg).map_err(failed)? };
    context.go_on()?;
    prepare(out, args.force)?;
    write_file(out, &content)?;
    let drawn = Drawn {
        table: path,
        rows: chosen.len(),
        x: x.clone(),
        y: args.y.clone(),
        file: out.clone(),
        bytes: content.len(),
    };
    let text = format!(
        "{} over {x}, {} of {}\n{} ({} kB)\n",
        drawn.y.join(", "),
        counted(drawn.rows, "row"),
        plain_path(&drawn.table),
        plain_path(&drawn.file),
        drawn.bytes.div_ceil(1000)
    );
    context.done(&plain_lines(&text), &drawn)
}

/// The file of a table in a folder.
fn table_path(folder: &Path, name: &str) -> Result<PathBuf, CliError> {
    refuse_no_folder(folder)?;
    let stem = name.strip_suffix(".csv").unwrap_or(name);
    let path = folder.join(format!("{stem}.csv"));
    let plain = !stem.is_empty() && !stem.contains(['/', '\\']);
    if plain && path.exists() {
        return Ok(path);
    }
    let entries = std::fs::read_dir(folder)
        .map_err(|e| FileError::new("read the folder", folder, e.to_string()))?;
    let mut there: Vec<String> = entries
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter_map(|name| Some(name.strip_suffix(".csv")?.to_owned()))
        .collect();
    there.sort();
    let now = renamed_result(stem).filter(|now| there.contains(now));
    let now = now.map(|now| format!(" (now called `{now}`)")).unwrap_or_default();
    let there = match there.is_empty() {
        true => "there is none (CSV) in it".to_owned(),
        false => format!("it has {}", there.join(", ")),
    };
    let what = format!("{}: no table `{stem}`{now}; {there}", plain_path(folder));
    Err(CliError::Usage(plain_lines(&what).into_owned()))
}

/// The rows of a stage and of all conditions, and what is wrong with these.
fn rows(
    args: &PlotArgs,
    path: &Path,
    whole: &ColumnTable,
    stage: Option<&str>,
    faults: &mut Vec<String>,
) -> Result<ColumnTable, CliError> {
    let mut chosen = whole.clone();
    if let Some(asked) = stage {
        match whole.find("stage") {
            Ok(column) => match stage_numbers(&args.run, asked) {
                Ok(numbers) => {
                    let rows = numbers.iter().map(|number| whole.where_is(column, number));
                    chosen = rows.reduce(ColumnTable::and).unwrap_or_else(|| whole.clone());
                }
                Err(CliError::Usage(fault)) => faults.push(fault),
                Err(other) => return Err(other),
            },
            Err(_) => faults.push(format!("--stage {asked}: {} has no stages", plain_path(path))),
        }
    }
    for condition in &args.conditions {
        let Some((column, value)) = condition.split_once('=') else {
            faults.push(format!("--where {condition}: expected COLUMN=VALUE, as in by=radius"));
            continue;
        };
        match whole.find(column) {
            Ok(column) => {
                let left = chosen.where_is(column, value);
                if left.is_empty() && !chosen.is_empty() {
                    let there = chosen.texts(column);
                    let shown = there.iter().take(8).copied().collect::<Vec<_>>().join(", ");
                    let more = if there.len() > 8 { ", ..." } else { "" };
                    faults.push(format!(
                        "--where {condition}: no row has it; there are {shown}{more}"
                    ));
                }
                chosen = left;
            }
            Err(why) => faults.push(format!("--where {condition}: {why}")),
        }
    }
    Ok(chosen)
}

/// Numbers of the stages that are asked for by number or name, as their rows have them.
fn stage_numbers(folder: &Path, asked: &str) -> Result<Vec<String>, CliError> {
    refuse_no_run(folder)?;
    let manifest = folder.join("manifest.json");
    let read: Value = read_json(&manifest)?;
    let stages = read["stages"].as_array().map_or(&[][..], Vec::as_slice);
    let names: Vec<&str> = stages.iter().filter_map(|stage| stage["stage"].as_str()).collect();
    match MeantStage::of(asked, names.iter().copied()) {
        MeantStage::One(number) => Ok(vec![number.to_string()]),
        MeantStage::Several(numbers) => Ok(numbers.iter().map(usize::to_string).collect()),
        MeantStage::None => {
            let known = names.iter().enumerate().map(|(number, name)| format!("{number} {name}"));
            let rest_test = read[REST_TEST].is_object().then(|| REST_TEST.to_owned());
            let has = known.chain(rest_test).collect::<Vec<_>>().join(", ");
            let now = MeantStage::now_called(asked, &has);
            Err(CliError::Usage(format!("--stage {asked}: no such stage{now}; the run has {has}")))
        }
    }
}

fn chart(
    args: &PlotArgs,
    path: &Path,
    rows: &ColumnTable,
    x: &str,
    mut faults: Vec<String>,
) -> Result<ColumnChart, CliError> {
    let mut column = |option: &str, name: &str| match rows.find(name) {
        Ok(found) => {
            let numbers = rows.numbers(found);
            if numbers.iter().all(Option::is_none) {
                let what = match rows.texts(found).first() {
                    Some(text) => format!("it holds text, such as `{text}`"),
                    None => "it is empty in these rows".to_owned(),
                };
                faults.push(format!("{option} {name}: there is no number to draw: {what}"));
            }
            ChartColumn { name: name.to_owned(), numbers, of: value_of(rows, name) }
        }
        Err(why) => {
            faults.push(format!("{option} {name}: in {} {why}", plain_path(path)));
            ChartColumn { name: name.to_owned(), numbers: Vec::new(), of: None }
        }
    };
    let along = column("--x", x);
    let y: Vec<ChartColumn> = args.y.iter().map(|name| column("--y", name)).collect();
    all_at_once(faults)?;
    let goes_on = rows.find("time_s").is_ok()
        || increases(&along.numbers)
        || y.iter().all(|column| increases(&column.numbers));
    let gaps = gaps(rows);
    let in_pieces =
        |column: ChartColumn| ChartColumn { numbers: broken(&column.numbers, &gaps), ..column };
    Ok(ColumnChart {
        stages: if x == "time_s" { begins(rows) } else { Vec::new() },
        x: in_pieces(along),
        y: y.into_iter().map(in_pieces).collect(),
        log: [args.log_x, args.log_y],
        is_line: goes_on && !args.points,
    })
}

/// What a column `value` is of and its unit, where all rows have the same of both in columns of
/// theirs.
fn value_of(rows: &ColumnTable, name: &str) -> Option<(String, String)> {
    let only = |name: &str| match rows.texts(rows.find(name).ok()?).as_slice() {
        [one] => Some(one.replace('_', " ")),
        _ => None,
    };
    if name == "value" { only("of").zip(only("unit")) } else { None }
}

/// Whether numbers never fall, so that rows have an order.
fn increases(numbers: &[Option<f64>]) -> bool {
    let there: Vec<f64> = numbers.iter().copied().flatten().collect();
    there.windows(2).all(|pair| pair[0] <= pair[1])
}

/// Numbers of the rows of a series before which stages are left out: no line leads there.
fn gaps(rows: &ColumnTable) -> Vec<usize> {
    let (Ok(_), Ok(stage)) = (rows.find("time_s"), rows.find("stage")) else {
        return Vec::new();
    };
    let stages = rows.numbers(stage);
    let is_after_others = |&row: &usize| match (stages[row - 1], stages[row]) {
        (Some(before), Some(now)) => now - before > 1.0,
        _ => false,
    };
    (1..stages.len()).filter(is_after_others).collect()
}

/// Numbers with none before each of these rows.
fn broken(numbers: &[Option<f64>], gaps: &[usize]) -> Vec<Option<f64>> {
    let with_gap = |(row, number): (usize, &Option<f64>)| {
        gaps.contains(&row).then_some(None).into_iter().chain([*number])
    };
    numbers.iter().enumerate().flat_map(with_gap).collect()
}

/// Times at which the stages but the first begin.
fn begins(rows: &ColumnTable) -> Vec<f64> {
    let (Ok(time), Ok(stage)) = (rows.find("time_s"), rows.find("stage")) else {
        return Vec::new();
    };
    let (times, stages) = (rows.numbers(time), rows.numbers(stage));
    let pairs = stages.windows(2).zip(times.iter().skip(1));
    pairs.filter(|(pair, _)| pair[0] != pair[1]).filter_map(|(_, time)| *time).collect()
}

fn all_at_once(faults: Vec<String>) -> Result<(), CliError> {
    if faults.is_empty() { Ok(()) } else { Err(CliError::Usage(faults.join("\n"))) }
}

fn list(context: &Context, path: PathBuf, rows: &ColumnTable) -> Result<ExitStatus, CliError> {
    let columns = rows.ranges();
    let count = counted(rows.len(), "row");
    let text = format!("{}, {count}\n{}", plain_path(&path), table::columns(&lines(&columns)));
    context.done_asked(&plain_lines(&text), &Listed { table: path, rows: rows.len(), columns })
}

/// What columns hold, one a line: ranges of numbers and, last as they may be long, texts where any
/// column has some.
fn lines(columns: &[ColumnRange]) -> Vec<Vec<String>> {
    let has_texts = columns.iter().any(|column| !column.texts.is_empty());
    let number = |n: Option<f64>| n.map_or_else(|| "-".to_owned(), short);
    let line = |cells: [String; 4], texts: String| {
        cells.into_iter().chain(has_texts.then_some(texts)).collect::<Vec<String>>()
    };
    let head = ["column", "rows", "smallest", "largest"].map(str::to_owned);
    let mut lines = vec![line(head, "texts".to_owned())];
    lines.extend(columns.iter().map(|column| {
        let [smallest, largest] = [column.smallest, column.largest].map(number);
        let cells = [column.name.clone(), column.numbers.to_string(), smallest, largest];
        line(cells, column.texts.join(", "))
    }));
    lines
}

/// A number to five digits.
fn short(number: f64) -> String {
    if number != 0.0 && !(1e-3..1e6).contains(&number.abs()) {
        return format!("{number:.4e}");
    }
    let digits = (4 - number.abs().max(1e-3).log10().floor() as i32).clamp(0, 7) as usize;
    without_zeros(&format!("{number:.digits$}")).to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short() {
        for (number, expected) in [
            (0.0, "0"),
            (1.5, "1.5"),
            (-123.456_78, "-123.46"),
            (100.0, "100"),
            (1e-7, "1.0000e-7"),
            (0.001_234_567, "0.0012346"),
        ] {
            assert_eq!(short(number), expected, "law: {number} to five digits");
        }
    }

    /// Law: texts stand in the last column, and move no range of numbers.
    #[test]
    fn texts_are_listed_behind_ranges() {
        let listed = |csv: &[u8]| {
            let rows = ColumnTable::read(Path::new("sweep.csv"), csv).expect("a table");
            table::columns(&lines(&rows.ranges()))
        };
        let got = listed(b"run,e\npoint-0001-c1,0.5\npoint-0002-c1,0.75\n");
        let expected = "column  rows  smallest  largest  texts\n\
                        run     0     -         -        point-0001-c1, point-0002-c1\n\
                        e       2     0.5       0.75\n";
        assert_eq!(got, expected, "law: texts last (got left)");
        let got = listed(b"e\n0.5\n");
        let expected = "column  rows  smallest  largest\ne       1     0.5       0.5\n";
        assert_eq!(got, expected, "law: no column of texts where there are none (got left)");
    }

    /// Law: no line leads over stages that are left out.
    #[test]
    fn lines_end_where_stages_are_left_out() {
        let csv = b"time_s,stage,lid_z_mm\n0,1,9\n1,1,8\n2,2,7\n3,6,6\n4,6,5\n";
        let rows = ColumnTable::read(Path::new("series.csv"), csv).expect("a table");
        assert_eq!(gaps(&rows), [3], "law: stages 3 to 5 are left out");
        let lid = broken(&rows.numbers(2), &gaps(&rows));
        let expected = [Some(9.0), Some(8.0), Some(7.0), None, Some(6.0), Some(5.0)];
        assert_eq!(lid, expected, "law: a row without a number ends a line");
        let other = b"stage,e\n1,1\n9,2\n";
        let other = ColumnTable::read(Path::new("sweep.csv"), other).expect("a table");
        assert_eq!(gaps(&other), [0; 0], "law: other tables have no time");
    }

    /// Law: a table that had another name is named where it is there; another result that had one
    /// is no table.
    #[test]
    fn the_new_name_of_a_table_is_that_of_a_table() {
        let folder = tempfile::tempdir().expect("a folder");
        let said = |asked: &str| {
            table_path(folder.path(), asked).err().map(|e| e.to_string()).unwrap_or_default()
        };
        assert!(!said("control").contains("now called"), "law: none is there: {}", said("control"));
        std::fs::write(folder.path().join("rest_test.csv"), "").expect("written");
        for (asked, expected) in [("control", true), ("guards", false)] {
            let said = said(asked);
            let named = said.contains("now called `rest_test`");
            let no_other = said.contains("now called") == named;
            assert!(named == expected && no_other, "law: of `{asked}`, got `{said}`");
        }
    }

    /// Law: an old name of the rest test is explained where the run has one, and nowhere else.
    #[test]
    fn a_run_without_a_rest_test_has_no_new_name_for_it() {
        let folder = tempfile::tempdir().expect("a folder");
        let said = |rest_test: Value| {
            let manifest = json!({ "stages": [{ "stage": "pour" }], "rest_test": rest_test });
            std::fs::write(folder.path().join("manifest.json"), manifest.to_string())
                .expect("written");
            stage_numbers(folder.path(), "control").expect_err("no such stage").to_string()
        };
        let with = said(json!({ "stage": "rest" }));
        assert!(with.contains("no such stage (now called `rest_test`)"), "law: got `{with}`");
        let without = said(Value::Null);
        assert!(without.ends_with("no such stage; the run has 0 pour"), "law: got `{without}`");
    }

    #[test]
    fn stages_begin_where_their_number_changes() {
        let csv = b"time_s,stage\n0,0\n1,0\n1,1\n2,1\n2,2\n";
        let rows = ColumnTable::read(Path::new("a.csv"), csv).expect("a table");
        assert_eq!(begins(&rows), [1.0, 2.0]);
    }

    /// Law: a value is of what all its rows say that it is of, in their unit.
    #[test]
    fn a_value_is_of_one_quantity() {
        let csv = b"of,value,unit\nnormal_force,1,of_mean\nnormal_force,2,of_mean\n\
                    coordination,3,grains\n";
        let whole = ColumnTable::read(Path::new("distributions.csv"), csv).expect("a table");
        let force = whole.where_is(0, "normal_force");
        let expected = Some(("normal force".to_owned(), "of mean".to_owned()));
        assert_eq!(value_of(&force, "value"), expected);
        assert_eq!(value_of(&whole, "value"), None, "law: of two quantities");
        assert_eq!(value_of(&force, "share_percent"), None, "law: it has a name");
    }

    #[test]
    fn what_never_falls_has_an_order() {
        assert!(increases(&[Some(1.0), None, Some(1.0), Some(2.0)]));
        assert!(!increases(&[Some(1.0), Some(3.0), Some(2.0)]));
    }
}
