//! Checks a program: interprets it without running the machine.

use std::collections::BTreeMap;

use gsk_core::command::ExecutedMove;
use gsk_core::preview::{Preview, Progress, Turning, preview_beyond_alarms};
use gsk_core::setup::Setup;
use gsk_messages::Language;

use super::{
    AlarmReport, Bounds, Final, PathReport, Report, Seconds, ToolSeconds, WarningReport, changed,
    modal_codes, tool_word,
};
use crate::moves::{diameter_z, rounded};
use crate::times::Times;

/// Previews the selected program of a set-up, and continues after alarms. `on_move` receives
/// every move in order. `goes_on` is called with the progress; it returns false to cancel.
pub fn check(
    name: &str,
    setup: &Setup,
    language: Option<Language>,
    on_move: &mut dyn FnMut(&ExecutedMove),
    goes_on: &mut dyn FnMut(&Progress) -> bool,
) -> Report {
    let mut times = Times::default();
    let mut take = |executed: &ExecutedMove| {
        times.push(executed);
        on_move(executed);
    };
    let preview = preview_beyond_alarms(setup, &setup.memory.programs, &mut take, goes_on);
    times.end(preview.time_s);
    of(name, setup, &preview, &times, language)
}

fn of(
    name: &str,
    setup: &Setup,
    preview: &Preview,
    times: &Times,
    language: Option<Language>,
) -> Report {
    let told = |alarm| AlarmReport::new(alarm, &setup.memory.programs, language);
    Report {
        file: name.to_owned(),
        end: preview.end.into(),
        alarm: preview.alarm.as_ref().map(told),
        waits_for: None,
        time_s: rounded(preview.time_s),
        cutting_s: rounded(preview.cutting_s),
        blocks: preview.blocks,
        moves: preview.moves,
        parts: preview.parts,
        stops: preview.stops,
        position: Final::new(preview.absolute, preview.machine, preview.relative),
        modal: modal_codes(&preview.modal),
        f: preview.modal.feed,
        s: preview.modal.spindle,
        t: tool_word((preview.modal.tool, preview.modal.offset)),
        spindle: match preview.spindle {
            Turning::Clockwise => "cw",
            Turning::CounterClockwise => "ccw",
            Turning::Stopped => "stop",
        },
        coolant: preview.coolant,
        parameters_changed: changed(&setup.memory.parameters, &preview.parameters),
        warnings: preview
            .cautions
            .iter()
            .map(|caution| WarningReport::new(caution, language))
            .collect(),
        path: Some(PathReport {
            more_alarms: preview.further.alarms.iter().map(told).collect(),
            unchecked_behind: preview.further.ends_at.map(|source| source.line),
            times: Seconds::from(times.spent()),
            tool_times: times.tools().iter().map(ToolSeconds::from).collect(),
            ..path(preview)
        }),
        part: None,
    }
}

fn path(preview: &Preview) -> PathReport {
    let lengths = &preview.lengths;
    PathReport {
        lengths: BTreeMap::from([
            ("rapid", rounded(lengths.rapid)),
            ("feed", rounded(lengths.feed)),
            ("cw", rounded(lengths.clockwise)),
            ("ccw", rounded(lengths.counter_clockwise)),
            ("thread", rounded(lengths.thread)),
        ]),
        tools: preview.tools.iter().map(|tool| tool_word(*tool)).collect(),
        bounds: preview.bounds.map(|bounds| {
            let (low, high) = (diameter_z(bounds.least), diameter_z(bounds.greatest));
            Bounds {
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
