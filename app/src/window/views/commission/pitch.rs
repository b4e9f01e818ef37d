//! The step for pitch errors: reads a measurement file, proposes a table for it, and compares
//! it with the current one.

use std::path::Path;

use crossbeam::channel::{Receiver, bounded};
use egui::{ScrollArea, Ui};
use gsk_commission::{
    DeviationCurve, ImportedFile, ParameterChange, PitchPlanOptions, SlideTravel,
    compute_correction,
};
use gsk_core::memory::{Parameters, PitchTable};
use gsk_core::units::Axis;
use gsk_messages::{Language, Message, say};

use super::fields::{Fields, optional};
use super::graph::{self, Curves};
use crate::kernel::Console;
use crate::pitch::{Found, found, read_file};
use crate::window::files::{self, Wanted};

/// Count of intervals of the drawn corrections.
const DRAWN: i32 = 600;
/// Height of the list of points, points.
const LIST: f32 = 150.0;

/// Extensions of measurement files.
const ENDINGS: [&str; 4] = ["csv", "ren", "rtl", "txt"];

/// A file that was read: its name and content.
#[derive(Clone, Debug)]
struct Measured {
    name: String,
    imported: ImportedFile,
}

/// The file and the result of the step.
#[derive(Default)]
pub struct PitchStep {
    reading: Option<Receiver<Measured>>,
    read: Option<Measured>,
    curves: Curves,
    said: Vec<Message>,
}

impl PitchStep {
    /// Draws the button and the summary of the file. Returns whether another file has been
    /// read.
    pub fn show(&mut self, ui: &mut Ui, language: Language, console: &Console) -> bool {
        let come = self.reading.as_ref().and_then(|it| it.try_recv().ok());
        let new = come.is_some();
        if new {
            self.read = come;
            self.reading = None;
        }
        if ui
            .button(say::commission_open_file().text(language))
            .clicked()
        {
            self.choose(ui, language, console);
        }
        if let Some(measured) = &self.read {
            let name = &measured.name;
            let words = match &measured.imported {
                ImportedFile::Measured(it) => {
                    say::commission_file_read(name, it.readings.len(), it.runs())
                }
                ImportedFile::Table(table) => say::commission_file_table(name, table.rows.len()),
            };
            ui.label(words.text(language));
        }
        new
    }

    fn choose(&mut self, ui: &Ui, language: Language, console: &Console) {
        let (deliver, reading) = bounded(1);
        self.reading = Some(reading);
        let kind = say::commission_open_file().text(language);
        let wanted = Wanted::Open(kind, ENDINGS.to_vec());
        files::choose(ui.ctx(), language, &console.say, wanted, move |path| {
            match read_file(&path) {
                Ok(imported) => {
                    let name = path.file_name().map(Path::new);
                    let name = name.unwrap_or(&path).display().to_string();
                    // A closed window shows nothing.
                    let _ = deliver.send(Measured { name, imported });
                    None
                }
                Err(said) => Some(said),
            }
        });
    }

    /// Computes the proposal for the current parameters; `None` without a file.
    pub fn propose(
        &mut self,
        axis: Axis,
        fields: &Fields,
        own: (&Parameters, &PitchTable),
    ) -> Result<Option<Found>, Message> {
        self.said.clear();
        let Some(measured) = &self.read else {
            return Ok(None);
        };
        let wish = PitchPlanOptions {
            interval: optional(&fields.interval)?.map(SlideTravel),
            clear: fields.clear,
        };
        let imported = measured.imported.clone();
        let found = found(imported, axis, wish, fields.diameters, own)?;
        let (mut then, mut table) = (own.0.clone(), own.1.clone());
        for change in &found.proposal().changes {
            change.apply(&mut then, &mut table)?;
        }
        let measured = match &found {
            Found::Measured(_, fit, plan) => {
                let play = match fit.backlash {
                    Some(play) => say::commission_play(play.0),
                    None => say::commission_play_unknown(),
                };
                self.said = vec![
                    say::commission_fit(fit.residual.1.0, fit.slope_um_per_m, play),
                    say::commission_plan(plan.before.0, plan.after.0, plan.interval.0),
                ];
                fit.curve.clone()
            }
            Found::Table(_) => DeviationCurve::default(),
        };
        let (first, last) = match &found {
            Found::Measured(_, fit, _) => fit.curve.range(),
            Found::Table(_) => reach(axis, &then, &found.proposal().changes),
        };
        let step = (last.0 - first.0) / f64::from(DRAWN);
        let positions = || (0..=DRAWN).map(|index| SlideTravel(first.0 + step * f64::from(index)));
        self.curves = Curves {
            old: compute_correction(axis, own.0, own.1, positions()),
            measured,
            new: compute_correction(axis, &then, &table, positions()),
        };
        Ok(Some(found))
    }

    /// Draws the graph, and the corrections at the targets as a list.
    pub fn result(&self, ui: &mut Ui, language: Language) {
        for said in &self.said {
            ui.label(said.text(language));
        }
        graph::show(ui, language, &self.curves);
        let rows = self.curves.measured.points();
        if rows.is_empty() {
            return;
        }
        let height = ui.spacing().interact_size.y;
        ScrollArea::vertical()
            .id_salt("pitch targets")
            .max_height(LIST)
            .show_rows(ui, height, rows.len(), |ui, shown| {
                for (at, value) in rows.get(shown).unwrap_or_default() {
                    let (old, new) = (self.curves.old.at(*at).0, self.curves.new.at(*at).0);
                    let words = format!(
                        "{:>10.3} mm  {:>7.1}  {old:>7.1} → {new:>7.1} µm",
                        at.0, value.0
                    );
                    ui.monospace(words);
                }
            });
    }
}

/// The range of the axis that the points of a table cover.
fn reach(
    axis: Axis,
    parameters: &Parameters,
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
