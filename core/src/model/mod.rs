//! Control models: the GSK980TD, and related systems or other controls of the same shop. The
//! record of a model (`gsk980td.rs`, `assets/models/`) lists which number means which code. The
//! parameters that only this model has are in a file of their own. The effect of a code is
//! implemented once for all models that have it.

mod code_meanings;
mod contacts;
mod conventions;
mod gsk980td;
mod parameters;
mod program_calls;
mod program_capacity;
mod program_naming;
mod record;

use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use serde::{Deserialize, Serialize};

pub use code_meanings::{GCode, MCode};
pub(crate) use contacts::{AxisEnd, EdgeAction, InputSignal, WiredContact};
pub use conventions::{Conventions, Increments, MacroForm, ToolForm, WorkPlane, XMeasure};
pub use parameters::ModelParameter;
pub use program_capacity::ProgramCapacity;
pub use program_naming::ProgramNaming;
pub use record::ModelRecord;
pub(crate) use record::{LadderOutput, MFunction};

/// A control model whose programs this control reads.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize,
)]
pub enum ModelId {
    /// GSK980TD: the lathe control that this program implements.
    #[default]
    Gsk980td,
    /// GSK980MDi, a mill control.
    Gsk980mdi,
    /// Huaxing 31 and 32 series, a lathe control.
    Hx31,
    /// SYSViV NC-B08, a lathe control.
    Ncb08,
}

impl ModelId {
    /// All control models, in the order of their declaration.
    pub const ALL: [Self; 4] = [Self::Gsk980td, Self::Gsk980mdi, Self::Hx31, Self::Ncb08];

    /// The word that names the model on the command line; also the name of its folder.
    pub const fn command_word(self) -> &'static str {
        match self {
            Self::Gsk980td => "gsk980td",
            Self::Gsk980mdi => "gsk980mdi",
            Self::Hx31 => "hx31",
            Self::Ncb08 => "ncb08",
        }
    }

    /// The name of the model in the language of the operator.
    pub fn name(self) -> Message {
        match self {
            Self::Hx31 => say::model_huaxing(),
            Self::Gsk980td | Self::Gsk980mdi | Self::Ncb08 => say::as_written(self.plate_name()),
        }
    }

    /// The name of the model as its name plate and its LCD show it.
    pub const fn plate_name(self) -> &'static str {
        match self {
            Self::Gsk980td => "GSK980TD",
            Self::Gsk980mdi => "GSK980MDi",
            Self::Hx31 => "华兴 31/32",
            Self::Ncb08 => "NC-B08",
        }
    }

    /// The model that a word of the command line names; `None` for an unknown word.
    pub fn from_command_word(word: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|it| it.command_word() == word)
    }

    /// The record of the model, read at the first call.
    pub fn record(self) -> &'static ModelRecord {
        ModelRecord::for_model(self)
    }

    /// Whether the model is the GSK980TD.
    pub const fn is_main(&self) -> bool {
        matches!(self, Self::Gsk980td)
    }

    /// Whether the model is a mill: its programs are checked and drawn, but not run.
    pub const fn is_mill(self) -> bool {
        matches!(self, Self::Gsk980mdi)
    }
}

/// The model of a control, with the values of the parameters that only this model has.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct ControlModel {
    id: ModelId,
    /// Values of changed parameters, by number; the others have their delivered values.
    parameters: BTreeMap<u16, i32>,
}

impl ControlModel {
    /// A control of the model `id` with all parameters as delivered.
    pub const fn new(id: ModelId) -> Self {
        Self {
            id,
            parameters: BTreeMap::new(),
        }
    }

    /// Returns the id of the control model.
    pub const fn id(&self) -> ModelId {
        self.id
    }

    /// The record of the model: its codes, conventions and parameters.
    pub fn record(&self) -> &'static ModelRecord {
        self.id.record()
    }

    /// Whether the model is the GSK980TD.
    pub const fn is_main(&self) -> bool {
        self.id.is_main()
    }

    /// Whether the model is the GSK980TD with all parameters as delivered.
    pub(crate) fn is_delivered_main(&self) -> bool {
        self.is_main() && self.parameters.is_empty()
    }

    /// The value of a parameter that only this model has; 0 if it has no such number.
    pub fn parameter(&self, number: u16) -> i32 {
        let delivered = || {
            self.record()
                .parameters()
                .get(&number)
                .map(|it| it.delivered)
        };
        self.parameters
            .get(&number)
            .copied()
            .or_else(delivered)
            .unwrap_or(0)
    }

    /// Sets a parameter that only this model has.
    ///
    /// # Errors
    /// The message that the model has no such number, or that the value is outside its range.
    pub fn set_parameter(&mut self, number: u16, value: i32) -> Result<(), Message> {
        let record = self.record();
        let Some(parameter) = record.parameters().get(&number) else {
            return Err(say::model_parameter_unknown(self.id.name(), number));
        };
        let (low, high) = parameter.range;
        if !(low..=high).contains(&value) {
            return Err(say::model_parameter_range(number, value, low, high));
        }
        self.parameters.insert(number, value);
        Ok(())
    }
}

/// Parameters of macro B that assign programs to codes, and the numbers of those programs.
pub(crate) mod code_calls {
    /// First of ten parameters, each with a G code that calls a program like G65.
    pub(crate) const FIRST_G_PARAMETER: u16 = 220;
    /// First of ten parameters, each with an M code that calls a program like G65.
    pub(crate) const FIRST_M_PARAMETER: u16 = 230;
    /// First of three parameters, each with an M code that calls a program like M98.
    pub(crate) const FIRST_PLAIN_M_PARAMETER: u16 = 240;
    /// Parameter that makes each T word call a program like M98, if it is not 0.
    pub(crate) const T_PARAMETER: u16 = 243;
    /// Bit parameter of the GSK980MDi with the bit [`MILL_T_BIT`].
    pub(crate) const MILL_T_PARAMETER: u16 = 40;
    /// Bit in [`MILL_T_PARAMETER`] that makes each T word call a program like M98.
    pub(crate) const MILL_T_BIT: u8 = 5;
    /// The program that the code in the first parameter of each kind calls; the codes in the
    /// next parameters call the next numbers.
    pub(crate) const FIRST_G_PROGRAM: u16 = 9010;
    pub(crate) const FIRST_M_PROGRAM: u16 = 9020;
    pub(crate) const FIRST_PLAIN_M_PROGRAM: u16 = 9001;
    pub(crate) const T_PROGRAM: u16 = 9000;
}

/// Numbers of parameters and codes of the Huaxing lathes.
pub(crate) mod hx31 {
    /// Parameter with the time for which M71 to M85 switch their output on, ms.
    pub(crate) const PULSE_TIME: u16 = 71;
    /// The M code that pulses the first output; the next codes pulse the next outputs.
    pub(crate) const FIRST_PULSE: u8 = 71;
}

/// Numbers of the parameters that only the NC-B08 has.
pub(crate) mod ncb08 {
    /// Number of the parameter with the greatest rapid rate, mm/min.
    pub(crate) const RAPID_LIMIT: u16 = 17;
    /// Number of the parameter with the speed profile of rapids: 0 S-curve, 1 straight.
    pub(crate) const RAPID_PROFILE: u16 = 18;
    /// Number of the parameter with the duration of M21, ms.
    pub(crate) const CLAMP_TIME: u16 = 41;
    /// Parameter with the X coordinate of the reference point as a diameter, 0.001 mm.
    pub(crate) const REFERENCE_X: u16 = 108;
    /// Parameter with the Z coordinate of the reference point, 0.001 mm.
    pub(crate) const REFERENCE_Z: u16 = 109;
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_record_can_be_read() {
        for id in ModelId::ALL {
            let record = id.record();
            let name = id.name();
            assert!(record.g_code(0).is_some(), "{name} has no G00");
            assert!(record.m_function(30).is_some(), "{name} has no M30");
            assert!(!record.parameters().is_empty(), "{name} has no parameters");
            assert_eq!(ModelId::from_command_word(id.command_word()), Some(id));
        }
    }

    #[test]
    fn decided_codes_are_codes_of_the_model() {
        for id in ModelId::ALL {
            let record = id.record();
            for code in &record.g_decided {
                assert!(record.g_code((*code).into()).is_some(), "{id:?} G{code:02}");
            }
            for code in &record.m_decided {
                assert!(record.m_function(*code).is_some(), "{id:?} M{code:02}");
            }
        }
    }

    #[test]
    fn parameters_keep_to_their_ranges() {
        let mut model = ControlModel::new(ModelId::Ncb08);
        assert_eq!(model.parameter(ncb08::RAPID_LIMIT), 15000);
        assert_eq!(model.set_parameter(17, 6000), Ok(()));
        assert_eq!(model.parameter(17), 6000);
        assert!(model.set_parameter(17, 15001).is_err());
        assert!(model.set_parameter(19, 1).is_err());
        assert!(ControlModel::default().set_parameter(17, 1).is_err());
    }
}
