//! Content hashes: the names under which results are stored.

use serde::Serialize;
use sha2::{Digest, Sha256};

/// SHA-256 of bytes, in lower-case hexadecimal.
pub fn hash_bytes(bytes: &[u8]) -> String {
    Sha256::digest(bytes).iter().map(|b| format!("{b:02x}")).collect()
}

/// SHA-256 of a value's JSON. Maps must be ordered (structs and `BTreeMap`
/// are); numbers are written in their shortest exact form, so equal values
/// give equal hashes.
///
/// # Panics
/// When the value has no JSON form; the types hashed here all have one.
pub fn hash_json(value: &impl Serialize) -> String {
    hash_bytes(&serde_json::to_vec(value).expect("hashed values have a JSON form"))
}
