//! Writes pages of HTML: setup sheets and ladders.

use gsk_messages::{Language, Message};

/// Writes one HTML page.
pub(crate) struct HtmlWriter {
    out: String,
    language: Language,
}

impl HtmlWriter {
    pub(crate) const fn new(language: Language) -> Self {
        Self {
            out: String::new(),
            language,
        }
    }

    pub(crate) const fn language(&self) -> Language {
        self.language
    }

    /// Returns the text of a message in the language of the page.
    pub(crate) fn text(&self, message: &Message) -> String {
        message.text(self.language)
    }

    /// Writes the head of the file and begins its body.
    pub(crate) fn begin(&mut self, title: &str, style: &str) {
        let code = match self.language {
            Language::Zh => "zh-CN",
            Language::En => "en",
        };
        self.raw("<!DOCTYPE html>\n<html lang=\"");
        self.raw(code);
        self.raw("\">\n<head>\n<meta charset=\"utf-8\">\n<title>");
        self.escaped(title);
        self.raw("</title>\n<style>\n");
        self.raw(style);
        self.raw("</style>\n</head>\n<body>\n");
    }

    pub(crate) fn finish(mut self) -> String {
        self.raw("</body>\n</html>\n");
        self.out
    }

    /// Writes HTML markup without changes.
    pub(crate) fn raw(&mut self, markup: &str) {
        self.out.push_str(markup);
    }

    /// Writes text with the characters replaced that HTML reserves.
    pub(crate) fn escaped(&mut self, text: &str) {
        for character in text.chars() {
            match character {
                '&' => self.raw("&amp;"),
                '<' => self.raw("&lt;"),
                '>' => self.raw("&gt;"),
                '"' => self.raw("&quot;"),
                '\0'..='\u{1f}' if character != '\t' => self.out.push('\u{fffd}'),
                _ => self.out.push(character),
            }
        }
    }

    pub(crate) fn message(&mut self, message: &Message) {
        let text = self.text(message);
        self.escaped(&text);
    }

    pub(crate) fn heading(&mut self, message: &Message) {
        self.raw("\n<h2>");
        self.message(message);
        self.raw("</h2>\n");
    }

    /// Writes a picture, given as SVG.
    pub(crate) fn picture(&mut self, svg: &str) {
        self.raw("<figure>");
        self.raw(svg);
        self.raw("</figure>");
    }

    /// Begins a table with the names of its columns, if there are any.
    pub(crate) fn begin_table(&mut self, columns: &[Message]) {
        self.raw("<table>");
        if columns.is_empty() {
            return;
        }
        self.raw("<thead><tr>");
        for column in columns {
            self.raw("<th>");
            self.message(column);
            self.raw("</th>");
        }
        self.raw("</tr></thead>\n");
    }

    pub(crate) fn row(&mut self, cells: &[&str]) {
        self.raw("<tr>");
        for cell in cells {
            self.raw("<td>");
            self.escaped(cell);
            self.raw("</td>");
        }
        self.raw("</tr>\n");
    }

    /// Writes a table row whose last cell is a picture, given as SVG.
    pub(crate) fn tool_row(&mut self, cells: &[String], svg: &str) {
        self.raw("<tr>");
        for cell in cells {
            self.raw("<td>");
            self.escaped(cell);
            self.raw("</td>");
        }
        self.raw("<td>");
        self.raw(svg);
        self.raw("</td></tr>\n");
    }

    pub(crate) fn end_table(&mut self) {
        self.raw("</table>\n");
    }
}
