//! Views of machine and PLC for fault bench, ladder view, commissioning and data editing.

use std::sync::Arc;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;
use gsk_core::machine::{MachineInputs, SimulatedLathe};
use gsk_core::memory::{ControlParameters, Offsets, PitchTable, WriteRefusal};
use gsk_core::plc::{Ladder, Plc};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::CoordinateFormat;

/// Machine and PLC at one moment. The kernel makes it only while a view shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineView {
    pub lathe: SimulatedLathe,
    /// Inputs of the machine: contacts and sensors.
    pub inputs: MachineInputs,
    pub plc: Plc,
    /// The scan of the PLC is halted for stepping.
    pub halted: bool,
    /// The ladder that runs from the next power-on, if it differs from the current one.
    pub next_ladder: Option<Arc<Ladder>>,
    /// Why the control would refuse a ladder now; `None`: it would take one.
    pub ladder_refused: Option<WriteRefusal>,
    pub parameters: ControlParameters,
    pub pitch: PitchTable,
    /// Why the control would refuse parameters now; `None`: it would take them.
    pub parameters_refused: Option<WriteRefusal>,
    pub offsets: OffsetTable,
    pub variables: VariableTable,
    /// Active alarms and messages, the newest first.
    pub alarms: Vec<String>,
}

/// The tool offsets at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct OffsetTable {
    pub rows: Offsets,
    /// Display format of lengths.
    pub display: CoordinateFormat,
    /// Why the control would refuse tool offsets now; `None`: it would take them.
    pub refused: Option<WriteRefusal>,
}

/// The macro variables at one moment.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableTable {
    /// Number of the variable and its value; `None`: null (empty).
    pub rows: Vec<(u16, Option<f64>)>,
    /// Variables take values with a fraction.
    pub real: bool,
    /// Why the control would refuse variables now; `None`: it would take them.
    pub refused: Option<WriteRefusal>,
}

impl VariableTable {
    fn from_cnc(cnc: &Cnc) -> Self {
        let real = cnc.are_variables_real();
        let value = |number: u16| match real {
            true => cnc.real_variable(number),
            // 33 bits at most.
            false => cnc.variables().get(number).map(|value| value as f64),
        };
        let numbers = cnc.variable_numbers().into_iter();
        Self {
            rows: numbers.map(|number| (number, value(number))).collect(),
            real,
            refused: cnc.rights().check_variables().err(),
        }
    }
}

impl MachineView {
    /// Returns the current state of an emulator.
    pub fn from_emulator(emulator: &Emulator) -> Self {
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
            halted: cnc.is_ladder_halted(),
            next_ladder: cnc.next_ladder().cloned(),
            ladder_refused: cnc.rights().check_ladder().err(),
            parameters: cnc.parameters().clone(),
            pitch: cnc.pitch().clone(),
            parameters_refused: cnc.rights().check_parameters().err(),
            offsets: OffsetTable {
                rows: cnc.offsets().clone(),
                display: CoordinateFormat::of(cnc),
                refused: cnc.rights().check_offsets().err(),
            },
            variables: VariableTable::from_cnc(cnc),
            alarms: alarms.chain(messages).collect(),
        }
    }
}
