//! Sizes, sieve tables and numbers that no apparatus and no gravel can have.

use pluvia::grains::ParticleSizeDistribution;
use pluvia::scenario::GrainsSpec;
use serde_json::{Value, json};

use super::{assert_holds, expect_at, expect_one, faults, load_text, place, sound};

#[test]
fn impossible_sizes_are_refused() {
    let height = "apparatus.cylinder.height_mm";
    expect_at(height, json!(-200), &["out of range", "found -200", "above 0"]);
    expect_at("grains.total_mass_g", json!(0), &["out of range", "found 0", "above 0"]);
    expect_at("grains.density_kg_per_m3", json!(-2650), &["out of range"]);
    expect_at("gravity_m_per_s2", json!(0), &["out of range", "above 0"]);
    expect_at("engine.length_scale", json!(1e6), &["out of range", "10000"]);
}

/// Law: samples are a step of the engine apart or more, and close enough for the rests whose numerical
/// creep is read off them.
#[test]
fn intervals_of_samples_are_bounded() {
    for outside in [0.0, -1.0, 10.1] {
        let words = ["out of range", "a number above 0 and at most 10"];
        expect_at("sample_interval_s", json!(outside), &words);
    }
    let words = ["more samples than steps", "one step of the engine"];
    expect_at("sample_interval_s", json!(1e-5), &words);
    let words = ["too few samples in a rest of 2 s (rest_test_s)", "at most 0.5 s"];
    expect_at("sample_interval_s", json!(0.6), &words);
    let mut coarse = sound();
    coarse["rest_test_s"] = json!(40);
    for (rest, at_fault) in [(40.0, 0), (8.0, 1)] {
        let stages = json!([{ "stage": "fill_funnel" }, { "stage": "rest", "duration_s": rest }]);
        coarse["stages"] = stages;
        coarse["sample_interval_s"] = json!(10);
        let found = faults(&coarse);
        assert_eq!(found.len(), at_fault, "law: a quarter of a rest of {rest} s, got {found:#?}");
    }
}

#[test]
fn sieve_tables_that_make_no_sense_are_refused() {
    let passing = "grains.sieve_table[1].passing_mm";
    expect_one(
        |s| s["grains"]["sieve_table"].as_array_mut().expect("a list").reverse(),
        passing,
        &["out of order", "from coarse to fine"],
    );
    expect_at(passing, json!(10), &["gap", "found 10", "allowed: 11.2", "or a fraction of 0 %"]);
    expect_at(passing, json!(12), &["overlap"]);
    expect_at("grains.sieve_table[1].retained_mm", json!(11.2), &["less than passing_mm"]);
    let less = |s: &mut Value| s["grains"]["sieve_table"][1]["mass_percent"] = json!(39.98);
    expect_one(less, "grains.sieve_table", &["do not add up", "99.98", "100 ± 0.01"]);
    expect_at("grains.sieve_table", json!([]), &["too short"]);
    let mut within = sound();
    within["grains"]["sieve_table"][1]["mass_percent"] = json!(39.99);
    assert_eq!(faults(&within), [], "a sum of 99.99 is within the tolerance");
}

/// Law: a gap-graded soil is one with fractions of 0 %; values follow from the fractions that have
/// grains, and a deposit asks for one of these.
#[test]
fn a_fraction_may_be_without_grains() {
    let fraction = |passing_mm: f64, retained_mm: f64, mass_percent: f64| {
        json!({ "passing_mm": passing_mm, "retained_mm": retained_mm,
            "mass_percent": mass_percent })
    };
    let with = |table: Value| {
        let mut value = sound();
        value["grains"]["sieve_table"] = table;
        value
    };
    let gapped = with(json!([
        fraction(31.5, 16.0, 0.0),
        fraction(16.0, 12.5, 40.0),
        fraction(12.5, 10.0, 0.0),
        fraction(10.0, 8.0, 60.0),
        fraction(8.0, 1.0, 0.0)
    ]));
    assert_eq!(faults(&gapped), [], "law: a gap-graded soil");
    let loaded = load_text(&gapped.to_string(), &[]).expect("law: it loads");
    let bare = with(json!([
        fraction(16.0, 12.5, 40.0),
        fraction(12.5, 10.0, 0.0),
        fraction(10.0, 8.0, 60.0)
    ]));
    let bare = load_text(&bare.to_string(), &[]).expect("law: it loads");
    assert_eq!(loaded.engine, bare.engine, "law: the engine's values follow from the grains");
    assert_eq!(loaded.apparatus, bare.apparatus, "law: and so do those of the apparatus");
    let nothing = with(json!([fraction(16.0, 8.0, 0.0)]));
    let found = faults(&nothing);
    assert!(
        found.iter().any(|fault| fault.to_string().contains("do not add up")),
        "law: nothing is no soil, got {found:?}"
    );
}

/// Law: a laboratory sheet of percentages rounded to one decimal is accepted, and its grains have the
/// whole mass; one that misses 100 by more than rounding can is refused with what is allowed.
#[test]
fn percentages_of_a_laboratory_sheet_may_be_rounded() {
    let sheet = |last: f64| {
        let mut value = sound();
        let fraction = |passing_mm: f64, retained_mm: f64, mass_percent: f64| {
            json!({ "passing_mm": passing_mm, "retained_mm": retained_mm,
                "mass_percent": mass_percent })
        };
        value["grains"]["sieve_table"] = json!([
            fraction(16.0, 12.5, 33.3),
            fraction(12.5, 10.0, 33.3),
            fraction(10.0, 8.0, last)
        ]);
        value
    };
    let rounded = sheet(33.3);
    assert_eq!(faults(&rounded), [], "law: 99.9 % of three fractions is rounding");
    let scenario = load_text(&rounded.to_string(), &[]).expect("law: it loads");
    let GrainsSpec::Sieved(sieved) = &scenario.grains else { panic!("sieved") };
    let psd = ParticleSizeDistribution::new(sieved).expect("law: grains are made of it");
    let mass: f64 = psd.fractions.iter().map(|fraction| fraction.mass).sum();
    assert!((mass - 0.5).abs() < 1e-12, "law: together they have 500 g, got {mass} kg");
    let found = faults(&sheet(33.2));
    assert_eq!(found.len(), 1, "law: 99.8 % is more than rounding, got {found:?}");
    let words = ["grains.sieve_table", "99.8 %", "100 ± 0.15 %", "rounded rows"];
    assert_holds(&found[0].to_string(), &words);
}

#[test]
fn numbers_of_grains_are_bounded() {
    expect_one(
        |s| {
            s["grains"]["sieve_table"][0]["mass_percent"] = json!(99.9);
            s["grains"]["sieve_table"][1]["mass_percent"] = json!(0.1);
        },
        "grains.sieve_table[1].mass_percent",
        &["lighter than one grain", "at least"],
    );
    expect_one(
        |s| {
            s["grains"]["total_mass_g"] = json!(5e8);
            s["apparatus"] = json!({ "cylinder": {
                "inner_diameter_mm": 10000, "height_mm": 10000
            } });
            s["engine"] = json!({ "rate_hz": 5000 });
        },
        "grains.total_mass_g",
        &["grains, more than 1000000"],
    );
}

#[test]
fn a_cylinder_narrower_than_a_grain_is_refused() {
    // Little mass, so that the grains have room by their volume.
    expect_one(
        |s| {
            s["grains"]["total_mass_g"] = json!(20);
            s["apparatus"] = json!({
                "cylinder": { "inner_diameter_mm": 30 },
                "funnel": { "opening_diameter_mm": 30 },
            });
        },
        "apparatus.cylinder.inner_diameter_mm",
        &["narrower than a grain", "found 30", "at least 38.4 mm"],
    );
    let words = ["less room than the grains have volume"];
    expect_at("apparatus.cylinder.height_mm", json!(15), &words);
}

#[test]
fn funnel_and_plate_must_fit() {
    let opening = "apparatus.funnel.opening_diameter_mm";
    let words = ["no grain of the coarsest fraction", "more than 16 mm"];
    expect_at(opening, json!(16), &words);
    expect_at("apparatus.funnel.top_diameter_mm", json!(80), &["no wider at the top"]);
    let wide = json!({
        "cylinder": { "inner_diameter_mm": 75 }, "funnel": { "opening_diameter_mm": 80 },
    });
    expect_one(|s| s["apparatus"] = wide, opening, &["wider than the cylinder"]);
    let plate = |s: &mut Value| s["apparatus"] = json!({ "top_plate": { "diameter_mm": 115 } });
    let mut unused = sound();
    plate(&mut unused);
    assert_eq!(faults(&unused), [], "a plate that is not laid on may have any size");
    expect_one(
        |s| {
            plate(s);
            s["stages"].as_array_mut().expect("a list").push(json!({ "stage": "place_top_plate" }));
        },
        "apparatus.top_plate.diameter_mm",
        &["does not fit", "less than 114.7 mm"],
    );
}

/// Law: grains or a gravity at fault bring no second fault of what nobody typed, though the paper's
/// funnel is wider than this cylinder; what is typed wrongly is a fault beside them.
#[test]
fn what_nobody_typed_is_no_fault_beside_faulty_grains() {
    let narrow = |s: &mut Value| {
        s["apparatus"] = json!({ "cylinder": { "inner_diameter_mm": 72.5 } });
    };
    for (path, found, words) in [
        ("grains.density_kg_per_m3", json!("2650"), ""),
        ("grains.density_kg_per_m3", json!(0), ""),
        // In g/cm³.
        ("grains.density_kg_per_m3", json!(2.65), "at least 10 and at most 30000"),
        ("grains.density_kg_per_m3", Value::Null, ""),
        ("grains.total_mass_g", json!("much"), ""),
        ("grains.total_mass_g", json!(-1), ""),
        ("grains.sieve_table", json!("none"), ""),
        ("grains.sieve_table[0].passing_mm", json!("16"), "wrong type"),
        ("gravity_m_per_s2", json!("strong"), "wrong type"),
    ] {
        let spoil = |s: &mut Value| {
            narrow(s);
            *place(s, path) = found;
        };
        expect_one(spoil, path, &[words]);
    }
    let without_grains = |s: &mut Value| {
        narrow(s);
        drop(s.as_object_mut().expect("an object").remove("grains"));
    };
    expect_one(without_grains, "grains", &["missing"]);

    let mut value = sound();
    narrow(&mut value);
    value["grains"]["density_kg_per_m3"] = json!(0);
    value["apparatus"]["funnel"] = json!({ "opening_diameter_mm": 90 });
    let paths: Vec<String> = faults(&value).into_iter().map(|fault| fault.path).collect();
    let expected = ["grains.density_kg_per_m3", "apparatus.funnel.opening_diameter_mm"];
    assert_eq!(paths, expected, "law: what is typed is judged beside them");
}
