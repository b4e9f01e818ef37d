//! The sheets of the data view with their drafts: shows, writes and undoes values. The caller
//! owns the values and applies the edits.

use egui::{Button, CentralPanel, ComboBox, Panel, RichText, Role, ScrollArea, Ui, WidgetInfo};
use gsk_commission::UndoList;
use gsk_core::memory::{ParameterGroup, Refusal};
use gsk_messages::{Language, Message, say};
use gsk_project::refusal_message;

use super::super::{bar_frame, side_frame, written};
use super::edit::{Drafts, Edit};
use super::parameters::Parameters;
use super::values::Values;
use super::{FINE, Kind, Page, TYPED, WRONG, tables};
use crate::window::focus;

/// Width of the list of pages, points.
const PAGES: f32 = 180.0;
/// Height of the undo list, points.
const WRITTEN: f32 = 110.0;

/// Where the sheets write values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Into {
    /// Into a control, if the operator has the rights. The sheets show the list of pages.
    Control,
    /// Into a project. Its tree lists the pages.
    Project,
}

/// Values to write together.
pub struct Asked {
    pub edits: Vec<Edit>,
    /// Whether the edits undo earlier ones.
    pub takes_back: bool,
}

/// The sheets of the data view.
pub struct Sheets {
    into: Into,
    page: Page,
    /// The parameter page that was shown last.
    last: Page,
    parameters: Parameters,
    drafts: Drafts,
    /// Whether the operator pressed the write button while a draft was invalid.
    asked_too_early: bool,
    /// Why the last request was refused, and the drafts at that time.
    complaint: Option<(Message, Drafts)>,
    undo: UndoList<Edit, Edit>,
    /// Whether values were written. Drafts that equal the current values are dropped
    /// meanwhile.
    settling: bool,
}

impl Sheets {
    /// Creates the sheets with the page of all parameters.
    pub fn new(into: Into) -> Self {
        Self {
            into,
            page: Page::Numbers(Kind::All),
            last: Page::Numbers(Kind::All),
            parameters: Parameters::default(),
            drafts: Drafts::default(),
            asked_too_early: false,
            complaint: None,
            undo: UndoList::default(),
            settling: false,
        }
    }

    /// Whether typed values are not written yet.
    pub fn has_drafts(&self) -> bool {
        self.drafts.count() > 0
    }

    /// Shows a page. For any parameter page it shows the one that was shown last.
    pub fn turn_to(&mut self, page: Page) {
        let of_parameters = |page| matches!(page, Page::Numbers(_) | Page::Group(_));
        if of_parameters(self.page) {
            self.last = self.page;
        }
        self.page = match of_parameters(page) {
            true => self.last,
            false => page,
        };
    }

    /// Shows why the last request was refused.
    pub fn refuse(&mut self, why: Message, asked: &Asked) {
        self.complaint = Some((why, self.drafts.clone()));
        if !asked.takes_back {
            self.undo.pop();
        }
    }

    /// Draws the sheets and handles their input. Returns the values to write.
    pub fn show(&mut self, ui: &mut Ui, language: Language, values: &Values<'_>) -> Option<Asked> {
        if self.settling {
            self.drafts.settle(values);
            self.settling = self.drafts.count() > 0;
        }
        let bar = Panel::bottom("data state").frame(bar_frame());
        let mut asked = bar.show(ui, |ui| self.bar(ui, language, values)).inner;
        let beside = self.into == Into::Control;
        // The undo button is outside of the scroll area of the pages: it stays visible.
        let mut list = |ui: &mut Ui, sheets: &mut Self| {
            if sheets.undo.entries().is_empty() {
                return;
            }
            Panel::bottom("data written")
                .exact_size(WRITTEN)
                .resizable(false)
                .frame(egui::Frame::new())
                .show(ui, |ui| {
                    ScrollArea::vertical()
                        .id_salt("data written")
                        .auto_shrink([false, false])
                        .stick_to_bottom(true)
                        .show(ui, |ui| {
                            let taken = sheets.written(ui, language, values);
                            asked = taken.or_else(|| asked.take());
                            focus::follow(ui);
                        });
                });
        };
        if beside {
            Panel::left("data pages")
                .exact_size(PAGES)
                .resizable(false)
                .frame(side_frame())
                .show(ui, |ui| {
                    list(ui, self);
                    ScrollArea::vertical()
                        .id_salt("data pages")
                        .auto_shrink([false, false])
                        .show(ui, |ui| {
                            self.pages(ui, language);
                        });
                });
        } else {
            list(ui, self);
        }
        let (drafts, page) = (&mut self.drafts, &mut self.page);
        CentralPanel::default().frame(side_frame()).show(ui, |ui| {
            if !beside && matches!(page, Page::Numbers(_) | Page::Group(_)) {
                choose(ui, language, page);
            }
            match *page {
                Page::Numbers(_) | Page::Group(_) => {
                    self.parameters.show(ui, language, values, *page, drafts);
                }
                Page::Offsets => tables::offsets(ui, language, values, drafts),
                Page::Pitch => tables::pitch(ui, language, values, drafts),
                Page::Variables => tables::variables(ui, language, values, drafts),
            }
        });
        asked
    }

    fn pages(&mut self, ui: &mut Ui, language: Language) {
        let others = [Page::Offsets, Page::Pitch, Page::Variables];
        entries(ui, language, &mut self.page, &others);
    }

    /// Draws the list of written values with the undo button.
    fn written(&mut self, ui: &mut Ui, language: Language, values: &Values<'_>) -> Option<Asked> {
        let taken = written::show(
            ui,
            language,
            &mut self.undo,
            &written::Words {
                label: |edit| edit.message(),
                change: |edit| edit.message(),
                hint: say::commission_write_hint(),
            },
            |edits| refusal(edits, values).is_none(),
        );
        taken.map(|edits| Asked {
            edits,
            takes_back: true,
        })
    }

    /// Draws the bar with the preconditions for writing, the alarms and the buttons.
    fn bar(&mut self, ui: &mut Ui, language: Language, values: &Values<'_>) -> Option<Asked> {
        let edits = self.drafts.edits(values);
        let of_page = match self.page {
            Page::Numbers(_) | Page::Group(_) | Page::Pitch => values.parameters_refused,
            Page::Offsets => values.offsets.refused,
            Page::Variables => values.variables.refused,
        };
        let of_drafts = edits.as_ref().ok().and_then(|it| refusal(it, values));
        let (words, colour) = match (of_drafts.or(of_page), self.into) {
            // Without drafts the reason is drawn in a weak colour.
            (Some(refusal), _) => (
                say::data_cannot_write(refusal_message(refusal)),
                match self.drafts.count() {
                    0 => ui.visuals().weak_text_color(),
                    _ => TYPED,
                },
            ),
            (None, Into::Control) => (say::data_can_write(), FINE),
            (None, Into::Project) => (say::data_into_project(), FINE),
        };
        ui.label(RichText::new(words.text(language)).color(colour));
        // An error disappears with the drafts that it is about.
        self.asked_too_early &= edits.is_err();
        self.complaint.take_if(|(_, drafts)| *drafts != self.drafts);
        let wrong = edits.as_ref().err().filter(|_| self.asked_too_early);
        if let Some(said) = wrong.or(self.complaint.as_ref().map(|(why, _)| why)) {
            ui.label(RichText::new(said.text(language)).color(WRONG));
        }
        if !values.alarms.is_empty() {
            ui.label(RichText::new(values.alarms.join("   ")).color(WRONG));
        }
        let buttons = ui.horizontal_wrapped(|ui| {
            let count = self.drafts.count();
            let write = Button::new(say::commission_write(count).text(language));
            let write = ui.add_enabled(count > 0 && of_drafts.is_none(), write);
            let hint = match self.into {
                Into::Control => say::commission_write_hint(),
                Into::Project => say::data_into_project(),
            };
            let hint = hint.text(language);
            let write = write
                .on_hover_text(hint.as_str())
                .on_disabled_hover_text(hint);
            let discard = Button::new(say::data_discard().text(language));
            let discard = ui.add_enabled(count > 0, discard);
            if count > 0 {
                let words = say::data_unwritten(count).text(language);
                ui.label(RichText::new(words).color(TYPED));
            }
            if discard.clicked() {
                self.drafts.discard();
            } else if write.clicked() {
                return self.write(edits, values);
            }
            None
        });
        buttons.inner
    }

    fn write(&mut self, edits: Result<Vec<Edit>, Message>, values: &Values<'_>) -> Option<Asked> {
        let Ok(mut edits) = edits else {
            self.asked_too_early = true;
            return None;
        };
        self.complaint = None;
        self.drafts.counted(&edits, values);
        edits.retain(|edit| edit.now(values) != *edit);
        self.settling = true;
        let first = edits.first()?;
        let before = edits.iter().map(|edit| edit.now(values)).collect();
        self.undo.record(*first, before, &edits);
        Some(Asked {
            edits,
            takes_back: false,
        })
    }
}

/// Draws the pages of parameters as a drop-down list, where the list of pages is missing.
fn choose(ui: &mut Ui, language: Language, page: &mut Page) {
    let words = page.name().text(language);
    let shown = ComboBox::from_id_salt("data page")
        .width(ui.available_width().min(PAGES * 2.0))
        .height(ui.available_height())
        .selected_text(words.as_str())
        .show_ui(ui, |ui| {
            if entries(ui, language, page, &[]) {
                ui.close();
            }
        });
    let name = say::data_all_parameters().text(language);
    shown.response.widget_info(|| WidgetInfo {
        current_text_value: Some(words.clone()),
        ..WidgetInfo::labeled(Role::ComboBox, true, &name)
    });
}

/// Draws the parameter pages and `others` as a list. Returns whether Enter was pressed on an
/// entry.
fn entries(ui: &mut Ui, language: Language, page: &mut Page, others: &[Page]) -> bool {
    let numbers = Kind::ALL.into_iter().map(Page::Numbers);
    let groups = ParameterGroup::ALL.into_iter().map(Page::Group);
    let pages = numbers.chain(groups).chain(others.iter().copied());
    let pages: Vec<Page> = pages.collect();
    let chosen = pages.iter().position(|own| own == page);
    let name = say::window_view_data().text(language);
    let list = focus::List::begin(ui, "pages", &name, pages.len(), chosen);
    if let Some(own) = list.moved().and_then(|at| pages.get(at)) {
        *page = *own;
    }
    for (at, own) in pages.iter().enumerate() {
        match at {
            0 => {
                ui.weak(say::data_by_number().text(language));
            }
            at if at == Kind::ALL.len() => {
                ui.add_space(4.0);
                ui.weak(say::data_by_function().text(language));
            }
            at if at == pages.len() - others.len() => {
                ui.separator();
            }
            _ => {}
        }
        let name = own.name().text(language);
        let is_chosen = page == own;
        let entry = Button::selectable(is_chosen, name.as_str()).wrap();
        let entry = ui.add(entry.sense(focus::ROW));
        entry.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, is_chosen, &name));
        if list.row(ui, at, &entry) {
            *page = *own;
        }
    }
    list.entered().is_some()
}

/// Why not all edits would be accepted now.
fn refusal(edits: &[Edit], values: &Values<'_>) -> Option<Refusal> {
    edits.iter().find_map(|edit| edit.refused(values))
}
