//! The control's side of the PLC interface: the G signals it reads and the F signals it
//! writes. The addresses of the signals are defined here only.

use gsk_plc::PlcMemory;
use serde::{Deserialize, Serialize};

use super::handshake::{Handshake, Strobe};
use crate::memory::ControlParameters;
use crate::mode::OperatingMode;
use crate::units::{Axis, PerAxis};

/// The G signals of the ladder, decoded once after every PLC slot.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FromPlc {
    /// FIN, G4.3: the M, S or T function is finished.
    pub fin: bool,
    /// AFL, G5.6: auxiliary lock, M, S and T are not output.
    pub auxiliary_lock: bool,
    /// OVC, G6.4: the feed override is fixed at 100 %.
    pub override_cancel: bool,
    /// STLK, G7.1: start lock; the axes stop and the cycle stays started.
    pub start_lock: bool,
    /// ST, G7.2: cycle start on its falling edge.
    pub start: bool,
    /// *IT, G8.0: true if the signal is 0 and all axes are locked.
    pub interlock: bool,
    /// *ESP, G8.4: true if the signal is 0 and the emergency stop is in force.
    pub emergency_stop: bool,
    /// *SP, G8.5: true if the signal is 0 and feed hold is requested.
    pub feed_hold: bool,
    /// ERS, G8.7: the external reset is requested.
    pub external_reset: bool,
    /// Jog rate code, G10 and G11 (0 = 150 % … 15 = 0 %).
    pub jog_code: u8,
    /// Feed override, 0–150 %, from G12.
    pub feed_override: u8,
    /// Rapid override, % (0 = F0), from G14, or from G96 in steps of 1 %.
    pub rapid_override: u8,
    /// RT, G19.7: manual rapid is selected.
    pub rapid: bool,
    /// SAR, G29.4: the spindle has reached its speed.
    pub speed_arrival: bool,
    /// Spindle override, 50–120 %, from G30.
    pub spindle_override: u8,
    /// Code of the operating mode, G43.
    pub mode_code: u8,
    /// HS1A, HS1B, G18: the axis that the handwheel moves; `None`: no axis.
    pub wheel_axis: Option<Axis>,
    /// MP1, MP2, G19.4 and G19.5: least increments per step or graduation: 1, 10, 100 or
    /// 1000.
    pub step_increments: u16,
    /// BDT, G44.0: blocks with `/` are skipped.
    pub block_skip: bool,
    /// MLK, G44.1: machine lock of all axes, without the locks of single axes (G108). MMLK
    /// repeats it.
    #[serde(default)]
    #[serde(rename = "all_locked")]
    pub all_axes_locked: bool,
    /// MLK, G44.1 or G108: machine lock of each axis.
    pub machine_lock: PerAxis<bool>,
    /// HDT, G44.7: index the tool post by one station.
    pub next_tool: bool,
    /// SBK, G46.1: single block is on.
    pub single_block: bool,
    /// KEY1, G46.3: programs, offsets and parameters are protected.
    pub memory_protect: bool,
    /// DRN, G46.7: dry run is on.
    pub dry_run: bool,
    /// SRVB, G74.4: the spindle turns forward.
    pub spindle_forward: bool,
    /// SFRB, G74.5: the spindle turns in reverse.
    pub spindle_reverse: bool,
    /// +J, G100: jog in the positive direction.
    pub jog_plus: PerAxis<bool>,
    /// -J, G102: jog in the negative direction.
    pub jog_minus: PerAxis<bool>,
    /// *+L, G114: true if the signal is 0 and the axis is at its positive limit.
    pub limit_plus: PerAxis<bool>,
    /// *-L, G116: true if the signal is 0 and the axis is at its negative limit.
    pub limit_minus: PerAxis<bool>,
    /// IT1, IT2, G130: the axis is locked.
    pub axis_interlock: PerAxis<bool>,
    /// +MIT1, +MIT2, G132: the axis is locked in its positive direction.
    pub plus_interlock: PerAxis<bool>,
    /// -MIT1, -MIT2, G134: the axis is locked in its negative direction.
    pub minus_interlock: PerAxis<bool>,
    /// SPHD, G200.0: spindle jog is requested.
    pub spindle_jog: bool,
    /// NOWT, G201–G204: number of the tool in position; above 255 it counts as 255.
    pub current_tool: u8,
}

const fn is_set(byte: u8, bit: u8) -> bool {
    byte & (1 << bit) != 0
}

const fn axis_bits(byte: u8) -> PerAxis<bool> {
    PerAxis::new(is_set(byte, 0), is_set(byte, 1))
}

const fn inverted_axis_bits(byte: u8) -> PerAxis<bool> {
    axis_bits(!byte)
}

/// Rapid override, % (0 = F0), from ROV1 and ROV2, or from the 1 % code if HROV selects
/// it.
fn rapid_override(g14: u8, g96: u8) -> u8 {
    if is_set(g96, 7) {
        return (!g96 & 0x7f).min(100);
    }
    match g14 & 0b11 {
        0 => 100,
        2 => 50,
        1 => 25,
        _ => 0,
    }
}

const fn spindle_override(g30: u8) -> u8 {
    match g30 {
        7 => 50,
        6 => 60,
        2 => 70,
        3 => 80,
        1 => 90,
        4 => 110,
        5 => 120,
        _ => 100,
    }
}

/// Number of the tool in position, from 32 bits of NOWT; above 255 it counts as 255.
fn current_tool(nowt: [u8; 4]) -> u8 {
    u8::try_from(u32::from_le_bytes(nowt)).unwrap_or(u8::MAX)
}

impl FromPlc {
    /// Decodes the G area of the PLC memory.
    pub fn read(memory: &PlcMemory) -> Self {
        let g = |number: u16| memory.g(number);
        let all_axes_locked = is_set(g(44), 1);
        let locked = axis_bits(g(108));
        Self {
            fin: is_set(g(4), 3),
            auxiliary_lock: is_set(g(5), 6),
            override_cancel: is_set(g(6), 4),
            start_lock: is_set(g(7), 1),
            start: is_set(g(7), 2),
            interlock: !is_set(g(8), 0),
            emergency_stop: !is_set(g(8), 4),
            feed_hold: !is_set(g(8), 5),
            external_reset: is_set(g(8), 7),
            jog_code: if g(11) == 0 { g(10).min(15) } else { 15 },
            feed_override: (15 - g(12).min(15)) * 10,
            rapid_override: rapid_override(g(14), g(96)),
            rapid: is_set(g(19), 7),
            speed_arrival: is_set(g(29), 4),
            spindle_override: spindle_override(g(30)),
            mode_code: g(43),
            wheel_axis: match g(18) & 0b11 {
                1 => Some(Axis::X),
                2 => Some(Axis::Z),
                _ => None,
            },
            step_increments: match g(19) >> 4 & 0b11 {
                0 => 1,
                1 => 10,
                2 => 100,
                _ => 1000,
            },
            block_skip: is_set(g(44), 0),
            all_axes_locked,
            machine_lock: PerAxis::new(all_axes_locked || locked.x, all_axes_locked || locked.z),
            next_tool: is_set(g(44), 7),
            single_block: is_set(g(46), 1),
            memory_protect: is_set(g(46), 3),
            dry_run: is_set(g(46), 7),
            spindle_forward: is_set(g(74), 4),
            spindle_reverse: is_set(g(74), 5),
            jog_plus: axis_bits(g(100)),
            jog_minus: axis_bits(g(102)),
            limit_plus: inverted_axis_bits(g(114)),
            limit_minus: inverted_axis_bits(g(116)),
            axis_interlock: axis_bits(g(130)),
            plus_interlock: axis_bits(g(132)),
            minus_interlock: axis_bits(g(134)),
            spindle_jog: is_set(g(200), 0),
            current_tool: current_tool([g(201), g(202), g(203), g(204)]),
        }
    }
}

/// The state of the control that is reported to the ladder in F signals.
pub struct ToPlc<'a> {
    /// Operating mode that is reported in F3 and F4.
    pub mode: OperatingMode,
    /// STL: a block is being executed.
    pub started: bool,
    /// SPL: the run is in feed hold.
    pub holding: bool,
    /// OP: automatic operation is in progress.
    pub operating: bool,
    /// AL: an alarm is active.
    pub alarm: bool,
    /// RST: the reset signal is on.
    pub reset: bool,
    /// DEN: everything in the block except FIN is done.
    pub distribution_end: bool,
    /// SA: the drives are ready.
    pub servo_ready: bool,
    /// RPDO: the last motion that began was a rapid.
    pub rapid: bool,
    /// CUT: a cutting feed of automatic operation is being executed.
    pub cutting: bool,
    /// Whether the dwell of a G04 is running.
    pub dwelling: bool,
    /// RTAP: a tap is being executed.
    pub tapping: bool,
    /// The M code whose decode signal DM00, DM01, DM02 or DM30 is 1; `None`: all are 0.
    pub decoded: Option<u8>,
    /// Codes and strobes of the M, S and T functions.
    pub handshake: &'a Handshake,
    /// Number of the gear in force (M41–M44), 1–4.
    pub gear: u8,
    /// ZP: the axis is at the reference point.
    pub at_reference: PerAxis<bool>,
    /// ZRF: the reference point is established.
    pub referenced: PerAxis<bool>,
    /// PRO: the axis is at the program zero.
    pub at_program_zero: PerAxis<bool>,
    /// MV: the axis is moving.
    pub moving: PerAxis<bool>,
    /// MVD: the last motion of the axis was in the negative direction.
    pub negative: PerAxis<bool>,
    /// OUTO: the OUTPUT key is down in MDI mode.
    pub output_key: bool,
    /// F213.0: data is being sent through the serial port.
    pub sending: bool,
    /// F213.1: data is being received through the serial port.
    pub receiving: bool,
    /// BGEACT: a program is being received while another one runs.
    pub receiving_in_background: bool,
    /// COVL: the feed override in force is 0 %.
    pub stopped_by_override: bool,
    /// CINP: the slides have not completed the commanded motion.
    pub board_lags: bool,
    /// Switches of the soft machine panel, as the bits of F75.
    pub soft_switches: u8,
    /// MA: the control is ready; false with a system alarm.
    pub ready: bool,
    /// MSPHD: the spindle is jogged.
    pub spindle_jog: bool,
    /// Parameters, some of which F200–F214 repeat for the ladder.
    pub parameters: &'a ControlParameters,
}

const fn pack(bits: &[(u8, bool)]) -> u8 {
    let mut byte = 0;
    let mut i = 0;
    while i < bits.len() {
        if bits[i].1 {
            byte |= 1 << bits[i].0;
        }
        i += 1;
    }
    byte
}

const fn pack_axes(axes: PerAxis<bool>) -> u8 {
    pack(&[(0, axes.x), (1, axes.z)])
}

/// State parameters whose bytes the ladder can read: (F byte, parameter number).
const MIRRORED: [(u16, u16); 9] = [
    (200, 1),
    (201, 4),
    (204, 9),
    (205, 11),
    (208, 164),
    (209, 168),
    (210, 172),
    (211, 173),
    (214, 175),
];

impl ToPlc<'_> {
    /// Writes the F area. `g` are the G signals whose states some F signals repeat.
    pub fn write(&self, memory: &mut PlcMemory, g: &FromPlc) {
        let mut set = |number: u16, byte: u8| memory.set_f(number, byte);
        set(
            0,
            pack(&[
                (4, self.holding),
                (5, self.started),
                (6, self.servo_ready),
                (7, self.operating),
            ]),
        );
        set(
            1,
            pack(&[
                (0, self.alarm),
                (1, self.reset),
                (3, self.distribution_end),
                (7, self.ready),
            ]),
        );
        set(
            2,
            pack(&[(1, self.rapid), (6, self.cutting), (7, g.dry_run)]),
        );
        set(
            3,
            u8::from(self.mode.teaches()) << 7
                | match self.mode.motion_mode() {
                    OperatingMode::Step => 1 << 0,
                    OperatingMode::Handwheel => 1 << 1,
                    OperatingMode::Jog => 1 << 2,
                    OperatingMode::Mdi => 1 << 3,
                    OperatingMode::Dnc => 1 << 4,
                    OperatingMode::Auto => 1 << 5,
                    OperatingMode::Edit => 1 << 6,
                    _ => 0,
                },
        );
        set(
            4,
            pack(&[
                (0, g.block_skip),
                (1, g.all_axes_locked),
                (3, g.single_block),
                (4, g.auxiliary_lock),
                (5, self.mode == OperatingMode::MachineZero),
                (6, self.mode == OperatingMode::ProgramZero),
            ]),
        );
        set(
            7,
            pack(&[
                (0, self.handshake.is_strobe_up(Strobe::M)),
                (2, self.handshake.is_strobe_up(Strobe::S)),
                (3, self.handshake.is_strobe_up(Strobe::T)),
            ]),
        );
        set(
            9,
            pack(&[
                (4, self.decoded == Some(30)),
                (5, self.decoded == Some(2)),
                (6, self.decoded == Some(1)),
                (7, self.decoded == Some(0)),
            ]),
        );
        set(10, self.handshake.m);
        for (index, byte) in self.handshake.s.to_le_bytes().into_iter().enumerate() {
            set(22 + index as u16, byte);
        }
        set(26, self.handshake.t);
        set(34, 1 << (self.gear.clamp(1, 4) - 1));
        set(53, pack(&[(4, self.receiving_in_background)]));
        set(75, self.soft_switches);
        set(76, pack(&[(3, self.tapping)]));
        set(94, pack_axes(self.at_reference));
        set(102, pack_axes(self.moving));
        set(106, pack_axes(self.negative));
        set(120, pack_axes(self.referenced));
        set(197, pack(&[(1, self.output_key)]));
        set(198, pack_axes(self.at_program_zero));
        set(199, u8::from(self.spindle_jog));
        set(
            212,
            pack(&[
                (2, self.dwelling),
                (3, self.board_lags),
                (4, self.stopped_by_override),
            ]),
        );
        set(213, pack(&[(0, self.sending), (1, self.receiving)]));
        set(207, self.parameters.station_count());
        for (f, parameter) in MIRRORED {
            set(f, self.parameters.byte(parameter));
        }
    }
}
