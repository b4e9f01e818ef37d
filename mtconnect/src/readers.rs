//! Reads each data item from control and lathe. X is a diameter, as on the control's display.

use std::sync::Arc;

use gsk_core::alarm::AlarmClass;
use gsk_core::cnc::Cnc;
use gsk_core::command::ProgramId;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::units::Point;

use crate::value::{AgentValue, MachineLoad, MachineSource, tool_asset_id};

/// Greatest length of a block text in an observation, characters.
const MAX_BLOCK_CHARACTERS: usize = 256;
/// Number of seconds in a minute: feeds are in mm/min in the control and in mm/s in a document.
const MINUTE_S: f64 = 60.0;

/// Creates a number rounded to a thousandth, so that changes below the display are not observed.
fn thousandths(value: f64) -> AgentValue {
    AgentValue::Number(round_to_thousandth(value))
}

/// Rounds to a thousandth; the result is never -0.
pub(crate) fn round_to_thousandth(value: f64) -> f64 {
    (value * 1000.0).round() / 1000.0 + 0.0
}

fn text(text: impl Into<Arc<str>>) -> AgentValue {
    AgentValue::Text(text.into())
}

fn on_off(is_on: bool) -> AgentValue {
    AgentValue::Word(if is_on { "ON" } else { "OFF" })
}

fn point_value(point: Point) -> AgentValue {
    let x = round_to_thousandth(point.diameter().0);
    AgentValue::Point([x, 0.0, round_to_thousandth(point.z)])
}

fn seconds(ms: u64) -> AgentValue {
    AgentValue::Number((ms / 1000) as f64)
}

pub(crate) const fn unavailable(_: &MachineSource<'_>) -> AgentValue {
    AgentValue::Unavailable
}

pub(crate) const fn availability(_: &MachineSource<'_>) -> AgentValue {
    AgentValue::Word("AVAILABLE")
}

pub(crate) fn x_machine(from: &MachineSource<'_>) -> AgentValue {
    thousandths(from.cnc.position_machine().diameter().0)
}

pub(crate) fn x_work(from: &MachineSource<'_>) -> AgentValue {
    thousandths(from.cnc.position_absolute().diameter().0)
}

pub(crate) fn z_machine(from: &MachineSource<'_>) -> AgentValue {
    thousandths(from.cnc.position_machine().z)
}

pub(crate) fn z_work(from: &MachineSource<'_>) -> AgentValue {
    thousandths(from.cnc.position_absolute().z)
}

/// Reads a load, % to a tenth. A board does not measure it.
fn load(from: &MachineSource<'_>, select: impl FnOnce(MachineLoad) -> f64) -> AgentValue {
    let load = from.load.filter(|_| !from.cnc.has_board());
    load.map_or(AgentValue::Unavailable, |load| {
        AgentValue::Number((select(load) * 10.0).round() / 10.0)
    })
}

pub(crate) fn x_load(from: &MachineSource<'_>) -> AgentValue {
    load(from, |load| load.x)
}

pub(crate) fn z_load(from: &MachineSource<'_>) -> AgentValue {
    load(from, |load| load.z)
}

pub(crate) fn spindle_load(from: &MachineSource<'_>) -> AgentValue {
    load(from, |load| load.spindle)
}

pub(crate) fn path_machine(from: &MachineSource<'_>) -> AgentValue {
    point_value(from.cnc.position_machine())
}

pub(crate) fn path_work(from: &MachineSource<'_>) -> AgentValue {
    point_value(from.cnc.position_absolute())
}

/// Reads the measured spindle speed, r/min: of the board's spindle, of the encoder, or of the
/// simulated spindle.
pub(crate) fn speed_actual(from: &MachineSource<'_>) -> AgentValue {
    let simulated = || (!from.cnc.has_board()).then(|| from.lathe.spindle_rpm());
    let measured = (from.cnc.board_spindle_rpm())
        .or_else(|| from.cnc.spindle_measured())
        .or_else(simulated);
    measured.map_or(AgentValue::Unavailable, |rpm| {
        AgentValue::Number(rpm.abs().round())
    })
}

pub(crate) fn speed_commanded(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Number(from.cnc.spindle_switched().abs().round())
}

pub(crate) fn spindle_override(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Number(f64::from(from.cnc.spindle_override()))
}

pub(crate) fn spindle_direction(from: &MachineSource<'_>) -> AgentValue {
    match from.cnc.spindle_m_code() {
        3 => AgentValue::Word("CLOCKWISE"),
        4 => AgentValue::Word("COUNTER_CLOCKWISE"),
        // Most versions of the schemas have no word for a spindle that stands.
        _ => AgentValue::Unavailable,
    }
}

pub(crate) const fn rotary_mode(_: &MachineSource<'_>) -> AgentValue {
    AgentValue::Word("SPINDLE")
}

/// Reads whether the power chuck of the simulated lathe is open. A board has no input for it.
pub(crate) fn chuck_state(from: &MachineSource<'_>) -> AgentValue {
    if from.cnc.has_board() || !from.cnc.parameters().has_chuck() {
        return AgentValue::Unavailable;
    }
    let is_clamped = from.lathe.is_chuck_clamped();
    AgentValue::Word(if is_clamped { "CLOSED" } else { "OPEN" })
}

pub(crate) fn emergency_stop(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Word(if is_emergency_stopped(from.cnc) {
        "TRIGGERED"
    } else {
        "ARMED"
    })
}

fn is_emergency_stopped(cnc: &Cnc) -> bool {
    let mut alarms = cnc.alarms().iter();
    alarms.any(|alarm| alarm.class() == AlarmClass::EmergencyStop)
}

/// Reads number and text of the first active message of the PLC ladder.
pub(crate) fn message(from: &MachineSource<'_>) -> AgentValue {
    let first = from.cnc.plc_messages().next();
    first.map_or(AgentValue::Unavailable, |(number, message)| {
        text(format!("{number:04} {message}"))
    })
}

pub(crate) fn time_powered(from: &MachineSource<'_>) -> AgentValue {
    seconds(from.cnc.ticks())
}

pub(crate) fn time_operating(from: &MachineSource<'_>) -> AgentValue {
    seconds(from.cnc.counters().started_ms)
}

pub(crate) fn time_working(from: &MachineSource<'_>) -> AgentValue {
    seconds(from.cnc.counters().cutting_ms)
}

pub(crate) fn process_time(from: &MachineSource<'_>) -> AgentValue {
    seconds(from.run_ms)
}

pub(crate) fn feed_actual(from: &MachineSource<'_>) -> AgentValue {
    thousandths(from.cnc.feed_actual() / MINUTE_S)
}

/// Reads the programmed feed (F word) as a speed, mm/s; with G99 it is computed at the commanded
/// spindle speed.
pub(crate) fn feed_programmed(from: &MachineSource<'_>) -> AgentValue {
    let feed = from.cnc.feed_commanded();
    let per_minute = if from.cnc.modal().feed_per_revolution {
        feed * from.cnc.spindle_commanded()
    } else {
        feed
    };
    thousandths(per_minute / MINUTE_S)
}

pub(crate) fn feed_override(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Number(f64::from(from.cnc.feed_override()))
}

pub(crate) fn rapid_override(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Number(f64::from(from.cnc.rapid_override()))
}

pub(crate) const fn controller_mode(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Word(match from.cnc.mode() {
        OperatingMode::Auto | OperatingMode::Dnc => "AUTOMATIC",
        OperatingMode::Mdi => "MANUAL_DATA_INPUT",
        OperatingMode::Edit => "EDIT",
        _ => "MANUAL",
    })
}

pub(crate) fn execution(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Word(match from.cnc.run_state() {
        RunState::Run => "ACTIVE",
        RunState::Hold => "FEED_HOLD",
        RunState::Stop => "INTERRUPTED",
        RunState::Reset if from.cnc.is_in_alarm() => "STOPPED",
        RunState::Reset => "READY",
    })
}

/// Returns the name of a program in a document as the control model writes it, such as
/// `O0001`.
pub fn program_name(cnc: &Cnc, id: ProgramId) -> String {
    let number = match id {
        ProgramId::Stored(number) => Some(number),
        ProgramId::External | ProgramId::Dnc => {
            (cnc.programs().get(id)).and_then(gsk_core::program::Program::number)
        }
        ProgramId::Mdi => return "MDI".to_owned(),
    };
    match (number, id) {
        (Some(number), _) => cnc.model().record().program_naming().name(number),
        (None, ProgramId::Dnc) => "DNC".to_owned(),
        (None, _) => "EXTERNAL".to_owned(),
    }
}

pub(crate) fn program(from: &MachineSource<'_>) -> AgentValue {
    let program = from.cnc.cursor().program;
    program.map_or(AgentValue::Unavailable, |id| {
        text(program_name(from.cnc, id))
    })
}

/// Reads the text of the line at the cursor, at most 256 characters.
pub(crate) fn block(from: &MachineSource<'_>) -> AgentValue {
    let cursor = from.cnc.cursor();
    let line = match cursor.program {
        Some(ProgramId::Mdi) => return text(limited(&from.cnc.mdi_block().text())),
        Some(id) => (from.cnc.programs().get(id)).map(|program| program.line(cursor.line)),
        None => None,
    };
    line.map_or(AgentValue::Unavailable, |line| text(limited(line)))
}

fn limited(text: &str) -> &str {
    let text = text.trim();
    let end = text.char_indices().nth(MAX_BLOCK_CHARACTERS);
    end.map_or(text, |(end, _)| &text[..end])
}

pub(crate) fn line_number(from: &MachineSource<'_>) -> AgentValue {
    let cursor = from.cnc.cursor();
    match cursor.program {
        Some(_) => AgentValue::Number(f64::from(cursor.line)),
        None => AgentValue::Unavailable,
    }
}

pub(crate) fn line_label(from: &MachineSource<'_>) -> AgentValue {
    let sequence = from.cnc.cursor().sequence;
    sequence.map_or(AgentValue::Unavailable, |number| {
        text(format!("N{number:04}"))
    })
}

pub(crate) fn tool_number(from: &MachineSource<'_>) -> AgentValue {
    text(from.cnc.tool().0.to_string())
}

pub(crate) fn tool_asset(from: &MachineSource<'_>) -> AgentValue {
    let number = from.cnc.tool().0;
    let is_in_job = from.job.is_some_and(|job| job.tools.contains_key(&number));
    if is_in_job {
        text(tool_asset_id(number))
    } else {
        AgentValue::Unavailable
    }
}

pub(crate) fn part_count(from: &MachineSource<'_>) -> AgentValue {
    AgentValue::Number(f64::from(from.cnc.counters().parts))
}

pub(crate) fn parts_required(from: &MachineSource<'_>) -> AgentValue {
    match from.cnc.counters().required {
        0 => AgentValue::Unavailable,
        required => AgentValue::Number(f64::from(required)),
    }
}

pub(crate) fn single_block(from: &MachineSource<'_>) -> AgentValue {
    on_off(from.cnc.is_single_block_on())
}

pub(crate) fn dry_run(from: &MachineSource<'_>) -> AgentValue {
    on_off(from.cnc.is_dry_run_on())
}

pub(crate) fn machine_lock(from: &MachineSource<'_>) -> AgentValue {
    on_off(from.cnc.is_machine_locked())
}
