//! Restart at the block of the cursor: plans it in a background thread, shows what it changes,
//! and requests it once the user confirms.

use std::sync::Arc;

use crossbeam::channel::{Receiver, Sender, unbounded};
use egui::{Align2, Context, RichText, ScrollArea, TextEdit, Ui, Window};
use gsk_core::cnc::ControlRequest;
use gsk_core::command::ProgramId;
use gsk_core::model::ProgramNaming;
use gsk_core::program::Program;
use gsk_core::simulation::Simulation;
use gsk_host::kernel::{Command, Console};
use gsk_messages::{Language, Message, say};
use gsk_runner::machining::live_part::LivePart;
use gsk_runner::restart::{
    self, BlockState, LineWatcher, RestartPlan, RestartWord, RestartWords, StateDifference,
};

use super::document::with_line_feeds;
use crate::theme;
use crate::widgets::files::run_in_thread;

/// Size of the list of steps, points.
const LIST_SIZE: [f32; 2] = [460.0, 320.0];
/// Width of the field for a changed word, points.
const WORD_WIDTH: f32 = 70.0;

/// The machine for which a restart is planned, and the state before the block.
struct PlanBasis {
    now: Simulation,
    part: Option<LivePart>,
    found: BlockState,
}

/// A planned restart, with the words that the operator has changed.
struct PlannedRestart {
    basis: Arc<PlanBasis>,
    words: RestartWords,
    plan: RestartPlan,
}

/// The result of planning a restart in a background thread.
type PlanResult = Result<Box<PlannedRestart>, Message>;

/// What the restart dialog currently shows.
enum DialogContent {
    /// The restart is being planned: the program runs in a copy of the machine.
    Planning,
    Planned(Box<PlannedRestart>),
    Failed(Message),
}

/// The operator's entries in the list of differences.
#[derive(Default)]
struct ListEntries {
    /// The differences that the operator has confirmed; real slides need all of them.
    confirmed: Vec<StateDifference>,
    /// The word whose field is open, and the text in it.
    field: Option<(RestartWord, String)>,
    /// The reason why the last changed word was refused; `None` if it was taken.
    refusal: Option<Message>,
}

/// The change of a word that the operator has requested.
enum WordChange {
    /// Another word: `S800`.
    Set(String),
    /// The word of the program again.
    Remove(RestartWord),
}

/// The dialog that plans and requests a restart within a program.
pub struct RestartDialog {
    console: Console,
    sender: Sender<PlanResult>,
    receiver: Receiver<PlanResult>,
    /// What the dialog shows; `None` while it is closed.
    content: Option<DialogContent>,
    entries: ListEntries,
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
            entries: ListEntries::default(),
            pending: 0,
        }
    }

    /// Opens the dialog for the block in a line, from 1, of the program `text`.
    pub fn open(&mut self, text: String, line: u32, context: &Context) {
        self.content = Some(DialogContent::Planning);
        self.entries = ListEntries::default();
        let console = self.console.clone();
        self.plan_in_thread(context, move || {
            find_basis(&console, &text, line)
                .and_then(|basis| plan(Arc::new(basis), RestartWords::default()))
        });
    }

    fn plan_in_thread(
        &mut self,
        context: &Context,
        plan: impl FnOnce() -> PlanResult + Send + 'static,
    ) {
        self.pending += 1;
        let to = self.sender.clone();
        run_in_thread(context, &self.console.notice_sender, move || {
            // The send fails when the view is gone. No view needs the plan then.
            let _ = to.send(plan());
            None
        });
    }

    fn take_plans(&mut self) {
        while let Ok(result) = self.receiver.try_recv() {
            self.pending = self.pending.saturating_sub(1);
            if self.pending > 0 {
                continue;
            }
            match (&self.content, result) {
                (None, _) => {}
                (Some(_), Ok(planned)) => {
                    self.entries.field = None;
                    self.entries.refusal = None;
                    self.content = Some(DialogContent::Planned(planned));
                }
                (Some(DialogContent::Planned(_)), Err(why)) => self.entries.refusal = Some(why),
                (Some(_), Err(why)) => self.content = Some(DialogContent::Failed(why)),
            }
        }
    }

    /// Draws the restart dialog, if it is open.
    pub fn show(&mut self, context: &Context, language: Language) {
        self.take_plans();
        let Some(content) = &self.content else {
            return;
        };
        let (entries, naming) = (&mut self.entries, self.console.naming());
        let is_checked = self.pending == 0;
        let mut change = None;
        let mut is_confirmed = false;
        let mut is_closed = false;
        Window::new(say::restart_title().text(language))
            .id(egui::Id::unique("restart"))
            .collapsible(false)
            .anchor(Align2::CENTER_CENTER, [0.0, -60.0])
            .show(context, |ui| {
                change = show_content(ui, content, entries, (language, naming));
                if let Some(refusal) = &entries.refusal {
                    ui.colored_label(theme::WARNING, refusal.text(language));
                }
                ui.horizontal(|ui| {
                    if let DialogContent::Planned(planned) = content {
                        let is_enabled = is_checked && entries.is_complete(&planned.plan);
                        let confirm = say::restart_confirm().text(language);
                        let button = ui.add_enabled(is_enabled, egui::Button::new(confirm));
                        let refusal = match is_checked {
                            true => say::restart_confirm_each(),
                            false => say::restart_checking(),
                        };
                        let refusal = refusal.text(language);
                        is_confirmed = button.on_disabled_hover_text(refusal).clicked();
                    }
                    is_closed = ui.button(say::window_cancel().text(language)).clicked();
                });
            });
        if let Some(change) = change {
            self.change_word(change, context);
        }
        if is_confirmed && let Some(DialogContent::Planned(planned)) = self.content.take() {
            let request = ControlRequest::Restart(planned.plan.restart);
            self.console.send(Command::Request(Box::new(request)));
        }
        if is_closed {
            self.content = None;
        }
    }

    /// Plans the restart again with a changed word.
    fn change_word(&mut self, change: WordChange, context: &Context) {
        let Some(DialogContent::Planned(planned)) = &self.content else {
            return;
        };
        let mut words = planned.words;
        self.entries.refusal = match change {
            WordChange::Remove(word) => {
                words.remove(word);
                None
            }
            WordChange::Set(text) => words.set(&text).err(),
        };
        if self.entries.refusal.is_none() {
            let basis = Arc::clone(&planned.basis);
            self.plan_in_thread(context, move || plan(basis, words));
        }
    }
}

impl ListEntries {
    /// Whether the operator has confirmed what a plan needs.
    fn is_complete(&self, plan: &RestartPlan) -> bool {
        let is_confirmed = |it: &StateDifference| self.confirmed.contains(it);
        !plan.moves_real_slides || plan.differences.iter().all(is_confirmed)
    }

    fn show_difference(
        &mut self,
        ui: &mut Ui,
        difference: &StateDifference,
        moves_real_slides: bool,
        language: Language,
    ) -> Option<WordChange> {
        let text = difference.to_message().text(language);
        if moves_real_slides {
            let mut is_ticked = self.confirmed.contains(difference);
            if ui.checkbox(&mut is_ticked, text).changed() {
                self.confirmed.retain(|it| it != difference);
                if is_ticked {
                    self.confirmed.push(difference.clone());
                }
            }
        } else {
            ui.label(text);
        }
        let word = difference.word?;
        ui.horizontal(|ui| self.show_word(ui, difference, word, language))
            .inner
    }

    /// Draws the buttons that change the word of a difference.
    fn show_word(
        &mut self,
        ui: &mut Ui,
        difference: &StateDifference,
        word: RestartWord,
        language: Language,
    ) -> Option<WordChange> {
        ui.add_space(ui.spacing().indent);
        if let Some((_, text)) = self.field.as_mut().filter(|(open, _)| *open == word) {
            let field = ui.add(TextEdit::singleline(text).desired_width(WORD_WIDTH));
            let is_entered =
                field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            let set = ui.button(say::restart_word_set().text(language));
            return (set.clicked() || is_entered).then(|| WordChange::Set(text.clone()));
        }
        let name = word.with_value(&difference.then);
        if (ui.small_button(say::restart_word_change(&name).text(language))).clicked() {
            self.field = Some((word, name));
        }
        if difference.replaced.is_some() {
            let back = ui.small_button(say::restart_word_program().text(language));
            return back.clicked().then_some(WordChange::Remove(word));
        }
        let keep = difference.keeping_word()?;
        let leave_out = say::restart_word_keep(&keep).text(language);
        let is_kept = ui.small_button(leave_out).clicked();
        is_kept.then_some(WordChange::Set(keep))
    }
}

/// Draws the plan, or its state. Returns the change of a word that the operator has requested.
fn show_content(
    ui: &mut Ui,
    content: &DialogContent,
    entries: &mut ListEntries,
    (language, naming): (Language, ProgramNaming),
) -> Option<WordChange> {
    let mut change = None;
    let list = ScrollArea::vertical().max_height(LIST_SIZE[1]);
    list.show(ui, |ui| {
        ui.set_min_width(LIST_SIZE[0]);
        let plan = match content {
            DialogContent::Planning => {
                return show_lines(ui, &[say::restart_planning()], language);
            }
            DialogContent::Failed(why) => {
                return show_lines(ui, core::slice::from_ref(why), language);
            }
            DialogContent::Planned(planned) => &planned.plan,
        };
        if plan.moves_real_slides {
            let warning = say::restart_confirm_each().text(language);
            ui.label(RichText::new(warning).color(theme::ALARM_TEXT).strong());
        }
        show_lines(
            ui,
            &plan.block_lines(|program| program_name(program, naming)),
            language,
        );
        for difference in &plan.differences {
            let requested =
                entries.show_difference(ui, difference, plan.moves_real_slides, language);
            change = change.take().or(requested);
        }
        show_lines(ui, &plan.way_lines(), language);
    });
    change
}

fn show_lines(ui: &mut Ui, lines: &[Message], language: Language) {
    for line in lines {
        ui.label(line.text(language));
    }
}

fn program_name(program: ProgramId, naming: ProgramNaming) -> String {
    match program {
        ProgramId::Stored(number) => naming.name(number),
        ProgramId::External | ProgramId::Mdi | ProgramId::Dnc => String::new(),
    }
}

/// Runs the program up to a line in a copy of the machine.
fn find_basis(console: &Console, text: &str, line: u32) -> Result<PlanBasis, Message> {
    let copy = console.machine_copy();
    let copy = copy.ok_or_else(say::window_kernel_stopped)?;
    let (now, part) = *copy;
    let id = find_program(&now, text).ok_or_else(say::program_other_text)?;
    let program = now.cnc.programs().get(id);
    let program = program.ok_or_else(say::program_other_text)?;
    let mut watcher = LineWatcher::new(id, program, line);
    let found = restart::find_block(&now, None, &mut watcher, None)?;
    Ok(PlanBasis { now, part, found })
}

/// Plans the restart with changed words.
fn plan(basis: Arc<PlanBasis>, words: RestartWords) -> PlanResult {
    let plan = restart::plan_restart(&basis.now, basis.part.as_ref(), &basis.found, &words)?;
    Ok(Box::new(PlannedRestart { basis, words, plan }))
}

/// The program of the control that has this text: the selected one, or a subprogram.
fn find_program(simulation: &Simulation, text: &str) -> Option<ProgramId> {
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
