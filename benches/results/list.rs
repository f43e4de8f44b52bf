//! The one table of results: what is computed, by which command, into which files of
//! `docs/results/`; by which build the kept ones were says `builds.csv`. Pages quote these files by
//! the names in `sources.rs`; to rename a file, change it here and there.

/// A result, kept in files of `docs/results/`.
pub struct Kept {
    /// Under which `--only` finds it.
    pub name: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Files in `docs/results/`, each with where it is copied from: of commands of `pluvia` in
    /// their output folder; of a make target in the tree or, after `OUT/`, in the output folder.
    /// Empty where the target writes it by itself, or nothing makes the file from what is there.
    pub files: &'static [(&'static str, &'static str)],
    /// What computes it.
    pub made: Made,
    /// About how long it takes on two cores.
    pub takes: &'static str,
}

/// What computes a result.
pub enum Made {
    /// Commands of `pluvia`, in order. `OUT` stands for the output folder.
    Pluvia(&'static [&'static str]),
    /// A make target and its variables, as a shell reads them; `$OUT` is the output folder. It is
    /// too long for `make results` to start unasked.
    Make(&'static str),
    /// By a build that today's code cannot repeat, or put together by hand, with the command of
    /// then.
    Once(&'static str),
}

/// All results, in the order in which they are made.
pub const KEPT: &[Kept] = &[
    Kept {
        name: "quick-vibration",
        what: "The quick specimen poured from 5 cm and shaken for 2 s, ten realisations, native \
               contacts",
        files: &[("quick/vibration.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/vibration.json --configurations 10 \
                              --over engine.rate_hz=480 --out OUT"]),
        takes: "4 minutes",
    },
    Kept {
        name: "quick-stock",
        what: "The quick specimen poured and shaken likewise, three realisations, stock Bullet \
               contacts",
        files: &[("quick/stock-vibration.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/vibration.json --configurations 3 \
                              --over engine.contact_solver=\"stock\" --out OUT"]),
        takes: "4 minutes",
    },
    Kept {
        name: "grains",
        what: "The paper's grains in the virtual sieve, and their shape",
        files: &[("grains.json", "printed.json")],
        made: Made::Pluvia(&["grains scenarios/paper/pluviation.json --json --out OUT"]),
        takes: "seconds",
    },
    Kept {
        name: "verify",
        what: "Every analytical case on every engine and setting",
        files: &[("verify.csv", "verify.csv")],
        made: Made::Pluvia(&["verify --out OUT"]),
        takes: "10 minutes",
    },
    Kept {
        name: "verify-single",
        what: "The same with Bullet in single precision",
        files: &[("verify-single.csv", "")],
        made: Made::Once(
            "pluvia verify, of a program built with --no-default-features --features rapier: its \
             verify.csv",
        ),
        takes: "10 minutes",
    },
    Kept {
        name: "programme",
        what: "The paper's programme with ten realisations, 70 runs: statements, intervals and \
               tests, figures",
        files: &[
            ("claims.json", "claims.json"),
            ("scorecard.json", "scorecard.json"),
            ("uncertainty.json", "uncertainty.json"),
            ("settlement.svg", "figures/settlement.svg"),
            (
                "figure-01-grain-size-distribution.svg",
                "figures/figure-01-grain-size-distribution.svg",
            ),
            ("figure-07-standing-height.svg", "figures/figure-07-standing-height.svg"),
            ("figure-09-continuous-vibration.svg", "figures/figure-09-continuous-vibration.svg"),
            (
                "figure-10-intermittent-vibration.svg",
                "figures/figure-10-intermittent-vibration.svg",
            ),
            ("quality-creep.svg", "figures/quality-creep.svg"),
            ("quality-overlap.svg", "figures/quality-overlap.svg"),
            ("uncertainty-standing-height.svg", "figures/uncertainty-standing-height.svg"),
        ],
        made: Made::Pluvia(&["reproduce --configurations 10 --out OUT"]),
        takes: "three hours",
    },
    Kept {
        name: "placements",
        what: "The paper's specimen, ten placements of the plate on each of three realisations, \
               shaken for 5 s",
        files: &[("placements.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/paper/vibration-continuous.json \
                              --configurations 3 \
                              --over stages.2.placement=1,2,3,4,5,6,7,8,9,10 \
                              --set stages.3.duration_s=5 --set rest_test_s=1 --out OUT"]),
        takes: "an hour",
    },
    Kept {
        name: "interpretations",
        what: "The programme under four interpretations of the paper, one realisation",
        files: &[
            ("interpretations.md", ""),
            (
                "interpretations-continuous-plate.svg",
                "figures/interpretations-continuous-plate.svg",
            ),
        ],
        made: Made::Pluvia(&["interpretations --configurations 1 \
                              --only converged,per_body,full_stroke,blender_2014_cm --out OUT"]),
        takes: "half an hour",
    },
    Kept {
        name: "stock",
        what: "The paper's specimen with stock Bullet contacts, 480 steps of 20 iterations, three \
               realisations",
        files: &[("stock-contacts.csv", "")],
        made: Made::Once("pluvia reproduce --set engine.contact_solver=stock"),
        takes: "hours",
    },
    Kept {
        name: "stock-at-rest",
        what: "The paper's specimen under its plate with stock Bullet contacts, left alone for 20 s and \
               shaken for as long, three realisations, and left alone with native contacts",
        files: &[
            ("stock-at-rest.csv", "OUT/tables/stock-at-rest.csv"),
            ("stock-at-rest-series.csv", "OUT/tables/stock-at-rest-series.csv"),
            ("stock-at-rest.svg", "OUT/tables/stock-at-rest.svg"),
        ],
        made: Made::Make("at-rest"),
        takes: "an hour",
    },
    Kept {
        name: "sensitivity",
        what: "What each choice moves, on the quick specimen, five realisations",
        files: &[("sensitivity-quick.md", "")],
        made: Made::Pluvia(&["sweep --design scenarios/studies/sensitivity.json --quick \
                              --configurations 5 --out OUT"]),
        takes: "a quarter of an hour",
    },
    Kept {
        name: "convergence",
        what: "Heights and settlements of ever finer settings, the paper's specimen, three \
               realisations",
        files: &[
            ("convergence/convergence-height.svg", "figures/convergence-height.svg"),
            (
                "convergence/convergence-plate-settlement.svg",
                "figures/convergence-plate-settlement.svg",
            ),
            (
                "convergence/convergence-surface-settlement.svg",
                "figures/convergence-surface-settlement.svg",
            ),
        ],
        made: Made::Pluvia(&["converge --out OUT"]),
        takes: "several hours",
    },
    Kept {
        name: "calibration",
        what: "The friction coefficient that gives piles of 364 grains an angle of repose of 38.40°",
        files: &[
            ("calibration/calibrate.json", "calibrate.json"),
            ("calibration/evaluations.csv", "evaluations.csv"),
            ("calibration/angle.svg", "figures/calibration.svg"),
        ],
        made: Made::Pluvia(&["calibrate scenarios/quick/repose.json --angle-of-repose 38.4 \
                              --out OUT"]),
        takes: "a quarter of an hour",
    },
    Kept {
        name: "calibrated-continuous",
        what: "The paper's continuous vibration with the calibrated coefficient, three realisations",
        files: &[("calibration/continuous.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/paper/vibration-continuous.json \
                              --configurations 3 \
                              --over contact.grain_grain_friction=0.348 --out OUT"]),
        takes: "half an hour",
    },
    Kept {
        name: "native",
        what: "Pours of the quick specimen by friction and restitution, 20 realisations, native \
               contacts",
        files: &[("engines/native.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/pluviation.json --configurations 20 \
                              --over contact.grain_grain_friction=0,0.793 \
                              --over contact.restitution=0,0.315 --out OUT"]),
        takes: "15 minutes",
    },
    Kept {
        name: "rapier",
        what: "The same pours by rapier, with both of its models of friction",
        files: &[("engines/rapier.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/pluviation.json --configurations 20 \
                              --backend rapier \
                              --over engine.rapier.friction_model=\"simplified\",\"coulomb\" \
                              --over contact.grain_grain_friction=0,0.793 \
                              --over contact.restitution=0,0.315 --out OUT"]),
        takes: "half an hour",
    },
    Kept {
        name: "high-friction",
        what: "Pours of the quick specimen with friction that grains hardly have, five realisations, \
               native contacts",
        files: &[("engines/high-friction.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/pluviation.json --configurations 5 \
                              --over contact.grain_grain_friction=1,1.5,2,3 --out OUT"]),
        takes: "4 minutes",
    },
    Kept {
        name: "native-eight",
        what: "The same pours with eight iterations in each sub-step",
        files: &[("engines/native-eight-iterations.csv", "")],
        made: Made::Once("as `native`"),
        takes: "",
    },
    Kept {
        name: "native-older",
        what: "The same pours with friction under an older rule of restitution",
        files: &[("engines/native-older-restitution.csv", "")],
        made: Made::Once("as `native`"),
        takes: "",
    },
    Kept {
        name: "native-middle",
        what: "The same pours with friction, which acts in the middle of a pair's contact points and \
               does not resist twisting",
        files: &[("engines/native-friction-in-the-middle.csv", "")],
        made: Made::Once("as `native`, with a solver changed for it"),
        takes: "",
    },
    Kept {
        name: "native-convergence",
        what: "Pours of the quick specimen, one setting of the solver changed at a time, 12 \
               realisations",
        files: &[("engines/native-convergence.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/pluviation.json --one-at-a-time \
                              --configurations 12 \
                              --over engine.native.iterations=4,16,40 \
                              --over engine.native.substep_rate_hz=960,2880 \
                              --over engine.rate_hz=240,960 \
                              --over engine.native.contact_stiffness_n_per_m=5000,20000 \
                              --out OUT"]),
        takes: "20 minutes",
    },
    Kept {
        name: "native-settlement",
        what: "The quick specimen poured and shaken, one setting of the solver changed at a time, \
               twelve realisations",
        files: &[("engines/native-settlement.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/quick/vibration.json --one-at-a-time \
                              --configurations 12 \
                              --over engine.native.solver_tolerance=1,0.05,0.0005 \
                              --over engine.native.substep_rate_hz=960,2880 \
                              --over engine.rate_hz=240,960 \
                              --over engine.native.contact_stiffness_n_per_m=5000,20000 \
                              --out OUT"]),
        takes: "half an hour",
    },
    Kept {
        name: "shaken",
        what: "The paper's specimen under its plate, shaken for 5 s with the solver's iterations repeated \
               to a tolerance and counted, eight specimens",
        files: &[("engines/shaken-tolerance.csv", "shaken/sweep.csv")],
        made: Made::Pluvia(&[
            "sweep scenarios/studies/settings/specimen.json --configurations 8 --out OUT/specimens",
            "sweep scenarios/studies/settings/shaken.json \
             --over engine.native.solver_tolerance=0.002,1 \
             --over begin.specimen=OUT/specimens/runs/point-0001-c1,\
             OUT/specimens/runs/point-0001-c2,OUT/specimens/runs/point-0001-c3,\
             OUT/specimens/runs/point-0001-c4,OUT/specimens/runs/point-0001-c5,\
             OUT/specimens/runs/point-0001-c6,OUT/specimens/runs/point-0001-c7,\
             OUT/specimens/runs/point-0001-c8 --out OUT/shaken",
        ]),
        takes: "20 minutes",
    },
    Kept {
        name: "handed-over",
        what: "Quick specimens poured by one engine and shaken by another, eight realisations",
        files: &[("engines/handed-over.csv", "")],
        made: Made::Once(
            "pluvia compare scenarios/quick/vibration.json, once for each realisation (1 and 3 to \
             9: the funnel of the second jams) and order of engines",
        ),
        takes: "",
    },
    Kept {
        name: "rounding",
        what: "Pours of the quick specimen over the roundness of its grains, three realisations",
        files: &[("shape/rounding.csv", "sweep.csv")],
        made: Made::Pluvia(&["sweep scenarios/rounded/rounded-gravel.json --configurations 3 \
                              --over grains.cells.rounding=0,0.15,0.3,0.6 --out OUT"]),
        takes: "3 minutes",
    },
    Kept {
        name: "sizes",
        what: "Sand, the paper's gravel and ballast poured with nothing typed but grains and stages, \
               three seeds",
        files: &[
            ("scale/sand.csv", "sand/sweep.csv"),
            ("scale/gravel.csv", "gravel/sweep.csv"),
            ("scale/ballast.csv", "ballast/sweep.csv"),
        ],
        made: Made::Pluvia(&[
            "sweep scenarios/scale/sand.json --over seed=1,2,3 --out OUT/sand",
            "sweep scenarios/paper/pluviation.json --over seed=1,2,3 --out OUT/gravel",
            "sweep scenarios/scale/ballast.json --over seed=1,2,3 --out OUT/ballast",
        ]),
        takes: "10 minutes",
    },
    Kept {
        name: "twins",
        what: "The quick specimen 0.1, 1 and 5 times as large, 64 realisations",
        files: &[("scale/twins.csv", "OUT/twins.csv")],
        made: Made::Make("twins TABLE=\"$OUT/twins.csv\""),
        takes: "half an hour",
    },
    Kept {
        name: "under-load",
        what: "A specimen of 494 grains under 200 kPa, its load held for 0.3 s with four rates of \
               sub-steps",
        files: &[("under-load.csv", "")],
        made: Made::Once(
            "scenarios/validation/oedometer.json to 200 kPa with 1440 sub-steps per second, \
             realisation 2; begun with this, a rest of 0.3 s with 8 iterations and \
             --set engine.native.substep_rate_hz=1440, 2880, 5760, 11520",
        ),
        takes: "",
    },
    Kept {
        name: "tall",
        what: "1456 grains that stand 42 layers high, at rest for 3 s with five numbers of iterations",
        files: &[("tall.csv", "")],
        made: Made::Once(
            "scenarios/validation/tall-column.json with --set engine.native.iterations=8; begun with \
             its stage pour, its rests with --set engine.native.iterations=8, 12, 16, 24, 40",
        ),
        takes: "",
    },
    Kept {
        name: "load",
        what: "10 000 grains poured and left alone, on the default settings",
        files: &[("load.csv", "")],
        made: Made::Once("make load GRAINS=10000"),
        takes: "",
    },
    Kept {
        name: "laboratory",
        what: "Standard tests of granular material against published numbers",
        files: &[
            ("laboratory.json", ""),
            ("laboratory/hopper.svg", ""),
            ("laboratory/hopper-spheres.svg", ""),
            ("laboratory/column.svg", ""),
            ("laboratory/repose.svg", ""),
            ("laboratory/direct-shear.svg", ""),
            ("laboratory/direct-shear-profile.svg", ""),
            ("laboratory/beads.svg", ""),
            ("laboratory/oedometer.svg", ""),
            ("laboratory/density.svg", ""),
            ("laboratory/density-vibration.svg", ""),
            ("laboratory/triaxial.svg", ""),
            ("laboratory/triaxial-path.svg", ""),
        ],
        made: Made::Make("laboratory ARGS=\"--small --keep\""),
        takes: "hours, without --small many",
    },
    Kept {
        name: "joint",
        what: "What the paper's text leaves open, varied together at full size: sweeps, and which \
               runs meet its four numbers",
        files: &[
            ("joint/pile-1.csv", "OUT/tables/pile-1.csv"),
            ("joint/continuous-1.csv", "OUT/tables/continuous-1.csv"),
            ("joint/intermittent-1.csv", "OUT/tables/intermittent-1.csv"),
            ("joint/builds.csv", "OUT/tables/builds.csv"),
            ("joint/targets.json", "OUT/tables/targets.json"),
        ],
        made: Made::Make("joint BATCHES=1 TABLES=\"$OUT/tables\""),
        takes: "an hour or two",
    },
    Kept {
        name: "bench",
        what: "What a step costs by number of grains, state and threads",
        files: &[("bench.json", "out/bench.json")],
        made: Made::Make("bench ARGS=\"--quick --most-grains 1500 --states rest,shaken,pour\""),
        takes: "ten minutes",
    },
    Kept {
        name: "peers",
        what: "Other engines on the same specimens",
        files: &[("peers.json", "out/peers.json")],
        made: Made::Make("bench-peers"),
        takes: "an hour or two",
    },
    Kept {
        name: "referee",
        what: "Sub-steps and specimens of 364 grains beside an exact solution of their contact problems",
        files: &[("referee.json", "out/referee.json")],
        made: Made::Make("referee ARGS=\"--only one-step,static --specimens quick\""),
        takes: "half an hour",
    },
    Kept {
        name: "referee-frictionless",
        what: "Pours of 30 grains without friction and restitution by the referee and each engine, \
               770 seeds",
        files: &[("referee-frictionless.json", "OUT/referee-frictionless.json")],
        made: Made::Make(
            "referee ARGS=\"--only pours --restitution 0 --friction 0 --pours 770 --out \
             $OUT/referee-frictionless.json\"",
        ),
        takes: "one to two hours",
    },
    Kept {
        name: "referee-pours",
        what: "Pours of 30 grains by the native solver, rapier, stock Bullet and the referee, 40 \
               seeds of each kind",
        files: &[("referee-pours.csv", "")],
        made: Made::Once(
            "parts of `make referee ARGS=\"--only pours --pours 40\"`, put together by hand",
        ),
        takes: "hours",
    },
    Kept {
        name: "robustness",
        what: "Faults of every class, and what became of them",
        files: &[("robustness.json", "")],
        made: Made::Make("soak && bash scripts/robustness.sh"),
        takes: "as long as one likes",
    },
];

/// Files of `docs/results/` that hold no result.
pub const OTHERS: &[(&str, &str)] = &[
    ("README.md", "says what each file is"),
    ("builds.csv", "which build made each result; `make results` writes it"),
    ("laboratory.md", "the page of the standard tests"),
    ("unmarked.csv", "where pages may quote numbers without a mark, and why"),
];

/// The folder of all result files.
pub const FOLDER: &str = "docs/results";

/// Where the pages are: Markdown files of these, and of folders in them.
pub const PAGES: &[&str] = &["README.md", "docs"];

/// Pages that a command of the tree prints as they are; they are compared by other tests.
pub const PRINTED: &[&str] = &["docs/scenario.md", "docs/commands.md"];
