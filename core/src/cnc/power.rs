//! The control at power-on, and what stays over a power-off.

use gsk_plc::Plc;
use gsk_plc::address::{Area, BitAddress};

use super::ladder::preset_plc;
use super::{Cnc, SerialPort};
use crate::axis::{AxisChain, SoftLimits};
use crate::command::{Frame, SpindleCommand};
use crate::interpreter::{Interpreter, MachineCodes};
use crate::motion::{Interpolator, MotionLimits};
use crate::operation::{
    ActiveAlarms, Automatic, DriveWatch, FromPlc, Handshake, InputFilter, Mode, Sensors,
    WheelCounter, X_BYTES,
};
use crate::program::MdiBlock;
use crate::setup::{Setup, TOOL_IN_POSITION};
use crate::spindle::{SpindleAngle, SpindleControl};
use crate::units::{Axis, PerAxis, Point};

/// Y1.2, M03: the spindle turns forward.
const M03_OUTPUT: BitAddress = BitAddress::new(Area::Y, 1, 2);

impl Cnc {
    /// A control at power-on.
    pub fn new(setup: Setup) -> Self {
        let tool = setup.tool_in_position();
        let referenced = PerAxis::new(setup.is_referenced(Axis::X), setup.is_referenced(Axis::Z));
        let mut parameters = setup.parameters;
        parameters.power_on();
        let mut authority = setup.authority;
        authority.power_on();
        let mut plc = Plc::new(setup.ladder);
        if let Some(retained) = &setup.plc_retained {
            plc.memory_mut().restore_retained(retained);
        }
        plc.power_on();
        plc.memory_mut().set_k(TOOL_IN_POSITION, tool);
        preset_plc(plc.memory_mut(), &parameters);
        let mut interpreter = Interpreter::new(&parameters);
        interpreter.set_inch_input(setup.settings.inch);
        interpreter.set_tool(tool);
        interpreter.set_machine_codes(MachineCodes::of(plc.ladder()));
        let modal = *interpreter.modal();
        let start = setup.start.unwrap_or_default();
        let mut axes = AxisChain::new(&parameters, &setup.pitch);
        axes.preset(Axis::X, start.x);
        axes.preset(Axis::Z, start.z);
        let mut spindle = SpindleControl::new(&parameters);
        if let Some(speed) = setup.spindle_rpm {
            spindle.command(SpindleCommand::Speed(speed));
            plc.memory_mut().set_bit(M03_OUTPUT, true);
        }
        let from_plc = FromPlc::read(plc.memory());
        let absolute = setup
            .absolute
            .filter(|_| !parameters.power_off_loses_coordinates());
        let mut cnc = Self {
            limits: MotionLimits::from(&parameters),
            soft_limits: SoftLimits::new(&parameters),
            spindle,
            angle: SpindleAngle::new(&parameters),
            spindle_override: 100,
            programmed_ahead: 0.0,
            at_power_on: parameters.clone(),
            parameter_switch: false,
            program_switch: parameters.bit(174, 3),
            parameters,
            offsets: setup.offsets,
            pitch: setup.pitch,
            variables: setup.variables,
            settings: setup.settings,
            authority,
            disks: setup.disks,
            programs: setup.programs,
            counters: setup.counters,
            mdi: MdiBlock::default(),
            interpreter,
            plc,
            from_plc,
            filter: InputFilter::default(),
            panel_keys: [0; X_BYTES],
            turning: None,
            output_key: false,
            serial_port: SerialPort::Idle,
            soft_switches: 0,
            plc_halted: false,
            next_ladder: None,
            plc_message: false,
            sensors: Sensors::default(),
            drives: DriveWatch::default(),
            mode: Mode::Mdi,
            automatic: Automatic::default(),
            handshake: Handshake::default(),
            alarms: ActiveAlarms::default(),
            emergency_stop: false,
            reset_left: 0,
            modal,
            tool: (tool, 0),
            indexing_by_hand: false,
            interpolator: Interpolator::new(start),
            held: None,
            jog_blocked: PerAxis::default(),
            jog_command: PerAxis::default(),
            axis_keys: PerAxis::default(),
            wheel: WheelCounter::default(),
            returns: PerAxis::default(),
            axes,
            board: None,
            frame: Frame::default(),
            relative_zero: Point::default(),
            program_zero: None,
            referenced,
            at_reference: PerAxis::default(),
            negative: PerAxis::default(),
            last_rapid: false,
            cursor_line: 1,
            rewind_at_start: false,
            ticks: 0,
            y: vec![0; 20],
            explanations: None,
            events: Vec::new(),
        };
        if let Some(absolute) = absolute {
            cnc.frame.zero = start - absolute;
            cnc.settle_coordinates();
        }
        for alarm in setup.alarms {
            cnc.raise(alarm);
        }
        cnc
    }

    /// Power off and on: what is retained stays, all else starts anew. The
    /// absolute coordinates stay with 004.7 ABOT = 0 (manual III-2.1).
    pub fn power_cycle(&mut self) {
        let position = self.position();
        let setup = Setup {
            parameters: self.parameters.clone(),
            offsets: self.offsets.clone(),
            pitch: self.pitch.clone(),
            variables: self.variables.clone(),
            settings: self.settings,
            authority: self.authority.clone(),
            disks: self.disks.clone(),
            ladder: self.ladder_at_power_on(),
            plc_retained: Some(self.plc.memory().retained()),
            programs: self.programs.clone(),
            counters: self.counters,
            start: Some(position),
            absolute: Some(self.frame.program(position)),
            referenced: false,
            zero_kept: self.reference_without_switch(),
            ..Setup::default()
        };
        *self = Self::new(setup);
    }
}
