//! Checkpoints: where a stage is at the ends of its segments, on disk until it is finished.
//!
//! A folder `.segments-<key>` beside the stages holds, while a stage with segments is run, one file
//! a segment (the last two are kept) and the frames so far. A checkpoint file has one line with the
//! SHA-256 of all that follows, which is JSON. It says of which stage it is. One that is damaged,
//! or of another stage, is passed over for the one before it.

use super::*;
use crate::protocol::Midway;

/// How a checkpoint begins; the number is that of its format.
const HEAD: &str = "pluvia checkpoint 2 ";

/// How many are kept: the last, and one in case that is damaged.
const KEPT: usize = 2;

/// How the names of their folders begin.
pub(super) const FOLDER: &str = ".segments-";

/// Name of the file that is held by whoever runs the stage.
const LOCK: &str = "lock";

/// How often a folder is made again that somebody removes at the same time.
const TRIES: u32 = 1000;

/// What is observed of a stage so far.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Observed {
    /// The rows of its series.
    pub rows: Vec<SeriesRow>,
    /// What settlement is counted from.
    pub reference: Reference,
    /// What was seen of the overlap of grains.
    pub overlap: OverlapWatch,
    /// How far grains sank in rests in which some left or came.
    pub sinking: Sinking,
    /// What was observed of a laboratory of pieces.
    pub laboratory: LaboratorySeries,
    /// Energy at the rows; fewer where it went on from a checkpoint of before this was recorded.
    pub energy: Vec<EnergyRow>,
    /// Wall time in s.
    pub wall_s: f64,
}

/// What settlement and height of a pile are counted from, once measured.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize)]
pub struct Reference {
    /// Heights in mm of the plate when the first vibration with one began, and of the mean surface
    /// when the first of all did.
    pub before_vibration_mm: Option<(Option<f64>, f64)>,
    /// Mean height of a pile's base in m.
    pub base_level_m: Option<f64>,
}

#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Stored {
    identity: StageIdentity,
    /// SHA-256 of the specimen that the stage began with.
    began_with_sha256: Option<String>,
    midway: Midway,
    series_csv: String,
    reference: Reference,
    overlap: OverlapWatch,
    #[serde(default, skip_serializing_if = "Sinking::is_empty")]
    sinking: Sinking,
    #[serde(default, skip_serializing_if = "LaboratorySeries::is_empty")]
    laboratory: LaboratorySeries,
    #[serde(default)]
    energy: Vec<EnergyRow>,
    frames: Option<FramesSoFar>,
    wall_s: f64,
}

/// Where a stage can go on.
#[derive(Debug)]
pub struct Resumed {
    /// The stage.
    pub midway: Midway,
    /// What was observed.
    pub observed: Observed,
    /// The file of frames, where they are kept.
    pub frames: Option<FrameWriter>,
}

/// The checkpoints of one stage, which nobody else writes meanwhile.
#[derive(Debug)]
pub struct Checkpoints {
    folder: PathBuf,
    identity: StageIdentity,
    began_with: Option<String>,
    lock: File,
}

impl Checkpoints {
    /// Those of a stage in a store's folder; none where another program is just running that stage.
    pub(super) fn open(root: &Path, asked: &AskedStage) -> Result<Option<Self>, FileError> {
        let folder = folder(root, &asked.identity.key);
        let Some(lock) = claim(&folder)? else { return Ok(None) };
        remove_abandoned_in(&folder);
        Ok(Some(Self {
            folder,
            identity: asked.identity.clone(),
            began_with: asked.began_with.map(str::to_owned),
            lock,
        }))
    }

    /// Removes what a finished stage may have left.
    pub(super) fn discard(root: &Path, key: &str) {
        let folder = folder(root, key);
        if folder.is_dir()
            && let Ok(Some(lock)) = claim(&folder)
        {
            clear(&folder, lock);
        }
    }

    /// Begins the file of frames.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn frames(&self, grains: usize, pieces: usize) -> Result<FrameWriter, FileError> {
        FrameWriter::staying(&self.folder.join(FRAMES_FILE), grains, pieces)
    }

    /// The last checkpoint that is sound, of this stage and plausible, with its frames where they
    /// are wanted; and what is wrong with later ones, which are removed.
    pub fn last(
        &self,
        frames: bool,
        plausible: &dyn Fn(&Midway) -> Result<(), String>,
    ) -> (Option<Resumed>, Vec<FileError>) {
        let mut damaged = Vec::new();
        for path in files(&self.folder).into_iter().rev() {
            match self.read(&path, frames, plausible) {
                Ok(resumed) => return (resumed, damaged),
                Err(error) => {
                    damaged.push(error);
                    let _ = fs::remove_file(&path);
                }
            }
        }
        (None, damaged)
    }

    /// None where it has no frames and they are wanted.
    fn read(
        &self,
        path: &Path,
        frames: bool,
        plausible: &dyn Fn(&Midway) -> Result<(), String>,
    ) -> Result<Option<Resumed>, FileError> {
        let unread = |e: String| FileError::malformed(path, e);
        let unfit = |why: String| FileError::unfit(path, why);
        let stored = read_stored(path)?;
        stored.identity.is(&self.identity).map_err(unfit)?;
        if stored.began_with_sha256 != self.began_with {
            let why = "its stage began with another specimen than the stage before has";
            return Err(unfit(why.to_owned()));
        }
        check_midway(path, &stored)?;
        plausible(&stored.midway).map_err(unfit)?;
        let rows = series_from_csv(stored.series_csv.as_bytes());
        let frames = match (frames, &stored.frames) {
            (false, _) => None,
            (true, None) => return Ok(None),
            (true, Some(so_far)) => {
                Some(FrameWriter::going_on(&self.folder.join(FRAMES_FILE), so_far)?)
            }
        };
        Ok(Some(Resumed {
            midway: stored.midway,
            observed: Observed {
                rows: rows.map_err(|e| unread(e.to_string()))?,
                reference: stored.reference,
                overlap: stored.overlap,
                sinking: stored.sinking,
                laboratory: stored.laboratory,
                energy: stored.energy,
                wall_s: stored.wall_s,
            },
            frames,
        }))
    }

    /// Stores where a stage is, with what was observed and its frames so far.
    ///
    /// # Errors
    /// When it cannot be written; the checkpoints before are still there.
    pub fn keep(
        &self,
        midway: &Midway,
        observed: &Observed,
        frames: Option<&mut FrameWriter>,
    ) -> Result<(), FileError> {
        let path = self.folder.join(name(midway.steps));
        let refused = |e: String| FileError::new("write", &path, e);
        let series = to_csv(&observed.rows).map_err(|e| refused(e.to_string()))?;
        let stored = Stored {
            identity: self.identity.clone(),
            began_with_sha256: self.began_with.clone(),
            midway: midway.clone(),
            series_csv: String::from_utf8(series).map_err(|e| refused(e.to_string()))?,
            reference: observed.reference,
            overlap: observed.overlap,
            sinking: observed.sinking.clone(),
            laboratory: observed.laboratory.clone(),
            energy: observed.energy.clone(),
            frames: frames.map(FrameWriter::so_far).transpose()?,
            wall_s: observed.wall_s,
        };
        let body = serde_json::to_vec(&stored).map_err(|e| refused(e.to_string()))?;
        let mut content = format!("{HEAD}{}\n", hash_bytes(&body)).into_bytes();
        content.extend(body);
        write_file(&path, &content)?;
        let files = files(&self.folder);
        for old in files.iter().take(files.len().saturating_sub(KEPT)) {
            // One too many does no harm.
            let _ = fs::remove_file(old);
        }
        Ok(())
    }

    /// Removes them, the stage being finished. What cannot be removed does no harm.
    pub fn remove(self) {
        clear(&self.folder, self.lock);
    }
}

fn name(steps: u64) -> String {
    format!("{steps:020}.segment")
}

fn folder(root: &Path, key: &str) -> PathBuf {
    root.join(format!("{FOLDER}{}", key.get(..24).unwrap_or(key)))
}

/// Checkpoint files in a folder from the earliest to the latest.
pub(super) fn files(folder: &Path) -> Vec<PathBuf> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|e| e == "segment"))
        .collect();
    files.sort();
    files
}

/// Makes a folder of checkpoints and holds it; none where somebody else does.
/// Whoever has finished the stage may remove it at the same time.
fn claim(folder: &Path) -> Result<Option<File>, FileError> {
    claim_after(folder, || ())
}

fn claim_after(folder: &Path, mut opened: impl FnMut()) -> Result<Option<File>, FileError> {
    let path = folder.join(LOCK);
    let mut tries = 0;
    loop {
        create_folder(folder)?;
        tries += 1;
        let lock = match File::options().create(true).append(true).open(&path) {
            Err(e) if e.kind() == io::ErrorKind::NotFound && tries < TRIES => continue,
            opened => opened.map_err(|e| FileError::new("create", &path, e))?,
        };
        opened();
        match ask_alone(&lock) {
            AtWork::Somebody => return Ok(None),
            // One that was removed meanwhile keeps nobody else away.
            AtWork::Nobody if !has_name(&lock) && tries < TRIES => {}
            // A file system without locks has one program at a time, we hope.
            AtWork::Nobody | AtWork::Unknown => return Ok(Some(lock)),
        }
    }
}

/// Removes what a folder of checkpoints holds, then what keeps others away, and
/// the folder unless somebody else has begun there again.
fn clear(folder: &Path, lock: File) {
    remove_abandoned_in(folder);
    for path in files(folder).into_iter().chain([folder.join(FRAMES_FILE), folder.join(LOCK)]) {
        let _ = fs::remove_file(path);
    }
    let _ = fs::remove_dir(folder);
    drop(lock);
}

fn read_stored(path: &Path) -> Result<Stored, FileError> {
    let content = read_file(path)?;
    let line = content.iter().position(|b| *b == b'\n').unwrap_or(content.len());
    let (head, body) = content.split_at(line);
    let body = body.get(1..).unwrap_or_default();
    if head != format!("{HEAD}{}", hash_bytes(body)).as_bytes() {
        return Err(FileError::changed(path));
    }
    serde_json::from_slice(body).map_err(|e| FileError::malformed(path, e))
}

/// Whether a checkpoint has as many bodies as its stage has grains, and the name
/// of where it was made.
fn check_midway(path: &Path, stored: &Stored) -> Result<(), FileError> {
    let (bodies, grains) = (stored.midway.state.bodies.len(), stored.identity.grains);
    if bodies != grains {
        let (bodies, grains) = (counted(bodies, "body"), counted(grains, "grain"));
        let why = format!("it has {bodies}, and its stage {grains}");
        return Err(FileError::unfit(path, why));
    }
    if path.file_name().is_none_or(|found| found != name(stored.midway.steps).as_str()) {
        let why = format!("it was made at step {}, which is not its name", stored.midway.steps);
        return Err(FileError::unfit(path, why));
    }
    Ok(())
}

/// Of which stage a checkpoint is, if it is whole.
pub(super) fn check_checkpoint(path: &Path) -> Result<StageIdentity, FileError> {
    let stored = read_stored(path)?;
    stored.identity.check().map_err(|why| FileError::unfit(path, why))?;
    check_midway(path, &stored)?;
    Ok(stored.identity)
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;
    use crate::protocol::Watch;
    use crate::specimen::SpecimenState;

    fn named(stage: &str) -> StageIdentity {
        let determinants = serde_json::json!({ "stage": stage, "parent": "g" });
        StageIdentity::new(stage, (2, "g"), None, &determinants)
    }

    fn asked(identity: &StageIdentity) -> AskedStage<'_> {
        AskedStage { identity, began_with: None, plausible: &|_| Ok(()) }
    }

    fn open(root: &Path, asked: &AskedStage) -> Checkpoints {
        Checkpoints::open(root, asked).expect("a folder").expect("law: nobody else is at it")
    }

    fn midway(steps: u64, bodies: usize) -> Midway {
        Midway {
            state: SpecimenState::before_everything(bodies),
            began_s: 0.0,
            steps,
            collar_m: 0.0,
            next_look_s: 0.08,
            calm_since_s: None,
            engine_s: 0.0,
            warnings: Vec::new(),
            watch: Watch::default(),
            residuals: Vec::new(),
            fed: None,
            part: 0,
            part_began: 0,
            pieces_began: Vec::new(),
            judged: crate::protocol::Judged::default(),
            kept_stress: None,
        }
    }

    /// Keeps a checkpoint of a stage of two grains.
    pub(in crate::record) fn keep_one(root: &Path, identity: &StageIdentity) {
        let asked = AskedStage { began_with: Some("s"), ..asked(identity) };
        keep(&open(root, &asked), &midway(10, 2));
    }

    fn keep(checkpoints: &Checkpoints, midway: &Midway) {
        checkpoints.keep(midway, &Observed::default(), None).expect("kept");
    }

    /// At how many steps a stage goes on, and what is wrong with its checkpoints.
    fn goes_on(checkpoints: &Checkpoints) -> (Option<u64>, String) {
        let (resumed, damaged) = checkpoints.last(false, &|_| Ok(()));
        let reported: Vec<String> = damaged.iter().map(ToString::to_string).collect();
        (resumed.map(|r| r.midway.steps), reported.join("; "))
    }

    #[test]
    fn a_checkpoint_of_another_stage_is_not_gone_on_from() {
        let root = tempfile::tempdir().expect("a folder");
        let [pour, rest] = ["pour", "rest"].map(named);
        let of_pour = open(root.path(), &asked(&pour));
        keep(&of_pour, &midway(10, 2));
        assert_eq!(goes_on(&of_pour), (Some(10), String::new()), "law: its own");
        let file = files(&of_pour.folder).remove(0);
        let of_rest = open(root.path(), &asked(&rest));
        let copy = of_rest.folder.join(name(10));
        fs::copy(&file, &copy).expect("copied");
        check_checkpoint(&copy).expect("law: it is whole by itself");
        let (at, reported) = goes_on(&of_rest);
        assert!(
            at.is_none() && reported.contains("another stage"),
            "law: not another's, got {reported}"
        );
        assert!(!copy.exists(), "law: it is removed");
        drop(of_pour);
        let other = AskedStage { began_with: Some("s"), ..asked(&pour) };
        let (at, reported) = goes_on(&open(root.path(), &other));
        assert!(
            at.is_none() && reported.contains("another specimen"),
            "law: not of another specimen"
        );
    }

    #[test]
    fn a_crafted_checkpoint_with_its_hash_is_not_gone_on_from() {
        let root = tempfile::tempdir().expect("a folder");
        let pour = named("pour");
        let own = open(root.path(), &asked(&pour));
        keep(&own, &midway(10, 2));
        keep(&own, &midway(20, 1));
        let (at, reported) = goes_on(&own);
        assert_eq!(at, Some(10), "law: the one before is used");
        assert!(reported.contains("1 body"), "law: too few bodies are reported, got {reported}");
        fs::rename(own.folder.join(name(10)), own.folder.join(name(30))).expect("renamed");
        let (at, reported) = goes_on(&own);
        assert!(
            at.is_none() && reported.contains("step 10"),
            "law: another step's, got {reported}"
        );
        keep(&own, &midway(40, 2));
        let (resumed, damaged) = own.last(false, &|_| Err("grains fly".to_owned()));
        assert!(resumed.is_none() && damaged[0].to_string().contains("grains fly"));
    }

    /// Law: who finishes a stage takes its checkpoints away from nobody.
    #[test]
    fn checkpoints_removed_while_they_are_opened_are_begun_anew() {
        let root = tempfile::tempdir().expect("a folder");
        let place = folder(root.path(), "key");
        let mut removed = false;
        let lock = claim_after(&place, || {
            // As another program does between opening and holding.
            if !removed {
                fs::remove_dir_all(&place).expect("removed");
                removed = true;
            }
        });
        let lock = lock.expect("law: that is no error").expect("law: nobody else is at it");
        assert!(has_name(&lock) && place.join(LOCK).is_file(), "law: what is held is there");
        assert!(claim(&place).expect("there").is_none(), "law: it keeps others away");
        clear(&place, lock);
        assert!(!place.exists(), "law: nothing is left");
    }
}
