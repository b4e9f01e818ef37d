//! Values and blocks in words.

use std::borrow::Cow;

/// Letters of a block that are shown: a line may hold a whole program.
const SHOWN: usize = 160;

/// The beginning of a line, with dots where it goes on.
pub fn beginning(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(SHOWN) {
        Some((end, _)) => Cow::Owned(format!("{} …", &text[..end])),
        None => Cow::Borrowed(text),
    }
}

/// Seconds as `1:02:03` or `2:03.4`.
pub fn clock(seconds: f64) -> String {
    let whole = seconds as u64;
    let (hours, minutes) = (whole / 3600, whole / 60 % 60);
    if hours > 0 {
        return format!("{hours}:{minutes:02}:{:02}", whole % 60);
    }
    format!("{minutes}:{:04.1}", seconds - 60.0 * (whole / 60) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_of_many_blocks_is_shown_by_its_beginning() {
        assert_eq!(beginning("G00 X1"), "G00 X1");
        let line = "车G1;".repeat(1000);
        assert_eq!(beginning(&line), format!("{} …", "车G1;".repeat(40)));
    }
}
