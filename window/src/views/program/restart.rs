//! Restart at the block of the cursor: plans it in a background thread, shows what it changes,
//! and requests it once the user confirms.

use std::collections::BTreeSet;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{Align2, Context, RichText, ScrollArea, Window};
use gsk_core::cnc::ControlRequest;
use gsk_core::command::ProgramId;
use gsk_core::program::Program;
use gsk_host::kernel::{Command, Console};
use gsk_messages::{Language, Message, say};
use gsk_runner::restart::{self, LineWatcher, RestartPlan};

use super::document::with_line_feeds;
use crate::theme;
use crate::widgets::files::run_in_thread;

/// Size of the list of steps, points.
const LIST_SIZE: [f32; 2] = [460.0, 320.0];

/// The result of planning a restart in a background thread.
type PlanResult = Result<Box<RestartPlan>, Message>;

/// What the restart dialog currently shows.
enum DialogContent {
    /// The restart is being planned: the program runs in a copy of the machine.
    Planning,
    Planned(Box<RestartPlan>),
    Failed(Message),
}

/// The dialog that plans and requests a restart within a program.
pub struct RestartDialog {
    console: Console,
    sender: Sender<PlanResult>,
    receiver: Receiver<PlanResult>,
    /// What the dialog shows; `None` while it is closed.
    content: Option<DialogContent>,
    /// The differences of the plan that the operator has confirmed; real slides need all of them.
    confirmed: BTreeSet<usize>,
    /// Number of plans that were requested and have not arrived.
    pending: u32,
}

impl RestartDialog {
    /// Creates the restart dialog, closed.
    pub fn new(console: Console) -> Self {
        let (sender, receiver) = unbounded();
        Self {
            console,
            sender,
            receiver,
            content: None,
            confirmed: BTreeSet::new(),
            pending: 0,
        }
    }

    /// Opens the dialog for the block in a line, from 1, of the program `text`.
    pub fn open(&mut self, text: String, line: u32, context: &Context) {
        self.content = Some(DialogContent::Planning);
        self.confirmed.clear();
        self.pending += 1;
        let (console, to) = (self.console.clone(), self.sender.clone());
        run_in_thread(context, &self.console.notice_sender, move || {
            // The send fails when the view is gone. No view needs the plan then.
            let _ = to.send(plan(&console, &text, line));
            None
        });
    }

    /// Draws the restart dialog, if it is open.
    pub fn show(&mut self, context: &Context, language: Language) {
        while let Ok(result) = self.receiver.try_recv() {
            self.pending = self.pending.saturating_sub(1);
            if self.pending == 0 && self.content.is_some() {
                self.content = Some(match result {
                    Ok(plan) => DialogContent::Planned(plan),
                    Err(why) => DialogContent::Failed(why),
                });
            }
        }
        let Some(content) = &self.content else {
            return;
        };
        let confirmed = &mut self.confirmed;
        let mut is_confirmed = false;
        let mut is_closed = false;
        Window::new(say::restart_title().text(language))
            .id(egui::Id::unique("restart"))
            .collapsible(false)
            .anchor(Align2::CENTER_CENTER, [0.0, -60.0])
            .show(context, |ui| {
                show_content(ui, content, confirmed, language);
                ui.horizontal(|ui| {
                    let confirm = say::restart_confirm().text(language);
                    if let DialogContent::Planned(plan) = content {
                        let is_complete =
                            !plan.moves_real_slides || confirmed.len() == plan.differences.len();
                        let button = ui.add_enabled(is_complete, egui::Button::new(confirm));
                        let refusal = say::restart_confirm_each().text(language);
                        is_confirmed = button.on_disabled_hover_text(refusal).clicked();
                    }
                    is_closed = ui.button(say::window_cancel().text(language)).clicked();
                });
            });
        if is_confirmed && let Some(DialogContent::Planned(plan)) = self.content.take() {
            let request = ControlRequest::Restart(plan.restart);
            self.console.send(Command::Request(Box::new(request)));
        }
        if is_closed {
            self.content = None;
        }
    }
}

fn show_content(
    ui: &mut egui::Ui,
    content: &DialogContent,
    confirmed: &mut BTreeSet<usize>,
    language: Language,
) {
    let list = ScrollArea::vertical().max_height(LIST_SIZE[1]);
    list.show(ui, |ui| {
        ui.set_min_width(LIST_SIZE[0]);
        match content {
            DialogContent::Planning => show_lines(ui, &[say::restart_planning()], language),
            DialogContent::Failed(why) => show_lines(ui, core::slice::from_ref(why), language),
            DialogContent::Planned(plan) if plan.moves_real_slides => {
                let warning = say::restart_confirm_each().text(language);
                ui.label(RichText::new(warning).color(theme::ALARM_TEXT).strong());
                show_lines(ui, &plan.block_lines(program_name), language);
                for (index, difference) in plan.differences.iter().enumerate() {
                    let mut is_ticked = confirmed.contains(&index);
                    let text = difference.to_message().text(language);
                    if ui.checkbox(&mut is_ticked, text).changed() {
                        match is_ticked {
                            true => confirmed.insert(index),
                            false => confirmed.remove(&index),
                        };
                    }
                }
                show_lines(ui, &plan.way_lines(), language);
            }
            DialogContent::Planned(plan) => show_lines(ui, &plan.lines(program_name), language),
        }
    });
}

fn show_lines(ui: &mut egui::Ui, lines: &[Message], language: Language) {
    for line in lines {
        ui.label(line.text(language));
    }
}

fn program_name(program: ProgramId) -> String {
    match program {
        ProgramId::Stored(number) => format!("O{number:04}"),
        ProgramId::External | ProgramId::Mdi | ProgramId::Dnc => String::new(),
    }
}

/// Plans a restart at a line, with a copy of the machine.
fn plan(console: &Console, text: &str, line: u32) -> PlanResult {
    let copy = console.machine_copy();
    let copy = copy.ok_or_else(say::window_kernel_stopped)?;
    let (simulation, part) = *copy;
    let id = find_program(&simulation, text).ok_or_else(say::program_other_text)?;
    let program = simulation.cnc.programs().get(id);
    let program = program.ok_or_else(say::program_other_text)?;
    let mut watcher = LineWatcher::new(id, program, line);
    let target = restart::find_block(&simulation, None, &mut watcher, None)?;
    restart::plan_restart(&simulation, part.as_ref(), &target).map(Box::new)
}

/// The program of the control that has this text: the selected one, or a subprogram.
fn find_program(simulation: &gsk_core::simulation::Simulation, text: &str) -> Option<ProgramId> {
    let programs = simulation.cnc.programs();
    let has_text = |program: &ProgramId| {
        let stored = programs.get(*program);
        stored.is_some_and(|it| with_line_feeds(it.text()).trim() == text.trim())
    };
    let numbered = Program::new(text).number().map(ProgramId::Stored);
    programs
        .selected()
        .filter(has_text)
        .or_else(|| numbered.filter(has_text))
}
