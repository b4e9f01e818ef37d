//! What can be explained, and the conditions of the control that come before the ladder.

use gsk_core::alarm::Alarm;
use gsk_core::alarm::number::EMERGENCY_STOP;
use gsk_core::cnc::Cnc;
use gsk_core::operation::RunState;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::units::Axis;
use gsk_messages::{Language, say};

use super::bit_log::BitLog;
use super::chain::CauseChain;
use super::ladder_cause::LadderTracer;
use crate::emulator::Emulator;
use crate::keys::{Key, lamp_of};
use crate::refusal::present_reason;

/// G7.2: cycle start; the program starts when the signal changes from 1 to 0.
const CYCLE_START: BitAddress = BitAddress::new(Area::G, 7, 2);
/// G8.4: emergency stop; the signal stops the machine while it is 0.
const EMERGENCY_SIGNAL: BitAddress = BitAddress::new(Area::G, 8, 4);
/// G44.1: machine lock of all axes.
const MACHINE_LOCK: BitAddress = BitAddress::new(Area::G, 44, 1);
/// G46.1: single block.
const SINGLE_BLOCK: BitAddress = BitAddress::new(Area::G, 46, 1);

/// The state of the machine that is to be explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CauseSubject {
    /// Explains the value of a PLC bit.
    Bit(BitAddress),
    /// Explains a key: why it has no effect, or what it acts on.
    Key(Key),
    /// Explains why an axis stands still.
    Axis(Axis),
    /// Explains the alarm or message with this number.
    Alarm(u16),
}

impl CauseSubject {
    /// Parses `bit Y5.3`, `lamp COOLANT`, `key CS`, `axis X` or `alarm 207`; `None` for another
    /// text.
    pub fn parse(kind: &str, name: &str) -> Option<Self> {
        match kind {
            "bit" => name.parse().ok().map(Self::Bit),
            "lamp" => lamp_of(name).map(|lamp| Self::Bit(lamp_bit(lamp))),
            "key" => Key::from_id(name).map(Self::Key),
            "axis" if name == "X" => Some(Self::Axis(Axis::X)),
            "axis" if name == "Z" => Some(Self::Axis(Axis::Z)),
            "alarm" => name.parse().ok().map(Self::Alarm),
            _ => None,
        }
    }
}

impl core::fmt::Display for CauseSubject {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Bit(bit) => write!(f, "bit {}", bit.short_name()),
            Self::Key(key) => write!(f, "key {}", key.id()),
            Self::Axis(axis) => write!(f, "axis {axis}"),
            Self::Alarm(number) => write!(f, "alarm {number:03}"),
        }
    }
}

const fn lamp_bit(lamp: crate::keys::Bit) -> BitAddress {
    BitAddress::new(Area::Y, lamp.byte, lamp.bit)
}

/// Explains the present state of a subject. `log` has the times at which bits have changed.
pub fn explain(emulator: &Emulator, subject: CauseSubject, log: &BitLog) -> CauseChain {
    let mut tracer = LadderTracer::new(emulator, log);
    let cnc = emulator.cnc();
    if !emulator.panel().powered() {
        tracer.add_condition(&say::key_power_off(), 0);
        return tracer.chain;
    }
    match subject {
        CauseSubject::Bit(bit) => tracer.trace_bit_once(bit, 0),
        CauseSubject::Key(key) => explain_key(emulator, key, &mut tracer),
        CauseSubject::Axis(axis) => explain_axis(cnc, axis, &mut tracer),
        CauseSubject::Alarm(number) => match active_alarms(cnc).find(|it| it.number == number) {
            Some(alarm) => add_alarm(cnc, &alarm, 0, &mut tracer),
            None => tracer.add_condition(&say::why_alarm_inactive(number), 0),
        },
    }
    tracer.chain
}

fn active_alarms(cnc: &Cnc) -> impl Iterator<Item = Alarm> {
    cnc.alarms().iter().cloned().chain(cnc.active_message())
}

fn explain_key(emulator: &Emulator, key: Key, tracer: &mut LadderTracer<'_>) {
    let cnc = emulator.cnc();
    let by_page = emulator.panel().refuses(key, cnc);
    let refusal = by_page.or_else(|| present_reason(key, cnc));
    match &refusal {
        Some(reason) => tracer.add_condition(reason, 0),
        None => tracer.add_condition(&say::why_key_acts(key.id()), 0),
    }
    if refusal.is_some() {
        add_active_alarm(cnc, 1, tracer);
    }
    if let Some(contact) = key.contact() {
        tracer.trace_bit_once(BitAddress::new(Area::X, contact.byte, contact.bit), 1);
    }
    if key == Key::CycleStart {
        tracer.trace_bit_once(CYCLE_START, 1);
    } else if let Some(lamp) = key.row().lamp {
        tracer.trace_bit_once(lamp_bit(lamp), 1);
    }
}

/// Adds the alarm or message that is active, and its cause.
fn add_active_alarm(cnc: &Cnc, depth: usize, tracer: &mut LadderTracer<'_>) {
    if let Some(alarm) = active_alarms(cnc).next() {
        add_alarm(cnc, &alarm, depth, tracer);
    }
}

fn explain_axis(cnc: &Cnc, axis: Axis, tracer: &mut LadderTracer<'_>) {
    let in_manual_mode = cnc.mode().is_manual();
    let by_key = || cnc.axis_key_refusal(axis).filter(|_| in_manual_mode);
    if cnc.is_moving() {
        tracer.add_condition(&say::why_axis_moves(axis), 0);
    } else if let Some(reason) = cnc.wait_reason() {
        tracer.add_condition(&reason, 0);
        add_active_alarm(cnc, 1, tracer);
    } else if active_alarms(cnc).next().is_some() {
        add_active_alarm(cnc, 0, tracer);
    } else {
        let no_key = say::axis_key_held_by_ladder();
        let reason = by_key().filter(|reason| *reason != no_key);
        let reason = reason.unwrap_or_else(|| say::why_axis_without_command(axis));
        tracer.add_condition(&reason, 0);
    }
    if cnc.run_state() == RunState::Stop && tracer.bit(SINGLE_BLOCK) {
        tracer.trace_bit_once(SINGLE_BLOCK, 1);
    }
    if tracer.bit(MACHINE_LOCK) {
        tracer.trace_bit_once(MACHINE_LOCK, 1);
    }
}

fn add_alarm(cnc: &Cnc, alarm: &Alarm, depth: usize, tracer: &mut LadderTracer<'_>) {
    let number = alarm.number;
    match &alarm.detail {
        Some(detail) => tracer.add_condition(&say::why_alarm(number, detail.clone()), depth),
        None => tracer.chain.push(depth, None, |language| {
            say::why_alarm(number, say::as_written(alarm.text(language)))
        }),
    }
    if let Some(source) = alarm.source {
        tracer.add_condition(&say::why_block(source.line), depth + 1);
    }
    tracer.add_faults(depth + 1);
    let messages = cnc.plc().ladder().messages().iter();
    for message in messages.filter(|it| it.number == number) {
        tracer.trace_bit_once(message.bit, depth + 1);
    }
    if number == EMERGENCY_STOP {
        tracer.trace_bit_once(EMERGENCY_SIGNAL, depth + 1);
    }
    if let Some(advice) = alarm.advice() {
        tracer.chain.push_remedy(depth + 1, |language| {
            let remedy = match language {
                Language::Zh => advice.remedy_zh,
                Language::En => advice.remedy_en,
            };
            say::why_remedy(say::as_written(remedy))
        });
    }
}
