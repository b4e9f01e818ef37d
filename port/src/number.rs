//! Numbers of part programs as whole millionths, so that no conversion depends on binary
//! fractions.

/// Number of millionths in one unit of a number.
pub(crate) const UNIT: i64 = 1_000_000;

/// Greatest number of digits of an F word on this control.
const MAX_FEED_DIGITS: u32 = 7;

/// A number as written: its value in millionths and whether it has a decimal point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Number {
    /// Value in millionths of the written unit.
    pub micro: i64,
    /// Whether the number has a decimal point.
    pub has_point: bool,
}

impl Number {
    /// Parses `-12.5`, `.5` or `12.`; returns `None` for other text and for values beyond a
    /// million.
    pub fn parse(text: &str) -> Option<Self> {
        let text = text.trim();
        let (negative, digits) = match text.as_bytes().first()? {
            b'-' => (true, &text[1..]),
            b'+' => (false, &text[1..]),
            _ => (false, text),
        };
        let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
        if whole.is_empty() && fraction.is_empty() {
            return None;
        }
        let all_digits = |text: &str| text.bytes().all(|byte| byte.is_ascii_digit());
        if !all_digits(whole) || !all_digits(fraction) || whole.len() > 9 {
            return None;
        }
        let whole: i64 = match whole {
            "" => 0,
            _ => whole.parse().ok()?,
        };
        let mut micro = 0;
        let mut weight = UNIT / 10;
        for byte in fraction.bytes() {
            micro += i64::from(byte - b'0') * weight;
            weight /= 10;
        }
        let micro = whole * UNIT + micro;
        Some(Self {
            micro: if negative { -micro } else { micro },
            has_point: digits.contains('.'),
        })
    }

    /// Returns the value if it is a whole number from 0 up; else `None`.
    pub const fn whole(self) -> Option<i64> {
        match self.micro >= 0 && self.micro % UNIT == 0 {
            true => Some(self.micro / UNIT),
            false => None,
        }
    }
}

/// Divides `value` by `by`, and rounds half away from zero.
pub(crate) const fn divide_rounded(value: i64, by: i64) -> i64 {
    let half = by / 2;
    if value >= 0 {
        (value + half) / by
    } else {
        (value - half) / by
    }
}

/// Rounds millionths to `decimals` places, 0 to 6.
pub(crate) const fn round_to(micro: i64, decimals: u32) -> i64 {
    let step = 10_i64.pow(6 - decimals);
    divide_rounded(micro, step) * step
}

/// Formats millionths with at most `decimals` places. A whole number keeps its point, because every
/// control then reads it as a length.
pub(crate) fn write_number(micro: i64, decimals: u32) -> String {
    let micro = round_to(micro, decimals);
    let sign = if micro < 0 { "-" } else { "" };
    let size = micro.unsigned_abs();
    let unit = UNIT.unsigned_abs();
    let digits = format!("{:06}", size % unit);
    format!("{sign}{}.{}", size / unit, digits.trim_end_matches('0'))
}

/// Formats a feed or lead in millionths with at most `decimals` places and with at most as many
/// digits as a word of this control has.
pub(crate) fn write_feed(micro: i64, decimals: u32) -> String {
    let whole_digits = (micro / UNIT).unsigned_abs().max(1).ilog10() + 1;
    write_number(
        micro,
        decimals.min(MAX_FEED_DIGITS.saturating_sub(whole_digits)),
    )
}

/// Formats `micro`, in millionths, as the nearest whole number without a point.
pub(crate) fn write_whole(micro: i64) -> String {
    divide_rounded(micro, UNIT).to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_parsed_and_written() {
        let micro = |text| Number::parse(text).map(|it| it.micro);
        assert_eq!(micro("-12.5"), Some(-12_500_000));
        assert_eq!(micro("+.5"), Some(500_000));
        assert_eq!(micro("7."), Some(7_000_000));
        assert_eq!(micro("."), None);
        assert_eq!(micro("1.2.3"), None);
        assert_eq!(micro("#100"), None);
        assert_eq!(write_number(-12_500_000, 3), "-12.5");
        assert_eq!(write_number(7_000_000, 3), "7.");
        assert_eq!(write_number(-400, 3), "0.");
        assert_eq!(write_number(1_234_500, 3), "1.235");
        assert_eq!(write_whole(1_500_000), "2");
    }
}
