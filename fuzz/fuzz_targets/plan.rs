//! A fuzz target: reads bytes as the plan of a sweep (`plan` in `targets.rs`).

#![no_main]

#[path = "../targets.rs"]
#[allow(dead_code)]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::plan(data));
