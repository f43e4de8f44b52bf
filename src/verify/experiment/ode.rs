//! Ordinary differential equations, for laws without a closed solution.

use nalgebra::SVector;

/// One step of the classical Runge-Kutta method of fourth order for y' = rate(y).
pub(super) fn runge_kutta<const N: usize>(
    y: &SVector<f64, N>,
    step: f64,
    rate: impl Fn(&SVector<f64, N>) -> SVector<f64, N>,
) -> SVector<f64, N> {
    let k1 = rate(y);
    let k2 = rate(&(y + k1 * (step / 2.0)));
    let k3 = rate(&(y + k2 * (step / 2.0)));
    let k4 = rate(&(y + k3 * step));
    y + (k1 + 2.0 * k2 + 2.0 * k3 + k4) * (step / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector2;

    fn error_of_a_turn(steps: u32) -> f64 {
        let step = std::f64::consts::TAU / f64::from(steps);
        let mut y = Vector2::new(1.0, 0.0);
        for _ in 0..steps {
            y = runge_kutta(&y, step, |y| Vector2::new(y.y, -y.x));
        }
        (y - Vector2::new(1.0, 0.0)).norm()
    }

    #[test]
    fn an_oscillator_comes_back_with_an_error_of_fourth_order() {
        let (coarse, fine) = (error_of_a_turn(50), error_of_a_turn(100));
        assert!(fine < 1e-5, "law: cos t after a period, off by {fine:e}");
        let order = (coarse / fine).log2();
        assert!((order - 4.0).abs() < 0.2, "law: fourth order, got {order}");
    }
}
