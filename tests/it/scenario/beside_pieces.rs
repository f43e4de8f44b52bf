//! What means nothing beside the pieces of a laboratory.

use std::fs;

use pluvia::grains::load_scenario;
use serde_json::{Value, json};

use super::sound;

/// Law: an apparatus that stands beside pieces in one file is said to mean nothing; one that a file
/// extends, or that is whole, as in a manifest, may be there.
#[test]
fn an_apparatus_beside_pieces_is_noted() {
    let folder = tempfile::tempdir().expect("a folder");
    let notes = |name: &str, value: &Value| {
        let path = folder.path().join(name);
        fs::write(&path, value.to_string()).expect("written");
        load_scenario(&path, &[]).unwrap_or_else(|e| panic!("{name}: {e}")).notes
    };
    let cylinder = json!({ "cylinder": { "inner_diameter_mm": 120 } });
    let pieces = json!([{ "name": "box", "shape": { "box": { "inner_mm": [90, 90, 200] } } }]);
    let deposit = json!([{ "stage": "deposit", "at_mm": [0, 0, 190], "area_mm": [60, 60],
        "rate_g_per_s": 500 }]);
    let mut built_in = sound();
    built_in["apparatus"] = cylinder.clone();
    assert_eq!(notes("base.json", &built_in), [""; 0], "law: of the apparatus itself nothing");
    let mut laboratory = sound();
    laboratory["pieces"] = pieces.clone();
    laboratory["stages"] = deposit.clone();
    laboratory.as_object_mut().expect("fields").remove("apparatus");
    assert_eq!(notes("pieces.json", &laboratory), [""; 0], "law: of pieces alone nothing");
    let scenario = load_scenario(&folder.path().join("pieces.json"), &[]).expect("sound").scenario;
    let whole = serde_json::to_value(&scenario).expect("JSON");
    assert!(whole["apparatus"].is_object(), "the check sees one: {whole}");
    assert_eq!(notes("whole.json", &whole), [""; 0], "law: a run keeps every field");
    let extending = json!({ "extends": "base.json", "pieces": pieces, "stages": deposit });
    assert_eq!(notes("extending.json", &extending), [""; 0], "law: it may be inherited");
    laboratory["apparatus"] = cylinder;
    let got = notes("both.json", &laboratory);
    let is_noted =
        got.len() == 1 && got[0].starts_with("apparatus: it means nothing with `pieces`");
    assert!(is_noted, "law: one note on `apparatus`, got {got:?}");
}
