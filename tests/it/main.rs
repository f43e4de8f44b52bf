//! Tests of the crate as a whole: its source, its documents, its files.

mod architecture;
mod cli;
mod collision;
mod compare;
mod docs;
mod export;
mod interruption;
mod picture;
mod readings;
mod scenario;
mod small;
mod studies;
mod verification;
