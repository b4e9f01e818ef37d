//! Parameters by name: display, keys, and locks of writing.

use super::ControlParameters;
use crate::units::Axis;

impl ControlParameters {
    /// Parameter 002.5 RS232: whether the serial port is active.
    pub fn has_serial_port(&self) -> bool {
        self.bit(2, 5)
    }

    /// Parameter 044: baud rate of the serial port, bit/s.
    pub fn baud(&self) -> u32 {
        u32::try_from(self.value(44)).unwrap_or_default()
    }

    /// Parameter 004.2 DCS: whether the key 输出 starts an MDI block.
    pub fn output_key_starts(&self) -> bool {
        self.bit(4, 2)
    }

    /// Parameter 010.5 NOFC: whether offsets cannot be taken from the relative coordinates.
    pub(crate) fn is_counter_input_locked(&self) -> bool {
        self.bit(10, 5)
    }

    /// Parameter 012.5 DOFSI: whether a measured diameter or length may be typed as an offset.
    pub(crate) fn can_type_measured_offsets(&self) -> bool {
        self.bit(12, 5)
    }

    /// Parameter 012.4 PRG9: whether programs O9000 and above are hidden.
    pub(crate) fn are_upper_programs_hidden(&self) -> bool {
        self.bit(12, 4)
    }

    /// Parameter 012.3 EAL: whether programs may be edited while an alarm is active.
    pub(crate) fn can_edit_in_alarm(&self) -> bool {
        self.bit(12, 3)
    }

    /// Parameter 012.1 EBCL: whether the end of a block is shown as `;`; otherwise as `*`.
    pub fn semicolon_ends_blocks(&self) -> bool {
        self.bit(12, 1)
    }

    /// Parameter 019 THDCH: width of a thread's run-out, in tenths of its lead.
    pub(crate) fn run_out_tenths(&self) -> i32 {
        self.value(19)
    }

    /// Parameter 042 SEQINC: increment of the sequence numbers that the editor writes.
    pub fn block_number_step(&self) -> u16 {
        u16::try_from(self.value(42)).unwrap_or(0)
    }

    /// Parameter 119: number of keys accepted at the same time.
    pub fn simultaneous_key_limit(&self) -> usize {
        self.value(119).clamp(1, 15) as usize
    }

    /// Parameter 172.2 MPWE: whether the parameter switch is masked: it cannot be operated, and
    /// parameters are locked.
    pub(crate) fn is_parameter_switch_masked(&self) -> bool {
        self.bit(172, 2)
    }

    /// Parameter 172.1 SKEY: whether the program switch is masked: it cannot be operated, and
    /// programs are locked.
    pub(crate) fn is_program_switch_masked(&self) -> bool {
        self.bit(172, 1)
    }

    /// Parameter 173.2 SWAT: whether the power-on screen waits for a display key.
    pub fn waits_at_power_on(&self) -> bool {
        self.bit(173, 2)
    }

    /// Parameter 174.3 KEY1: whether the program switch is on at power-on.
    pub(crate) fn program_switch_at_power_on(&self) -> bool {
        self.bit(174, 3)
    }

    /// Parameters 174.2–174.0 MD: code of the mode at power-on; `None` (174.4 MDOK = 0) for the
    /// mode of the last power-off.
    pub(crate) fn mode_at_power_on(&self) -> Option<u8> {
        self.bit(174, 4).then(|| self.byte(174) & 0b111)
    }

    /// Parameter 175.0 XVAL: whether the upper arrow key is X+.
    pub fn is_up_positive(&self) -> bool {
        self.bit(175, 0)
    }

    /// Parameter 175.1 ZVAL: whether the left arrow key is Z+.
    pub fn is_left_positive(&self) -> bool {
        self.bit(175, 1)
    }

    /// Legend of the axis key that moves the tool in a direction of its axis.
    pub(crate) fn axis_key(&self, axis: Axis, is_positive: bool) -> &'static str {
        match axis {
            Axis::X if is_positive == self.is_up_positive() => "X ↑",
            Axis::X => "↓ X",
            Axis::Z if is_positive == self.is_left_positive() => "← Z",
            Axis::Z => "Z →",
        }
    }

    /// Parameter 180.0 SPOS: whether the position page shows the distance to go.
    pub fn shows_remaining(&self) -> bool {
        self.bit(180, 0)
    }

    /// Parameter 184.0 CH_EN: whether the screen is in English.
    pub fn is_english(&self) -> bool {
        self.bit(184, 0)
    }
}
