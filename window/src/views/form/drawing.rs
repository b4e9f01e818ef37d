//! A drawing whose outline fills the points of the contour form: file, layer, unit, zero,
//! faults.

use std::path::Path;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{ComboBox, RichText, Ui};
use gsk_core::units::Point;
use gsk_forms::{TurnedOutline, outline_of_profile};
use gsk_host::files::program_file;
use gsk_host::kernel::{Console, Notice};
use gsk_messages::{Language, Message, say};
use gsk_outline::{
    CutRule, DEFAULT_GAP_MM, Drawing, DrawingFault, DrawingUnit, ProfileOptions, ProfilePiece,
    ProfileZero, TurnedProfile, read_drawing,
};

use crate::theme;
use crate::widgets::files::{FileChoice, choose_file};

/// The units that can be chosen.
const UNITS: [DrawingUnit; 3] = [
    DrawingUnit::Millimetre,
    DrawingUnit::Centimetre,
    DrawingUnit::Inch,
];
/// The distances within which ends can be joined, mm.
const GAPS_MM: [f64; 4] = [DEFAULT_GAP_MM, 0.05, 0.2, 1.0];
/// Width of a choice, points.
const CHOICE_WIDTH: f32 = 130.0;

/// An outline that a drawing gives to the form.
pub struct ReadOutline {
    pub outline: TurnedOutline,
    /// Whether diameters decrease somewhere towards the chuck.
    pub has_undercut: bool,
    pub largest_diameter: f64,
}

/// A drawing file with the choices for it.
struct OpenedDrawing {
    name: String,
    drawing: Drawing,
    options: ProfileOptions,
    found: Result<TurnedProfile, Vec<DrawingFault>>,
}

/// A file as the thread has read it.
struct ReadFile {
    name: String,
    drawing: Result<Drawing, Message>,
}

/// The drawing of the contour form.
pub struct ContourDrawing {
    notices: Sender<Notice>,
    sender: Sender<ReadFile>,
    receiver: Receiver<ReadFile>,
    opened: Option<OpenedDrawing>,
    /// Why the last file could not be read; `None` if it could.
    refusal: Option<Message>,
}

impl ContourDrawing {
    pub fn new(console: &Console) -> Self {
        let (sender, receiver) = unbounded();
        Self {
            notices: console.notice_sender.clone(),
            sender,
            receiver,
            opened: None,
            refusal: None,
        }
    }

    /// Draws the button that opens a file, and the choices of an open drawing. Returns the
    /// outline if another one was found.
    pub fn show(&mut self, ui: &mut Ui, language: Language) -> Option<ReadOutline> {
        let mut is_changed = false;
        while let Ok(file) = self.receiver.try_recv() {
            is_changed |= self.take(file);
        }
        let mut is_closed = false;
        ui.horizontal(|ui| {
            if ui.button(say::form_drawing_open().text(language)).clicked() {
                self.choose(ui, language);
            }
            if let Some(opened) = &self.opened {
                ui.add(egui::Label::new(&opened.name).truncate());
                let close = ui.small_button("✖");
                is_closed = close
                    .on_hover_text(say::form_drawing_close().text(language))
                    .clicked();
            }
        });
        if let Some(refusal) = &self.refusal {
            ui.label(RichText::new(refusal.text(language)).color(theme::ERROR_TEXT));
        }
        if is_closed {
            self.opened = None;
        }
        let opened = self.opened.as_mut()?;
        is_changed |= opened.show_choices(ui, language);
        if is_changed {
            opened.find();
        }
        opened.show_result(ui, language);
        let read = is_changed.then(|| opened.read_outline())??;
        match read {
            Ok(outline) => Some(outline),
            Err(message) => {
                self.refusal = Some(message);
                None
            }
        }
    }

    /// The lines and arcs of an open drawing that has faults, and where these are; `None` if
    /// there is nothing to mend.
    pub fn faulty_pieces(&self) -> Option<(Vec<ProfilePiece>, Vec<Point>)> {
        let opened = self.opened.as_ref()?;
        let faults = opened.found.as_ref().err()?;
        let marks = faults.iter().filter_map(|fault| fault.at).collect();
        Some((opened.drawing.selected_pieces(&opened.options), marks))
    }

    fn choose(&self, ui: &Ui, language: Language) {
        let to = self.sender.clone();
        let kind = say::form_drawing_files().text(language);
        let choice = FileChoice::Open(kind, vec!["dxf", "svg"]);
        choose_file(ui.ctx(), language, &self.notices, choice, move |path| {
            // The send fails when the view is gone. No view needs the drawing then.
            let _ = to.send(read_file(&path));
            None
        });
    }

    /// Opens a file that was read; returns whether it is a drawing.
    fn take(&mut self, file: ReadFile) -> bool {
        match file.drawing {
            Ok(drawing) => {
                self.refusal = None;
                let mut opened = OpenedDrawing {
                    name: file.name,
                    drawing,
                    options: ProfileOptions::default(),
                    found: Err(Vec::new()),
                };
                opened.find();
                self.opened = Some(opened);
                true
            }
            Err(message) => {
                self.opened = None;
                self.refusal = Some(say::subject_reason(file.name, message));
                false
            }
        }
    }
}

fn read_file(path: &Path) -> ReadFile {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let bytes = program_file::read_bytes(path).map_err(|error| error.message());
    ReadFile {
        name: name.into_owned(),
        drawing: bytes.and_then(|bytes| read_drawing(&bytes)),
    }
}

impl OpenedDrawing {
    fn find(&mut self) {
        self.found = self.drawing.find_profile_or_faults(&self.options);
    }

    /// Draws the choices; returns whether one was changed.
    fn show_choices(&mut self, ui: &mut Ui, language: Language) -> bool {
        let before = self.options.clone();
        let options = &mut self.options;
        let layers = self.drawing.layers().iter();
        let layers: Vec<&String> = (layers.filter(|layer| layer.pieces > 0))
            .map(|layer| &layer.name)
            .collect();
        egui::Grid::new("drawing choices")
            .num_columns(2)
            .show(ui, |ui| {
                let all = say::form_drawing_all_layers().text(language);
                let label = ui.label(say::form_drawing_layer().text(language)).id;
                let shown = options.layers.first().unwrap_or(&all).clone();
                let layer = choice(ui, "layer", &shown, |ui| {
                    let is_all = options.layers.is_empty();
                    if ui.selectable_label(is_all, &all).clicked() {
                        options.layers.clear();
                    }
                    for layer in &layers {
                        let is_chosen = options.layers.contains(*layer);
                        if ui.selectable_label(is_chosen, *layer).clicked() {
                            options.layers = vec![(*layer).clone()];
                        }
                    }
                });
                layer.labelled_by(label);
                ui.end_row();

                let label = ui.label(say::form_drawing_unit().text(language)).id;
                let file = say::form_drawing_unit_file().text(language);
                let name = |unit: Option<DrawingUnit>| match unit {
                    Some(unit) => unit.name().to_owned(),
                    None => file.clone(),
                };
                let unit = choice(ui, "unit", &name(options.unit), |ui| {
                    for unit in [None].into_iter().chain(UNITS.map(Some)) {
                        ui.selectable_value(&mut options.unit, unit, name(unit));
                    }
                });
                unit.labelled_by(label);
                ui.end_row();

                let label = ui.label(say::form_drawing_zero().text(language)).id;
                let name = |zero: ProfileZero| match zero {
                    ProfileZero::Left => say::form_drawing_zero_left().text(language),
                    _ => say::form_drawing_zero_right().text(language),
                };
                let zero = choice(ui, "zero", &name(options.zero), |ui| {
                    for zero in [ProfileZero::Right, ProfileZero::Left] {
                        ui.selectable_value(&mut options.zero, zero, name(zero));
                    }
                });
                zero.labelled_by(label);
                ui.end_row();

                let label = ui.label(say::form_drawing_gap().text(language)).id;
                let gap = choice(ui, "gap", &format!("{} mm", options.gap), |ui| {
                    for gap in GAPS_MM {
                        ui.selectable_value(&mut options.gap, gap, format!("{gap} mm"));
                    }
                });
                gap.labelled_by(label);
                ui.end_row();
            });
        self.options != before
    }

    /// Draws what was found, or all faults.
    fn show_result(&self, ui: &mut Ui, language: Language) {
        match &self.found {
            Ok(profile) => {
                let count = profile.pieces().count();
                let text = say::form_drawing_read(count, profile.largest_diameter());
                ui.label(RichText::new(text.text(language)).color(theme::SUCCESS));
                for note in &profile.notes {
                    ui.label(RichText::new(note.text(language)).small().weak());
                }
            }
            Err(faults) => {
                for (index, fault) in faults.iter().enumerate() {
                    let text = format!("{}. {}", index + 1, fault.message.text(language));
                    ui.label(RichText::new(text).color(theme::ERROR_TEXT));
                }
            }
        }
    }

    /// The points of the outline; `None` if the drawing has faults.
    fn read_outline(&self) -> Option<Result<ReadOutline, Message>> {
        let profile = self.found.as_ref().ok()?;
        let pieces: Vec<ProfilePiece> = profile.pieces().copied().collect();
        let read = |outline| ReadOutline {
            outline,
            has_undercut: CutRule::Roughing.find_fault(&pieces).is_some(),
            largest_diameter: profile.largest_diameter(),
        };
        Some(outline_of_profile(profile).map(read))
    }
}

fn choice(ui: &mut Ui, id: &str, shown: &str, add: impl FnOnce(&mut Ui)) -> egui::Response {
    ComboBox::from_id_salt(id)
        .width(CHOICE_WIDTH)
        .selected_text(shown)
        .show_ui(ui, add)
        .response
}
