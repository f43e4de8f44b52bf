//! The laws by which `make laboratory` reads its tests keep to what they say.

#[allow(dead_code, unused_imports)] // the laboratory reads more than the tests ask
#[path = "../../benches/laboratory/standard_tests/mod.rs"]
mod laws;
