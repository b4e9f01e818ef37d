//! The form pane in the program view: cards, fields, the part that the form cuts, its text.

mod cards;
mod drawing;
mod fields;
mod keypad;
mod outline_picture;
mod outline_table;
mod preview;
mod proposals;

use std::collections::BTreeMap;

use egui::{Button, Panel, Rect, RichText, ScrollArea, Sense, Ui, WidgetInfo, vec2};
use gsk_forms::{
    DrawnOutline, FormError, FormKind, FormSection, FormValues, drawn_outline, find_sections,
    free_sequence_number, write_form,
};
use gsk_host::kernel::Console;
use gsk_messages::{Language, Message, say};

use crate::focus;
use crate::theme;
use crate::views::{bar_frame, side_frame};
use drawing::{ContourDrawing, ReadOutline};
use fields::FieldDrafts;
use preview::{FormPreview, FormPreviewer, PreviewOrder};

/// Least width at which the fields are beside the picture, points.
const WIDE: f32 = 620.0;
/// Width of the fields, points.
const FIELDS_WIDTH: f32 = 345.0;
/// Width of the fields of a contour with its table, points.
const CONTOUR_WIDTH: f32 = 440.0;
/// Height of the picture above the fields in a narrow pane, points.
const NARROW_PICTURE_HEIGHT: f32 = 190.0;
/// Least width at which outline and part are side by side, points.
const PICTURES_WIDTH: f32 = 640.0;
/// Space between stock and outline when a drawing is read, mm of the diameter.
const STOCK_ALLOWANCE_MM: f64 = 2.0;
/// Height below which the forms are a list that opens and the picture scrolls, points.
const LOW: f32 = 430.0;
/// Share of the height that the picture has beside the fields.
const PICTURE_SHARE: f32 = 0.58;

/// What the user requests of the program view.
pub enum FormRequest {
    /// Insert this section at the cursor.
    Insert(String),
    /// Make a new program of this section.
    NewProgram(String),
    /// Replace the section `old` by `new`.
    Replace { old: String, new: String },
}

/// The section from which the form was opened.
struct OpenedSection {
    text: String,
    is_edited: bool,
}

/// The pane, open or closed.
pub struct FormPane {
    previewer: FormPreviewer,
    is_open: bool,
    values: FormValues,
    /// The values of the other forms, kept while one is shown.
    kept: BTreeMap<FormKind, FormValues>,
    drafts: FieldDrafts,
    /// The drawing from which the contour is read.
    drawing: ContourDrawing,
    /// The outline of the values, as it is drawn.
    outline: DrawnOutline,
    shows_keys: bool,
    /// The text of the form, or why there is none.
    written: Result<String, FormError>,
    /// Incremented by each change.
    revision: u64,
    /// The revision and the language that were sent to the thread last.
    ordered: Option<(u64, Language)>,
    preview: Option<FormPreview>,
    opened: Option<OpenedSection>,
    /// Whether the question is shown before blocks that were changed by hand are replaced.
    asks_to_replace: bool,
    /// Why the last request could not be carried out; `None` if it could.
    notice: Option<Message>,
    /// The first sequence number that is free in the program.
    free_number: u16,
}

impl FormPane {
    /// Creates a closed pane.
    pub fn new(console: &Console) -> Self {
        let values = FormValues::new(FormKind::Turn);
        Self {
            previewer: FormPreviewer::new(console),
            is_open: false,
            written: write_form(&values),
            drafts: FieldDrafts::new(&values),
            drawing: ContourDrawing::new(console),
            outline: drawn_outline(&values),
            shows_keys: false,
            values,
            kept: BTreeMap::new(),
            revision: 1,
            ordered: None,
            preview: None,
            opened: None,
            asks_to_replace: false,
            notice: None,
            free_number: 100,
        }
    }

    /// Whether the pane is open.
    pub const fn is_open(&self) -> bool {
        self.is_open
    }

    /// Opens the pane for a new section of the program `text`, with the last values.
    pub fn open_new(&mut self, text: &str) {
        self.opened = None;
        self.free_number = free_sequence_number(text);
        self.show_values(self.values.clone());
        self.drafts.focuses_first = true;
    }

    /// Opens the form of a section in the program `text`.
    ///
    /// # Errors
    /// The values of the section cannot be read.
    pub fn open_section(&mut self, text: &str, section: &FormSection) -> Result<(), FormError> {
        let values = section.values.clone()?.without_defaults();
        let lines: Vec<&str> = text.lines().collect();
        let lines = lines.get(section.lines.clone()).unwrap_or_default();
        let mut own = lines.join("\n");
        own.push('\n');
        self.free_number = free_sequence_number(&text.replace(&own, ""));
        self.opened = Some(OpenedSection {
            text: own,
            is_edited: section.is_edited,
        });
        self.show_values(values);
        self.drafts.focuses_first = true;
        Ok(())
    }

    fn show_values(&mut self, values: FormValues) {
        self.is_open = true;
        self.asks_to_replace = false;
        self.kept.insert(self.values.form(), self.values.clone());
        self.values = values;
        if self.opened.is_none() && self.values.field("N").is_ok() {
            // A number below the limit of the field is always accepted.
            let _ = self.values.set_text("N", &self.free_number.to_string());
        }
        self.drafts = FieldDrafts::new(&self.values);
        self.rewrite();
    }

    /// Shows why a request could not be carried out.
    pub fn report(&mut self, notice: Message) {
        self.notice = Some(notice);
    }

    fn rewrite(&mut self) {
        self.notice = None;
        self.revision += 1;
        self.written = match self.drafts.first_error() {
            Some(error) => Err(error.clone()),
            None => write_form(&self.values),
        };
        self.outline = drawn_outline(&self.values);
    }

    /// Fills the points of the contour with the outline of a drawing.
    fn use_outline(&mut self, read: &ReadOutline) {
        let stock = (read.largest_diameter + STOCK_ALLOWANCE_MM - 1e-6).ceil();
        let undercuts = if read.has_undercut { "YES" } else { "NO" };
        for (id, text) in [
            ("SIDE", "OUT".to_owned()),
            ("POINTS", read.outline.to_string()),
            ("UNDER", undercuts.to_owned()),
            ("STOCK", format!("{stock}")),
        ] {
            if let Err(error) = self.values.set_text(id, &text) {
                self.notice = Some(error.message());
                return;
            }
        }
        self.drafts = FieldDrafts::new(&self.values);
        self.asks_to_replace = false;
        self.rewrite();
    }

    /// Closes the pane.
    pub fn close(&mut self) {
        self.is_open = false;
    }

    /// Draws the open pane and returns the user's request; `None` without one.
    pub fn show(&mut self, ui: &mut Ui, language: Language) -> Option<FormRequest> {
        if let Some(preview) = self.previewer.take_result() {
            self.preview = Some(preview);
        }
        keypad::begin_frame(ui);
        let is_low = ui.available_height() < LOW;
        let mut chosen = None;
        Panel::top("form cards").frame(bar_frame()).show(ui, |ui| {
            let form = self.values.form();
            chosen = match is_low {
                true => cards::show_choice(ui, form, language),
                false => cards::show_cards(ui, form, language),
            };
        });
        if let Some(form) = chosen {
            let kept = self.kept.get(&form).cloned();
            self.show_values(kept.unwrap_or_else(|| FormValues::new(form)));
        }
        let mut request = None;
        Panel::bottom("form buttons")
            .frame(bar_frame())
            .show(ui, |ui| {
                request = self.show_buttons(ui, language);
                if self.shows_keys {
                    keypad::show_keys(ui, language);
                }
            });
        let is_contour = self.values.form() == FormKind::Contour;
        let (id, width) = match is_contour {
            true => ("contour fields", CONTOUR_WIDTH),
            false => ("form fields", FIELDS_WIDTH),
        };
        if ui.available_width() >= WIDE + width - FIELDS_WIDTH {
            focus::skip_resize_edge(ui, id);
            Panel::left(id)
                .frame(side_frame())
                .resizable(true)
                .default_size(width)
                .min_size(width)
                .show(ui, |ui| {
                    let area = ScrollArea::vertical().auto_shrink([false, false]);
                    area.show(ui, |ui| self.show_fields(ui, language));
                });
            egui::CentralPanel::default()
                .frame(side_frame())
                .show(ui, |ui| {
                    let height = ui.available_height() * PICTURE_SHARE;
                    self.show_picture(ui, height, language);
                    self.show_state(ui, language);
                    let area = ScrollArea::both().auto_shrink([false, false]);
                    area.show(ui, |ui| self.show_text(ui));
                });
        } else {
            egui::CentralPanel::default()
                .frame(side_frame())
                .show(ui, |ui| {
                    // A contour has two pictures.
                    let height = NARROW_PICTURE_HEIGHT * if is_contour { 1.5 } else { 1.0 };
                    let picture = (height, language);
                    if !is_low {
                        self.show_picture(ui, picture.0, picture.1);
                    }
                    self.show_state(ui, language);
                    let area = ScrollArea::vertical().auto_shrink([false, false]);
                    area.show(ui, |ui| {
                        if is_low {
                            self.show_picture(ui, picture.0, picture.1);
                        }
                        self.show_fields(ui, language);
                        ui.separator();
                        self.show_text(ui);
                    });
                });
        }
        self.order_preview(ui, language);
        request
    }

    fn order_preview(&mut self, ui: &Ui, language: Language) {
        let Ok(section) = &self.written else {
            return;
        };
        if self.ordered == Some((self.revision, language)) {
            return;
        }
        if self
            .ordered
            .is_some_and(|(revision, _)| revision == self.revision)
        {
            // The same text in another language is another order.
            self.revision += 1;
        }
        self.ordered = Some((self.revision, language));
        let order = PreviewOrder {
            revision: self.revision,
            values: self.values.clone(),
            section: section.clone(),
            language,
        };
        self.previewer.request(order, ui.ctx());
    }

    fn show_fields(&mut self, ui: &mut Ui, language: Language) {
        if self.shows_keys {
            ui.spacing_mut().interact_size.y = keypad::TOUCH_HEIGHT;
        }
        ui.label(self.values.form().purpose().text(language));
        if self.values.form() == FormKind::Contour
            && let Some(read) = self.drawing.show(ui, language)
        {
            self.use_outline(&read);
        }
        if self.opened.as_ref().is_some_and(|it| it.is_edited) {
            let text = say::form_edited_hint().text(language);
            ui.label(RichText::new(text).color(theme::WARNING));
        }
        ui.add_space(4.0);
        let broken = self.written.as_ref().err().cloned();
        let drafts = &mut self.drafts;
        if drafts.show(ui, &mut self.values, broken.as_ref(), language) {
            self.asks_to_replace = false;
            self.rewrite();
        }
        self.show_proposals(ui, language);
        self.show_tools(ui, language);
    }

    /// Draws the last part that could be cut, and the outline of a contour beside or above it.
    fn show_picture(&mut self, ui: &mut Ui, height: f32, language: Language) {
        let size = vec2(ui.available_width(), height.max(60.0));
        let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
        let name = say::form_picture_name().text(language);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
        ui.painter().rect_filled(rect, 0.0, theme::DRAWING_GROUND);
        let part = match self.values.form() {
            FormKind::Contour => {
                let (outline, part) = match rect.width() >= PICTURES_WIDTH {
                    true => rect.split_left_right_at_fraction(0.5),
                    false => rect.split_top_bottom_at_fraction(0.5),
                };
                self.draw_outline(ui, outline.shrink(1.0), language);
                part.shrink(1.0)
            }
            _ => rect,
        };
        if let Some(preview) = &mut self.preview {
            let rear = preview.rear;
            preview.picture.draw(ui.painter(), part, rear);
        }
    }

    /// Draws the outline of the points, or a drawing that has faults.
    fn draw_outline(&self, ui: &Ui, rect: Rect, language: Language) {
        let id = ui.scope_id().with("outline picture");
        let response = ui.interact(rect, id, Sense::hover());
        let name = say::form_outline_name().text(language);
        response.widget_info(|| WidgetInfo::labeled(egui::Role::Image, true, &name));
        match self.drawing.faulty_pieces() {
            Some((pieces, marks)) => {
                outline_picture::draw_faults(ui.painter(), rect, &pieces, &marks);
            }
            None => outline_picture::draw_outline(ui.painter(), rect, &self.outline),
        }
    }

    /// Draws the error of the fields, or what the check has found.
    fn show_state(&self, ui: &mut Ui, language: Language) {
        if let Err(error) = &self.written {
            let text = match self.values.field(error.field) {
                Ok(field) => {
                    let name = (field.name)().text(language);
                    say::subject_reason(name, error.rule.clone())
                }
                Err(_) => error.rule.clone(),
            };
            ui.label(RichText::new(text.text(language)).color(theme::ERROR_TEXT));
            return;
        }
        let preview = self.preview.as_ref();
        let Some(preview) = preview.filter(|it| it.revision == self.revision) else {
            ui.weak(say::program_checking().text(language));
            return;
        };
        if preview.findings.is_empty() {
            let seconds = preview.time_s.max(0.0).round() as u64;
            let time = format!("{}:{:02}", seconds / 60, seconds % 60);
            let text = say::form_checked(time).text(language);
            ui.label(RichText::new(text).color(theme::SUCCESS));
        }
        for finding in &preview.findings {
            ui.label(RichText::new(finding).color(theme::CODE_ALARM_TEXT));
        }
    }

    fn show_text(&self, ui: &mut Ui) {
        if let Ok(section) = &self.written {
            let text = RichText::new(section.trim_end()).monospace();
            ui.add(egui::Label::new(text).extend().selectable(true));
        }
    }

    fn show_buttons(&mut self, ui: &mut Ui, language: Language) -> Option<FormRequest> {
        let mut request = None;
        if let Some(notice) = &self.notice {
            ui.label(RichText::new(notice.text(language)).color(theme::ERROR_TEXT));
        }
        if self.asks_to_replace {
            ui.label(say::form_replace_question().text(language));
        }
        ui.horizontal_wrapped(|ui| {
            let section = self.written.clone().ok();
            let can_write = section.is_some();
            let section = section.unwrap_or_default();
            let button = |ui: &mut Ui, name: Message| {
                let button = Button::new(name.text(language));
                ui.add_enabled(can_write, button).clicked()
            };
            if let Some(opened) = &self.opened {
                let name = match self.asks_to_replace {
                    true => say::form_replace_anyway(),
                    false => say::form_replace(),
                };
                if button(ui, name) {
                    match opened.is_edited && !self.asks_to_replace {
                        true => self.asks_to_replace = true,
                        false => {
                            request = Some(FormRequest::Replace {
                                old: opened.text.clone(),
                                new: section.clone(),
                            });
                        }
                    }
                }
            }
            if button(ui, say::form_insert()) {
                request = Some(FormRequest::Insert(section.clone()));
            }
            if button(ui, say::form_new_program()) {
                request = Some(FormRequest::NewProgram(section));
            }
            if ui.button(say::form_close().text(language)).clicked() {
                self.is_open = false;
            }
            let keys = say::form_keypad().text(language);
            ui.toggle_value(&mut self.shows_keys, keys);
        });
        request
    }
}

/// The sections of a text, found again only for another revision.
#[derive(Default)]
pub struct SectionFinder {
    found: Option<(u64, Vec<FormSection>)>,
}

impl SectionFinder {
    /// The section that contains a line, from 0, of the text with this revision.
    pub fn section_at(&mut self, revision: u64, text: &str, line: usize) -> Option<&FormSection> {
        if self
            .found
            .as_ref()
            .is_none_or(|(known, _)| *known != revision)
        {
            self.found = Some((revision, find_sections(text)));
        }
        let (_, sections) = self.found.as_ref()?;
        sections
            .iter()
            .find(|section| section.lines.contains(&line))
    }
}
