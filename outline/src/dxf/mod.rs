//! Reads DXF text files: units, layers, and the entities of the model space.

mod entities;
mod tags;

use gsk_messages::{Message, say};

use crate::drawing::{Drawing, DrawingFormat, DrawingUnit};
use entities::EntityReader;
use tags::{GroupTag, decode, split_tags, unescape};

/// The first bytes of a binary DXF file.
const BINARY_MARK: &[u8] = b"AutoCAD Binary DXF";

/// Whether bytes look like a DXF file: text that begins with a group code.
pub(crate) fn is_dxf(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let first = bytes
        .split(|byte| *byte == b'\n')
        .next()
        .unwrap_or_default();
    let first = first.trim_ascii();
    bytes.starts_with(BINARY_MARK)
        || (!first.is_empty() && first.len() <= 4 && first.iter().all(u8::is_ascii_digit))
}

/// Reads a DXF file.
///
/// # Errors
/// The file is binary or damaged, or has an unknown unit or too many entities.
pub(crate) fn read(bytes: &[u8]) -> Result<Drawing, Message> {
    if bytes.starts_with(BINARY_MARK) {
        return Err(say::outline_binary_dxf());
    }
    let text = decode(bytes);
    let tags = split_tags(&text)?;
    let mut drawing = Drawing::new(DrawingFormat::Dxf);
    let mut reader = EntityReader::default();
    let mut sections = 0;
    for section in tags.split(|tag| tag.code == 0 && tag.value == "ENDSEC") {
        let Some(start) = section.iter().position(|tag| tag.value == "SECTION") else {
            continue;
        };
        let (name, content) = match &section[start + 1..] {
            [name, content @ ..] => (name.value, content),
            [] => continue,
        };
        sections += 1;
        match name {
            "HEADER" => drawing.unit_mm = read_unit(content)?,
            "TABLES" => read_layers(content, &mut drawing, &mut reader),
            "ENTITIES" => reader.read_all(content, &mut drawing)?,
            _ => {}
        }
    }
    if sections == 0 {
        return Err(say::outline_no_sections());
    }
    Ok(drawing)
}

/// The unit of `$INSUNITS`, mm; `None` for a drawing without one.
fn read_unit(header: &[GroupTag<'_>]) -> Result<Option<f64>, Message> {
    let name = header
        .iter()
        .position(|tag| tag.code == 9 && tag.value == "$INSUNITS");
    let Some(tag) = name.and_then(|at| header.get(at + 1)) else {
        return Ok(None);
    };
    let unit = match tag.flags() {
        0 => return Ok(None),
        1 => DrawingUnit::Inch,
        2 => DrawingUnit::Foot,
        4 => DrawingUnit::Millimetre,
        5 => DrawingUnit::Centimetre,
        6 => DrawingUnit::Metre,
        13 => DrawingUnit::Micrometre,
        _ => {
            return Err(say::outline_unknown_unit(
                tag.line,
                tags::shortened(tag.value),
            ));
        }
    };
    Ok(Some(unit.millimetres()))
}

/// Reads the table of layers: names, visibility, line types.
fn read_layers(tables: &[GroupTag<'_>], drawing: &mut Drawing, reader: &mut EntityReader) {
    let starts = (0..tables.len()).filter(|at| tables[*at].code == 0);
    let starts: Vec<usize> = starts.collect();
    for (index, start) in starts.iter().enumerate() {
        let end = starts.get(index + 1).copied().unwrap_or(tables.len());
        if tables[*start].value != "LAYER" {
            continue;
        }
        let entry = &tables[start + 1..end];
        let value = |code| entry.iter().find(|tag| tag.code == code);
        let Some(name) = value(2) else { continue };
        let layer = drawing.layer_index(&unescape(name.value));
        let is_frozen = value(70).is_some_and(|tag| tag.flags() & 1 == 1);
        let is_off = value(62).is_some_and(|tag| tag.flags() < 0);
        drawing.layers[layer].is_visible = !(is_frozen || is_off);
        let line_type = value(6).map_or("", |tag| tag.value);
        reader.set_line_type(layer, line_type);
    }
}
