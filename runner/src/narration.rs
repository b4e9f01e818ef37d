//! A program told block by block while it is carried out, as on a blackboard.

use gsk_core::command::{ExecutedMove, MoveKind};
use gsk_core::interpreter::{Explanation, Modal};
use gsk_core::units::Feed;

use crate::moves::{diameter_z, rounded};
use crate::report::modal_codes;
use crate::words::beginning;

/// A block that begins, with the words in force; `line` counts from 1.
pub fn block(line: u32, text: &str, modal: &Modal) -> String {
    let codes = modal_codes(modal).join(" ");
    let (feed, speed) = (rounded(modal.feed), rounded(modal.spindle));
    let (tool, offset) = (modal.tool, modal.offset);
    format!(
        "{line:6}  {}\n        {codes} F{feed} S{speed} T{tool:02}{offset:02}\n",
        beginning(text)
    )
}

/// A pass of a cycle.
pub fn pass(explanation: &Explanation) -> String {
    let Explanation {
        code,
        pass,
        depth,
        remaining,
        formula,
        words,
        ..
    } = explanation;
    let of = explanation
        .passes
        .map_or_else(String::new, |passes| format!(" of {passes}"));
    let level = explanation
        .level
        .map_or_else(String::new, |level| format!(" at {}", rounded(level)));
    let cut = if *depth == 0.0 && *remaining == 0.0 {
        String::new()
    } else {
        format!(": depth {depth:.3}, left {remaining:.3}")
    };
    format!("        G{code:02} pass {pass}{of}{level}{cut}\n          {formula}   [{words}]\n")
}

/// A move that was executed.
pub fn executed(executed: &ExecutedMove) -> String {
    format!("        {}\n", sentence(executed))
}

fn sentence(executed: &ExecutedMove) -> String {
    let (x, z) = diameter_z(executed.to);
    let verb = match executed.kind {
        MoveKind::Rapid => "rapid",
        MoveKind::Feed => "cut",
        MoveKind::Clockwise => "cut clockwise",
        MoveKind::CounterClockwise => "cut counter-clockwise",
        MoveKind::Thread => "thread",
        MoveKind::RunOut => "leave the thread",
        MoveKind::Dwell => return format!("wait {} s", rounded(executed.duration_s)),
    };
    let feed = match executed.feed {
        Some(Feed::PerMinute(feed)) => format!(" at {} mm/min", rounded(feed)),
        Some(Feed::PerRevolution(feed)) => format!(" at {} mm/r", rounded(feed)),
        None => String::new(),
    };
    format!("{verb} to X{x} Z{z}{feed}: {:.2} s", executed.duration_s)
}
