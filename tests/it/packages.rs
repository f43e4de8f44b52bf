//! `scripts/package.sh` says what the archive needs where it is made, not on one system alone.

use std::{fs, process::Command};

use super::program::{root, script};

/// What the archive says of its installation where the system has these names.
fn installation(os_release: &str, bullet: &str, package: &str) -> String {
    let folder = tempfile::tempdir().expect("a folder");
    let at = |name: &str| folder.path().join(name);
    fs::write(at("os-release"), os_release).expect("written");
    let library = at("libBulletX.so");
    fs::write(&library, "").expect("written");
    let version = env!("CARGO_PKG_VERSION");
    script(
        &at("pluvia"),
        &format!(
            "#!/bin/sh\n[ \"$1\" = --version ] && exec echo pluvia {version}\n\
             echo 'backend   bullet {bullet} precision'\necho 'backend   rapier 0, double precision'\n"
        ),
    );
    let listed = format!("  libBulletX.so => {} (0x7f)", library.display());
    script(&at("ldd"), &format!("#!/bin/sh\necho '{listed}'\n"));
    script(&at("dpkg-query"), &format!("#!/bin/sh\necho \"{package}:amd64: $2\"\n"));
    let path = std::env::var("PATH").expect("a path");
    let output = Command::new("bash")
        .current_dir(root())
        .args(["scripts/package.sh", "install"])
        .env("PLUVIA", at("pluvia"))
        .env("OS_RELEASE", at("os-release"))
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .output()
        .expect("bash");
    let said = [output.stdout, output.stderr].map(|s| String::from_utf8_lossy(&s).into_owned());
    said.concat()
}

/// Law: the archive names the system that it was made on, its Bullet and the package that has it.
#[test]
fn an_archive_names_the_system_it_was_made_on() {
    for (os_release, bullet, package, expected) in [
        (
            "NAME=\"Debian GNU/Linux\"\nVERSION_ID=\"12\"\n",
            "3.24, double",
            "libbullet3.24",
            "Built on Debian 12 for Bullet 3.24 in double precision. Install that first:\n\n    \
             apt-get install libbullet3.24\n\nthen run ./pluvia",
        ),
        (
            "NAME=\"Ubuntu\"\nVERSION_ID=\"24.04\"\n",
            "3.30, single",
            "libbullet3.30t64",
            "Built on Ubuntu 24.04 for Bullet 3.30 in single precision. Install that first:\n\n    \
             apt-get install libbullet3.30t64\n\nthen run ./pluvia",
        ),
    ] {
        let got = installation(os_release, bullet, package);
        assert!(got.starts_with(expected), "law: expected {expected:?}, got {got:?}");
    }
}
