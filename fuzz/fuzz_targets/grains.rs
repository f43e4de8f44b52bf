//! A fuzz target: reads bytes as a sieve analysis from which grains are cut (`grains` in
//! `targets.rs`).

#![no_main]

#[path = "../targets.rs"]
#[allow(dead_code)]
mod targets;

libfuzzer_sys::fuzz_target!(|data: &[u8]| targets::grains(data));
