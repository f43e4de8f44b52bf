//! `pluvia view` plays a run in the browser, in three dimensions.

use std::sync::mpsc::RecvTimeoutError;

use super::picture::{ends_in, prepare, refuse_existing};
use super::*;
use crate::viewer::{Redirect, Server, Site, read_run_data, self_contained};

/// Play a run in the browser, in three dimensions
#[derive(Debug, Args)]
#[command(after_help = "\
The page is served to this machine alone, until Ctrl-C. docs/viewer.md says what it shows.

Examples:
  pluvia view out/first
  pluvia view out/reproduce/runs/vibration-continuous-c1 --no-browser --port 8000
  pluvia view out/first --save first.html")]
pub(super) struct ViewArgs {
    /// Folder of a run, as `pluvia run` and `pluvia reproduce` leave it
    #[arg(value_name = "RUN_DIR")]
    run: PathBuf,
    /// Port on 127.0.0.1; 0 takes a free one
    #[arg(long, default_value_t = 0, value_parser = whole(0, u16::MAX),
          allow_negative_numbers = true)]
    port: u16,
    /// Print the address without opening a browser
    #[arg(long)]
    no_browser: bool,
    /// Write the page with the run inside as one file, to hand to others, and serve nothing; its
    /// folder is created if needed, and an existing file is kept unless --force is given
    #[arg(long, value_name = "FILE.html", conflicts_with_all = ["port", "no_browser"])]
    pub(super) save: Option<PathBuf>,
    /// Replace the file if it exists already
    #[arg(long, requires = "save")]
    force: bool,
}

/// What is shown, and where.
#[derive(Serialize)]
struct Shown {
    scenario: String,
    grains: usize,
    stages: usize,
    frames: usize,
    /// Whether every stage kept frames.
    frames_kept: bool,
    /// Address of the page, where it is served.
    address: Option<String>,
    /// The file, where it is saved.
    file: Option<String>,
}

impl Shown {
    fn text(&self) -> String {
        let Self { scenario, grains, stages, frames, .. } = self;
        let scenario = plain(scenario);
        let [grains, stages, frames] = [(grains, "grain"), (stages, "stage"), (frames, "frame")]
            .map(|(n, one)| counted(*n, one));
        let mut text = format!("{scenario}: {grains}, {stages}, {frames}\n");
        if !self.frames_kept {
            text += "Some stages kept no frames: only their end is shown.\n";
        }
        match (&self.address, &self.file) {
            (Some(address), _) => text += &format!("{address}  (stop with Ctrl-C)\n"),
            (None, Some(file)) => text += &format!("wrote {}\n", plain(file)),
            (None, None) => {}
        }
        text
    }
}

pub(super) fn run(args: &ViewArgs, context: &Context) -> Result<ExitStatus, CliError> {
    if let Some(file) = &args.save {
        ends_in(file, "--save", &["html", "htm"])?;
        refuse_existing(file, args.force)?;
        context.stop_without_stages();
    }
    let data = read_run_data(&args.run)?;
    let mut shown = Shown {
        scenario: data.scenario.clone(),
        grains: data.grains,
        stages: data.stages,
        frames: data.frames,
        frames_kept: data.kept,
        address: None,
        file: args.save.as_ref().map(|file| file.to_string_lossy().into_owned()),
    };
    if let Some(file) = &args.save {
        let page = self_contained(&data);
        context.go_on()?;
        prepare(file, args.force)?;
        write_file(file, page.as_bytes())?;
        return context.done(&shown.text(), &shown);
    }
    let (stop, stopped) = std::sync::mpsc::channel();
    // One sender stays here, so that waiting goes on where no handler can be set.
    let sender = stop.clone();
    if let Err(error) = ctrlc::set_handler(move || sender.send(()).unwrap_or_default()) {
        say(&format!("warning: Ctrl-C will stop at once, not cleanly: {error}"));
    }
    let server = Server::start(Site::new(data), args.port)?;
    shown.address = Some(server.url());
    if args.no_browser {
        // Nobody else could find the page.
        context.print_asked(&shown.text(), &shown)?;
    } else {
        context.print(&shown.text(), &shown)?;
    }
    let mut redirect = if args.no_browser { None } else { browse(&server.url()) };
    let opened = Instant::now();
    // The page that leads there is not needed once a browser has followed it.
    while redirect.is_some() {
        match stopped.recv_timeout(LOOK) {
            Err(RecvTimeoutError::Timeout) => {}
            _ => return Ok(ExitStatus::Done),
        }
        redirect = redirect.filter(|_| !server.was_asked() && opened.elapsed() < BROWSER_TIME);
    }
    let _ = stopped.recv();
    drop(stop);
    Ok(ExitStatus::Done)
}

/// How long a browser may take to begin, and the time between two looks whether it has.
const BROWSER_TIME: Duration = Duration::from_secs(120);
const LOOK: Duration = Duration::from_millis(200);

/// Opens a browser by a page that its user alone can read, so that the address is in no list of
/// processes.
fn browse(url: &str) -> Option<Redirect> {
    let opened = Redirect::to(url).and_then(|redirect| {
        open::that_detached(redirect.path())?;
        Ok(redirect)
    });
    if let Err(error) = &opened {
        say(&format!("warning: no browser could be opened ({error}); open {url}"));
    }
    opened.ok()
}
