//! Decides when the text scrolls to the block that runs.

/// Change of the height of the text from which it scrolls again, points.
const HEIGHT_CHANGE: f32 = 1.0;

/// The block that the text has shown last, and the height of the text then.
#[derive(Default)]
pub struct RunFollower {
    is_requested: bool,
    line: Option<u32>,
    height: f32,
}

impl RunFollower {
    /// Lets the text scroll to the block in the next frame.
    pub const fn request(&mut self) {
        self.is_requested = true;
    }

    /// Whether the text scrolls to the block that runs in this frame: at another block, and at
    /// another height of the text, which may have hidden the block. Not while the cursor is in the
    /// text (`is_edited`), unless it is requested.
    pub fn should_scroll(&mut self, line: Option<u32>, height: f32, is_edited: bool) -> bool {
        let is_other_line = std::mem::replace(&mut self.line, line) != line;
        let height_before = std::mem::replace(&mut self.height, height);
        let is_other_height = (height_before - height).abs() > HEIGHT_CHANGE;
        let is_requested = std::mem::take(&mut self.is_requested);
        is_requested || !is_edited && (is_other_line || is_other_height)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_block_or_another_height_scrolls_unless_the_text_is_edited() {
        let mut follower = RunFollower::default();
        assert!(follower.should_scroll(Some(4), 300.0, false));
        assert!(!follower.should_scroll(Some(4), 300.0, false));
        assert!(follower.should_scroll(Some(5), 300.0, false));
        assert!(follower.should_scroll(Some(5), 200.0, false));
        assert!(!follower.should_scroll(Some(6), 100.0, true));
        follower.request();
        assert!(follower.should_scroll(Some(6), 100.0, true));
        assert!(!follower.should_scroll(Some(6), 100.0, true));
    }
}
