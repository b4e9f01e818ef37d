//! What a mill holds beside its programs: parameters, offsets of tools, zeros of the work.

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, number};
use gsk_core::model::{ControlModel, ModelId};
use gsk_messages::say;

use crate::modal::WorkZero;
use crate::space::{Axis, Each, Length, Position};

/// Numbers of its parameters; those of an axis have 10000, 20000 or 30000 more for X, Y
/// and Z, 40000 or 50000 for the fourth and the fifth.
pub mod parameter {
    use crate::space::Axis;

    /// Bit 7: D is a diameter; bit 1: the radius of the cutter is compensated.
    pub const TOOLS: u16 = 2;
    /// Bit 4: offsets shift the coordinates, the slides stand.
    pub const OFFSETS: u16 = 3;
    /// Bit 6: every block of motion ends at a stand.
    pub const CORNERS: u16 = 7;
    /// Bit 7: axes of a rapid arrive together; bit 4: G01 at power-on.
    pub const MOTION: u16 = 12;
    /// Bit 7: length offsets stay after a return to a reference point and G53.
    pub const LENGTHS: u16 = 13;
    /// Rapid rates, mm/min, and their time constant, ms.
    pub const RAPID_RATE: u16 = 22;
    /// Its time constant, ms.
    pub const RAPID_TIME: u16 = 23;
    /// Feed at power-on, mm/min.
    pub const FIRST_FEED: u16 = 26;
    /// The greatest feed, mm/min.
    pub const FEED_LIMIT: u16 = 27;
    /// Time constant of cuts, ms.
    pub const FEED_TIME: u16 = 29;
    /// Speed at which cuts begin and end, mm/min.
    pub const FEED_START: u16 = 30;
    /// Bit 7: a scale counts in 0.00001 instead of 0.001.
    pub const SCALE_UNIT: u16 = 36;
    /// Ends of the travel, machine coordinates, 0.001 mm.
    pub const TRAVEL_PLUS: u16 = 45;
    /// The other end.
    pub const TRAVEL_MINUS: u16 = 46;
    /// Feed of G31 with 551.2 = 1, mm/min.
    pub const SKIP_FEED: u16 = 71;
    /// Rapid rate of the index axis, mm/min or degrees/min.
    pub const INDEX_RATE: u16 = 76;
    /// Bit 4: no soft limits.
    pub const LIMITS: u16 = 172;
    /// Of a further axis, bits 1 and 0: 00 a slide, 01 rotary A, 11 rotary B.
    pub const KIND: u16 = 187;
    /// Of a rotary axis A: bit 0: its coordinates begin anew after a turn; bit 1: the sign
    /// of an absolute word is the sense.
    pub const ROLLOVER: u16 = 188;
    /// Bit 7: angles of ASIN and ATAN from −180 to 180.
    pub const ANGLES: u16 = 520;
    /// Bit 4: G54 and the like clear the shift of G92.
    pub const ZEROS: u16 = 540;
    /// Local coordinates end with M30 and M02 (bit 1), with a reference return (bit 0).
    pub const LOCAL: u16 = 542;
    /// Bit 2: G31 runs at 071.
    pub const SKIP: u16 = 551;
    /// Bit 7: G91 adds to the angle of G68; bit 4: a scale for each axis; bits 2 to 0: Z,
    /// Y and X are scaled.
    pub const TRANSFORM: u16 = 562;
    /// Bits 1 and 0: the shift of G76 and G87 is along the second axis, is negative.
    pub const SHIFT: u16 = 584;
    /// Bit 5: a rigid tap goes back by 5213 between pecks; else to R.
    pub const TAPS: u16 = 588;
    /// How many axes: 3 to 5.
    pub const AXES: u16 = 1010;
    /// The address of a further axis: 65 A, 66 B, 67 C.
    pub const NAME: u16 = 1020;
    /// The axis with which the fourth one runs: 1 X, 2 Y, 3 Z.
    pub const FOURTH_FOLLOWS: u16 = 1026;
    /// The same of the fifth one.
    pub const FIFTH_FOLLOWS: u16 = 1027;
    /// The index axis: 4 or 5.
    pub const INDEX: u16 = 1030;
    /// A turn of a rotary axis, 0.001 degrees.
    pub const TURN: u16 = 1260;
    /// Reference points 1 to 4, machine coordinates, 0.001 mm.
    pub const REFERENCE: u16 = 1240;
    /// How far the end of an arc may lie off its circle, 0.001 mm.
    pub const ARC_ERROR: u16 = 3410;
    /// Lines of the spindle encoder; 0: G74 and G84 drill.
    pub const ENCODER: u16 = 3720;
    /// G37: its feed, mm/min, and how far before its point it begins, 0.001 mm.
    pub const MEASURE_FEED: u16 = 5040;
    /// How far before, 0.001 mm.
    pub const MEASURE_BEFORE: u16 = 5043;
    /// Dwell after a hole, ms.
    pub const HOLE_DWELL: u16 = 5108;
    /// G73 goes back by, 0.001 mm.
    pub const PECK_BACK: u16 = 5114;
    /// G83 stops short of the last depth by, 0.001 mm.
    pub const PECK_CLEARANCE: u16 = 5115;
    /// A rigid tap goes back by, with 588.5 = 1, 0.001 mm.
    pub const TAP_BACK: u16 = 5213;
    /// Override of the way out of a rigid tap, %; 0: 100.
    pub const TAP_OUT: u16 = 5211;
    /// Time constants of rigid taps, ms: in.
    pub const TAP_TIME: u16 = 5261;
    /// Out; 0: as in.
    pub const TAP_TIME_OUT: u16 = 5271;
    /// Angle of G68 without R, 0.001 degrees.
    pub const ANGLE: u16 = 5410;
    /// Scale of G51 without P, and those of the axes without I, J and K.
    pub const SCALE: u16 = 5411;
    /// Of an axis.
    pub const AXIS_SCALE: u16 = 5421;
    /// That of an axis.
    pub const fn of(number: u16, axis: Axis) -> u16 {
        number + 10_000 * (axis as u16 + 1)
    }
}

/// Offsets of tools by number.
const OFFSETS: u16 = 400;
/// The greatest value of one: 999.999 mm, or 99.9999 inches.
const GREATEST: Length = Length::from_increments(999_999);
const GREATEST_INCHES: Length = Length::from_nm(2_539_997_460);

/// A row of the offset table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Offset {
    /// H: the length of the tool.
    pub length: Length,
    /// What has worn off it.
    pub length_wear: Length,
    /// D: the radius of the cutter, or its diameter with 002.7 = 1.
    pub radius: Length,
    /// What has worn off it.
    pub radius_wear: Length,
}

/// A value of a row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Column {
    Length,
    LengthWear,
    Radius,
    RadiusWear,
}

impl Offset {
    pub(crate) const fn column(&mut self, column: Column) -> &mut Length {
        match column {
            Column::Length => &mut self.length,
            Column::LengthWear => &mut self.length_wear,
            Column::Radius => &mut self.radius,
            Column::RadiusWear => &mut self.radius_wear,
        }
    }
}

/// All of it.
#[derive(Clone, Debug, PartialEq)]
pub struct MillMemory {
    /// Its parameters.
    pub model: ControlModel,
    offsets: BTreeMap<u16, Offset>,
    /// Added to all zeros.
    pub(crate) external: Position,
    /// Machine coordinates of the zeros.
    zeros: [Position; WorkZero::COUNT],
}

impl Default for MillMemory {
    fn default() -> Self {
        Self {
            model: ControlModel::new(ModelId::Gsk980mdi),
            offsets: BTreeMap::new(),
            external: Position::default(),
            zeros: [Position::default(); WorkZero::COUNT],
        }
    }
}

impl MillMemory {
    /// A parameter.
    pub(crate) fn value(&self, number: u16) -> i32 {
        self.model.parameter(number)
    }

    /// A bit of one.
    pub(crate) fn bit(&self, number: u16, bit: u8) -> bool {
        self.value(number) >> bit & 1 == 1
    }

    /// A length in 0.001 mm.
    pub(crate) fn length(&self, number: u16) -> Length {
        Length::from_increments(self.value(number).into())
    }

    /// A point: a length of each axis.
    pub(crate) fn point(&self, number: u16) -> Position {
        Each(Axis::ALL.map(|axis| self.length(parameter::of(number, axis))))
    }

    /// An offset; 0 for those that were never set.
    pub(crate) fn offset(&self, number: u16) -> Offset {
        self.offsets.get(&number).copied().unwrap_or_default()
    }

    /// The length of a tool with its wear.
    pub(crate) fn tool_length(&self, number: u16) -> Length {
        let offset = self.offset(number);
        offset.length + offset.length_wear
    }

    /// The radius of a cutter with its wear.
    pub(crate) fn cutter_radius(&self, number: u16) -> f64 {
        let offset = self.offset(number);
        let value = (offset.radius + offset.radius_wear).mm();
        if self.bit(parameter::TOOLS, 7) {
            value / 2.0
        } else {
            value
        }
    }

    /// Gives an offset a value.
    ///
    /// # Errors
    /// 030 for a number outside 1 to 400, 043 for a value beyond 999.999 mm (`inch`:
    /// 99.9999 inches; appendix 1).
    pub(crate) fn set_offset(
        &mut self,
        offset: i64,
        column: Column,
        value: Length,
        inch: bool,
    ) -> Result<(), Alarm> {
        let found = u16::try_from(offset)
            .ok()
            .filter(|it| (1..=OFFSETS).contains(it));
        let Some(offset) = found else {
            let detail = say::mill_offset_number(offset, OFFSETS);
            return Err(Alarm::new(number::BAD_OFFSET).because(detail));
        };
        let greatest = if inch { GREATEST_INCHES } else { GREATEST };
        if value.abs() > greatest {
            let detail = say::mill_offset_value(value.mm(), greatest.mm());
            return Err(Alarm::new(number::OUT_OF_RANGE).because(detail));
        }
        *self.offsets.entry(offset).or_default().column(column) = value;
        Ok(())
    }

    /// Machine coordinates of a zero, without the external one.
    pub(crate) fn zero(&self, zero: WorkZero) -> Position {
        self.zeros
            .get(usize::from(zero.0))
            .copied()
            .unwrap_or_default()
    }

    /// The same, to be changed.
    pub(crate) fn zero_mut(&mut self, zero: WorkZero) -> Option<&mut Position> {
        self.zeros.get_mut(usize::from(zero.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parameters_are_those_of_the_record() {
        let memory = MillMemory::default();
        assert_eq!(memory.value(parameter::SCALE), 1000);
        for axis in Axis::ALL {
            assert!(memory.value(parameter::of(parameter::RAPID_RATE, axis)) > 0);
        }
        for axis in Axis::BASIC {
            assert_eq!(
                memory.value(parameter::of(parameter::AXIS_SCALE, axis)),
                1000
            );
        }
    }
}
