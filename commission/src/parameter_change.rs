//! Parameter changes that commissioning proposes.

use gsk_core::cnc::ControlRequest;
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

/// A new value for a parameter or a point of the pitch error table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterChange {
    /// A data parameter, or a state parameter as a byte.
    Value {
        /// Parameter number.
        number: u16,
        /// New value in the unit of the parameter.
        value: i32,
    },
    /// A bit of a state parameter.
    Bit {
        /// Parameter number.
        number: u16,
        /// Bit, 0 to 7.
        bit: u8,
        /// New state of the bit.
        on: bool,
    },
    /// A point of the pitch error table.
    Pitch {
        /// Axis of the table column.
        axis: Axis,
        /// Point, 0 to 255.
        point: u8,
        /// New value, −255 to 255, in 0.001 mm before multiplication by parameter 013.
        value: i16,
    },
}

impl ParameterChange {
    /// Converts the change to a request to the control.
    pub const fn to_request(self) -> ControlRequest {
        match self {
            Self::Value { number, value } => ControlRequest::SetParameter { number, value },
            Self::Bit { number, bit, on } => ControlRequest::SetParameterBit { number, bit, on },
            Self::Pitch { axis, point, value } => ControlRequest::SetPitch { axis, point, value },
        }
    }

    /// Returns the same change with the current value: applying it undoes this one.
    #[must_use]
    pub fn current(self, parameters: &ControlParameters, pitch: &PitchTable) -> Self {
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

    /// Writes the new value.
    ///
    /// # Errors
    /// The control does not accept the value (alarm 043).
    pub fn apply(
        self,
        parameters: &mut ControlParameters,
        pitch: &mut PitchTable,
    ) -> Result<(), Message> {
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

    /// Formats the new value: `No.035 = 12`.
    pub fn message(self) -> Message {
        match self {
            Self::Value { number, value } => say::commission_value(number, value),
            Self::Bit { number, bit, on } => say::commission_bit(number, bit, u8::from(on)),
            Self::Pitch { axis, point, value } => {
                say::commission_point(axis_letter(axis), point, value)
            }
        }
    }
}

pub(crate) const fn axis_letter(axis: Axis) -> char {
    match axis {
        Axis::X => 'X',
        Axis::Z => 'Z',
    }
}

pub(crate) const fn select_by_axis(axis: Axis, x: u16, z: u16) -> u16 {
    match axis {
        Axis::X => x,
        Axis::Z => z,
    }
}

/// The changes that a commissioning step proposes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Proposal {
    /// Values to write, in this order.
    pub changes: Vec<ParameterChange>,
    /// Remarks for the operator.
    pub notes: Vec<Message>,
}

impl Proposal {
    /// Keeps only the changes that differ from the current values.
    ///
    /// # Errors
    /// A value that the control does not accept (alarm 043).
    pub(crate) fn from_changes(
        changes: Vec<ParameterChange>,
        notes: Vec<Message>,
        parameters: &ControlParameters,
        pitch: &PitchTable,
    ) -> Result<Self, Message> {
        let (mut new, mut table) = (parameters.clone(), pitch.clone());
        for change in &changes {
            change.apply(&mut new, &mut table)?;
        }
        let mut changes = changes;
        changes.retain(|change| change.current(parameters, pitch) != *change);
        Ok(Self { changes, notes })
    }
}
