//! What is to be written, and what was there before.

use gsk_core::cnc::Request;
use gsk_core::memory::{Parameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

/// A value of the control that becomes another.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// A data parameter, or a state parameter as a byte.
    Value {
        /// Number.
        number: u16,
        /// Value, in the unit of the parameter.
        value: i32,
    },
    /// A bit of a state parameter.
    Bit {
        /// Number.
        number: u16,
        /// Bit, 0 to 7.
        bit: u8,
        /// Value.
        on: bool,
    },
    /// A point of the pitch error table.
    Pitch {
        /// Axis.
        axis: Axis,
        /// Point, 0 to 255.
        point: u8,
        /// −255 to 255, 0.001 mm before the factor 013.
        value: i16,
    },
}

impl Change {
    /// What is asked of the control.
    pub const fn request(self) -> Request {
        match self {
            Self::Value { number, value } => Request::SetParameter { number, value },
            Self::Bit { number, bit, on } => Request::SetParameterBit { number, bit, on },
            Self::Pitch { axis, point, value } => Request::SetPitch { axis, point, value },
        }
    }

    /// The same with the value that stands there now.
    #[must_use]
    pub fn now(self, parameters: &Parameters, pitch: &PitchTable) -> Self {
        match self {
            Self::Value { number, .. } => Self::Value {
                number,
                value: parameters.value(number),
            },
            Self::Bit { number, bit, .. } => Self::Bit {
                number,
                bit,
                on: parameters.bit(number, bit),
            },
            Self::Pitch { axis, point, .. } => Self::Pitch {
                axis,
                point,
                value: pitch.value(axis, point),
            },
        }
    }

    /// Writes it.
    ///
    /// # Errors
    /// A value that the control does not take (alarm 043).
    pub fn apply(self, parameters: &mut Parameters, pitch: &mut PitchTable) -> Result<(), Message> {
        match self {
            Self::Value { number, value } => parameters
                .set(number, value)
                .map_err(|error| error.message()),
            Self::Bit { number, bit, on } => {
                let done = parameters.set_bit(number, bit, on);
                done.map_err(|error| error.message())
            }
            Self::Pitch { axis, point, value } => pitch
                .set(axis, point, value)
                .map_err(|error| error.message()),
        }
    }

    /// What stands where, as `No.035 = 12`.
    pub fn message(self) -> Message {
        match self {
            Self::Value { number, value } => say::commission_value(number, value),
            Self::Bit { number, bit, on } => say::commission_bit(number, bit, u8::from(on)),
            Self::Pitch { axis, point, value } => say::commission_point(name(axis), point, value),
        }
    }
}

/// The letter of an axis.
pub(crate) const fn name(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    }
}

/// The number of the two that belongs to an axis.
pub(crate) const fn of(axis: Axis, x: u16, z: u16) -> u16 {
    match axis {
        Axis::X => x,
        Axis::Z => z,
    }
}

/// What a step proposes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Proposal {
    /// What is to be written.
    pub changes: Vec<Change>,
    /// What should be known about it.
    pub notes: Vec<Message>,
}

impl Proposal {
    /// Only what differs from what stands there.
    ///
    /// # Errors
    /// A value that the control does not take.
    pub(crate) fn of(
        changes: Vec<Change>,
        notes: Vec<Message>,
        parameters: &Parameters,
        pitch: &PitchTable,
    ) -> Result<Self, Message> {
        let (mut new, mut table) = (parameters.clone(), pitch.clone());
        for change in &changes {
            change.apply(&mut new, &mut table)?;
        }
        let mut changes = changes;
        changes.retain(|change| change.now(parameters, pitch) != *change);
        Ok(Self { changes, notes })
    }
}
