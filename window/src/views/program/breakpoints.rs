//! The breakpoints of the program view: marks beside the lines, other locations as text, and
//! the bar of a halt.

use std::collections::{BTreeMap, BTreeSet};

use egui::{ScrollArea, Ui};
use gsk_core::command::{ProgramId, SourcePosition};
use gsk_core::model::ProgramNaming;
use gsk_core::program::Program;
use gsk_debugger::location::{BreakEvent, BreakLocation, ProgramFilter};
use gsk_debugger::source_files::ProgramSources;
use gsk_host::kernel::timeline::TimelineCommand;
use gsk_host::kernel::{BreakpointCommand, BreakpointHalt, Command, Console, PanelSnapshot};
use gsk_messages::{Language, Message, say};

use super::document::{ProgramDocument, TextOrigin};
use super::list_entry::{EntryTexts, ListEntry, MENU_WIDTH};
use super::watches::WatchList;
use crate::theme;
use crate::widgets::alarm_text;
use crate::widgets::field_menu::field_menu;

/// Greatest height of the list of breakpoints, points.
const LIST_HEIGHT: f32 = 200.0;
/// Length of the beginning of a text in which its O number is looked for, bytes.
const HEAD_BYTES: usize = 2000;
/// Greatest number of variables that the bar of a halt shows.
const SHOWN_VARIABLES: usize = 24;

/// Marks that the margin of the text shows beside the line numbers; lines count from 1.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MarginMarks {
    /// Numbers of the lines that have a breakpoint.
    pub breakpoints: BTreeSet<u32>,
    /// The line in execution; `None` if the text is not that of the program that runs.
    pub running_line: Option<u32>,
}

/// The user's breakpoints, and the state of the program that runs.
pub struct BreakpointList {
    /// The watched values, which the view shows with the breakpoints.
    pub watches: WatchList,
    console: Console,
    /// Lines with a breakpoint, by the number of their program; `None`: a text without number.
    lines: BTreeMap<Option<u16>, BTreeSet<u32>>,
    /// Locations that are not lines of the text.
    locations: Vec<BreakLocation>,
    entry: ListEntry,
    running_block: Option<SourcePosition>,
    halt: Option<BreakpointHalt>,
    /// Whether breakpoints have an effect: not on real slides, in a lesson or an exercise.
    is_active: bool,
}

impl BreakpointList {
    /// `watched` are the names of the values that are watched.
    pub fn new(console: Console, watched: &[String]) -> Self {
        Self {
            watches: WatchList::new(console.clone(), watched),
            console,
            lines: BTreeMap::new(),
            locations: Vec::new(),
            entry: ListEntry::default(),
            running_block: None,
            halt: None,
            is_active: true,
        }
    }

    /// Stores the state of the program that runs. Returns the block of a new halt.
    pub fn take_snapshot(&mut self, snapshot: &PanelSnapshot) -> Option<SourcePosition> {
        self.running_block = snapshot.running_block;
        self.watches.take_readings(&snapshot.watches);
        self.is_active = snapshot.board.is_none() && !snapshot.is_at_practice_machine();
        if self.halt == snapshot.halt {
            return None;
        }
        self.halt.clone_from(&snapshot.halt);
        self.halt.as_ref()?.block
    }

    /// Whether the text of `document` is that of a program.
    pub fn is_program(document: &ProgramDocument, program: ProgramId) -> bool {
        is_numbered_program(document, program_number(document), program)
    }

    /// Returns the marks beside the lines of a text.
    pub fn margin_marks(&self, document: &ProgramDocument) -> MarginMarks {
        let number = program_number(document);
        let lines = self.lines.get(&number);
        let block = self.halt.as_ref().map_or(self.running_block, |it| it.block);
        MarginMarks {
            breakpoints: lines.cloned().unwrap_or_default(),
            running_line: block
                .filter(|block| is_numbered_program(document, number, block.program))
                .map(|block| block.line),
        }
    }

    /// Sets or removes the breakpoint of the first block at or after a line, from 1.
    pub fn toggle_line(&mut self, document: &ProgramDocument, line: u32) {
        let lines = self.lines.entry(program_number(document)).or_default();
        if !lines.remove(&line) {
            let program = document.to_program();
            let block = program.block_from_line(line);
            if block >= program.block_count() {
                return;
            }
            let line = program.block_line(block);
            if !lines.remove(&line) {
                lines.insert(line);
            }
        }
        self.send();
    }

    /// Returns how the control model writes the names of programs.
    pub fn naming(&self) -> ProgramNaming {
        self.console.naming()
    }

    /// Returns the number of all breakpoints.
    fn count(&self) -> usize {
        let lines: usize = self.lines.values().map(BTreeSet::len).sum();
        lines + self.locations.len()
    }

    fn send(&self) {
        let line_locations = self.lines.iter().flat_map(|(number, lines)| {
            let filter = number.map_or(ProgramFilter::Any, ProgramFilter::Number);
            lines.iter().map(move |line| BreakLocation {
                text: line_name(*number, *line, self.console.naming()),
                event: BreakEvent::Line(filter.clone(), *line),
                condition: None,
            })
        });
        let locations = line_locations.chain(self.locations.clone()).collect();
        self.command(BreakpointCommand::Set(locations));
    }

    fn command(&self, command: BreakpointCommand) {
        self.console.send(Command::Breakpoints(command));
    }

    /// Draws the menus with the lists of breakpoints and watches, and the fields for others.
    pub fn show_menu(&mut self, ui: &mut Ui, language: Language) {
        let name = say::breakpoint_menu(self.count()).text(language);
        field_menu(ui, name, |ui| {
            ui.set_min_width(MENU_WIDTH);
            if !self.is_active {
                ui.colored_label(theme::WARNING, say::breakpoint_inactive().text(language));
            }
            ui.weak(say::breakpoint_margin_hint().text(language));
            self.show_list(ui, language);
            let texts = EntryTexts {
                examples: "N50, alarm 11, X<20, #500>3",
                hint: say::breakpoint_entry_hint(),
                add: say::breakpoint_add(),
            };
            let parse = |text: &str| BreakLocation::parse(text, &ProgramSources::default());
            if let Some(location) = self.entry.show(ui, language, &texts, parse) {
                self.locations.push(location);
                self.send();
            }
        });
        self.watches.show_menu(ui, language);
    }

    fn show_list(&mut self, ui: &mut Ui, language: Language) {
        let mut removed_line = None;
        let mut removed_location = None;
        let row = |ui: &mut Ui, name: &str| {
            ui.horizontal(|ui| {
                let remove = say::breakpoint_remove(name).text(language);
                let is_removed = ui.small_button("✕").on_hover_text(remove).clicked();
                ui.monospace(name);
                is_removed
            })
            .inner
        };
        ScrollArea::vertical()
            .max_height(LIST_HEIGHT)
            .show(ui, |ui| {
                for (number, lines) in &self.lines {
                    for line in lines {
                        if row(ui, &line_name(*number, *line, self.console.naming())) {
                            removed_line = Some((*number, *line));
                        }
                    }
                }
                for (index, location) in self.locations.iter().enumerate() {
                    if row(ui, &location.text) {
                        removed_location = Some(index);
                    }
                }
            });
        if let Some((number, line)) = removed_line
            && let Some(lines) = self.lines.get_mut(&number)
        {
            lines.remove(&line);
            self.send();
        }
        if let Some(index) = removed_location {
            self.locations.remove(index);
            self.send();
        }
    }

    /// Draws the watched values, and the bar of a halt: why, the buttons that end it, and the
    /// variables.
    pub fn show_halt(&self, ui: &mut Ui, language: Language) {
        self.watches.show_values(ui, language);
        let Some(halt) = &self.halt else {
            return;
        };
        ui.horizontal_wrapped(|ui| {
            ui.strong(halt_text(halt, self.console.naming(), language).text(language));
            if let Some(command) = show_halt_buttons(ui, language) {
                self.console.send(command);
            }
        });
        if let Some(fault) = &halt.fault {
            let fault = alarm_text::one_line(fault, language);
            ui.colored_label(theme::CODE_ALARM_TEXT, fault);
        }
        if !halt.variables.is_empty() {
            let shown = halt.variables.iter().take(SHOWN_VARIABLES);
            let mut values: Vec<String> = shown
                .map(|(number, value)| format!("#{number}={value}"))
                .collect();
            if halt.variables.len() > SHOWN_VARIABLES {
                values.push("…".to_owned());
            }
            ui.horizontal_wrapped(|ui| {
                ui.label(say::breakpoint_variables().text(language));
                ui.monospace(values.join("  "));
            });
        }
    }
}

/// Draws the buttons that lead on or back from a halt, and returns the command of the clicked
/// one.
pub fn show_halt_buttons(ui: &mut Ui, language: Language) -> Option<Command> {
    let buttons = [
        (
            say::breakpoint_continue(),
            say::breakpoint_continue_hint(),
            Command::Breakpoints(BreakpointCommand::Continue),
        ),
        (
            say::breakpoint_next_block(),
            say::breakpoint_next_block_hint(),
            Command::Breakpoints(BreakpointCommand::NextBlock),
        ),
        (
            say::breakpoint_next_slot(),
            say::breakpoint_next_slot_hint(),
            Command::Breakpoints(BreakpointCommand::NextSlot),
        ),
        (
            say::breakpoint_slot_back(),
            say::breakpoint_slot_back_hint(),
            Command::Timeline(TimelineCommand::StepSlot { back: true }),
        ),
    ];
    let mut chosen = None;
    for (name, hint, command) in buttons {
        let button = ui.button(name.text(language));
        if button.on_hover_text(hint.text(language)).clicked() {
            chosen = Some(command);
        }
    }
    chosen
}

/// Returns the message about a halt at a breakpoint.
pub fn halt_text(halt: &BreakpointHalt, naming: ProgramNaming, language: Language) -> Message {
    let block = halt.block.as_ref();
    let place = block.map(|it| alarm_text::source_text(it, naming, language));
    let place = place.unwrap_or_default();
    match &halt.location {
        Some(location) => say::breakpoint_hit(location, place),
        None => say::breakpoint_stepped(place),
    }
}

/// Whether the text of `document`, with this O number, is that of a program.
const fn is_numbered_program(
    document: &ProgramDocument,
    number: Option<u16>,
    program: ProgramId,
) -> bool {
    match (program, number) {
        (ProgramId::Stored(wanted), Some(number)) => wanted == number,
        (ProgramId::External, _) => !matches!(document.origin, TextOrigin::Memory(_)),
        (ProgramId::Stored(_), None) | (ProgramId::Mdi | ProgramId::Dnc, _) => false,
    }
}

/// Returns the program number of a text; `None` without an O word.
fn program_number(document: &ProgramDocument) -> Option<u16> {
    let mut end = document.text.len().min(HEAD_BYTES);
    while !document.text.is_char_boundary(end) {
        end -= 1;
    }
    Program::new(&document.text[..end]).number()
}

/// A line as a location: `O0012:3`, or `3` in a text without number.
fn line_name(number: Option<u16>, line: u32, naming: ProgramNaming) -> String {
    let of_program = |number| format!("{}:{line}", naming.name(number));
    number.map_or_else(|| line.to_string(), of_program)
}
