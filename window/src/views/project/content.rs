//! Shows the content of a node of the tree as lines.

use egui::{Align, Layout, RichText, ScrollArea, TextWrapMode, Ui, vec2};
use gsk_messages::{Language, Message, say};
use gsk_project::{ProjectKey, ProjectState, ProjectValue, label, unit};

use super::document::program_numbers;
use super::tree::{LadderParts, ProjectNode, children};

/// Width of the column with the names, points.
const HEAD_WIDTH: f32 = 84.0;
/// Width of the column with the values, points.
const VALUE_WIDTH: f32 = 150.0;

/// A line of a node's content: name, value and meaning.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct ContentLine {
    head: String,
    text: String,
    note: String,
}

/// The lines with the content of a node, kept until another node is shown.
#[derive(Default)]
pub struct NodeContent {
    shown_node: Option<(ProjectNode, Language)>,
    lines: Vec<ContentLine>,
}

impl NodeContent {
    /// Drops the lines, because the project has changed; the next frame rebuilds them.
    pub fn invalidate(&mut self) {
        self.shown_node = None;
    }

    /// Draws the lines with the content of a node.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        language: Language,
        node: ProjectNode,
        state: &ProjectState,
    ) {
        if self.shown_node != Some((node, language)) {
            self.shown_node = Some((node, language));
            self.lines = lines_of(node, state, language);
        }
        if self.lines.is_empty() {
            ui.weak(say::project_view_empty().text(language));
        }
        let height = ui.spacing().interact_size.y;
        let has_heads = self.lines.iter().any(|line| !line.head.is_empty());
        let has_values = self.lines.iter().any(|line| !line.note.is_empty());
        ScrollArea::both()
            .id_salt(("project content", self.lines.len()))
            .auto_shrink([false, false])
            .show_rows(ui, height, self.lines.len(), |ui, shown| {
                ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
                for line in self.lines.get(shown).unwrap_or_default() {
                    ui.horizontal(|ui| {
                        if has_heads {
                            show_cell(ui, HEAD_WIDTH, height, RichText::new(&line.head).weak());
                        }
                        if has_values {
                            show_cell(ui, VALUE_WIDTH, height, RichText::new(&line.text));
                            ui.label(line.note.as_str());
                        } else {
                            ui.monospace(line.text.as_str());
                        }
                    });
                }
            });
    }
}

/// Draws a text cut to a column of `width` points.
fn show_cell(ui: &mut Ui, width: f32, height: f32, text: RichText) {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.label(text.monospace());
    });
}

fn lines_of(node: ProjectNode, state: &ProjectState, language: Language) -> Vec<ContentLine> {
    let ladder = state.ladder();
    match node {
        ProjectNode::Messages => {
            let messages = ladder.messages().iter().map(|message| ContentLine {
                head: message.bit.to_string(),
                text: format!("{:04}", message.number),
                note: message.text.clone(),
            });
            messages.collect()
        }
        ProjectNode::Initial => {
            let values = ladder.start_values().iter();
            values
                .map(|start| ContentLine {
                    head: start.address.to_string(),
                    text: start.value.to_string(),
                    note: label(ProjectKey::Data(start.address), state, language),
                })
                .collect()
        }
        ProjectNode::Ladder => numbered_lines(ladder.source()),
        ProjectNode::Machine => stored_text(state, ProjectKey::Machine),
        ProjectNode::Program(number) => {
            let program = state.memory().programs.iter();
            let stored = program.into_iter().find(|(own, _)| *own == number);
            let mut all =
                stored.map_or_else(Vec::new, |(_, program)| numbered_lines(program.text()));
            let job = stored_text(state, ProjectKey::Job(number));
            if !job.is_empty() {
                all.push(ContentLine::default());
                all.extend(job);
            }
            all
        }
        ProjectNode::Programs => program_numbers(state)
            .into_iter()
            .map(|number| program_line(number, state, language))
            .collect(),
        ProjectNode::Project | ProjectNode::Plc | ProjectNode::Cnc => children(node)
            .map(|(node, name)| node_summary(node, &name, state, language))
            .collect(),
        _ => value_lines(node, state, language),
    }
}

/// Converts a text to content lines with line numbers from 1.
fn numbered_lines(source: &str) -> Vec<ContentLine> {
    let lines = (1..).zip(source.lines());
    lines
        .map(|(number, line): (u32, &str)| ContentLine {
            head: number.to_string(),
            text: line.trim_end().to_owned(),
            note: String::new(),
        })
        .collect()
}

/// Converts the machine file or a job file to content lines with line numbers.
fn stored_text(state: &ProjectState, key: ProjectKey) -> Vec<ContentLine> {
    let stored = state.texts().and_then(|texts| texts.get(&key));
    stored.map_or_else(Vec::new, |found| numbered_lines(found))
}

/// Formats the line of a program in the list of programs.
fn program_line(number: u16, state: &ProjectState, language: Language) -> ContentLine {
    let mut programs = state.memory().programs.iter();
    let stored = programs.find(|(own, _)| *own == number);
    let source = stored.as_ref().map_or("", |(_, program)| program.text());
    let count = say::project_node_lines(source.lines().count());
    ContentLine {
        head: state.memory().model.record().program_naming().name(number),
        text: count.text(language),
        note: source.lines().next().unwrap_or_default().trim().to_owned(),
    }
}

/// Formats the line with the name of a node and the number of its entries.
fn node_summary(
    node: ProjectNode,
    name: &Message,
    state: &ProjectState,
    language: Language,
) -> ContentLine {
    let ladder = state.ladder();
    let count_text = match node {
        ProjectNode::Messages => say::project_node_values(ladder.messages().len()),
        ProjectNode::Initial => say::project_node_values(ladder.start_values().len()),
        ProjectNode::Ladder => say::project_node_lines(ladder.source().lines().count()),
        ProjectNode::Programs => say::project_node_values(program_numbers(state).len()),
        ProjectNode::Machine => {
            say::project_node_lines(stored_text(state, ProjectKey::Machine).len())
        }
        _ => say::project_node_values(entries_of(node, state).count()),
    };
    ContentLine {
        head: String::new(),
        text: name.text(language),
        note: count_text.text(language),
    }
}

fn entries_of(
    node: ProjectNode,
    state: &ProjectState,
) -> impl Iterator<Item = (ProjectKey, ProjectValue)> {
    let all = state.entries().into_iter();
    all.filter(move |(key, _)| node.contains(*key, LadderParts::default()))
}

/// Formats the values of a node with their names, one per line.
fn value_lines(node: ProjectNode, state: &ProjectState, language: Language) -> Vec<ContentLine> {
    let model = state.memory().model.id();
    entries_of(node, state)
        .map(|(key, value)| ContentLine {
            head: key.name(),
            text: format!("{value} {}", unit(key, model))
                .trim_end()
                .to_owned(),
            note: label(key, state, language),
        })
        .collect()
}
