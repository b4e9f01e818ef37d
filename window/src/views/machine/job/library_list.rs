//! The tool library in the job panel: search, pictures, life, new tools by ISO code, tables of
//! other programs.

use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use egui::{Button, Checkbox, Color32, DragValue, RichText, ScrollArea, TextEdit, Ui};
use gsk_host::files::tool_library;
use gsk_host::files::tool_tables::{self, ToolTableFormat};
use gsk_host::kernel::Console;
use gsk_messages::{Language, Message, say};
use gsk_runner::text_format::short_description;
use gsk_tooling::{LibraryTool, ToolLibrary, ToolLife};
use gsk_workpiece::job::Job;

use super::{JobContext, MAX_TOOL_NUMBER, tool_drawing};
use crate::focus::{FocusList, selectable_row};
use crate::theme;
use crate::widgets::files::{FileChoice, choose_file};

/// Height of the list, points.
const LIST_HEIGHT: f32 = 150.0;
/// Time after which the file is read again, s: other programs and the counting of lives change
/// it.
const READ_INTERVAL_S: f64 = 2.0;
/// Life of an edge that is proposed, minutes.
const PROPOSED_MINUTES: f64 = 15.0;
/// Range of the life of an edge, minutes.
const MINUTES_RANGE: core::ops::RangeInclusive<f64> = 0.1..=1000.0;
/// Greatest number of edges of an insert.
const MAX_EDGES: u8 = 12;

/// The list of the library with what is typed and chosen.
pub struct ToolLibraryList {
    /// The library, or why it cannot be read.
    library: Result<ToolLibrary, Message>,
    /// Time at which the file is read again, s.
    next_read_s: f64,
    /// Set by a thread that has changed the file.
    is_outdated: Arc<AtomicBool>,
    filter: String,
    /// The description of a new tool.
    code: String,
    selected: Option<String>,
    /// The T number for the selected tool; `None` until one is chosen.
    number: Option<u8>,
    message: Option<(Message, Color32)>,
}

impl Default for ToolLibraryList {
    fn default() -> Self {
        Self {
            library: Ok(ToolLibrary::default()),
            next_read_s: 0.0,
            is_outdated: Arc::default(),
            filter: String::new(),
            code: String::new(),
            selected: None,
            number: None,
            message: None,
        }
    }
}

impl ToolLibraryList {
    /// Draws the library. Returns the T number under which a tool was put into the job; `None`
    /// without one. `free_number` is proposed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        job: &mut Job,
        free_number: Option<u8>,
        lathe: &JobContext<'_>,
        language: Language,
    ) -> Option<u8> {
        self.update(ui);
        self.show_new_tool(ui, language);
        self.show_tables(ui, lathe.console, language);
        if let Some((message, color)) = &self.message {
            ui.colored_label(*color, message.text(language));
        }
        let library = match &self.library {
            Ok(library) => library.clone(),
            Err(why) => {
                ui.colored_label(theme::JOB_ERROR, why.text(language));
                return None;
            }
        };
        if library.tools.is_empty() {
            ui.weak(say::tool_library_empty().text(language));
            return None;
        }
        self.show_list(ui, &library, language);
        let id = self.selected.clone()?;
        let tool = library.tools.get(&id)?;
        ui.separator();
        tool_drawing::show(ui, &tool.tool, lathe.rear_tool_post, language);
        ui.label(tool.description());
        self.show_life(ui, &id, tool, language);
        self.show_use(ui, job, (&id, tool), free_number, language)
    }

    /// Draws the button that stores a tool of the job in the library.
    pub fn show_keeping(&mut self, ui: &mut Ui, job: &mut Job, number: u8, language: Language) {
        let Some(tool) = job.tools.get(&number) else {
            return;
        };
        let button = Button::new(say::tool_library_keep().text(language));
        let button = ui.add_enabled(tool.check().is_ok(), button);
        let hint = say::tool_library_keep_hint().text(language);
        if button.on_hover_text(hint).clicked() {
            let kept = LibraryTool {
                station: Some(number),
                ..LibraryTool::new(tool.clone())
            };
            let name = short_description(tool).text(Language::En);
            let added = add_tool(&name, kept);
            if let Ok(id) = &added {
                job.library.insert(number, id.clone());
            }
            self.take_result(added.map(|id| Some(say::tool_library_added(id))));
        }
        if let Some((message, color)) = &self.message {
            ui.colored_label(*color, message.text(language));
        }
    }

    /// Reads the file if it may have changed.
    fn update(&mut self, ui: &Ui) {
        let now_s = ui.input(|input| input.time);
        let is_outdated = self.is_outdated.swap(false, Ordering::Relaxed);
        if is_outdated || now_s >= self.next_read_s {
            self.next_read_s = now_s + READ_INTERVAL_S;
            self.library = tool_library::read();
        }
    }

    /// Shows what a change has done, and reads the file again.
    fn take_result(&mut self, result: Result<Option<Message>, Message>) {
        self.next_read_s = 0.0;
        self.message = match result {
            Ok(message) => message.map(|it| (it, theme::JOB_VALID)),
            Err(why) => Some((why, theme::JOB_ERROR)),
        };
    }

    fn show_new_tool(&mut self, ui: &mut Ui, language: Language) {
        let name = ui.label(say::tool_library_code().text(language));
        ui.horizontal(|ui| {
            let button_width = 90.0;
            let width = (ui.available_width() - button_width).max(80.0);
            let field = TextEdit::singleline(&mut self.code).desired_width(width);
            let field = ui.add(field).labelled_by(name.id);
            let hint = say::tool_library_code_hint().text(language);
            let is_entered =
                field.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
            field.on_hover_text(hint);
            let add = Button::new(say::tool_library_add().text(language));
            let add = ui.add_enabled(!self.code.trim().is_empty(), add);
            if add.clicked() || (is_entered && !self.code.trim().is_empty()) {
                let added = LibraryTool::from_description(&self.code)
                    .and_then(|tool| add_tool(&tool.code.clone(), tool));
                if let Ok(id) = &added {
                    self.selected = Some(id.clone());
                    self.code.clear();
                }
                self.take_result(added.map(|id| Some(say::tool_library_added(id))));
            }
        });
    }

    /// Draws the buttons for tables of other programs.
    fn show_tables(&mut self, ui: &mut Ui, console: &Console, language: Language) {
        ui.horizontal_wrapped(|ui| {
            let import = ui.button(say::tool_library_import().text(language));
            let hint = say::tool_library_import_hint().text(language);
            if import.on_hover_text(hint).clicked() {
                let name = say::tool_library_name().text(language);
                let choice = FileChoice::Open(name, vec!["csv", "tbl", "fctl", "fctb", "ron"]);
                let is_outdated = Arc::clone(&self.is_outdated);
                let notices = &console.notice_sender;
                choose_file(ui.ctx(), language, notices, choice, move |path| {
                    let done = import_table(&path);
                    is_outdated.store(true, Ordering::Relaxed);
                    Some(done.unwrap_or_else(|why| why))
                });
            }
            let export = ui.button(say::tool_library_export().text(language));
            let hint = say::tool_library_export_hint().text(language);
            if export.on_hover_text(hint).clicked() {
                let choice = FileChoice::Save("tools.csv".to_owned(), "csv");
                let notices = &console.notice_sender;
                choose_file(ui.ctx(), language, notices, choice, |path| {
                    Some(export_table(&path).unwrap_or_else(|why| why))
                });
            }
        });
    }

    fn show_list(&mut self, ui: &mut Ui, library: &ToolLibrary, language: Language) {
        ui.horizontal(|ui| {
            let name = ui.label(say::tool_library_filter().text(language));
            let width = ui.available_width();
            let field = TextEdit::singleline(&mut self.filter).desired_width(width);
            ui.add(field).labelled_by(name.id);
        });
        let tools: Vec<(&String, &LibraryTool)> = library
            .tools
            .iter()
            .filter(|(id, tool)| tool.matches(id, &self.filter))
            .collect();
        if tools.is_empty() {
            ui.weak(say::tool_library_nothing().text(language));
        }
        let selected = self.selected.as_ref();
        let row = tools.iter().position(|(id, _)| Some(*id) == selected);
        let name = say::tool_library_name().text(language);
        let mut chosen = None;
        ScrollArea::vertical()
            .id_salt("tool library")
            .max_height(LIST_HEIGHT)
            .auto_shrink([false, true])
            .show(ui, |ui| {
                let list = FocusList::begin(ui, "tools", &name, tools.len(), row);
                for (index, (id, tool)) in tools.iter().enumerate() {
                    let station = tool
                        .station
                        .map_or_else(String::new, |it| format!("T{it:02}  "));
                    let kind = short_description(&tool.tool).text(language);
                    let text = format!("{station}{id}  {kind}  {}", tool.name);
                    let response = selectable_row(ui, row == Some(index), text);
                    let is_clicked = list.show_cursor(ui, index, &response);
                    if is_clicked
                        || list.entered_row() == Some(index)
                        || list.moved_row() == Some(index)
                    {
                        chosen = Some((*id).clone());
                    }
                }
            });
        if chosen.is_some() && chosen != self.selected {
            self.selected = chosen;
            (self.number, self.message) = (None, None);
        }
    }

    /// Draws the life of a tool's edge with its switch.
    fn show_life(&mut self, ui: &mut Ui, id: &str, tool: &LibraryTool, language: Language) {
        let mut life = tool.life;
        let mut counts = life.is_some();
        let name = say::tool_library_life().text(language);
        if ui.add(Checkbox::new(&mut counts, name)).changed() {
            life = counts.then_some(ToolLife::new(PROPOSED_MINUTES, 1));
        }
        if let Some(life) = &mut life {
            let (used, minutes) = (format!("{:.1}", life.used_minutes), life.minutes);
            let words = say::tool_life_left(life.edge, life.edges, used, minutes).text(language);
            let color = match life.is_used_up() {
                true => theme::WARNING,
                false => theme::STATE_TEXT,
            };
            ui.label(RichText::new(words).color(color));
            ui.horizontal(|ui| {
                let drag = DragValue::new(&mut life.minutes).range(MINUTES_RANGE);
                let drag = ui.add(drag.speed(0.5));
                let word = ui.label(say::tool_word_life().text(language));
                drag.labelled_by(word.id);
            });
            ui.horizontal(|ui| {
                let drag = DragValue::new(&mut life.edges).range(1..=MAX_EDGES);
                let drag = ui.add(drag.speed(0.1));
                let word = ui.label(say::tool_word_edges().text(language));
                drag.labelled_by(word.id);
                life.edge = life.edge.min(life.edges);
                let next = ui.button(say::tool_library_edge().text(language));
                let hint = say::tool_library_edge_hint().text(language);
                if next.on_hover_text(hint).clicked() {
                    life.turn_edge();
                }
            });
        }
        let is_released = !ui.input(|input| input.pointer.any_down());
        if life != tool.life {
            if let Ok(library) = &mut self.library
                && let Some(known) = library.tools.get_mut(id)
            {
                known.life = life;
            }
            // The file is not read while the pointer drags a value.
            self.next_read_s = f64::INFINITY;
        }
        if is_released && self.next_read_s.is_infinite() {
            let changed = tool_library::change(|library| {
                if let Some(known) = library.tools.get_mut(id) {
                    known.life = life;
                }
                library.check()
            });
            self.take_result(changed.map(|()| None));
        }
    }

    /// Draws the buttons that use or remove a tool. Returns the number under which it is used.
    fn show_use(
        &mut self,
        ui: &mut Ui,
        job: &mut Job,
        (id, tool): (&str, &LibraryTool),
        free_number: Option<u8>,
        language: Language,
    ) -> Option<u8> {
        let proposed = self.number.or(tool.station).or(free_number).unwrap_or(1);
        let (mut number, mut used) = (proposed, None);
        ui.horizontal_wrapped(|ui| {
            let drag = DragValue::new(&mut number)
                .range(1..=MAX_TOOL_NUMBER)
                .prefix("T");
            if ui.add(drag.speed(0.1)).changed() {
                self.number = Some(number);
            }
            if ui
                .button(say::tool_library_use(number).text(language))
                .clicked()
            {
                job.tools.insert(number, tool.tool.clone());
                job.library.insert(number, id.to_owned());
                used = Some(number);
            }
            if ui
                .button(say::tool_library_remove().text(language))
                .clicked()
            {
                let removed = tool_library::change(|library| {
                    library.tools.remove(id);
                    Ok(())
                });
                self.selected = None;
                self.take_result(removed.map(|()| Some(say::tool_removed(id))));
            }
        });
        used
    }
}

/// Adds a tool under an id made from a name. Returns the id.
fn add_tool(name: &str, tool: LibraryTool) -> Result<String, Message> {
    tool_library::change(|library| {
        let id = library.free_id(name);
        library.insert(&id, tool)?;
        Ok(id)
    })
}

/// Adds the tools of a table. Returns how many, or the first line that cannot be read.
fn import_table(path: &Path) -> Result<Message, Message> {
    let format = ToolTableFormat::from_input_path(path);
    let format = format.ok_or_else(|| say::tool_format_unknown(path.display()))?;
    let imported = tool_tables::import(path, format, 1.0)?;
    if let (true, Some(note)) = (imported.tools.is_empty(), imported.notes.first()) {
        return Err(note.clone());
    }
    let add = |library: &mut ToolLibrary| tool_tables::add_imported(library, imported, false);
    Ok(say::tool_import_done(tool_library::change(add)?))
}

fn export_table(path: &Path) -> Result<Message, Message> {
    let format = ToolTableFormat::from_path(path);
    let format = format.ok_or_else(|| say::tool_format_unknown(path.display()))?;
    tool_tables::export(&tool_library::read()?, path, format)?;
    Ok(say::window_saved(path.display()))
}
