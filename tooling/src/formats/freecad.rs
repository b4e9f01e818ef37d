//! FreeCAD's tool libraries: a `.fctl` file with numbers and names, a `.fctb` file a tool.
//!
//! FreeCAD has shapes of drills and mills only, and opens no file with another shape. Inserts name
//! that of an end mill, with their size as its diameter; their dimensions are further parameters,
//! and an attribute has the whole tool for the way back.

use gsk_messages::{Message, say};
use gsk_workpiece::tool::{Insert, Tool};
use serde_json::{Map, Value, json};

use super::{ImportedTools, numbered_tools};
use crate::description::{parse_description, tool_description};
use crate::library::{LibraryTool, ToolLibrary};

/// The attribute with all dimensions.
const TOOL_ATTRIBUTE: &str = "Gsk980tdTool";
/// The attribute with the code as it was entered.
const CODE_ATTRIBUTE: &str = "Gsk980tdCode";
/// Shapes of drills.
const DRILL_SHAPES: [&str; 2] = ["drill", "twistdrill"];
/// The shape that stands for an insert.
const INSERT_SHAPE: &str = "endmill";

/// A file of a tool.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FreecadBit {
    /// Name of the file in the folder `Bit`.
    pub file_name: String,
    /// The content.
    pub text: String,
}

/// Writes the list of a library.
pub fn freecad_library_text(library: &ToolLibrary, label: &str) -> String {
    let tools = numbered_tools(library).into_iter();
    let tools: Vec<Value> = tools
        .map(|(number, id, _)| json!({ "nr": number, "path": file_name(id) }))
        .collect();
    pretty(&json!({ "version": 1, "label": label, "tools": tools }))
}

/// Writes a file for each tool.
pub fn freecad_bits(library: &ToolLibrary) -> Vec<FreecadBit> {
    let bits = library.tools.iter().map(|(id, tool)| {
        let (shape, parameters) = parameters(&tool.tool);
        let parameters: Map<String, Value> = parameters
            .into_iter()
            .map(|(name, value, unit)| (name.to_owned(), json!(format!("{value:.4} {unit}"))))
            .collect();
        let mut attributes = Map::new();
        attributes.insert(
            TOOL_ATTRIBUTE.to_owned(),
            json!(tool_description(&tool.tool)),
        );
        if !tool.code.is_empty() {
            attributes.insert(CODE_ATTRIBUTE.to_owned(), json!(tool.code));
        }
        let name = if tool.name.is_empty() { id } else { &tool.name };
        FreecadBit {
            file_name: file_name(id),
            text: pretty(&json!({
                "version": 2,
                "name": name,
                "shape": format!("{shape}.fcstd"),
                "parameter": parameters,
                "attribute": attributes,
            })),
        }
    });
    bits.collect()
}

fn file_name(id: &str) -> String {
    format!("{id}.fctb")
}

fn pretty(value: &Value) -> String {
    format!("{value:#}\n")
}

/// The shape of a tool and its parameters with their units.
fn parameters(tool: &Tool) -> (&'static str, Vec<(&'static str, f64, &'static str)>) {
    match tool.insert {
        Insert::Drill {
            diameter,
            point,
            reach,
        } => (
            "drill",
            vec![
                ("Diameter", diameter, "mm"),
                ("Length", reach, "mm"),
                ("TipAngle", point, "°"),
            ],
        ),
        Insert::Turning {
            letter,
            entering,
            size,
            nose,
        } => (
            INSERT_SHAPE,
            vec![
                ("Diameter", size, "mm"),
                ("CuttingEdgeAngle", letter.corner(), "°"),
                ("EnteringAngle", entering, "°"),
                ("InscribedCircle", size, "mm"),
                ("NoseRadius", nose, "mm"),
            ],
        ),
        Insert::Grooving { width, nose, reach } => (
            INSERT_SHAPE,
            vec![
                ("Diameter", width, "mm"),
                ("Width", width, "mm"),
                ("NoseRadius", nose, "mm"),
                ("Depth", reach, "mm"),
            ],
        ),
        Insert::Threading {
            angle,
            nose,
            height,
        } => (
            INSERT_SHAPE,
            vec![
                ("Diameter", height, "mm"),
                ("CuttingEdgeAngle", angle, "°"),
                ("NoseRadius", nose, "mm"),
                ("Height", height, "mm"),
            ],
        ),
    }
}

/// Reads the list of a library: numbers and names of tool files.
///
/// # Errors
/// The text is not such a list.
pub fn read_freecad_library(text: &str) -> Result<Vec<(u32, String)>, Message> {
    let list: Value = serde_json::from_str(text).map_err(say::as_written)?;
    let tools = list.get("tools").and_then(Value::as_array);
    let tools = tools.ok_or_else(|| say::tool_freecad_list("tools"))?;
    let entries = tools.iter().map(|tool| {
        let number = tool.get("nr").and_then(|it| match it {
            Value::String(text) => text.parse().ok(),
            other => other.as_u64(),
        });
        let path = tool.get("path").and_then(Value::as_str);
        let path = path.ok_or_else(|| say::tool_freecad_list("path"))?;
        Ok((
            number.and_then(|it| u32::try_from(it).ok()).unwrap_or(0),
            path.to_owned(),
        ))
    });
    entries.collect()
}

/// Reads the file of a tool with its number in the list, into the tools already read. `stem` is
/// the name of the file without its ending.
pub fn read_freecad_bit(imported: &mut ImportedTools, text: &str, stem: &str, number: u32) {
    match parse_bit(text, stem) {
        Ok(mut tool) => {
            tool.station = u8::try_from(number).ok().filter(|it| (1..=99).contains(it));
            imported.tools.push((stem.to_owned(), tool));
        }
        Err(why) => imported.notes.push(say::subject_reason(stem, why)),
    }
}

fn parse_bit(text: &str, stem: &str) -> Result<LibraryTool, Message> {
    let bit: Value = serde_json::from_str(text).map_err(say::as_written)?;
    let word = |group: &str, name: &str| bit.get(group)?.get(name)?.as_str();
    let mut tool = match word("attribute", TOOL_ATTRIBUTE) {
        Some(text) => LibraryTool::new(parse_description(text)?),
        None => LibraryTool::new(parse_drill(&bit)?),
    };
    tool.code = word("attribute", CODE_ATTRIBUTE)
        .unwrap_or_default()
        .to_owned();
    let name = bit.get("name").and_then(Value::as_str).unwrap_or_default();
    if name != stem {
        tool.name = name.to_owned();
    }
    tool.tool.check()?;
    Ok(tool)
}

fn parse_drill(bit: &Value) -> Result<Tool, Message> {
    let shape = bit.get("shape").and_then(Value::as_str).unwrap_or_default();
    let name = shape.rsplit(['/', '\\']).next().unwrap_or_default();
    let name = name.split('.').next().unwrap_or_default().to_lowercase();
    if !DRILL_SHAPES.contains(&name.as_str()) {
        return Err(say::tool_freecad_shape(shape));
    }
    let parameter = |name: &str| bit.get("parameter").and_then(|it| it.get(name));
    let number = |name: &str| parameter(name).and_then(parse_quantity);
    let diameter = number("Diameter").ok_or_else(|| say::tool_freecad_list("Diameter"))?;
    let mut tool = Tool::drill(diameter);
    if let Insert::Drill { point, reach, .. } = &mut tool.insert {
        *point = number("TipAngle").unwrap_or(*point);
        *reach = number("Length").unwrap_or(*reach);
    }
    Ok(tool)
}

/// A length in mm or an angle in degrees.
fn parse_quantity(value: &Value) -> Option<f64> {
    let Value::String(text) = value else {
        return value.as_f64();
    };
    let text = text.trim().replace(',', ".");
    let end = text
        .find(|it: char| !(it.is_ascii_digit() || matches!(it, '.' | '-' | '+')))
        .unwrap_or(text.len());
    let (number, unit) = text.split_at(end);
    let factor = match unit.trim() {
        "" | "mm" | "°" | "deg" => 1.0,
        "in" | "\"" => 25.4,
        "cm" => 10.0,
        "m" => 1000.0,
        "µm" | "um" => 0.001,
        _ => return None,
    };
    let number: f64 = number.parse().ok()?;
    number.is_finite().then_some(number * factor)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    #[test]
    fn a_library_survives_a_round_trip_through_the_files() {
        let mut library = ToolLibrary::default();
        for (index, text) in [
            "CNMG 120408 PCLNR 2020K12",
            "drill 8.5",
            "groove 3",
            "thread 60",
        ]
        .into_iter()
        .enumerate()
        {
            let mut tool = LibraryTool::from_description(text).unwrap();
            tool.name = format!("名 {index}");
            tool.station = Some(index as u8 + 1);
            library.insert(&format!("t{index}"), tool).unwrap();
        }
        let list = read_freecad_library(&freecad_library_text(&library, "shop")).unwrap();
        let bits = freecad_bits(&library);
        assert_eq!(bits.len(), 4);
        let mut imported = ImportedTools::default();
        for (number, path) in list {
            let bit = bits.iter().find(|it| it.file_name == path).unwrap();
            read_freecad_bit(
                &mut imported,
                &bit.text,
                path.trim_end_matches(".fctb"),
                number,
            );
        }
        assert_eq!(imported.notes, []);
        for (id, tool) in imported.tools {
            assert_eq!(tool, library.tools[&id]);
        }
    }

    #[test]
    fn drills_are_read_with_their_units_and_mills_are_refused() {
        let mut imported = ImportedTools::default();
        let drill = r#"{"version": 2, "name": "quarter", "shape": "drill.fcstd",
            "parameter": {"Diameter": "0.2500 in", "TipAngle": "119.0000 °", "Length": "50.0000 mm"},
            "attribute": {}}"#;
        read_freecad_bit(&mut imported, drill, "q", 3);
        let mill = r#"{"version": 2, "name": "m", "shape": "endmill.fcstd", "parameter": {}}"#;
        read_freecad_bit(&mut imported, mill, "m", 4);
        read_freecad_bit(&mut imported, "{", "x", 5);
        let expected = Insert::Drill {
            diameter: 6.35,
            point: 119.0,
            reach: 50.0,
        };
        assert_eq!(imported.tools[0].1.tool.insert, expected);
        assert_eq!(imported.tools.len(), 1);
        let notes: Vec<String> = imported
            .notes
            .iter()
            .map(|it| it.text(Language::En))
            .collect();
        assert!(
            notes[0].contains("endmill") && notes[1].starts_with("x:"),
            "{notes:?}"
        );
        assert!(read_freecad_library("{}").is_err());
        assert!(read_freecad_library("[").is_err());
    }
}
