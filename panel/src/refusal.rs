//! Explains why a pressed key has no effect, for the line beside the panel. The LCD shows only
//! what the manual describes.
//!
//! Page and text keys are checked when they are pressed, by page and mode. Machine keys act
//! through the ladder. They are checked a little later, by the ladder's reaction.

use gsk_core::cnc::Cnc;
use gsk_core::operation::{OperatingMode, RunState};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_core::units::Axis;
use gsk_messages::{Message, say};

use crate::keys::Key;

/// Delay after which a pressed machine key is checked, ticks. By then the contact is debounced
/// and the whole ladder has run with it.
pub const CHECK_DELAY_TICKS: u64 = 48;

/// PLC signal by which the ladder requests cycle start.
const START: BitAddress = BitAddress::new(Area::G, 7, 2);
const NEXT_TOOL: BitAddress = BitAddress::new(Area::G, 44, 7);
const TOOL_STROBE: BitAddress = BitAddress::new(Area::F, 7, 3);
const FORWARD: BitAddress = BitAddress::new(Area::G, 74, 4);
const REVERSE: BitAddress = BitAddress::new(Area::G, 74, 5);
const WHEEL_X: BitAddress = BitAddress::new(Area::G, 18, 0);
const WHEEL_Z: BitAddress = BitAddress::new(Area::G, 18, 1);

/// The control's state before a key press, to find out whether the press changed it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct StateBefore {
    run: RunState,
    /// Overrides of feed, rapid and spindle, %.
    overrides: [u8; 3],
}

impl StateBefore {
    const fn read(cnc: &Cnc) -> Self {
        Self {
            run: cnc.run_state(),
            overrides: [
                cnc.feed_override(),
                cnc.rapid_override(),
                cnc.spindle_override(),
            ],
        }
    }
}

/// A pressed machine key, with the state of the control at that moment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeyPress {
    key: Key,
    before: StateBefore,
}

impl KeyPress {
    /// Records that a key was pressed; `None` if it is not a machine key.
    pub fn new(key: Key, cnc: &Cnc) -> Option<Self> {
        key.contact().map(|_| Self {
            key,
            before: StateBefore::read(cnc),
        })
    }

    /// Returns the key that was pressed.
    pub const fn key(&self) -> Key {
        self.key
    }

    /// Returns why the key has no effect, if it was pressed [`CHECK_DELAY_TICKS`] ticks ago
    /// and is still down. Returns `None` if it acts or the ladder has not read it yet.
    pub fn refusal_reason(&self, cnc: &Cnc) -> Option<Message> {
        machine_key_reason(self.key, cnc).or_else(|| no_change_reason(self.key, self.before, cnc))
    }
}

/// The least and greatest override of feed, rapid and spindle, % (G12, G14, G30).
const OVERRIDE_LIMITS: [(u8, u8); 3] = [(0, 150), (0, 100), (50, 120)];

/// Returns why the press of an override or hold key has changed nothing; `None` if it did or
/// the key does not have to.
fn no_change_reason(key: Key, before: StateBefore, cnc: &Cnc) -> Option<Message> {
    let now = StateBefore::read(cnc);
    let index = match key {
        Key::FeedHold => return feed_hold_reason(before.run),
        Key::FeedOverrideUp | Key::FeedOverrideDown => 0,
        Key::RapidOverrideUp | Key::RapidOverrideDown => 1,
        Key::SpindleOverrideUp | Key::SpindleOverrideDown => 2,
        _ => return None,
    };
    let percent = now.overrides[index];
    let (least, greatest) = OVERRIDE_LIMITS[index];
    if percent != before.overrides[index] {
        return None;
    }
    Some(match index {
        _ if least < percent && percent < greatest => say::key_override_not_taken(),
        0 => say::key_feed_override_at_end(percent),
        1 => say::key_rapid_override_at_end(percent),
        _ => say::key_spindle_override_at_end(percent),
    })
}

fn feed_hold_reason(before: RunState) -> Option<Message> {
    match before {
        RunState::Run => None,
        RunState::Hold => Some(say::key_program_is_held()),
        RunState::Stop | RunState::Reset => Some(say::key_nothing_to_hold()),
    }
}

/// Returns why a machine key that is down has no effect in the current state; `None` if it
/// acts.
fn machine_key_reason(key: Key, cnc: &Cnc) -> Option<Message> {
    let contact = key.contact()?;
    let memory = cnc.plc().memory();
    if !memory.bit(BitAddress::new(Area::X, contact.byte, contact.bit)) {
        return None;
    }
    let on = |bit| memory.bit(bit);
    let why = match key {
        Key::CycleStart => return cycle_start_reason(cnc, on(START)),
        Key::XUp | Key::XDown => return cnc.axis_key_refusal(Axis::X),
        Key::ZLeft | Key::ZRight => return cnc.axis_key_refusal(Axis::Z),
        Key::WheelY | Key::YMinus | Key::YPlus => say::key_no_y_axis(),
        Key::SpindleForward if !on(FORWARD) => spindle_reason(cnc)?,
        Key::SpindleReverse if !on(REVERSE) => spindle_reason(cnc)?,
        Key::SpindleForward | Key::SpindleReverse => speed_reason(cnc)?,
        Key::SpindleStop if on(FORWARD) || on(REVERSE) => say::key_acts_in_manual_modes(),
        Key::ToolChange if !on(NEXT_TOOL) && !on(TOOL_STROBE) => tool_change_reason(cnc)?,
        Key::WheelX if !on(WHEEL_X) => handwheel_reason(cnc),
        Key::WheelZ if !on(WHEEL_Z) => handwheel_reason(cnc),
        _ => return mode_reason(key, cnc),
    };
    Some(why)
}

/// Returns why the mode or a parameter forbids a machine key; `None` if neither does.
fn mode_reason(key: Key, cnc: &Cnc) -> Option<Message> {
    let why = match key {
        Key::Lubrication if !is_manual(cnc) => say::key_acts_in_manual_modes(),
        Key::Rapid | Key::RapidOverrideUp | Key::RapidOverrideDown
            if matches!(cnc.mode(), OperatingMode::Edit | OperatingMode::Handwheel) =>
        {
            say::key_not_in_edit_and_handwheel()
        }
        Key::Increment1 | Key::Increment10 | Key::Increment100
            if !matches!(cnc.mode(), OperatingMode::Step | OperatingMode::Handwheel) =>
        {
            say::key_step_size_in_step_mode()
        }
        Key::Increment100 if cnc.parameters().has_small_steps_only() => {
            say::key_large_steps_locked()
        }
        _ => return None,
    };
    Some(why)
}

/// Returns why a machine key has no effect, or would have none if it were pressed now; `None` if
/// nothing prevents it.
pub fn present_reason(key: Key, cnc: &Cnc) -> Option<Message> {
    let contact = key.contact()?;
    let contact = BitAddress::new(Area::X, contact.byte, contact.bit);
    if cnc.plc().memory().bit(contact) {
        return machine_key_reason(key, cnc);
    }
    let without_key = |why: &Message| *why != say::axis_key_held_by_ladder();
    match key {
        Key::CycleStart => cnc.start_refusal(),
        Key::FeedHold => feed_hold_reason(cnc.run_state()),
        Key::XUp | Key::XDown => cnc.axis_key_refusal(Axis::X).filter(without_key),
        Key::ZLeft | Key::ZRight => cnc.axis_key_refusal(Axis::Z).filter(without_key),
        Key::SpindleForward | Key::SpindleReverse if !is_manual(cnc) => spindle_reason(cnc),
        Key::ToolChange => tool_change_reason(cnc),
        Key::WheelX | Key::WheelZ if cnc.mode() != OperatingMode::Handwheel => {
            Some(handwheel_reason(cnc))
        }
        _ => mode_reason(key, cnc),
    }
}

/// Returns whether the mode allows the keys of spindle, tool post and lubrication.
const fn is_manual(cnc: &Cnc) -> bool {
    cnc.mode().is_manual()
}

fn cycle_start_reason(cnc: &Cnc, passed: bool) -> Option<Message> {
    cnc.start_refusal()
        .or_else(|| (!passed).then(say::key_ladder_holds_cycle_start))
}

/// Returns why a spindle key has no effect; `None` in an alarm, which the ladder's message
/// explains already.
fn spindle_reason(cnc: &Cnc) -> Option<Message> {
    if !is_manual(cnc) {
        return Some(say::key_acts_in_manual_modes());
    }
    (!cnc.is_in_alarm()).then(say::key_ladder_holds_spindle)
}

fn speed_reason(cnc: &Cnc) -> Option<Message> {
    let is_zero = cnc.parameters().has_analog_spindle() && cnc.spindle_commanded() == 0.0;
    is_zero.then(say::key_spindle_without_speed)
}

fn tool_change_reason(cnc: &Cnc) -> Option<Message> {
    if !is_manual(cnc) {
        Some(say::key_acts_in_manual_modes())
    } else if cnc.parameters().station_count() < 2 {
        Some(say::key_no_tool_post())
    } else {
        None
    }
}

fn handwheel_reason(cnc: &Cnc) -> Message {
    match cnc.mode() {
        OperatingMode::Step => say::key_handwheel_in_step_mode(),
        _ => say::key_handwheel_axis_in_step_mode(),
    }
}
