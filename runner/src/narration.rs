//! Describes a running program in words, block by block.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::interpreter::{Explanation, Modal};
use gsk_core::units::Feed;
use gsk_messages::{Language, say};

use crate::moves::{diameter_z, rounded};
use crate::report::modal_codes;
use crate::words::beginning;

/// Text for a block that begins: its line number from 1, its text, and the words in force.
pub fn block(line: u32, text: &str, modal: &Modal) -> String {
    let codes = modal_codes(modal).join(" ");
    let (feed, speed) = (rounded(modal.feed), rounded(modal.spindle));
    let (tool, offset) = (modal.tool, modal.offset);
    format!(
        "{line:6}  {}\n        {codes} F{feed} S{speed} T{tool:02}{offset:02}\n",
        beginning(text)
    )
}

/// Text for a pass of a cycle.
pub fn pass(explanation: &Explanation, language: Language) -> String {
    let (said, formula) = pass_in_words(explanation, language);
    format!("        {said}\n          {formula}\n")
}

/// Two texts for a pass of a cycle: its number and depth, and the formula of its position with
/// the words and parameters that it uses.
pub fn pass_in_words(explanation: &Explanation, language: Language) -> (String, String) {
    let Explanation {
        code,
        pass,
        depth,
        remaining,
        formula,
        words,
        ..
    } = explanation;
    let of = explanation.passes.map(say::narration_of_passes);
    let level = explanation.level.map(rounded);
    let level = level.map(say::narration_at_level);
    let cuts = *depth != 0.0 || *remaining != 0.0;
    let cut = cuts.then(|| say::narration_depth(*depth, *remaining));
    let said = [Some(say::narration_pass(code, pass)), of, level, cut];
    let said: String = said.iter().flatten().map(|it| it.text(language)).collect();
    let formula = formula.text(language);
    (said, format!("{formula}   [{words}]"))
}

/// Text for an executed move: target, feed and duration.
pub fn executed(executed: &ExecutedMove, language: Language) -> String {
    format!("        {}\n", sentence(executed, language))
}

fn sentence(executed: &ExecutedMove, language: Language) -> String {
    let (x, z) = diameter_z(executed.to);
    let way = match executed.kind {
        MoveKind::Rapid => say::narration_rapid(x, z),
        MoveKind::Feed => say::narration_cut(x, z),
        MoveKind::Clockwise => say::narration_cut_clockwise(x, z),
        MoveKind::CounterClockwise => say::narration_cut_counter_clockwise(x, z),
        MoveKind::Thread => say::narration_thread(x, z),
        MoveKind::RunOut => say::narration_run_out(x, z),
        MoveKind::Dwell => {
            return say::narration_wait(rounded(executed.duration_s)).text(language);
        }
    };
    let feed = executed.feed.map(|feed| match feed {
        Feed::PerMinute(feed) => say::narration_per_minute(rounded(feed)),
        Feed::PerRevolution(feed) => say::narration_per_revolution(rounded(feed)),
    });
    let takes = say::narration_takes(executed.duration_s);
    let said = [Some(way), feed, Some(takes)];
    said.iter().flatten().map(|it| it.text(language)).collect()
}
