//! Pictures of the pages, and the commands that draw them.

const SHAKEN: &str = "scenarios/paper/vibration-continuous.json";
const PILE: &str = "scenarios/paper/repose.json";

/// A picture of `docs/pictures/`, the scenario whose run it shows and the command that draws it,
/// as `docs/gallery.md` has it. `RUN` stands for the folder of the run.
pub const PICTURES: &[(&str, &str, &str)] = &[
    ("grains.png", SHAKEN, "picture RUN --grains --width 1200 --out PICTURE"),
    (
        "funnel.png",
        SHAKEN,
        "picture RUN --stage fill_funnel --cylinder cut --width 900 --out PICTURE",
    ),
    ("pour.png", SHAKEN, "picture RUN --stage pour --width 320 --animate PICTURE"),
    ("pouring.png", SHAKEN, "picture RUN --stage pour --time 0.9 --width 900 --out PICTURE"),
    (
        "displacement.png",
        SHAKEN,
        "picture RUN --stage vibrate --colour-by displacement --cylinder cut --width 900 \
         --out PICTURE",
    ),
    ("specimen-cut-away.png", SHAKEN, "picture RUN --cylinder cut --width 900 --out PICTURE"),
    ("pile-on-its-base.png", PILE, "picture RUN --width 900 --out PICTURE"),
    (
        "laboratory-box.png",
        "scenarios/laboratory/box-two-layers.json",
        "picture RUN --cylinder cut --width 900 --out PICTURE",
    ),
    (
        "laboratory-hopper.png",
        "scenarios/laboratory/hopper.json",
        "picture RUN --stage remove --time 3.1 --width 900 --out PICTURE",
    ),
    (
        "laboratory-tilt.png",
        "scenarios/laboratory/tilting-box.json",
        "picture RUN --stage move --time 8.4 --width 900 --out PICTURE",
    ),
    (
        "laboratory-drum.png",
        "scenarios/laboratory/rotating-drum.json",
        "picture RUN --stage move --time 8 --colour-by speed --width 900 --out PICTURE",
    ),
    (
        "laboratory-column.png",
        "scenarios/laboratory/column-collapse.json",
        "picture RUN --width 900 --out PICTURE",
    ),
    (
        "laboratory-vertical.png",
        "scenarios/laboratory/vertical-vibration.json",
        "picture RUN --stage move --colour-by displacement --cylinder cut \
         --width 900 --out PICTURE",
    ),
    (
        "laboratory-load.png",
        "scenarios/laboratory/vibration-under-load.json",
        "picture RUN --stage 3 --colour-by displacement --cylinder cut --width 900 --out PICTURE",
    ),
    (
        "laboratory-oedometer.png",
        "scenarios/laboratory/oedometer.json",
        "picture RUN --cylinder cut --width 900 --out PICTURE",
    ),
    (
        "laboratory-shear.png",
        "scenarios/laboratory/direct-shear.json",
        "picture RUN --cylinder cut --width 900 --out PICTURE",
    ),
    (
        "laboratory-footing.png",
        "scenarios/laboratory/footing.json",
        "picture RUN --cylinder cut --width 900 --out PICTURE",
    ),
    (
        "laboratory-vane.png",
        "scenarios/laboratory/vane.json",
        "picture RUN --cylinder cut --colour-by displacement --width 900 --out PICTURE",
    ),
];
