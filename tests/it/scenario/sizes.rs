//! Sizes, sieve tables and numbers that no apparatus and no gravel can have.

use serde_json::{Value, json};

use super::{expect_one, faults, sound};

#[test]
fn impossible_sizes_are_refused() {
    expect_one(
        |s| s["apparatus"] = json!({ "cylinder": { "height_mm": -200 } }),
        "apparatus.cylinder.height_mm",
        &["out of range", "found -200", "above 0"],
    );
    expect_one(
        |s| s["grains"]["total_mass_g"] = json!(0),
        "grains.total_mass_g",
        &["out of range", "found 0", "above 0"],
    );
    expect_one(
        |s| s["grains"]["density_kg_per_m3"] = json!(-2650),
        "grains.density_kg_per_m3",
        &["out of range"],
    );
    expect_one(
        |s| s["gravity_m_per_s2"] = json!(0),
        "gravity_m_per_s2",
        &["out of range", "above 0"],
    );
    expect_one(
        |s| s["engine"] = json!({ "length_scale": 1e6 }),
        "engine.length_scale",
        &["out of range", "10000"],
    );
}

#[test]
fn sieve_tables_that_make_no_sense_are_refused() {
    expect_one(
        |s| s["grains"]["sieve_table"].as_array_mut().expect("a list").reverse(),
        "grains.sieve_table[1].passing_mm",
        &["out of order", "from coarse to fine"],
    );
    expect_one(
        |s| s["grains"]["sieve_table"][1]["passing_mm"] = json!(10),
        "grains.sieve_table[1].passing_mm",
        &["gap", "found 10", "allowed: 11.2"],
    );
    expect_one(
        |s| s["grains"]["sieve_table"][1]["passing_mm"] = json!(12),
        "grains.sieve_table[1].passing_mm",
        &["overlap"],
    );
    expect_one(
        |s| s["grains"]["sieve_table"][1]["retained_mm"] = json!(11.2),
        "grains.sieve_table[1].retained_mm",
        &["less than passing_mm"],
    );
    expect_one(
        |s| s["grains"]["sieve_table"][1]["mass_percent"] = json!(39.98),
        "grains.sieve_table",
        &["do not add up", "99.98", "100 ± 0.01"],
    );
    expect_one(|s| s["grains"]["sieve_table"] = json!([]), "grains.sieve_table", &["too short"]);
    let mut within = sound();
    within["grains"]["sieve_table"][1]["mass_percent"] = json!(39.99);
    assert_eq!(faults(&within), [], "a sum of 99.99 is within the tolerance");
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
    expect_one(
        |s| s["apparatus"] = json!({ "cylinder": { "height_mm": 15 } }),
        "apparatus.cylinder.height_mm",
        &["less room than the grains have volume"],
    );
}

#[test]
fn funnel_and_plate_must_fit() {
    expect_one(
        |s| s["apparatus"] = json!({ "funnel": { "opening_diameter_mm": 16 } }),
        "apparatus.funnel.opening_diameter_mm",
        &["no grain of the coarsest fraction", "more than 16 mm"],
    );
    expect_one(
        |s| s["apparatus"] = json!({ "funnel": { "top_diameter_mm": 80 } }),
        "apparatus.funnel.top_diameter_mm",
        &["no wider at the top"],
    );
    expect_one(
        |s| {
            s["apparatus"] = json!({
                "cylinder": { "inner_diameter_mm": 75 }, "funnel": { "opening_diameter_mm": 80 },
            })
        },
        "apparatus.funnel.opening_diameter_mm",
        &["wider than the cylinder"],
    );
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
        &["does not fit", "less than 114.8 mm"],
    );
}

/// Law: grains or a gravity at fault bring no second fault of what nobody typed, though the paper's
/// funnel is wider than this cylinder; what is typed wrongly is a fault beside them.
#[test]
fn what_nobody_typed_is_no_fault_beside_faulty_grains() {
    let narrow = |s: &mut Value| {
        s["apparatus"] = json!({ "cylinder": { "inner_diameter_mm": 72.5 } });
    };
    for (field, found) in [
        ("density_kg_per_m3", json!("2650")),
        ("density_kg_per_m3", json!(0)),
        ("density_kg_per_m3", Value::Null),
        ("total_mass_g", json!("much")),
        ("total_mass_g", json!(-1)),
        ("sieve_table", json!("none")),
    ] {
        let spoil = |s: &mut Value| {
            narrow(s);
            s["grains"][field] = found.clone();
        };
        expect_one(spoil, &format!("grains.{field}"), &[]);
    }
    let of_sieve = |s: &mut Value| {
        narrow(s);
        s["grains"]["sieve_table"][0]["passing_mm"] = json!("16");
    };
    expect_one(of_sieve, "grains.sieve_table[0].passing_mm", &["wrong type"]);
    let without_grains = |s: &mut Value| {
        narrow(s);
        drop(s.as_object_mut().expect("an object").remove("grains"));
    };
    expect_one(without_grains, "grains", &["missing"]);
    let of_gravity = |s: &mut Value| {
        narrow(s);
        s["gravity_m_per_s2"] = json!("strong");
    };
    expect_one(of_gravity, "gravity_m_per_s2", &["wrong type"]);

    let mut value = sound();
    narrow(&mut value);
    value["grains"]["density_kg_per_m3"] = json!(0);
    value["apparatus"]["funnel"] = json!({ "opening_diameter_mm": 90 });
    let paths: Vec<String> = faults(&value).into_iter().map(|fault| fault.path).collect();
    let expected = ["grains.density_kg_per_m3", "apparatus.funnel.opening_diameter_mm"];
    assert_eq!(paths, expected, "law: what is typed is judged beside them");
}
