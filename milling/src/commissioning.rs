//! Computes commissioning values of a GSK980MDi: the electronic gear (015, 016), the rate of
//! backlash compensation (010), and pitch error compensation (3620 to 3624).

use std::collections::BTreeMap;

use gsk_messages::{Message, say};

use crate::space::Length;

/// An electronic gear: command multiplier (CMR) over command divider (CMD).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ElectronicGear {
    /// The command multiplier, parameter 015.
    pub multiplier: u32,
    /// The command divider, parameter 016.
    pub divider: u32,
}

/// The greatest multiplier and the greatest divider of the electronic gear.
const GREATEST: u64 = 32_767;

/// Numbers of teeth of the gear wheels between motor and screw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Teeth {
    /// Number of teeth of the wheel on the screw, or on the table.
    pub screw: u32,
    /// Number of teeth of the wheel on the motor.
    pub motor: u32,
}

fn greatest_divisor(a: u64, b: u64) -> u64 {
    if b == 0 {
        a
    } else {
        greatest_divisor(b, a % b)
    }
}

fn gear(multiplier: u64, divider: u64) -> Result<ElectronicGear, Message> {
    let common = greatest_divisor(multiplier, divider).max(1);
    let (multiplier, divider) = (multiplier / common, divider / common);
    let fits = |value: u64| {
        u32::try_from(value)
            .ok()
            .filter(|_| (1..=GREATEST).contains(&value))
    };
    match (fits(multiplier), fits(divider)) {
        (Some(multiplier), Some(divider)) => Ok(ElectronicGear {
            multiplier,
            divider,
        }),
        _ => Err(say::mill_gear_too_great(multiplier, divider, GREATEST)),
    }
}

/// Returns the electronic gear of a linear axis. `counts`: encoder counts per turn.
/// `increment`: output increment. `lead`: lead of the screw.
///
/// # Errors
///
/// Returns a message if a value is 0 or the gear is beyond 32767.
pub fn linear_gear(
    counts: u32,
    increment: Length,
    lead: Length,
    teeth: Teeth,
) -> Result<ElectronicGear, Message> {
    let nm = |length: Length| u64::try_from(length.nm()).unwrap_or(0);
    let multiplier = u64::from(counts) * u64::from(teeth.screw);
    let multiplier = multiplier.checked_mul(nm(increment));
    let divider = nm(lead).checked_mul(teeth.motor.into());
    match (multiplier, divider) {
        (Some(multiplier @ 1..), Some(divider @ 1..)) => gear(multiplier, divider),
        _ => Err(say::mill_gear_of_nothing()),
    }
}

/// Returns the electronic gear of a rotary axis or a spindle. `counts`: encoder counts per
/// turn of the motor. `pulses`: pulses per turn of the axis.
///
/// # Errors
///
/// Returns a message if a value is 0 or the gear is beyond 32767.
pub fn rotary_gear(counts: u32, pulses: u32, teeth: Teeth) -> Result<ElectronicGear, Message> {
    let multiplier = u64::from(counts) * u64::from(teeth.screw);
    let divider = u64::from(pulses) * u64::from(teeth.motor);
    if multiplier == 0 || divider == 0 {
        return Err(say::mill_gear_of_nothing());
    }
    gear(multiplier, divider)
}

/// Returns the rate of backlash compensation in mode A (011.7 = 0), pulses/s. Parameter 010
/// counts thousands. `an_eighth` (011.6) reduces the rate to an eighth.
pub const fn backlash_rate(parameter_010: u8, an_eighth: bool) -> u32 {
    let rate = parameter_010 as u32 * 1000;
    if an_eighth { rate / 8 } else { rate }
}

/// The pitch error table of an axis, as parameters and interval errors.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct MillPitchTable {
    /// Number of the interval at the reference point (parameter 3620).
    origin: i64,
    /// Length of an interval (parameter 3624), 0.001 mm.
    interval: i64,
    /// Least and greatest number of the intervals whose errors are compensated (parameters 3621,
    /// 3622).
    window: (i64, i64),
    /// Error of each interval by its number N, 0.001 mm: between `(N − 1 − origin)` and
    /// `(N − origin)` intervals.
    values: BTreeMap<i64, i64>,
}

/// Ranges of the table's numbers, and in 0.001 mm of its errors and of its interval.
const NUMBERS: core::ops::RangeInclusive<i64> = 0..=1023;
const VALUES: core::ops::RangeInclusive<i64> = -2550..=2550;
const INTERVALS: core::ops::RangeInclusive<i64> = 1000..=999_999;

impl MillPitchTable {
    /// Creates a table. `origin` is the number at the reference point (3620). Only values with
    /// numbers from `least` (3621) to `most` (3622) act. `interval` and values are in 0.001
    /// mm.
    ///
    /// # Errors
    ///
    /// Returns a message if a number, a value or the interval is out of range.
    pub fn new(
        origin: i64,
        interval: i64,
        (least, most): (i64, i64),
        values: &[(i64, i64)],
    ) -> Result<Self, Message> {
        if !NUMBERS.contains(&origin) || !NUMBERS.contains(&least) || !NUMBERS.contains(&most) {
            return Err(say::mill_pitch_number());
        }
        if !INTERVALS.contains(&interval) {
            return Err(say::mill_pitch_interval(interval));
        }
        if let Some((number, value)) = values
            .iter()
            .find(|(number, value)| !NUMBERS.contains(number) || !VALUES.contains(value))
        {
            return Err(say::mill_pitch_value(*number, *value));
        }
        let inside = values.iter().copied();
        let inside = inside.filter(|(number, _)| (least..=most).contains(number));
        Ok(Self {
            origin,
            interval,
            window: (least, most),
            values: inside.collect(),
        })
    }

    /// Returns whether positions on the negative side of the reference point are compensated.
    /// If the reference point is the least number of the table, its value has no interval: the
    /// interval below it is outside the table (part on installation, 6.6).
    pub const fn has_negative_side(&self) -> bool {
        self.origin > self.window.0
    }

    /// Returns the number of the interval that ends at a position, seen from the reference
    /// point; `None` if no interval ends there. `position` is in 0.001 mm.
    pub const fn number_at(&self, position: i64) -> Option<i64> {
        if position % self.interval != 0 || (position < 0 && !self.has_negative_side()) {
            return None;
        }
        match position / self.interval {
            0 => None,
            beyond @ 1.. => Some(self.origin + beyond),
            before => Some(self.origin + before + 1),
        }
    }

    /// Adds `value`, 0.001 mm, to the error of a number.
    ///
    /// # Errors
    ///
    /// Returns a message if the number is outside 3621 to 3622 or the sum is out of range.
    pub fn add(&mut self, number: i64, value: i64) -> Result<(), Message> {
        let (least, most) = self.window;
        if !(least..=most).contains(&number) {
            return Err(say::mill_pitch_window(number, least, most));
        }
        let sum = self.value(number).saturating_add(value);
        if !VALUES.contains(&sum) {
            return Err(say::mill_pitch_value(number, sum));
        }
        self.values.insert(number, sum);
        Ok(())
    }

    /// Returns number and error (0.001 mm) of the errors other than 0, by ascending number.
    pub fn values(&self) -> impl Iterator<Item = (i64, i64)> {
        let values = self.values.iter().map(|(number, value)| (*number, *value));
        values.filter(|(_, value)| *value != 0)
    }

    /// Returns the end of a number's interval that is farther from the reference point, 0.001
    /// mm from that point.
    pub fn end_of(&self, number: i64) -> i64 {
        let beyond = i64::from(number > self.origin);
        (number - 1 + beyond - self.origin) * self.interval
    }

    fn value(&self, number: i64) -> i64 {
        self.values.get(&number).copied().unwrap_or(0)
    }

    /// Returns the commanded position at which the axis really reaches `position`. Both are in
    /// 0.001 mm from the reference point. Within an interval the error is interpolated.
    pub fn commanded(&self, position: i64) -> i64 {
        if position < 0 && !self.has_negative_side() {
            return position;
        }
        let whole = position.abs() / self.interval;
        let rest = position.abs() % self.interval;
        let (first, sign) = if position < 0 {
            (self.origin, -1)
        } else {
            (self.origin + 1, 1)
        };
        let number = |count: i64| first + sign * count;
        let errors: i64 = (0..whole.min(1024))
            .map(|count| self.value(number(count)))
            .sum();
        let share = self.value(number(whole)) * rest;
        let half = self.interval / 2 * share.signum();
        position + sign * (errors + (share + half) / self.interval)
    }

    /// Returns the number at the positive end of a rotary axis's turn. `turn` is in 0.001
    /// degrees (1260).
    ///
    /// # Errors
    ///
    /// Returns a message if the turn is not a multiple of the interval, if the errors of a turn
    /// do not add up to 0, or if those at both ends differ.
    pub fn end_of_turn(&self, turn: i64) -> Result<i64, Message> {
        if turn <= 0 || turn % self.interval != 0 {
            return Err(say::mill_pitch_turn(turn, self.interval));
        }
        let end = self.origin + turn / self.interval;
        if !NUMBERS.contains(&end) {
            return Err(say::mill_pitch_number());
        }
        let sum: i64 = (self.origin + 1..=end)
            .map(|number| self.value(number))
            .sum();
        if sum != 0 {
            return Err(say::mill_pitch_sum(sum));
        }
        if self.value(self.origin) != self.value(end) {
            return Err(say::mill_pitch_ends(self.origin, end));
        }
        Ok(end)
    }

    /// Returns the text that the page shows in place of a number: the far end of its interval,
    /// in whole millimetres.
    pub fn label(&self, number: i64) -> String {
        let position = self.end_of(number) / 1000;
        if position < 0 {
            format!("-{:03}", -position)
        } else {
            format!("{position:04}")
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DIRECT: Teeth = Teeth { screw: 1, motor: 1 };

    fn table(
        origin: i64,
        interval: i64,
        window: (i64, i64),
        values: &[(i64, i64)],
    ) -> MillPitchTable {
        MillPitchTable::new(origin, interval, window, values).expect("a table")
    }

    /// Facts C34 and C35 of `tests/model-facts.tsv`.
    #[test]
    fn gears_of_the_manual() {
        let found = linear_gear(
            131_072,
            Length::from_mm(0.001),
            Length::from_mm(4.0),
            DIRECT,
        );
        assert_eq!(found.map(|it| (it.multiplier, it.divider)), Ok((4096, 125)));
        let found = rotary_gear(4096, 1000, DIRECT);
        assert_eq!(found.map(|it| (it.multiplier, it.divider)), Ok((512, 125)));
        let teeth = Teeth { screw: 3, motor: 2 };
        let found = rotary_gear(4096, 1000, teeth);
        assert_eq!(found.map(|it| (it.multiplier, it.divider)), Ok((768, 125)));
        assert!(rotary_gear(4097, 1, Teeth { screw: 9, motor: 1 }).is_err());
        assert!(rotary_gear(0, 1000, DIRECT).is_err());
    }

    /// Fact C40 of `tests/model-facts.tsv`.
    #[test]
    fn backlash_pulses_by_parameter() {
        assert_eq!(backlash_rate(0b0000_1010, false), 10_000);
        assert_eq!(backlash_rate(0b0000_1010, true), 1250);
        assert_eq!(backlash_rate(255, false), 255_000);
    }

    /// Facts C36 to C38 of `tests/model-facts.tsv`.
    #[test]
    fn pulses_of_the_examples() {
        let one = table(0, 10_000, (0, 199), &[(1, 7), (2, -6), (3, 4)]);
        let found = [10_000, 20_000, 30_000].map(|at| one.commanded(at));
        assert_eq!(found, [10_007, 20_001, 30_005]);
        let values = [(58, -7), (59, -7), (60, 6), (61, 4)];
        let two = table(60, 10_000, (0, 127), &values);
        let found = [-30_000, -20_000, -10_000, 0, 10_000].map(|at| two.commanded(at));
        assert_eq!(found, [-29_992, -19_999, -10_006, 0, 10_004]);
        let values = [(255, 2), (254, 0), (253, -7), (252, 3)];
        let three = table(255, 10_000, (0, 255), &values);
        let found = [-10_000, -20_000, -30_000, -40_000].map(|at| three.commanded(at));
        assert_eq!(found, [-10_002, -20_002, -29_995, -39_998]);
        // If the reference point is the least number, its value acts nowhere.
        let one = table(0, 10_000, (0, 199), &[(0, 9), (1, 7), (2, -6), (3, 4)]);
        let found = [-10_000, -5000, 0, 10_000].map(|at| one.commanded(at));
        assert_eq!(found, [-10_000, -5000, 0, 10_007]);
        assert_eq!(
            (one.number_at(-10_000), one.number_at(10_000)),
            (None, Some(1))
        );
        // Half the interval has half the error: 3.5 is rounded away from zero.
        assert_eq!(one.commanded(5000), 5004);
    }

    #[test]
    fn values_are_added_by_their_positions() {
        let mut five = table(60, 10_000, (50, 70), &[(61, 4)]);
        let found = [10_000, 20_000, -10_000, -20_000].map(|at| five.number_at(at));
        assert_eq!(found, [Some(61), Some(62), Some(60), Some(59)]);
        assert_eq!((five.number_at(0), five.number_at(5000)), (None, None));
        for number in [59, 60, 61, 62] {
            assert_eq!(five.number_at(five.end_of(number)), Some(number));
        }
        assert_eq!(five.add(61, -1), Ok(()));
        assert_eq!(five.add(59, 7), Ok(()));
        assert_eq!(five.values().collect::<Vec<_>>(), [(59, 7), (61, 3)]);
        assert!(five.add(71, 1).is_err() && five.add(61, 2548).is_err());
    }

    /// Fact C39 of `tests/model-facts.tsv`.
    #[test]
    fn a_turn_comes_out_even() {
        let errors = [1, -2, 1, 3, -1, -1, -3, 2, 1];
        let values: Vec<(i64, i64)> = (60..).zip(errors).collect();
        let mut four = table(60, 45_000, (50, 100), &values);
        assert_eq!(four.end_of_turn(360_000), Ok(68));
        four.values.insert(64, 0);
        assert!(four.end_of_turn(360_000).is_err());
        assert!(four.end_of_turn(100_000).is_err());
        assert!(four.end_of_turn(45_000_000_000).is_err());
    }

    /// Fact C41 of `tests/model-facts.tsv`.
    #[test]
    fn numbers_become_positions() {
        let five = table(100, 20_000, (0, 1023), &[]);
        let labels: Vec<String> = (94..=101).map(|number| five.label(number)).collect();
        assert_eq!(
            labels,
            [
                "-140", "-120", "-100", "-080", "-060", "-040", "-020", "0020"
            ]
        );
    }
}
