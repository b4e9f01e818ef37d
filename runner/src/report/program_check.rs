//! Checks a program: interprets it without running the machine.

use std::collections::BTreeMap;

use gsk_core::command::ExecutedMove;
use gsk_core::preview::{Preview, PreviewProgress, SpindleRotation, preview_beyond_alarms};
use gsk_core::setup::Setup;
use gsk_messages::Language;

use super::{
    AlarmReport, FinalPositions, PathReport, ProgramReport, ReportBounds, TimeReport,
    ToolTimeReport, WarningReport, changed_parameters, modal_codes, tool_word,
};
use crate::move_output::{diameter_z, round_to_millionth};
use crate::times::ProgramTimes;

/// Previews the selected program of a set-up, continues after alarms, and reports on it.
/// `on_move` receives every move in order. `can_continue` receives the progress and returns
/// false to cancel.
pub fn check_program(
    name: &str,
    setup: &Setup,
    language: Option<Language>,
    on_move: &mut dyn FnMut(&ExecutedMove),
    can_continue: &mut dyn FnMut(&PreviewProgress) -> bool,
) -> ProgramReport {
    let mut times = ProgramTimes::default();
    let mut add = |executed: &ExecutedMove| {
        times.add_move(executed);
        on_move(executed);
    };
    let preview = preview_beyond_alarms(setup, &setup.memory.programs, &mut add, can_continue);
    times.end_at(preview.time_s);
    build_report(name, setup, &preview, &times, language)
}

fn build_report(
    name: &str,
    setup: &Setup,
    preview: &Preview,
    times: &ProgramTimes,
    language: Option<Language>,
) -> ProgramReport {
    let alarm_report = |alarm| AlarmReport::new(alarm, &setup.memory.programs, language);
    ProgramReport {
        naming: setup.memory.model.record().program_naming(),
        file: name.to_owned(),
        end: preview.end.into(),
        alarm: preview.alarm.as_ref().map(alarm_report),
        waits_for: None,
        time_s: round_to_millionth(preview.time_s),
        cutting_s: round_to_millionth(preview.cutting_s),
        blocks: preview.blocks,
        moves: preview.moves,
        parts: preview.parts,
        stops: preview.stops,
        position: FinalPositions::new(preview.absolute, preview.machine, preview.relative),
        modal: modal_codes(&preview.modal),
        f: preview.modal.feed,
        s: preview.modal.spindle,
        t: tool_word((preview.modal.tool, preview.modal.offset)),
        spindle: match preview.spindle {
            SpindleRotation::Clockwise => "cw",
            SpindleRotation::CounterClockwise => "ccw",
            SpindleRotation::Stopped => "stop",
        },
        coolant: preview.coolant,
        breaks: Vec::new(),
        parameters_changed: changed_parameters(&setup.memory.parameters, &preview.parameters),
        warning_kinds: Vec::new(),
        warnings: preview
            .cautions
            .iter()
            .map(|caution| WarningReport::new(caution, language))
            .collect(),
        path: Some(PathReport {
            more_alarms: preview.further.alarms.iter().map(alarm_report).collect(),
            unchecked_after: preview.further.ends_at.map(|source| source.line),
            times: TimeReport::from(times.spent()),
            tool_times: times.tools().iter().map(ToolTimeReport::from).collect(),
            ..path_report(preview)
        }),
        part: None,
        load: None,
    }
}

fn path_report(preview: &Preview) -> PathReport {
    let lengths = &preview.lengths;
    PathReport {
        lengths: BTreeMap::from([
            ("rapid", round_to_millionth(lengths.rapid)),
            ("feed", round_to_millionth(lengths.feed)),
            ("cw", round_to_millionth(lengths.clockwise)),
            ("ccw", round_to_millionth(lengths.counter_clockwise)),
            ("thread", round_to_millionth(lengths.thread)),
        ]),
        programs: preview.programs.clone(),
        tools: preview.tools.iter().map(|tool| tool_word(*tool)).collect(),
        bounds: preview.bounds.map(|bounds| {
            let (low, high) = (diameter_z(bounds.least), diameter_z(bounds.greatest));
            ReportBounds {
                x: (low.0, high.0),
                y: None,
                z: (low.1, high.1),
                further: BTreeMap::new(),
                turning: Vec::new(),
            }
        }),
        ..PathReport::default()
    }
}
