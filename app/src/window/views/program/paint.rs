//! Colours the words of a program text.

use std::ops::Range;

use egui::text::{LayoutJob, TextFormat};
use egui::{Color32, FontId, Stroke};

use super::check::Finding;
use gsk_language::words::{SpanKind, spans};

/// Colour of words that raise an alarm.
pub const WRONG: Color32 = Color32::from_rgb(255, 110, 96);
const GROUND_OF_WRONG: Color32 = Color32::from_rgb(70, 28, 26);

/// The colour of a span on a dark background.
const fn color(kind: SpanKind) -> Color32 {
    match kind {
        SpanKind::Name => Color32::from_gray(140),
        SpanKind::Code => Color32::from_rgb(110, 180, 255),
        SpanKind::Function => Color32::from_rgb(255, 170, 90),
        SpanKind::Setting => Color32::from_rgb(225, 150, 230),
        SpanKind::Axis => Color32::from_rgb(240, 240, 240),
        SpanKind::Other => Color32::from_rgb(230, 215, 140),
        SpanKind::Statement => Color32::from_rgb(150, 215, 225),
        SpanKind::Comment => Color32::from_rgb(120, 190, 130),
        SpanKind::Mark => Color32::from_gray(110),
        SpanKind::Foreign => WRONG,
    }
}

/// Appends a coloured line to a layout job. `wrong`: ranges of characters that raise alarms.
pub fn line(job: &mut LayoutJob, text: &str, font: &FontId, wrong: &[Range<usize>]) {
    let plain = |color| TextFormat::simple(font.clone(), color);
    let mut last = 0;
    for span in spans(text) {
        let characters = text[..span.range.start].chars().count();
        let mut format = plain(color(span.kind));
        if wrong.iter().any(|range| range.contains(&characters)) {
            format.underline = Stroke::new(1.5, WRONG);
            format.background = GROUND_OF_WRONG;
        }
        if last < span.range.start {
            job.append(
                &text[last..span.range.start],
                0.0,
                plain(color(SpanKind::Axis)),
            );
        }
        job.append(&text[span.range.clone()], 0.0, format);
        last = span.range.end;
    }
    if last < text.len() {
        job.append(&text[last..], 0.0, plain(color(SpanKind::Axis)));
    }
}

/// The layout of a whole text, kept until text or findings change.
#[derive(Default)]
pub struct Painter {
    job: LayoutJob,
    /// The revision of the text whose findings are underlined.
    marked: Option<u64>,
}

impl Painter {
    /// The coloured text. `marks`: the revision that was checked and its findings.
    pub fn job(
        &mut self,
        text: &str,
        font: &FontId,
        marks: (Option<u64>, &[Finding]),
    ) -> LayoutJob {
        let (marked, findings) = marks;
        if self.job.text != text || self.marked != marked {
            self.marked = marked;
            self.job = LayoutJob::default();
            let plain = TextFormat::simple(font.clone(), color(SpanKind::Axis));
            for (index, piece) in text.split('\n').enumerate() {
                if index > 0 {
                    self.job.append("\n", 0.0, plain.clone());
                }
                line(&mut self.job, piece, font, &wrong_in(findings, index));
            }
        }
        self.job.clone()
    }
}

/// The ranges of characters in a line, from 0, that raise alarms.
pub fn wrong_in(findings: &[Finding], line: usize) -> Vec<Range<usize>> {
    let here = findings.iter().filter(|finding| finding.line == Some(line));
    here.map(|finding| finding.columns.clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_text_is_lost_in_its_colours() {
        let text = "O0001 (车削)\n\nN10  G1 X2? ;\n  ";
        let mut painter = Painter::default();
        let job = painter.job(text, &FontId::monospace(14.0), (None, &[]));
        assert_eq!(job.text, text);
        let mut line_job = LayoutJob::default();
        let wrong: Vec<Range<usize>> = core::iter::once(3..5).collect();
        line(&mut line_job, "G1 X2", &FontId::monospace(14.0), &wrong);
        let lined: Vec<bool> = (line_job.sections.iter())
            .map(|section| section.format.underline.width > 0.0)
            .collect();
        assert_eq!(lined, [false, false, true]);
    }
}
