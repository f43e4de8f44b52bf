//! A fuzz target: reads bytes as the manifest of a run (`manifest` in `targets.rs`).

#![no_main]

#[path = "../targets.rs"]
#[allow(dead_code)]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::manifest(data));
