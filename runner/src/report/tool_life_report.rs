//! Warns about tools that cut longer than their edges still last.

use std::collections::BTreeMap;

use gsk_core::preview::Lint;
use gsk_messages::{Language, say};

use super::{ProgramReport, WarningReport, message_text};
use crate::machining::Machining;

/// The rest of the life of a tool's edge.
#[derive(Clone, Debug, PartialEq)]
pub struct ToolLifeLimit {
    /// The tool in the tool library.
    pub id: String,
    /// Minutes in the cut that the edge still lasts.
    pub remaining_minutes: f64,
}

impl ProgramReport {
    /// Adds a warning at the first cut of each tool that cuts longer than its edge still lasts.
    pub fn add_tool_lives(
        &mut self,
        machining: &Machining,
        limits: &BTreeMap<u8, ToolLifeLimit>,
        language: Option<Language>,
    ) {
        for (number, limit) in limits {
            let Some(cutting) = machining.cutting().get(number) else {
                continue;
            };
            let minutes = cutting.seconds / 60.0;
            let Some(source) = cutting
                .first_block
                .filter(|_| minutes > limit.remaining_minutes)
            else {
                continue;
            };
            let message = say::tool_life_exceeded(
                format_args!("{number:02}"),
                &limit.id,
                format_args!("{minutes:.2}"),
                format_args!("{:.2}", limit.remaining_minutes),
            );
            let sentence = say::in_line(source.line, message.clone());
            self.warnings.push(WarningReport {
                lint: Lint::ToolLife,
                is_denied: false,
                program: source.program,
                line: source.line,
                columns: None,
                text: message_text(&message, language),
                sentence: message_text(&sentence, language),
            });
        }
    }
}
