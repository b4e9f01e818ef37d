//! Where the machine's signals are wired (manual III-2.2, plugs XS39 and XS40):
//! byte and bit. Some pins carry one of several signals.

/// An X or Y contact: byte and bit.
pub(super) type Pin = (u8, u8);

/// T01–T08, station switches. T05 may be *SPEN or *OV1, T06 *OV2, T07 M41I, WQPJ
/// or *OV4, T08 M42I, NQPJ, *STEN or *OV8.
pub(super) const STATIONS: [Pin; 8] = [
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
pub(super) const DECELERATION_X: Pin = (0, 3);
/// *ESP.
pub(super) const EMERGENCY_STOP: Pin = (0, 5);
/// *TCP, or PRES.
pub(super) const TOOL_CLAMPED: Pin = (0, 7);
/// *DECZ.
pub(super) const DECELERATION_Z: Pin = (1, 3);
/// *SP, or SAGT.
pub(super) const DOOR: Pin = (1, 5);

/// S1 or M41, S2 or M42, S3 or M43, S4 or M44.
pub(super) const SPEEDS: [Pin; 4] = [(1, 0), (0, 0), (0, 1), (1, 3)];
/// M03.
pub(super) const FORWARD: Pin = (1, 2);
/// M04.
pub(super) const REVERSE: Pin = (0, 4);
/// SPZD.
pub(super) const BRAKE: Pin = (0, 7);
/// TL+.
pub(super) const TURRET_FORWARD: Pin = (1, 6);
/// TL-.
pub(super) const TURRET_REVERSE: Pin = (1, 7);
/// DOQPJ.
pub(super) const CHUCK_INWARD: Pin = (0, 6);
/// DOQPS.
pub(super) const CHUCK_OUTWARD: Pin = (1, 5);
/// DOTWJ.
pub(super) const TAILSTOCK_OUT: Pin = (0, 2);
/// DOTWS.
pub(super) const TAILSTOCK_BACK: Pin = (1, 4);
/// M08.
pub(super) const COOLANT: Pin = (0, 3);
/// M32.
pub(super) const LUBRICATION: Pin = (1, 1);
