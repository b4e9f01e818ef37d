//! Machine position → least output increments → drive pulses (manual III-12.4).

use serde::{Deserialize, Serialize};

use crate::memory::Parameters;
use crate::units::{Axis, PerAxis, Point, Pulses};

/// The least output increment of an axis, mm of slide travel: X 0.0005 with
/// diameter programming (001.2 = 0), 0.001 with radius programming; Z 0.001. With
/// an inch machine (004.0 SCW) 0.0001 inch takes the place of 0.001 mm.
pub fn least_increment(axis: Axis, parameters: &Parameters) -> f64 {
    match axis {
        Axis::X if !parameters.radius_programming() => parameters.least_increment() / 2.0,
        _ => parameters.least_increment(),
    }
}

/// Slide travel of one pulse, mm: what the drive must be set to.
pub fn pulse_weight(axis: Axis, parameters: &Parameters) -> f64 {
    let (multiply, divide) = parameters.gear(axis);
    least_increment(axis, parameters) * f64::from(divide) / f64::from(multiply)
}

/// Whether pulses count down towards positive coordinates (008.0 DIRX, 008.1 DIRZ).
pub(crate) fn motor_reversed(axis: Axis, parameters: &Parameters) -> bool {
    let bit = match axis {
        Axis::X => 0,
        Axis::Z => 1,
    };
    !parameters.bit(8, bit)
}

/// The highest speed an axis can be given when the gear multiplies (CMR > CMD),
/// mm/min; beyond it alarm 097 (manual III-12.4).
pub fn gear_speed_limit(axis: Axis, parameters: &Parameters) -> Option<f64> {
    let (multiply, divide) = parameters.gear(axis);
    let base = match axis {
        Axis::X => 3800.0,
        Axis::Z => 7600.0,
    };
    (multiply > divide).then(|| base * f64::from(divide) / f64::from(multiply))
}

/// One axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct Chain {
    /// Least output increments per mm.
    per_mm: f64,
    multiply: i64,
    divide: i64,
    reversed: bool,
    /// Machine coordinate, mm, of the place where the increments are counted from.
    origin: f64,
    /// Pulse count there.
    base: i64,
    /// Distance that machine lock has kept from the slide, mm.
    locked_away: f64,
    /// Commanded coordinate of the last tick, mm.
    commanded: f64,
}

impl Chain {
    fn new(axis: Axis, parameters: &Parameters) -> Self {
        let (multiply, divide) = parameters.gear(axis);
        Self {
            per_mm: 1.0 / least_increment(axis, parameters),
            multiply: multiply.into(),
            divide: divide.into(),
            reversed: motor_reversed(axis, parameters),
            origin: 0.0,
            base: 0,
            locked_away: 0.0,
            commanded: 0.0,
        }
    }

    fn slide(&self) -> f64 {
        self.commanded - self.locked_away
    }

    /// The position in whole increments, then geared; the part of a pulse that is
    /// left over counts again with the next increment.
    fn pulses(&self) -> i64 {
        let increments = ((self.slide() - self.origin) * self.per_mm).round() as i64;
        let geared = increments * self.multiply / self.divide;
        self.base + if self.reversed { -geared } else { geared }
    }

    fn advance(&mut self, commanded: f64, locked: bool) {
        if locked {
            self.locked_away += commanded - self.commanded;
        }
        self.commanded = commanded;
    }

    /// Makes the place of a pulse count the coordinate zero; the coordinate of the
    /// place where the axis stands now.
    fn zero_at(&mut self, count: i64) -> f64 {
        let from_base = count - self.base;
        let from_base = if self.reversed { -from_base } else { from_base };
        let increments = from_base as f64 * self.divide as f64 / self.multiply as f64;
        self.commanded = self.slide() - (self.origin + increments / self.per_mm);
        self.origin = 0.0;
        self.base = count;
        self.locked_away = 0.0;
        self.commanded
    }

    fn preset(&mut self, commanded: f64) {
        // The origin moves along, so that the part of a pulse left over is kept.
        self.origin += commanded - self.slide();
        self.commanded = commanded;
        self.locked_away = 0.0;
    }
}

/// Positions to pulses for both axes. The pulse count follows from the absolute
/// position, never from a sum of steps: there is no drift.
///
/// ```text
///  position ─► increments ─► · CMR / CMD ─► direction 008 ─► pulses
///    mm        0.0005/0.001    015–018
/// ```
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisChain {
    chains: PerAxis<Chain>,
}

impl AxisChain {
    /// At machine coordinate zero and pulse count zero.
    pub fn new(parameters: &Parameters) -> Self {
        let chain = |axis| Chain::new(axis, parameters);
        Self {
            chains: PerAxis::new(chain(Axis::X), chain(Axis::Z)),
        }
    }

    /// The slides follow the commanded position, except locked axes (machine
    /// lock), which get no pulses; the count after it.
    pub fn advance(&mut self, commanded: Point, locked: PerAxis<bool>) -> PerAxis<Pulses> {
        self.chains.x.advance(commanded.x, locked.x);
        self.chains.z.advance(commanded.z, locked.z);
        self.pulses()
    }

    /// The pulse count.
    pub fn pulses(&self) -> PerAxis<Pulses> {
        PerAxis::new(
            Pulses(self.chains.x.pulses()),
            Pulses(self.chains.z.pulses()),
        )
    }

    /// Machine coordinate of the slides: the commanded position without what
    /// machine lock has kept from them.
    pub fn slide(&self) -> Point {
        Point::new(self.chains.x.slide(), self.chains.z.slide())
    }

    /// Gives the place where an axis stands another machine coordinate, mm (X in
    /// radius), without a pulse: reference point, power-on, end of machine lock.
    pub fn preset(&mut self, axis: Axis, coordinate: f64) {
        self.chains.get_mut(axis).preset(coordinate);
    }

    /// Makes the place of a pulse count the machine zero of an axis (the zero signal
    /// came there); the machine coordinate, mm, of the place where it stands now.
    pub fn zero_at(&mut self, axis: Axis, count: Pulses) -> f64 {
        self.chains.get_mut(axis).zero_at(count.0)
    }

    /// Takes over changed parameters 001.2, 008, 015–018 at standstill, without a
    /// pulse.
    pub fn reconfigure(&mut self, parameters: &Parameters) {
        for axis in [Axis::X, Axis::Z] {
            let chain = self.chains.get_mut(axis);
            let mut changed = Chain::new(axis, parameters);
            changed.base = chain.pulses();
            changed.origin = chain.slide();
            changed.commanded = chain.commanded;
            changed.locked_away = chain.locked_away;
            *chain = changed;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn geared(multiply: i64, divide: i64) -> Chain {
        Chain {
            per_mm: 1000.0,
            multiply,
            divide,
            reversed: false,
            origin: 0.0,
            base: 0,
            locked_away: 0.0,
            commanded: 0.0,
        }
    }

    #[test]
    fn a_fifth_gives_its_first_pulse_at_five_increments() {
        let mut chain = geared(1, 5);
        chain.advance(0.004, false);
        assert_eq!(chain.pulses(), 0);
        chain.advance(0.005, false);
        assert_eq!(chain.pulses(), 1);
        chain.advance(-0.004, false);
        assert_eq!(chain.pulses(), 0);
    }

    #[test]
    fn machine_lock_keeps_the_slide_where_it_is() {
        let mut chain = geared(1, 1);
        chain.advance(1.0, false);
        chain.advance(3.0, true);
        assert_eq!((chain.pulses(), chain.slide()), (1000, 1.0));
        chain.advance(4.0, false);
        assert_eq!(chain.pulses(), 2000);
    }

    #[test]
    fn a_preset_gives_no_pulse() {
        let mut chain = geared(1, 1);
        chain.advance(12.345, false);
        chain.preset(0.0);
        assert_eq!(chain.pulses(), 12345);
        chain.advance(-0.345, false);
        assert_eq!(chain.pulses(), 12000);
    }

    #[test]
    fn the_zero_is_the_pulse_of_the_signal_whatever_the_gear() {
        for (multiply, divide) in [(1, 1), (3, 7), (1, 5), (127, 1)] {
            for reversed in [false, true] {
                let mut chain = Chain {
                    reversed,
                    ..geared(multiply, divide)
                };
                chain.advance(12.3456, false);
                let count = chain.pulses() - 3;
                let here = chain.zero_at(count);
                let sign = if reversed { -1.0 } else { 1.0 };
                let weight = 0.001 * divide as f64 / multiply as f64;
                assert!(
                    (here - sign * 3.0 * weight).abs() < 1.001 * weight + 0.001,
                    "{here}"
                );
                chain.advance(0.0, false);
                assert_eq!(chain.pulses(), count);
            }
        }
    }

    #[test]
    fn presets_of_places_between_increments_do_not_drift() {
        let mut chain = geared(1, 5);
        let mut at = 0.0;
        for _ in 0..10_000 {
            at += 0.00025;
            chain.advance(at, false);
            at = 0.0;
            chain.preset(at);
        }
        assert_eq!(chain.pulses(), 500);
    }

    proptest! {
        #[test]
        fn pulses_are_the_rounded_end_position(ways in prop::collection::vec(-50_000i32..50_000, 1..60)) {
            let mut chain = geared(1, 1);
            let mut at = 0.0;
            let mut thousandths = 0i64;
            for way in ways {
                at += f64::from(way) / 1000.0;
                thousandths += i64::from(way);
                chain.advance(at, false);
            }
            prop_assert_eq!(chain.pulses(), thousandths);
        }
    }
}
