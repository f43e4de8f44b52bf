//! Finds Debian's Bullet, compiles the shims in `cpp/` against it, and lets
//! bindgen read Bullet's constants, so that none is retyped.
//!
//! Everything that can be missing fails with one sentence and one command.

use std::{env, path::PathBuf, process::exit};

/// Bullet versions the shims are known to work with: from, up to but not including.
const BULLET_VERSIONS: (&str, &str) = ("3.24", "3.26");

/// The sources of `cpp/`. Each has a header of its name, but for `sphere_pair` and `rounded_pair`,
/// whose functions `hull_pair.h` declares.
const SHIMS: [&str; 27] = [
    "contact_bodies",
    "contact_colours",
    "contact_memory",
    "contact_solver",
    "crowd",
    "globals",
    "hull_data",
    "hull_axis",
    "hull_beside",
    "hull_bodies",
    "hull_clip",
    "hull_memory",
    "hull_pair",
    "hull_passing",
    "hull_algorithm",
    "hull_search",
    "workers",
    "probe",
    "shapes",
    "sphere_pair",
    "core_distance",
    "rounded_pair",
    "bodies",
    "stock_world",
    "native_world",
    "pool",
    "world",
];

/// Sanitizers to compile the shims with, as `scripts/test-sanitizers.sh` does:
/// `address,undefined`, or `thread`.
const SANITIZE: &str = "PLUVIA_SANITIZE";

fn main() {
    println!("cargo::rerun-if-changed=cpp");
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-env-changed={SANITIZE}");

    let bullet = find_bullet();
    compile_shims(&bullet);
    read_constants(&bullet);
}

fn find_bullet() -> pkg_config::Library {
    let double = env::var_os("CARGO_FEATURE_DOUBLE_PRECISION").is_some();
    let name = if double { "bullet-float64" } else { "bullet" };
    let (from, below) = BULLET_VERSIONS;
    match pkg_config::Config::new().range_version(from..below).probe(name) {
        Ok(library) => library,
        Err(pkg_config::Error::Command { .. } | pkg_config::Error::EnvNoPkgConfig(_)) => fail(
            "the program pkg-config, which finds the Bullet library, is not installed",
            "sudo apt-get install pkg-config",
        ),
        Err(error) => fail(
            &format!(
                "the Bullet physics library ({name}, version {from} up to but not including \
                 {below}) was not found: {}",
                error.to_string().lines().next().unwrap_or_default()
            ),
            "sudo apt-get install libbullet-dev",
        ),
    }
}

fn compile_shims(bullet: &pkg_config::Library) {
    let mut build = cxx_build::bridge("src/world/bullet/ffi.rs");
    if let Err(error) = build.try_get_compiler() {
        fail(&format!("no C++ compiler works here: {error}"), "sudo apt-get install g++");
    }
    // -isystem: warnings in Bullet's own headers are not ours to fix. The
    // compiler's own system folder must not be named again: that would change
    // its place in the order and hide the C headers from the C++ ones.
    for path in bullet.include_paths.iter().filter(|p| !p.ends_with("usr/include")) {
        build.flag("-isystem").flag(path);
    }
    for (define, value) in &bullet.defines {
        build.define(define, value.as_deref());
    }
    build
        .files(SHIMS.map(|shim| format!("cpp/{shim}.cpp")))
        .std("c++17")
        // The simulation is the same in every Cargo profile, tests included.
        .opt_level(2)
        // a*b+c must not be fused differently from machine to machine.
        .flag("-ffp-contract=off")
        .flag("-fno-math-errno")
        // Vectors of eight stay inside one source file: those of cpp/hull_axis.cpp, and those of
        // cpp/lanes.h in cpp/contact_solver.cpp.
        .flag("-Wno-psabi")
        .warnings(true)
        .extra_warnings(true);
    sanitize(&mut build);
    if let Err(error) = build.try_compile("pluvia_shims") {
        fail(&format!("the C++ shims did not compile: {error}"), "make lint");
    }
}

/// Compiles what was asked for into the shims. A finding ends the program.
fn sanitize(build: &mut cc::Build) {
    let asked = env::var(SANITIZE).unwrap_or_default();
    let asked: Vec<&str> = asked.split(',').filter(|name| !name.is_empty()).collect();
    if asked.is_empty() {
        return;
    }
    if let Some(unknown) = asked.iter().find(|n| !["address", "undefined", "thread"].contains(n)) {
        fail(
            &format!("{SANITIZE} names `{unknown}`; it may name address, undefined and thread"),
            &format!("unset {SANITIZE}"),
        );
    }
    build
        .flag(format!("-fsanitize={}", asked.join(",")))
        .flag("-fno-sanitize-recover=all")
        .flag("-fno-omit-frame-pointer")
        .flag("-g")
        // With every access checked, more takes minutes for one file of lanes.
        .opt_level(1);
    if asked.contains(&"undefined") {
        // Not in -fsanitize=undefined: numbers too large for what they are turned into.
        build.flag("-fsanitize=float-cast-overflow");
        // Needs the type information of Bullet's classes, and the C++ runtime of
        // the sanitizer, which the one that comes with Rust has not.
        build.flag("-fno-sanitize=vptr");
    }
    // With Rust's own -Zsanitizer=address its runtime is linked already.
    let rust = env::var("CARGO_CFG_SANITIZE").unwrap_or_default();
    if asked.contains(&"thread") && !rust.contains("thread") {
        println!("cargo::rustc-link-lib=dylib=tsan");
    }
    if asked.contains(&"address") && !rust.contains("address") {
        println!("cargo::rustc-link-lib=dylib=asan");
        println!("cargo::rustc-link-lib=dylib=ubsan");
    }
}

fn read_constants(bullet: &pkg_config::Library) {
    let mut builder = bindgen::Builder::default()
        .header("cpp/constants.h")
        .clang_args(["-x", "c++", "-std=c++17"])
        .allowlist_var("PLUVIA_.*")
        .allowlist_type("btSolverMode")
        .prepend_enum_name(false);
    for path in &bullet.include_paths {
        builder = builder.clang_arg(format!("-I{}", path.display()));
    }
    for (define, value) in &bullet.defines {
        builder = builder.clang_arg(match value {
            Some(value) => format!("-D{define}={value}"),
            None => format!("-D{define}"),
        });
    }
    // bindgen panics when it cannot load libclang.
    let quiet = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let generated = std::panic::catch_unwind(std::panic::AssertUnwindSafe(|| builder.generate()));
    std::panic::set_hook(quiet);
    let bindings = match generated {
        Ok(Ok(bindings)) => bindings,
        Ok(Err(error)) => fail(
            &format!("bindgen could not read Bullet's headers: {error}"),
            "sudo apt-get install libbullet-dev libclang-dev",
        ),
        Err(_) => fail(
            "libclang, with which bindgen reads Bullet's headers, was not found",
            "sudo apt-get install libclang-dev",
        ),
    };
    let out = PathBuf::from(env::var("OUT_DIR").expect("cargo sets OUT_DIR"));
    if let Err(error) = bindings.write_to_file(out.join("constants.rs")) {
        fail(&format!("cannot write constants.rs: {error}"), "cargo clean");
    }
}

/// Ends the build with one sentence and one command.
fn fail(sentence: &str, command: &str) -> ! {
    println!("cargo::error={sentence}. Try: {command}");
    exit(1)
}
