//! A fuzz target: reads bytes as the design of a convergence or sensitivity study (`design`
//! in `targets.rs`).

#![no_main]

#[path = "../targets.rs"]
#[allow(dead_code)]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::design(data));
