//! Views of machine and PLC for fault bench, ladder view, commissioning and data editing.

use std::sync::Arc;

use gsk_core::alarm::Alarm;
use gsk_core::cnc::Cnc;
use gsk_core::machine::{MachineInputs, SimulatedLathe};
use gsk_core::memory::{ControlParameters, Offsets, PitchTable, WriteRefusal};
use gsk_core::plc::{Ladder, Plc};
use gsk_panel::emulator::Emulator;
use gsk_panel::pages::CoordinateFormat;

/// State of machine, control data and PLC at one moment, made only while a view shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct MachineView {
    pub lathe: SimulatedLathe,
    /// Whether the faults of the lathe are not shown, because an exercise is to find them.
    pub hides_faults: bool,
    /// States of the machine's contacts and sensors.
    pub inputs: MachineInputs,
    pub plc: Plc,
    /// Whether the scan of the PLC is halted for single steps.
    pub halted: bool,
    /// The ladder that runs from the next power-on; `None` if it is the current one.
    pub next_ladder: Option<Arc<Ladder>>,
    /// The reason why the control would refuse a new ladder at the moment; `None` if it would
    /// accept one.
    pub ladder_refused: Option<WriteRefusal>,
    pub parameters: ControlParameters,
    pub pitch: PitchTable,
    /// The reason why the control would refuse parameters at the moment; `None` if it would accept
    /// them.
    pub parameters_refused: Option<WriteRefusal>,
    pub offsets: OffsetTable,
    pub variables: VariableTable,
    pub alarms: MachineAlarms,
}

/// The active alarms, and the active messages of the PLC.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MachineAlarms {
    /// The alarms, the newest first.
    pub alarms: Vec<Alarm>,
    /// Number of each message with the text that the machine builder has written.
    pub plc_messages: Vec<String>,
}

/// The tool offsets at one moment, their display format, and whether they may be written.
#[derive(Clone, Debug, PartialEq)]
pub struct OffsetTable {
    pub rows: Offsets,
    /// Format in which the offsets are displayed.
    pub display: CoordinateFormat,
    /// The reason why the control would refuse tool offsets at the moment; `None` if it would
    /// accept them.
    pub refused: Option<WriteRefusal>,
}

/// The macro variables at one moment, and whether they may be written.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableTable {
    /// Number and value of each variable; the value is `None` if it is null (empty).
    pub rows: Vec<(u16, Option<f64>)>,
    /// Whether variables may have a fraction.
    pub real: bool,
    /// The reason why the control would refuse variables at the moment; `None` if it would accept
    /// them.
    pub refused: Option<WriteRefusal>,
}

/// Number and value of each variable of a control; the value is `None` if it is null (empty).
pub(super) fn variable_values(cnc: &Cnc) -> impl Iterator<Item = (u16, Option<f64>)> {
    let value = |number: u16| match cnc.are_variables_real() {
        true => cnc.real_variable(number),
        // 33 bits at most.
        false => cnc.variables().get(number).map(|value| value as f64),
    };
    let numbers = cnc.variable_numbers().into_iter();
    numbers.map(move |number| (number, value(number)))
}

impl VariableTable {
    fn from_cnc(cnc: &Cnc) -> Self {
        Self {
            rows: variable_values(cnc).collect(),
            real: cnc.are_variables_real(),
            refused: cnc.rights().check_variables().err(),
        }
    }
}

impl MachineView {
    /// Creates a view of the current state of an emulator.
    pub fn from_emulator(emulator: &Emulator) -> Self {
        let simulation = emulator.simulation();
        let cnc = &simulation.cnc;
        let messages = cnc
            .plc_messages()
            .map(|(number, text)| format!("{number:04} {text}"));
        Self {
            lathe: simulation.lathe.clone(),
            hides_faults: false,
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
            alarms: MachineAlarms {
                alarms: cnc.alarms().to_vec(),
                plc_messages: messages.collect(),
            },
        }
    }
}
