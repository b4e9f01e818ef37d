//! Stores the parameters, tool offsets and work zeros of a mill.

use std::collections::BTreeMap;

use gsk_core::alarm::{Alarm, number};
use gsk_core::model::{ControlModel, ModelId};
use gsk_messages::say;

use crate::modal::WorkZero;
use crate::space::{AxisValues, Length, MillAxis, MillPosition};

/// Numbers of mill parameters. For an axis add 10000 (X), 20000 (Y), 30000 (Z), 40000 (fourth)
/// or 50000 (fifth).
pub mod parameter {
    use crate::space::MillAxis;

    /// Parameter 001. Bit 1: the least increment is 0.0001 mm (IS-C), otherwise 0.001 mm (IS-B).
    pub const INCREMENTS: u16 = 1;
    /// Parameter 002. Bit 7: D is a diameter. Bit 6: cutter compensation starts and ends by type
    /// B. Bit 1: cutter radius compensation is available.
    pub const TOOLS: u16 = 2;
    /// Parameter 003. Bit 4: offsets shift the coordinates without motion.
    pub const OFFSETS: u16 = 3;
    /// Parameter 004. Bit 0: inch machine, lengths and speeds of parameters are in inches.
    pub const UNITS: u16 = 4;
    /// Parameter 007. Bit 6: every motion block ends with an exact stop.
    pub const CORNERS: u16 = 7;
    /// Parameter 010: rate at which backlash is taken up, bits of kpps.
    pub const BACKLASH_RATE: u16 = 10;
    /// Parameter 011. Bit 7: backlash in mode B. Bit 6: an eighth of the rate of 010.
    pub const BACKLASH_MODE: u16 = 11;
    /// Parameter 012. Bit 7: the axes of a rapid arrive together. Bit 4: G01 is in force at
    /// power-on. Bit 1: soft limits of an axis act after its reference return.
    pub const MOTION: u16 = 12;
    /// Parameter 013. Bit 7: length offsets stay in force after a reference return and G53.
    pub const LENGTHS: u16 = 13;
    /// Parameter 022: rapid rate of an axis, mm/min.
    pub const RAPID_RATE: u16 = 22;
    /// Parameter 023: time constant of rapids, ms.
    pub const RAPID_TIME: u16 = 23;
    /// Parameter 026: feed at power-on, mm/min.
    pub const FIRST_FEED: u16 = 26;
    /// Parameter 027: the greatest feed, mm/min.
    pub const FEED_LIMIT: u16 = 27;
    /// Parameter 029: time constant of cuts, ms.
    pub const FEED_TIME: u16 = 29;
    /// Parameter 030: speed at which cuts begin and end, mm/min.
    pub const FEED_START: u16 = 30;
    /// Parameter 034: backlash of an axis, 0.001 mm.
    pub const BACKLASH: u16 = 34;
    /// Parameter 036: time constant of flexible taps, ms.
    pub const FLEXIBLE_TAP_TIME: u16 = 36;
    /// Parameter 037: speed at which flexible taps begin and end, mm/min.
    pub const FLEXIBLE_TAP_START: u16 = 37;
    /// Parameter 036 of the older control of the appendices. Bit 7: a scale counts in 0.00001
    /// instead of 0.001.
    pub const SCALE_UNIT: u16 = 60_036;
    /// Parameter 045: positive travel limit, machine coordinates, 0.001 mm.
    pub const TRAVEL_PLUS: u16 = 45;
    /// Parameter 046: negative travel limit, machine coordinates, 0.001 mm.
    pub const TRAVEL_MINUS: u16 = 46;
    /// Parameter 071: feed of G31 with 551.2 = 1, mm/min.
    pub const SKIP_FEED: u16 = 71;
    /// Parameter 060: time constant of the Cs axis, ms.
    pub const CS_TIME: u16 = 60;
    /// Parameter 076: rapid rate of the index axis, mm/min or degrees/min.
    pub const INDEX_RATE: u16 = 76;
    /// Parameter 172. Bit 4: soft limits are off.
    pub const LIMITS: u16 = 172;
    /// Parameter 174. Bit 7: cuts stop with the spindle. Bit 6: cuts wait for the speed of the
    /// spindle.
    pub const SPINDLE_CHECK: u16 = 174;
    /// Parameter 187. Type of a fourth or fifth axis, bits 1 and 0: 00 linear, 01 rotary A, 11
    /// rotary B. Bits 7 and 6 its least increment: 00 as X, Y and Z, 01 IS-A, 10 IS-B, 11 IS-C.
    pub const KIND: u16 = 187;
    /// Parameter 188. Rollover of a rotary axis A. Bit 0: coordinates restart after a turn. Bit 1:
    /// the sign of an absolute word is the direction.
    pub const ROLLOVER: u16 = 188;
    /// Parameter 520. Bit 7: ASIN and ATAN return angles from −180 to 180 degrees.
    pub const ANGLES: u16 = 520;
    /// Parameter 540. Bit 4: G54 to G59 clear the shift of G92. Bit 1: a changed work zero acts
    /// at once, otherwise with the next code that selects a zero.
    pub const ZEROS: u16 = 540;
    /// Parameter 542. Local coordinates are cancelled by M30 and M02 (bit 1) or by a reference
    /// return (bit 0).
    pub const LOCAL: u16 = 542;
    /// Parameter 551. Bit 2: G31 runs at the feed of 071.
    pub const SKIP: u16 = 551;
    /// Parameter 562. Bit 7: G91 adds to the angle of G68. Bit 4: a scale for each axis. Bits 2 to
    /// 0: Z, Y and X are scaled.
    pub const TRANSFORM: u16 = 562;
    /// Parameter 584. Shift of G76 and G87. Bit 1: along the second axis. Bit 0: negative.
    pub const SHIFT: u16 = 584;
    /// Parameter 588. Bit 5: a rigid tap retracts by 5213 between pecks, otherwise to R.
    pub const TAPS: u16 = 588;
    /// Parameter 600. Bit 1: S selects the gear (M type), otherwise the ladder does (T type).
    /// Bit 0: gears change at the speeds of 3751 to 3753 (M type B), otherwise at 3736 (A).
    pub const GEAR_TYPE: u16 = 600;
    /// Parameter 1010: number of axes, 3 to 5.
    pub const AXES: u16 = 1010;
    /// Parameter 1020: address of a fourth or fifth axis: 65 A, 66 B, 67 C.
    pub const NAME: u16 = 1020;
    /// Parameter 1026: the axis with which the fourth axis moves synchronously: 0 none, 1 X, 2 Y, 3
    /// Z.
    pub const FOURTH_FOLLOWS: u16 = 1026;
    /// Parameter 1027: the axis with which the fifth axis moves synchronously: 0 none, 1 X, 2 Y, 3
    /// Z.
    pub const FIFTH_FOLLOWS: u16 = 1027;
    /// Parameter 1030: which axis is the index axis, 4 or 5.
    pub const INDEX: u16 = 1030;
    /// Parameter 1260: length of a full turn of a rotary axis, 0.001 degrees.
    pub const TURN: u16 = 1260;
    /// Parameter 1240. First of four parameters of each axis: position of reference points 1 to 4,
    /// machine coordinates, 0.001 mm.
    pub const REFERENCE: u16 = 1240;
    /// Parameter 3010: delay of the strobe SF at a gear change, ms.
    pub const GEAR_STROBE: u16 = 3010;
    /// Parameter 3410: greatest distance of an arc's end from its circle, 0.001 mm.
    pub const ARC_ERROR: u16 = 3410;
    /// Parameter 3712: type of the spindle: 0 gears, 1 analog, 2 serial.
    pub const SPINDLE_TYPE: u16 = 3712;
    /// Parameter 3720: lines of the spindle encoder. With 0, G74 and G84 drill.
    pub const ENCODER: u16 = 3720;
    /// Parameter 3735: least speed of the spindle motor, of 4095.
    pub const MOTOR_LEAST: u16 = 3735;
    /// Parameter 3736: greatest speed of the spindle motor, of 4095.
    pub const MOTOR_GREATEST: u16 = 3736;
    /// Parameter 3740: delay before the speed of the spindle is checked, ms.
    pub const SPINDLE_DELAY: u16 = 3740;
    /// Parameters 3741 to 3744: greatest speed of the gears 1 to 4, r/min.
    pub const GEAR_SPEEDS: core::ops::RangeInclusive<u16> = 3741..=3744;
    /// Parameters 3751 to 3753: motor speeds at which gears 1 to 3 change to the next, of 4095.
    pub const GEAR_CHANGES: core::ops::RangeInclusive<u16> = 3751..=3753;
    /// Parameter 3760: the axis that the spindle becomes as Cs axis: 0 none, 1 X to 5 fifth.
    pub const CS_AXIS: u16 = 3760;
    /// Parameter 4901: time after which cuts stopped with the spindle raise an alarm, ms.
    pub const STOPPED_TIME: u16 = 4901;
    /// Parameter 5012: greatest difference from 0 and 180 degrees at which two lines count as
    /// straight and as opposite in cutter compensation, 0.001 degrees (IS-C: 0.0001 degrees).
    pub const STRAIGHT_ANGLE: u16 = 5012;
    /// Parameter 5025: number of the first tool pocket.
    pub const FIRST_POCKET: u16 = 5025;
    /// Parameter 5026: number of the last tool pocket, greater than the first.
    pub const LAST_POCKET: u16 = 5026;
    /// Parameter 5040: feed of G37, mm/min.
    pub const MEASURE_FEED: u16 = 5040;
    /// Parameter 5043: distance before the measuring point at which G37 changes to its feed, 0.001
    /// mm.
    pub const MEASURE_BEFORE: u16 = 5043;
    /// Parameter 5108: dwell after a hole, ms.
    pub const HOLE_DWELL: u16 = 5108;
    /// Parameter 5114: retraction of G73, 0.001 mm.
    pub const PECK_BACK: u16 = 5114;
    /// Parameter 5115: distance before the last depth where G83 changes to feed, 0.001 mm.
    pub const PECK_CLEARANCE: u16 = 5115;
    /// Parameter 5213: retraction of a rigid tap with 588.5 = 1, 0.001 mm.
    pub const TAP_BACK: u16 = 5213;
    /// Parameter 5211: override for retracting a rigid tap, %. 0 means 100.
    pub const TAP_OUT: u16 = 5211;
    /// Parameter 5261: time constant of a rigid tap on its way in, ms.
    pub const TAP_TIME: u16 = 5261;
    /// Parameter 5271: time constant of a rigid tap on its way out, ms. 0 means the same as in.
    pub const TAP_TIME_OUT: u16 = 5271;
    /// Parameter 5410: angle of G68 without R, 0.001 degrees.
    pub const ANGLE: u16 = 5410;
    /// Parameter 5411: scale of G51 without P, in the unit of 60036.7.
    pub const SCALE: u16 = 5411;
    /// Parameter 5421: scale of an axis for G51 without I, J or K, in the unit of 60036.7.
    pub const AXIS_SCALE: u16 = 5421;
    /// Returns the number of a parameter of one axis.
    pub const fn axis_parameter(number: u16, axis: MillAxis) -> u16 {
        number + 10_000 * (axis as u16 + 1)
    }
}

/// Number of tool offsets that a mill has.
const OFFSETS: u16 = 400;
/// The greatest tool offset: 999.999 mm, or 99.9999 inches.
const GREATEST: Length = Length::from_increments(999_999);
const GREATEST_INCHES: Length = Length::from_nm(2_539_997_460);

/// Unit of a length parameter on an inch machine: 0.0001 inch, nm.
const PARAMETER_INCH_NM: i64 = 2540;
/// The greatest value of 5012 in IS-B: one degree.
const MAX_STRAIGHT: i32 = 1000;

/// A row of the tool offset table: length and radius of a tool, each with its wear.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MillOffset {
    /// Length of the tool (H).
    pub length: Length,
    /// Wear of the tool length, added to the length.
    pub length_wear: Length,
    /// Radius of the cutter (D), or its diameter with 002.7 = 1.
    pub radius: Length,
    /// Wear of the radius or diameter, added to the radius or diameter.
    pub radius_wear: Length,
}

/// How the machine stores tool offsets, an option of its builder (001:5-19).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MillOffsetMemory {
    /// One value for each number, used as length by H and as radius by D.
    A,
    /// A value and its wear for each number, used by H and by D.
    B,
    /// Length and radius with their wear for each number.
    #[default]
    C,
}

/// A column of the tool offset table that G10 and variables write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum MillOffsetColumn {
    Length,
    LengthWear,
    Radius,
    RadiusWear,
}

impl MillOffsetColumn {
    /// The same column of the other offset: that of the radius for one of the length.
    const fn other(self) -> Self {
        match self {
            Self::Length => Self::Radius,
            Self::LengthWear => Self::RadiusWear,
            Self::Radius => Self::Length,
            Self::RadiusWear => Self::LengthWear,
        }
    }
}

impl MillOffsetMemory {
    /// The column that a variable or G10 means: memory A has no wear.
    pub(crate) const fn column(self, column: MillOffsetColumn) -> MillOffsetColumn {
        match (self, column) {
            (Self::A, MillOffsetColumn::LengthWear) => MillOffsetColumn::Length,
            (Self::A, MillOffsetColumn::RadiusWear) => MillOffsetColumn::Radius,
            _ => column,
        }
    }
}

impl MillOffset {
    pub(crate) const fn column(&mut self, column: MillOffsetColumn) -> &mut Length {
        match column {
            MillOffsetColumn::Length => &mut self.length,
            MillOffsetColumn::LengthWear => &mut self.length_wear,
            MillOffsetColumn::Radius => &mut self.radius,
            MillOffsetColumn::RadiusWear => &mut self.radius_wear,
        }
    }
}

/// The parameters, tool offsets and work zeros of a mill.
#[derive(Clone, Debug, PartialEq)]
pub struct MillMemory {
    /// The control model with the values of its parameters.
    pub model: ControlModel,
    /// How the tool offsets are stored; set it before the first offset.
    pub offset_memory: MillOffsetMemory,
    offsets: BTreeMap<u16, MillOffset>,
    /// External zero offset, added to all work zeros.
    pub(crate) external: MillPosition,
    /// The work zeros in machine coordinates, in the order of [`WorkZero`].
    zeros: [MillPosition; WorkZero::COUNT],
}

impl Default for MillMemory {
    fn default() -> Self {
        Self {
            model: ControlModel::new(ModelId::Gsk980mdi),
            offset_memory: MillOffsetMemory::default(),
            offsets: BTreeMap::new(),
            external: MillPosition::default(),
            zeros: [MillPosition::default(); WorkZero::COUNT],
        }
    }
}

impl MillMemory {
    /// Returns the value of a parameter.
    pub(crate) fn value(&self, number: u16) -> i32 {
        self.model.parameter(number)
    }

    /// Returns whether a bit (0 to 7) of a parameter is 1.
    pub(crate) fn bit(&self, number: u16, bit: u8) -> bool {
        self.value(number) >> bit & 1 == 1
    }

    /// Returns whether the least increment of X, Y and Z is 0.0001 mm (IS-C).
    pub(crate) fn is_fine(&self) -> bool {
        self.bit(parameter::INCREMENTS, 1)
    }

    /// Returns whether the machine is an inch machine.
    pub(crate) fn is_inch_machine(&self) -> bool {
        self.bit(parameter::UNITS, 0)
    }

    /// Returns the value of a parameter that is in 0.001 mm, or in 0.0001 inch on an inch
    /// machine, as a length.
    pub(crate) fn length(&self, number: u16) -> Length {
        let value = i64::from(self.value(number));
        match self.is_inch_machine() {
            true => Length::from_nm(value.saturating_mul(PARAMETER_INCH_NM)),
            false => Length::from_increments(value),
        }
    }

    /// Returns the value of a parameter in 0.001 degrees as an angle.
    pub(crate) fn angle(&self, number: u16) -> Length {
        Length::from_increments(self.value(number).into())
    }

    /// Returns the value of a speed parameter, mm/min. On an inch machine it is in 0.1 inch/min.
    pub(crate) fn speed(&self, number: u16) -> f64 {
        let unit = if self.is_inch_machine() { 2.54 } else { 1.0 };
        f64::from(self.value(number)) * unit
    }

    /// Returns whether an axis is a rotary one (187), whose parameters are in degrees.
    pub(crate) fn is_rotary(&self, axis: MillAxis) -> bool {
        let kind = parameter::axis_parameter(parameter::KIND, axis);
        MillAxis::FURTHER.contains(&axis) && self.bit(kind, 0)
    }

    /// Returns the values of a parameter that each axis has, as a point.
    pub(crate) fn point(&self, number: u16) -> MillPosition {
        AxisValues(MillAxis::ALL.map(|axis| {
            let own = parameter::axis_parameter(number, axis);
            match self.is_rotary(axis) {
                true => self.angle(own),
                false => self.length(own),
            }
        }))
    }

    /// Returns the greatest difference from 0 and 180 degrees at which two lines count as
    /// straight and as opposite (5012), degrees.
    pub(crate) fn straight_degrees(&self) -> f64 {
        let value = self.value(parameter::STRAIGHT_ANGLE);
        match self.is_fine() {
            true => f64::from(value) / 10_000.0,
            false => f64::from(value.min(MAX_STRAIGHT)) / 1000.0,
        }
    }

    /// Returns the tool offset with a number; zeros if it was never set.
    pub(crate) fn offset(&self, number: u16) -> MillOffset {
        self.offsets.get(&number).copied().unwrap_or_default()
    }

    /// Returns the tool length of an offset number, with its wear.
    pub(crate) fn tool_length(&self, number: u16) -> Length {
        let offset = self.offset(number);
        offset.length + offset.length_wear
    }

    /// Returns the cutter radius of an offset number, with its wear, mm.
    pub(crate) fn cutter_radius(&self, number: u16) -> f64 {
        let offset = self.offset(number);
        let value = (offset.radius + offset.radius_wear).mm();
        if self.bit(parameter::TOOLS, 7) {
            value / 2.0
        } else {
            value
        }
    }

    /// Sets a column of a tool offset. Errors: alarm 030 for a number outside 1 to 400, alarm
    /// 043 for a value beyond 999.999 mm (`inch`: 99.9999 inches, appendix 1).
    pub(crate) fn set_offset(
        &mut self,
        offset: i64,
        column: MillOffsetColumn,
        value: Length,
        inch: bool,
    ) -> Result<(), Alarm> {
        let found = u16::try_from(offset)
            .ok()
            .filter(|it| (1..=OFFSETS).contains(it));
        let Some(offset) = found else {
            let detail = say::mill_offset_number(offset, OFFSETS);
            return Err(Alarm::new(number::BAD_OFFSET).with_detail(detail));
        };
        let greatest = if inch { GREATEST_INCHES } else { GREATEST };
        if value.abs() > greatest {
            let detail = say::mill_offset_value(value.mm(), greatest.mm());
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail));
        }
        let column = self.offset_memory.column(column);
        let offset = self.offsets.entry(offset).or_default();
        *offset.column(column) = value;
        if self.offset_memory != MillOffsetMemory::C {
            *offset.column(column.other()) = value;
        }
        Ok(())
    }

    /// Returns a work zero in machine coordinates, without the external offset.
    pub(crate) fn zero(&self, zero: WorkZero) -> MillPosition {
        self.zeros
            .get(usize::from(zero.0))
            .copied()
            .unwrap_or_default()
    }

    /// Returns a work zero to change it; `None` if there is no such zero.
    pub(crate) fn zero_mut(&mut self, zero: WorkZero) -> Option<&mut MillPosition> {
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
        for axis in MillAxis::ALL {
            assert!(memory.value(parameter::axis_parameter(parameter::RAPID_RATE, axis)) > 0);
        }
        for axis in MillAxis::BASIC {
            assert_eq!(
                memory.value(parameter::axis_parameter(parameter::AXIS_SCALE, axis)),
                1000
            );
        }
    }
}
