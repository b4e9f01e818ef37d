//! Converts machine positions to least output increments and to drive pulses (manual
//! III-12.4).

use serde::{Deserialize, Serialize};

use super::backlash::Backlash;
use super::pitch::PitchCurve;
use crate::memory::{ControlParameters, PitchTable};
use crate::units::{Axis, PerAxis, Point, Pulses, round_to_i64};

/// The least output increment of an axis, mm of slide travel: X 0.0005 with
/// diameter programming (001.2 = 0), 0.001 with radius programming; Z 0.001. With
/// an inch machine (004.0 SCW) 0.0001 inch takes the place of 0.001 mm.
pub(crate) fn least_increment(axis: Axis, parameters: &ControlParameters) -> f64 {
    match axis {
        Axis::X if !parameters.is_radius_programming() => parameters.least_increment_mm() / 2.0,
        _ => parameters.least_increment_mm(),
    }
}

/// Slide travel of one pulse, mm: the weight that the drive must be set to.
pub fn pulse_weight(axis: Axis, parameters: &ControlParameters) -> f64 {
    let (multiply, divide) = parameters.gear(axis);
    least_increment(axis, parameters) * f64::from(divide) / f64::from(multiply)
}

/// Whether pulses count down towards positive coordinates (008.0 DIRX, 008.1 DIRZ).
pub(crate) fn is_motor_reversed(axis: Axis, parameters: &ControlParameters) -> bool {
    !parameters.counts_up(axis)
}

/// The highest speed of an axis with a gear that multiplies (CMR > CMD), mm/min. Above it
/// the control raises alarm 097 (manual III-12.4). `None`: the gear sets no limit.
pub fn gear_speed_limit(axis: Axis, parameters: &ControlParameters) -> Option<f64> {
    let (multiply, divide) = parameters.gear(axis);
    let base = match axis {
        Axis::X => 3800.0,
        Axis::Z => 7600.0,
    };
    (multiply > divide).then(|| base * f64::from(divide) / f64::from(multiply))
}

/// Converts the position of one axis to pulses.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Chain {
    /// Number of least output increments per mm.
    per_mm: f64,
    multiply: i64,
    divide: i64,
    reversed: bool,
    backlash: Backlash,
    pitch: PitchCurve,
    /// Machine coordinate at which the increments are zero, mm.
    origin: f64,
    /// Pulse count at the origin of the increments.
    base: i64,
    /// Sum of the corrections in force at the origin, increments.
    #[serde(rename = "without")]
    origin_correction: i64,
    /// Distance that machine lock has kept the slide from moving, mm.
    #[serde(rename = "locked_away")]
    locked_distance: f64,
    /// Commanded machine coordinate at the last tick, mm.
    commanded: f64,
    /// Distance from the origin at the last tick, increments.
    increments: i64,
    /// Pitch error correction at the last tick, increments.
    correction: i64,
}

impl Chain {
    fn new(axis: Axis, parameters: &ControlParameters, table: &PitchTable) -> Self {
        let (multiply, divide) = parameters.gear(axis);
        let least = least_increment(axis, parameters);
        let per_pulse = f64::from(divide) / f64::from(multiply);
        let per_thousandth = match axis {
            Axis::X if !parameters.is_radius_programming() => 2,
            Axis::X | Axis::Z => 1,
        };
        let mut new = Self {
            per_mm: 1.0 / least,
            multiply: multiply.into(),
            divide: divide.into(),
            reversed: is_motor_reversed(axis, parameters),
            backlash: Backlash::new(axis, parameters, 1.0 / least, per_pulse),
            pitch: PitchCurve::new(axis, parameters, table, per_thousandth),
            origin: 0.0,
            base: 0,
            origin_correction: 0,
            locked_distance: 0.0,
            commanded: 0.0,
            increments: 0,
            correction: 0,
        };
        new.correction = new.pitch_correction();
        new.origin_correction = new.correction;
        new
    }

    fn slide_position(&self) -> f64 {
        self.commanded - self.locked_distance
    }

    fn pitch_correction(&self) -> i64 {
        if self.pitch.is_off() {
            return 0;
        }
        self.pitch
            .correction_at(round_to_i64(self.slide_position() * self.per_mm))
    }

    /// The pulse count: the whole increments with their corrections, times the gear ratio.
    /// A remaining fraction of a pulse is added to the next increments.
    fn pulses(&self) -> i64 {
        let increments = self.increments + self.corrections() - self.origin_correction;
        let geared = match self.divide {
            // The most frequent case; the division is the slowest step here.
            1 => increments * self.multiply,
            divide => increments * self.multiply / divide,
        };
        self.base + if self.reversed { -geared } else { geared }
    }

    /// The position in fractional pulses, with the same corrections; the whole count
    /// changes halfway between two pulses. A remaining fraction of a pulse delays the
    /// change: the position is shifted by that fraction, and stretched around the origin.
    fn fine_pulses(&self) -> f64 {
        let increments = (self.slide_position() - self.origin) * self.per_mm;
        let increments = increments + (self.corrections() - self.origin_correction) as f64;
        let per_increment = self.multiply as f64 / self.divide as f64;
        let geared = increments * per_increment;
        let first = 1.0 - 0.5 * per_increment.min(1.0);
        let fine = if geared.abs() < first {
            geared * 0.5 / first
        } else {
            geared - (first - 0.5).copysign(geared)
        };
        self.base as f64 + if self.reversed { -fine } else { fine }
    }

    fn corrections(&self) -> i64 {
        self.correction + self.backlash.compensation()
    }

    fn advance(&mut self, commanded: f64, locked: bool) {
        let moved = commanded - self.commanded;
        self.commanded = commanded;
        if locked {
            // The slide stays on its pulse: even the rounding of the two sums must not make
            // one.
            self.locked_distance += moved;
            return;
        }
        let increments = round_to_i64((self.slide_position() - self.origin) * self.per_mm);
        self.backlash.tick(increments - self.increments);
        self.increments = increments;
        self.correction = self.pitch_correction();
    }

    /// Takes up the backlash before the axis moves by `distance`, mm.
    fn take_up_backlash(&mut self, distance: f64) {
        let increments = round_to_i64(distance * self.per_mm);
        self.backlash.tick(increments.signum());
    }

    /// Makes the position at a pulse count the machine zero. Returns the machine coordinate
    /// of the present position, mm.
    fn set_zero_at(&mut self, count: i64) -> f64 {
        let from_base = count - self.base;
        let from_base = if self.reversed { -from_base } else { from_base };
        let geared = from_base as f64 * self.divide as f64 / self.multiply as f64;
        // The same corrections were in force when the signal came.
        let increments = geared - (self.corrections() - self.origin_correction) as f64;
        self.commanded = self.slide_position() - (self.origin + increments / self.per_mm);
        self.origin = 0.0;
        self.base = count;
        self.locked_distance = 0.0;
        self.increments = round_to_i64(self.commanded * self.per_mm);
        self.correction = self.pitch_correction();
        // At zero no pitch error is compensated.
        self.origin_correction = self.backlash.compensation();
        self.commanded
    }

    /// Makes a pulse count the present position. Returns its machine coordinate, mm.
    fn set_count(&mut self, count: i64) -> f64 {
        let from_base = count - self.base;
        let from_base = if self.reversed { -from_base } else { from_base };
        // The first increment that makes this pulse.
        let increments = {
            let scaled = from_base.abs() * self.divide;
            let ceiled = (scaled + self.multiply - 1) / self.multiply;
            from_base.signum() * ceiled
        };
        // The correction depends on the position, and the position on the correction.
        for _ in 0..3 {
            self.increments = increments - self.corrections() + self.origin_correction;
            self.commanded = self.origin + self.increments as f64 / self.per_mm;
            self.locked_distance = 0.0;
            self.correction = self.pitch_correction();
        }
        self.base += count - self.pulses();
        self.commanded
    }

    fn preset(&mut self, commanded: f64) {
        // The origin moves along, so that the left-over fraction of a pulse is kept.
        self.origin += commanded - self.slide_position();
        self.commanded = commanded;
        self.locked_distance = 0.0;
        let correction = self.pitch_correction();
        self.origin_correction += correction - self.correction;
        self.correction = correction;
    }

    fn reconfigure(&mut self, changed: Self) {
        let mut new = Self {
            backlash: self.backlash.with_parameters(changed.backlash),
            base: self.pulses(),
            origin: self.slide_position(),
            commanded: self.commanded,
            locked_distance: self.locked_distance,
            increments: 0,
            ..changed
        };
        new.correction = new.pitch_correction();
        new.origin_correction = new.corrections();
        *self = new;
    }
}

/// Converts positions to pulses for both axes. The pulse count follows from the absolute
/// position and the direction of the last motion, never from a sum of steps: there is no
/// drift.
///
/// ```text
///  position ─► increments ─► + pitch error ─► + backlash ─► · CMR / CMD ─► direction ─► pulses
///    mm        0.0005/0.001  098–103, 013    034, 035      015–018        008
/// ```
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct AxisChain {
    chains: PerAxis<Chain>,
}

impl AxisChain {
    /// Creates a chain at machine coordinate zero and pulse count zero.
    pub fn new(parameters: &ControlParameters, table: &PitchTable) -> Self {
        let chain = |axis| Chain::new(axis, parameters, table);
        Self {
            chains: PerAxis::new(chain(Axis::X), chain(Axis::Z)),
        }
    }

    /// Moves the slides to the commanded position. Locked axes (machine lock) get no
    /// pulses. Call it once a tick.
    pub fn advance(&mut self, commanded: Point, locked: PerAxis<bool>) {
        self.chains.x.advance(commanded.x, locked.x);
        self.chains.z.advance(commanded.z, locked.z);
    }

    /// The commanded pulse count of each axis since power-on.
    #[inline]
    pub fn pulses(&self) -> PerAxis<Pulses> {
        PerAxis::new(
            Pulses(self.chains.x.pulses()),
            Pulses(self.chains.z.pulses()),
        )
    }

    /// The commanded position of each axis in fractional pulses. The whole count changes
    /// halfway between two pulses.
    pub fn fine_pulses(&self) -> PerAxis<f64> {
        PerAxis::new(self.chains.x.fine_pulses(), self.chains.z.fine_pulses())
    }

    /// Machine coordinates of the slides, mm: the commanded position without the distance
    /// that machine lock held back.
    pub fn slide_position(&self) -> Point {
        Point::new(
            self.chains.x.slide_position(),
            self.chains.z.slide_position(),
        )
    }

    /// Takes up the backlash for a coming motion by `distance` (mm) while the axes stand
    /// still.
    pub(crate) fn take_up_backlash(&mut self, distance: Point) {
        self.chains.x.take_up_backlash(distance.x);
        self.chains.z.take_up_backlash(distance.z);
    }

    /// Whether the compensation of backlash is still changing on an axis.
    pub fn is_settling(&self) -> bool {
        !(self.chains.x.backlash.is_settled() && self.chains.z.backlash.is_settled())
    }

    /// Gives the present position of an axis another machine coordinate, mm (X as a
    /// radius), without a pulse. Used at the reference point, at power-on and at the end of
    /// machine lock.
    pub fn preset(&mut self, axis: Axis, coordinate: f64) {
        self.chains.get_mut(axis).preset(coordinate);
    }

    /// Makes the position at a pulse count (where the zero signal came) the machine zero of
    /// an axis. Returns the machine coordinate of the present position, mm.
    pub(crate) fn set_zero_at(&mut self, axis: Axis, count: Pulses) -> f64 {
        self.chains.get_mut(axis).set_zero_at(count.0)
    }

    /// Makes the pulse count at which an axis was stopped its present position. Returns its
    /// machine coordinate, mm.
    pub fn set_count(&mut self, axis: Axis, count: Pulses) -> f64 {
        self.chains.get_mut(axis).set_count(count.0)
    }

    /// Applies changed parameters (001.2, 003.5, 006, 008, 010, 011, 013, 015–018, 034,
    /// 035, 090–103) and pitch errors at a standstill, without a pulse.
    pub(crate) fn reconfigure(&mut self, parameters: &ControlParameters, table: &PitchTable) {
        for axis in [Axis::X, Axis::Z] {
            let changed = Chain::new(axis, parameters, table);
            self.chains.get_mut(axis).reconfigure(changed);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::units::round;
    use proptest::prelude::*;

    fn geared(multiply: i32, divide: i32) -> Chain {
        let mut parameters = ControlParameters::default();
        parameters.set(16, multiply).unwrap();
        parameters.set(18, divide).unwrap();
        Chain::new(Axis::Z, &parameters, &PitchTable::default())
    }

    /// Parameters and table: backlash of 0.1 mm, +7 and -6 µm at points 1 and 2, every 10
    /// mm.
    fn corrected() -> (ControlParameters, PitchTable) {
        let mut parameters = ControlParameters::default();
        parameters.set(35, 100).unwrap();
        let mut table = PitchTable::default();
        table.set(Axis::Z, 1, 7).unwrap();
        table.set(Axis::Z, 2, -6).unwrap();
        (parameters, table)
    }

    fn settle_at(chain: &mut Chain, at: f64) -> i64 {
        for _ in 0..100 {
            chain.advance(at, false);
        }
        chain.pulses()
    }

    #[test]
    fn backlash_and_pitch_errors_add_up() {
        let (parameters, table) = corrected();
        let mut chain = Chain::new(Axis::Z, &parameters, &table);
        assert_eq!(settle_at(&mut chain, 5.0), 5000);
        assert_eq!(settle_at(&mut chain, 15.0), 15_007);
        assert_eq!(settle_at(&mut chain, 25.0), 25_001);
        assert_eq!(settle_at(&mut chain, 15.0), 14_907);
        assert_eq!(settle_at(&mut chain, -5.0), -5100);
        assert_eq!(settle_at(&mut chain, 15.0), 15_007);
    }

    #[test]
    fn backlash_can_be_taken_up_before_the_motion() {
        let (parameters, table) = corrected();
        let mut axes = AxisChain::new(&parameters, &table);
        let still = PerAxis::default();
        axes.advance(Point::new(0.0, 5.0), still);
        axes.take_up_backlash(Point::new(0.0, -3.0));
        assert!(axes.is_settling());
        while axes.is_settling() {
            axes.advance(Point::new(0.0, 5.0), still);
        }
        let sign = axes.pulses().z.0.signum();
        assert_eq!(axes.pulses().z.0 * sign, 4900);
        axes.advance(Point::new(0.0, 2.0), still);
        assert_eq!(axes.pulses().z.0 * sign, 1900);
    }

    #[test]
    fn a_preset_keeps_corrections_out_of_the_pulses() {
        let (parameters, table) = corrected();
        let mut chain = Chain::new(Axis::Z, &parameters, &table);
        settle_at(&mut chain, 15.0);
        chain.preset(-3.0);
        assert_eq!(chain.pulses(), 15_007);
        assert_eq!(settle_at(&mut chain, 12.0), 30_014);
    }

    #[test]
    fn changed_parameters_give_no_pulse_and_act_from_there() {
        let (mut parameters, table) = corrected();
        let mut chain = Chain::new(Axis::Z, &parameters, &table);
        settle_at(&mut chain, 15.0);
        let before = settle_at(&mut chain, 12.0);
        assert_eq!(before, 11_907);
        parameters.set(35, 40).unwrap();
        parameters.set(16, 2).unwrap();
        chain.reconfigure(Chain::new(Axis::Z, &parameters, &table));
        assert_eq!(settle_at(&mut chain, 12.0), before);
        assert_eq!(settle_at(&mut chain, 11.0), before - 2000);
        // 1 mm back and 0.04 mm of backlash, two pulses each.
        assert_eq!(settle_at(&mut chain, 12.0), before + 80);
    }

    #[test]
    fn machine_lock_gives_no_backlash() {
        let (parameters, table) = corrected();
        let mut chain = Chain::new(Axis::Z, &parameters, &table);
        settle_at(&mut chain, 15.0);
        for step in 1..100 {
            chain.advance(15.0 - f64::from(step) * 0.1, true);
        }
        assert_eq!(chain.pulses(), 15_007);
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
    fn the_count_is_the_rounded_fine_position() {
        for (multiply, divide) in [(1, 1), (1, 5), (3, 7)] {
            for reversed in [false, true] {
                let mut chain = Chain {
                    reversed,
                    base: 7,
                    ..geared(multiply, divide)
                };
                for step in -4000..4000 {
                    chain.advance(f64::from(step) * 0.000_07 + 0.000_003, false);
                    let (count, fine) = (chain.pulses(), chain.fine_pulses());
                    // Other gear ratios change the count up to an increment later.
                    let tolerance = if multiply == 3 { 0.95 } else { 0.500_001 };
                    assert!(
                        (fine - count as f64).abs() <= tolerance,
                        "{step}: {fine} {count}"
                    );
                }
            }
        }
    }

    #[test]
    fn machine_lock_keeps_the_slide_where_it_is() {
        let mut chain = geared(1, 1);
        chain.advance(1.0, false);
        chain.advance(3.0, true);
        assert_eq!((chain.pulses(), chain.slide_position()), (1000, 1.0));
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
    fn the_count_of_a_stopped_axis_is_taken_over() {
        for (multiply, divide) in [(1, 1), (3, 7), (1, 5), (7, 3), (127, 1)] {
            for reversed in [false, true] {
                let mut chain = Chain {
                    reversed,
                    ..geared(multiply, divide)
                };
                let weight = 0.001 * divide as f64 / multiply as f64;
                let sign = if reversed { -1.0 } else { 1.0 };
                chain.advance(40.0, false);
                for count in [-3001, -7, 0, 1, 250, 4999] {
                    let at = chain.set_count(count);
                    assert_eq!(chain.pulses(), count);
                    let off = (at - sign * count as f64 * weight).abs();
                    assert!(off < 0.001 + 2.0 * weight, "{count}: {off}");
                    // Staying there makes no pulse.
                    chain.advance(at, false);
                    assert_eq!(chain.pulses(), count);
                }
            }
        }
    }

    #[test]
    fn the_zero_is_the_pulse_of_the_signal_with_any_gear() {
        for (multiply, divide) in [(1, 1), (3, 7), (1, 5), (127, 1)] {
            for reversed in [false, true] {
                let mut chain = Chain {
                    reversed,
                    ..geared(multiply, divide)
                };
                chain.advance(12.3456, false);
                let count = chain.pulses() - 3;
                let here = chain.set_zero_at(count);
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
    fn presets_between_increments_do_not_drift() {
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
        fn whole_numbers_are_those_of_the_standard_library(
            (bits, halves) in (any::<u64>(), any::<i64>().prop_flat_map(|it| (Just(it), 0..64_u32)))
        ) {
            let half = (halves.0 >> halves.1) as f64 / 2.0;
            for value in [f64::from_bits(bits), half.next_down(), half, half.next_up()] {
                prop_assert_eq!(round_to_i64(value), value.round() as i64, "{}", value);
                let (quick, long) = (round(value), value.round());
                prop_assert!(quick.to_bits() == long.to_bits() || value.is_nan(), "{}", value);
            }
        }

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
