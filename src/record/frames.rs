//! Frames: where everything was at regular times of a stage, in a compact file.
//!
//! Little endian. First the eight bytes `PLUVFRM1` and the number of grains as
//! a 32-bit integer; then frames of one length, each
//!
//! | bytes | content |
//! | --- | --- |
//! | 8 | time since the run began in s, 64-bit float |
//! | 4 | what is there, 32-bit integer: 1 cylinder, 2 funnel, 4 its lid, 8 top plate |
//! | 4 | displacement of the table along x in m, 32-bit float |
//! | 4 | height of the funnel's opening above the cylinder's floor in m |
//! | 20 | centroid and orientation of the top plate, as of a grain |
//! | 20 a grain | centroid in m as three 32-bit floats, NaN for a grain that is no longer there; orientation as a unit quaternion x, y, z, w in 16-bit integers of 1/32767 |
//!
//! With pieces it begins `PLUVFRM2`, the highest byte of that integer counts them, and they follow the grains.
//!
//! A quaternion's rounding turns a grain by less than 0.0036°: by 4 · 0.5/32767 rad at most.

use std::io::{BufWriter, Read, Seek, SeekFrom, Write};
use std::sync::Arc;

use nalgebra::{Isometry3, Quaternion, Translation3, UnitQuaternion};
use sha2::{Digest, Sha256};

use super::*;
use crate::geometry::Pose;
use crate::specimen::{Base, FunnelState};

/// Name of the file in a stage's folder.
pub const FRAMES_FILE: &str = "frames.bin";

const MAGIC: &[u8; 8] = b"PLUVFRM1";
const MAGIC_WITH_PIECES: &[u8; 8] = b"PLUVFRM2";
/// The bit from which the number of pieces stands.
const PIECES_FROM: u32 = 24;
const HEAD: usize = 12;
const PLACE: usize = 20;
const BEFORE_GRAINS: usize = 20 + PLACE;

const CYLINDER: u32 = 1;
const FUNNEL: u32 = 2;
const LID: u32 = 4;
const TOP_PLATE: u32 = 8;

/// Where everything was at one time.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Frame {
    /// Time since the run began in s.
    pub time: f64,
    /// Whether the cylinder stood on the table.
    pub cylinder: bool,
    /// The funnel, where it stood.
    pub funnel: Option<FunnelState>,
    /// What a pile stands on; a file of frames does not hold it.
    pub base: Option<Arc<Base>>,
    /// Displacement of the table along x in m.
    pub table_x: f64,
    /// Pose of the top plate's centroid, where it was placed.
    pub top_plate: Option<Pose>,
    /// Pose of each grain's principal frame; none where it was no longer there.
    pub grains: Vec<Option<Pose>>,
    /// Frame of each piece of a laboratory; none where it was removed.
    pub pieces: Vec<Option<Pose>>,
}

impl Frame {
    /// A specimen's state as a frame.
    pub fn of(state: &SpecimenState) -> Self {
        let grain =
            |g: &crate::specimen::GrainState| (g.fate == Fate::Present).then_some(g.body.pose);
        Self {
            time: state.time,
            cylinder: state.cylinder,
            funnel: state.funnel,
            base: state.base.clone().map(Arc::new),
            table_x: state.table_x,
            top_plate: state.top_plate.map(|plate| plate.pose),
            grains: state.bodies.iter().map(grain).collect(),
            pieces: state.pieces.iter().map(|p| p.present.then_some(p.pose)).collect(),
        }
    }

    /// Writes it as one frame of the file, without the file's head.
    ///
    /// # Errors
    /// When `out` refuses.
    pub fn write(&self, out: &mut impl Write) -> io::Result<()> {
        let mut there = 0;
        for (flag, is) in [
            (CYLINDER, self.cylinder),
            (FUNNEL, self.funnel.is_some()),
            (LID, self.funnel.is_some_and(|f| f.lid)),
            (TOP_PLATE, self.top_plate.is_some()),
        ] {
            there |= if is { flag } else { 0 };
        }
        out.write_all(&self.time.to_le_bytes())?;
        out.write_all(&there.to_le_bytes())?;
        out.write_all(&(self.table_x as f32).to_le_bytes())?;
        let opening = self.funnel.map_or(0.0, |f| f.opening_height);
        out.write_all(&(opening as f32).to_le_bytes())?;
        write_place(self.top_plate.as_ref(), out)?;
        self.grains
            .iter()
            .chain(&self.pieces)
            .try_for_each(|grain| write_place(grain.as_ref(), out))
    }

    /// One of which every number can be of a frame.
    fn sound(bytes: &[u8], grains: usize) -> Result<Self, String> {
        let frame = Self::read(bytes, grains);
        let opening = frame.funnel.map_or(0.0, |funnel| funnel.opening_height);
        let poses = frame.grains.iter().chain(&frame.pieces).flatten().chain(&frame.top_plate);
        let farthest = poses.map(|pose| pose.translation.vector.amax());
        let mut numbers = farthest.chain([frame.time, frame.table_x, opening]);
        match numbers.find(|number| !(number.abs() <= LARGEST)) {
            Some(number) => Err(format!("a place or time in a frame is {number:e}")),
            None => Ok(frame),
        }
    }

    fn read(bytes: &[u8], grains: usize) -> Self {
        let places = || bytes[BEFORE_GRAINS..].chunks_exact(PLACE).map(read_place);
        let there = u32::from_le_bytes(taken(bytes, 8));
        let is = |flag| there & flag != 0;
        Self {
            time: f64::from_le_bytes(taken(bytes, 0)),
            cylinder: is(CYLINDER),
            funnel: is(FUNNEL)
                .then(|| FunnelState { opening_height: single(bytes, 16), lid: is(LID) }),
            base: None,
            table_x: single(bytes, 12),
            top_plate: is(TOP_PLATE).then(|| read_place(&bytes[20..])).flatten(),
            grains: places().take(grains).collect(),
            pieces: places().skip(grains).collect(),
        }
    }
}

/// The bytes of a number that begins at a place.
fn taken<const N: usize>(bytes: &[u8], at: usize) -> [u8; N] {
    *bytes[at..].first_chunk().expect("the length of a frame is known")
}

/// The number in single precision that begins at a place.
fn single(bytes: &[u8], at: usize) -> f64 {
    f64::from(f32::from_le_bytes(taken(bytes, at)))
}

fn write_place(pose: Option<&Pose>, out: &mut impl Write) -> io::Result<()> {
    let Some(pose) = pose else {
        for _ in 0..3 {
            out.write_all(&f32::NAN.to_le_bytes())?;
        }
        return out.write_all(&[0; 8]);
    };
    for x in pose.translation.vector.iter() {
        out.write_all(&(*x as f32).to_le_bytes())?;
    }
    for x in pose.rotation.coords.iter() {
        out.write_all(&((x * 32767.0).round() as i16).to_le_bytes())?;
    }
    Ok(())
}

fn read_place(bytes: &[u8]) -> Option<Pose> {
    let position = [0, 4, 8].map(|at| single(bytes, at));
    if position.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let [x, y, z, w] = [12, 14, 16, 18].map(|at| f64::from(i16::from_le_bytes(taken(bytes, at))));
    let rotation = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 0.5)?;
    Some(Isometry3::from_parts(Translation3::from(position), rotation))
}

/// No number of a frame is larger, in m and s.
const LARGEST: f64 = 1e6;

/// Where frames stand until the stage is finished.
#[derive(Debug)]
enum Place {
    /// In a file that goes when it is not kept.
    Temporary(tempfile::TempPath),
    /// In one that stays, to be gone on with.
    Staying(PathBuf),
}

/// How far a file of frames was written when a segment of its stage ended.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct FramesSoFar {
    /// Bytes.
    length: u64,
    /// SHA-256 of them.
    sha256: String,
}

/// Writes the frames of a stage one after the other into a file.
#[derive(Debug)]
pub struct FrameWriter {
    out: BufWriter<File>,
    place: Place,
    hash: Sha256,
    /// Bytes written.
    length: u64,
    /// Bytes of one frame, used again for the next.
    frame: Vec<u8>,
    fault: Option<io::Error>,
}

impl FrameWriter {
    /// Begins a file for a number of grains in a folder; it is removed unless it is kept.
    ///
    /// # Errors
    /// When it cannot be made.
    pub fn new(folder: &Path, grains: usize, pieces: usize) -> Result<Self, FileError> {
        let refused = |e| FileError::new("create a file in", folder, e);
        let file = make_file(tempfile::Builder::new().prefix(".part-"), folder).map_err(refused)?;
        let (file, path) = file.into_parts();
        Self::begin(file, Place::Temporary(path), grains, pieces).map_err(refused)
    }

    /// Begins a file that stays where it is when the stage is interrupted, in
    /// place of what may be there.
    pub(super) fn staying(path: &Path, grains: usize, pieces: usize) -> Result<Self, FileError> {
        let refused = |e| FileError::new("create", path, e);
        // What is there may be a stored stage's by another name: it is not emptied.
        let _ = fs::remove_file(path);
        let file = File::create(path).map_err(refused)?;
        Self::begin(file, Place::Staying(path.to_owned()), grains, pieces).map_err(refused)
    }

    /// Goes on with such a file where a segment had ended; what was written since is forgotten.
    pub(super) fn going_on(path: &Path, so_far: &FramesSoFar) -> Result<Self, FileError> {
        let refused = |e| FileError::new("go on with", path, e);
        let mut file = File::options().read(true).write(true).open(path).map_err(refused)?;
        let mut hash = Sha256::new();
        let read = hash_of(&mut (&mut file).take(so_far.length), &mut hash).map_err(refused)?;
        if read != so_far.length || hexadecimal(&hash.clone().finalize()) != so_far.sha256 {
            return Err(FileError::changed(path));
        }
        file.set_len(so_far.length).map_err(refused)?;
        let place = Place::Staying(path.to_owned());
        Ok(Self::of(file, place, hash, so_far.length))
    }

    fn of(file: File, place: Place, hash: Sha256, length: u64) -> Self {
        let out = BufWriter::new(file);
        Self { out, place, hash, length, frame: Vec::new(), fault: None }
    }

    fn begin(file: File, place: Place, grains: usize, pieces: usize) -> io::Result<Self> {
        let mut writer = Self::of(file, place, Sha256::new(), 0);
        let mut head = if pieces > 0 { MAGIC_WITH_PIECES } else { MAGIC }.to_vec();
        head.extend((grains as u32 | (pieces as u32) << PIECES_FROM).to_le_bytes());
        writer.write(&head)?;
        Ok(writer)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.hash.update(bytes);
        self.length += bytes.len() as u64;
        self.out.write_all(bytes)
    }

    /// Has everything so far written to the disk, and says how much it is.
    pub(super) fn so_far(&mut self) -> Result<FramesSoFar, FileError> {
        let path = match &self.place {
            Place::Temporary(path) => path.to_path_buf(),
            Place::Staying(path) => path.clone(),
        };
        let refused = |e| FileError::new("write", &path, e);
        if let Some(fault) = self.fault.take() {
            return Err(refused(fault));
        }
        self.out.flush().map_err(refused)?;
        self.out.get_ref().sync_all().map_err(refused)?;
        Ok(FramesSoFar { length: self.length, sha256: hexadecimal(&self.hash.clone().finalize()) })
    }

    /// Adds a state at a time in s since the run began. A fault is reported at the end.
    pub fn add(&mut self, state: &SpecimenState, time: f64) {
        if self.fault.is_none() {
            let frame = Frame { time, ..Frame::of(state) };
            let mut bytes = std::mem::take(&mut self.frame);
            bytes.clear();
            let written = frame.write(&mut bytes).and_then(|()| self.write(&bytes));
            self.fault = written.err();
            self.frame = bytes;
        }
    }

    /// Puts the file in its place; gives the SHA-256 of its content. One that
    /// stays is there too until its folder is removed.
    ///
    /// # Errors
    /// When not everything could be written.
    pub fn keep(self, path: &Path) -> Result<String, FileError> {
        let refused = |e| FileError::new("write", path, e);
        if let Some(fault) = self.fault {
            return Err(refused(fault));
        }
        let file = self.out.into_inner().map_err(|e| refused(e.into_error()))?;
        file.sync_all().map_err(refused)?;
        make_readable(&file).map_err(refused)?;
        match self.place {
            Place::Temporary(from) => from.persist(path).map_err(|e| refused(e.error))?,
            // Where there are no links, it is copied.
            Place::Staying(from) => fs::hard_link(&from, path)
                .or_else(|_| fs::copy(&from, path).and_then(|_| File::open(path)?.sync_all()))
                .map_err(refused)?,
        }
        Ok(hexadecimal(&self.hash.finalize()))
    }
}

/// Which frames of a stage are read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FramesRead {
    /// All of them.
    All,
    /// The first of every stage and the last two alone, so that a long run takes no more memory than a
    /// short one.
    Ends,
}

/// Reads the frames of a stage, whose SHA-256 is compared unless it is empty.
pub(super) fn read_frames(path: &Path, sha256: &str) -> Result<Vec<Frame>, FileError> {
    let bytes = read_unchanged(path, sha256)?;
    frames_of(&bytes).map_err(|why| FileError::unfit(path, why))
}

/// The first frame of a stage and the last two, or as many as there are: what tells its beginning
/// and end, without holding in memory what lies between.
pub(super) fn read_frame_ends(path: &Path, sha256: &str) -> Result<Vec<Frame>, FileError> {
    let unread = |e: io::Error| FileError::unread(path, &e);
    if !sha256.is_empty() && hash_file(path).map_err(unread)? != sha256 {
        return Err(FileError::changed(path));
    }
    let (mut file, size) = input::open(path, input::LARGEST_OF_RUN).map_err(unread)?;
    let mut head = Vec::new();
    (&mut file).take(HEAD as u64).read_to_end(&mut head).map_err(unread)?;
    let unusable = |why| FileError::unfit(path, why);
    let (frame, grains) = frame_length(&head).map_err(unusable)?;
    let (length, body) = (frame as u64, size.saturating_sub(HEAD as u64));
    if body % length != 0 {
        return Err(unusable("its last frame is cut off".to_owned()));
    }
    let count = body / length;
    let mut wanted = vec![0, count.saturating_sub(2), count.saturating_sub(1)];
    wanted.dedup();
    let mut frames = Vec::new();
    for n in wanted.into_iter().filter(|n| *n < count) {
        // Only now is the length that the head gives known to be there.
        let mut bytes = vec![0; frame];
        file.seek(SeekFrom::Start(HEAD as u64 + n * length)).map_err(unread)?;
        file.read_exact(&mut bytes).map_err(unread)?;
        frames.push(Frame::sound(&bytes, grains).map_err(unusable)?);
    }
    Ok(frames)
}

/// Bytes of a frame and its number of grains, by the head of its file.
fn frame_length(head: &[u8]) -> Result<(usize, usize), String> {
    let with_pieces = head.starts_with(MAGIC_WITH_PIECES);
    if head.len() < HEAD || !(with_pieces || head.starts_with(MAGIC)) {
        return Err("it does not begin as frames do".to_owned());
    }
    let number = u32::from_le_bytes(taken(head, 8));
    let pieces = if with_pieces { number >> PIECES_FROM } else { 0 };
    let grains = (number - (pieces << PIECES_FROM)) as usize;
    Ok((BEFORE_GRAINS + PLACE * (grains + pieces as usize), grains))
}

fn frames_of(bytes: &[u8]) -> Result<Vec<Frame>, String> {
    let (length, grains) = frame_length(bytes)?;
    let frames = bytes[HEAD..].chunks_exact(length);
    if !frames.remainder().is_empty() {
        return Err(format!("its last frame of {} is cut off", counted(grains, "grain")));
    }
    frames.map(|frame| Frame::sound(frame, grains)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame() -> Frame {
        let turned = UnitQuaternion::from_euler_angles(0.3, -1.1, 2.7);
        let pose = |x: f64| Isometry3::from_parts(Translation3::new(x, -0.02, 0.11), turned);
        Frame {
            time: 3.76,
            cylinder: true,
            funnel: Some(FunnelState { opening_height: 0.25, lid: true }),
            base: None,
            table_x: -0.015625,
            top_plate: Some(pose(0.5)),
            grains: vec![Some(pose(0.031)), None, Some(pose(-0.04))],
            pieces: Vec::new(),
        }
    }

    fn bytes(frames: &[Frame]) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(3u32.to_le_bytes());
        for frame in frames {
            frame.write(&mut bytes).expect("memory");
        }
        bytes
    }

    #[test]
    fn frames_with_numbers_that_cannot_be_are_refused() {
        type Change = fn(&mut Frame);
        let changes: [Change; 4] = [
            |f| f.time = f64::INFINITY,
            |f| f.table_x = 1e30,
            |f| f.funnel = Some(FunnelState { opening_height: f64::NAN, lid: true }),
            |f| f.grains[0] = Some(Isometry3::translation(0.0, -2e6, 0.0)),
        ];
        for (n, change) in changes.into_iter().enumerate() {
            let mut crafted = frame();
            change(&mut crafted);
            let got = frames_of(&bytes(&[frame(), crafted])).expect_err("law: it cannot be");
            assert!(got.contains("a place or time"), "law: case {n} is refused, got {got}");
        }
    }

    #[test]
    fn frames_come_back_within_their_rounding() {
        let wrote = frame();
        let read = frames_of(&bytes(&[wrote.clone(), wrote.clone()])).expect("frames");
        assert_eq!(read.len(), 2, "law: as many frames as written");
        let got = &read[1];
        assert_eq!(
            (got.time, got.cylinder, got.funnel, got.table_x),
            (wrote.time, wrote.cylinder, wrote.funnel, wrote.table_x)
        );
        let places = [(&got.top_plate, &wrote.top_plate)]
            .into_iter()
            .chain(got.grains.iter().zip(&wrote.grains));
        for (got, wrote) in places {
            assert_eq!(got.is_some(), wrote.is_some(), "law: there or not there");
            if let (Some(got), Some(wrote)) = (got, wrote) {
                let shift = (got.translation.vector - wrote.translation.vector).norm();
                let turn = got.rotation.angle_to(&wrote.rotation).to_degrees();
                assert!(shift < 1e-7, "law: same place, expected 0, got {shift} m, tolerance 1e-7");
                assert!(turn < 0.0036, "law: same turn, expected 0, got {turn}°, tolerance 0.0036");
            }
        }
    }

    #[test]
    fn the_ends_are_those_of_all_frames() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("frames.bin");
        let at = |n: usize| Frame { time: 0.08 * n as f64, ..frame() };
        for (count, ends) in
            [(0, vec![]), (1, vec![0]), (2, vec![0, 1]), (3, vec![0, 1, 2]), (9, vec![0, 7, 8])]
        {
            let content = bytes(&(0..count).map(at).collect::<Vec<_>>());
            fs::write(&path, &content).expect("written");
            let hash = crate::record::hash_bytes(&content);
            let all = read_frames(&path, &hash).expect("frames");
            let expected: Vec<Frame> = ends.iter().map(|&n: &usize| all[n].clone()).collect();
            let got = read_frame_ends(&path, &hash).expect("frames");
            assert_eq!(got, expected, "law: first and last two of {count}");
            read_frame_ends(&path, "0").expect_err("law: changed files are refused");
        }
        let cut = &bytes(&[at(0)])[..80];
        fs::write(&path, cut).expect("written");
        for refused in [read_frames(&path, ""), read_frame_ends(&path, "")] {
            assert!(refused.expect_err("cut off").to_string().contains("cut off"));
        }
    }

    #[test]
    fn what_is_no_frames_file_is_refused() {
        let whole = bytes(&[frame()]);
        for (content, expected) in [
            (&whole[..whole.len() - 1], "cut off"),
            (&b"PNG"[..], "does not begin"),
            (&[0; 64][..], "does not begin"),
        ] {
            let got = frames_of(content).expect_err("it is no frames file");
            assert!(got.contains(expected), "law: `{expected}` is said, got `{got}`");
        }
    }
}
