//! Refuses motion towards an operated limit switch.
//!
//! A board reports that a switch of an axis is operated, but not at which end. The link
//! derives the end from the direction of the motion that operated the switch. If the
//! direction is unknown (at power-on, or when a hand presses the switch) the axis may move
//! a short distance only, until the operator has checked its position.

use super::MotionRefused;
use gsk_units::Axis;

/// Distance that an axis may move on a switch of unknown end, mm of the slide. At the same
/// distance from a switch the link forgets the end of that switch.
const STEP_LIMIT_MM: f64 = 1.0;

/// States of the limit switches of X and Z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits([Limit; 2]);

#[derive(Clone, Copy, Debug, Default)]
struct Limit {
    /// Distance [`STEP_LIMIT_MM`] converted to pulses.
    step_limit: i64,
    operated: bool,
    /// Direction of motion towards the limit switch, 1 or -1; 0 if unknown.
    direction: i64,
    /// Pulses moved. While a switch of unknown end is operated: the sum of all motion in both
    /// directions since the operator's last check. While no switch is operated: the distance
    /// from the last one, positive in the positive direction of the axis.
    moved: i64,
    /// Direction of the last motion on the operated switch, 1 or -1.
    last: i64,
}

impl Limits {
    pub(super) fn new(pulses_per_mm: [f64; 2]) -> Self {
        Self(pulses_per_mm.map(|per_mm| Limit {
            step_limit: (STEP_LIMIT_MM * per_mm).ceil() as i64,
            ..Limit::default()
        }))
    }

    /// Stores that motion in `direction`, 1 or -1, operated the switch of an axis (0 for X, 1 for
    /// Z). A `direction` of 0 means unknown.
    pub(super) const fn hit(&mut self, axis: usize, direction: i64) {
        let limit = &mut self.0[axis];
        limit.operated = true;
        limit.moved = 0;
        // Operated in both directions: the switch bounces, or a hand presses it.
        limit.direction = if limit.direction == 0 || limit.direction == direction {
            direction
        } else {
            0
        };
    }

    /// Returns the direction from an axis (0 for X, 1 for Z) towards its operated limit switch, 1
    /// or -1, or 0 if unknown; `None` if the switch is free.
    pub(super) fn operated_direction(&self, axis: usize) -> Option<i64> {
        let limit = &self.0[axis];
        limit.operated.then_some(limit.direction)
    }

    pub(super) const fn is_any_operated(&self) -> bool {
        self.0[0].operated || self.0[1].operated
    }

    /// Whether the axis (0 for X, 1 for Z) has moved off its limit switch by more than
    /// [`STEP_LIMIT_MM`].
    pub(super) const fn has_left(&self, axis: usize) -> bool {
        !self.0[axis].operated && self.0[axis].direction == 0
    }

    /// Permits new motion on operated limit switches, after the operator has checked the position
    /// (RESET).
    pub(super) fn confirm_position_checked(&mut self) {
        for limit in &mut self.0 {
            if limit.operated {
                limit.moved = 0;
            }
        }
    }

    /// Forgets at which end the switches are: while homing, the board moves the axes without the
    /// link.
    pub(super) const fn forget(&mut self) {
        self.0[0].direction = 0;
        self.0[1].direction = 0;
    }

    /// Checks a motion of X and Z by `moves` pulses, and counts it if it is allowed. `operated`
    /// tells whether the switches of X and Z were last reported as operated; `None` if not
    /// reported.
    ///
    /// # Errors
    /// The motion leads towards an operated switch, or too far on a switch of unknown end.
    pub(super) fn allow(
        &mut self,
        moves: [i64; 2],
        operated: [Option<bool>; 2],
    ) -> Result<(), MotionRefused> {
        for (axis, limit) in [Axis::X, Axis::Z].into_iter().zip(&mut self.0) {
            let moved = moves[axis as usize];
            if moved != 0 {
                limit.update(operated[axis as usize]);
                limit.allows(axis, moved)?;
            }
        }
        for (limit, moved) in self.0.iter_mut().zip(moves) {
            if moved != 0 {
                limit.go(moved);
            }
        }
        Ok(())
    }
}

impl Limit {
    const fn update(&mut self, operated: Option<bool>) {
        match operated {
            Some(true) if !self.operated => {
                self.operated = true;
                self.moved = 0;
            }
            Some(false) if self.operated => {
                self.operated = false;
                if self.direction == 0 && self.moved != 0 {
                    // The axis has left the switch: it is in the opposite direction.
                    self.direction = -self.last;
                }
                self.moved = 0;
            }
            _ => {}
        }
    }

    const fn allows(&self, axis: Axis, moved: i64) -> Result<(), MotionRefused> {
        if !self.operated {
            Ok(())
        } else if self.direction == 0 && self.moved + moved.abs() > self.step_limit {
            Err(MotionRefused::OnLimit(axis))
        } else if self.direction == moved.signum() {
            Err(MotionRefused::TowardLimit(axis))
        } else {
            Ok(())
        }
    }

    const fn go(&mut self, moved: i64) {
        if self.operated {
            self.moved += moved.abs();
            self.last = moved.signum();
        } else if self.direction != 0 {
            self.moved += moved;
            if self.moved.abs() > self.step_limit {
                self.direction = 0;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MET: [Option<bool>; 2] = [Some(false), Some(true)];
    const FREE: [Option<bool>; 2] = [Some(false), Some(false)];

    fn limits() -> Limits {
        Limits::new([400.0, 200.0])
    }

    #[test]
    fn motion_towards_an_operated_switch_is_refused() {
        let mut limits = limits();
        limits.hit(1, 1);
        let refused = Err(MotionRefused::TowardLimit(Axis::Z));
        assert_eq!(limits.allow([5, 1], MET), refused);
        assert_eq!(limits.allow([5, 0], MET), Ok(()));
        assert_eq!(limits.allow([0, -5000], MET), Ok(()));
        assert_eq!(limits.allow([0, 1], MET), refused);
    }

    #[test]
    fn on_a_switch_of_unknown_end_an_axis_moves_a_millimetre() {
        let mut limits = limits();
        for direction in [1, -1] {
            for _ in 0..200 {
                assert_eq!(limits.allow([3, direction], MET), Ok(()));
            }
            let refused = Err(MotionRefused::OnLimit(Axis::Z));
            assert_eq!(limits.allow([3, direction], MET), refused);
            assert_eq!(limits.allow([3, -direction], MET), refused);
            limits.confirm_position_checked();
        }
    }

    #[test]
    fn the_end_of_a_released_switch_is_known_within_a_millimetre() {
        let mut limits = limits();
        assert_eq!(limits.allow([0, -100], MET), Ok(()));
        assert_eq!(limits.allow([0, -100], FREE), Ok(()));
        assert!(!limits.has_left(1));
        assert_eq!(limits.allow([0, 99], FREE), Ok(()));
        let refused = Err(MotionRefused::TowardLimit(Axis::Z));
        assert_eq!(limits.allow([0, 1], MET), refused);
        assert_eq!(limits.allow([0, -1], MET), Ok(()));
        assert_eq!(limits.allow([0, -200], FREE), Ok(()));
        assert!(!limits.has_left(1));
        assert_eq!(limits.allow([0, -1], FREE), Ok(()));
        assert!(limits.has_left(1));
        // The axis meets the switch of the other end.
        limits.hit(1, -1);
        assert_eq!(limits.allow([0, -1], MET), refused);
        assert_eq!(limits.allow([0, 1], MET), Ok(()));
    }

    #[test]
    fn a_switch_operated_in_both_directions_has_an_unknown_end() {
        let mut limits = limits();
        limits.hit(0, 1);
        limits.hit(0, -1);
        assert_eq!(limits.operated_direction(0), Some(0));
        assert_eq!(limits.operated_direction(1), None);
    }
}
