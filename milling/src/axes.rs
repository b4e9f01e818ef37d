//! Reads which axes a machine has besides X, Y and Z, with their names and units: parameters
//! 1010, 1020, 187, 188, 1026, 1027 and 1260.

use crate::memory::{MillMemory, parameter};
use crate::space::{Length, MillAxis, MillPosition};

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

/// The fourth and the fifth axis of a machine; `None` for one that it does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Axes([Option<FurtherAxis>; 2]);

impl Axes {
    /// Reads the axes of a machine from its parameters. An axis that follows X, Y or Z (1026,
    /// 1027) has no words and is left out.
    pub fn from_memory(memory: &MillMemory) -> Self {
        let count = memory.value(parameter::AXES);
        let follows = [parameter::FOURTH_FOLLOWS, parameter::FIFTH_FOLLOWS];
        let mut axes = Self::default();
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
            let turn = memory.length(own(parameter::TURN)).abs();
            let turn = (rotary && !counts_on && rolls(0) && turn > Length::ZERO).then_some(turn);
            axes.0[index] = Some(FurtherAxis {
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
            MillAxis::Fourth => self.0[0],
            MillAxis::Fifth => self.0[1],
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
