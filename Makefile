# Every target installs what it needs first (scripts/setup.sh).

OUT ?= out/reproduce
ARGS ?=
# How long `make soak` and `make fuzz` go on.
MINUTES ?= 10
# How many grains `make load` pours, 10000, 50000 or 100000, and how much memory and how
# many minutes they may take.
GRAINS ?= 10000
LIMIT_MIB ?= $(if $(filter 10000,$(GRAINS)),1024,3072)
LIMIT_MINUTES ?= 90
# Builds that `make convergence` compares: double, single or 'double single'.
PRECISIONS ?= double

# Batches of `make joint`: eight points each, shaken four ways; and the folder of its tables.
BATCHES ?= 8
TABLES ?= $(OUT)/tables

# The table that `make twins` makes.
TABLE ?= docs/results/scale/twins.csv

# Runs a program of benches/programs/Cargo.toml, which uses what `make build` built.
PROGRAM = cargo run --release --locked -p pluvia-benches --bin

# For shells that were open before Rust was installed.
export PATH := $(PATH):$(HOME)/.cargo/bin

.NOTPARALLEL:
.PHONY: docs help setup setup-lint build reproduce convergence sensitivity twins joint at-rest test test-slow test-all test-exports test-sanitizers test-slurm test-snakemake soak load fuzz deny lint format bench bench-peers bench-sweep laboratory referee results deb test-deb archive wheel test-python test-wheel clean

help: ## list these targets
	@echo 'make reproduce [OUT=out/reproduce] [ARGS="--quick"], or one of:'
	@sed -n 's/^\([a-z][a-z-]*\):.*## \(.*\)/  \1\t\2/p' Makefile | expand -t 16

setup: ## install the Debian packages that are missing
	@bash scripts/setup.sh

setup-lint:
	@bash scripts/setup.sh lint

build: setup ## build target/release/pluvia
	cargo build --release --locked

reproduce: build ## run the paper's experiments, report in $(OUT)/report.html
	target/release/pluvia reproduce --out "$(OUT)" $(ARGS)

convergence: OUT = out/convergence
convergence: setup ## how results change with the engine's settings, in $(OUT)/convergence.md
	@for precision in $(PRECISIONS); do \
	    case $$precision in \
	        double) features= ;; \
	        single) features='--no-default-features --features rapier' ;; \
	        *) echo "error: PRECISIONS=$$precision, allowed are double and single" >&2; exit 2 ;; \
	    esac; \
	    folder=target; [ $$precision = double ] || folder=target/single; \
	    cargo build --release --locked $$features --target-dir $$folder && \
	    $$folder/release/pluvia converge --out "$(OUT)" $(ARGS) || exit $$?; \
	done

twins: OUT = out/twins
twins: build ## scaled twins, 64 realisations each, into $(TABLE) (docs/scale.md)
	bash scripts/twins.sh "$(OUT)" "$(TABLE)" $(ARGS)

joint: OUT = out/joint
joint: build ## which values of what the paper leaves open meet its numbers together; hours (docs/studies.md)
	bash scripts/joint.sh "$(OUT)" "$(TABLES)" $(BATCHES)

at-rest: OUT = out/at-rest
at-rest: build ## stock Bullet contacts: specimens left alone and shaken, in $(OUT)/tables (docs/results/interpretations.md)
	bash scripts/at-rest.sh "$(OUT)" $(ARGS)

sensitivity: OUT = out/sensitivity
sensitivity: build ## what each of our choices moves, in $(OUT)/sensitivity.md
	target/release/pluvia sensitivity --out "$(OUT)" $(ARGS)

test: setup ## run the tests, except the slow ones
	cargo test --locked

test-slow: setup ## run the slow tests (some twenty minutes on two cores)
	cargo test --locked -- --ignored

test-all: test test-slow ## run every test

test-exports: setup ## have VTK and the glTF validator read what `pluvia export` writes
	@bash scripts/setup.sh exports
	cargo build --locked
	bash scripts/test-exports.sh

test-sanitizers: setup ## every access to memory of the C++, looked at; some 20 minutes (docs/robustness.md)
	@bash scripts/setup.sh valgrind
	bash scripts/test-sanitizers.sh

test-slurm: setup ## send a sweep through a Slurm cluster on this machine, and kill a node
	@bash scripts/setup.sh slurm
	cargo build --locked
	bash scripts/test-slurm.sh

test-snakemake: setup ## have Snakemake run a sweep, and compare
	@bash scripts/setup.sh snakemake
	cargo build --locked
	bash scripts/test-snakemake.sh

soak: setup ## faults of every class for $(MINUTES) minutes, with counts and a log (docs/robustness.md)
	@bash scripts/setup.sh soak
	PLUVIA_SOAK=$(MINUTES) cargo test --locked --release --test it -- --exact soak::soak --nocapture

load: OUT = out/load-$(GRAINS)
load: build ## pour $(GRAINS) grains within LIMIT_MIB, LIMIT_MINUTES and the standard (docs/robustness.md)
	bash scripts/load.sh "$(GRAINS)" "$(LIMIT_MIB)" "$(LIMIT_MINUTES)" "$(OUT)" $(ARGS)

fuzz: setup ## feed readers by coverage for $(MINUTES) minutes, with counts (docs/robustness.md)
	bash scripts/fuzz.sh $(MINUTES)

deny: ## licences, sources and known weaknesses of what is linked (deny.toml)
	bash scripts/deny.sh

lint: setup-lint ## check formatting, lints and documentation
	cargo fmt --check
	cargo fmt --check --manifest-path python/Cargo.toml
	clang-format --dry-run -Werror cpp/*.h cpp/*.cpp benches/peers/*.h benches/peers/*.cpp benches/referee/*.h benches/referee/*.cpp tests/sanitizers/*.cpp
	cargo clippy --workspace --all-targets --locked -- -D warnings
	cargo clippy --workspace --all-targets --locked --no-default-features -- -D warnings
	PYO3_NO_PYTHON=1 PYO3_BUILD_EXTENSION_MODULE=1 cargo clippy --manifest-path python/Cargo.toml --target-dir target --locked -- -D warnings
	RUSTDOCFLAGS='-D warnings' cargo doc --no-deps --locked

format: setup-lint ## format all source
	cargo fmt
	cargo fmt --manifest-path python/Cargo.toml
	clang-format -i cpp/*.h cpp/*.cpp benches/peers/*.h benches/peers/*.cpp benches/referee/*.h benches/referee/*.cpp tests/sanitizers/*.cpp

docs: ## the documentation as a site, in out/site/ (MkDocs in target/mkdocs/)
	@bash scripts/setup.sh venv
	@bash scripts/docs.sh $(ARGS)

bench: setup ## what a step costs, by number of grains (out/bench.json) and by engine (ARGS=--quick; with other ARGS not by engine)
	cargo bench --locked --bench growth -- $(ARGS)
	$(if $(filter-out --quick,$(ARGS)),,cargo bench --locked --bench pour -- $(ARGS))

bench-peers: setup ## other engines on the same specimens: a table, and out/peers.json
	$(PROGRAM) peers -- $(ARGS)

referee: setup ## the contact problems solved exactly, and what engines make of them: out/referee.json
	@bash scripts/referee.sh
	$(PROGRAM) referee -- $(ARGS)

laboratory: setup ## standard tests against published numbers: out/laboratory.json (ARGS=--quick: ten minutes)
	$(PROGRAM) laboratory -- $(ARGS)

results: build ## compute what docs/results/ misses and fill the pages' numbers (ARGS="--check", --list, --only NAME, --older, --targets, --pictures)
	$(PROGRAM) results -- $(ARGS)

bench-sweep: build ## what a sweep costs beside its runs (a few minutes)
	bash scripts/sweep-overhead.sh

deb: build ## pack the program for Debian 12, in dist/ (docs/install.md)
	@bash scripts/setup.sh package
	bash scripts/package.sh deb

test-deb: deb ## install that package on a bare Debian 12 and run it; as root
	@bash scripts/setup.sh bare
	bash scripts/test-deb.sh

archive: build ## pack the program with manual pages, scenarios and docs, in dist/
	@bash scripts/setup.sh package
	bash scripts/package.sh archive

wheel: setup ## pack the Python package with Bullet inside, in dist/ (docs/python.md)
	@bash scripts/setup.sh venv
	bash scripts/wheel.sh

test-python: wheel ## install that wheel in a fresh environment, run its tests and notebooks
	bash scripts/test-python.sh $(ARGS)

test-wheel: wheel ## install that wheel on a bare Debian 12 without Bullet and run it; as root
	@bash scripts/setup.sh bare
	bash scripts/test-wheel.sh

clean: ## remove what was built; results in out/ stay
	cargo clean
