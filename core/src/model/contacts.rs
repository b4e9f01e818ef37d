//! Assigns signals to the inputs and outputs of a model by its parameters.

use std::collections::BTreeMap;

use serde::Deserialize;

use super::ControlModel;
use crate::units::Axis;

/// The assignment of signals to the inputs and outputs of a model. A parameter of each contact
/// holds the number of its signal, 0 for none; a negative number inverts the level.
#[derive(Clone, Debug, Deserialize)]
pub(super) struct ContactAssignment {
    /// Number of the parameter of input 0; the next inputs have the next numbers.
    first_input: u16,
    /// The signals of the inputs as delivered, from input 0.
    inputs: Vec<i32>,
    /// Number of the parameter of output 0; the next outputs have the next numbers.
    first_output: u16,
    /// The signals of the outputs as delivered, from output 0. Signal 1 is the output 0 of the
    /// M codes of the model.
    outputs: Vec<i32>,
    /// Number of signals of outputs.
    output_signals: i32,
    /// What each signal of an input does.
    input_signals: BTreeMap<u8, InputSignal>,
}

/// The action that a rising edge of an input triggers in a manual mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum EdgeAction {
    /// Executes the two M codes in turn, one at each edge.
    Toggles(u8, u8),
    /// Each edge executes this M code.
    Does(u8),
}

/// The contact of the machine that an input of a model is wired to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum WiredContact {
    /// The contact of the emergency-stop button.
    EmergencyStop,
    /// The limit switch at an end of an axis.
    Limit(Axis, AxisEnd),
    /// The contact of the deceleration switch of an axis.
    Deceleration(Axis),
}

/// An end of the travel of an axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum AxisEnd {
    /// The end of the axis in positive direction.
    Plus,
    /// The end of the axis in negative direction.
    Minus,
}

/// What the signal of an input does.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
pub(crate) enum InputSignal {
    /// A rising edge acts in manual modes.
    Edge(EdgeAction),
    /// The input acts like a contact of the machine.
    Wire(WiredContact),
}

/// An input with its signal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct AssignedInput {
    /// Number of the input, from 0.
    pub(crate) input: u8,
    /// Whether the signal is active while the input is off.
    pub(crate) inverted: bool,
    /// What the signal does.
    pub(crate) signal: InputSignal,
}

/// Parameter of a contact: its number, and its signal as delivered.
fn numbered(first: u16, delivered: &[i32]) -> impl Iterator<Item = (u16, u8, i32)> {
    let contacts = delivered.iter().zip(0_u8..);
    contacts.map(move |(signal, contact)| (first + u16::from(contact), contact, *signal))
}

/// The parameter with the signal of a contact.
pub(super) struct ContactParameter {
    pub(super) number: u16,
    pub(super) name_en: String,
    pub(super) name_zh: String,
    /// The greatest number of a signal.
    pub(super) greatest: i32,
    /// The signal as delivered.
    pub(super) delivered: i32,
}

impl ContactAssignment {
    /// The parameters of all contacts.
    pub(super) fn parameters(&self) -> impl Iterator<Item = ContactParameter> {
        let last_input = self.input_signals.keys().next_back().copied().unwrap_or(0);
        let inputs = numbered(self.first_input, &self.inputs);
        let inputs = inputs.map(move |(number, input, delivered)| ContactParameter {
            number,
            name_en: format!("signal of X{input}, - inverted"),
            name_zh: format!("输入 X{input} 的信号, 负: 取反"),
            greatest: last_input.into(),
            delivered,
        });
        let outputs = numbered(self.first_output, &self.outputs);
        let outputs = outputs.map(|(number, output, delivered)| ContactParameter {
            number,
            name_en: format!("signal of Y{output}, - inverted"),
            name_zh: format!("输出 Y{output} 的信号, 负: 取反"),
            greatest: self.output_signals,
            delivered,
        });
        inputs.chain(outputs)
    }
}

impl ControlModel {
    /// Number of the parameter with the signal of an input; `None` if no parameter assigns it.
    pub fn input_parameter(&self, input: u8) -> Option<u16> {
        let contacts = self.record().contacts.as_ref()?;
        let is_there = usize::from(input) < contacts.inputs.len();
        is_there.then(|| contacts.first_input + u16::from(input))
    }

    /// Number of the parameter with the signal of an output; `None` if no parameter assigns it.
    pub fn output_parameter(&self, output: u8) -> Option<u16> {
        let contacts = self.record().contacts.as_ref()?;
        let is_there = usize::from(output) < contacts.outputs.len();
        is_there.then(|| contacts.first_output + u16::from(output))
    }

    /// The inputs that have a signal.
    pub(crate) fn assigned_inputs(&self) -> impl Iterator<Item = AssignedInput> + '_ {
        let contacts = self.record().contacts.as_ref().into_iter();
        contacts.flat_map(move |contacts| {
            numbered(contacts.first_input, &contacts.inputs).filter_map(
                move |(number, input, delivered)| {
                    let value = self.parameters.get(&number).copied().unwrap_or(delivered);
                    let signal = u8::try_from(value.unsigned_abs()).ok()?;
                    Some(AssignedInput {
                        input,
                        inverted: value < 0,
                        signal: *contacts.input_signals.get(&signal)?,
                    })
                },
            )
        })
    }

    /// The outputs that carry `signals`. Both are masks, with output 0 and signal 1 in bit 0.
    pub(crate) fn outputs_of(&self, signals: u32) -> u32 {
        let Some(contacts) = &self.record().contacts else {
            return signals;
        };
        let all = numbered(contacts.first_output, &contacts.outputs);
        all.fold(0, |outputs, (number, output, _)| {
            let signal = self.parameter(number).unsigned_abs();
            let carries = signal > 0 && signals >> (signal - 1) & 1 == 1;
            outputs | u32::from(carries) << output
        })
    }

    /// The outputs whose level is inverted, as a mask with output 0 in bit 0.
    pub(crate) fn inverted_outputs(&self) -> u32 {
        let Some(contacts) = &self.record().contacts else {
            return 0;
        };
        let all = numbered(contacts.first_output, &contacts.outputs);
        all.fold(0, |outputs, (number, output, _)| {
            outputs | u32::from(self.parameter(number) < 0) << output
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::ModelId;

    #[test]
    fn outputs_follow_their_assignment() {
        let mut model = ControlModel::new(ModelId::Ncb08);
        assert_eq!(model.outputs_of(0b1001), 0b1001);
        assert_eq!(model.outputs_of(1 << 16), 0, "lubrication is not assigned");
        // Y20 carries the signal of Y3, besides Y3; Y16 the lubrication, inverted.
        assert_eq!(model.set_parameter(320, 4), Ok(()));
        assert_eq!(model.set_parameter(316, -17), Ok(()));
        assert_eq!(model.outputs_of(0b1001), 1 << 20 | 0b1001);
        assert_eq!(model.outputs_of(1 << 16), 1 << 16);
        assert_eq!(model.inverted_outputs(), 1 << 16);
        assert!(model.set_parameter(316, 18).is_err());
        assert!(model.set_parameter(324, 1).is_err(), "there are 24 outputs");
    }

    #[test]
    fn inputs_follow_their_assignment() {
        let mut model = ControlModel::new(ModelId::Ncb08);
        let inputs = |model: &ControlModel| -> Vec<u8> {
            model.assigned_inputs().map(|it| it.input).collect()
        };
        let delivered = [8, 9, 10, 11, 12, 14, 15, 16, 17, 18, 19, 20, 21, 22, 23];
        assert_eq!(inputs(&model), delivered);
        assert_eq!(model.set_parameter(208, 0), Ok(()));
        assert_eq!(model.set_parameter(231, -8), Ok(()));
        let found = model.assigned_inputs().last().expect("an input");
        assert_eq!((found.input, found.inverted), (31, true));
        assert!(!inputs(&model).contains(&8));
        assert_eq!(ControlModel::default().assigned_inputs().count(), 0);
    }
}
