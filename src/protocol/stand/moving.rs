//! What of the stand moves as prescribed, and whether the rest still does.

use crate::specimen::PressState;

use super::{Fate, Stand, TableMotion, Vector, WorldError, moved};

impl Stand<'_> {
    pub(super) fn move_table(&mut self, to: Vector) -> Result<(), WorldError> {
        for (id, at_rest) in &self.on_table {
            self.world.drive(*id, &moved(at_rest, &to))?;
        }
        self.midway.watch.table_moved(to - self.specimen.state.table());
        self.specimen.state.set_table(to);
        Ok(())
    }

    /// Tells a world in which a shaken stage goes on how the table has moved.
    pub(super) fn recall_table(&mut self, motion: &TableMotion) -> Result<(), WorldError> {
        let dt = self.world.time_step();
        let steps = self.midway.steps;
        let place = |step: u64| motion.displacement(step as f64 * dt);
        let ends = [2, 1, 0].map(|ago| steps.checked_sub(ago).map_or(Vector::zeros(), place));
        for (id, at_rest) in &self.on_table {
            self.world.recall_drive(*id, &ends.map(|at| moved(at_rest, &at)))?;
        }
        Ok(())
    }

    /// Ends a stage in which a pressed piece and another got into each other, which they do not
    /// feel, at a time in s since it began.
    pub(super) fn look_at_presses(&self, stage_time: f64) -> Result<(), WorldError> {
        let into = self.pieces.pressed_into(self.setup, &self.specimen.state);
        let Some((pressed, other)) = into else { return Ok(()) };
        let name = |n: usize| &self.setup.pieces[n].name;
        let (one, into) = (name(pressed), name(other));
        let what = match self.pieces.is_moved(other) {
            // Which of them went into the other is not known.
            true => format!(
                "`{one}`, which is pressed, and `{into}`, which this stage moves, got into each \
                 other: pieces do not push each other"
            ),
            false => format!("`{one}` was pressed into `{into}`: no grains on its way carried it"),
        };
        Err(WorldError::Unphysical { time_s: self.midway.began_s + stage_time, what })
    }

    /// Whether every body is slow enough to count as settled just now.
    pub(super) fn calm(&self) -> bool {
        let limits = &self.setup.settle;
        let state = &self.specimen.state;
        let present = state.bodies.iter().filter(|g| g.fate == Fate::Present).map(|g| &g.body);
        let (mut squares, mut count, mut largest) = (0.0, 0u32, 0.0_f64);
        for body in present.chain(state.top_plate.as_ref()) {
            let square = body.linear_velocity.norm_squared();
            squares += square;
            count += 1;
            largest = largest.max(square);
        }
        // Many grains at rest would hide one piece that slides.
        let mut free = self.pieces.free_motion(state).map(|(.., body)| body);
        let free_at_rest = free.all(|body| body.linear_velocity.norm() <= limits.rms_speed);
        // A small force is whole before its piece meets anything, and a heavy piece rebounds.
        let bears = |press: &PressState| press.arrived || press.target_n == 0.0;
        let speed = |press: &PressState| press.of_points(press.speed_m_per_s);
        let is_still = |press: &PressState| speed(press) <= limits.rms_speed;
        let mut pressed = state.pieces.iter().filter_map(|piece| piece.press);
        // Where nothing is left, only what is waited for can still come: a flow that has ended.
        (count > 0 || self.endings.is_none())
            && free_at_rest
            && pressed.all(|press| press.is_reached() && bears(&press) && is_still(&press))
            && (squares / f64::from(count.max(1))).sqrt() <= limits.rms_speed
            && largest.sqrt() <= limits.largest_speed
    }
}
