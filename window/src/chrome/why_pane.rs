//! The pane *Why?*: the chain of causes of an alarm, a wait, a refused key or a typed subject. Each
//! link leads to its rung, key, parameter or signal.

use egui::{Context, Key as PcKey, RichText, ScrollArea, TextEdit, Ui};
use gsk_core::plc::address::{Area, BitAddress};
use gsk_help::{Subject, topic};
use gsk_host::kernel::{Command, Console};
use gsk_messages::{Language, Message, say};
use gsk_panel::keys::{Bit, Key};
use gsk_panel::why::{CauseChain, CauseLink, CauseSubject, CauseTarget};

use crate::Window;
use crate::placement::panel_placement::PlacedArea;
use crate::placement::stop_key_clearance;
use crate::theme;
use crate::view::ViewId;
use crate::widgets::status_message::StatusMessage;

/// Indent of a link below the one that it decides, points.
const INDENT: f32 = 14.0;
const WINDOW_SIZE: [f32; 2] = [460.0, 360.0];

/// The state of the pane *Why?*, which shows chains of causes.
#[derive(Default)]
pub struct WhyPane {
    is_open: bool,
    chain: CauseChain,
    entry: String,
    has_entry_error: bool,
    refused_key: Option<Key>,
    /// The key of the last selected link, which the panel marks.
    pub marked_key: Option<Key>,
}

impl WhyPane {
    /// Stores the key that the kernel has reported as refused.
    pub const fn set_refused_key(&mut self, key: Option<Key>) {
        self.refused_key = key;
    }

    /// Stores a chain of causes that the kernel has computed.
    pub fn take_chain(&mut self, chain: CauseChain) {
        self.chain = chain;
    }

    pub const fn close(&mut self) {
        self.is_open = false;
        self.marked_key = None;
    }

    fn open(&mut self, subject: CauseSubject, console: &Console) {
        self.is_open = true;
        self.entry = subject.to_string();
        self.has_entry_error = false;
        console.send(Command::Explain(subject));
    }

    fn explain_entry(&mut self, console: &Console) {
        let subject = (self.entry.trim().split_once(' '))
            .and_then(|(kind, name)| CauseSubject::parse(kind, name.trim()));
        self.has_entry_error = subject.is_none();
        if let Some(subject) = subject {
            console.send(Command::Explain(subject));
        }
    }

    /// Draws the pane; returns the target of a link that was selected.
    fn show(
        &mut self,
        context: &Context,
        language: Language,
        console: &Console,
        placed: &[PlacedArea],
        crash: Option<&Message>,
    ) -> Option<CauseTarget> {
        if !self.is_open {
            return None;
        }
        // The pane never covers the stop keys of the panel.
        let size = egui::Vec2::from(WINDOW_SIZE);
        let area = stop_key_clearance::best_rect(
            context.content_rect(),
            &stop_key_clearance::stop_key_rects(placed),
            |room| stop_key_clearance::rate_beside_panel(room, size, placed),
        );
        let mut is_open = true;
        let shown = egui::Window::new(say::window_why_title().text(language))
            .id(egui::Id::unique("why"))
            .collapsible(false)
            .default_size(WINDOW_SIZE)
            .default_pos(area.right_top() - egui::vec2(WINDOW_SIZE[0].min(area.width()), 0.0))
            .constrain_to(area)
            .open(&mut is_open)
            .show(context, |ui| {
                self.show_content(ui, language, console, crash)
            });
        if !is_open {
            self.close();
        }
        shown.and_then(|shown| shown.inner).flatten()
    }

    fn show_content(
        &mut self,
        ui: &mut Ui,
        language: Language,
        console: &Console,
        crash: Option<&Message>,
    ) -> Option<CauseTarget> {
        ui.horizontal(|ui| {
            let hint = say::window_why_entry().text(language);
            let field = ui.add(TextEdit::singleline(&mut self.entry).hint_text(&hint));
            let has_enter = field.lost_focus() && ui.input(|it| it.key_pressed(PcKey::Enter));
            let button = ui.button(say::window_why_explain().text(language));
            if button.on_hover_text(hint).clicked() || has_enter {
                self.explain_entry(console);
            }
        });
        if self.has_entry_error {
            let text = say::script_no_why(&self.entry).text(language);
            ui.label(RichText::new(text).color(theme::ALARM_TEXT));
        }
        ui.separator();
        if let Some(crash) = crash {
            // The alarm is its consequence.
            ui.label(RichText::new(crash.text(language)).color(theme::ALARM_TEXT));
            ui.label(say::window_why_crash().text(language));
            ui.separator();
        }
        let mut selected = None;
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            // After a crash the way out is that of the crash.
            let links = self.chain.links().iter();
            for link in links.filter(|link| crash.is_none() || !link.is_remedy) {
                ui.horizontal(|ui| {
                    ui.add_space(INDENT * link.depth as f32);
                    selected = selected.or(show_link(ui, link, language));
                });
            }
        });
        selected
    }
}

fn show_link(ui: &mut Ui, link: &CauseLink, language: Language) -> Option<CauseTarget> {
    let text = link.text(language);
    match link.target {
        Some(target) => ui.link(text).clicked().then_some(target),
        None => {
            ui.label(text);
            None
        }
    }
}

impl Window {
    /// Draws the button *Why?* if a key was refused, an alarm is active or a program waits.
    pub(crate) fn show_why_button(&mut self, ui: &mut Ui) {
        if self.is_in_exam() {
            return;
        }
        let Some(subject) = self.subject_to_explain() else {
            return;
        };
        let language = self.settings.language;
        let button = ui.button(say::window_why().text(language));
        if button
            .on_hover_text(say::window_why_hint().text(language))
            .clicked()
        {
            self.why.open(subject, &self.console);
        }
    }

    /// Opens the pane *Why?* for the Y bit of a lamp; not in an exam.
    pub(crate) fn explain_bit(&mut self, lamp: Bit) {
        self.explain_subject(CauseSubject::Bit(BitAddress::new(
            Area::Y,
            lamp.byte,
            lamp.bit,
        )));
    }

    /// Opens the pane *Why?* for a state; has no effect in an exam.
    pub(crate) fn explain_subject(&mut self, subject: CauseSubject) {
        if !self.is_in_exam() {
            self.why.open(subject, &self.console);
        }
    }

    fn subject_to_explain(&self) -> Option<CauseSubject> {
        let snapshot = self.snapshot.as_ref()?;
        if let Some(alarm) = &snapshot.alarm {
            return Some(CauseSubject::Alarm(alarm.number));
        }
        if matches!(self.message, Some(StatusMessage::KeyRefused(_)))
            && let Some(key) = self.why.refused_key
        {
            return Some(CauseSubject::Key(key));
        }
        let is_waiting = snapshot.program_wait.is_some();
        is_waiting.then_some(CauseSubject::Axis(gsk_core::units::Axis::Z))
    }

    /// Draws the pane *Why?*, and opens the target of a clicked link.
    pub(crate) fn show_why_pane(&mut self, context: &Context) {
        let language = self.settings.language;
        let crash = self.snapshot.as_ref().and_then(|it| it.crash.as_ref());
        match self
            .why
            .show(context, language, &self.console, &self.placed_areas, crash)
        {
            Some(CauseTarget::Key(key)) => self.why.marked_key = Some(key),
            Some(CauseTarget::Rung(rung)) => {
                self.show_view(ViewId::Ladder);
                self.views.ladder().show_rung(rung);
            }
            Some(CauseTarget::Parameter(number)) => {
                self.help.toggle(topic(Subject::Parameter(number)));
            }
            Some(CauseTarget::Bit(bit)) => {
                if let Some(topic) = topic(Subject::Signal(&bit.short_name())) {
                    self.help.toggle(Some(topic));
                }
            }
            None => {}
        }
    }
}
