//! The sheets of the data view with their drafts: shows, writes and undoes values. The caller
//! owns the values and applies the edits.

use egui::{Button, CentralPanel, ComboBox, Panel, RichText, Role, ScrollArea, Ui, WidgetInfo};
use gsk_commission::UndoList;
use gsk_core::memory::{ParameterGroup, WriteRefusal};
use gsk_messages::{Language, Message, say};
use gsk_project::refusal_message;

use super::super::{bar_frame, side_frame, undo_panel};
use super::data_values::DataValues;
use super::edit::{DataEdit, Drafts};
use super::parameters::ParameterSheet;
use super::{DataPage, ParameterKind, tables};
use crate::focus;
use crate::theme;
use crate::widgets::alarm_text;

/// Width of the list of pages, points.
const PAGE_LIST_WIDTH: f32 = 180.0;
/// Height of the undo list, points.
const UNDO_LIST_HEIGHT: f32 = 110.0;

/// The target into which the pages write values: the control or a project.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WriteTarget {
    /// The pages write into a control, if the operator has the rights. They draw the list of pages.
    Control,
    /// The pages write into an open project. They draw no list of pages, because the project's tree
    /// lists them.
    Project,
}

/// Values that the operator requests to write in one step.
pub struct WriteRequest {
    pub edits: Vec<DataEdit>,
    /// Whether the edits undo values that were written earlier.
    pub is_undo: bool,
}

/// The pages of the data view with their typed texts.
pub struct DataSheets {
    target: WriteTarget,
    page: DataPage,
    /// The parameter page that was selected last.
    last_parameter_page: DataPage,
    parameters: ParameterSheet,
    drafts: Drafts,
    /// Whether the operator pressed the write button while a typed text was invalid.
    shows_draft_error: bool,
    /// The reason why the last request was refused, with the typed texts at that time; `None`
    /// without a refusal.
    refusal: Option<(Message, Drafts)>,
    undo: UndoList<DataEdit, DataEdit>,
    /// Whether values were written, so that typed texts that equal the current values are
    /// dropped.
    drops_written: bool,
}

impl DataSheets {
    /// Creates the data pages, showing that of all parameters.
    pub fn new(target: WriteTarget) -> Self {
        Self {
            target,
            page: DataPage::Numbers(ParameterKind::All),
            last_parameter_page: DataPage::Numbers(ParameterKind::All),
            parameters: ParameterSheet::default(),
            drafts: Drafts::default(),
            shows_draft_error: false,
            refusal: None,
            undo: UndoList::default(),
            drops_written: false,
        }
    }

    /// Whether any typed value is not written yet.
    pub fn has_drafts(&self) -> bool {
        self.drafts.count() > 0
    }

    /// Selects a page. For any parameter page, selects the one that was shown last.
    pub fn show_page(&mut self, page: DataPage) {
        let is_parameter_page = |page| matches!(page, DataPage::Numbers(_) | DataPage::Group(_));
        if is_parameter_page(self.page) {
            self.last_parameter_page = self.page;
        }
        self.page = match is_parameter_page(page) {
            true => self.last_parameter_page,
            false => page,
        };
    }

    /// Shows the reason why the last request to write was refused.
    pub fn show_refusal(&mut self, reason: Message, request: &WriteRequest) {
        self.refusal = Some((reason, self.drafts.clone()));
        if !request.is_undo {
            self.undo.pop();
        }
    }

    /// Draws the selected page and handles its input. Returns the values to write; `None` without
    /// any.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        values: &DataValues<'_>,
    ) -> Option<WriteRequest> {
        if self.drops_written {
            self.drafts.drop_written(values);
            self.drops_written = self.drafts.count() > 0;
        }
        let bar = Panel::bottom("data state").frame(bar_frame());
        let mut request = bar.show(ui, |ui| self.show_bar(ui, language, values)).inner;
        let has_page_list = self.target == WriteTarget::Control;
        // The undo button is outside of the scroll area of the pages: it stays visible.
        let mut list = |ui: &mut Ui, sheets: &mut Self| {
            if sheets.undo.entries().is_empty() {
                return;
            }
            Panel::bottom("data written")
                .exact_size(UNDO_LIST_HEIGHT)
                .resizable(false)
                .frame(egui::Frame::new())
                .show(ui, |ui| {
                    ScrollArea::vertical()
                        .id_salt("data written")
                        .auto_shrink([false, false])
                        .stick_to_bottom(true)
                        .show(ui, |ui| {
                            let undo_request = sheets.show_undo_list(ui, language, values);
                            request = undo_request.or_else(|| request.take());
                            focus::scroll_to_focus(ui);
                        });
                });
        };
        if has_page_list {
            Panel::left("data pages")
                .exact_size(PAGE_LIST_WIDTH)
                .resizable(false)
                .frame(side_frame())
                .show(ui, |ui| {
                    list(ui, self);
                    ScrollArea::vertical()
                        .id_salt("data pages")
                        .auto_shrink([false, false])
                        .show(ui, |ui| {
                            self.show_page_list(ui, language);
                        });
                });
        } else {
            list(ui, self);
        }
        let (drafts, page) = (&mut self.drafts, &mut self.page);
        CentralPanel::default().frame(side_frame()).show(ui, |ui| {
            if !has_page_list && matches!(page, DataPage::Numbers(_) | DataPage::Group(_)) {
                show_page_choice(ui, language, page);
            }
            match *page {
                DataPage::Numbers(_) | DataPage::Group(_) => {
                    self.parameters.show(ui, language, values, *page, drafts);
                }
                DataPage::Offsets => tables::show_offsets(ui, language, values, drafts),
                DataPage::Pitch => tables::show_pitch(ui, language, values, drafts),
                DataPage::Variables => tables::show_variables(ui, language, values, drafts),
            }
        });
        request
    }

    fn show_page_list(&mut self, ui: &mut Ui, language: Language) {
        let others = [DataPage::Offsets, DataPage::Pitch, DataPage::Variables];
        show_page_entries(ui, language, &mut self.page, &others);
    }

    /// Draws the list of written values with the undo button. Returns the values that undo the
    /// last ones when the button is clicked.
    fn show_undo_list(
        &mut self,
        ui: &mut Ui,
        language: Language,
        values: &DataValues<'_>,
    ) -> Option<WriteRequest> {
        let undo_edits = undo_panel::show(
            ui,
            language,
            &mut self.undo,
            &undo_panel::UndoTexts {
                label: |edit| edit.message(),
                change: |edit| edit.message(),
                blocked_hint: say::commission_write_hint(),
            },
            |edits| first_refusal(edits, values).is_none(),
        );
        undo_edits.map(|edits| WriteRequest {
            edits,
            is_undo: true,
        })
    }

    /// Draws the bar with the preconditions for writing, the alarms and the buttons. Returns
    /// the values to write when the button is clicked.
    fn show_bar(
        &mut self,
        ui: &mut Ui,
        language: Language,
        values: &DataValues<'_>,
    ) -> Option<WriteRequest> {
        let edits = self.drafts.parse_edits(values);
        let page_refusal = match self.page {
            DataPage::Numbers(_) | DataPage::Group(_) | DataPage::Pitch => {
                values.parameters_refusal
            }
            DataPage::Offsets => values.offsets.refused,
            DataPage::Variables => values.variables.refused,
        };
        let draft_refusal = edits.as_ref().ok().and_then(|it| first_refusal(it, values));
        let (text, colour) = match (draft_refusal.or(page_refusal), self.target) {
            // Without drafts the reason is drawn in a weak colour.
            (Some(refusal), _) => (
                say::data_cannot_write(refusal_message(refusal)),
                match self.drafts.count() {
                    0 => ui.visuals().weak_text_color(),
                    _ => theme::UNSAVED_TEXT,
                },
            ),
            (None, WriteTarget::Control) => (say::data_can_write(), theme::SUCCESS),
            (None, WriteTarget::Project) => (say::data_into_project(), theme::SUCCESS),
        };
        ui.label(RichText::new(text.text(language)).color(colour));
        // An error disappears with the drafts that it is about.
        self.shows_draft_error &= edits.is_err();
        self.refusal.take_if(|(_, drafts)| *drafts != self.drafts);
        let draft_error = edits.as_ref().err().filter(|_| self.shows_draft_error);
        if let Some(error) = draft_error.or(self.refusal.as_ref().map(|(reason, _)| reason)) {
            ui.label(RichText::new(error.text(language)).color(theme::ERROR_TEXT));
        }
        let alarms = values.alarms.map(|it| alarm_text::joined_row(it, language));
        if let Some(alarms) = alarms.filter(|it| !it.is_empty()) {
            ui.label(RichText::new(alarms).color(theme::ERROR_TEXT));
        }
        let buttons = ui.horizontal_wrapped(|ui| {
            let count = self.drafts.count();
            let write = Button::new(say::commission_write(count).text(language));
            let write = ui.add_enabled(count > 0 && draft_refusal.is_none(), write);
            let hint = match self.target {
                WriteTarget::Control => say::commission_write_hint(),
                WriteTarget::Project => say::data_into_project(),
            };
            let hint = hint.text(language);
            let write = write
                .on_hover_text(hint.as_str())
                .on_disabled_hover_text(hint);
            let discard = Button::new(say::data_discard().text(language));
            let discard = ui.add_enabled(count > 0, discard);
            if count > 0 {
                let label = say::data_unwritten(count).text(language);
                ui.label(RichText::new(label).color(theme::UNSAVED_TEXT));
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

    fn write(
        &mut self,
        edits: Result<Vec<DataEdit>, Message>,
        values: &DataValues<'_>,
    ) -> Option<WriteRequest> {
        let Ok(mut edits) = edits else {
            self.shows_draft_error = true;
            return None;
        };
        self.refusal = None;
        self.drafts.replace_additions(&edits, values);
        edits.retain(|edit| edit.with_current_value(values) != *edit);
        self.drops_written = true;
        let first = edits.first()?;
        let previous = edits
            .iter()
            .map(|edit| edit.with_current_value(values))
            .collect();
        self.undo.record(*first, previous, &edits);
        Some(WriteRequest {
            edits,
            is_undo: false,
        })
    }
}

/// Draws the parameter pages as a drop-down list, for use without the list of pages.
fn show_page_choice(ui: &mut Ui, language: Language, page: &mut DataPage) {
    let selected_label = page.name().text(language);
    let list = ComboBox::from_id_salt("data page")
        .width(ui.available_width().min(PAGE_LIST_WIDTH * 2.0))
        .height(ui.available_height())
        .selected_text(selected_label.as_str())
        .show_ui(ui, |ui| {
            if show_page_entries(ui, language, page, &[]) {
                ui.close();
            }
        });
    let name = say::data_all_parameters().text(language);
    list.response.widget_info(|| WidgetInfo {
        current_text_value: Some(selected_label.clone()),
        ..WidgetInfo::labeled(Role::ComboBox, true, &name)
    });
}

/// Draws the parameter pages and `others` as a list. Returns true if Enter was pressed on an
/// entry.
fn show_page_entries(
    ui: &mut Ui,
    language: Language,
    page: &mut DataPage,
    others: &[DataPage],
) -> bool {
    let numbers = ParameterKind::ALL.into_iter().map(DataPage::Numbers);
    let groups = ParameterGroup::ALL.into_iter().map(DataPage::Group);
    let pages = numbers.chain(groups).chain(others.iter().copied());
    let pages: Vec<DataPage> = pages.collect();
    let selected = pages.iter().position(|own| own == page);
    let name = say::window_view_data().text(language);
    let list = focus::FocusList::begin(ui, "pages", &name, pages.len(), selected);
    if let Some(selected_page) = list.moved_row().and_then(|at| pages.get(at)) {
        *page = *selected_page;
    }
    for (at, entry_page) in pages.iter().enumerate() {
        match at {
            0 => {
                ui.weak(say::data_by_number().text(language));
            }
            at if at == ParameterKind::ALL.len() => {
                ui.add_space(4.0);
                ui.weak(say::data_by_function().text(language));
            }
            at if at == pages.len() - others.len() => {
                ui.separator();
            }
            _ => {}
        }
        let name = entry_page.name().text(language);
        let is_chosen = page == entry_page;
        let entry = Button::selectable(is_chosen, name.as_str()).wrap();
        let entry = ui.add(entry.sense(focus::ROW_SENSE));
        entry.widget_info(|| WidgetInfo::selected(Role::ListBoxOption, true, is_chosen, &name));
        if list.show_cursor(ui, at, &entry) {
            *page = *entry_page;
        }
    }
    list.entered_row().is_some()
}

/// Returns the first reason why the control would refuse one of the edits now; `None` if it
/// would accept all.
fn first_refusal(edits: &[DataEdit], values: &DataValues<'_>) -> Option<WriteRefusal> {
    edits.iter().find_map(|edit| edit.refusal(values))
}
