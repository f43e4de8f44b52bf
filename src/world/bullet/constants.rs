//! Bullet's own version, enums and constants, read from its headers by bindgen.

#![allow(
    missing_docs,
    non_camel_case_types,
    non_upper_case_globals,
    dead_code,
    unsafe_code,
    clippy::all
)]

include!(concat!(env!("OUT_DIR"), "/constants.rs"));
