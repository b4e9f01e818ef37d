//! On which end of its axis an operated limit switch lies: that way the axis is not
//! moved.
//!
//! A board tells a switch, not its end; the motion that met it does. Where that is not
//! known (power came on upon it, a hand has pressed it) the axis goes in short pieces,
//! and somebody has to look between them.

use super::MotionRefused;
use gsk_units::Axis;

/// A piece of motion upon a switch whose end is not known, and how far off a switch the
/// axis has to be for it to be another meeting, mm of the slide.
const STEP_LIMIT_MM: f64 = 1.0;

/// The limit switches of X and Z.
#[derive(Clone, Copy, Debug)]
pub(super) struct Limits([Limit; 2]);

#[derive(Clone, Copy, Debug, Default)]
struct Limit {
    /// `PIECE` in pulses.
    piece: i64,
    operated: bool,
    /// Way on which the switch lies, 1 or -1; 0: not known.
    direction: i64,
    /// Pulses: upon a switch whose end is not known those made since somebody looked,
    /// off it the distance.
    moved: i64,
    /// Way of the newest of them.
    last: i64,
}

impl Limits {
    pub(super) fn new(pulses_per_mm: [f64; 2]) -> Self {
        Self(pulses_per_mm.map(|per_mm| Limit {
            piece: (STEP_LIMIT_MM * per_mm).ceil() as i64,
            ..Limit::default()
        }))
    }

    /// A switch was met on this way of the axis; 0: it is not known on which.
    pub(super) const fn hit(&mut self, axis: usize, direction: i64) {
        let limit = &mut self.0[axis];
        limit.operated = true;
        limit.moved = 0;
        // Met both ways at the same place: it chatters, or a hand was there.
        limit.direction = if limit.direction == 0 || limit.direction == direction {
            direction
        } else {
            0
        };
    }

    /// Way on which the switch lies that an axis stands upon, 0 when that is not known;
    /// none: it is free.
    pub(super) fn operated_direction(&self, axis: usize) -> Option<i64> {
        let limit = &self.0[axis];
        limit.operated.then_some(limit.direction)
    }

    pub(super) const fn is_any_operated(&self) -> bool {
        self.0[0].operated || self.0[1].operated
    }

    /// Whether the axis is well off its switch.
    pub(super) const fn has_left(&self, axis: usize) -> bool {
        !self.0[axis].operated && self.0[axis].direction == 0
    }

    /// Somebody has looked where the slides stand.
    pub(super) fn confirm_position_checked(&mut self) {
        for limit in &mut self.0 {
            if limit.operated {
                limit.moved = 0;
            }
        }
    }

    /// The axes will be moved by the board itself, farther than is told here.
    pub(super) const fn forget(&mut self) {
        self.0[0].direction = 0;
        self.0[1].direction = 0;
    }

    /// Whether the axes may be moved by so many pulses; they are when it is allowed.
    /// `operated`: what the switches were last reported to be.
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
                    // It was left behind.
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
        } else if self.direction == 0 && self.moved + moved.abs() > self.piece {
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
            if self.moved.abs() > self.piece {
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
    fn the_way_it_was_met_on_is_refused_and_the_other_is_not() {
        let mut limits = limits();
        limits.hit(1, 1);
        let refused = Err(MotionRefused::TowardLimit(Axis::Z));
        assert_eq!(limits.allow([5, 1], MET), refused);
        assert_eq!(limits.allow([5, 0], MET), Ok(()));
        assert_eq!(limits.allow([0, -5000], MET), Ok(()));
        assert_eq!(limits.allow([0, 1], MET), refused);
    }

    #[test]
    fn upon_an_unknown_end_it_goes_a_millimetre_at_a_time() {
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

    /// What let it go reports where it lies, as long as the axis is near.
    #[test]
    fn a_switch_that_was_left_is_known_until_the_axis_is_a_millimetre_off() {
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
        // The one at the other end is another one.
        limits.hit(1, -1);
        assert_eq!(limits.allow([0, -1], MET), refused);
        assert_eq!(limits.allow([0, 1], MET), Ok(()));
    }

    #[test]
    fn met_on_both_ways_nothing_is_known() {
        let mut limits = limits();
        limits.hit(0, 1);
        limits.hit(0, -1);
        assert_eq!(limits.operated_direction(0), Some(0));
        assert_eq!(limits.operated_direction(1), None);
    }
}
