//! `pitch`: imports and shows the pitch error table of a control.

use std::path::PathBuf;

use gsk_commission::{
    AxisDeviation, ParameterChange, PitchPlan, PitchPlanOptions, ScrewFit, SlideTravel,
    compute_correction, pitch_interval, write_csv, write_ren,
};
use gsk_core::battery::BatteryMemory;
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::units::Axis;
use gsk_host::files::pitch::{self, EvaluatedMeasurement, axis_letter};
use gsk_host::project::{self, ImportRights, ImportTarget};
use gsk_messages::{Language, Message, say};
use gsk_runner::report::message_text;
use serde_json::{Value as Json, json};

use super::project::{data_directory, print_differences, report_denied_changes};
use super::{CommandError, EXIT_ALARM, EXIT_OK, output};
use crate::cli::{PitchCommand, PitchFormat, PitchImportArgs, PitchShowArgs};

/// Number of the last point in the pitch error table.
const LAST_POINT: u8 = 255;

pub fn pitch(command: &PitchCommand, language: Option<Language>) -> Result<u8, CommandError> {
    match command {
        PitchCommand::Import(args) => import(args, language),
        PitchCommand::Show(args) => show_table(args, language),
    }
}

fn print_message(message: &Message, language: Option<Language>) {
    output::print(&format!("{}\n", message_text(message, language)));
}

fn import(args: &PitchImportArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let axis = args.axis;
    let at_file = |rule: Message| CommandError::from(say::pitch_file(args.file.display(), rule));
    let imported = pitch::read_file(&args.file)?;
    let folder = data_directory(args.into.as_ref())?;
    let target = ImportTarget {
        data_dir: &folder,
        model: args.model,
        rights: match &args.password {
            Some(password) => ImportRights::Password(password),
            None => ImportRights::AtPowerOn,
        },
        dry_run: args.dry_run,
    };
    let options = PitchPlanOptions {
        interval: args.interval.map(SlideTravel),
        clear: args.clear,
    };
    let opened = project::open_control_memory(&target)?;
    let memory = opened.memory();
    let old_tables = (memory.parameters.clone(), memory.pitch.clone());
    let found = pitch::evaluate_measurement(
        imported,
        axis,
        options,
        args.diameter,
        (&old_tables.0, &old_tables.1),
    );
    let found = found.map_err(at_file)?;
    let differences = pitch::list_differences(&found.proposal().changes, opened.state());
    let taken = opened.apply_differences(differences, args.dry_run)?;
    for complaint in &taken.complaints {
        complain!("gsk980td: {}", message_text(complaint, language));
    }
    if !taken.denied_changes.is_empty() {
        report_denied_changes(&taken, language);
        return Ok(EXIT_ALARM);
    }
    if args.json {
        let mut value = result_to_json(axis, &found);
        if let Json::Object(fields) = &mut value {
            fields.insert("written".to_owned(), json!(taken.backup_folder.is_some()));
        }
        output::print(&format!("{}\n", serde_json::to_string_pretty(&value)?));
        return Ok(EXIT_OK);
    }
    if let EvaluatedMeasurement::Measured(measured, fit, plan) = &found {
        print_message(
            &describe_fit(measured.readings.len(), measured.runs(), fit),
            language,
        );
        print_message(
            &say::commission_plan(plan.before.0, plan.after.0, plan.interval.0),
            language,
        );
    }
    if args.dry_run {
        print_comparison(axis, &old_tables, &found);
    }
    print_differences(
        &taken.differences,
        &taken.old_state,
        &taken.new_state,
        language,
    );
    for note in &found.proposal().notes {
        print_message(note, language);
    }
    let (count, shown) = (taken.differences.len(), taken.model_folder.display());
    match &taken.backup_folder {
        Some(backup) => {
            print_message(&say::project_applied(shown, count), language);
            print_message(&say::project_backup(backup.display()), language);
        }
        None if count > 0 => print_message(&say::pitch_nothing_written(), language),
        None => print_message(&say::commission_no_changes(), language),
    }
    Ok(EXIT_OK)
}

/// Formats the result of a fit: number of readings and runs, and the fitted errors of the
/// screw.
fn describe_fit(readings: usize, runs: usize, fit: &ScrewFit) -> Message {
    let backlash = match fit.backlash {
        Some(play) => say::commission_play(play.0),
        None => say::commission_play_unknown(),
    };
    say::pitch_fit_summary(
        readings,
        runs,
        fit.residual.0.0,
        fit.residual.1.0,
        fit.slope_um_per_m,
        backlash,
    )
}

/// Prints the current and the proposed corrections, point by point.
fn print_comparison(
    axis: Axis,
    (parameters, table): &(ControlParameters, PitchTable),
    found: &EvaluatedMeasurement,
) {
    let (mut new_parameters, mut new_table) = (parameters.clone(), table.clone());
    for change in &found.proposal().changes {
        // The changes were applied before: none is refused.
        let _ = change.apply(&mut new_parameters, &mut new_table);
    }
    let mut positions = point_positions(axis, &new_parameters);
    if let EvaluatedMeasurement::Measured(_, fit, plan) = found {
        let (first, last) = fit.curve.range();
        let within = first.0 - plan.interval.0..=last.0 + plan.interval.0;
        positions.retain(|(_, at)| within.contains(&at.0));
    }
    let before = compute_correction(axis, parameters, table, positions.iter().map(|(_, at)| *at));
    let after = compute_correction(
        axis,
        &new_parameters,
        &new_table,
        positions.iter().map(|(_, at)| *at),
    );
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

/// Lists the points of the table with their positions, in ascending order of points.
fn point_positions(axis: Axis, parameters: &ControlParameters) -> Vec<(u8, SlideTravel)> {
    let interval = pitch_interval(axis, parameters)
        .unwrap_or(SlideTravel(0.0))
        .0;
    let origin = f64::from(parameters.pitch_origin(axis));
    let position = |point: u8| SlideTravel((f64::from(point) - origin) * interval);
    (0..=LAST_POINT)
        .map(|point| (point, position(point)))
        .collect()
}

/// Lists the points of an axis whose value is not 0: number of the point, far end of its
/// interval, value.
fn table_rows(axis: Axis, memory: &BatteryMemory) -> Vec<(u8, SlideTravel, AxisDeviation)> {
    let parameters = &memory.parameters;
    let Some(interval) = pitch_interval(axis, parameters) else {
        return Vec::new();
    };
    let origin = parameters.pitch_origin(axis);
    let unit = parameters.least_increment_mm() * 1000.0 * f64::from(parameters.pitch_factor());
    (1..=LAST_POINT)
        .filter_map(|point| {
            let value = memory.pitch.value(axis, point);
            // Seen from the machine zero the interval ends at its far point.
            let end_point = if point > origin {
                point.into()
            } else {
                i32::from(point) - 1
            };
            let end = f64::from(end_point - i32::from(origin)) * interval.0;
            let row = (
                point,
                SlideTravel(end),
                AxisDeviation(f64::from(value) * unit),
            );
            (value != 0).then_some(row)
        })
        .collect()
}

fn show_table(args: &PitchShowArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let folder: PathBuf = data_directory(args.data.as_ref())?;
    let held = project::read_control(&folder, args.model)?;
    for complaint in held.complaints() {
        complain!("gsk980td: {}", message_text(complaint, language));
    }
    let axes = [Axis::X, Axis::Z];
    let axes = axes
        .into_iter()
        .filter(|it| args.axis.is_none_or(|only| only == *it));
    let memory = &held.memory;
    if args.format == PitchFormat::Json {
        let tables: Vec<Json> = axes.map(|axis| table_to_json(axis, memory)).collect();
        output::print(&format!("{}\n", serde_json::to_string_pretty(&tables)?));
        return Ok(EXIT_OK);
    }
    for axis in axes {
        show_axis(axis, memory, args.format, language);
    }
    Ok(if held.complaints().is_empty() {
        EXIT_OK
    } else {
        EXIT_ALARM
    })
}

fn show_axis(axis: Axis, memory: &BatteryMemory, format: PitchFormat, language: Option<Language>) {
    let parameters = &memory.parameters;
    let interval = pitch_interval(axis, parameters).unwrap_or(SlideTravel(0.0));
    let positions = point_positions(axis, parameters)
        .into_iter()
        .map(|(_, at)| at);
    let curve = compute_correction(axis, parameters, &memory.pitch, positions);
    let rows = table_rows(axis, memory);
    match format {
        PitchFormat::Csv => output::print(&write_csv(&curve)),
        PitchFormat::Ren => {
            let backlash = AxisDeviation(parameters.backlash(axis) * 1000.0);
            output::print(&write_ren(axis, interval, backlash, &rows));
        }
        PitchFormat::Human | PitchFormat::Json => {
            let state = match parameters.is_pitch_compensated() {
                true => say::pitch_show_on(),
                false => say::pitch_show_off(),
            };
            let head = say::pitch_show_head(
                axis_letter(axis),
                interval.0,
                format_args!("{:03}", parameters.pitch_origin(axis)),
                parameters.pitch_factor(),
                state,
            );
            print_message(&head, language);
            if rows.is_empty() {
                print_message(&say::pitch_show_flat(), language);
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

fn table_to_json(axis: Axis, memory: &BatteryMemory) -> Json {
    let parameters = &memory.parameters;
    let points: Vec<Json> = table_rows(axis, memory)
        .into_iter()
        .map(|(point, end, value)| json!({"point": point, "end_mm": end.0, "value_um": value.0}))
        .collect();
    json!({
        "axis": axis_letter(axis).to_string(),
        "interval_mm": pitch_interval(axis, parameters).map(|it| it.0),
        "origin": parameters.pitch_origin(axis),
        "factor": parameters.pitch_factor(),
        "compensated": parameters.is_pitch_compensated(),
        "backlash_mm": parameters.backlash(axis),
        "points": points,
    })
}

fn result_to_json(axis: Axis, found: &EvaluatedMeasurement) -> Json {
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
        EvaluatedMeasurement::Table(_) => Json::Null,
        EvaluatedMeasurement::Measured(measured, fit, plan) => {
            fit_to_json(measured.runs(), fit, plan)
        }
    };
    json!({"axis": axis_letter(axis).to_string(), "fit": fit, "changes": changes})
}

fn fit_to_json(runs: usize, fit: &ScrewFit, plan: &PitchPlan) -> Json {
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
