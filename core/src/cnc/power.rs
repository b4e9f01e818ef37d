//! Power-on of the control, and the state that a power-off keeps.

use gsk_plc::Plc;
use gsk_plc::address::{Area, BitAddress};

use super::ladder::preset_plc;
use super::parts::{
    CncRun, Coordinates, DriveUnit, ManualMotion, PlcPort, SpindleUnit, WriteSwitches,
};
use super::{Cnc, DncLine, SerialPort};
use crate::command::SpindleCommand;
use crate::interpreter::Interpreter;
use crate::interpreter::MachineCodes;
use crate::memory::Registers;
use crate::operation::ActiveAlarms;
use crate::setup::{Setup, TOOL_IN_POSITION};
use crate::units::{Axis, PerAxis};

/// Output Y1.2, M03: the spindle turns forward.
const M03_OUTPUT: BitAddress = BitAddress::new(Area::Y, 1, 2);

impl Cnc {
    /// Creates a control at power-on, from the retained memory of `setup`.
    pub fn new(setup: Setup) -> Self {
        let tool = setup.tool_in_position();
        let referenced = PerAxis::new(setup.is_referenced(Axis::X), setup.is_referenced(Axis::Z));
        let mut memory = setup.memory;
        memory.power_on();
        let capacity = memory.model.record().capacity;
        memory.programs.set_capacity(capacity);
        let parameters = &memory.parameters;
        let mut plc = Plc::new(setup.ladder.compiled());
        if let Some(retained) = &setup.plc_retained {
            plc.memory_mut().restore_retained(retained);
        }
        plc.power_on();
        plc.memory_mut().set_k(TOOL_IN_POSITION, tool);
        preset_plc(plc.memory_mut(), parameters);
        let mut spindle = SpindleUnit::new(parameters);
        if let Some(speed) = setup.spindle_rpm {
            spindle.control.command(SpindleCommand::Speed(speed));
            plc.memory_mut().set_bit(M03_OUTPUT, true);
        }
        let mut interpreter = Interpreter::new(parameters);
        interpreter.set_inch_input(memory.settings.inch);
        interpreter.set_macro_b(memory.settings.macro_b);
        interpreter.set_model(&memory.model);
        interpreter.set_tool(tool);
        interpreter.set_machine_codes(MachineCodes::from_declared(plc.ladder().m_codes()));
        let start = setup.start.unwrap_or_default();
        let absolute = setup
            .absolute
            .filter(|_| !parameters.power_off_loses_coordinates());
        let mut cnc = Self {
            switches: WriteSwitches {
                parameters: false,
                programs: parameters.program_switch_at_power_on(),
            },
            at_power_on: parameters.clone(),
            plc: PlcPort::new(plc),
            serial_port: SerialPort::Idle,
            dnc: DncLine::default(),
            run: CncRun::new(interpreter, tool, Registers::new(setup.day_time)),
            drives: DriveUnit::new(&memory, start),
            hand: ManualMotion::default(),
            spindle,
            coordinates: Coordinates {
                referenced,
                ..Coordinates::default()
            },
            alarms: ActiveAlarms::default(),
            emergency_stop: false,
            reset_left_ms: 0,
            ticks: 0,
            events: Vec::new(),
            memory,
        };
        cnc.set_program_outputs(0);
        if let Some(absolute) = absolute {
            cnc.coordinates.frame.zero = start - absolute;
            cnc.settle_coordinates();
        }
        for alarm in setup.alarms {
            cnc.raise(alarm);
        }
        cnc
    }

    /// Switches the power off and on: retained data is kept, all other state is as at power-on.
    /// With 004.7 ABOT = 0 the absolute coordinates are kept (manual III-2.1).
    pub fn power_cycle(&mut self) {
        let position = self.position();
        let setup = Setup {
            memory: self.memory.clone(),
            ladder: self.plc.ladder_at_power_on().into(),
            plc_retained: Some(self.plc.engine.memory().retained()),
            start: Some(position),
            absolute: Some(self.coordinates.frame.to_program(position)),
            referenced: false,
            zero_kept: self.reference_without_switch(),
            day_time: self.run.registers.day_time(self.ticks),
            ..Setup::default()
        };
        *self = Self::new(setup);
    }
}
