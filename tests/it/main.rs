//! Tests of the crate as a whole: its source, its documents, its files.

mod architecture;
mod bits;
mod calibrate;
mod cli;
mod collision;
mod compare;
mod docs;
mod export;
mod files;
mod fuzz;
mod interruption;
mod legs;
mod picture;
mod readings;
mod repose;
mod reproduce;
mod same;
mod scenario;
mod small;
mod soak;
mod stones;
mod studies;
mod sweep;
mod terminal;
mod verification;
mod viewer;
