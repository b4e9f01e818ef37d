//! The spindle for which the kernel plans a thread: a whole number of ticks for each turn, so
//! that all passes of a thread have the same positions.

use crate::ThreadPlan;

/// Ticks of the kernel per second.
pub(super) const TICKS_PER_S: f64 = 1000.0;
/// Least number of ticks of a turn.
const LEAST_TURN: f64 = 4.0;
/// A planned speed is kept for later threads while the wanted one is between these shares of it:
/// all passes of a thread then have the same lead-in, and cut the same groove.
const KEPT_SPEEDS: core::ops::RangeInclusive<f64> = 0.5..=1.15;

/// The turns of the planned spindle in a thread.
#[derive(Clone, Copy, Debug, Default)]
struct PlannedTurns {
    ticks_per_turn: f64,
    turn: f64,
    tick: f64,
    /// Number of ticks since the plan began.
    age: u32,
    is_waiting: bool,
}

/// The spindle that the kernel sees: the planned one in a thread, else one of the measured speed.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct PlannedSpindle {
    /// `None` while the motion does not depend on the angle.
    plan: Option<PlannedTurns>,
    kept_ticks_per_turn: Option<f64>,
    /// The angle at the start and at the end of the kernel's tick, turns.
    pub(super) turns: [f64; 2],
}

impl PlannedSpindle {
    /// Takes the plan for the next tick; `None` if its motion does not depend on the angle.
    /// `measured` is the speed, turns per second.
    pub(super) fn follow(&mut self, plan: Option<ThreadPlan>, measured: f64) {
        let Some(plan) = plan else {
            self.plan = None;
            return;
        };
        if let Some(planned) = &mut self.plan {
            planned.age = planned.age.saturating_add(1);
            planned.is_waiting = plan.waits;
            return;
        }
        let wanted = if plan.rpm > 0.0 {
            plan.rpm / 60.0
        } else {
            measured
        };
        let wanted = libm::round(TICKS_PER_S / wanted.max(0.01)).max(LEAST_TURN);
        // The fewer ticks, the faster.
        let is_near = |kept: &f64| KEPT_SPEEDS.contains(&(*kept / wanted));
        let ticks_per_turn = self.kept_ticks_per_turn.filter(is_near).unwrap_or(wanted);
        self.kept_ticks_per_turn = Some(ticks_per_turn);
        self.plan = Some(PlannedTurns {
            ticks_per_turn,
            turn: self.turns[1].ceil(),
            is_waiting: plan.waits,
            ..PlannedTurns::default()
        });
    }

    /// Returns the number of ticks of a turn; `None` while the motion does not depend on the angle.
    pub(super) const fn ticks_per_turn(&self) -> Option<f64> {
        match self.plan {
            Some(planned) => Some(planned.ticks_per_turn),
            None => None,
        }
    }

    /// Turns the spindle by a tick; returns the angle before and after it, turns.
    pub(super) fn turn(&mut self, measured: f64) -> [f64; 2] {
        let Some(planned) = &mut self.plan else {
            let before = self.turns[1];
            self.turns = [before, before + measured / TICKS_PER_S];
            return self.turns;
        };
        // The kernel need not wait for an index of its planned spindle: the board waits for the true
        // one.
        if planned.age == 1 && planned.is_waiting {
            planned.turn += 1.0;
            planned.tick = 0.0;
        }
        let at = |tick: f64| planned.turn + tick / planned.ticks_per_turn;
        self.turns = [at(planned.tick), at(planned.tick + 1.0)];
        planned.tick += 1.0;
        if planned.tick >= planned.ticks_per_turn {
            planned.tick = 0.0;
            planned.turn += 1.0;
        }
        self.turns
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The fractions of a turn at the ends of the ticks of a thread.
    fn thread(spindle: &mut PlannedSpindle, rpm: f64, measured: f64) -> Vec<f64> {
        let mut angles = Vec::new();
        for tick in 0..250 {
            let waits = tick < 2;
            spindle.follow(Some(ThreadPlan { rpm, waits }), measured);
            let [before, after] = spindle.turn(measured);
            assert!(after > before);
            if !waits {
                angles.push(after - after.floor());
            }
        }
        spindle.follow(None, measured);
        angles
    }

    #[test]
    fn all_passes_have_the_same_angles() {
        let mut spindle = PlannedSpindle::default();
        // The speed of a spindle that the control does not command is measured, a little otherwise
        // for each pass.
        let first = thread(&mut spindle, 0.0, 9.8);
        for measured in [10.4, 9.1, 11.0] {
            for _ in 0..777 {
                spindle.turn(measured);
            }
            let next = thread(&mut spindle, 0.0, measured);
            let is_equal = |(one, other): (&f64, &f64)| (one - other).abs() < 1e-9;
            assert!(first.iter().zip(&next).all(is_equal), "{measured}");
        }
        // A faster spindle has another plan: the axes could not follow the old one.
        thread(&mut spindle, 900.0, 15.0);
        assert_eq!(spindle.kept_ticks_per_turn, Some(67.0));
    }
}
