//! `pitch`: imports and shows the pitch error table of a control.

use std::path::PathBuf;

use gsk_commission::{
    AxisDeviation, ParameterChange, PitchPlan, PitchPlanOptions, ScrewFit, SlideTravel,
    compute_correction, pitch_interval, write_csv, write_ren,
};
use gsk_core::battery::Memory;
use gsk_core::memory::{Parameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Language, Message, say};
use gsk_runner::report::said;
use serde_json::{Value as Json, json};

use super::project::{directory, list, tell_denied};
use super::{ALARM, CommandError, FINE, output};
use crate::cli::{PitchCommand, PitchFormat, PitchImportArgs, PitchShowArgs};
use crate::pitch::{self, Found, letter};
use crate::project::{self, Target, Who};

/// The last point of the table.
const LAST: u8 = 255;

pub fn pitch(command: &PitchCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        PitchCommand::Import(args) => import(args, language),
        PitchCommand::Show(args) => show(args, language),
    }
}

fn say(message: &Message, language: Option<Language>) {
    output::print(&format!("{}\n", said(message, language)));
}

fn import(args: &PitchImportArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let axis = args.axis;
    let at_file = |rule: Message| CommandError::Pitch(say::pitch_file(args.file.display(), rule));
    let imported = pitch::read_file(&args.file).map_err(CommandError::Pitch)?;
    let folder = directory(args.into.as_ref())?;
    let target = Target {
        directory: &folder,
        model: args.model,
        who: match &args.password {
            Some(password) => Who::Password(password),
            None => Who::AtPowerOn,
        },
        dry_run: args.dry_run,
    };
    let wish = PitchPlanOptions {
        interval: args.interval.map(SlideTravel),
        clear: args.clear,
    };
    let opened = project::open(&target)?;
    let memory = opened.memory();
    let own = (memory.parameters.clone(), memory.pitch.clone());
    let found = pitch::found(imported, axis, wish, args.diameter, (&own.0, &own.1));
    let found = found.map_err(at_file)?;
    let differences = pitch::differences(&found.proposal().changes, opened.state());
    let taken = opened.take_over(differences, args.dry_run)?;
    for complaint in &taken.complaints {
        complain!("gsk980td: {}", said(complaint, language));
    }
    if !taken.denied.is_empty() {
        tell_denied(&taken, language);
        return Ok(ALARM);
    }
    if args.json {
        let mut value = as_json(axis, &found);
        if let Json::Object(fields) = &mut value {
            fields.insert("written".to_owned(), json!(taken.backup.is_some()));
        }
        output::print(&format!("{}\n", serde_json::to_string_pretty(&value)?));
        return Ok(FINE);
    }
    if let Found::Measured(measured, fit, plan) = &found {
        say(
            &fitted(measured.readings.len(), measured.runs(), fit),
            language,
        );
        say(
            &say::commission_plan(plan.before.0, plan.after.0, plan.interval.0),
            language,
        );
    }
    if args.dry_run {
        compare(axis, &own, &found);
    }
    list(&taken.differences, &taken.old, &taken.new, language);
    for note in &found.proposal().notes {
        say(note, language);
    }
    let (count, shown) = (taken.differences.len(), taken.folder.display());
    match &taken.backup {
        Some(backup) => {
            say(&say::project_applied(shown, count), language);
            say(&say::project_backup(backup.display()), language);
        }
        None if count > 0 => say(&say::pitch_nothing_written(), language),
        None => say(&say::commission_no_changes(), language),
    }
    Ok(FINE)
}

/// Describes the fitted errors of a screw.
fn fitted(readings: usize, runs: usize, fit: &ScrewFit) -> Message {
    let play = match fit.backlash {
        Some(play) => say::commission_play(play.0),
        None => say::commission_play_unknown(),
    };
    say::pitch_fit_said(
        readings,
        runs,
        fit.residual.0.0,
        fit.residual.1.0,
        fit.slope_um_per_m,
        play,
    )
}

/// Prints the current and the proposed corrections, point by point.
fn compare(axis: Axis, (parameters, table): &(Parameters, PitchTable), found: &Found) {
    let (mut then, mut new) = (parameters.clone(), table.clone());
    for change in &found.proposal().changes {
        // The changes were applied before: none is refused.
        let _ = change.apply(&mut then, &mut new);
    }
    let mut positions = points(axis, &then);
    if let Found::Measured(_, fit, plan) = found {
        let (first, last) = fit.curve.range();
        let within = first.0 - plan.interval.0..=last.0 + plan.interval.0;
        positions.retain(|(_, at)| within.contains(&at.0));
    }
    let before = compute_correction(axis, parameters, table, positions.iter().map(|(_, at)| *at));
    let after = compute_correction(axis, &then, &new, positions.iter().map(|(_, at)| *at));
    let mut out = String::from("position,correction,proposed\n");
    let mut last = None;
    for ((at, old), (_, value)) in before.points().iter().zip(after.points()) {
        // One line for adjacent points with equal corrections.
        let row = (old.0, value.0);
        if last != Some(row) {
            out.push_str(&format!("{:.3},{:.3},{:.3}\n", at.0, row.0, row.1));
        }
        last = Some(row);
    }
    output::print(&out);
}

/// The points of the table with their positions, in ascending order of points.
fn points(axis: Axis, parameters: &Parameters) -> Vec<(u8, SlideTravel)> {
    let interval = pitch_interval(axis, parameters)
        .unwrap_or(SlideTravel(0.0))
        .0;
    let origin = f64::from(parameters.pitch_origin(axis));
    let place = |point: u8| SlideTravel((f64::from(point) - origin) * interval);
    (0..=LAST).map(|point| (point, place(point))).collect()
}

/// The points of an axis whose value is not 0: point, far end of its interval, value in µm.
fn rows(axis: Axis, memory: &Memory) -> Vec<(u8, SlideTravel, AxisDeviation)> {
    let parameters = &memory.parameters;
    let Some(interval) = pitch_interval(axis, parameters) else {
        return Vec::new();
    };
    let origin = parameters.pitch_origin(axis);
    let unit = parameters.least_increment() * 1000.0 * f64::from(parameters.pitch_factor());
    (1..=LAST)
        .filter_map(|point| {
            let value = memory.pitch.value(axis, point);
            // Seen from the machine zero the interval ends at its far point.
            let ends = if point > origin {
                point.into()
            } else {
                i32::from(point) - 1
            };
            let end = f64::from(ends - i32::from(origin)) * interval.0;
            let row = (
                point,
                SlideTravel(end),
                AxisDeviation(f64::from(value) * unit),
            );
            (value != 0).then_some(row)
        })
        .collect()
}

fn show(args: &PitchShowArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let folder: PathBuf = directory(args.data.as_ref())?;
    let held = project::of_data(&folder, args.model)?;
    for complaint in held.complaints() {
        complain!("gsk980td: {}", said(complaint, language));
    }
    let axes = [Axis::X, Axis::Z];
    let axes = axes
        .into_iter()
        .filter(|it| args.axis.is_none_or(|only| only == *it));
    let memory = &held.memory;
    if args.format == PitchFormat::Json {
        let tables: Vec<Json> = axes.map(|axis| table_as_json(axis, memory)).collect();
        output::print(&format!("{}\n", serde_json::to_string_pretty(&tables)?));
        return Ok(FINE);
    }
    for axis in axes {
        show_axis(axis, memory, args.format, language);
    }
    Ok(if held.complaints().is_empty() {
        FINE
    } else {
        ALARM
    })
}

fn show_axis(axis: Axis, memory: &Memory, format: PitchFormat, language: Option<Language>) {
    let parameters = &memory.parameters;
    let interval = pitch_interval(axis, parameters).unwrap_or(SlideTravel(0.0));
    let positions = points(axis, parameters).into_iter().map(|(_, at)| at);
    let curve = compute_correction(axis, parameters, &memory.pitch, positions);
    let rows = rows(axis, memory);
    match format {
        PitchFormat::Csv => output::print(&write_csv(&curve)),
        PitchFormat::Ren => {
            let backlash = AxisDeviation(parameters.backlash(axis) * 1000.0);
            output::print(&write_ren(axis, interval, backlash, &rows));
        }
        PitchFormat::Human | PitchFormat::Json => {
            let state = match parameters.pitch_compensated() {
                true => say::pitch_show_on(),
                false => say::pitch_show_off(),
            };
            let head = say::pitch_show_head(
                letter(axis),
                interval.0,
                format_args!("{:03}", parameters.pitch_origin(axis)),
                parameters.pitch_factor(),
                state,
            );
            say(&head, language);
            if rows.is_empty() {
                say(&say::pitch_show_flat(), language);
            }
            for (point, end, value) in rows {
                let sum = curve.at(end).0;
                output::print(&format!(
                    "  {point:03} {:>10.3} mm {:>6} µm {sum:>8.1} µm\n",
                    end.0, value.0
                ));
            }
        }
    }
}

fn table_as_json(axis: Axis, memory: &Memory) -> Json {
    let parameters = &memory.parameters;
    let points: Vec<Json> = rows(axis, memory)
        .into_iter()
        .map(|(point, end, value)| json!({"point": point, "end_mm": end.0, "value_um": value.0}))
        .collect();
    json!({
        "axis": letter(axis).to_string(),
        "interval_mm": pitch_interval(axis, parameters).map(|it| it.0),
        "origin": parameters.pitch_origin(axis),
        "factor": parameters.pitch_factor(),
        "compensated": parameters.pitch_compensated(),
        "backlash_mm": parameters.backlash(axis),
        "points": points,
    })
}

fn as_json(axis: Axis, found: &Found) -> Json {
    let changes: Vec<Json> = found
        .proposal()
        .changes
        .iter()
        .map(|change| match *change {
            ParameterChange::Value { number, value } => {
                json!({"parameter": number, "value": value})
            }
            ParameterChange::Bit { number, bit, on } => {
                json!({"parameter": number, "bit": bit, "value": u8::from(on)})
            }
            ParameterChange::Pitch { point, value, .. } => json!({"point": point, "value": value}),
        })
        .collect();
    let fit = match found {
        Found::Table(_) => Json::Null,
        Found::Measured(measured, fit, plan) => fit_as_json(measured.runs(), fit, plan),
    };
    json!({"axis": letter(axis).to_string(), "fit": fit, "changes": changes})
}

fn fit_as_json(runs: usize, fit: &ScrewFit, plan: &PitchPlan) -> Json {
    let curve: Vec<Json> = fit
        .curve
        .points()
        .iter()
        .map(|(at, value)| json!({"position_mm": at.0, "deviation_um": value.0}))
        .collect();
    json!({
        "runs": runs,
        "curve": curve,
        "backlash_um": fit.backlash.map(|it| it.0),
        "rms_um": fit.residual.0.0,
        "largest_um": fit.residual.1.0,
        "slope_um_per_m": fit.slope_um_per_m,
        "interval_mm": plan.interval.0,
        "before_um": plan.before.0,
        "after_um": plan.after.0,
    })
}
