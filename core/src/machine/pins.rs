//! Contacts of the machine signals by byte and bit (manual III-2.2, plugs XS39 and XS40).
//! Some pins carry one of several signals.

use gsk_link::SpindleDirection;
use gsk_plc::PlcMemory;

/// A contact or output as byte and bit of the X or Y area.
pub(crate) type ContactPin = (u8, u8);

/// Station switches T01–T08 of the tool post. T05 may be *SPEN or *OV1, T06 *OV2, T07
/// M41I, WQPJ or *OV4, T08 M42I, NQPJ, *STEN or *OV8.
pub(crate) const STATIONS: [ContactPin; 8] = [
    (1, 6),
    (1, 7),
    (0, 0),
    (0, 1),
    (0, 4),
    (1, 0),
    (1, 1),
    (1, 2),
];
/// X0.3, *DECX: deceleration switch of X.
pub(crate) const DECELERATION_X: ContactPin = (0, 3);
/// X0.5, *ESP: contact of the emergency-stop loop.
pub(crate) const EMERGENCY_STOP: ContactPin = (0, 5);
/// X0.7, *TCP: tool post clamped; or PRES: pressure.
pub(crate) const TOOL_CLAMPED: ContactPin = (0, 7);
/// X1.3, *DECZ: deceleration switch of Z.
pub(crate) const DECELERATION_Z: ContactPin = (1, 3);
/// X1.5, *SP: feed hold; or SAGT: guard door.
pub(crate) const DOOR: ContactPin = (1, 5);

/// Outputs of the spindle speeds S1–S4, or of the gears M41–M44.
pub(crate) const SPEEDS: [ContactPin; 4] = [(1, 0), (0, 0), (0, 1), (1, 3)];
/// Y1.2, M03: the spindle turns forward.
pub(crate) const FORWARD: ContactPin = (1, 2);
/// Y0.4, M04: the spindle turns in reverse.
pub(crate) const REVERSE: ContactPin = (0, 4);
/// Y0.7, SPZD: applies the spindle brake.
pub(crate) const BRAKE: ContactPin = (0, 7);
/// Y1.6, TL+: the tool post turns forward.
pub(crate) const TURRET_FORWARD: ContactPin = (1, 6);
/// Y1.7, TL-: the tool post turns in reverse, which seats and clamps it.
pub(crate) const TURRET_REVERSE: ContactPin = (1, 7);
/// Y0.6, DOQPJ: the chuck moves inwards.
pub(crate) const CHUCK_INWARD: ContactPin = (0, 6);
/// Y1.5, DOQPS: the chuck moves outwards.
pub(crate) const CHUCK_OUTWARD: ContactPin = (1, 5);
/// Y0.2, DOTWJ: the tailstock moves out.
pub(crate) const TAILSTOCK_OUT: ContactPin = (0, 2);
/// Y1.4, DOTWS: the tailstock moves back.
pub(crate) const TAILSTOCK_BACK: ContactPin = (1, 4);
/// Y0.3, M08: switches the coolant.
pub(crate) const COOLANT: ContactPin = (0, 3);
/// Y1.1, M32: switches the lubrication.
pub(crate) const LUBRICATION: ContactPin = (1, 1);

/// Direction that the ladder's outputs M03 and M04 command; stop while the brake is on.
pub(crate) fn spindle_direction(memory: &PlcMemory) -> SpindleDirection {
    let is_on = |(byte, bit): ContactPin| memory.y(u16::from(byte)) >> bit & 1 == 1;
    match (is_on(FORWARD), is_on(REVERSE), is_on(BRAKE)) {
        (true, false, false) => SpindleDirection::Forward,
        (false, true, false) => SpindleDirection::Reverse,
        _ => SpindleDirection::Stop,
    }
}
