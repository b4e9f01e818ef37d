//! Formats moments as XML does.

use core::fmt;

/// Number of milliseconds in a day.
const DAY_MS: u64 = 86_400_000;

/// A time in UTC, ms since 1970.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TimeStamp(pub u64);

impl fmt::Display for TimeStamp {
    /// Formats the time as `2026-03-01T07:05:09.250Z`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (days, ms) = (self.0 / DAY_MS, self.0 % DAY_MS);
        let (year, month, day) = civil_date(days);
        let second = ms / 1000;
        write!(
            f,
            "{year:04}-{month:02}-{day:02}T{:02}:{:02}:{:02}.{:03}Z",
            second / 3600,
            second / 60 % 60,
            second % 60,
            ms % 1000
        )
    }
}

/// Converts a number of days since 1970-01-01 to year, month and day. The year is counted from
/// March, so that the leap day is its last day.
const fn civil_date(days: u64) -> (u64, u64, u64) {
    let from_march_0 = days + 719_468;
    let (era, day_of_era) = (from_march_0 / 146_097, from_march_0 % 146_097);
    let year_of_era =
        (day_of_era - day_of_era / 1460 + day_of_era / 36_524 - day_of_era / 146_096) / 365;
    let day_of_year = day_of_era - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let month_from_march = (5 * day_of_year + 2) / 153;
    let day = day_of_year - (153 * month_from_march + 2) / 5 + 1;
    let month = if month_from_march < 10 {
        month_from_march + 3
    } else {
        month_from_march - 9
    };
    let year = era * 400 + year_of_era + (month <= 2) as u64;
    (year, month, day)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn leap_days_and_ends_of_years() {
        let at = |seconds: u64| TimeStamp(seconds * 1000 + 7).to_string();
        assert_eq!(at(0), "1970-01-01T00:00:00.007Z");
        assert_eq!(at(951_782_400), "2000-02-29T00:00:00.007Z");
        assert_eq!(at(1_735_689_599), "2024-12-31T23:59:59.007Z");
        assert_eq!(at(1_772_323_200), "2026-03-01T00:00:00.007Z");
    }
}
