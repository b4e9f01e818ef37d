//! Parameters by name, converted to internal units: mm as a radius, mm/min, ms.

use core::ops::RangeInclusive;

use super::ControlParameters;
use crate::memory::parameter;
use crate::units::Axis;

impl ControlParameters {
    fn per_axis(&self, axis: Axis, x: u16, z: u16) -> i32 {
        self.value(match axis {
            Axis::X => x,
            Axis::Z => z,
        })
    }

    /// Whether the bit of an axis is 1 in the state parameter `number`: bit 0 for X, bit 1 for
    /// Z.
    pub(super) fn axis_bit(&self, number: u16, axis: Axis) -> bool {
        self.bit(
            number,
            match axis {
                Axis::X => 0,
                Axis::Z => 1,
            },
        )
    }

    /// Parameter 001.4: whether the spindle speed is an analog voltage; otherwise outputs S1–S4
    /// select it.
    pub fn has_analog_spindle(&self) -> bool {
        self.bit(1, 4)
    }

    /// Parameter 005.2 DRDY: level (`true` = 1) of the signal of a ready drive.
    pub(crate) fn drive_ready_level(&self) -> bool {
        self.bit(5, 2)
    }

    /// Parameters 009.0, 009.1 ALM: level (`true` = 1) of the signal of a drive with an alarm.
    pub(crate) fn drive_alarm_level(&self, axis: Axis) -> bool {
        self.axis_bit(9, axis)
    }

    /// Parameter 012.2 OFVY: whether a drive may be ready before it is enabled, without an alarm.
    pub(crate) fn can_drive_be_early(&self) -> bool {
        self.bit(12, 2)
    }

    /// Parameter 006.4 OVRI: whether the code of the feed-override switch is inverted.
    pub(crate) fn is_override_code_inverted(&self) -> bool {
        self.bit(6, 4)
    }

    /// Parameter 004.1 PROD: whether the relative coordinates are those of the program; otherwise
    /// they include the tool offset.
    pub(crate) fn is_relative_programmed(&self) -> bool {
        self.bit(4, 1)
    }

    /// Parameter 005.3 EDTB: whether text is inserted after the character at the cursor (function
    /// A); otherwise before it (B).
    pub fn inserts_after_cursor(&self) -> bool {
        self.bit(5, 3)
    }

    /// Parameter 012.6 WSFT: whether offset 000 shifts the work coordinates.
    pub fn has_work_shift(&self) -> bool {
        self.bit(12, 6)
    }

    /// Parameter 001.3: whether the handwheel key selects the handwheel mode; otherwise the step
    /// mode.
    pub fn has_handwheel(&self) -> bool {
        self.bit(1, 3)
    }

    /// Parameter 001.2: whether X and U words are radii.
    pub fn is_radius_programming(&self) -> bool {
        self.bit(1, 2)
    }

    /// Parameter 002.1: whether the control has nose radius compensation C (option).
    pub(crate) fn has_nose_compensation(&self) -> bool {
        self.bit(2, 1)
    }

    /// Parameter 003.4: whether a T word shifts the coordinates; otherwise the tool moves.
    pub(crate) fn is_offset_by_shift(&self) -> bool {
        self.bit(3, 4)
    }

    /// Parameter 004.4 ORC: whether X offsets are radii.
    pub(crate) fn is_offset_radius(&self) -> bool {
        self.bit(4, 4)
    }

    /// Parameter 004.3 TOC: whether RESET keeps the active offset.
    pub(crate) fn reset_keeps_offset(&self) -> bool {
        self.bit(4, 3)
    }

    /// Parameter 005.4 M30: whether M30 returns the cursor to the program head immediately;
    /// otherwise the next start does.
    pub(crate) fn m30_rewinds(&self) -> bool {
        self.bit(5, 4)
    }

    /// Parameter 005.1 PPD: whether G50 also sets the relative coordinates.
    pub(crate) fn g50_sets_relative(&self) -> bool {
        self.bit(5, 1)
    }

    /// Parameter 013.5 POD: whether numbers in programs need a decimal point.
    pub fn is_point_required(&self) -> bool {
        self.bit(13, 5)
    }

    /// Parameter 013.4 SBKM: whether single block stops after G65 blocks.
    pub(crate) fn macro_blocks_stop(&self) -> bool {
        self.bit(13, 4)
    }

    /// Parameter 013.3 PODI: whether the editor appends the decimal point to numbers without one.
    pub fn is_point_appended(&self) -> bool {
        self.bit(13, 3)
    }

    /// Parameter 006.5 CM98: whether M, S and T codes without a function call subprograms.
    pub(crate) fn special_codes_call(&self) -> bool {
        self.bit(6, 5)
    }

    /// Parameter 004.0 SCW: whether the least increment, which is the unit of length parameters, is
    /// 0.0001 inch; otherwise 0.001 mm.
    pub fn is_inch_machine(&self) -> bool {
        self.bit(4, 0)
    }

    /// Unit of length parameters, mm: 0.001, or 0.00254 (0.0001 inch) with 004.0 SCW.
    pub fn least_increment_mm(&self) -> f64 {
        if self.is_inch_machine() {
            0.00254
        } else {
            0.001
        }
    }

    /// Parameter 004.7 ABOT: whether the absolute coordinates are lost at power-off.
    pub(crate) fn power_off_loses_coordinates(&self) -> bool {
        self.bit(4, 7)
    }

    /// Parameter 004.6 RDRN: whether rapids keep the rapid rate in dry run.
    pub(crate) fn dry_run_keeps_rapid(&self) -> bool {
        self.bit(4, 6)
    }

    /// Parameter 012.7 APRS: whether a reference return sets the absolute coordinates to 049, 050.
    pub(crate) fn reference_sets_coordinates(&self) -> bool {
        self.bit(12, 7)
    }

    /// Parameter 012.0 ISOT: whether manual rapid is allowed before the reference return.
    pub(crate) fn can_rapid_without_reference(&self) -> bool {
        self.bit(12, 0)
    }

    /// Parameters 014.0, 014.1: whether the axis has a zero switch (methods B and C).
    pub(crate) fn has_zero_switch(&self, axis: Axis) -> bool {
        self.axis_bit(14, axis)
    }

    /// Parameters 007.0, 007.1 ZC: whether one switch serves for deceleration and zero (method C);
    /// otherwise the zero signal is separate (method B).
    pub fn has_one_zero_switch(&self, axis: Axis) -> bool {
        self.axis_bit(7, axis)
    }

    /// Parameters 006.0, 006.1 ZM: whether the zero is approached in the negative direction.
    pub(crate) fn is_zero_negative(&self, axis: Axis) -> bool {
        self.axis_bit(6, axis)
    }

    /// Parameter 004.5 DECI: whether a closed deceleration contact means that the switch is
    /// pressed; otherwise an open one.
    pub(crate) fn is_deceleration_closed(&self) -> bool {
        self.bit(4, 5)
    }

    /// Parameter 113: rate at which the slide approaches the reference point, mm/min; for X half of
    /// 113.
    pub(crate) fn zero_approach_rate(&self, axis: Axis) -> f64 {
        let rate = f64::from(self.value(113));
        match axis {
            Axis::X => rate / 2.0,
            Axis::Z => rate,
        }
    }

    /// Parameter 033: low rate FL of the reference return, mm/min.
    pub fn zero_low_rate(&self) -> f64 {
        self.value(33).into()
    }

    /// Parameters 049, 050: absolute coordinate of the slide at the reference point (X as a
    /// radius), mm.
    pub(crate) fn reference_coordinate(&self, axis: Axis) -> f64 {
        self.slide_length(axis, self.per_axis(axis, 49, 50))
    }

    /// Converts the value of a length parameter to a coordinate of the slide (X as a radius),
    /// mm.
    fn slide_length(&self, axis: Axis, value: i32) -> f64 {
        let scale = match axis {
            Axis::X if !self.is_radius_programming() => 2.0,
            Axis::X | Axis::Z => 1.0,
        };
        if self.is_inch_machine() {
            f64::from(value) * self.least_increment_mm() / scale
        } else {
            f64::from(value) / (1000.0 * scale)
        }
    }

    /// Parameter 173.1 SINC: whether step mode and handwheel offer no steps of 0.1 mm and more.
    pub fn has_small_steps_only(&self) -> bool {
        self.bit(173, 1)
    }

    /// Parameter 164.7 AGER: whether M41–M44 change gears. This needs an analog spindle, and 005.5
    /// SMAL must not select manual gear change.
    pub(crate) fn has_automatic_gears(&self) -> bool {
        self.bit(164, 7) && self.has_analog_spindle() && !self.bit(5, 5)
    }

    /// Parameter 172.4 MOT: whether the soft limits are not monitored.
    pub(crate) fn are_soft_limits_masked(&self) -> bool {
        self.bit(172, 4)
    }

    /// Parameter 172.3 MESP: whether the emergency-stop contact is not monitored.
    pub(crate) fn is_emergency_stop_masked(&self) -> bool {
        self.bit(172, 3)
    }

    /// Parameters 015/017, 016/018: pulses per least output increment, as multiplier and divisor,
    /// both at least 1.
    pub fn gear(&self, axis: Axis) -> (i32, i32) {
        (
            self.per_axis(axis, 15, 16).max(1),
            self.per_axis(axis, 17, 18).max(1),
        )
    }

    /// Parameters 022, 023: rapid rate of the slide, mm/min.
    pub fn rapid_rate(&self, axis: Axis) -> f64 {
        self.per_axis(axis, 22, 23).into()
    }

    /// Parameters 024, 025: time constant of the linear acceleration of rapids, ms.
    pub fn rapid_time(&self, axis: Axis) -> f64 {
        self.per_axis(axis, 24, 25).into()
    }

    /// Parameter 007.3 SMZ: whether cuts decelerate to the speed 030 at their end points; otherwise
    /// they blend into the next one.
    pub(crate) fn has_exact_corners(&self) -> bool {
        self.bit(7, 3)
    }

    /// Parameter 027: highest cutting feed, mm/min.
    pub(crate) fn feed_limit(&self) -> f64 {
        self.value(27).into()
    }

    /// Parameter 029: time constant of the exponential acceleration of cuts and jogs, ms.
    pub(crate) fn feed_time(&self) -> f64 {
        self.value(29).into()
    }

    /// Parameter 026: time constant of X in the run-out of a thread, ms.
    pub(crate) fn run_out_time(&self) -> f64 {
        self.value(26).into()
    }

    /// Parameter 028: speed at which threads start and end, mm/min.
    pub(crate) fn thread_start_speed(&self) -> f64 {
        self.value(28).into()
    }

    /// Parameter 175.4 THDACC: whether acceleration in threads is exponential; otherwise linear.
    pub(crate) fn is_thread_exponential(&self) -> bool {
        self.bit(175, 4)
    }

    /// Parameter 106: greatest change of the spindle speed in a thread, %; 0: not monitored.
    pub(crate) fn speed_fluctuation_limit(&self) -> f64 {
        self.value(106).into()
    }

    /// Parameter 107: speed of X in the run-out of a thread (Z twice as fast), mm/min; 0: the speed
    /// of the thread.
    pub(crate) fn run_out_rate(&self) -> f64 {
        self.value(107).into()
    }

    /// Parameter 175.2 SPFD: whether cuts stop when the spindle stops.
    pub(crate) fn watches_spindle(&self) -> bool {
        self.bit(175, 2)
    }

    /// Parameter 175.6 SAR: whether cuts wait until the spindle has reached its speed.
    pub(crate) fn awaits_speed(&self) -> bool {
        self.bit(175, 6)
    }

    /// Parameter 030: speed at which cuts start and end, mm/min.
    pub(crate) fn feed_start_speed(&self) -> f64 {
        self.value(30).into()
    }

    /// Parameter 032: rapid rate at override F0, mm/min.
    pub(crate) fn lowest_rapid_rate(&self) -> f64 {
        self.value(32).into()
    }

    /// Parameters 037–040: spindle speed at 10 V in gear 1–4, r/min; other gears count as gear 1.
    pub(crate) fn gear_top_speed(&self, gear: u8) -> f64 {
        let gear = if (1..=4).contains(&gear) { gear } else { 1 };
        self.value(36 + u16::from(gear)).into()
    }

    /// Parameter 041: speed at which jogs start and end, mm/min.
    pub(crate) fn jog_start_speed(&self) -> f64 {
        self.value(41).into()
    }

    /// Parameter 043: lowest spindle speed in constant surface speed, r/min.
    pub(crate) fn lowest_surface_speed_rpm(&self) -> f64 {
        self.value(43).into()
    }

    /// Parameters 045–048: soft limits as machine coordinates of the slide (X as a radius), mm:
    /// positive end, negative end.
    pub fn soft_limits(&self, axis: Axis) -> (f64, f64) {
        let positive = self.per_axis(axis, 45, 46);
        let negative = self.per_axis(axis, 47, 48);
        (
            self.slide_length(axis, positive),
            self.slide_length(axis, negative),
        )
    }

    /// Parameter 070: lines of the spindle encoder.
    pub fn encoder_lines(&self) -> i32 {
        self.value(70)
    }

    /// Parameters 111/110: spindle revolutions per encoder revolution, as a ratio.
    pub(crate) fn encoder_ratio(&self) -> f64 {
        f64::from(self.value(111).max(1)) / f64::from(self.value(110).max(1))
    }

    /// Parameter 071: duration of the reset signal after its cause has gone, ms.
    pub(crate) fn reset_time_ms(&self) -> u32 {
        self.value(71).clamp(16, 4080).unsigned_abs()
    }

    /// Parameter 011.2 ZNIK: whether one press of an axis key starts a whole reference return.
    pub(crate) fn are_zero_keys_latched(&self) -> bool {
        self.bit(11, 2)
    }

    /// The duration of a timer of the PLC, ms, from the parameter `number`. 065 counts units
    /// of 256 ms (manual, appendix 1).
    pub fn timer_ms(&self, number: u16) -> i32 {
        let value = self.value(number);
        if number == parameter::GEAR_TIME_1 {
            value.saturating_mul(256)
        } else {
            value
        }
    }

    /// Parameter 084: number of stations of the tool post; 0 without a turret.
    pub fn station_count(&self) -> u8 {
        self.value(84).clamp(0, 32) as u8
    }

    /// Parameters 034, 035: backlash of the slide, mm.
    pub fn backlash(&self, axis: Axis) -> f64 {
        f64::from(self.per_axis(axis, 34, 35)) * self.least_increment_mm()
    }

    /// Parameter 011.7 BDEC: whether backlash is compensated with acceleration (method B);
    /// otherwise at a constant frequency (A).
    pub(crate) fn is_backlash_accelerated(&self) -> bool {
        self.bit(11, 7)
    }

    /// Parameters 010.3–010.0 CPF, 011.6 BD8: pulse frequency of backlash compensation by method A,
    /// 1/s.
    pub(crate) fn backlash_frequency(&self) -> f64 {
        let frequency = f64::from(self.value(10) & 0b1111) + 1.0;
        let eighth = if self.bit(11, 6) { 8.0 } else { 1.0 };
        frequency * 1000.0 / eighth
    }

    /// Parameters 006.0 ZMX, 006.1 ZMZ: whether the reference return and the first backlash are in
    /// the negative direction.
    pub fn is_reference_negative(&self, axis: Axis) -> bool {
        self.bit(
            6,
            match axis {
                Axis::X => 0,
                Axis::Z => 1,
            },
        )
    }

    /// Parameter 003.5: whether the control compensates pitch errors (option).
    pub fn is_pitch_compensated(&self) -> bool {
        self.bit(3, 5)
    }

    /// Parameters 013.2–013.0 PML: factor by which the values of the pitch error table are
    /// multiplied.
    pub fn pitch_factor(&self) -> i32 {
        match self.value(13) & 0b111 {
            code @ 0..4 => 1 << code,
            _ => 16,
        }
    }

    /// Parameters 098, 099: point of the pitch error table at the reference position.
    pub fn pitch_origin(&self, axis: Axis) -> u8 {
        self.per_axis(axis, 98, 99).clamp(0, 255) as u8
    }

    /// Parameters 090, 094 for X, 091, 095 for Z: numbers of the active points of the pitch error
    /// table. All points are active if the highest is not above the lowest.
    pub fn pitch_points(&self, axis: Axis) -> RangeInclusive<usize> {
        let point = |number: i32| number.clamp(0, 255) as usize;
        let lowest = point(self.per_axis(axis, 90, 91));
        let highest = point(self.per_axis(axis, 94, 95));
        if highest > lowest {
            lowest..=highest
        } else {
            0..=255
        }
    }

    /// Parameters 102, 103: slide travel between points of the pitch error table, in 0.001 mm
    /// (0.0001 inch); 0: no compensation.
    pub fn pitch_interval(&self, axis: Axis) -> i64 {
        i64::from(self.per_axis(axis, 102, 103)).abs()
    }
}
