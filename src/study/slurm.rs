//! Slurm job arrays for the stages of a sweep.
//!
//! Each level of stages becomes one array (or several, where the cluster takes no larger ones),
//! which begins when that before has ended, whether all of it went well or not: a stage whose
//! beginning is missing says so and ends, the others go on. A last job collects the results.

use std::process::Command;

use super::*;
use crate::plain::in_shell;

/// Tasks of an array have indices below this: Slurm's default limit (`MaxArraySize`, slurm.conf), of
/// the indices and not of their number, is 1001.
const INDICES: usize = 1000;

/// Options with which no job is submitted.
const NO_JOBS: [&str; 4] = ["plan_only", "snakemake", "status", "collect"];

/// A word of a line `#SBATCH`, which a blank or a line's end would take apart.
fn one_word(text: &str) -> Result<String, String> {
    if text.is_empty() || text.contains(|c: char| c.is_whitespace() || c.is_control()) {
        return Err("allowed is one word, without blanks".to_owned());
    }
    Ok(text.to_owned())
}

/// What jobs ask of the cluster; what is left out is the cluster's default.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, clap::Args)]
pub struct SlurmRequest {
    /// Partition for the jobs
    #[arg(long, value_name = "NAME", value_parser = one_word,
          requires = "slurm", conflicts_with_all = NO_JOBS)]
    pub partition: Option<String>,
    /// Time limit of a stage, as sbatch takes it
    #[arg(long, value_name = "HH:MM:SS", value_parser = one_word,
          requires = "slurm", conflicts_with_all = NO_JOBS)]
    pub time: Option<String>,
    /// Memory of a stage, as sbatch takes it
    #[arg(long = "mem", value_name = "SIZE", value_parser = one_word,
          requires = "slurm", conflicts_with_all = NO_JOBS)]
    pub memory: Option<String>,
    /// Account to charge for the jobs
    #[arg(long, value_name = "NAME", value_parser = one_word,
          requires = "slurm", conflicts_with_all = NO_JOBS)]
    pub account: Option<String>,
}

/// One job that was submitted.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct SlurmJob {
    /// Slurm's number of it.
    pub id: String,
    /// The level of stages; none of the job that collects.
    pub level: Option<usize>,
    /// How many tasks it has.
    pub tasks: usize,
}

/// Writes the jobs of all stages that are not stored into `DIR/slurm/` and
/// submits them; gives them in the order in which they were submitted. `jobs.json` there names
/// those so far, also where a later one is refused.
///
/// # Errors
/// [`StudyError::File`]; [`StudyError::Scenario`] with what sbatch says.
pub fn submit(
    tasks: &SweepTasks,
    program: &Path,
    request: &SlurmRequest,
) -> Result<Vec<SlurmJob>, StudyError> {
    let folder = tasks.folder().join("slurm");
    create_folder(&folder)?;
    let typed = |path: &Path| in_shell(&path.display().to_string()).into_owned();
    let (program, sweep) = (typed(program), typed(tasks.folder()));
    let mut jobs: Vec<SlurmJob> = Vec::new();
    let submitted = |file: String, name: &str, of: Tasks<'_>, after: &[String], command: &str| {
        let script = folder.join(file);
        let text = script_text(name, of, after, request, &folder, command);
        write_file(&script, text.as_bytes())?;
        sbatch(&script)
    };
    let list = folder.join("jobs.json");
    let mut before: Vec<String> = Vec::new();
    for level in 0..tasks.levels().len() {
        let mut ids = Vec::new();
        for (base, numbers) in arrays(&tasks.missing(level)) {
            let command = format!(
                "{program} stage {sweep} --level {level} \
                 --task \"$((SLURM_ARRAY_TASK_ID + {base}))\" --quiet"
            );
            let part = base / INDICES;
            let (file, name) = (format!("level-{level}-{part}.sh"), format!("pluvia-{level}"));
            let of = Tasks { numbers: Some(&numbers), cores: tasks.cores(level) };
            let id = submitted(file, &name, of, &before, &command)?;
            jobs.push(SlurmJob { id: id.clone(), level: Some(level), tasks: numbers.len() });
            write_json(&list, &jobs)?;
            ids.push(id);
        }
        if !ids.is_empty() {
            before = ids;
        }
    }
    let command = format!("{program} sweep --collect --out {sweep} --quiet");
    let once = Tasks { numbers: None, cores: 1 };
    let id = submitted("collect.sh".to_owned(), "pluvia-collect", once, &before, &command)?;
    jobs.push(SlurmJob { id, level: None, tasks: 1 });
    write_json(&list, &jobs)?;
    Ok(jobs)
}

/// Numbers of tasks, in ascending order, as arrays: the number from which each counts, and its
/// indices.
fn arrays(numbers: &[usize]) -> Vec<(usize, Vec<usize>)> {
    let parts = numbers.chunk_by(|a, b| a / INDICES == b / INDICES);
    let array = |part: &[usize]| {
        let base = part[0] / INDICES * INDICES;
        (base, part.iter().map(|n| n - base).collect::<Vec<_>>())
    };
    parts.map(array).collect()
}

/// Numbers in ascending order as Slurm's lists have them: `0-3,7`.
fn ranges(numbers: &[usize]) -> String {
    let mut parts: Vec<(usize, usize)> = Vec::new();
    for &n in numbers {
        match parts.last_mut() {
            Some((_, last)) if *last + 1 == n => *last = n,
            _ => parts.push((n, n)),
        }
    }
    let part = |&(a, b): &(usize, usize)| if a == b { a.to_string() } else { format!("{a}-{b}") };
    parts.iter().map(part).collect::<Vec<_>>().join(",")
}

/// What a script runs: once, or once for each index of an array.
#[derive(Clone, Copy)]
struct Tasks<'a> {
    numbers: Option<&'a [usize]>,
    cores: u32, // of each
}

fn script_text(
    name: &str,
    tasks: Tasks<'_>,
    after: &[String],
    request: &SlurmRequest,
    logs: &Path,
    command: &str,
) -> String {
    let log = if tasks.numbers.is_some() { "%x-%A_%a.log" } else { "%x-%j.log" };
    let dependency = (!after.is_empty()).then(|| format!("afterany:{}", after.join(":")));
    let options = [
        ("job-name", Some(name.to_owned())),
        ("ntasks", Some("1".to_owned())),
        ("cpus-per-task", Some(tasks.cores.to_string())),
        ("output", Some(log_pattern(logs, log))),
        // A stage that comes near its time limit is reported, and keeps its checkpoint. Without `B:`
        // the signal reaches steps of the job alone, and the script starts none: it becomes the
        // program.
        ("signal", Some("B:TERM@30".to_owned())),
        ("array", tasks.numbers.map(ranges)),
        ("dependency", dependency),
        ("partition", request.partition.clone()),
        ("time", request.time.clone()),
        ("mem", request.memory.clone()),
        ("account", request.account.clone()),
    ];
    let line =
        |(name, value): (&str, Option<String>)| Some(format!("#SBATCH --{name}={}\n", value?));
    let options: String = options.into_iter().filter_map(line).collect();
    // A node that fails must not fail the array: what it had is done again.
    format!("#!/bin/sh\n{options}#SBATCH --requeue\nexec {command}\n")
}

/// Where a job's output goes, as sbatch reads it from a script: within quotes, with a backslash
/// before what would end them, and signs of percentage of the folder doubled, which else stand for
/// numbers of the job (sbatch(1), "filename pattern").
fn log_pattern(logs: &Path, log: &str) -> String {
    let folder = logs.display().to_string().replace('%', "%%");
    format!("\"{}/{log}\"", folder.replace('\\', "\\\\").replace('"', "\\\""))
}

/// Submits a script; gives the job's number.
fn sbatch(script: &Path) -> Result<String, StudyError> {
    let told = |what: String| {
        StudyError::Scenario(format!("sbatch does not take {}: {what}", script.display()))
    };
    let not_run = |e: std::io::Error| {
        StudyError::Scenario(format!(
            "the program sbatch cannot be run: {e}; is Slurm installed on this machine? It was to \
             take {}",
            script.display()
        ))
    };
    let output = Command::new("sbatch").arg("--parsable").arg(script).output().map_err(not_run)?;
    if !output.status.success() {
        return Err(told(String::from_utf8_lossy(&output.stderr).trim().to_owned()));
    }
    // `--parsable`: the number, and after a semicolon the cluster's name.
    let text = String::from_utf8_lossy(&output.stdout);
    let id = text.trim().split(';').next().unwrap_or_default();
    if id.is_empty() {
        return Err(told("it names no job".to_owned()));
    }
    Ok(id.to_owned())
}

/// The program that is running, for jobs to start.
///
/// # Errors
/// When the system does not tell.
pub fn this_program() -> Result<PathBuf, StudyError> {
    let unknown = |e| FileError::new("find", Path::new("the running program"), e);
    Ok(std::env::current_exe().map_err(unknown)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_put_into_ranges() {
        assert_eq!(ranges(&[0, 1, 2, 3, 7, 9, 10]), "0-3,7,9-10");
        assert_eq!(ranges(&[5]), "5");
    }

    /// Law: an index is below 1000, whatever the number of its task; each task is there once.
    #[test]
    fn arrays_have_indices_that_slurm_takes() {
        let one_by_one = |few: &[usize]| few.iter().map(|n| (n / 1000 * 1000, n % 1000)).collect();
        let all: Vec<usize> = (0..1100).collect();
        for numbers in [&[][..], &[0], &[7, 999, 1000, 3001], &all[..]] {
            let expected: Vec<(usize, usize)> = one_by_one(numbers);
            let found = arrays(numbers);
            let tasks = found.iter().flat_map(|(base, of)| of.iter().map(move |n| (*base, *n)));
            let got: Vec<(usize, usize)> = tasks.collect();
            assert_eq!(got, expected, "law: left the arrays got, right bases and indices");
            let bases: Vec<usize> = found.iter().map(|(base, _)| *base).collect();
            assert!(bases.is_sorted_by(|a, b| a < b), "law: an array of each base, got {bases:?}");
        }
        assert_eq!(ranges(&arrays(&all)[1].1), "0-99", "law: the array of tasks 1000 to 1099");
    }

    #[test]
    fn a_script_asks_for_what_was_given() {
        let request = SlurmRequest {
            partition: Some("long".into()),
            time: Some("02:00:00".into()),
            ..SlurmRequest::default()
        };
        let logs = Path::new("out/slurm");
        let tasks = Tasks { numbers: Some(&[0, 1]), cores: 4 };
        let text = script_text("pluvia-1", tasks, &["7".into()], &request, logs, "pluvia x");
        for line in [
            "#!/bin/sh",
            "#SBATCH --requeue",
            "#SBATCH --signal=B:TERM@30",
            "#SBATCH --cpus-per-task=4",
            "#SBATCH --array=0-1",
            "#SBATCH --dependency=afterany:7",
            "#SBATCH --partition=long",
            "#SBATCH --time=02:00:00",
            "#SBATCH --output=\"out/slurm/%x-%A_%a.log\"",
            "exec pluvia x",
        ] {
            assert!(text.lines().any(|l| l == line), "law: there is a line {line}, got\n{text}");
        }
        assert!(!text.contains("--mem"), "law: what was not given is left to the cluster");
    }

    #[test]
    fn paths_survive_sbatch() {
        let pattern = log_pattern(Path::new("a b/100% \"x\" it's"), "%j.log");
        assert_eq!(pattern, r#""a b/100%% \"x\" it's/%j.log""#);
    }
}
