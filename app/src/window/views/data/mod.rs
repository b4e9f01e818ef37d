//! The data of the control at a PC, as GSKCC edits them (manual V-3): parameters by number
//! and by function, tool offsets, pitch errors, macro variables. What is typed is written together, as
//! the control lets it, and taken back by an undo list (decision DATA-2).

mod edit;
mod field;
mod parameters;
mod tables;

use std::sync::Arc;

use egui::{Button, CentralPanel, Color32, Panel, RichText, ScrollArea, Ui};
use gsk_commission::Undo;
use gsk_core::memory::{ParameterGroup, Refusal};
use gsk_messages::{Language, Message, say};
use gsk_project::refused;

use super::written;
use crate::kernel::monitor::MachineView;
use crate::kernel::{Command, Console};
use edit::{Drafts, Edit};
use parameters::Parameters;

/// Width of the list of pages, points.
const PAGES: f32 = 180.0;
/// Height of the list of what was written, points.
const WRITTEN: f32 = 110.0;

const WRONG: Color32 = Color32::from_rgb(255, 150, 110);
const FINE: Color32 = Color32::from_rgb(110, 230, 120);
/// What is typed and not written yet.
const TYPED: Color32 = Color32::from_rgb(255, 214, 110);

/// What is edited.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Page {
    /// Parameters by number.
    Numbers(Kind),
    /// Parameters by function.
    Group(ParameterGroup),
    /// Tool offsets.
    Offsets,
    /// The pitch error table.
    Pitch,
    /// Macro variables.
    Variables,
}

/// The kinds of parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    All,
    State,
    Data,
}

impl Kind {
    const ALL: [Self; 3] = [Self::All, Self::State, Self::Data];

    fn name(self) -> Message {
        match self {
            Self::All => say::data_all_parameters(),
            Self::State => say::data_state_parameters(),
            Self::Data => say::data_data_parameters(),
        }
    }
}

/// The view of the control's data.
pub struct DataView {
    console: Console,
    page: Page,
    parameters: Parameters,
    drafts: Drafts,
    /// What was wrong when it was to be written.
    complaint: Option<Message>,
    undo: Undo<Edit, Edit>,
    /// Something was written: what the control has by now is no draft any more.
    settling: bool,
}

impl DataView {
    /// At all parameters.
    pub fn new(console: Console) -> Self {
        Self {
            console,
            page: Page::Numbers(Kind::All),
            parameters: Parameters::default(),
            drafts: Drafts::default(),
            complaint: None,
            undo: Undo::default(),
            settling: false,
        }
    }

    /// Draws the view and takes its input.
    pub fn show(&mut self, ui: &mut Ui, language: Language, machine: Option<&Arc<MachineView>>) {
        let Some(machine) = machine else {
            ui.label(say::commission_waits().text(language));
            return;
        };
        if self.settling {
            self.drafts.settle(machine);
            self.settling = self.drafts.count() > 0;
        }
        Panel::bottom("data state")
            .frame(super::bar_frame())
            .show(ui, |ui| self.bar(ui, language, machine));
        Panel::left("data pages")
            .exact_size(PAGES)
            .resizable(false)
            .frame(super::side_frame())
            .show(ui, |ui| {
                // The button that takes back is never scrolled away.
                if !self.undo.entries().is_empty() {
                    Panel::bottom("data written")
                        .exact_size(WRITTEN)
                        .resizable(false)
                        .frame(egui::Frame::new())
                        .show(ui, |ui| {
                            ScrollArea::vertical()
                                .id_salt("data written")
                                .auto_shrink([false, false])
                                .stick_to_bottom(true)
                                .show(ui, |ui| self.written(ui, language, machine));
                        });
                }
                ScrollArea::vertical()
                    .id_salt("data pages")
                    .auto_shrink([false, false])
                    .show(ui, |ui| self.pages(ui, language));
            });
        let drafts = &mut self.drafts;
        let page = self.page;
        CentralPanel::default()
            .frame(super::side_frame())
            .show(ui, |ui| match page {
                Page::Numbers(_) | Page::Group(_) => {
                    self.parameters.show(ui, language, machine, page, drafts);
                }
                Page::Offsets => tables::offsets(ui, language, machine, drafts),
                Page::Pitch => tables::pitch(ui, language, machine, drafts),
                Page::Variables => tables::variables(ui, language, machine, drafts),
            });
    }

    fn pages(&mut self, ui: &mut Ui, language: Language) {
        let mut entry = |ui: &mut Ui, page: Page, name: Message| {
            let chosen = self.page == page;
            let button = Button::selectable(chosen, name.text(language)).wrap();
            if ui.add(button).clicked() {
                self.page = page;
            }
        };
        ui.weak(say::data_by_number().text(language));
        for kind in Kind::ALL {
            entry(ui, Page::Numbers(kind), kind.name());
        }
        ui.add_space(4.0);
        ui.weak(say::data_by_function().text(language));
        for group in ParameterGroup::ALL {
            entry(ui, Page::Group(group), group.name());
        }
        ui.separator();
        entry(ui, Page::Offsets, say::data_offsets());
        entry(ui, Page::Pitch, say::data_pitch());
        entry(ui, Page::Variables, say::data_variables());
    }

    /// What was written, and the button that takes the last of it back.
    fn written(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let taken = written::show(
            ui,
            language,
            &mut self.undo,
            &written::Words {
                label: |edit| edit.message(),
                change: |edit| edit.message(),
                hint: say::commission_write_hint(),
            },
            |edits| refusal(edits, machine).is_none(),
        );
        if let Some(before) = taken {
            self.ask(&before);
        }
    }

    fn ask(&self, edits: &[Edit]) {
        let requests = edits.iter().map(|edit| edit.request());
        self.console.send(Command::Write(requests.collect()));
    }

    /// What the page needs, alarms, and the buttons.
    fn bar(&mut self, ui: &mut Ui, language: Language, machine: &MachineView) {
        let edits = self.drafts.edits(machine);
        let of_page = match self.page {
            Page::Numbers(_) | Page::Group(_) | Page::Pitch => machine.parameters_refused,
            Page::Offsets => machine.offsets.refused,
            Page::Variables => machine.variables.refused,
        };
        let of_drafts = edits.as_ref().ok().and_then(|it| refusal(it, machine));
        let (words, colour) = match of_drafts.or(of_page) {
            Some(refusal) => (say::commission_refused(refused(refusal)), WRONG),
            None => (say::data_can_write(), FINE),
        };
        ui.label(RichText::new(words.text(language)).color(colour));
        if let Some(complaint) = &self.complaint {
            ui.label(RichText::new(complaint.text(language)).color(WRONG));
        }
        if !machine.alarms.is_empty() {
            ui.label(RichText::new(machine.alarms.join("   ")).color(WRONG));
        }
        ui.horizontal_wrapped(|ui| {
            let count = self.drafts.count();
            let write = Button::new(say::commission_write(count).text(language));
            let write = ui.add_enabled(count > 0 && of_drafts.is_none(), write);
            let hint = say::commission_write_hint().text(language);
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
                self.complaint = None;
            } else if write.clicked() {
                self.write(edits, machine);
            }
        });
    }

    fn write(&mut self, edits: Result<Vec<Edit>, Message>, machine: &MachineView) {
        let mut edits = match edits {
            Ok(edits) => edits,
            Err(said) => {
                self.complaint = Some(said);
                return;
            }
        };
        self.complaint = None;
        self.drafts.counted(&edits, machine);
        edits.retain(|edit| edit.now(machine) != *edit);
        if let Some(first) = edits.first() {
            let before = edits.iter().map(|edit| edit.now(machine)).collect();
            self.undo.note(*first, before, &edits);
            self.ask(&edits);
        }
        self.settling = true;
    }
}

/// Why the control would not take all of them now.
fn refusal(edits: &[Edit], machine: &MachineView) -> Option<Refusal> {
    edits.iter().find_map(|edit| edit.refused(machine))
}
