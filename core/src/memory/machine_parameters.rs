//! Parameters by name: the machine's equipment and the active levels of its contacts.

use super::{ControlParameters, parameter_row};
use crate::units::Axis;

impl ControlParameters {
    /// Parameters 008.0 DIRX, 008.1 DIRZ: whether pulses count up towards positive coordinates.
    pub(crate) fn counts_up(&self, axis: Axis) -> bool {
        self.axis_bit(8, axis)
    }

    /// Parameter 011.0 TCPS: level of the input *TCP (`true` = 1) while the tool post is clamped.
    pub(crate) fn tool_clamped_level(&self) -> bool {
        self.bit(11, 0)
    }

    /// Parameter 011.1 TSGN: level (`true` = 1) of the contact of the tool-post station in
    /// position.
    pub(crate) fn station_level(&self) -> bool {
        !self.bit(11, 1)
    }

    /// Parameter 011.4 ZDIL: whether axes may move while the spindle brake is on.
    pub(crate) fn can_move_under_brake(&self) -> bool {
        self.bit(11, 4)
    }

    /// Parameter 020: debounce width of the input filter, in samples of 4 ms.
    pub(crate) fn debounce_width(&self) -> i32 {
        self.value(20)
    }

    /// Parameter 021: gain of the analog spindle output; 625 is a gain of 1.
    pub(crate) fn analog_gain(&self) -> i32 {
        self.value(21)
    }

    /// Parameter 036 VELO: offset of the analog spindle output at speed 0, in units of 10 V / 8192.
    pub(crate) fn analog_zero(&self) -> i32 {
        self.value(36)
    }

    /// Parameter 067: spindle speed while a gear changes, r/min.
    pub(crate) fn gear_change_speed(&self) -> f64 {
        self.value(67).into()
    }

    /// Parameter 072: delay after spindle start until speed arrival is checked, ms.
    pub(crate) fn speed_arrival_delay_ms(&self) -> u32 {
        self.value(72).unsigned_abs()
    }

    /// Parameter 075: number of the tool in position; 0: unknown.
    pub(crate) fn tool_in_position(&self) -> u8 {
        u8::try_from(self.value(75)).unwrap_or(0)
    }

    /// Writes 075, the number of the tool in position; ignores a number out of range.
    pub(crate) fn remember_tool(&mut self, tool: u8) {
        let _ = self.set(75, tool.into());
    }

    /// Parameter 109: speed of the spindle jog, r/min.
    pub(crate) fn spindle_jog_speed(&self) -> f64 {
        self.value(109).into()
    }

    /// Whether parameters 110 and 111 are equal: the encoder turns as fast as the spindle.
    pub(crate) fn is_encoder_direct(&self) -> bool {
        self.value(110) == self.value(111)
    }

    /// Parameter 164.6 AGIN: whether a change to gear 1 or 2 waits for the in-position input of the
    /// gear. The enable inputs *SPEN and *STEN then have no pins.
    pub(crate) fn watches_gear(&self) -> bool {
        self.bit(164, 6)
    }

    /// Parameter 164.5 AGIM: level (`true` = 1) at which M41I and M42I report that the gear is
    /// engaged.
    pub(crate) fn gear_in_level(&self) -> bool {
        !self.bit(164, 5)
    }

    /// Parameter 164.5 AGIM: level (`true` = 1) at which *SPEN and *STEN enable.
    pub(crate) fn enable_level(&self) -> bool {
        self.bit(164, 5)
    }

    /// Parameter 164.4 STEN: whether cycle start needs its enable input *STEN.
    pub(crate) fn has_start_enable_input(&self) -> bool {
        self.bit(164, 4) && !self.watches_gear()
    }

    /// Parameter 164.3 SPEN: whether the spindle needs its enable input *SPEN.
    pub(crate) fn has_spindle_enable_input(&self) -> bool {
        self.bit(164, 3) && !self.watches_gear()
    }

    /// Parameter 164.2 SLTW: whether the machine has a tailstock.
    pub(crate) fn has_tailstock(&self) -> bool {
        self.bit(164, 2)
    }

    /// Parameter 164.0 SLQP: whether the machine has a power chuck.
    pub fn has_chuck(&self) -> bool {
        self.bit(164, 0)
    }

    /// Equips the machine with a power chuck: sets 164.0 SLQP, and 164.1 SLSP, which lets the
    /// spindle start with the chuck open.
    pub(crate) fn fit_chuck(&mut self) {
        self.set_option(164, 0);
        self.set_option(164, 1);
    }

    /// Equips the machine with an analog spindle: sets 001.4.
    pub(crate) fn fit_analog_spindle(&mut self) {
        self.set_option(1, 4);
    }

    fn set_option(&mut self, number: u16, bit: u8) {
        debug_assert!(
            parameter_row(number, Some(bit)).is_some(),
            "{number:03}.{bit} exists"
        );
        // Without a check: the table of parameters is long to read, and a preview needs no
        // other row of it.
        self.write_unchecked(number, self.value(number) | 1 << bit);
    }

    /// Parameter 168.0 PB1: whether the chuck clamps with the output DOQPS (outer chuck) instead of
    /// DOQPJ.
    pub(crate) fn is_outer_chuck(&self) -> bool {
        self.bit(168, 0)
    }

    /// Parameter 168.2 PB2: whether M12 and M13 wait for the in-position input of the chuck.
    pub(crate) fn watches_chuck(&self) -> bool {
        self.bit(168, 2)
    }

    /// Parameters 168.4 PB3, 168.5 SPB3: the level (`true` = 1) of the input that reports
    /// sufficient pressure; `None` if the pressure is not monitored.
    pub(crate) fn pressure_level(&self) -> Option<bool> {
        self.bit(168, 4).then(|| self.bit(168, 5))
    }

    /// Parameters 168.6 PB4, 168.7 SPB4: the level (`true` = 1) of the input that reports a closed
    /// door; `None` if the door is not monitored.
    pub(crate) fn door_level(&self) -> Option<bool> {
        self.bit(168, 6).then(|| self.bit(168, 7))
    }

    /// Parameter 172.0 SOVI: whether the inputs of T05–T08 are used for the feed-override switch.
    pub(crate) fn has_override_switches(&self) -> bool {
        self.bit(172, 0)
    }
}
