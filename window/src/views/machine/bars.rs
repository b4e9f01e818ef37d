//! The tool bar above the picture, and the state lines, findings and clock below it.

use egui::{Color32, Label, RichText, ScrollArea, Ui};
use gsk_core::command::ProgramId;
use gsk_host::kernel::Command;
use gsk_messages::{Language, Message, say};
use gsk_runner::narration::describe_pass;

use super::job::unknown_setting;
use super::path::BlockRef;
use super::xray::{self, TrialAction};
use super::{Instrument, LatheView, ProgramViewRequest, SelectedBlock, to_block_ref, to_pos2};
use crate::focus;
use crate::theme;
use crate::widgets::alarm_text;
use crate::widgets::icons::{self, Icon, IconButton};

/// Maximum height of the list of collisions, points.
const LIST_HEIGHT: f32 = 72.0;

/// An instrument with its icon, its name and the hint for its button.
type InstrumentRow = (Instrument, Icon, fn() -> Message, fn() -> Message);

/// The instruments (path, caliper, …) in the order of their buttons.
const INSTRUMENTS: [InstrumentRow; 4] = [
    (
        Instrument::Path,
        Icon::PATH,
        say::lathe_pick,
        say::lathe_path_hint,
    ),
    (
        Instrument::Caliper,
        Icon::MEASURE,
        say::caliper,
        say::caliper_hint,
    ),
    (
        Instrument::Microscope,
        Icon::COMPARE,
        say::microscope,
        say::microscope_hint,
    ),
    (
        Instrument::Job,
        Icon::TOOLS,
        say::job_view,
        say::job_view_hint,
    ),
];

/// The buttons that have words in place of an icon: the lathe in space, load, overload.
fn word_buttons(language: Language) -> [String; 3] {
    let words = [
        say::window_view_lathe(),
        say::lathe_load(),
        say::lathe_cut_faults(),
    ];
    words.map(|it| it.text(language))
}

impl LatheView {
    pub(super) fn show_toolbar(&mut self, ui: &mut Ui, language: Language) {
        let button = |icon, name: Message, hint: Message, is_selected| IconButton {
            icon,
            name: name.text(language),
            hint: hint.text(language),
            is_selected,
        };
        let solid = self.picture.is_solid;
        let instruments = INSTRUMENTS.iter().map(|(instrument, icon, name, hint)| {
            let is_selected = self.instruments.selected == *instrument;
            button(*icon, name(), hint(), Some(is_selected))
        });
        let groups = [
            vec![
                button(Icon::FIT, say::lathe_fit(), say::lathe_fit_hint(), None),
                button(
                    Icon::FOLLOW,
                    say::lathe_follow(),
                    say::lathe_follow_hint(),
                    Some(self.picture.follows_tool),
                ),
            ],
            vec![
                button(
                    Icon::SECTION,
                    say::lathe_section(),
                    say::lathe_section_hint(),
                    Some(!solid),
                ),
                button(
                    Icon::SOLID,
                    say::lathe_solid(),
                    say::lathe_solid_hint(),
                    Some(solid),
                ),
            ],
            vec![
                button(
                    Icon::STOCK,
                    say::lathe_new_stock(),
                    say::lathe_new_stock_hint(),
                    None,
                ),
                button(
                    Icon::CRASH_STOP,
                    say::lathe_crash_stops(),
                    say::lathe_crash_stops_hint(),
                    Some(self.stops_on_crash),
                ),
            ],
            instruments.collect(),
        ];
        let clicked = ui.horizontal_wrapped(|ui| {
            let width = icons::word_buttons_width(ui, &word_buttons(language));
            let clicked = icons::show_groups(ui, &groups, width);
            // No icon says what they open: without room for the words a menu has them.
            match ui.available_size_before_wrap().x >= width {
                true => self.show_word_buttons(ui, language),
                false => {
                    ui.menu_button("…", |ui| self.show_word_buttons(ui, language));
                }
            }
            clicked
        });
        match clicked.inner {
            Some((0, 0)) => {
                self.fit_picture();
                self.picture.follows_tool = false;
            }
            Some((0, _)) => self.picture.follows_tool = !self.picture.follows_tool,
            Some((1, index)) if solid != (index == 1) => {
                self.picture.is_solid = !solid;
                self.picture.show_whole_part();
            }
            Some((2, 0)) => self.console.send(Command::FreshStock),
            Some((2, _)) => {
                self.stops_on_crash = !self.stops_on_crash;
                self.console.send(Command::CrashStops(self.stops_on_crash));
            }
            Some((3, index)) => {
                if let Some((instrument, ..)) = INSTRUMENTS.get(index) {
                    // The key of the instrument in use puts it away.
                    self.instruments.selected = match self.instruments.selected == *instrument {
                        true => Instrument::Path,
                        false => *instrument,
                    };
                }
            }
            _ => {}
        }
    }

    fn show_word_buttons(&mut self, ui: &mut Ui, language: Language) {
        let [space, load, overload] = word_buttons(language);
        let space = ui.button(space);
        let hint = say::lathe_open_space_hint().text(language);
        self.picture.requests_space |= space.on_hover_text(hint).clicked();
        let load = ui.toggle_value(&mut self.instruments.load.is_shown, load);
        load.on_hover_text(say::lathe_load_hint().text(language));
        let is_on = &mut self.instruments.load.breaks_on_overload;
        let overload = ui.toggle_value(is_on, overload);
        if overload.clicked() {
            self.console.send(Command::Overload(*is_on));
        }
        overload.on_hover_text(say::lathe_cut_faults_hint().text(language));
    }

    /// Draws the row below the picture: pointer position, block, text of the instrument, clock,
    /// guesses about the job, and collisions.
    /// In a low view the block takes the place of the sentence about the job.
    pub(super) fn show_state(&mut self, ui: &mut Ui, is_low: bool, language: Language) {
        self.show_position(ui, is_low, language);
        match self.instruments.selected {
            Instrument::Job | Instrument::Caliper => {}
            Instrument::Path => self.show_xray(ui, language),
            Instrument::Microscope => {
                let partial = self.preview.path.is_partial;
                let clicked = self.instruments.microscope.show_bar(ui, partial, language);
                if let Some(at) = clicked {
                    self.show_enlarged(at);
                }
            }
        }
        let running = self.part.as_ref().and_then(|part| {
            let block = part.block.map(to_block_ref)?;
            Some((block, to_pos2(part.tip)))
        });
        let made = (&self.preview.times, &self.preview.path);
        self.time_bar.show(ui, made, running, language);
        let total_s = self.preview.times.spent().total_s() as f32;
        let elapsed = running.map(|_| self.time_bar.elapsed_share(total_s));
        let load = &mut self.instruments.load;
        load.show_bar(ui, total_s, elapsed, language);
        if !is_low {
            let (words, color) = self.job_message();
            ui.label(RichText::new(words.text(language)).color(color));
        }
        if let Some(trouble) = &self.preview.job_file_error {
            ui.label(RichText::new(trouble.text(language)).color(theme::COLLISION));
        }
        if let Some(alarm) = &self.preview.alarm {
            let alarm = alarm_text::one_line(alarm, language);
            let words = say::lathe_path_ends(alarm).text(language);
            ui.label(RichText::new(words).color(theme::COLLISION));
            if self.preview.fault_block.is_some() {
                let words = say::xray_profile().text(language);
                ui.label(RichText::new(words).color(theme::COLLISION));
            }
        } else if self.preview.path.is_partial {
            let words = say::lathe_path_partial().text(language);
            ui.label(RichText::new(words).color(theme::WARNING));
        }
        self.show_collisions(ui, language);
    }

    /// The sentence about the job of the part, and its colour.
    fn job_message(&self) -> (Message, Color32) {
        match &self.part {
            Some(part) if part.empty_chuck.is_some() && self.preview.is_practice_machine => {
                (say::lathe_chuck_empty(), theme::STATE_TEXT)
            }
            Some(part) if part.empty_chuck.is_some() => {
                (say::lathe_nothing_cut(), theme::STATE_TEXT)
            }
            Some(part) => match &part.job_name {
                _ if unknown_setting::is_unknown(&part.job) => match self.unset_tool_names() {
                    names if names.is_empty() => (say::lathe_tools_set(), theme::STATE_TEXT),
                    names => (say::lathe_tools_unset(names), theme::WARNING),
                },
                _ if self.preview.is_changed_job
                    || self.instruments.job.is_own_change(&part.job) =>
                {
                    (say::lathe_changed(), theme::STATE_TEXT)
                }
                Some(name) => (say::lathe_job(name), theme::STATE_TEXT),
                None if self.preview.is_practice_job => (say::lathe_practice(), theme::STATE_TEXT),
                None if self.preview.is_form_job => (say::job_of_form(), theme::STATE_TEXT),
                None => (say::lathe_guessed(), theme::WARNING),
            },
            None if self.preview.is_practice_job => (say::lathe_no_path(), theme::STATE_TEXT),
            None => (say::window_one_moment(), theme::STATE_TEXT),
        }
    }

    /// The tools of the program whose offset is still 0: `T02 T03`.
    fn unset_tool_names(&self) -> String {
        let tools = self.preview.unset_tools.iter();
        tools
            .map(|tool| format!("T{tool:02}"))
            .collect::<Vec<_>>()
            .join(" ")
    }

    /// Draws the position of the pointer, and the block that is selected or runs. Without one a
    /// low view (`is_low`) has the sentence about the job there.
    fn show_position(&mut self, ui: &mut Ui, is_low: bool, language: Language) {
        ui.horizontal(|ui| {
            let pointer = self.pointer.map_or_else(String::new, |at| {
                say::lathe_pointer(f64::from(at.y) * 2.0, f64::from(at.x)).text(language)
            });
            // A fixed width, so that the label beside it does not move.
            ui.label(RichText::new(format!("{pointer:<24}")).monospace());
            let running = self.part.as_ref().and_then(|part| part.block);
            let chosen = self.selected.as_ref().map(|chosen| chosen.block);
            if let Some(block) = chosen.or(running.map(to_block_ref)) {
                let words = RichText::new(self.describe_block(block)).monospace();
                let words = Label::new(words).truncate().sense(egui::Sense::click());
                let hint = say::lathe_show_text().text(language);
                if ui.add(words).on_hover_text(hint).clicked() {
                    self.program_text.request = Some(self.make_show_request(block, true));
                }
            } else if is_low {
                let (words, color) = self.job_message();
                let words = RichText::new(words.text(language)).color(color);
                ui.add(Label::new(words).truncate());
            }
        });
    }

    /// Draws the reason for the position of the selected cycle pass, and the words of its
    /// cycle.
    fn show_xray(&mut self, ui: &mut Ui, language: Language) {
        let pass = self
            .selected
            .as_ref()
            .and_then(|chosen| chosen.pass.as_ref());
        if let Some(why) = pass.and_then(|pass| pass.explanation.as_ref()) {
            let (sentence, formula) = describe_pass(why, language);
            ui.label(RichText::new(sentence).color(theme::PASS_PATH));
            ui.label(RichText::new(formula).monospace());
        }
        let block = self.selected.as_ref().map(|chosen| chosen.block);
        let trial = self.program_text.trial.as_ref();
        match xray::show(ui, &self.preview.path, block, trial, language) {
            Some(TrialAction::Try(trial)) => self.set_trial(Some(trial)),
            Some(TrialAction::Discard) => self.set_trial(None),
            Some(TrialAction::TakeOver(trial)) => {
                self.program_text.request = Some(ProgramViewRequest::ReplaceText {
                    program: trial.program_id,
                    control_text: trial.control_text.text().to_owned(),
                    new_text: trial.trial_text.text().to_owned(),
                });
            }
            None => {}
        }
    }

    fn show_collisions(&mut self, ui: &mut Ui, language: Language) {
        let findings = self.part.as_ref().map_or(&[][..], |part| &part.findings);
        if findings.is_empty() {
            return;
        }
        let words = say::lathe_collisions(findings.len()).text(language);
        ui.label(RichText::new(words).color(theme::COLLISION));
        let mut clicked = None;
        // A solid scroll bar shows that the list is longer.
        ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
        ScrollArea::vertical()
            .max_height(LIST_HEIGHT)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                let name = say::lathe_collisions(findings.len()).text(language);
                let count = findings.len();
                let list = focus::FocusList::begin(ui, "collisions", &name, count, None);
                // The newest one first.
                for (at, finding) in findings.iter().rev().enumerate() {
                    let collision = &finding.collision;
                    let (x, z) = (collision.tip.diameter().0, collision.tip.z);
                    let block = finding.source.map(to_block_ref);
                    let words = match block {
                        Some(block) => {
                            let block = self.format_block_name(block);
                            say::lathe_collision(block, collision.message(), x, z)
                        }
                        None => say::window_collision(collision.message(), x, z),
                    };
                    let words = RichText::new(words.text(language)).color(theme::COLLISION);
                    let link = focus::link_row(ui, words);
                    if list.show_cursor(ui, at, &link) || list.entered_row() == Some(at) {
                        clicked = Some((block, to_pos2(collision.contact)));
                    }
                }
            });
        if let Some((block, position)) = clicked {
            self.selected = block.map(|block| SelectedBlock { block, pass: None });
            self.show_centred(position);
        }
    }

    /// Moves the newest collision to the centre of the picture, if the part has one.
    pub fn show_newest_collision(&mut self) {
        let findings = self.part.as_ref().map(|part| &part.findings);
        if let Some(finding) = findings.and_then(|findings| findings.last()) {
            self.show_centred(to_pos2(finding.collision.contact));
        }
    }

    fn describe_block(&self, block: BlockRef) -> String {
        let text = self.preview.path.block_text(block).trim();
        format!("{}  {text}", self.format_block_name(block))
    }

    /// Formats program and line of a block, for messages.
    fn format_block_name(&self, block: BlockRef) -> String {
        let line = block.line;
        match block.program {
            ProgramId::Stored(number) => {
                format!("{}:{line}", self.console.naming().name(number))
            }
            ProgramId::External | ProgramId::Mdi | ProgramId::Dnc => line.to_string(),
        }
    }
}
