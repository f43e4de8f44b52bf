//! A fuzz target: reads bytes as a specimen, a grain file or frames (`specimen` in `targets.rs`).

#![no_main]

#[path = "../targets.rs"]
#[allow(dead_code)]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::specimen(data));
