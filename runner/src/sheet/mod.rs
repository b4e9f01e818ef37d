//! The setup sheet of a program: one page of HTML for the operator at the lathe, A4 when printed.
//!
//! It contains its pictures and loads nothing.

mod qr_code;
mod tool_picture;

use std::borrow::Cow;

use gsk_core::memory::Offsets;
use gsk_core::model::ModelId;
use gsk_core::program::Program;
use gsk_messages::{Language, Message, say};
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::measure::Feature;
use gsk_workpiece::stock::StockForm;
use gsk_workpiece::tool::{Holder, Insert, Tool};

use crate::html::HtmlWriter;
use crate::report::{AlarmReport, ProgramReport, TimeReport, ToolTimeReport, feature_message};
use crate::text_format::{format_time, short_description};
use crate::times::TimeUse;

/// Greatest number of program lines that a setup sheet prints.
const MAX_LINES: usize = 5000;
/// The CSS style sheet of the page.
const STYLE: &str = include_str!("style.css");

/// The data that a setup sheet shows.
#[derive(Clone, Debug)]
pub struct SetupSheet<'a> {
    /// Name of the program file.
    pub file_name: &'a str,
    /// The control model that reads the program.
    pub model: ModelId,
    /// The program whose lines the sheet prints.
    pub program: &'a Program,
    /// The subprograms that it calls, by their names, in the order of first use.
    pub subprograms: Vec<(String, &'a Program)>,
    /// The SHA-256 of the program file, hexadecimal.
    pub hash: &'a str,
    /// Report of the program check, with the measured part.
    pub report: &'a ProgramReport,
    /// The job: stock, clamping and tools.
    pub job: &'a Job,
    /// The tool offsets of the control.
    pub offsets: &'a Offsets,
    /// Work zero in machine coordinates; `None` if it is set at the lathe.
    pub zero: Option<DiameterPoint>,
    /// The part with its dimensions, as SVG.
    pub part_picture: &'a str,
    /// The tool path with the numbers of its blocks, as SVG.
    pub path_picture: &'a str,
}

impl SetupSheet<'_> {
    /// Writes the setup sheet as an HTML page in a language.
    pub fn render(&self, language: Language) -> String {
        let mut page = HtmlWriter::new(language);
        self.write_head(&mut page);
        self.write_warnings(&mut page);
        page.heading(&say::sheet_part());
        page.picture(self.part_picture);
        self.write_features(&mut page);
        page.raw("<div class=\"pair\"><section>");
        page.heading(&say::sheet_stock());
        self.write_stock(&mut page);
        page.raw("</section><section>");
        page.heading(&say::sheet_zero());
        self.write_zero(&mut page);
        page.heading(&say::sheet_times());
        self.write_times(&mut page);
        page.raw("</section></div>");
        page.heading(&say::sheet_tools());
        self.write_tools(&mut page);
        page.heading(&say::sheet_path());
        page.picture(self.path_picture);
        page.heading(&say::sheet_program());
        write_program(&mut page, self.program);
        for (name, subprogram) in &self.subprograms {
            page.heading(&say::sheet_subprogram(name));
            write_program(&mut page, subprogram);
        }
        page.finish()
    }

    fn write_head(&self, page: &mut HtmlWriter) {
        let title = format!("{} {}", page.text(&say::sheet_title()), self.file_name);
        page.begin(&title, STYLE);
        page.raw("<header><div><h1>");
        page.escaped(&title);
        page.raw("</h1><p>");
        if let Some(number) = self.program.number() {
            page.escaped(&self.model.record().program_naming().name(number));
            page.raw(" · ");
        }
        page.message(&say::sheet_total_time(format_time(self.report.time_s)));
        page.raw("</p><p class=\"hash\">SHA-256 ");
        page.escaped(self.hash);
        page.raw("</p><p class=\"hint\">");
        page.message(&say::sheet_hash_hint());
        page.raw("</p></div>");
        let code = format!("gsk980td:{}:sha256:{}", self.file_name, self.hash);
        page.raw(&qr_code::render_code(&code).unwrap_or_default());
        page.raw("</header>");
    }

    fn write_warnings(&self, page: &mut HtmlWriter) {
        let (report, language) = (self.report, page.language());
        let mut lines: Vec<String> = Vec::new();
        let path = report.path.as_ref();
        let further = path.map_or(&[][..], |path| path.more_alarms.as_slice());
        let alarms = report.alarm.iter().chain(further);
        lines.extend(alarms.map(|alarm: &AlarmReport| alarm.sentence(Some(language))));
        lines.extend(
            report
                .warnings
                .iter()
                .map(|warning| warning.sentence.clone()),
        );
        let part = report.part.as_ref();
        let collisions = part.map_or(&[][..], |part| part.collisions.as_slice());
        lines.extend(collisions.iter().map(|it| it.message().text(language)));
        if part.is_some_and(|part| part.job.is_none()) {
            lines.push(page.text(&say::sheet_guessed()));
        }
        page.heading(&say::sheet_warnings());
        if lines.is_empty() {
            page.raw("<p>");
            page.message(&say::sheet_no_warnings());
            page.raw("</p>");
            return;
        }
        page.raw("<ul class=\"warnings\">");
        for line in lines {
            page.raw("<li>");
            page.escaped(&line);
            page.raw("</li>");
        }
        page.raw("</ul>");
    }

    fn write_features(&self, page: &mut HtmlWriter) {
        let features = self.report.part.as_ref();
        let features = features.map_or(&[][..], |part| part.features.as_slice());
        if features.is_empty() {
            return;
        }
        page.raw("<ol class=\"features\">");
        for feature in features {
            let message: Message = feature_message(feature);
            page.raw(match feature {
                Feature::Thread { .. } => "<li class=\"thread\">",
                _ => "<li>",
            });
            page.message(&message);
            page.raw("</li>");
        }
        page.raw("</ol>");
    }

    fn write_stock(&self, page: &mut HtmlWriter) {
        let stock = &self.job.stock;
        page.begin_table(&[]);
        let form = match stock.form {
            StockForm::Bar { .. } => say::sheet_bar(),
            StockForm::Tube { .. } => say::sheet_tube(),
            StockForm::Contour { .. } => say::sheet_contour(),
        };
        let form = page.text(&form);
        page.row(&[&page.text(&say::job_stock()), &form]);
        let mut add = |name: Message, value: f64| {
            let name = page.text(&name);
            page.row(&[&name, &millimetres(value)]);
        };
        add(say::stock_word_diameter(), stock.radius() * 2.0);
        match &stock.form {
            StockForm::Tube { bore, .. } | StockForm::Contour { bore, .. } if bore.0 > 0.0 => {
                add(say::stock_word_bore(), bore.0);
            }
            _ => {}
        }
        add(say::stock_word_length(), stock.length);
        add(say::stock_word_overhang(), stock.overhang);
        add(say::stock_word_face(), stock.face);
        add(say::stock_word_chuck(), stock.chuck.diameter.0);
        add(say::stock_word_jaws(), stock.chuck.jaws);
        if let Some(tailstock) = stock.tailstock {
            add(say::stock_word_quill(), tailstock.quill.0);
            add(say::stock_word_center(), tailstock.center.0);
        }
        page.end_table();
    }

    fn write_zero(&self, page: &mut HtmlWriter) {
        page.raw("<p>");
        match self.zero {
            Some(zero) => page.message(&say::sheet_zero_known(zero.x.0, zero.z)),
            None => page.message(&say::sheet_zero_by_hand()),
        }
        page.raw("</p>");
        let lines = 1..=self.program.line_count();
        let mut codes = lines.map(|line| (line, split_comments(self.program.line(line).trim()).0));
        if let Some((line, block)) = codes.find(|(_, code)| sets_coordinates(code, self.model)) {
            page.raw("<p>");
            page.message(&say::sheet_zero_by_block(line, block));
            page.raw("</p>");
        }
    }

    fn write_times(&self, page: &mut HtmlWriter) {
        page.begin_table(&[]);
        let times = self.report.path.as_ref();
        let times = times.map_or_else(TimeReport::default, |path| path.times);
        for (time_use, seconds) in TimeUse::ALL.into_iter().zip([
            times.rapid,
            times.feed,
            times.thread,
            times.dwell,
            times.other,
        ]) {
            if seconds > 0.0 {
                let name = page.text(&time_use.message());
                page.row(&[&name, &format_time(seconds)]);
            }
        }
        let name = page.text(&say::sheet_total());
        page.row(&[&name, &format_time(self.report.time_s)]);
        page.end_table();
    }

    fn write_tools(&self, page: &mut HtmlWriter) {
        let columns = [
            say::sheet_tool(),
            say::sheet_tool_kind(),
            say::sheet_holder(),
            say::sheet_offset(),
            say::sheet_offset_values(),
            say::sheet_tool_time(),
            say::tool_picture(),
        ];
        page.begin_table(&columns);
        let times = self.report.path.as_ref();
        let times = times.map_or(&[][..], |path| path.tool_times.as_slice());
        for (number, tool) in &self.job.tools {
            let uses = times
                .iter()
                .filter(|time| tool_number(time) == Some(*number));
            let uses: Vec<&ToolTimeReport> = uses.collect();
            let offset = uses.first().and_then(|time| offset_number(time));
            let seconds: f64 = uses.iter().map(|time| time.seconds.total_s()).sum();
            let row = self.offsets.get(offset.unwrap_or(0));
            let values = offset.map_or_else(String::new, |_| {
                format!(
                    "X\u{a0}{:.3} Z\u{a0}{:.3} R\u{a0}{:.3} T\u{a0}{}",
                    row.x, row.z, row.r, row.t
                )
            });
            let kind = page.text(&short_description(tool));
            // The short text of a turning tool names its nose.
            let nose = page.text(&match tool.insert {
                Insert::Grooving { .. } | Insert::Threading { .. } => {
                    say::sheet_nose(tool.nose(), tool.tip)
                }
                Insert::Turning { .. } | Insert::Drill { .. } => say::sheet_tip(tool.tip),
            });
            let cells = [
                format!("T{number:02}"),
                format!("{kind}; {nose}"),
                self.holder_text(page, tool),
                offset.map_or_else(|| "–".to_owned(), |offset| format!("{offset:02}")),
                values,
                format_time(seconds),
            ];
            page.tool_row(&cells, &tool_picture::render_tool(tool));
        }
        page.end_table();
    }

    fn holder_text(&self, page: &HtmlWriter, tool: &Tool) -> String {
        let (name, size, length) = match tool.holder {
            Holder::None => return page.text(&say::tool_holder_none()),
            Holder::Shank { width, length } => (say::tool_holder_shank(), width, length),
            Holder::Bar { diameter, length } => (say::tool_holder_bar(), diameter, length),
        };
        format!("{} {size} × {length} mm", page.text(&name))
    }
}

fn write_program(page: &mut HtmlWriter, program: &Program) {
    page.raw("<ol class=\"program\">");
    let text = program.text();
    for line in text.lines().take(MAX_LINES) {
        page.raw("<li>");
        let (code, comments) = split_comments(line);
        page.escaped(&code);
        if !comments.is_empty() {
            page.raw(" <em>");
            page.escaped(&comments);
            page.raw("</em>");
        }
        page.raw("</li>");
    }
    page.raw("</ol>");
    let left_out = text.lines().count().saturating_sub(MAX_LINES);
    if left_out > 0 {
        page.raw("<p>");
        page.message(&say::sheet_lines_left_out(left_out));
        page.raw("</p>");
    }
}

fn millimetres(value: f64) -> String {
    format!("{:.3}", value + 0.0)
}

/// Returns the tool number of a time report: the first half of its T digits; `None` if they are
/// invalid.
fn tool_number(time: &ToolTimeReport) -> Option<u8> {
    time.tool.get(..time.tool.len() / 2)?.parse().ok()
}

/// Returns the offset number of a time report: the second half of its T digits; `None` if they are
/// invalid.
fn offset_number(time: &ToolTimeReport) -> Option<u8> {
    time.tool.get(time.tool.len() / 2..)?.parse().ok()
}

/// Whether a block sets coordinates: G50 with an axis, on the Huaxing G92. G50 with S limits the
/// spindle.
fn sets_coordinates(code: &str, model: ModelId) -> bool {
    let Some(number) = model.record().coordinate_code() else {
        return false;
    };
    let after = code.split(&format!("G{number}")).nth(1);
    let is_whole = after.is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()));
    is_whole && code.contains(['X', 'Z', 'U', 'W'])
}

/// Splits a line into its words (first) and its comments in brackets (second).
fn split_comments(line: &str) -> (Cow<'_, str>, Cow<'_, str>) {
    match line.split_once('(') {
        Some((code, rest)) if rest.trim_end().ends_with([')', ';']) => {
            let comment = rest.trim_end().trim_end_matches(';').trim_end();
            match comment.strip_suffix(')') {
                Some(comment) if !comment.contains(['(', ')']) => {
                    (code.trim_end().into(), comment.into())
                }
                _ => (line.into(), Cow::default()),
            }
        }
        _ => (line.into(), Cow::default()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::machining::Machining;
    use crate::report::{PartReport, check_program};
    use gsk_core::setup::Setup;
    use gsk_workpiece::stock::Stock;

    const PROGRAM: &str = "O0031;\nG50 X100 Z100;\nM03 S500;\nT0101 (ROUGH <1>);\nG00 X38 Z2;\n\
        G98 G01 Z-30 F100;\nG00 X100 Z100;\nM30;\n";

    fn sheet_text(language: Language) -> String {
        let mut setup = Setup::default();
        let program = Program::new(PROGRAM);
        setup.memory.programs.open_external(program.clone());
        let mut job = Job::new(Stock::bar(40.0, 1.0, 60.0));
        job.tools.insert(1, Tool::turning());
        job.tools.insert(4, Tool::drill(8.0));
        let machining = Machining::new(job.clone());
        let spoken = Some(language);
        let mut report = check_program("p", &setup, spoken, &mut |_| {}, &mut |_| true);
        report.part = Some(PartReport::new(&machining, None, true, spoken));
        let subprogram = Program::new("O1031;\nG00 U-1 (GROOVE);\nM99;\n");
        let sheet = SetupSheet {
            file_name: "a&b.CNC",
            model: ModelId::Gsk980td,
            program: &program,
            subprograms: vec![("O1031".to_owned(), &subprogram)],
            hash: "00ff",
            report: &report,
            job: &job,
            offsets: &setup.memory.offsets,
            zero: None,
            part_picture: "<svg id=\"part\"></svg>",
            path_picture: "<svg id=\"path\"></svg>",
        };
        sheet.render(language)
    }

    #[test]
    fn a_sheet_has_all_its_parts_in_both_languages() {
        for (language, words) in [
            (Language::En, ["Setup sheet", "shank 20", "bar", "Warnings"]),
            (Language::Zh, ["加工准备单", "方刀杆 20", "圆棒", "警告"]),
        ] {
            let text = sheet_text(language);
            for part in words.into_iter().chain([
                "a&amp;b.CNC",
                "O0031",
                "G50 X100 Z100;",
                "O1031</h2>",
                "<em>GROOVE</em>",
                "<em>ROUGH &lt;1&gt;</em>",
                "id=\"part\"",
                "id=\"path\"",
                "class=\"qr\"",
                "00ff",
                ">T01<",
                ">T04<",
                "size: A4",
            ]) {
                assert!(text.contains(part), "{part}\n{text}");
            }
            assert_eq!(
                text.matches("<section>").count(),
                text.matches("</section>").count()
            );
            assert_eq!(text.matches("class=\"tool\"").count(), 2);
            assert!(
                !text.contains("http://") && !text.contains("https://"),
                "{text}"
            );
        }
    }

    #[test]
    fn a_speed_limit_sets_no_coordinates() {
        let blocks = [
            "G50 X100 Z100;",
            "N5G50Z20",
            "G50 S1500;",
            "G500 X1",
            "G00 X50",
        ];
        let found = blocks.map(|block| sets_coordinates(block, ModelId::Gsk980td));
        assert_eq!(found, [true, true, false, false, false]);
        let found = blocks.map(|block| sets_coordinates(block, ModelId::Hx31));
        assert_eq!(found, [false; 5]);
        assert!(sets_coordinates("N10 G92 X100 Z100", ModelId::Hx31));
    }

    #[test]
    fn comments_are_set_apart() {
        let split = |line| {
            let (code, comment) = split_comments(line);
            (code.into_owned(), comment.into_owned())
        };
        let pair = |code: &str, comment: &str| (code.to_owned(), comment.to_owned());
        assert_eq!(split("G00 X1 (a b);"), pair("G00 X1", "a b"));
        assert_eq!(split("(a) G00 (b)"), pair("(a) G00 (b)", ""));
        assert_eq!(split("G01 Z-1;"), pair("G01 Z-1;", ""));
    }
}
