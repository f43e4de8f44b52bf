//! Uses every function of the bridge to the C++ shims, with both contact solvers,
//! soundly and not. The program that looks at it says whether C++ did right;
//! this one only says how much of it there was.
//!
//! `all` one after the other; `threads` two worlds in two threads and worlds
//! with several workers; `leak N` makes and drops N worlds.

#[path = "world/bullet/ffi.rs"]
mod bridge;
mod errors;
mod worlds;

use bridge::*;

/// What a process holds in memory, in KiB.
fn resident() -> i64 {
    let status = std::fs::read_to_string("/proc/self/status").expect("Linux tells");
    let line = status.lines().find(|l| l.starts_with("VmRSS:")).expect("resident memory");
    line.split_whitespace().nth(1).and_then(|n| n.parse().ok()).expect("a number of KiB")
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        ["all"] => {
            println!("{} failures in C++ came back as errors", errors::all());
            println!("{} contact points of probed pairs", worlds::probes());
            println!("{} speeds of crowds", worlds::speeds());
            println!("{} steps of worlds", worlds::all());
            assert!(bytes_handed_out() >= -1, "law: a number of bytes, or that there is none");
        }
        ["threads"] => {
            println!("{} failures in threads came back as errors", errors::in_threads());
            println!("{} steps of worlds in several threads", worlds::in_threads());
        }
        ["leak", number] => {
            let number: usize = number.parse().expect("a number of worlds");
            for made in 1..=number {
                let kind = worlds::KINDS[made % worlds::KINDS.len()];
                worlds::one(kind, 12, 12);
                if made % 100 == 0 {
                    println!("{made} worlds: {} KiB", resident());
                }
            }
        }
        _ => panic!("all, threads, or leak and a number"),
    }
}
