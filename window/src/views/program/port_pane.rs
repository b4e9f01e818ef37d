//! The pane that ports a program of another control: both texts side by side, block by block.

use std::ops::Range;

use egui::{Checkbox, ComboBox, Panel, RichText, ScrollArea, Ui};
use gsk_messages::{Language, say};
use gsk_port::{
    DialectGuess, ForeignDialect, PlainNumbers, PortOptions, PortedProgram, guess_dialect,
    port_program,
};

use crate::focus;
use crate::theme;
use crate::views::{bar_frame, plain_frame, side_frame};

/// Height of the list of changes, points.
const FINDINGS_HEIGHT: f32 = 150.0;
/// Share of the width that the foreign text has.
const FOREIGN_SHARE: f32 = 0.5;
/// Width of the line numbers, points.
const NUMBER_WIDTH: f32 = 40.0;

/// A line of the foreign text beside a line of the ported one; either may be missing.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
struct PortRow {
    foreign: Option<(u32, Range<usize>)>,
    ported: Option<Range<usize>>,
    is_changed: bool,
    is_refused: bool,
}

/// A program that is being ported.
struct OpenPort {
    foreign: String,
    dialect: ForeignDialect,
    options: PortOptions,
    ported: PortedProgram,
    rows: Vec<PortRow>,
}

impl OpenPort {
    fn new(foreign: String, dialect: ForeignDialect, options: PortOptions) -> Self {
        let ported = port_program(&foreign, dialect, options);
        let rows = pair_lines(&foreign, &ported);
        Self {
            foreign,
            dialect,
            options,
            ported,
            rows,
        }
    }
}

/// The pane, open or closed, and the offer to open it.
#[derive(Default)]
pub struct PortPane {
    open: Option<OpenPort>,
    /// The guess for the text with this revision.
    guess: Option<(u64, Option<DialectGuess>)>,
}

impl PortPane {
    /// Whether the pane is open.
    pub const fn is_open(&self) -> bool {
        self.open.is_some()
    }

    /// Opens the pane for a text, with the dialect for which it seems to be written.
    pub fn open(&mut self, text: &str) {
        let guess = guess_dialect(text).map(|guess| guess.dialect);
        let dialect = guess.unwrap_or(ForeignDialect::Fanuc0t);
        self.open = Some(OpenPort::new(
            text.to_owned(),
            dialect,
            PortOptions::default(),
        ));
    }

    /// Draws the offer to port a text that seems to be written for another control. Returns true
    /// if the user accepts it.
    pub fn show_offer(
        &mut self,
        ui: &mut Ui,
        revision: u64,
        text: &str,
        language: Language,
    ) -> bool {
        if self
            .guess
            .as_ref()
            .is_none_or(|(known, _)| *known != revision)
        {
            self.guess = Some((revision, guess_dialect(text)));
        }
        let Some((_, Some(guess))) = &self.guess else {
            return false;
        };
        let mut is_accepted = false;
        ui.horizontal_wrapped(|ui| {
            let offer = say::port_offer(guess.line, &guess.word, guess.dialect.name());
            ui.label(RichText::new(offer.text(language)).color(theme::WARNING));
            is_accepted = ui.button(say::port_open().text(language)).clicked();
        });
        is_accepted
    }

    /// Draws the open pane. Returns the ported text if the user takes it over.
    pub fn show(&mut self, ui: &mut Ui, language: Language) -> Option<String> {
        let open = self.open.as_mut()?;
        let mut taken = None;
        let mut is_closed = false;
        Panel::top("port bar").frame(bar_frame()).show(ui, |ui| {
            show_options(ui, open, language);
        });
        Panel::bottom("port buttons")
            .frame(bar_frame())
            .show(ui, |ui| {
                ui.horizontal_wrapped(|ui| {
                    if ui.button(say::port_take_over().text(language)).clicked() {
                        taken = Some(open.ported.text.clone());
                    }
                    is_closed = ui.button(say::port_close().text(language)).clicked();
                });
            });
        focus::skip_resize_edge(ui, "port findings");
        Panel::bottom("port findings")
            .frame(side_frame())
            .resizable(true)
            .default_size(FINDINGS_HEIGHT)
            .min_size(60.0)
            .show(ui, |ui| show_findings(ui, &open.ported, language));
        egui::CentralPanel::default()
            .frame(plain_frame().inner_margin(egui::Margin::symmetric(8, 0)))
            .show(ui, |ui| show_rows(ui, open));
        if is_closed || taken.is_some() {
            self.open = None;
        }
        taken
    }
}

/// Draws the dialect and the settings of the other control; ports again if one has changed.
fn show_options(ui: &mut Ui, open: &mut OpenPort, language: Language) {
    let (mut dialect, mut options) = (open.dialect, open.options);
    ui.horizontal_wrapped(|ui| {
        let label = ui.label(say::port_dialect().text(language));
        let choice = ComboBox::from_id_salt("port dialect")
            .selected_text(dialect.name())
            .show_ui(ui, |ui| {
                for it in ForeignDialect::ALL {
                    ui.selectable_value(&mut dialect, it, it.name());
                }
            });
        choice.response.labelled_by(label.id);
        let name = say::port_inch().text(language);
        ui.add(Checkbox::new(&mut options.starts_in_inches, name));
        let mut is_written = options.plain_numbers == Some(PlainNumbers::AsWritten);
        let name = say::port_written().text(language);
        if ui.checkbox(&mut is_written, name).changed() {
            options.plain_numbers = is_written.then_some(PlainNumbers::AsWritten);
        }
    });
    if (dialect, options) != (open.dialect, open.options) {
        *open = OpenPort::new(std::mem::take(&mut open.foreign), dialect, options);
    }
}

/// Draws the summary and the list of changes and refused blocks.
fn show_findings(ui: &mut Ui, ported: &PortedProgram, language: Language) {
    let refused = ported.findings.iter().filter(|it| it.is_refused).count();
    let (summary, color) = match refused {
        0 => (say::ported_complete(ported.findings.len()), theme::SUCCESS),
        _ => (say::ported_incomplete(refused), theme::ERROR_TEXT),
    };
    ui.label(RichText::new(summary.text(language)).color(color));
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    area.show(ui, |ui| {
        for finding in &ported.findings {
            let message = finding.message().text(language);
            let text = RichText::new(format!("{}: {message}", finding.line));
            ui.label(match finding.is_refused {
                true => text.color(theme::ERROR_TEXT),
                false => text,
            });
        }
    });
}

/// Draws both texts, each foreign line beside the lines that it became.
fn show_rows(ui: &mut Ui, open: &OpenPort) {
    let height = ui.text_style_height(&egui::TextStyle::Monospace);
    let width = ui.available_width();
    let column = (width * FOREIGN_SHARE - NUMBER_WIDTH).max(NUMBER_WIDTH);
    let area = ScrollArea::vertical().auto_shrink([false, false]);
    area.show_rows(ui, height, open.rows.len(), |ui, shown| {
        for row in open.rows.get(shown).unwrap_or_default() {
            ui.horizontal(|ui| {
                let (number, foreign) = match &row.foreign {
                    Some((line, bytes)) => (line.to_string(), &open.foreign[bytes.clone()]),
                    None => (String::new(), ""),
                };
                let ported = row.ported.clone().map_or("", |it| &open.ported.text[it]);
                let color = match (row.is_refused, row.is_changed) {
                    (true, _) => Some(theme::ERROR_TEXT),
                    (false, true) => Some(theme::WARNING),
                    (false, false) => None,
                };
                let cell = |ui: &mut Ui, width: f32, text: RichText| {
                    let size = egui::vec2(width, height);
                    let layout = egui::Layout::left_to_right(egui::Align::Center);
                    ui.allocate_ui_with_layout(size, layout, |ui| {
                        ui.set_min_size(size);
                        ui.add(egui::Label::new(text.monospace()).truncate());
                    });
                };
                cell(ui, NUMBER_WIDTH, RichText::new(number).weak());
                cell(ui, column, RichText::new(foreign));
                let text = RichText::new(ported);
                cell(
                    ui,
                    column,
                    color.map_or(text.clone(), |color| text.color(color)),
                );
            });
        }
    });
}

/// Pairs each line of the foreign text with the lines that it became.
fn pair_lines(foreign: &str, ported: &PortedProgram) -> Vec<PortRow> {
    let theirs = line_ranges(foreign);
    let ours = line_ranges(&ported.text);
    let is_refused = |line: u32| {
        let mut findings = ported.findings.iter();
        findings.any(|finding| finding.is_refused && finding.line == line)
    };
    let mut rows = Vec::with_capacity(ours.len());
    let mut at = 0;
    for (line, bytes) in (1..).zip(theirs) {
        let end = ported.source_lines[at..]
            .iter()
            .position(|source| *source != line)
            .map_or(ported.source_lines.len(), |count| at + count);
        let mut became = ours[at.min(ours.len())..end.min(ours.len())]
            .iter()
            .cloned();
        let text = &foreign[bytes.clone()];
        let mut source = Some((line, bytes));
        loop {
            let next = became.next();
            if source.is_none() && next.is_none() {
                break;
            }
            let is_same = next
                .as_ref()
                .is_some_and(|it| &ported.text[it.clone()] == text);
            rows.push(PortRow {
                foreign: source.take(),
                ported: next,
                is_changed: !is_same,
                is_refused: is_refused(line),
            });
        }
        at = end;
    }
    rows
}

/// Returns the bytes of each line of a text, without its end.
fn line_ranges(text: &str) -> Vec<Range<usize>> {
    let mut begin = 0;
    let mut ranges = Vec::new();
    for line in text.split_inclusive('\n') {
        let content = line.trim_end_matches(['\n', '\r']).len();
        ranges.push(begin..begin + content);
        begin += line.len();
    }
    ranges
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_foreign_line_is_beside_its_blocks() {
        let foreign = "G99\nG71 P1 Q2 D2000 F.2\nG31 Z1.\n".to_owned();
        let dialect = ForeignDialect::Fanuc10t;
        let open = OpenPort::new(foreign, dialect, PortOptions::default());
        let shown = |row: &PortRow| {
            let foreign = row.foreign.clone();
            let foreign = foreign.map(|(line, bytes)| format!("{line} {}", &open.foreign[bytes]));
            let ported = row
                .ported
                .clone()
                .map_or("", |bytes| &open.ported.text[bytes]);
            let foreign = foreign.unwrap_or_default();
            format!(
                "{foreign} | {ported}{}",
                if row.is_refused { " !" } else { "" }
            )
        };
        let rows: Vec<String> = open.rows.iter().map(shown).collect();
        assert_eq!(
            rows,
            [
                "1 G99 | G99",
                "2 G71 P1 Q2 D2000 F.2 | G71 U2. R0.5",
                " | G71 P1 Q2 F.2",
                "3 G31 Z1. | G65 H99 P0 (G31 Z1.) !",
            ]
        );
        assert!(!open.rows[0].is_changed && open.rows[1].is_changed);
    }
}
