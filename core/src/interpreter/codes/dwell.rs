//! G04: dwell and exact stop (manual I-3.2.3).
//!
//! ```text
//!   G04 P1500   1500 ms      P before X before U; without any, exact stop:
//!   G04 X1.5    1.5 s        the next block begins when the axes are at rest
//!   G04 U1.5    1.5 s
//!
//!   On the NC-B08 X comes before P, on the Huaxing lathes K (in seconds) before X
//!   and P.
//! ```

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::Action;
use crate::interpreter::exact::{UNITS_PER_MM, to_mm};
use crate::interpreter::words::SortedWords;
use crate::model::{GCode, ModelRecord};

/// Plans the dwell of a G04 block, in whole ms; 0 ms is an exact stop.
///
/// # Errors
/// 043 for a negative time (manual I-2.2, table 2-1), or one outside the model's limits.
pub(crate) fn plan_dwell(words: &SortedWords, record: &ModelRecord) -> Result<Action, Alarm> {
    let has_k_word = record.g_code(4) == Some(GCode::DwellByK);
    let k = words.k.filter(|_| has_k_word);
    let time_words = [('P', words.p), ('X', words.x), ('U', words.u), ('K', k)];
    for (letter, value) in time_words {
        if let Some(value) = value.filter(|value| *value < 0) {
            let time = match letter {
                'P' => format!("P{value}"),
                _ => format!("{letter}{:.3}", to_mm(value)),
            };
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(say::dwell_negative(time)));
        }
    }
    if let Some((least, most)) = record.dwell_limits {
        // The values are in millionths of a second.
        const PER_MS: i64 = UNITS_PER_MM / 1000;
        let range = least.saturating_mul(PER_MS)..=most.saturating_mul(PER_MS);
        let in_range = |letter: char, value: i64| match letter {
            'P' => range.contains(&value.saturating_mul(PER_MS)),
            _ => range.contains(&value),
        };
        let invalid = time_words
            .into_iter()
            .filter_map(|(letter, value)| Some((letter, value?)))
            .find(|(letter, value)| !in_range(*letter, *value));
        if let Some((letter, value)) = invalid {
            let (value, least, most) = match letter {
                'P' => (value as f64, least as f64, most as f64),
                _ => (to_mm(value), least as f64 / 1000.0, most as f64 / 1000.0),
            };
            let rule = say::dwell_out_of_range(letter, value, least, most);
            return Err(Alarm::new(number::OUT_OF_RANGE).with_detail(rule));
        }
    }
    let is_seconds_first = has_k_word || record.g_code(4) == Some(GCode::DwellSecondsFirst);
    let ms = match (words.p, k.or(words.x).or(words.u)) {
        (Some(p), None) => p,
        (Some(p), Some(_)) if !is_seconds_first => p,
        (_, Some(seconds)) => (seconds.saturating_mul(1000) + UNITS_PER_MM / 2) / UNITS_PER_MM,
        (None, None) => 0,
    };
    Ok(Action::Dwell {
        ms: u32::try_from(ms).unwrap_or(u32::MAX),
    })
}
