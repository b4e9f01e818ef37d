//! The step for pitch errors: reads a measurement file, proposes a table for it, and compares
//! it with the current one.

use std::path::Path;

use crossbeam::channel::{Receiver, bounded};
use egui::{ScrollArea, Ui};
use gsk_commission::{
    DeviationCurve, ImportedFile, ParameterChange, PitchPlanOptions, SlideTravel,
    compute_correction,
};
use gsk_core::memory::{ControlParameters, PitchTable};
use gsk_core::units::Axis;
use gsk_host::files::pitch::{EvaluatedMeasurement, evaluate_measurement, read_file};
use gsk_host::kernel::Console;
use gsk_messages::{Language, Message, say};

use super::graph::{self, PitchCurves};
use super::inputs::{CommissionInputs, parse_optional};
use crate::widgets::files::{self, FileChoice};

/// Number of intervals into which the drawn corrections are divided.
const DRAWN_INTERVALS: i32 = 600;
/// Height of the list of table points, in window points.
const LIST_HEIGHT: f32 = 150.0;

/// Extensions of measurement files, in lower case without the dot.
const EXTENSIONS: [&str; 4] = ["csv", "ren", "rtl", "txt"];

/// A measurement file that was read: its name and content.
#[derive(Clone, Debug)]
struct MeasurementFile {
    name: String,
    imported: ImportedFile,
}

/// The measurement file and the result of the pitch error step.
#[derive(Default)]
pub struct PitchErrorStep {
    pending: Option<Receiver<MeasurementFile>>,
    file: Option<MeasurementFile>,
    curves: PitchCurves,
    summary: Vec<Message>,
}

impl PitchErrorStep {
    /// Draws the button that reads a file, and the summary of the file. Returns true when
    /// another file has been read.
    pub fn show(&mut self, ui: &mut Ui, language: Language, console: &Console) -> bool {
        let received = self.pending.as_ref().and_then(|it| it.try_recv().ok());
        let is_new = received.is_some();
        if is_new {
            self.file = received;
            self.pending = None;
        }
        if ui
            .button(say::commission_open_file().text(language))
            .clicked()
        {
            self.choose_file(ui, language, console);
        }
        if let Some(measured) = &self.file {
            let name = &measured.name;
            let text = match &measured.imported {
                ImportedFile::Measured(it) => {
                    say::commission_file_read(name, it.readings.len(), it.runs())
                }
                ImportedFile::Table(table) => say::commission_file_table(name, table.rows.len()),
            };
            ui.label(text.text(language));
        }
        is_new
    }

    fn choose_file(&mut self, ui: &Ui, language: Language, console: &Console) {
        let (sender, pending) = bounded(1);
        self.pending = Some(pending);
        let kind = say::commission_open_file().text(language);
        let choice = FileChoice::Open(kind, EXTENSIONS.to_vec());
        files::choose_file(
            ui.ctx(),
            language,
            &console.notice_sender,
            choice,
            move |path| {
                match read_file(&path) {
                    Ok(imported) => {
                        let name = path.file_name().map(Path::new);
                        let name = name.unwrap_or(&path).display().to_string();
                        // A closed window shows nothing.
                        let _ = sender.send(MeasurementFile { name, imported });
                        None
                    }
                    Err(error) => Some(error),
                }
            },
        );
    }

    /// Evaluates the file with the current parameters and table and computes the curves to
    /// draw; `None` without a file.
    pub fn propose(
        &mut self,
        axis: Axis,
        fields: &CommissionInputs,
        current: (&ControlParameters, &PitchTable),
    ) -> Result<Option<EvaluatedMeasurement>, Message> {
        self.summary.clear();
        let Some(measured) = &self.file else {
            return Ok(None);
        };
        let options = PitchPlanOptions {
            interval: parse_optional(&fields.pitch_interval_text)?.map(SlideTravel),
            clear: fields.is_table_empty,
        };
        let imported = measured.imported.clone();
        let result = evaluate_measurement(
            imported,
            axis,
            options,
            fields.are_targets_diameters,
            current,
        )?;
        let (mut proposed, mut table) = (current.0.clone(), current.1.clone());
        for change in &result.proposal().changes {
            change.apply(&mut proposed, &mut table)?;
        }
        let measured = match &result {
            EvaluatedMeasurement::Measured(_, fit, plan) => {
                let backlash_text = match fit.backlash {
                    Some(play) => say::commission_play(play.0),
                    None => say::commission_play_unknown(),
                };
                self.summary = vec![
                    say::commission_fit(fit.residual.1.0, fit.slope_um_per_m, backlash_text),
                    say::commission_plan(plan.before.0, plan.after.0, plan.interval.0),
                ];
                fit.curve.clone()
            }
            EvaluatedMeasurement::Table(_) => DeviationCurve::default(),
        };
        let (first, last) = match &result {
            EvaluatedMeasurement::Measured(_, fit, _) => fit.curve.range(),
            EvaluatedMeasurement::Table(_) => {
                table_range(axis, &proposed, &result.proposal().changes)
            }
        };
        let step = (last.0 - first.0) / f64::from(DRAWN_INTERVALS);
        let positions =
            || (0..=DRAWN_INTERVALS).map(|index| SlideTravel(first.0 + step * f64::from(index)));
        self.curves = PitchCurves {
            current: compute_correction(axis, current.0, current.1, positions()),
            measured,
            proposed: compute_correction(axis, &proposed, &table, positions()),
        };
        Ok(Some(result))
    }

    /// Draws the curves, and the corrections at the targets as a list.
    pub fn show_result(&self, ui: &mut Ui, language: Language) {
        for line in &self.summary {
            ui.label(line.text(language));
        }
        graph::show(ui, language, &self.curves);
        let rows = self.curves.measured.points();
        if rows.is_empty() {
            return;
        }
        let height = ui.spacing().interact_size.y;
        ScrollArea::vertical()
            .id_salt("pitch targets")
            .max_height(LIST_HEIGHT)
            .show_rows(ui, height, rows.len(), |ui, shown| {
                for (at, value) in rows.get(shown).unwrap_or_default() {
                    let (old, new) = (
                        self.curves.current.at(*at).0,
                        self.curves.proposed.at(*at).0,
                    );
                    let text = format!(
                        "{:>10.3} mm  {:>7.1}  {old:>7.1} → {new:>7.1} µm",
                        at.0, value.0
                    );
                    ui.monospace(text);
                }
            });
    }
}

/// The range of the axis, first and last slide travel, that the points of a proposed table
/// cover.
fn table_range(
    axis: Axis,
    parameters: &ControlParameters,
    changes: &[ParameterChange],
) -> (SlideTravel, SlideTravel) {
    let interval = gsk_commission::pitch_interval(axis, parameters);
    let interval = interval.unwrap_or(SlideTravel(1.0)).0;
    let origin = f64::from(parameters.pitch_origin(axis));
    let (mut low, mut high) = (-interval, interval);
    for change in changes {
        if let ParameterChange::Pitch { point, .. } = change {
            let at = (f64::from(*point) - origin) * interval;
            (low, high) = (low.min(at - interval), high.max(at));
        }
    }
    (SlideTravel(low), SlideTravel(high))
}
