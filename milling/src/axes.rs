//! Reads which axes a machine has besides X, Y and Z, with their names and units: parameters
//! 1010, 1020, 187, 188, 1026, 1027 and 1260. 001.1, 004.0 and 187 give the least increments.

use gsk_core::compensation::{CompensationSettings, StartUpType};
use gsk_core::units::Point;

use crate::memory::{MillMemory, parameter};
use crate::space::{Length, MillAxis, MillPosition, Plane, PlanePoint};

/// A fourth or fifth axis of a mill, besides X, Y and Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FurtherAxis {
    /// The axis's address in programs: A, B or C.
    pub letter: char,
    /// Whether the axis is rotary and counts in degrees. A linear axis counts in mm.
    pub rotary: bool,
    /// The turn after which the axis's coordinates restart at 0 (rotary A with 188.0); `None`
    /// if they do not restart.
    turn: Option<Length>,
    /// Whether the sign of an absolute word selects the direction (188.1). Otherwise the axis
    /// takes the shorter one.
    by_sign: bool,
}

/// The least increments of the axes (001.1, 004.0, 187).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct LeastIncrements {
    /// Least increment of each axis in metric words, nm or millionths of a degree.
    metric: [u16; 5],
    /// Whether the machine is an inch machine, so that computed points are in inch increments.
    inch_machine: bool,
}

impl Default for LeastIncrements {
    fn default() -> Self {
        Self {
            metric: [IS_B; 5],
            inch_machine: false,
        }
    }
}

/// Least increments of IS-A, IS-B and IS-C: 0.01, 0.001 and 0.0001 mm or degrees, in nm.
const IS_A: u16 = 10_000;
const IS_B: u16 = 1000;
const IS_C: u16 = 100;

impl LeastIncrements {
    fn from_memory(memory: &MillMemory) -> Self {
        let basic = if memory.is_fine() { IS_C } else { IS_B };
        let increment = |axis: MillAxis| {
            let bit = |bit| memory.bit(parameter::axis_parameter(parameter::KIND, axis), bit);
            match (MillAxis::FURTHER.contains(&axis), bit(7), bit(6)) {
                (true, false, true) => IS_A,
                (true, true, false) => IS_B,
                (true, true, true) => IS_C,
                _ => basic,
            }
        };
        Self {
            metric: MillAxis::ALL.map(increment),
            inch_machine: memory.is_inch_machine(),
        }
    }

    /// Returns the least increment of an axis in inches or in mm and degrees, nm. That of an
    /// inch system is a tenth of the metric one, counted in inches.
    fn nm(&self, axis: MillAxis, inch: bool) -> i64 {
        let metric = i64::from(self.metric[axis as usize]);
        if inch { metric * 254 / 100 } else { metric }
    }
}

/// The fourth and the fifth axis of a machine, `None` for one that it does not have, and the
/// least increments of all its axes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Axes {
    further: [Option<FurtherAxis>; 2],
    increments: LeastIncrements,
}

impl Axes {
    /// Reads the axes of a machine from its parameters. An axis that follows X, Y or Z (1026,
    /// 1027) has no words and is left out.
    pub fn from_memory(memory: &MillMemory) -> Self {
        let count = memory.value(parameter::AXES);
        let follows = [parameter::FOURTH_FOLLOWS, parameter::FIFTH_FOLLOWS];
        let mut axes = Self {
            increments: LeastIncrements::from_memory(memory),
            ..Self::default()
        };
        for (index, axis) in MillAxis::FURTHER.into_iter().enumerate() {
            let there = count > 3 + index as i32 && memory.value(follows[index]) == 0;
            let own = |number| parameter::axis_parameter(number, axis);
            let letter = u8::try_from(memory.value(own(parameter::NAME))).unwrap_or(b'A');
            let letter = char::from(letter);
            // If both axes have the same name, the word moves the fourth.
            let named = axes.axis(letter).is_none();
            if !there || !named {
                continue;
            }
            let kind = |bit| memory.bit(own(parameter::KIND), bit);
            let rolls = |bit| memory.bit(own(parameter::ROLLOVER), bit);
            let (rotary, counts_on) = (kind(0), kind(1));
            let turn = memory.angle(own(parameter::TURN)).abs();
            let turn = (rotary && !counts_on && rolls(0) && turn > Length::ZERO).then_some(turn);
            axes.further[index] = Some(FurtherAxis {
                letter,
                rotary,
                turn,
                by_sign: rolls(1),
            });
        }
        axes
    }

    /// Returns the fourth or fifth axis of the machine. Returns `None` for X, Y, Z and axes
    /// that it does not have.
    pub const fn further(&self, axis: MillAxis) -> Option<FurtherAxis> {
        match axis {
            MillAxis::Fourth => self.further[0],
            MillAxis::Fifth => self.further[1],
            _ => None,
        }
    }

    /// Returns the fourth and fifth axis that the machine has, in this order.
    pub fn all_further(&self) -> impl Iterator<Item = (MillAxis, FurtherAxis)> + use<> {
        let axes = *self;
        let axis = move |axis| Some((axis, axes.further(axis)?));
        MillAxis::FURTHER.into_iter().filter_map(axis)
    }

    /// Returns all axes that the machine has, X first.
    pub(crate) fn all(&self) -> impl Iterator<Item = MillAxis> + use<> {
        let further = self.all_further().map(|(axis, _)| axis);
        MillAxis::BASIC.into_iter().chain(further)
    }

    /// Returns the address of an axis; `?` for one that the machine does not have.
    pub(crate) fn letter(&self, axis: MillAxis) -> char {
        match axis {
            MillAxis::X => 'X',
            MillAxis::Y => 'Y',
            MillAxis::Z => 'Z',
            MillAxis::Fourth | MillAxis::Fifth => self.further(axis).map_or('?', |it| it.letter),
        }
    }

    /// Returns the fourth or fifth axis that has this address; `None` if the machine has none.
    pub(crate) fn axis(&self, letter: char) -> Option<MillAxis> {
        let mut all = self.all_further();
        all.find_map(|(axis, it)| (it.letter == letter).then_some(axis))
    }

    /// Returns whether an axis is rotary and counts in degrees.
    pub(crate) fn is_rotary(&self, axis: MillAxis) -> bool {
        self.further(axis).is_some_and(|it| it.rotary)
    }

    /// Returns whether a word of any axis has increments of 0.0001 mm or degrees.
    pub(crate) fn have_fine_words(&self) -> bool {
        self.all()
            .any(|axis| self.increments.nm(axis, false) == i64::from(IS_C))
    }

    /// Returns the value of a word of an axis, rounded to its least increment. `inch`: the word
    /// was in inches.
    pub(crate) fn rounded_word(&self, axis: MillAxis, value: Length, inch: bool) -> Length {
        value.rounded_to(self.increments.nm(axis, inch))
    }

    /// Returns a computed position of an axis, rounded to the least increment of the machine.
    pub(crate) fn rounded(&self, axis: MillAxis, value: Length) -> Length {
        let inch = self.increments.inch_machine && !self.is_rotary(axis);
        value.rounded_to(self.increments.nm(axis, inch))
    }

    /// Returns the point with its coordinates in a plane replaced by `flat`, rounded to the
    /// least increment.
    pub(crate) fn moved_to(
        &self,
        mut point: MillPosition,
        plane: Plane,
        flat: PlanePoint,
    ) -> MillPosition {
        let [first, second, _] = plane.axes();
        point.set(first, self.rounded(first, Length::from_mm(flat.first)));
        point.set(second, self.rounded(second, Length::from_mm(flat.second)));
        point
    }

    /// Returns the settings of the cutter compensation: start-up type (002.6), angle at which
    /// two lines count as straight or opposite (5012) and least increment.
    pub(crate) fn compensation(&self, memory: &MillMemory) -> CompensationSettings {
        let start_up = match memory.bit(parameter::TOOLS, 6) {
            true => StartUpType::B,
            false => StartUpType::A,
        };
        let inch = self.increments.inch_machine;
        let per_mm = 1e6 / self.increments.nm(MillAxis::X, inch) as f64;
        let increments = Point {
            x: per_mm,
            z: per_mm,
        };
        CompensationSettings::with_angle(start_up, memory.straight_degrees(), increments)
    }

    /// Returns whether the coordinates of an axis restart at 0 after a turn.
    pub(crate) fn rolls_over(&self, axis: MillAxis) -> bool {
        self.turn(axis).is_some()
    }

    fn turn(&self, axis: MillAxis) -> Option<Length> {
        self.further(axis)?.turn
    }

    /// Returns the point with the coordinates of axes that restart wrapped into one turn, from
    /// 0.
    #[must_use]
    pub(crate) fn wrapped(&self, mut point: MillPosition) -> MillPosition {
        for axis in MillAxis::FURTHER {
            if let Some(turn) = self.turn(axis) {
                point.set(axis, wrap_into_turn(point.get(axis), turn));
            }
        }
        point
    }

    /// Returns where a move of `axis` from `from` to the absolute word `to` ends. The end may
    /// be outside of one turn.
    pub(crate) fn towards(&self, axis: MillAxis, from: Length, to: Length) -> Length {
        match self.further(axis) {
            Some(FurtherAxis {
                turn: Some(turn),
                by_sign: true,
                ..
            }) => {
                let ahead = wrap_into_turn(to.abs() - from, turn);
                let back = to < Length::ZERO && ahead != Length::ZERO;
                from + if back { ahead - turn } else { ahead }
            }
            _ => self.nearest(axis, from, to),
        }
    }

    /// Returns where the move ends if the axis takes the shorter direction to `to`. Plus wins
    /// if both are equal.
    pub(crate) fn nearest(&self, axis: MillAxis, from: Length, to: Length) -> Length {
        let Some(turn) = self.turn(axis) else {
            return to;
        };
        let ahead = wrap_into_turn(to - from, turn);
        from + if ahead + ahead > turn {
            ahead - turn
        } else {
            ahead
        }
    }
}

/// Returns the value reduced to one turn: from 0 to below `turn`.
const fn wrap_into_turn(value: Length, turn: Length) -> Length {
    Length::from_nm(value.nm().rem_euclid(turn.nm()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn machine(parameters: &[(u16, i32)]) -> Axes {
        let mut memory = MillMemory::default();
        for (number, value) in parameters {
            assert_eq!(memory.model.set_parameter(*number, *value), Ok(()));
        }
        Axes::from_memory(&memory)
    }

    #[test]
    fn axes_are_those_of_the_parameters() {
        let names = |axes: Axes| axes.all_further().map(|(_, it)| it.letter).collect();
        let found: Vec<String> = [
            machine(&[]),
            machine(&[(1010, 4)]),
            machine(&[(1010, 5)]),
            machine(&[(1010, 5), (1026, 2)]),
            machine(&[(1010, 5), (51_020, 65)]),
        ]
        .map(names)
        .into();
        assert_eq!(found, ["", "A", "AC", "C", "A"]);
        // Bit 1 of 187 alone has no meaning.
        let kinds = [0, 1, 2, 3].map(|kind| machine(&[(1010, 4), (40_187, kind)]));
        let turns = kinds.map(|axes| axes.is_rotary(MillAxis::Fourth));
        assert_eq!(turns, [false, true, false, true]);
    }

    #[test]
    fn an_axis_reaches_its_word_in_either_direction() {
        let shorter = machine(&[(1010, 4), (40_188, 1), (41_260, 90_000)]);
        let by_sign = machine(&[(1010, 4), (40_188, 3), (41_260, 90_000)]);
        let turn = Length::from_mm(90.0);
        for from in (0..90).map(|it| Length::from_mm(it.into())) {
            for to in (-200..200).map(|it| Length::from_mm(it.into())) {
                let distance = |axes: Axes| axes.towards(MillAxis::Fourth, from, to) - from;
                let reaches = |distance: Length, to| {
                    wrap_into_turn(from + distance, turn) == wrap_into_turn(to, turn)
                };
                let least = distance(shorter);
                assert!(reaches(least, to) && least.abs() + least.abs() <= turn);
                let signed = distance(by_sign);
                assert!(reaches(signed, to.abs()) && signed.abs() < turn);
                let sense =
                    signed == Length::ZERO || (signed < Length::ZERO) == (to < Length::ZERO);
                assert!(sense, "{from:?} {to:?}");
            }
        }
    }
}
