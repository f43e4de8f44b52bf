//! The force that drags a block over a step down between two floor pieces.
//!
//! A block of length 2ℓ, height h and weight W is pushed forward at a steady velocity, at a
//! height h/2 above the first piece and without friction there. Both floors resist with μ. On a
//! level floor the force is μ W. What it carries is centred under the centroid, moved
//! forward by the moment of the push: a₁ = ℓ − μ h/2 behind the block's front. When that
//! point passes the edge, the block tips until its front meets the lower piece, a step s
//! below. With the edge at a distance a behind the front, geometry gives its tilt:
//!
//! sin θ = s/a, a from a₁ to 2ℓ, where the rear leaves the edge and the block lies flat again.
//!
//! Meanwhile it bears on the edge by N, along the normal of its own lower face, on its front by
//! N', which is vertical, and is pushed by P along the normal of its rear face, at the height
//! of the pusher. Equilibrium of forces and, about the front, of moments is solved for N, N' and
//! P. The normal of a tilted face helps the block forward: to first order in s the force is
//! W (μ − (1 + μ²) θ a₁/a + μ² θ), less than on a level floor.
//!
//! That the block tips and lands, and does not go from equilibrium to equilibrium, matters
//! little for the mean force. The vertical forces have the impulse W T in a time T whatever
//! happens in it, because the block has no vertical momentum before and after; plastic impacts on
//! horizontal faces are part of it, and friction takes μ of every part. Inertia can only move the
//! small forward part, while the front falls for about √(2s/g), by a share of it. (Statics of
//! a rigid body and Coulomb's law; no further source.)

/// A block that is pushed over a step down; lengths in m.
#[derive(Debug, Clone, Copy)]
pub(super) struct Drag {
    /// Half its length, ℓ.
    pub half_length: f64,
    /// Its height, h.
    pub height: f64,
    pub friction: f64,
    /// Step down, s.
    pub step: f64,
}

/// Of a place on the way: the pusher's position, in m in front of the edge, and its horizontal
/// force as a share of the weight.
type Pushed = (f64, f64);

impl Drag {
    /// Distance (m) of the edge behind the front at which the block tips, a₁.
    pub fn tips(&self) -> f64 {
        self.half_length - 0.5 * self.friction * self.height
    }

    /// The push with the edge a distance a (m) behind the front.
    fn pushed(&self, a: f64) -> Pushed {
        let (mu, half) = (self.friction, 0.5 * self.height);
        let sin = self.step / a;
        let cos = (1.0 - sin * sin).sqrt();
        // Along the rear face, from its lower edge to the pusher.
        let up = (self.step + half - 2.0 * self.half_length * sin) / cos;
        let arm = self.half_length * cos - half * sin;
        // Forces along x and z, with the moments −a N − up P + arm W = 0 about the front.
        let helps = sin * (1.0 + mu * mu);
        let push = (mu - helps * arm / a) / (cos - mu * sin - helps * up / a);
        (a * cos - 2.0 * self.half_length * cos + up * sin, push * cos)
    }

    /// Forces on the way while the block is tilted, in equal steps of a.
    pub fn tilted(&self) -> Vec<Pushed> {
        const STEPS: u32 = 2000;
        let (from, to) = (self.tips(), 2.0 * self.half_length);
        (0..=STEPS)
            .map(|n| self.pushed(from + (to - from) * f64::from(n) / f64::from(STEPS)))
            .collect()
    }

    /// Mean of the force over μ W while the pusher goes a distance (m) in which the block
    /// passes the edge from flat to flat.
    pub fn mean(&self, distance: f64) -> f64 {
        let tilted = self.tilted();
        let less = |p: &[Pushed]| (p[1].0 - p[0].0) * (0.5 * (p[0].1 + p[1].1) - self.friction);
        1.0 + tilted.windows(2).map(less).sum::<f64>() / (self.friction * distance)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drag(step: f64) -> Drag {
        Drag { half_length: 0.01, height: 0.006, friction: 0.3, step }
    }

    #[test]
    fn without_a_step_it_is_coulombs_force() {
        assert_eq!(drag(0.0).mean(0.03), 1.0, "law: μ W");
        for (_, force) in drag(0.0).tilted() {
            assert!((force - 0.3).abs() < 1e-15, "law: μ W, got {force} W");
        }
    }

    #[test]
    fn a_small_step_gives_the_force_of_first_order() {
        let small = drag(1e-6);
        let (mu, first, length) = (small.friction, small.tips(), 0.02);
        // ∫ θ a₁/a da and ∫ θ da with θ = s/a.
        let edge = small.step * (1.0 - first / length);
        let pushed = small.step * (length / first).ln();
        let less = (1.0 + mu * mu) * edge - mu * mu * pushed;
        let (expected, got) = (less / (mu * 0.03), 1.0 - small.mean(0.03));
        assert!((got / expected - 1.0).abs() < 1e-3, "law: {expected:e} less, got {got:e}");
    }

    /// What the pusher does not give comes from the height that the block loses, of
    /// which some is lost as the front and the rear land.
    #[test]
    fn a_step_saves_work_and_no_more_than_the_block_sinks() {
        for step in [1e-5, 1e-4, 5e-4] {
            let saved = drag(step).friction * 0.03 * (1.0 - drag(step).mean(0.03));
            assert!(saved > 0.0 && saved < step, "law: 0 to {step} W m, got {saved}");
        }
    }

    /// Forces and moments of the tilted block, put together once more from their points.
    #[test]
    fn the_tilted_block_is_in_equilibrium() {
        let drag = drag(5e-4);
        let (a, mu) = (0.013, drag.friction);
        let push = drag.pushed(a).1;
        let sin = drag.step / a;
        let cos = (1.0 - sin * sin).sqrt();
        let push = push / cos;
        let cross = |r: (f64, f64), f: (f64, f64)| r.0 * f.1 - r.1 * f.0;
        let (edge, rear) = ((-a * cos, drag.step), (-0.02 * cos, 0.02 * sin));
        let height = drag.step + 0.003;
        let pusher = (rear.0 + (height - rear.1) * sin / cos, height);
        let centre = (-0.01 * cos + 0.003 * sin, 0.01 * sin + 0.003 * cos);
        let pushes = (push * cos, -push * sin);
        let along = |n: f64| (n * (sin - mu * cos), n * (cos + mu * sin));
        // The edge's force from the moments; the front's from the vertical forces.
        let moment = cross(pusher, pushes) + cross(centre, (0.0, -1.0));
        let edge_force = -moment / cross(edge, along(1.0));
        let front = 1.0 - along(edge_force).1 - pushes.1;
        assert!(edge_force > 0.0 && front > 0.0, "law: floors push, {edge_force} and {front}");
        let forward = along(edge_force).0 - mu * front + pushes.0;
        assert!(forward.abs() < 1e-12, "law: no force is left over, got {forward:e} W");
    }
}
