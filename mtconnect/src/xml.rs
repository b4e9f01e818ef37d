//! Writes XML: escapes text, closes elements in the order in which they were opened.

use core::fmt::{Display, Write};

/// Writes an XML document, element by element.
#[derive(Debug)]
pub(crate) struct XmlWriter {
    text: String,
    /// Names of the open elements, the innermost last.
    open: Vec<&'static str>,
    /// Whether the start tag of the innermost element still accepts attributes.
    in_tag: bool,
}

impl XmlWriter {
    /// Begins an XML document with its declaration.
    pub(crate) fn new() -> Self {
        Self {
            text: "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n".to_owned(),
            open: Vec::new(),
            in_tag: false,
        }
    }

    /// Opens an element inside the innermost open one.
    pub(crate) fn open(&mut self, name: &'static str) -> &mut Self {
        self.end_tag();
        self.text.push('<');
        self.text.push_str(name);
        self.open.push(name);
        self.in_tag = true;
        self
    }

    /// Adds an attribute to the element that was opened last. It has no effect after the
    /// content of that element has begun.
    pub(crate) fn attribute(&mut self, name: &str, value: impl Display) -> &mut Self {
        if self.in_tag {
            let _ = write!(self.text, " {name}=\"");
            self.escape(value);
            self.text.push('"');
        }
        self
    }

    /// Adds an attribute to the element that was opened last, if `value` is not `None`.
    pub(crate) fn attribute_if(&mut self, name: &str, value: Option<impl Display>) -> &mut Self {
        if let Some(value) = value {
            self.attribute(name, value);
        }
        self
    }

    /// Adds text to the innermost open element.
    pub(crate) fn text(&mut self, value: impl Display) -> &mut Self {
        self.end_tag();
        self.escape(value);
        self
    }

    /// Closes the innermost open element.
    pub(crate) fn close(&mut self) -> &mut Self {
        if let Some(name) = self.open.pop() {
            if self.in_tag {
                self.text.push_str("/>");
                self.in_tag = false;
            } else {
                let _ = write!(self.text, "</{name}>");
            }
        }
        self
    }

    /// Writes a whole element that has only text as its content.
    pub(crate) fn element(&mut self, name: &'static str, value: impl Display) -> &mut Self {
        self.open(name).text(value).close()
    }

    /// Closes all open elements and returns the document as text.
    pub(crate) fn finish(mut self) -> String {
        while !self.open.is_empty() {
            self.close();
        }
        self.text.push('\n');
        self.text
    }

    fn end_tag(&mut self) {
        if self.in_tag {
            self.text.push('>');
            self.in_tag = false;
        }
    }

    fn escape(&mut self, value: impl Display) {
        // Writing to a string does not fail.
        let _ = write!(Escaper(&mut self.text), "{value}");
    }
}

/// Appends text with the characters replaced that XML reserves or does not permit.
struct Escaper<'a>(&'a mut String);

impl Write for Escaper<'_> {
    fn write_str(&mut self, text: &str) -> core::fmt::Result {
        for character in text.chars() {
            match character {
                '&' => self.0.push_str("&amp;"),
                '<' => self.0.push_str("&lt;"),
                '>' => self.0.push_str("&gt;"),
                '"' => self.0.push_str("&quot;"),
                '\t' | '\n' | '\r' => self.0.push(' '),
                '\0'..=' ' if character != ' ' => self.0.push('\u{fffd}'),
                '\u{fffe}' | '\u{ffff}' => self.0.push('\u{fffd}'),
                _ => self.0.push(character),
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_and_attributes_are_escaped() {
        let mut xml = XmlWriter::new();
        xml.open("A").attribute("b", "<\"&>\u{1}");
        xml.element("C", "G01 X<1>\n&\u{ffff}").open("D");
        let text = xml.finish();
        let (_, body) = text.split_once('\n').expect("a declaration");
        assert_eq!(
            body,
            "<A b=\"&lt;&quot;&amp;&gt;\u{fffd}\">\
             <C>G01 X&lt;1&gt; &amp;\u{fffd}</C><D/></A>\n"
        );
    }
}
