//! The text field: editable with colours, line numbers and hover texts, or read-only if the
//! text is too large.

use std::ops::Range;

use egui::text::{CCursor, CCursorRange, LayoutJob};
use egui::text_edit::TextEditState;
use egui::{
    Align, Align2, Context, FontId, Frame, Galley, Id, Margin, Pos2, Rect, Response, ScrollArea,
    TextEdit, Ui, pos2, vec2,
};
use gsk_language::meaning::word_meaning;
use gsk_language::words::{spans, word_of};
use gsk_messages::{Language, say};

use super::check::TextFinding;
use super::document::ProgramDocument;
use super::paint::{self, TextColorizer, find_alarm_ranges};
use super::targets::JumpTarget;
use crate::theme;

/// Width of a digit of a line number, points. The constant after it is the margin beside the
/// numbers.
const DIGIT_WIDTH: f32 = 9.0;
const NUMBERS_MARGIN: f32 = 14.0;

/// What the text field draws.
pub struct EditorInputs<'a> {
    pub document: &'a mut ProgramDocument,
    /// The revision of the text that was checked, and the findings of that check.
    pub marks: (Option<u64>, &'a [TextFinding]),
    /// The language of the hover texts.
    pub language: Language,
}

/// What the user has done in the text field in a frame.
#[derive(Debug, Default)]
pub struct EditorResponse {
    pub is_changed: bool,
    /// The target of the word that was clicked with Ctrl, and the line of that word, from 0;
    /// `None` without such a click.
    pub clicked_target: Option<(JumpTarget, usize)>,
    /// The line, from 1, at whose block the user requests a restart; `None` without a request.
    pub restart_line: Option<u32>,
}

/// The widget id of the text field.
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
        let done = EditorResponse {
            is_changed: response.changed(),
            clicked_target: find_clicked_target(
                ui,
                document,
                &response,
                &output.galley,
                output.galley_pos,
            ),
            restart_line: show_menu(document, &response, language),
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
            let at = output.galley.pos_from_cursor(from);
            ui.scroll_to_rect(
                at.translate(output.galley_pos.to_vec2()),
                Some(Align::Center),
            );
        }
        draw_line_numbers(ui, &output.galley, output.galley_pos, numbers_width);
        show_hover_text(
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

/// Draws a read-only text, of which it lays out only the visible lines. `jump`: a line to
/// scroll to.
pub fn show_read_only(ui: &mut Ui, sheet: &EditorInputs<'_>, jump: Option<usize>) {
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
    if let Some(line) = jump {
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
            draw_line_number(
                ui,
                index + 1,
                pos2(
                    rect.left() + numbers_width - NUMBERS_MARGIN / 2.0,
                    rect.top(),
                ),
            );
        }
    });
}

/// The context menu of the text. Returns the line of the cursor, from 1, if the user requests a
/// restart at its block.
fn show_menu(document: &ProgramDocument, response: &Response, language: Language) -> Option<u32> {
    let mut line = None;
    response.context_menu(|ui| {
        let cursor = cursor_range(ui.ctx()).map_or(0, |range| range.start);
        let at = document.line_at(document.byte_of_character(cursor)) as u32 + 1;
        let name = say::restart_menu(at).text(language);
        if ui.button(name).clicked() {
            line = Some(at);
            ui.close();
        }
    });
    line
}

fn line_numbers_width(lines: usize) -> f32 {
    let digits = lines.max(100).to_string().len();
    DIGIT_WIDTH * digits as f32 + NUMBERS_MARGIN
}

/// Draws line numbers beside the visible rows. The numbers do not move when long lines are
/// scrolled.
fn draw_line_numbers(ui: &Ui, galley: &Galley, origin: Pos2, width: f32) {
    let clip = ui.clip_rect();
    let column = Rect::from_min_max(
        clip.left_top(),
        pos2(clip.left() + width - 4.0, clip.bottom()),
    );
    ui.painter()
        .rect_filled(column, 0.0, theme::LINE_NUMBER_GROUND);
    let mut line = 1;
    for row in &galley.rows {
        let top = origin.y + row.pos.y;
        if top > clip.bottom() {
            break;
        }
        if top + row.size.y >= clip.top() {
            draw_line_number(ui, line, pos2(column.right() - NUMBERS_MARGIN / 2.0, top));
        }
        line += usize::from(row.ends_with_newline);
    }
}

fn draw_line_number(ui: &Ui, line: usize, at: Pos2) {
    let font = FontId::monospace(theme::LABEL_SIZE);
    ui.painter()
        .text(at, Align2::RIGHT_TOP, line, font, theme::LINE_NUMBER_TEXT);
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
/// hover text.
fn show_hover_text(
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
        word.and_then(|it| word_meaning(&it))
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
    if is_near && !lines.is_empty() {
        response.clone().on_hover_text_at_pointer(lines.join("\n"));
    }
}
