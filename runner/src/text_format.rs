//! Formats values, blocks and tools as text.

use std::borrow::Cow;

use gsk_messages::{Message, say};
use gsk_workpiece::tool::{Insert, Tool};

/// Maximum number of characters of a block that are shown, because a line may hold a whole
/// program.
const MAX_SHOWN_CHARS: usize = 160;

/// Shortens a line that has more than 160 characters, with an ellipsis at its end.
pub fn shorten_line(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(MAX_SHOWN_CHARS) {
        Some((end, _)) => Cow::Owned(format!("{} …", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// Formats seconds as hours, minutes and seconds, `1:02:03`, or below an hour `2:03.4`.
pub fn format_time(seconds: f64) -> String {
    let whole = seconds as u64;
    let (hours, minutes) = (whole / 3600, whole / 60 % 60);
    if hours > 0 {
        return format!("{hours}:{minutes:02}:{:02}", whole % 60);
    }
    format!("{minutes}:{:04.1}", seconds - 60.0 * (whole / 60) as f64)
}

/// Formats seconds, rounded, as `1:02:03` or `2:03`.
pub fn format_whole_seconds(seconds: f64) -> String {
    let whole = seconds.round() as u64;
    let (hours, minutes, seconds) = (whole / 3600, whole / 60 % 60, whole % 60);
    if hours > 0 {
        return format!("{hours}:{minutes:02}:{seconds:02}");
    }
    format!("{minutes}:{seconds:02}")
}

/// Returns the message that describes a tool briefly, as in a tool list.
pub fn short_description(tool: &Tool) -> Message {
    match tool.insert {
        Insert::Turning {
            letter,
            entering,
            nose,
            ..
        } => say::tool_short_turning(format!("{letter:?}"), entering, nose),
        Insert::Grooving { width, .. } => say::tool_short_grooving(width),
        Insert::Threading { angle, .. } => say::tool_short_threading(angle),
        Insert::Drill { diameter, .. } => say::tool_short_drill(diameter),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn clocks_have_two_digits_after_each_colon() {
        assert_eq!(format_whole_seconds(59.6), "1:00");
        assert_eq!(format_whole_seconds(3723.2), "1:02:03");
        assert_eq!(format_time(63.45), "1:03.5");
    }

    #[test]
    fn a_line_of_many_blocks_is_shown_by_its_beginning() {
        assert_eq!(shorten_line("G00 X1"), "G00 X1");
        let line = "车G1;".repeat(1000);
        assert_eq!(shorten_line(&line), format!("{} …", "车G1;".repeat(40)));
    }
}
