//! Colours the words of a program text.

use std::ops::Range;

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, Stroke};

use super::check::TextFinding;
use crate::theme;
use gsk_language::words::{SpanKind, spans};

/// The colour in which a span of program text is drawn, for the dark theme.
const fn span_color(kind: SpanKind) -> Color32 {
    match kind {
        SpanKind::Name => theme::CODE_NAME,
        SpanKind::Code => theme::CODE_G,
        SpanKind::Function => theme::CODE_FUNCTION,
        SpanKind::Setting => theme::CODE_SETTING,
        SpanKind::Axis => theme::CODE_AXIS,
        SpanKind::Other => theme::CODE_OTHER,
        SpanKind::Statement => theme::CODE_STATEMENT,
        SpanKind::Comment => theme::CODE_COMMENT,
        SpanKind::Mark => theme::CODE_MARK,
        SpanKind::Foreign => theme::CODE_ALARM_TEXT,
    }
}

/// Appends a coloured line to a layout job. `alarm_ranges`: ranges of characters that raise
/// alarms.
pub fn append_line(job: &mut LayoutJob, text: &str, font: &FontId, alarm_ranges: &[Range<usize>]) {
    let plain = |color| TextFormat::simple(font.clone(), color);
    let mut last = 0;
    for span in spans(text) {
        let characters = text[..span.range.start].chars().count();
        let mut format = plain(span_color(span.kind));
        if alarm_ranges.iter().any(|range| range.contains(&characters)) {
            format.underline = Stroke::new(1.5, theme::CODE_ALARM_TEXT);
            format.background = theme::CODE_ALARM_GROUND;
        }
        if last < span.range.start {
            job.append(
                &text[last..span.range.start],
                0.0,
                plain(span_color(SpanKind::Axis)),
            );
        }
        job.append(&text[span.range.clone()], 0.0, format);
        last = span.range.end;
    }
    if last < text.len() {
        job.append(&text[last..], 0.0, plain(span_color(SpanKind::Axis)));
    }
}

/// Colours a whole text and keeps the layout until text or findings change.
#[derive(Default)]
pub struct TextColorizer {
    job: LayoutJob,
    /// The revision of the text whose findings are underlined; `None` without findings.
    marked_revision: Option<u64>,
}

impl TextColorizer {
    /// Lays out the coloured text. `marks`: the revision that was checked and its findings.
    pub fn layout_text(
        &mut self,
        text: &str,
        font: &FontId,
        marks: (Option<u64>, &[TextFinding]),
    ) -> LayoutJob {
        let (marked, findings) = marks;
        if self.job.text != text || self.marked_revision != marked {
            self.marked_revision = marked;
            self.job = LayoutJob::default();
            let plain = TextFormat::simple(font.clone(), span_color(SpanKind::Axis));
            for (index, line_text) in text.split('\n').enumerate() {
                if index > 0 {
                    self.job.append("\n", 0.0, plain.clone());
                }
                append_line(
                    &mut self.job,
                    line_text,
                    font,
                    &find_alarm_ranges(findings, index),
                );
            }
        }
        self.job.clone()
    }
}

/// The ranges of characters that raise alarms in a line, whose index counts from 0.
pub fn find_alarm_ranges(findings: &[TextFinding], line: usize) -> Vec<Range<usize>> {
    let here = findings.iter().filter(|finding| finding.line == Some(line));
    here.map(|finding| finding.columns.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_text_is_lost_in_its_colours() {
        let text = "O0001 (车削)\n\nN10  G1 X2? ;\n  ";
        let mut painter = TextColorizer::default();
        let job = painter.layout_text(text, &FontId::monospace(theme::READING_SIZE), (None, &[]));
        assert_eq!(job.text, text);
        let mut line_job = LayoutJob::default();
        let wrong: Vec<Range<usize>> = core::iter::once(3..5).collect();
        append_line(
            &mut line_job,
            "G1 X2",
            &FontId::monospace(theme::READING_SIZE),
            &wrong,
        );
        let lined: Vec<bool> = (line_job.sections.iter())
            .map(|section| section.format.underline.width > 0.0)
            .collect();
        assert_eq!(lined, [false, false, true]);
    }
}
