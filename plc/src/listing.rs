//! Writes a ladder as text in the standard form of a listing.

use std::fmt;

use crate::directive::PlcAddress;
use crate::instruction::{Operand, Statement};
use crate::ladder::Ladder;

impl Ladder {
    /// Returns the program as an instruction list with four-digit addresses, rung and step
    /// numbers, and address names as comments. The list compiles to the same program.
    #[must_use]
    pub fn to_source(&self) -> String {
        let mut text = String::new();
        self.list_directives(&mut text);
        for rung in self.rungs() {
            text.push('\n');
            if let Some(title) = rung.title {
                text.push_str(&format!(".NET \"{title}\"\n"));
            }
            text.push_str(&format!("; rung {}, step {}\n", rung.number, rung.step));
            for statement in rung.statements {
                text.push_str(&self.annotated(statement));
                text.push('\n');
            }
        }
        text
    }

    fn list_directives(&self, text: &mut String) {
        let directives = self.directives();
        let header = &directives.header;
        let fields = [
            (".UNIT", &header.unit),
            (".AUTHOR", &header.author),
            (".VERSION", &header.version),
            (".REMARK", &header.remark),
        ];
        for (name, value) in fields.iter().filter(|(_, value)| !value.is_empty()) {
            text.push_str(&format!("{name} \"{value}\"\n"));
        }
        if directives.table_from_0 {
            text.push_str(".OPT codb0\n");
        }
        if directives.undivided {
            text.push_str(".OPT n1\n");
        }
        for comment in &directives.comments {
            let subject = comment.subject;
            let (chinese, english) = (&comment.chinese, &comment.english);
            text.push_str(&format!(".CMT {subject} \"{chinese}\" \"{english}\"\n"));
        }
        for message in &directives.messages {
            let (bit, number) = (message.bit, message.number);
            text.push_str(&format!(".MSG {bit} {number} \"{}\"\n", message.text));
        }
        for m in &directives.m_codes {
            text.push_str(&format!(".MCODE {} \"{}\"\n", m.code, m.text));
        }
        for start in &directives.start_values {
            text.push_str(&format!(".INIT {} {}\n", start.address, start.value));
        }
    }

    /// Returns the statement with the English name of its last named operand as a comment.
    fn annotated(&self, statement: &Statement) -> String {
        let line = statement.to_string();
        let names = statement.operands.iter().rev();
        let name = names
            .filter_map(|operand| match operand {
                Operand::Bit(bit) => self.comment(PlcAddress::Bit(*bit)),
                Operand::Byte(byte) => self.comment(PlcAddress::Byte(*byte)),
                _ => None,
            })
            .map(|comment| comment.english.as_str())
            .next();
        match name {
            Some(name) => format!("{line:<24} ; {name}"),
            None => line,
        }
    }
}

impl fmt::Display for PlcAddress {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            PlcAddress::Bit(bit) => bit.fmt(f),
            PlcAddress::Byte(byte) => byte.fmt(f),
        }
    }
}

impl fmt::Display for Operand {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Operand::Bit(bit) => bit.fmt(f),
            Operand::Byte(byte) => byte.fmt(f),
            Operand::Number(number) => number.fmt(f),
            Operand::Format(digits) => write!(f, "{digits:04b}"),
            Operand::Label(label) => write!(f, "L{label:04}"),
            Operand::Subprogram(number) => write!(f, "P{number:04}"),
        }
    }
}

impl fmt::Display for Statement {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.mnemonic.row().name)?;
        for operand in &self.operands {
            write!(f, " {operand}")?;
        }
        if !self.table.is_empty() {
            f.write_str(" ,")?;
        }
        for entry in &self.table {
            write!(f, " {entry}")?;
        }
        Ok(())
    }
}
