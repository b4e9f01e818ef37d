//! The tools of a workshop by their ids.

use std::collections::BTreeMap;

use gsk_messages::{Message, say};
use gsk_workpiece::job::DiameterPoint;
use gsk_workpiece::tool::Tool;
use serde::{Deserialize, Serialize};

use crate::description::{parse_description, tool_description};
use crate::life::ToolLife;

/// Greatest length of an id.
const MAX_ID_LENGTH: usize = 40;
/// Greatest number of tools.
const MAX_TOOLS: usize = 10_000;
/// The highest T number.
const MAX_STATION: u8 = 99;

/// The tools of a workshop.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ToolLibrary {
    /// The tools by their ids.
    #[serde(default)]
    pub tools: BTreeMap<String, LibraryTool>,
}

/// A tool of the library.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LibraryTool {
    /// Name or purpose, for people; empty without one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub name: String,
    /// ISO codes of insert and holder, or dimensions, as they were entered; empty without them.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub code: String,
    /// The dimensions that the simulation uses.
    pub tool: Tool,
    /// Usual T number of the tool; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub station: Option<u8>,
    /// Length of the tool, X as a diameter, mm; `None` if it was not measured.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<DiameterPoint>,
    /// Life of an edge; `None` if it is not counted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub life: Option<ToolLife>,
}

impl LibraryTool {
    /// A tool by its dimensions alone.
    pub const fn new(tool: Tool) -> Self {
        Self {
            name: String::new(),
            code: String::new(),
            tool,
            station: None,
            length: None,
            life: None,
        }
    }

    /// A tool by its description, which is kept as its code.
    ///
    /// # Errors
    /// What is wrong with the description.
    pub fn from_description(text: &str) -> Result<Self, Message> {
        let tool = parse_description(text)?;
        Ok(Self {
            code: text.split_whitespace().collect::<Vec<_>>().join(" "),
            ..Self::new(tool)
        })
    }

    /// The code if the tool still has its dimensions, else the dimensions.
    pub fn description(&self) -> String {
        let is_unchanged = parse_description(&self.code).is_ok_and(|it| it == self.tool);
        match is_unchanged {
            true => self.code.clone(),
            false => tool_description(&self.tool),
        }
    }

    /// Whether name, code or description contain a text, in any case.
    pub fn matches(&self, id: &str, text: &str) -> bool {
        let wanted = text.to_lowercase();
        [id, &self.name, &self.code, &tool_description(&self.tool)]
            .iter()
            .any(|it| it.to_lowercase().contains(&wanted))
    }

    fn check(&self) -> Result<(), Message> {
        self.tool.check()?;
        if let Some(station) = self.station.filter(|it| !(1..=MAX_STATION).contains(it)) {
            let word = say::tool_word_station();
            return Err(say::tool_value_out_of_range(word, station, 1, MAX_STATION));
        }
        let length = self.length.unwrap_or_default();
        if !length.x.0.is_finite() || !length.z.is_finite() {
            return Err(say::job_place_not_finite());
        }
        self.life.as_ref().map_or(Ok(()), ToolLife::check)
    }
}

impl ToolLibrary {
    /// Checks all tools.
    ///
    /// # Errors
    /// The first rule that is broken, with the id of the tool.
    pub fn check(&self) -> Result<(), Message> {
        if self.tools.len() > MAX_TOOLS {
            return Err(say::tool_library_full(MAX_TOOLS));
        }
        for (id, tool) in &self.tools {
            check_id(id)?;
            tool.check().map_err(|rule| say::subject_reason(id, rule))?;
        }
        Ok(())
    }

    /// Adds a tool or replaces the one with its id.
    ///
    /// # Errors
    /// The id or a value breaks a rule.
    pub fn insert(&mut self, id: &str, tool: LibraryTool) -> Result<(), Message> {
        check_id(id)?;
        tool.check().map_err(|rule| say::subject_reason(id, rule))?;
        if self.tools.len() >= MAX_TOOLS && !self.tools.contains_key(id) {
            return Err(say::tool_library_full(MAX_TOOLS));
        }
        self.tools.insert(id.to_owned(), tool);
        Ok(())
    }

    /// A free id made from a name: its letters and digits, with a number if needed.
    pub fn free_id(&self, name: &str) -> String {
        let mut base = String::new();
        for character in name.to_lowercase().chars() {
            if character.is_ascii_alphanumeric() || character == '.' {
                base.push(character);
            } else if !base.is_empty() && !base.ends_with('-') {
                base.push('-');
            }
        }
        base.truncate(MAX_ID_LENGTH - 6);
        let base = base.trim_matches(['-', '.']);
        let base = if base.is_empty() { "tool" } else { base };
        if !self.tools.contains_key(base) {
            return base.to_owned();
        }
        let numbered = (2..).map(|number: u32| format!("{base}-{number}"));
        let mut free = numbered.filter(|it| !self.tools.contains_key(it));
        free.next().unwrap_or_default()
    }
}

fn check_id(id: &str) -> Result<(), Message> {
    let is_plain = |it: char| it.is_alphanumeric() || matches!(it, '-' | '_' | '.');
    let is_usable = (1..=MAX_ID_LENGTH).contains(&id.chars().count())
        && id.chars().all(is_plain)
        && !id.starts_with('.');
    match is_usable {
        true => Ok(()),
        false => Err(say::tool_id_wrong(id, MAX_ID_LENGTH)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn a_library_survives_a_round_trip_through_its_file() {
        let mut library = ToolLibrary::default();
        let mut tool = LibraryTool::from_description("CNMG 120408  PCLNR 2020K12").unwrap();
        tool.name = "粗车".to_owned();
        tool.station = Some(1);
        tool.life = Some(ToolLife::new(15.0, 4));
        library.insert("rough-80", tool).unwrap();
        library
            .insert("d8.5", LibraryTool::from_description("drill 8.5").unwrap())
            .unwrap();
        let text = ron::to_string(&library).unwrap();
        assert_eq!(ron::from_str::<ToolLibrary>(&text).unwrap(), library);
        assert_eq!(library.tools["rough-80"].code, "CNMG 120408 PCLNR 2020K12");
        library.check().unwrap();
    }

    #[test]
    fn ids_are_plain_and_free() {
        let mut library = ToolLibrary::default();
        assert_eq!(library.free_id("CNMG 120408 PCLNR"), "cnmg-120408-pclnr");
        assert_eq!(library.free_id("粗车"), "tool");
        library
            .insert("tool", LibraryTool::new(Tool::turning()))
            .unwrap();
        assert_eq!(library.free_id("??"), "tool-2");
        for id in ["", "a b", "../x", ".x", &"x".repeat(41)] {
            assert!(
                library
                    .insert(id, LibraryTool::new(Tool::turning()))
                    .is_err(),
                "{id}"
            );
        }
        let wrong = LibraryTool {
            station: Some(0),
            ..LibraryTool::new(Tool::turning())
        };
        let error = library.insert("a", wrong).unwrap_err().text(Language::En);
        assert!(error.starts_with("a:"), "{error}");
    }

    #[test]
    fn a_changed_tool_is_described_by_its_dimensions() {
        let mut tool = LibraryTool::from_description("CNMG 120408").unwrap();
        assert_eq!(tool.description(), "CNMG 120408");
        tool.tool = Tool::drill(5.0);
        assert!(tool.description().starts_with("drill 5"));
        assert!(tool.matches("x", "DRILL") && tool.matches("ab", "B") && !tool.matches("x", "q"));
    }
}
