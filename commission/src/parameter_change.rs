//! Parameter changes that commissioning proposes.

use gsk_core::cnc::ControlRequest;
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

/// A new value for a parameter or a point of the pitch error table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ParameterChange {
    /// Writes a data parameter, or a state parameter as a byte.
    Value {
        /// Number of the parameter.
        number: u16,
        /// New value in the unit of the parameter.
        value: i32,
    },
    /// Writes one bit of a state parameter.
    Bit {
        /// Number of the parameter.
        number: u16,
        /// Number of the bit, 0 to 7.
        bit: u8,
        /// New state of the bit: 1 (`true`) or 0.
        on: bool,
    },
    /// Writes a point of the pitch error table.
    Pitch {
        /// Axis whose column contains the point.
        axis: Axis,
        /// Number of the point, 0 to 255.
        point: u8,
        /// New value, −255 to 255, in 0.001 mm before multiplication by parameter 013.
        value: i16,
    },
}

impl ParameterChange {
    /// Returns the request to the control that writes the new value.
    pub const fn to_request(self) -> ControlRequest {
        match self {
            Self::Value { number, value } => ControlRequest::SetParameter { number, value },
            Self::Bit { number, bit, on } => ControlRequest::SetParameterBit { number, bit, on },
            Self::Pitch { axis, point, value } => ControlRequest::SetPitch { axis, point, value },
        }
    }

    /// Returns the change that writes the current value again, to undo this one later.
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

    /// Writes the new value into `parameters` or `pitch`.
    ///
    /// # Errors
    /// Returns a message if the control does not accept the value (alarm 043).
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

    /// Returns the message that shows the new value: `No.035 = 12`.
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
    /// Values to write to the control, in this order.
    pub changes: Vec<ParameterChange>,
    /// Remarks on the proposal for the operator.
    pub notes: Vec<Message>,
}

impl Proposal {
    /// Creates a proposal from those changes that differ from the current values.
    ///
    /// # Errors
    /// Returns a message about a value that the control does not accept (alarm 043).
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
