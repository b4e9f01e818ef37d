//! System registers of macro B: the timer, date and time of day, and the functions that
//! programs have switched off.
//!
//! ```text
//!   #3001  timer, 16 ms steps       #3003  1 single block, 2 waiting for FIN
//!   #3011  date, YYYYMMDD           #3004  1 feed hold, 2 feed override, 4 exact stop
//!   #3012  time of day, hhmmss             a set bit switches off
//! ```

use chrono::{DateTime, Datelike, Timelike};
use serde::{Deserialize, Serialize};

/// Step in which the timer #3001 counts, ms.
const TIMER_STEP_MS: i64 = 16;
/// The timer #3001 wraps to 0 at this value, ms.
const TIMER_PERIOD_MS: i64 = 65_536;

/// Time of a clock that was never set, 2000-01-01 00:00:00, in seconds since 1970.
const UNSET_CLOCK_SECONDS: i64 = 946_684_800;

/// A local date and time of day, in seconds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct DayTime {
    /// Local time in seconds since 1970-01-01 00:00:00.
    seconds: i64,
}

impl Default for DayTime {
    fn default() -> Self {
        Self {
            seconds: UNSET_CLOCK_SECONDS,
        }
    }
}

impl DayTime {
    /// Creates a date and time from local seconds since 1970-01-01 00:00:00.
    pub const fn from_seconds(seconds: i64) -> Self {
        Self { seconds }
    }

    /// Parses a text like `1993-03-28 15:34:56`; `None` if it is invalid.
    pub fn from_text(text: &str) -> Option<Self> {
        let (date, time) = text.trim().split_once([' ', 'T'])?;
        let parse_triple = |text: &str, by| {
            let mut parts = text.split(by).map(|part| part.parse::<u32>().ok());
            let all = (parts.next()??, parts.next()??, parts.next()??);
            parts.next().is_none().then_some(all)
        };
        let (year, month, day) = parse_triple(date, '-')?;
        let (hour, minute, second) = parse_triple(time, ':')?;
        let year = i32::try_from(year)
            .ok()
            .filter(|year| (1970..=9999).contains(year))?;
        let date = chrono::NaiveDate::from_ymd_opt(year, month, day)?;
        let moment = date.and_hms_opt(hour, minute, second)?;
        Some(Self::from_seconds(moment.and_utc().timestamp()))
    }

    /// The date as the number YYYYMMDD and the time as hhmmss, `ms` milliseconds later.
    fn digits(self, ms: u64) -> (u32, u32) {
        let seconds = self.seconds.saturating_add((ms / 1000) as i64);
        let moment = DateTime::from_timestamp(seconds, 0).unwrap_or_default();
        let date = moment.year().unsigned_abs() * 10_000 + moment.month() * 100 + moment.day();
        let time = moment.hour() * 10_000 + moment.minute() * 100 + moment.second();
        (date, time)
    }
}

/// Functions of the control that a program has switched off until its end or RESET.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct SwitchedOff {
    /// The values of #3003 and #3004; each set bit switches a function off.
    bits: (u8, u8),
}

impl SwitchedOff {
    /// Greatest values of #3003 and #3004, with all their bits set.
    pub(crate) const GREATEST: (u8, u8) = (3, 7);

    /// The value of #3003: bit 0 single block, bit 1 waiting for FIN.
    pub(crate) const fn stop_bits(self) -> u8 {
        self.bits.0
    }

    /// The value of #3004: bit 0 feed hold, bit 1 feed override, bit 2 exact stop.
    pub(crate) const fn motion_bits(self) -> u8 {
        self.bits.1
    }

    pub(crate) const fn set_stops(&mut self, bits: u8) {
        self.bits.0 = bits & Self::GREATEST.0;
    }

    pub(crate) const fn set_motion(&mut self, bits: u8) {
        self.bits.1 = bits & Self::GREATEST.1;
    }

    /// Whether single block does not stop the program.
    pub(crate) const fn is_single_block_off(self) -> bool {
        self.bits.0 & 1 != 0
    }

    /// Whether the next block does not wait for the completion of M, S and T.
    pub(crate) const fn is_completion_wait_off(self) -> bool {
        self.bits.0 & 2 != 0
    }

    /// Whether feed hold cannot stop motion, because a program has switched it off.
    pub(crate) const fn is_feed_hold_off(self) -> bool {
        self.bits.1 & 1 != 0
    }

    /// Whether the feed override is fixed at 100 %.
    pub(crate) const fn is_feed_override_off(self) -> bool {
        self.bits.1 & 2 != 0
    }

    /// Whether cuts blend into each other without an exact stop.
    pub(crate) const fn is_exact_stop_off(self) -> bool {
        self.bits.1 & 4 != 0
    }
}

/// Registers of macro B that are lost at power-off: timer, clock, switched-off functions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Registers {
    /// Local date and time of power-on.
    day_time: DayTime,
    /// Time, ms after power-on, at which the timer #3001 was 0.
    timer_from: i64,
    /// Functions that programs have switched off.
    pub(crate) off: SwitchedOff,
}

impl Registers {
    /// The registers at power-on, which happens at the local time `day_time`.
    pub const fn new(day_time: DayTime) -> Self {
        Self {
            day_time,
            timer_from: 0,
            off: SwitchedOff { bits: (0, 0) },
        }
    }

    /// Greatest value of the timer #3001, ms.
    pub const TIMER_GREATEST: i64 = TIMER_PERIOD_MS - 1;

    /// Value of the timer #3001, ms, at `now` ms after power-on; it counts in steps of 16 ms.
    pub const fn timer(&self, now: u64) -> i64 {
        let since = (now as i64 - self.timer_from) / TIMER_STEP_MS * TIMER_STEP_MS;
        since.rem_euclid(TIMER_PERIOD_MS)
    }

    /// Sets the timer #3001 to `ms` at `now` ms after power-on.
    pub const fn set_timer(&mut self, ms: i64, now: u64) {
        self.timer_from = now as i64 - ms / TIMER_STEP_MS * TIMER_STEP_MS;
    }

    /// The local date as the number YYYYMMDD, at `now` ms after power-on.
    pub fn date(&self, now: u64) -> u32 {
        self.day_time.digits(now).0
    }

    /// The local time of day as the number hhmmss, at `now` ms after power-on.
    pub fn time_of_day(&self, now: u64) -> u32 {
        self.day_time.digits(now).1
    }

    /// Local date and time at `now` ms after power-on.
    pub(crate) const fn day_time(&self, now: u64) -> DayTime {
        DayTime::from_seconds(self.day_time.seconds.saturating_add((now / 1000) as i64))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Manual of macro B, 2.4: 28 March 1993, 15:34:56 (C29).
    #[test]
    fn date_and_time_are_digits() {
        let registers = Registers::new(DayTime::from_text("1993-03-28 15:34:56").unwrap());
        assert_eq!(registers.date(0), 19_930_328);
        assert_eq!(registers.time_of_day(0), 153_456);
        assert_eq!(registers.time_of_day(999), 153_456);
        assert_eq!(registers.time_of_day(4000), 153_500);
        // The day has 8 h 25 min 4 s left, and the month 3 days.
        let midnight = (8 * 3600 + 25 * 60 + 4) * 1000;
        assert_eq!(registers.date(midnight - 1), 19_930_328);
        assert_eq!(registers.date(midnight), 19_930_329);
        assert_eq!(registers.time_of_day(midnight), 0);
        assert_eq!(registers.date(midnight + 3 * 86_400_000), 19_930_401);
        assert_eq!(registers.day_time(midnight).digits(0), (19_930_329, 0));
    }

    #[test]
    fn leap_days_and_invalid_times() {
        let digits = |text| DayTime::from_text(text).map(|it| it.digits(86_400_000));
        assert_eq!(digits("2024-02-28 01:02:03"), Some((20_240_229, 10_203)));
        assert_eq!(digits("2023-02-28T01:02:03"), Some((20_230_301, 10_203)));
        for wrong in [
            "",
            "1993-03-28",
            "1993-02-29 00:00:00",
            "1993-13-01 00:00:00",
            "1993-03-28 24:00:00",
            "1993-03-28 15:34",
            "1993-03-28-1 15:34:56",
            "1969-12-31 00:00:00",
            "99999999999-01-01 00:00:00",
        ] {
            assert_eq!(DayTime::from_text(wrong), None, "{wrong}");
        }
    }

    /// C52: the timer wraps from 65535 ms to 0 after 16 ms.
    #[test]
    fn the_timer_counts_in_steps_and_wraps() {
        let mut registers = Registers::default();
        assert_eq!((registers.timer(15), registers.timer(16)), (0, 16));
        registers.set_timer(65_535, 1000);
        assert_eq!(registers.timer(1000), 65_520);
        assert_eq!(registers.timer(1016), 0);
        assert_eq!(registers.timer(1033), 16);
        registers.set_timer(0, 5000);
        assert_eq!(registers.timer(5031), 16);
    }
}
