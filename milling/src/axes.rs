//! Which axes a machine has besides X, Y and Z, what they are called and how they count:
//! parameters 1010, 1020, 187, 188, 1026, 1027 and 1260.

use crate::memory::{MillMemory, parameter};
use crate::space::{Axis, Length, Position};

/// An axis besides X, Y and Z.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Further {
    /// Its address: A, B or C.
    pub letter: char,
    /// It turns and counts in degrees; else it is a slide and counts in mm.
    pub rotary: bool,
    /// A turn, after which its coordinates begin anew (rotary A with 188.0).
    turn: Option<Length>,
    /// The sign of an absolute word says which way round (188.1), else it is the shorter one.
    by_sign: bool,
}

/// The axes besides X, Y and Z: the fourth and the fifth, where the machine has them.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Axes([Option<Further>; 2]);

impl Axes {
    /// Those of a machine. One that runs with X, Y or Z (1026, 1027) has no words of its own.
    pub fn of(memory: &MillMemory) -> Self {
        let count = memory.value(parameter::AXES);
        let follows = [parameter::FOURTH_FOLLOWS, parameter::FIFTH_FOLLOWS];
        let mut axes = Self::default();
        for (index, axis) in Axis::FURTHER.into_iter().enumerate() {
            let there = count > 3 + index as i32 && memory.value(follows[index]) == 0;
            let own = |number| parameter::of(number, axis);
            let letter = u8::try_from(memory.value(own(parameter::NAME))).unwrap_or(b'A');
            let letter = char::from(letter);
            // Of two axes of one name the word is that of the fourth.
            let named = axes.axis(letter).is_none();
            if !there || !named {
                continue;
            }
            let kind = |bit| memory.bit(own(parameter::KIND), bit);
            let rolls = |bit| memory.bit(own(parameter::ROLLOVER), bit);
            let (rotary, counts_on) = (kind(0), kind(1));
            let turn = memory.length(own(parameter::TURN)).abs();
            let turn = (rotary && !counts_on && rolls(0) && turn > Length::ZERO).then_some(turn);
            axes.0[index] = Some(Further {
                letter,
                rotary,
                turn,
                by_sign: rolls(1),
            });
        }
        axes
    }

    /// What an axis is; none of X, Y, Z and where the machine has none.
    pub const fn further(&self, axis: Axis) -> Option<Further> {
        match axis {
            Axis::Fourth => self.0[0],
            Axis::Fifth => self.0[1],
            _ => None,
        }
    }

    /// The further ones that there are, in order.
    pub fn all_further(&self) -> impl Iterator<Item = (Axis, Further)> + use<> {
        let axes = *self;
        let axis = move |axis| Some((axis, axes.further(axis)?));
        Axis::FURTHER.into_iter().filter_map(axis)
    }

    /// All that there are, in order.
    pub(crate) fn all(&self) -> impl Iterator<Item = Axis> + use<> {
        let further = self.all_further().map(|(axis, _)| axis);
        Axis::BASIC.into_iter().chain(further)
    }

    /// The address of an axis.
    pub(crate) fn letter(&self, axis: Axis) -> char {
        match axis {
            Axis::X => 'X',
            Axis::Y => 'Y',
            Axis::Z => 'Z',
            Axis::Fourth | Axis::Fifth => self.further(axis).map_or('?', |it| it.letter),
        }
    }

    /// The further axis of an address.
    pub(crate) fn axis(&self, letter: char) -> Option<Axis> {
        let mut all = self.all_further();
        all.find_map(|(axis, it)| (it.letter == letter).then_some(axis))
    }

    /// Whether an axis counts in degrees.
    pub(crate) fn is_rotary(&self, axis: Axis) -> bool {
        self.further(axis).is_some_and(|it| it.rotary)
    }

    /// Whether the coordinates of an axis begin anew after a turn.
    pub(crate) fn rolls(&self, axis: Axis) -> bool {
        self.turn(axis).is_some()
    }

    fn turn(&self, axis: Axis) -> Option<Length> {
        self.further(axis)?.turn
    }

    /// A point with what has gone beyond a turn taken back into it.
    #[must_use]
    pub(crate) fn rolled(&self, mut point: Position) -> Position {
        for axis in Axis::FURTHER {
            if let Some(turn) = self.turn(axis) {
                point.set(axis, within(point.get(axis), turn));
            }
        }
        point
    }

    /// Where an absolute word leads from a place: as far as the axis has to turn.
    pub(crate) fn towards(&self, axis: Axis, from: Length, to: Length) -> Length {
        match self.further(axis) {
            Some(Further {
                turn: Some(turn),
                by_sign: true,
                ..
            }) => {
                let ahead = within(to.abs() - from, turn);
                let back = to < Length::ZERO && ahead != Length::ZERO;
                from + if back { ahead - turn } else { ahead }
            }
            _ => self.nearest(axis, from, to),
        }
    }

    /// The same by the shorter way; of both the one in plus.
    pub(crate) fn nearest(&self, axis: Axis, from: Length, to: Length) -> Length {
        let Some(turn) = self.turn(axis) else {
            return to;
        };
        let ahead = within(to - from, turn);
        from + if ahead + ahead > turn {
            ahead - turn
        } else {
            ahead
        }
    }
}

/// From 0 up to a turn.
const fn within(value: Length, turn: Length) -> Length {
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
        Axes::of(&memory)
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
        // Bit 1 of 187 alone is no kind.
        let kinds = [0, 1, 2, 3].map(|kind| machine(&[(1010, 4), (40_187, kind)]));
        let turns = kinds.map(|axes| axes.is_rotary(Axis::Fourth));
        assert_eq!(turns, [false, true, false, true]);
    }

    #[test]
    fn whatever_way_an_axis_turns_it_comes_to_its_word() {
        let shorter = machine(&[(1010, 4), (40_188, 1), (41_260, 90_000)]);
        let by_sign = machine(&[(1010, 4), (40_188, 3), (41_260, 90_000)]);
        let turn = Length::from_mm(90.0);
        for from in (0..90).map(|it| Length::from_mm(it.into())) {
            for to in (-200..200).map(|it| Length::from_mm(it.into())) {
                let way = |axes: Axes| axes.towards(Axis::Fourth, from, to) - from;
                let comes = |way: Length, to| within(from + way, turn) == within(to, turn);
                let least = way(shorter);
                assert!(comes(least, to) && least.abs() + least.abs() <= turn);
                let signed = way(by_sign);
                assert!(comes(signed, to.abs()) && signed.abs() < turn);
                let sense =
                    signed == Length::ZERO || (signed < Length::ZERO) == (to < Length::ZERO);
                assert!(sense, "{from:?} {to:?}");
            }
        }
    }
}
