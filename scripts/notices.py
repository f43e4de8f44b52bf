#!/usr/bin/env python3
"""Writes the copyright notices and licences of the crates that are linked into Pluvia.

    scripts/notices.py MANIFEST OUT    MANIFEST is Cargo.toml or python/Cargo.toml

Crates are those that a release build for this system links: no build or dev dependencies, but procedural
macros, whose code ends in the program. A crate without a licence file has that of its repository, or the
standard text of Apache-2.0 or MIT. Rust's standard library has the notices that rustc comes with.
"""

import html, json, os, re, subprocess, sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LICENCE, NOTICE = re.compile(r"(un)?licen[sc]e|copying", re.I), re.compile(r"copyright|notice|authors", re.I)
NOT_TEXT = {".rs", ".toml", ".yml", ".yaml", ".json", ".py", ".sh"}
ASIDE = {".github", "benches", "examples", "fuzz", "tests"}


def fail(sentence, command):
    sys.exit(f"error: {sentence}. Try: {command}")


def output(variable, *words):
    program = os.environ.get(variable, variable.lower())
    ran = subprocess.run([program, *words], stdout=subprocess.PIPE, env={**os.environ, "CARGO_TERM_COLOR": "never"})
    if ran.returncode:
        fail(f"{variable.lower()} {words[0]} failed (its message is above)", "cargo fetch --locked")
    return ran.stdout.decode()


def read(path):
    try:
        return path.read_text("utf-8-sig", "replace")
    except OSError as error:
        fail(f"{path} cannot be read: {error.strerror}", "rustup update stable")


def linked(manifest, host):
    """What cargo metadata says of the linked crates."""
    common = ("--locked", "--manifest-path", manifest)
    metadata = json.loads(output("CARGO", "metadata", "--format-version", "1", "--filter-platform", host, *common))
    # Its graph holds features that only tests switch on; that of cargo tree does not.
    tree = ("tree", "--prefix", "none", "--format", "{p}", "--target", host, *common, "--edges")
    lines = output("CARGO", *tree, "normal,no-proc-macro").splitlines()
    lines += [line for line in output("CARGO", *tree, "normal").splitlines() if "(proc-macro)" in line]
    named = {tuple(line.split()[:2]) for line in lines if line}
    members = metadata["workspace_members"]
    ours = lambda crate: crate["id"] in members or Path(crate["manifest_path"]).resolve().parent == ROOT
    found = [crate for crate in metadata["packages"] if (crate["name"], "v" + crate["version"]) in named]
    return sorted((crate for crate in found if not ours(crate)), key=lambda crate: (crate["name"], crate["version"]))


def files(package):
    """The texts of its licence files, and those of its other notices."""
    folder = Path(package["manifest_path"]).parent
    paths = [path for path in sorted(folder.rglob("*")) if path.is_file() and path.suffix not in NOT_TEXT]
    paths = [path for path in paths if path.relative_to(folder).parts[0] not in ASIDE]
    stated = folder / (package["license_file"] or "LICENSE")
    licences = [path for path in paths if path == stated or LICENCE.match(path.name) or path.parent.name == "LICENSES"]
    notices = [path for path in paths if path not in licences and NOTICE.match(path.name)]
    # A link may be packed as a file with its path, and words as "MIT OR Apache-2.0" are no licence.
    licences = [text for text in map(read, licences) if " " in text.strip()]
    return licences if any(len(text) > 300 for text in licences) else [], [read(path) for path in notices]


def standard_text(package):
    """The text of a licence that the crate may be used under: the one whose text names no owner, if it may."""
    allowed = re.split(r" OR |/", package["license"] or "no licence")
    if "Apache-2.0" in allowed:
        return read(ROOT / "LICENSE-APACHE")
    if "MIT" in allowed:
        owners = ", ".join(package["authors"]) or f"the authors of {package['name']}"
        return re.sub(r"(?m)^Copyright .*$", lambda _: f"Copyright (c) {owners}", read(ROOT / "LICENSE-MIT"))
    of = f"{package['name']} {package['version']} ({package['license'] or 'no licence'})"
    fail(f"crate {of} has no licence file, and its text is not known", f"cargo tree --invert {package['name']}")


def standard_library(host):
    """The crates of which Rust's standard library is made, and their texts."""
    root = Path(output("RUSTC", "--print", "sysroot").strip())
    folder = root / "share/doc/rust"
    own = read(folder / "COPYRIGHT-library.html").partition('id="in-tree-files">')[2].partition("<h2")[0]
    texts = ["Rust's standard library\n" + re.sub(r"\n\s*", "\n", re.sub(r"<[^>]*>", "", own))]
    texts += [read(folder / f"licenses/{name}.txt") for name in ("Apache-2.0", "MIT", "Unicode-3.0")]
    libraries = {path.name[3:].rpartition("-")[0] for path in (root / f"lib/rustlib/{host}/lib").glob("lib*.rlib")}
    sections = read(folder / "COPYRIGHT.html").split("<h3>📦 ")[1:]
    named = [(re.split(r"-\d", section)[0], section) for section in sections]
    named = [(name, section) for name, section in named if name.replace("-", "_") in libraries]
    if not own or not named:
        fail(f"the notices in {folder} are of another form than scripts/notices.py knows", "rustup update stable")
    texts += re.findall(r"<pre>(.*?)</pre>", "".join(section for _, section in named), re.S)
    return sorted({name for name, _ in named}), [html.unescape(text) for text in texts]


def main(manifest, out):
    host = re.search(r"^host: (\S+)$", output("RUSTC", "-vV"), re.M)[1]
    found = [(package, *files(package)) for package in linked(manifest, host)]
    of_repository = {(package["repository"], package["license"]): texts for package, texts, _ in found if texts}
    entries = []
    for package, licences, notices in found:
        licences = licences or of_repository.get((package["repository"] or "?", package["license"]))
        title = f"{package['name']} {package['version']} | {package['license'] or 'see its text'}"
        entries.append((title, (licences or [standard_text(package)]) + notices))
    within, texts = standard_library(host)
    title = f"std {output('RUSTC', '--version').split()[1]} with {', '.join(within)}"
    entries.append((f"{title} | MIT OR Apache-2.0, and others", texts))

    # Texts of the same words are one.
    texts, lines = {}, []
    for title, of_entry in entries:
        of_entry = {tuple(text.split()): text for text in of_entry}
        for words, text in of_entry.items():
            text = "\n".join(line.rstrip() for line in text.splitlines()).strip("\n")
            texts.setdefault(words, (len(texts) + 1, text))
        lines.append(f"{title} | {' '.join(map(str, sorted(texts[words][0] for words in of_entry)))}")
    head = "Pluvia contains code of these crates and of Rust's standard library: name | licence | its texts below\n"
    parts = [f"{'=' * 20} Text {number} {'=' * 20}\n\n{text}\n" for number, text in texts.values()]
    Path(out).write_text("\n".join([head, *lines, "", *parts]), "utf-8")


main(*sys.argv[1:])
