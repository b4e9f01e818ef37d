//! The text field: editable with colours, line numbers and hover texts, or read-only if the
//! text is too large.

use std::ops::Range;

use egui::text::{CCursor, CCursorRange, LayoutJob};
use egui::text_edit::TextEditState;
use egui::{
    Align, Align2, Context, FontId, Frame, Galley, Id, Margin, Pos2, Rect, Response, ScrollArea,
    Shape, Stroke, TextEdit, Ui, pos2, vec2,
};
use gsk_core::model::ModelId;
use gsk_language::meaning::word_meaning;
use gsk_language::words::{spans, word_of};
use gsk_messages::{Language, say};

use super::breakpoints::MarginMarks;
use super::check::TextFinding;
use super::document::ProgramDocument;
use super::paint::{self, TextColorizer, find_alarm_ranges};
use super::targets::JumpTarget;
use crate::{help, theme};

/// Width of a digit of a line number, points. The constant after it is the margin beside the
/// numbers.
const DIGIT_WIDTH: f32 = 9.0;
const NUMBERS_MARGIN: f32 = 14.0;
/// Size of a mark beside the line numbers, points.
const MARK_SIZE: f32 = 9.0;

/// The data that the text field draws besides the text.
pub struct EditorInputs<'a> {
    pub document: &'a mut ProgramDocument,
    /// The revision of the text that was checked, and the findings of that check.
    pub marks: (Option<u64>, &'a [TextFinding]),
    /// The marks in the margin of the text.
    pub margin: MarginMarks,
    /// Whether to scroll to the line that is being executed.
    pub shows_running_line: bool,
    /// The language of hover texts.
    pub language: Language,
}

/// The actions of the user in the text field during a frame.
#[derive(Debug, Default)]
pub struct EditorResponse {
    pub is_changed: bool,
    /// The target of the word that was clicked with Ctrl, and the line of that word, from 0; `None`
    /// without such a click.
    pub clicked_target: Option<(JumpTarget, usize)>,
    /// The line, from 1, at whose block the user requests a restart; `None` without a request.
    pub restart_line: Option<u32>,
    /// The line, from 1, whose breakpoint the user sets or removes; `None` without a request.
    pub breakpoint_line: Option<u32>,
    /// Whether the user opens a form at the cursor.
    pub opens_form: bool,
}

/// Returns the widget id of the text field.
pub fn text_field_id() -> Id {
    Id::unique("program text")
}

/// The range of characters that the cursor selects; `None` if the field has no cursor.
pub fn cursor_range(context: &Context) -> Option<Range<usize>> {
    let range = TextEditState::load(context, text_field_id())?
        .cursor
        .char_range()?;
    let range = range.as_sorted_char_range();
    Some(range.start.0..range.end.0)
}

/// Undoes the last change or, if `redo` is set, repeats the change undone last. Returns the
/// resulting text, or `None` if there is no such change.
pub fn undo_or_redo(context: &Context, text: &str, redo: bool) -> Option<String> {
    let mut state = TextEditState::load(context, text_field_id())?;
    let mut undoer = state.undoer();
    let here = state.cursor.char_range().unwrap_or_default();
    let now = (here, text.to_owned());
    let step = if redo {
        undoer.redo(&now)
    } else {
        undoer.undo(&now)
    };
    let (range, text) = step?.clone();
    state.cursor.set_char_range(Some(range));
    state.set_undoer(undoer);
    state.store(context, text_field_id());
    Some(text)
}

/// Clears undo steps and cursor, because another text is loaded.
pub fn clear_undo(context: &Context) {
    if let Some(mut state) = TextEditState::load(context, text_field_id()) {
        state.clear_undoer();
        state.cursor.set_char_range(None);
        state.store(context, text_field_id());
    }
}

/// Draws an editable text. Takes a range of characters to select and scroll to out of `jump`.
pub fn show_editable(
    ui: &mut Ui,
    sheet: EditorInputs<'_>,
    painter: &mut TextColorizer,
    jump: &mut Option<Range<usize>>,
) -> EditorResponse {
    let font = FontId::monospace(theme::READING_SIZE);
    let numbers_width = line_numbers_width(sheet.document.line_count());
    let EditorInputs {
        document,
        marks,
        margin: margin_marks,
        shows_running_line,
        language,
    } = sheet;
    ui.painter()
        .rect_filled(ui.max_rect(), 0.0, theme::CODE_GROUND);
    let area = ScrollArea::both()
        .auto_shrink([false, false])
        .id_salt("text");
    area.show(ui, |ui| {
        let mut layouter = |ui: &Ui, buffer: &dyn egui::TextBuffer, _wrap: f32| {
            let job = painter.layout_text(buffer.as_str(), &font, marks);
            ui.fonts_mut(|fonts| fonts.layout_job(job))
        };
        let available = ui.available_size();
        let margin = Margin {
            left: numbers_width as i8,
            ..Margin::same(4)
        };
        let mut output = TextEdit::multiline(&mut document.text)
            .id(text_field_id())
            .code_editor()
            // Tab moves the focus: a program does not use tabs, and the keyboard must get out.
            .lock_focus(false)
            .frame(Frame::NONE.inner_margin(margin))
            .desired_width(f32::INFINITY)
            .min_size(available)
            .layouter(&mut layouter)
            .show(ui);
        let response = output.response.response.clone();
        let name = say::program_text().text(language);
        response
            .widget_info(|| egui::WidgetInfo::labeled(egui::Role::MultilineTextInput, true, &name));
        let menu = show_menu(document, &response, language);
        let done = EditorResponse {
            is_changed: response.changed(),
            clicked_target: find_clicked_target(
                ui,
                document,
                &response,
                &output.galley,
                output.galley_pos,
            ),
            restart_line: menu.restart_line,
            opens_form: menu.opens_form,
            breakpoint_line: draw_margin(
                ui,
                &output.galley,
                output.galley_pos,
                numbers_width,
                &margin_marks,
                language,
            )
            .or(menu.breakpoint_line),
        };
        if done.is_changed {
            document.update_after_change();
        }
        if let Some(range) = jump.take() {
            let (from, to) = (CCursor::new(range.start), CCursor::new(range.end));
            output
                .state
                .cursor
                .set_char_range(Some(CCursorRange::two(from, to)));
            output.state.store(ui.ctx(), text_field_id());
            response.request_focus();
            scroll_to(ui, &output.galley, output.galley_pos, from);
        }
        if shows_running_line && let Some(line) = margin_marks.running_line {
            let start = document.line_start(line.saturating_sub(1) as usize);
            let cursor = CCursor::new(document.character_at_byte(start));
            scroll_to(ui, &output.galley, output.galley_pos, cursor);
        }
        show_hover_text(
            ui,
            document,
            marks.1,
            language,
            &response,
            &output.galley,
            output.galley_pos,
        );
        done
    })
    .inner
}

/// Scrolls to a character of the text; `origin` is the position of the text in the window.
fn scroll_to(ui: &Ui, galley: &Galley, origin: Pos2, cursor: CCursor) {
    let at = galley.pos_from_cursor(cursor);
    ui.scroll_to_rect(at.translate(origin.to_vec2()), Some(Align::Center));
}

/// Draws a read-only text, of which it lays out only the visible lines. `jump`: a line to
/// scroll to. Returns the line, from 1, whose number was clicked.
pub fn show_read_only(ui: &mut Ui, sheet: &EditorInputs<'_>, jump: Option<usize>) -> Option<u32> {
    let font = FontId::monospace(theme::READING_SIZE);
    let count = sheet.document.line_count();
    let numbers_width = line_numbers_width(count);
    let height = ui.fonts_mut(|fonts| fonts.row_height(&font));
    ui.painter()
        .rect_filled(ui.max_rect(), 0.0, theme::CODE_GROUND);
    ui.spacing_mut().item_spacing.y = 0.0;
    let mut area = ScrollArea::both()
        .auto_shrink([false, false])
        .id_salt("lines");
    let running_line = (sheet.margin.running_line).filter(|_| sheet.shows_running_line);
    let running_index = running_line.map(|line| line.saturating_sub(1) as usize);
    let mut clicked_line = None;
    if let Some(line) = jump.or(running_index) {
        let above = ui.available_height() / 2.0;
        area = area.vertical_scroll_offset((line as f32 * height - above).max(0.0));
    }
    area.show_rows(ui, height, count, |ui, rows| {
        for index in rows {
            let mut job = LayoutJob::default();
            let wrong = find_alarm_ranges(sheet.marks.1, index);
            paint::append_line(&mut job, sheet.document.line(index), &font, &wrong);
            let galley = ui.fonts_mut(|fonts| fonts.layout_job(job));
            let size = vec2(numbers_width + galley.size().x, height);
            let (rect, _) = ui.allocate_exact_size(size, egui::Sense::HOVER);
            let at = rect.left_top() + vec2(numbers_width, 0.0);
            ui.painter().galley(at, galley, theme::BRIGHT_TEXT);
            let column = Rect::from_min_size(rect.min, vec2(numbers_width - 4.0, height));
            draw_line_number(ui, index + 1, column, &sheet.margin);
            let id = ui.scope_id().with(("line number", index));
            if ui.interact(column, id, egui::Sense::CLICK).clicked() {
                clicked_line = Some(index as u32 + 1);
            }
        }
    });
    clicked_line
}

/// The lines, from 1, for which the user has chosen an entry of the context menu.
#[derive(Default)]
struct MenuChoice {
    restart_line: Option<u32>,
    breakpoint_line: Option<u32>,
    opens_form: bool,
}

/// Draws the context menu of the text, for the line of the cursor, and returns the chosen entries.
fn show_menu(document: &ProgramDocument, response: &Response, language: Language) -> MenuChoice {
    let mut choice = MenuChoice::default();
    response.context_menu(|ui| {
        let cursor = cursor_range(ui.ctx()).map_or(0, |range| range.start);
        let line = document.line_at(document.byte_of_character(cursor)) as u32 + 1;
        let entries = [
            (say::restart_menu(line), &mut choice.restart_line),
            (say::breakpoint_at_line(line), &mut choice.breakpoint_line),
        ];
        for (name, chosen) in entries {
            if ui.button(name.text(language)).clicked() {
                *chosen = Some(line);
                ui.close();
            }
        }
        if ui.button(say::program_form().text(language)).clicked() {
            choice.opens_form = true;
            ui.close();
        }
    });
    choice
}

fn line_numbers_width(lines: usize) -> f32 {
    let digits = lines.max(100).to_string().len();
    DIGIT_WIDTH * digits as f32 + NUMBERS_MARGIN + 2.0 * MARK_SIZE
}

/// Draws line numbers and marks beside the visible rows. They do not move when long lines are
/// scrolled. Returns the line, from 1, whose number was clicked.
fn draw_margin(
    ui: &Ui,
    galley: &Galley,
    origin: Pos2,
    width: f32,
    marks: &MarginMarks,
    language: Language,
) -> Option<u32> {
    let clip = ui.clip_rect();
    let column = Rect::from_min_max(
        clip.left_top(),
        pos2(clip.left() + width - 4.0, clip.bottom()),
    );
    ui.painter()
        .rect_filled(column, 0.0, theme::LINE_NUMBER_GROUND);
    let response = ui.interact(
        column,
        ui.scope_id().with("line numbers"),
        egui::Sense::CLICK,
    );
    let clicked_y = (response.clicked())
        .then(|| response.interact_pointer_pos())
        .flatten()
        .map(|at| at.y);
    response.on_hover_text(say::breakpoint_margin_hint().text(language));
    let mut clicked_line = None;
    let mut line = 1;
    for row in &galley.rows {
        let top = origin.y + row.pos.y;
        if top > clip.bottom() {
            break;
        }
        if top + row.size.y >= clip.top() {
            let bottom = top + row.size.y;
            if clicked_y.is_some_and(|y| (top..bottom).contains(&y)) {
                clicked_line = Some(line as u32);
            }
            let cell = Rect::from_x_y_ranges(column.x_range(), top..=bottom);
            draw_line_number(ui, line, cell, marks);
        }
        line += usize::from(row.ends_with_newline);
    }
    clicked_line
}

/// Draws a line number into its cell of the margin: a disc marks a breakpoint, an arrow the line
/// in execution.
fn draw_line_number(ui: &Ui, line: usize, cell: Rect, marks: &MarginMarks) {
    let number = line as u32;
    let painter = ui.painter();
    let center = pos2(cell.left() + MARK_SIZE, cell.center().y);
    if marks.breakpoints.contains(&number) {
        painter.circle_filled(center, MARK_SIZE / 2.0, theme::BREAKPOINT);
    }
    if marks.running_line == Some(number) {
        let half = MARK_SIZE / 2.0;
        let tip = center + vec2(MARK_SIZE + half, 0.0);
        let arrow = vec![tip + vec2(-half, -half), tip, tip + vec2(-half, half)];
        painter.add(Shape::convex_polygon(arrow, theme::ACCENT, Stroke::NONE));
    }
    let font = FontId::monospace(theme::LABEL_SIZE);
    let at = pos2(cell.right() - NUMBERS_MARGIN / 2.0, cell.top());
    painter.text(at, Align2::RIGHT_TOP, line, font, theme::LINE_NUMBER_TEXT);
}

/// Index of the character at the position `at` in the window; `origin` is that of the text.
fn character_at(galley: &Galley, origin: Pos2, at: Pos2) -> usize {
    galley.cursor_from_pos(at - origin).index.0
}

/// The target of the word under the pointer, and its line from 0, if the word was clicked with
/// Ctrl.
fn find_clicked_target(
    ui: &Ui,
    document: &ProgramDocument,
    response: &Response,
    galley: &Galley,
    origin: Pos2,
) -> Option<(JumpTarget, usize)> {
    let command = ui.input(|input| input.modifiers.command);
    if !response.clicked() || !command {
        return None;
    }
    let at = response.interact_pointer_pos()?;
    let byte = document.byte_of_character(character_at(galley, origin, at));
    let line = document.line_at(byte);
    let (text, column) = (document.line(line), byte - document.line_start(line));
    let span = spans(text)
        .into_iter()
        .find(|span| span.range.contains(&column))?;
    JumpTarget::from_word(text, &span).map(|target| (target, line))
}

/// Shows the meaning of the word under the pointer, and the alarms that the word raises, as a
/// hover text, and gives F1 its topic.
fn show_hover_text(
    ui: &Ui,
    document: &ProgramDocument,
    findings: &[TextFinding],
    language: Language,
    response: &Response,
    galley: &Galley,
    origin: Pos2,
) {
    let Some(at) = response.hover_pos() else {
        return;
    };
    let byte = document.byte_of_character(character_at(galley, origin, at));
    let line = document.line_at(byte);
    let (text, column) = (document.line(line), byte - document.line_start(line));
    let span = spans(text)
        .into_iter()
        .find(|span| span.range.contains(&column));
    let word = span.as_ref().and_then(|span| word_of(text, span));
    let mut lines: Vec<String> = Vec::new();
    lines.extend(
        word.as_ref()
            .and_then(word_meaning)
            .map(|meaning| meaning.text(language)),
    );
    if span.is_some_and(|span| JumpTarget::from_word(text, &span).is_some()) {
        lines.push(say::program_lead().text(language));
    }
    let character = text
        .get(..column)
        .map_or(0, |before| before.chars().count());
    let here = findings.iter().filter(|finding| finding.line == Some(line));
    for finding in here.filter(|finding| finding.columns.contains(&character)) {
        lines.push(finding.report(language).sentence(Some(language)));
    }
    // There is no word after the end of a line.
    let row = galley.pos_from_cursor(galley.cursor_from_pos(at - origin));
    let is_near = (row.center() + origin.to_vec2() - at).length() < 2.0 * theme::READING_SIZE;
    if !is_near {
        return;
    }
    if let Some(word) = &word {
        // The help window shows the code as the model in use has it.
        let topic = gsk_help::address_topic(ModelId::default(), word.address, &word.value);
        help::point_at_topic(ui, topic);
    }
    if !lines.is_empty() {
        response.clone().on_hover_text_at_pointer(lines.join("\n"));
    }
}
