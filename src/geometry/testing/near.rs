//! A number beside the one that a law gives, for tests of the library and of the program.

/// Fails unless `got` is within `tolerance` of `expected`.
#[track_caller]
pub fn near(law: &str, got: f64, expected: f64, tolerance: f64) {
    assert!(
        (got - expected).abs() <= tolerance,
        "law: {law}: expected {expected:e}, got {got:e}, tolerance {tolerance:e}"
    );
}

#[test]
fn the_helper_can_fail() {
    for off in [-0.2, 0.2] {
        assert!(std::panic::catch_unwind(|| near("", 1.0 + off, 1.0, 0.1)).is_err());
    }
    near("", 1.05, 1.0, 0.1);
}
