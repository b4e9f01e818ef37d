//! Shows the content of a node of the tree as lines.

use egui::{Align, Layout, RichText, ScrollArea, TextWrapMode, Ui, vec2};
use gsk_messages::{Language, Message, say};
use gsk_project::{ProjectKey, ProjectState, ProjectValue, label, unit};

use super::document::programs;
use super::tree::{LadderParts, Node, below};

/// Width of the first column, points.
const HEAD: f32 = 84.0;
/// Width of the column of values, points.
const VALUE: f32 = 150.0;

/// A line: the name, its value, and the meaning.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct Line {
    head: String,
    text: String,
    note: String,
}

/// The lines of a node, kept until another node is shown.
#[derive(Default)]
pub struct Content {
    of: Option<(Node, Language)>,
    lines: Vec<Line>,
}

impl Content {
    /// Rebuilds the lines on the next frame: the project has changed.
    pub fn forget(&mut self) {
        self.of = None;
    }

    /// Draws the lines of a node.
    pub fn show(&mut self, ui: &mut Ui, language: Language, node: Node, state: &ProjectState) {
        if self.of != Some((node, language)) {
            self.of = Some((node, language));
            self.lines = lines(node, state, language);
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
                            cell(ui, HEAD, height, RichText::new(&line.head).weak());
                        }
                        if has_values {
                            cell(ui, VALUE, height, RichText::new(&line.text));
                            ui.label(line.note.as_str());
                        } else {
                            ui.monospace(line.text.as_str());
                        }
                    });
                }
            });
    }
}

/// Draws a text in a column of fixed width.
fn cell(ui: &mut Ui, width: f32, height: f32, text: RichText) {
    let layout = Layout::left_to_right(Align::Center);
    ui.allocate_ui_with_layout(vec2(width, height), layout, |ui| {
        ui.set_min_width(width);
        ui.label(text.monospace());
    });
}

fn lines(node: Node, state: &ProjectState, language: Language) -> Vec<Line> {
    let ladder = state.ladder();
    match node {
        Node::Messages => {
            let messages = ladder.messages().iter().map(|message| Line {
                head: message.bit.to_string(),
                text: format!("{:04}", message.number),
                note: message.text.clone(),
            });
            messages.collect()
        }
        Node::Initial => {
            let values = ladder.start_values().iter();
            values
                .map(|start| Line {
                    head: start.address.to_string(),
                    text: start.value.to_string(),
                    note: label(ProjectKey::Data(start.address), state, language),
                })
                .collect()
        }
        Node::Ladder => text(ladder.source()),
        Node::Machine => written(state, ProjectKey::Machine),
        Node::Program(number) => {
            let program = state.memory().programs.iter();
            let own = program.into_iter().find(|(own, _)| *own == number);
            let mut all = own.map_or_else(Vec::new, |(_, program)| text(program.text()));
            let job = written(state, ProjectKey::Job(number));
            if !job.is_empty() {
                all.push(Line::default());
                all.extend(job);
            }
            all
        }
        Node::Programs => programs(state)
            .into_iter()
            .map(|number| listed(number, state, language))
            .collect(),
        Node::Project | Node::Plc | Node::Cnc => below(node)
            .map(|(node, name)| summary(node, &name, state, language))
            .collect(),
        _ => values(node, state, language),
    }
}

/// The lines of a text with their numbers.
fn text(source: &str) -> Vec<Line> {
    let lines = (1..).zip(source.lines());
    lines
        .map(|(number, line): (u32, &str)| Line {
            head: number.to_string(),
            text: line.trim_end().to_owned(),
            note: String::new(),
        })
        .collect()
}

/// The lines of the machine file or of a job file.
fn written(state: &ProjectState, key: ProjectKey) -> Vec<Line> {
    let found = state.texts().and_then(|texts| texts.get(&key));
    found.map_or_else(Vec::new, |found| text(found))
}

/// The line of a program in the list of programs.
fn listed(number: u16, state: &ProjectState, language: Language) -> Line {
    let mut programs = state.memory().programs.iter();
    let own = programs.find(|(own, _)| *own == number);
    let source = own.as_ref().map_or("", |(_, program)| program.text());
    let count = say::project_node_lines(source.lines().count());
    Line {
        head: format!("O{number:04}"),
        text: count.text(language),
        note: source.lines().next().unwrap_or_default().trim().to_owned(),
    }
}

/// The line with the count of entries of a node.
fn summary(node: Node, name: &Message, state: &ProjectState, language: Language) -> Line {
    let ladder = state.ladder();
    let said = match node {
        Node::Messages => say::project_node_values(ladder.messages().len()),
        Node::Initial => say::project_node_values(ladder.start_values().len()),
        Node::Ladder => say::project_node_lines(ladder.source().lines().count()),
        Node::Programs => say::project_node_values(programs(state).len()),
        Node::Machine => say::project_node_lines(written(state, ProjectKey::Machine).len()),
        _ => say::project_node_values(entries(node, state).count()),
    };
    Line {
        head: String::new(),
        text: name.text(language),
        note: said.text(language),
    }
}

fn entries(node: Node, state: &ProjectState) -> impl Iterator<Item = (ProjectKey, ProjectValue)> {
    let all = state.entries().into_iter();
    all.filter(move |(key, _)| node.has(*key, LadderParts::default()))
}

/// The values of a node with their names.
fn values(node: Node, state: &ProjectState, language: Language) -> Vec<Line> {
    let model = state.memory().model.id();
    entries(node, state)
        .map(|(key, value)| Line {
            head: key.name(),
            text: format!("{value} {}", unit(key, model))
                .trim_end()
                .to_owned(),
            note: label(key, state, language),
        })
        .collect()
}
