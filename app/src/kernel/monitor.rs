//! What fault bench, ladder view, commissioning and the editing of data see: the machine
//! and the PLC as they are.

use std::sync::Arc;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;
use gsk_core::machine::{Inputs, Lathe};
use gsk_core::memory::{Offsets, Parameters, PitchTable, Refusal};
use gsk_core::plc::{Ladder, Plc};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::CoordinateFormat;

/// The machine and the PLC at one moment. Taken only while a view is open that
/// shows them.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineView {
    /// The lathe.
    pub lathe: Lathe,
    /// What its contacts and sensors say.
    pub inputs: Inputs,
    /// The PLC with its memory.
    pub plc: Plc,
    /// The scan stands still for stepping.
    pub halted: bool,
    /// The ladder that runs at the next power-on, if it is another one.
    pub next_ladder: Option<Arc<Ladder>>,
    /// Why the control would not take a ladder now.
    pub ladder_refused: Option<Refusal>,
    /// The parameters.
    pub parameters: Parameters,
    /// The pitch error table.
    pub pitch: PitchTable,
    /// Why the control would not take parameters now.
    pub parameters_refused: Option<Refusal>,
    /// The tool offsets.
    pub offsets: OffsetTable,
    /// The macro variables.
    pub variables: VariableTable,
    /// Alarms and messages that stand, the newest first.
    pub alarms: Vec<String>,
}

/// The tool offsets at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct OffsetTable {
    /// Their values.
    pub rows: Offsets,
    /// How lengths are shown.
    pub display: CoordinateFormat,
    /// Why the control would not take any now.
    pub refused: Option<Refusal>,
}

/// The macro variables at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableTable {
    /// Number and value; `None`: null.
    pub rows: Vec<(u16, Option<f64>)>,
    /// They take values with a fraction.
    pub real: bool,
    /// Why the control would not take any now.
    pub refused: Option<Refusal>,
}

impl VariableTable {
    fn of(cnc: &Cnc) -> Self {
        let real = cnc.variables_are_real();
        let value = |number: u16| match real {
            true => cnc.real_variable(number),
            // 33 bits at most.
            false => cnc.variables().get(number).map(|value| value as f64),
        };
        let numbers = cnc.variable_numbers().into_iter();
        Self {
            rows: numbers.map(|number| (number, value(number))).collect(),
            real,
            refused: cnc.rights().variables().err(),
        }
    }
}

impl MachineView {
    /// As it is now.
    pub fn of(emulator: &Emulator) -> Self {
        let simulation = &emulator.simulation;
        let cnc = &simulation.cnc;
        let alarms = cnc.alarms().iter().map(Alarm::line_text);
        let messages = cnc
            .plc_messages()
            .map(|(number, text)| format!("{number:04} {text}"));
        Self {
            lathe: simulation.lathe.clone(),
            inputs: simulation.lathe.inputs(),
            plc: cnc.plc().clone(),
            halted: cnc.ladder_halted(),
            next_ladder: cnc.next_ladder().cloned(),
            ladder_refused: cnc.rights().ladder().err(),
            parameters: cnc.parameters().clone(),
            pitch: cnc.pitch().clone(),
            parameters_refused: cnc.rights().parameters().err(),
            offsets: OffsetTable {
                rows: cnc.offsets().clone(),
                display: CoordinateFormat::of(cnc),
                refused: cnc.rights().offsets().err(),
            },
            variables: VariableTable::of(cnc),
            alarms: alarms.chain(messages).collect(),
        }
    }
}
