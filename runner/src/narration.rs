//! Describes a running program in words, block by block.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::interpreter::{Explanation, ModalState};
use gsk_core::units::Feed;
use gsk_messages::{Language, say};

use crate::move_output::{diameter_z, round_to_millionth};
use crate::report::modal_codes;
use crate::text_format::shorten_line;

/// The text that explains a block: its line number from 1, its text, and the G codes, F, S and
/// T in force.
pub fn block_text(line: u32, text: &str, modal: &ModalState) -> String {
    let codes = modal_codes(modal).join(" ");
    let (feed, speed) = (
        round_to_millionth(modal.feed),
        round_to_millionth(modal.spindle),
    );
    let (tool, offset) = (modal.tool, modal.offset);
    format!(
        "{line:6}  {}\n        {codes} F{feed} S{speed} T{tool:02}{offset:02}\n",
        shorten_line(text)
    )
}

/// Returns the text that explains a pass of a cycle in one line.
pub fn pass_text(explanation: &Explanation, language: Language) -> String {
    let (description, formula) = describe_pass(explanation, language);
    format!("        {description}\n          {formula}\n")
}

/// Two texts that explain a pass of a cycle: its number and depth, and the formula of its
/// position with the words and parameters that it uses.
pub fn describe_pass(explanation: &Explanation, language: Language) -> (String, String) {
    let Explanation {
        code,
        pass,
        depth,
        remaining,
        formula,
        words,
        ..
    } = explanation;
    let total = explanation.passes.map(say::narration_of_passes);
    let level = explanation.level.map(round_to_millionth);
    let level = level.map(say::narration_at_level);
    let cuts = *depth != 0.0 || *remaining != 0.0;
    let cut = cuts.then(|| say::narration_depth(*depth, *remaining));
    let sentences = [Some(say::narration_pass(code, pass)), total, level, cut];
    let description: String = sentences
        .iter()
        .flatten()
        .map(|it| it.text(language))
        .collect();
    let formula = formula.text(language);
    (description, format!("{formula}   [{words}]"))
}

/// Returns the text that describes an executed move: target, feed and duration.
pub fn move_text(executed: &ExecutedMove, language: Language) -> String {
    format!("        {}\n", move_sentence(executed, language))
}

fn move_sentence(executed: &ExecutedMove, language: Language) -> String {
    let (x, z) = diameter_z(executed.to);
    let motion = match executed.kind {
        MoveKind::Rapid => say::narration_rapid(x, z),
        MoveKind::Feed => say::narration_cut(x, z),
        MoveKind::Clockwise => say::narration_cut_clockwise(x, z),
        MoveKind::CounterClockwise => say::narration_cut_counter_clockwise(x, z),
        MoveKind::Thread => say::narration_thread(x, z),
        MoveKind::RunOut => say::narration_run_out(x, z),
        MoveKind::Dwell => {
            return say::narration_wait(round_to_millionth(executed.duration_s)).text(language);
        }
    };
    let feed = executed.feed.map(|feed| match feed {
        Feed::PerMinute(feed) => say::narration_per_minute(round_to_millionth(feed)),
        Feed::PerRevolution(feed) => say::narration_per_revolution(round_to_millionth(feed)),
    });
    let duration = say::narration_takes(executed.duration_s);
    let sentences = [Some(motion), feed, Some(duration)];
    sentences
        .iter()
        .flatten()
        .map(|it| it.text(language))
        .collect()
}
