//! FreeCAD's tool libraries: a `.fctl` file with numbers and names, a `.fctb` file a tool.
//!
//! FreeCAD has shapes of drills and mills only, and opens no file with another shape. Inserts name
//! that of an end mill, with their size as its diameter, or those of the add-on for lathes. Their
//! dimensions are further parameters, and an attribute has the whole tool for the way back.

use gsk_messages::{Message, say};
use gsk_workpiece::tool::{Insert, Tool};
use serde_json::{Map, Value, json};

use super::freecad_inserts::{BitParameter, insert_parameters, parse_insert};
use super::freecad_quantity::{QuantityUnit, parse_quantity};
use super::{ImportedTools, numbered_tools};
use crate::description::{parse_description, tool_description};
use crate::library::{LibraryTool, ToolLibrary};

/// The group of the attributes in the file of a tool.
const ATTRIBUTES: &str = "attribute";
/// The attribute with all dimensions.
const TOOL_ATTRIBUTE: &str = "Gsk980tdTool";
/// The attribute with the code as it was entered.
const CODE_ATTRIBUTE: &str = "Gsk980tdCode";
/// Shapes of drills.
const DRILL_SHAPES: [&str; 2] = ["drill", "twistdrill"];
/// The shape that stands for an insert.
const INSERT_SHAPE: &str = "endmill";

/// Greatest difference of a parameter from that of the attribute's tool that counts as equal: half
/// of the last decimal that FreeCAD writes.
const PARAMETER_TOLERANCE: f64 = 0.005_001;

/// The shapes that inserts name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FreecadInserts {
    /// That of an end mill, which every FreeCAD has.
    EndMill,
    /// Those of the add-on for lathes (`Iso_shape_C` and others); an end mill for inserts that it
    /// lacks. FreeCAD opens these files only with the add-on.
    LatheAddon,
}

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
pub fn freecad_bits(library: &ToolLibrary, inserts: FreecadInserts) -> Vec<FreecadBit> {
    let bits = library.tools.iter().map(|(id, tool)| {
        let of_addon = match inserts {
            FreecadInserts::LatheAddon => insert_parameters(&tool.tool),
            FreecadInserts::EndMill => None,
        };
        let (shape, parameters) = of_addon.unwrap_or_else(|| parameters(&tool.tool));
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
fn parameters(tool: &Tool) -> (&'static str, Vec<BitParameter>) {
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
        Err(why) => imported
            .notes
            .push(say::subject_reason(file_name(stem), why)),
    }
}

fn parse_bit(text: &str, stem: &str) -> Result<LibraryTool, Message> {
    let bit: Value = serde_json::from_str(text).map_err(say::as_written)?;
    let word = |group: &str, name: &str| bit.get(group)?.get(name)?.as_str();
    let whole = word(ATTRIBUTES, TOOL_ATTRIBUTE).map(parse_description);
    let whole = whole.transpose()?;
    let shape = shape_name(&bit);
    let mut tool = LibraryTool::new(match (parse_insert(&shape, &bit), whole) {
        (Some(insert), Some(whole)) => merge_tools(insert?, whole),
        (Some(insert), None) => insert?,
        (None, Some(whole)) => whole,
        (None, None) => parse_drill(&shape, &bit)?,
    });
    tool.code = word(ATTRIBUTES, CODE_ATTRIBUTE)
        .unwrap_or_default()
        .to_owned();
    let name = bit.get("name").and_then(Value::as_str).unwrap_or_default();
    if name != stem {
        tool.name = name.to_owned();
    }
    tool.tool.check()?;
    Ok(tool)
}

/// The tool of the attribute if the parameters still are its own: they have fewer digits and no
/// holder. Otherwise the parameters were changed in FreeCAD, and only the holder is kept.
fn merge_tools(insert: Tool, whole: Tool) -> Tool {
    let values = |tool: &Tool| insert_parameters(tool).unwrap_or_default().1;
    let (changed, stored) = (values(&insert), values(&whole));
    let is_equal = changed.len() == stored.len()
        && changed
            .iter()
            .zip(&stored)
            .all(|(a, b)| libm::fabs(a.1 - b.1) <= PARAMETER_TOLERANCE);
    match is_equal {
        true => whole,
        false if insert.is_internal() == whole.is_internal() => Tool {
            holder: whole.holder,
            ..insert
        },
        false => insert,
    }
}

/// The name of the shape file of a bit without folders and ending, in lower case.
fn shape_name(bit: &Value) -> String {
    let shape = bit.get("shape").and_then(Value::as_str).unwrap_or_default();
    let name = shape.rsplit(['/', '\\']).next().unwrap_or_default();
    name.split('.').next().unwrap_or_default().to_lowercase()
}

fn parse_drill(shape: &str, bit: &Value) -> Result<Tool, Message> {
    if !DRILL_SHAPES.contains(&shape) {
        return Err(say::tool_freecad_shape(shape));
    }
    let parameter = |name: &str| bit.get("parameter").and_then(|it| it.get(name));
    let number = |name: &str, unit| parameter(name).and_then(|it| parse_quantity(it, unit));
    let diameter = number("Diameter", QuantityUnit::Length);
    let diameter = diameter.ok_or_else(|| say::tool_freecad_list("Diameter"))?;
    let mut tool = Tool::drill(diameter);
    if let Insert::Drill { point, reach, .. } = &mut tool.insert {
        *point = number("TipAngle", QuantityUnit::Angle).unwrap_or(*point);
        *reach = number("Length", QuantityUnit::Length).unwrap_or(*reach);
    }
    Ok(tool)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;

    fn sample_library() -> ToolLibrary {
        let mut library = ToolLibrary::default();
        for (index, text) in [
            "CNMG 120408 PCLNR 2020K12",
            "DCMT 070204 S12M-SDUCR 07",
            "turn V entering=93.123456 size=9.525 nose=0.2 tip=4",
            "WNMG 080408 MWLNR 2020K08",
            "TCMT 110204",
            "SNMG 120408",
            "turn C tip=8",
            "turn C tip=9",
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
        library
    }

    fn read_back(library: &ToolLibrary, bits: &[FreecadBit]) -> ImportedTools {
        let list = read_freecad_library(&freecad_library_text(library, "shop")).unwrap();
        let mut imported = ImportedTools::default();
        for (number, path) in list {
            let bit = bits.iter().find(|it| it.file_name == path).unwrap();
            let stem = path.trim_end_matches(".fctb");
            read_freecad_bit(&mut imported, &bit.text, stem, number);
        }
        assert_eq!(imported.notes, []);
        imported
    }

    #[test]
    fn a_library_survives_a_round_trip_through_the_files() {
        let library = sample_library();
        for inserts in [FreecadInserts::EndMill, FreecadInserts::LatheAddon] {
            let bits = freecad_bits(&library, inserts);
            assert_eq!(bits.len(), library.tools.len());
            for (id, tool) in read_back(&library, &bits).tools {
                assert_eq!(tool, library.tools[&id], "{inserts:?}");
            }
        }
    }

    /// FreeCAD drops unknown attributes and rounds to two decimals when it saves a bit.
    #[test]
    fn inserts_of_the_addon_survive_without_attributes() {
        let library = sample_library();
        let mut bits = freecad_bits(&library, FreecadInserts::LatheAddon);
        let shapes = |it: &FreecadBit| it.text.contains("\"shape\": \"Iso_shape_");
        bits.retain(shapes);
        assert_eq!(bits.len(), 6, "C, D, V, T, S and the one with tip 8");
        for bit in bits {
            let mut value: Value = serde_json::from_str(&bit.text).unwrap();
            value[ATTRIBUTES] = json!({});
            let mut imported = ImportedTools::default();
            let id = bit.file_name.trim_end_matches(".fctb");
            read_freecad_bit(&mut imported, &value.to_string(), id, 0);
            assert_eq!(imported.notes, []);
            let (read, stored) = (&imported.tools[0].1.tool, &library.tools[id].tool);
            assert_eq!(read.tip, stored.tip);
            let parameters = [read, stored].map(|it| insert_parameters(it).unwrap().1);
            for (a, b) in parameters[0].iter().zip(&parameters[1]) {
                assert!((a.1 - b.1).abs() < 1e-4, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn a_parameter_changed_in_freecad_replaces_that_of_the_attribute() {
        let library = sample_library();
        let bits = freecad_bits(&library, FreecadInserts::LatheAddon);
        let bit = bits.iter().find(|it| it.file_name == "t0.fctb").unwrap();
        let text = bit.text.replace("0.8000 mm", "1.2000 mm");
        let mut imported = ImportedTools::default();
        read_freecad_bit(&mut imported, &text, "t0", 1);
        let (read, stored) = (&imported.tools[0].1.tool, &library.tools["t0"].tool);
        assert_eq!(read.nose(), 1.2);
        assert_eq!(read.holder, stored.holder);
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
        let angle = r#"{"shape": "C:\\a\\Iso_shape_C.FCStd", "parameter": {"TipAngle": "70 °"}}"#;
        read_freecad_bit(&mut imported, angle, "c", 6);
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
            notes[0].contains("endmill") && notes[1].starts_with("x.fctb:"),
            "{notes:?}"
        );
        assert!(
            notes[2].starts_with("c.fctb: `TipAngle` is 70 °:"),
            "{notes:?}"
        );
        assert!(read_freecad_library("{}").is_err());
        assert!(read_freecad_library("[").is_err());
    }
}
