//! What can be explained, and the conditions of the control that come before the ladder.

use gsk_core::cnc::Cnc;
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use super::bit_log::BitLog;
use super::chain::{CauseChain, CauseFact};
use super::ladder_cause::LadderTracer;
use crate::emulator::Emulator;
use crate::keys::{Key, lamp_of};

/// G7.2: cycle start; its falling edge starts the program.
const CYCLE_START: BitAddress = BitAddress::new(Area::G, 7, 2);
/// G8.5: feed hold, 0 holds.
const FEED_HOLD: BitAddress = BitAddress::new(Area::G, 8, 5);

/// A state that can be explained.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CauseSubject {
    /// The value of a bit.
    Bit(BitAddress),
    /// A key that has no effect, or what it acts on.
    Key(Key),
    /// An axis that stands still.
    Axis(Axis),
    /// An alarm with this number.
    Alarm(u16),
}

impl CauseSubject {
    /// Parses `Y5.3`, `CYCLE-START`, `axis X`, `alarm 207`, `lamp COOLANT`; `None` for another
    /// text.
    pub fn parse(words: &[&str]) -> Option<Self> {
        match words {
            ["axis", "X" | "x"] => Some(Self::Axis(Axis::X)),
            ["axis", "Z" | "z"] => Some(Self::Axis(Axis::Z)),
            ["alarm", number] => number.parse().ok().map(Self::Alarm),
            ["lamp", name] => lamp_of(name)
                .map(|lamp| Self::Bit(BitAddress::new(Area::Y, lamp.byte, lamp.bit))),
            [word] => match word.parse() {
                Ok(bit) => Some(Self::Bit(bit)),
                Err(_) => Key::from_id(word).map(Self::Key),
            },
            _ => None,
        }
    }
}

/// Explains the present state of a subject.
pub(super) fn explain(emulator: &Emulator, subject: CauseSubject, log: &BitLog) -> CauseChain {
    let cnc = emulator.cnc();
    let mut chain = CauseChain::default();
    let mut tracer = LadderTracer::new(cnc, log);
    match subject {
        CauseSubject::Bit(bit) => tracer.trace_bit(bit, 0, &mut chain),
        CauseSubject::Key(key) => explain_key(emulator, key, &mut tracer, &mut chain),
        CauseSubject::Axis(axis) => explain_axis(cnc, axis, &mut tracer, &mut chain),
        CauseSubject::Alarm(number) => explain_alarm(cnc, number, &mut tracer, &mut chain),
    }
    chain
}

fn condition(depth: usize, message: Message, chain: &mut CauseChain) {
    chain.push(depth, CauseFact::Condition(message));
}

fn explain_key(
    emulator: &Emulator,
    key: Key,
    tracer: &mut LadderTracer<'_>,
    chain: &mut CauseChain,
) {
    let cnc = emulator.cnc();
    let refusal = match key {
        Key::CycleStart => cnc.start_refusal(),
        Key::XUp | Key::XDown => cnc.axis_key_refusal(Axis::X),
        Key::ZLeft | Key::ZRight => cnc.axis_key_refusal(Axis::Z),
        _ => emulator.panel().refuses(key, cnc),
    };
    let is_refused = refusal.is_some();
    condition(
        0,
        refusal.unwrap_or_else(|| say::why_key_acts(key.id())),
        chain,
    );
    if key == Key::CycleStart && is_refused {
        explain_active_alarm(cnc, 1, tracer, chain);
    }
    if let Some(contact) = key.contact() {
        let contact = BitAddress::new(Area::X, contact.byte, contact.bit);
        tracer.trace_bit(contact, 1, chain);
    }
    match key {
        Key::CycleStart => {
            tracer.trace_bit(CYCLE_START, 1, chain);
            tracer.trace_bit(FEED_HOLD, 1, chain);
        }
        _ => {
            if let Some(lamp) = key.row().lamp {
                let lamp = BitAddress::new(Area::Y, lamp.byte, lamp.bit);
                tracer.trace_bit(lamp, 1, chain);
            }
        }
    }
}

/// Adds the alarm or message that is active, and its cause.
fn explain_active_alarm(
    cnc: &Cnc,
    depth: usize,
    tracer: &mut LadderTracer<'_>,
    chain: &mut CauseChain,
) {
    let message = cnc.active_message();
    if let Some(alarm) = cnc.alarms().first().or(message.as_ref()) {
        add_alarm(cnc, alarm.number, depth, tracer, chain);
    }
}

fn explain_axis(cnc: &Cnc, axis: Axis, tracer: &mut LadderTracer<'_>, chain: &mut CauseChain) {
    let reason = cnc
        .wait_reason()
        .or_else(|| cnc.axis_key_refusal(axis).filter(|_| !cnc.is_moving()));
    let reason = match reason {
        Some(reason) => reason,
        None if cnc.is_moving() => say::why_axis_moves(axis),
        None => say::why_axis_without_command(axis),
    };
    condition(0, reason, chain);
    explain_active_alarm(cnc, 1, tracer, chain);
    // Interlock of all axes, feed hold, interlock of this axis.
    let own = match axis {
        Axis::X => BitAddress::new(Area::G, 130, 0),
        Axis::Z => BitAddress::new(Area::G, 130, 1),
    };
    for bit in [BitAddress::new(Area::G, 8, 0), FEED_HOLD, own] {
        tracer.trace_bit(bit, 1, chain);
    }
}

fn explain_alarm(cnc: &Cnc, number: u16, tracer: &mut LadderTracer<'_>, chain: &mut CauseChain) {
    let message = cnc.active_message();
    let mut active = cnc.alarms().iter().chain(message.as_ref());
    if active.any(|alarm| alarm.number == number) {
        add_alarm(cnc, number, 0, tracer, chain);
    } else {
        condition(0, say::why_alarm_inactive(number), chain);
    }
}

fn add_alarm(
    cnc: &Cnc,
    number: u16,
    depth: usize,
    tracer: &mut LadderTracer<'_>,
    chain: &mut CauseChain,
) {
    let message = cnc.active_message();
    let found = cnc.alarms().iter().chain(message.as_ref());
    let Some(alarm) = found.into_iter().find(|alarm| alarm.number == number) else {
        return;
    };
    let reason = alarm.reason();
    condition(depth, say::why_alarm(number, reason), chain);
    if let Some(source) = alarm.source {
        condition(depth + 1, say::why_block(source.line), chain);
    }
    let ladder_bit = cnc.plc().ladder().messages().iter();
    let ladder_bit = ladder_bit.filter(|it| it.number == number).map(|it| it.bit);
    for bit in ladder_bit {
        tracer.trace_bit(bit, depth + 1, chain);
    }
    // The emergency stop: its contact and the ladder's request.
    if number == gsk_core::alarm::number::EMERGENCY_STOP {
        tracer.trace_bit(BitAddress::new(Area::X, 0, 5), depth + 1, chain);
        tracer.trace_bit(BitAddress::new(Area::G, 8, 4), depth + 1, chain);
    }
}
