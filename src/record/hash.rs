//! Content hashes: the names under which results are stored.

use std::io::Read;

use sha2::{Digest, Sha256};

use super::*;

pub(super) use crate::input::hexadecimal;
pub use crate::input::sha256 as hash_bytes;

/// SHA-256 of a file's content, read in pieces.
pub(super) fn hash_file(path: &Path) -> io::Result<String> {
    let mut hash = Sha256::new();
    hash_of(&mut input::open(path, input::LARGEST_OF_RUN)?.0, &mut hash)?;
    Ok(hexadecimal(&hash.finalize()))
}

/// Feeds all that can be read to a hash; gives the number of bytes.
pub(super) fn hash_of(from: &mut impl Read, hash: &mut Sha256) -> io::Result<u64> {
    let mut piece = vec![0; 1 << 16];
    let mut read = 0;
    loop {
        match from.read(&mut piece) {
            Ok(0) => return Ok(read),
            Ok(length) => {
                hash.update(&piece[..length]);
                read += length as u64;
            }
            Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
            Err(error) => return Err(error),
        }
    }
}

/// SHA-256 of a value's JSON. Maps must be ordered (structs and `BTreeMap` are); numbers are
/// written in their shortest exact form, so equal values give equal hashes.
///
/// # Panics
/// When the value has no JSON form; the types hashed here all have one.
pub fn hash_json(value: &impl Serialize) -> String {
    hash_bytes(&serde_json::to_vec(value).expect("hashed values have a JSON form"))
}
