//! Contacts of the machine signals by byte and bit (manual III-2.2, plugs XS39 and XS40).
//! Some pins carry one of several signals.

use gsk_link::SpindleDirection;
use gsk_plc::PlcMemory;

/// An X or Y contact: byte and bit.
pub(crate) type ContactPin = (u8, u8);

/// T01–T08, station switches. T05 may be *SPEN or *OV1, T06 *OV2, T07 M41I, WQPJ
/// or *OV4, T08 M42I, NQPJ, *STEN or *OV8.
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
/// *DECX.
pub(crate) const DECELERATION_X: ContactPin = (0, 3);
/// *ESP.
pub(crate) const EMERGENCY_STOP: ContactPin = (0, 5);
/// *TCP, or PRES.
pub(crate) const TOOL_CLAMPED: ContactPin = (0, 7);
/// *DECZ.
pub(crate) const DECELERATION_Z: ContactPin = (1, 3);
/// *SP, or SAGT.
pub(crate) const DOOR: ContactPin = (1, 5);

/// S1 or M41, S2 or M42, S3 or M43, S4 or M44.
pub(crate) const SPEEDS: [ContactPin; 4] = [(1, 0), (0, 0), (0, 1), (1, 3)];
/// M03.
pub(crate) const FORWARD: ContactPin = (1, 2);
/// M04.
pub(crate) const REVERSE: ContactPin = (0, 4);
/// SPZD.
pub(crate) const BRAKE: ContactPin = (0, 7);
/// TL+.
pub(crate) const TURRET_FORWARD: ContactPin = (1, 6);
/// TL-.
pub(crate) const TURRET_REVERSE: ContactPin = (1, 7);
/// DOQPJ.
pub(crate) const CHUCK_INWARD: ContactPin = (0, 6);
/// DOQPS.
pub(crate) const CHUCK_OUTWARD: ContactPin = (1, 5);
/// DOTWJ.
pub(crate) const TAILSTOCK_OUT: ContactPin = (0, 2);
/// DOTWS.
pub(crate) const TAILSTOCK_BACK: ContactPin = (1, 4);
/// M08.
pub(crate) const COOLANT: ContactPin = (0, 3);
/// M32.
pub(crate) const LUBRICATION: ContactPin = (1, 1);

/// Direction of the spindle, from the outputs of the ladder.
pub(crate) fn spindle_direction(memory: &PlcMemory) -> SpindleDirection {
    let is_on = |(byte, bit): ContactPin| memory.y(u16::from(byte)) >> bit & 1 == 1;
    match (is_on(FORWARD), is_on(REVERSE), is_on(BRAKE)) {
        (true, false, false) => SpindleDirection::Forward,
        (false, true, false) => SpindleDirection::Reverse,
        _ => SpindleDirection::Stop,
    }
}
