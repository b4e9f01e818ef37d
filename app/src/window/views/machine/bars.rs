//! The tool bar above the picture, and the state lines, findings and clock below it.

use egui::text::LayoutJob;
use egui::{Color32, Label, RichText, ScrollArea, TextFormat, TextStyle, Ui};
use gsk_core::command::ProgramId;
use gsk_messages::{Language, Message, say};
use gsk_runner::narration::pass_in_words;
use gsk_runner::times::Spending;

use super::path::Block;
use super::xray::{self, Done};
use super::{Chosen, HIT, Instrument, LatheView, Wish, block_of, lines, place};
use crate::kernel::Command;
use crate::window::alarm_line;
use crate::window::focus;

/// Greatest height of the list of collisions, points.
const LIST: f32 = 72.0;
const DOUBTFUL: Color32 = Color32::from_rgb(255, 196, 90);

impl LatheView {
    pub(super) fn toolbar(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal_wrapped(|ui| {
            let button = |ui: &mut Ui, words: Message, hint: Message| {
                let button = ui.button(words.text(language));
                button.on_hover_text(hint.text(language)).clicked()
            };
            if button(ui, say::lathe_fit(), say::lathe_fit_hint()) {
                self.sight.camera = None;
                self.sight.follow = false;
            }
            for (solid, words, hint) in [
                (false, say::lathe_section(), say::lathe_section_hint()),
                (true, say::lathe_solid(), say::lathe_solid_hint()),
            ] {
                let chosen = self.sight.solid == solid;
                let button = ui.selectable_label(chosen, words.text(language));
                if button.on_hover_text(hint.text(language)).clicked() && !chosen {
                    self.sight.solid = solid;
                    self.sight.camera = None;
                }
            }
            ui.checkbox(&mut self.sight.follow, say::lathe_follow().text(language))
                .on_hover_text(say::lathe_follow_hint().text(language));
            ui.separator();
            if button(ui, say::lathe_new_stock(), say::lathe_new_stock_hint()) {
                self.console.send(Command::FreshStock);
            }
            let words = say::lathe_crash_stops().text(language);
            let stops = ui.checkbox(&mut self.crash_stops, words);
            let hint = say::lathe_crash_stops_hint().text(language);
            if stops.on_hover_text(hint).changed() {
                self.console.send(Command::CrashStops(self.crash_stops));
            }
            ui.separator();
            for (instrument, words, hint) in [
                (Instrument::Path, say::lathe_path(), say::lathe_path_hint()),
                (Instrument::Caliper, say::caliper(), say::caliper_hint()),
                (
                    Instrument::Microscope,
                    say::microscope(),
                    say::microscope_hint(),
                ),
                (Instrument::Job, say::job_view(), say::job_view_hint()),
            ] {
                let chosen = self.instruments.in_hand == instrument;
                let button = ui.selectable_label(chosen, words.text(language));
                if button.on_hover_text(hint.text(language)).clicked() {
                    self.instruments.in_hand = instrument;
                }
            }
            ui.separator();
            legend(ui, language);
        });
    }

    /// Draws the pointer's position, the block, the text of the instrument in use, the clock,
    /// what is guessed about the job, and the collisions.
    pub(super) fn state(&mut self, ui: &mut Ui, language: Language) {
        ui.horizontal(|ui| {
            let pointer = self.pointer.map_or_else(String::new, |at| {
                say::lathe_pointer(f64::from(at.y) * 2.0, f64::from(at.x)).text(language)
            });
            // A fixed width, so that the label beside it does not move.
            ui.label(RichText::new(format!("{pointer:<24}")).monospace());
            let running = self.part.as_ref().and_then(|part| part.block);
            let chosen = self.chosen.as_ref().map(|chosen| chosen.block);
            if let Some(block) = chosen.or(running.map(block_of)) {
                let words = RichText::new(self.words_of(block)).monospace();
                let words = Label::new(words).truncate().sense(egui::Sense::click());
                let hint = say::lathe_show_text().text(language);
                if ui.add(words).on_hover_text(hint).clicked() {
                    self.text.wish = Some(self.show_block(block, true));
                }
            }
        });
        match self.instruments.in_hand {
            Instrument::Job => {}
            Instrument::Path => self.xray(ui, language),
            Instrument::Caliper => {
                let said = self.instruments.caliper.words();
                let said = said.iter().map(|words| words.text(language));
                // Always three rows: the picture under the pointer must not move.
                for words in said.chain(std::iter::repeat(String::new())).take(3) {
                    ui.label(RichText::new(words).monospace());
                }
            }
            Instrument::Microscope => {
                let partial = self.made.path.partial;
                let clicked = self.instruments.microscope.bar(ui, partial, language);
                if let Some(at) = clicked {
                    self.look_closely(at);
                }
            }
        }
        let running = self.part.as_ref().and_then(|part| part.block);
        let made = (&self.made.times, &self.made.path);
        self.clock.show(ui, made, running.map(block_of), language);
        let (words, color) = match &self.part {
            Some(part) if part.guessed && self.instruments.job.has_changed(&part.job) => {
                (say::lathe_changed(), Color32::from_gray(160))
            }
            Some(part) if part.guessed && self.made.practice => {
                (say::lathe_practice(), Color32::from_gray(160))
            }
            Some(part) if part.guessed => (say::lathe_guessed(), DOUBTFUL),
            Some(_) => (say::lathe_job(), Color32::from_gray(160)),
            None if self.made.practice => (say::lathe_no_path(), Color32::from_gray(160)),
            None if self.made.serial > 0 => (say::lathe_nothing_cut(), DOUBTFUL),
            None => (say::window_one_moment(), Color32::from_gray(160)),
        };
        ui.label(RichText::new(words.text(language)).color(color));
        if let Some(trouble) = &self.made.trouble {
            ui.label(RichText::new(trouble.text(language)).color(HIT));
        }
        if let Some(alarm) = &self.made.alarm {
            let alarm = alarm_line::short(alarm, language);
            let words = say::lathe_path_ends(alarm).text(language);
            ui.label(RichText::new(words).color(HIT));
            if self.made.fault.is_some() {
                let words = say::xray_profile().text(language);
                ui.label(RichText::new(words).color(HIT));
            }
        } else if self.made.path.partial {
            let words = say::lathe_path_partial().text(language);
            ui.label(RichText::new(words).color(DOUBTFUL));
        }
        self.collisions(ui, language);
    }

    /// Draws why the selected pass is where it is, and the words of its cycle.
    fn xray(&mut self, ui: &mut Ui, language: Language) {
        let pass = self.chosen.as_ref().and_then(|chosen| chosen.pass.as_ref());
        if let Some(why) = pass.and_then(|pass| pass.why.as_ref()) {
            let (said, formula) = pass_in_words(why, language);
            ui.label(RichText::new(said).color(lines::PASS));
            ui.label(RichText::new(formula).monospace());
        }
        let block = self.chosen.as_ref().map(|chosen| chosen.block);
        let trial = self.text.trial.as_ref();
        match xray::show(ui, &self.made.path, block, trial, language) {
            Some(Done::Changed(trial)) => self.try_out(Some(trial)),
            Some(Done::Discard) => self.try_out(None),
            Some(Done::Take(trial)) => {
                self.text.wish = Some(Wish::Take {
                    program: trial.id,
                    own: trial.own.text().to_owned(),
                    text: trial.tried.text().to_owned(),
                });
            }
            None => {}
        }
    }

    fn collisions(&mut self, ui: &mut Ui, language: Language) {
        let findings = self.part.as_ref().map_or(&[][..], |part| &part.findings);
        if findings.is_empty() {
            return;
        }
        let words = say::lathe_collisions(findings.len()).text(language);
        ui.label(RichText::new(words).color(HIT));
        let mut meant = None;
        // A solid scroll bar shows that the list is longer.
        ui.spacing_mut().scroll = egui::style::ScrollStyle::solid();
        ScrollArea::vertical()
            .max_height(LIST)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                let name = say::lathe_collisions(findings.len()).text(language);
                let count = findings.len();
                let list = focus::List::begin(ui, "collisions", &name, count, None);
                // The newest one first.
                for (at, finding) in findings.iter().rev().enumerate() {
                    let collision = &finding.collision;
                    let (x, z) = (collision.tip.diameter().0, collision.tip.z);
                    let block = finding.source.map(block_of);
                    let words = match block {
                        Some(block) => {
                            let block = Self::name_of(block);
                            say::lathe_collision(block, collision.message(), x, z)
                        }
                        None => say::window_collision(collision.message(), x, z),
                    };
                    let words = RichText::new(words.text(language)).color(HIT);
                    let link = focus::link(ui, words);
                    if list.row(ui, at, &link) || list.entered() == Some(at) {
                        meant = Some((block, place(collision.contact)));
                    }
                }
            });
        if let Some((block, at)) = meant {
            self.chosen = block.map(|block| Chosen { block, pass: None });
            self.look_at(at);
        }
    }

    fn words_of(&self, block: Block) -> String {
        let text = self.made.path.text(block).trim();
        format!("{}  {text}", Self::name_of(block))
    }

    /// The program and line of a block.
    fn name_of(block: Block) -> String {
        let line = block.line;
        match block.program {
            ProgramId::Stored(number) => format!("O{number:04}:{line}"),
            ProgramId::External | ProgramId::Mdi | ProgramId::Dnc => line.to_string(),
        }
    }
}

/// Draws the kinds of moves in the colours of the path, in one row.
fn legend(ui: &mut Ui, language: Language) {
    let font_id = TextStyle::Body.resolve(ui.style());
    let mut job = LayoutJob::default();
    for (what, color) in [
        (Spending::Rapid, lines::RAPID),
        (Spending::Feed, lines::FEED),
        (Spending::Thread, lines::THREAD),
    ] {
        let gap = match job.text.is_empty() {
            true => "",
            false => "  ",
        };
        let words = what.words().text(language);
        let format = TextFormat::simple(font_id.clone(), color);
        job.append(&format!("{gap}{words}"), 0.0, format);
    }
    ui.add(Label::new(job).extend());
}
