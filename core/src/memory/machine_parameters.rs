//! Parameters by name: the machine's equipment and the active levels of its contacts.

use super::ControlParameters;
use crate::units::Axis;

impl ControlParameters {
    /// 008.0 DIRX, 008.1 DIRZ: pulses count up towards positive coordinates.
    pub(crate) fn counts_up(&self, axis: Axis) -> bool {
        self.axis_bit(8, axis)
    }

    /// 011.0 TCPS: level of *TCP with the tool post clamped.
    pub(crate) fn tool_clamped_level(&self) -> bool {
        self.bit(11, 0)
    }

    /// 011.1 TSGN: level of the contact of the active tool-post station.
    pub(crate) fn station_level(&self) -> bool {
        !self.bit(11, 1)
    }

    /// 011.4 ZDIL: axes may move while the spindle brake is on.
    pub(crate) fn can_move_under_brake(&self) -> bool {
        self.bit(11, 4)
    }

    /// 020: debounce width of the input filter.
    pub(crate) fn debounce_width(&self) -> i32 {
        self.value(20)
    }

    /// 021: gain of the analog spindle output at 10 V.
    pub(crate) fn analog_gain(&self) -> i32 {
        self.value(21)
    }

    /// 036: offset of the analog spindle output at speed 0, VELO.
    pub(crate) fn analog_zero(&self) -> i32 {
        self.value(36)
    }

    /// 067: spindle speed while a gear changes, r/min.
    pub(crate) fn gear_change_speed(&self) -> f64 {
        self.value(67).into()
    }

    /// 072: delay after spindle start until speed arrival is checked, ms.
    pub(crate) fn speed_arrival_delay_ms(&self) -> u32 {
        self.value(72).unsigned_abs()
    }

    /// 075: number of the tool in position; 0: unknown.
    pub(crate) fn tool_in_position(&self) -> u8 {
        u8::try_from(self.value(75)).unwrap_or(0)
    }

    /// Writes 075; a number out of range is ignored.
    pub(crate) fn remember_tool(&mut self, tool: u8) {
        let _ = self.set(75, tool.into());
    }

    /// 109: speed of the spindle jog, r/min.
    pub(crate) fn spindle_jog_speed(&self) -> f64 {
        self.value(109).into()
    }

    /// 110 = 111: the encoder turns at the spindle speed.
    pub(crate) fn is_encoder_direct(&self) -> bool {
        self.value(110) == self.value(111)
    }

    /// 164.6 AGIN: a change to gear 1 or 2 waits for its in-position input. The enable
    /// inputs *SPEN and *STEN then have no pins.
    pub(crate) fn watches_gear(&self) -> bool {
        self.bit(164, 6)
    }

    /// 164.5 AGIM: level at which M41I and M42I report that the gear is engaged.
    pub(crate) fn gear_in_level(&self) -> bool {
        !self.bit(164, 5)
    }

    /// 164.5 AGIM: level at which *SPEN and *STEN enable.
    pub(crate) fn enable_level(&self) -> bool {
        self.bit(164, 5)
    }

    /// 164.4 STEN: cycle start needs its enable input.
    pub(crate) fn has_start_enable_input(&self) -> bool {
        self.bit(164, 4) && !self.watches_gear()
    }

    /// 164.3 SPEN: the spindle needs its enable input.
    pub(crate) fn has_spindle_enable_input(&self) -> bool {
        self.bit(164, 3) && !self.watches_gear()
    }

    /// 164.2 SLTW: the machine has a tailstock.
    pub(crate) fn has_tailstock(&self) -> bool {
        self.bit(164, 2)
    }

    /// 164.0 SLQP: the machine has a power chuck.
    pub(crate) fn has_chuck(&self) -> bool {
        self.bit(164, 0)
    }

    /// Sets 164.0 SLQP, and 164.1 SLSP: the spindle starts with the chuck open too.
    pub(crate) fn fit_chuck(&mut self) {
        self.set_option(164, 0);
        self.set_option(164, 1);
    }

    /// Sets 001.4: the spindle speed is an analog voltage.
    pub(crate) fn fit_analog_spindle(&mut self) {
        self.set_option(1, 4);
    }

    fn set_option(&mut self, number: u16, bit: u8) {
        let set = self.set_bit(number, bit, true);
        debug_assert!(set.is_ok(), "{number:03}.{bit} exists");
    }

    /// 168.0 PB1: the chuck clamps with DOQPS instead of DOQPJ.
    pub(crate) fn is_outer_chuck(&self) -> bool {
        self.bit(168, 0)
    }

    /// 168.2 PB2: M12 and M13 wait for the in-position input of the chuck.
    pub(crate) fn watches_chuck(&self) -> bool {
        self.bit(168, 2)
    }

    /// 168.4 PB3, 168.5 SPB3: the level that reports sufficient pressure; `None` if the
    /// pressure is not monitored.
    pub(crate) fn pressure_level(&self) -> Option<bool> {
        self.bit(168, 4).then(|| self.bit(168, 5))
    }

    /// 168.6 PB4, 168.7 SPB4: the level that reports a closed door; `None` if the door is
    /// not monitored.
    pub(crate) fn door_level(&self) -> Option<bool> {
        self.bit(168, 6).then(|| self.bit(168, 7))
    }

    /// 172.0 SOVI: the inputs of T05–T08 are used for the feed-override switch.
    pub(crate) fn has_override_switches(&self) -> bool {
        self.bit(172, 0)
    }
}
