//! Reads SVG files: shapes and paths with their transforms, groups as layers.

mod path;
mod transform;

use gsk_messages::{Message, say};
use gsk_units::{Point, parse_finite};
use roxmltree::{Document, Node, ParsingOptions};
use svgtypes::{Length, LengthUnit, PointsParser, ViewBox};

use crate::curve_fit::FIT_TOLERANCE_MM;
use crate::drawing::{Drawing, DrawingFormat, DrawnEntity, EntityUse};
use crate::piece::ProfilePiece;
use path::{EllipseArc, PieceCollector, SvgPieces, read_path};
use transform::AffineMap;

/// Length of a pixel, mm.
const PIXEL_MM: f64 = 25.4 / 96.0;
/// Greatest number of nodes of a file.
const MAX_NODES: u32 = 500_000;
/// Greatest depth of nested groups.
const MAX_DEPTH: usize = 64;
/// The layer of elements outside groups.
const ROOT_LAYER: &str = "svg";

/// Whether bytes look like an XML text with an `svg` element.
pub(crate) fn is_svg(bytes: &[u8]) -> bool {
    let bytes = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    bytes.trim_ascii_start().starts_with(b"<") && bytes.windows(4).any(|word| word == b"<svg")
}

/// Reads an SVG file.
///
/// # Errors
/// The XML, a path or a transform is damaged, or the file has too many elements.
pub(crate) fn read(bytes: &[u8]) -> Result<Drawing, Message> {
    let text = String::from_utf8_lossy(bytes);
    let options = ParsingOptions {
        allow_dtd: true,
        nodes_limit: MAX_NODES,
        ..ParsingOptions::default()
    };
    let document = Document::parse_with_options(&text, options)
        .map_err(|error| say::outline_bad_xml(error.pos().row, error))?;
    let mut drawing = Drawing::new(DrawingFormat::Svg);
    let root = document.root_element();
    drawing.unit_mm = read_unit(root);
    for node in root.descendants().filter(Node::is_element) {
        read_element(node, &mut drawing)?;
    }
    Ok(drawing)
}

/// The length of a unit by width and view box, mm; `None` if the width is not a length.
fn read_unit(root: Node<'_, '_>) -> Option<f64> {
    let width: Length = root.attribute("width")?.parse().ok()?;
    let unit = match width.unit {
        LengthUnit::Mm => 1.0,
        LengthUnit::Cm => 10.0,
        LengthUnit::In => 25.4,
        LengthUnit::Pt => 25.4 / 72.0,
        LengthUnit::Pc => 25.4 / 6.0,
        LengthUnit::None
        | LengthUnit::Px
        | LengthUnit::Em
        | LengthUnit::Ex
        | LengthUnit::Percent => {
            return None;
        }
    };
    let view_box = root
        .attribute("viewBox")
        .and_then(|text| text.parse::<ViewBox>().ok());
    let scale = view_box.map_or(PIXEL_MM, |view| width.number * unit / view.w);
    (scale.is_finite() && scale > 0.0).then_some(scale)
}

fn read_element(node: Node<'_, '_>, drawing: &mut Drawing) -> Result<(), Message> {
    let kind = node.tag_name().name();
    let line = line_of(node);
    let is_shape = matches!(
        kind,
        "path" | "line" | "polyline" | "polygon" | "rect" | "circle" | "ellipse" | "use"
    );
    if matches!(kind, "text" | "image" | "foreignObject") {
        drawing.annotations += 1;
    }
    if !is_shape || is_hidden(node) {
        return Ok(());
    }
    if node.ancestors().nth(MAX_DEPTH).is_some() {
        return Err(say::outline_too_deep(line, MAX_DEPTH));
    }
    let layer = drawing.layer_index(&layer_name(node));
    let mut collector = PieceCollector {
        map: map_of(node)?,
        tolerance: FIT_TOLERANCE_MM / drawing.unit_mm.unwrap_or(1.0),
        found: SvgPieces::default(),
    };
    let is_read = read_shape(node, kind, line, &mut collector)?;
    let entity_use = match is_read {
        false => EntityUse::Unsupported,
        true if is_center_line(node) => EntityUse::CenterLine,
        true => EntityUse::Outline,
    };
    let entity = DrawnEntity {
        kind: kind.to_owned(),
        line,
        layer,
        entity_use,
    };
    drawing.fitted_curves += collector.found.fitted_curves;
    drawing.add(entity, collector.found.pieces)
}

/// Adds the pieces of a shape. Returns false if its form is not read.
fn read_shape(
    node: Node<'_, '_>,
    kind: &str,
    line: usize,
    collector: &mut PieceCollector,
) -> Result<bool, Message> {
    let number = |name: &str| match node.attribute(name) {
        None => Ok(0.0),
        Some(text) => parse_finite(text.trim().trim_end_matches("px")).ok_or_else(|| {
            say::outline_bad_number(line, text.chars().take(30).collect::<String>())
        }),
    };
    let point = |x: &str, y: &str| Ok::<_, Message>(Point::new(number(y)?, number(x)?));
    match kind {
        "path" => read_path(node.attribute("d").unwrap_or_default(), line, collector)?,
        "line" => {
            collector.add_piece(ProfilePiece::line(point("x1", "y1")?, point("x2", "y2")?));
        }
        "polyline" | "polygon" => {
            let points = PointsParser::from(node.attribute("points").unwrap_or_default());
            let points: Vec<Point> = points.map(|(x, y)| Point::new(y, x)).collect();
            add_corners(&points, kind == "polygon", collector);
        }
        "rect" if node.has_attribute("rx") || node.has_attribute("ry") => return Ok(false),
        "rect" => {
            let (low, size) = (point("x", "y")?, point("width", "height")?);
            let high = low + size;
            let corners = [
                low,
                Point::new(low.x, high.z),
                high,
                Point::new(high.x, low.z),
            ];
            add_corners(&corners, true, collector);
        }
        "circle" | "ellipse" => {
            let (rx, ry) = match kind {
                "circle" => (number("r")?, number("r")?),
                _ => (number("rx")?, number("ry")?),
            };
            if rx > 0.0 && ry > 0.0 {
                collector.add_ellipse(&EllipseArc {
                    center: point("cx", "cy")?,
                    major: Point::new(0.0, rx),
                    minor: Point::new(ry, 0.0),
                    begin: 0.0,
                    sweep: core::f64::consts::TAU,
                });
            }
        }
        _ => return Ok(false),
    }
    Ok(true)
}

fn add_corners(corners: &[Point], is_closed: bool, collector: &mut PieceCollector) {
    let closing = if is_closed { corners.first() } else { None };
    let next = corners.iter().skip(1).chain(closing);
    for (from, to) in corners.iter().zip(next) {
        collector.add_piece(ProfilePiece::line(*from, *to));
    }
}

/// The map of an element: the transforms of its groups and its own.
fn map_of(node: Node<'_, '_>) -> Result<AffineMap, Message> {
    let transforms: Vec<_> = (node.ancestors())
        .filter_map(|group| Some((group.attribute("transform")?, line_of(group))))
        .collect();
    let outside_in = transforms.into_iter().rev();
    outside_in
        .into_iter()
        .try_fold(AffineMap::UPWARDS, |map, (text, line)| {
            Ok(map.then_inner(AffineMap::parse(text, line)?))
        })
}

fn line_of(node: Node<'_, '_>) -> usize {
    node.document().text_pos_at(node.range().start).row as usize
}

/// The value of a presentation attribute or of its `style` property.
fn style_value<'a>(node: Node<'a, '_>, name: &str) -> Option<&'a str> {
    let declarations = node.attribute("style").unwrap_or_default().split(';');
    let mut pairs = declarations.filter_map(|declaration| declaration.split_once(':'));
    let in_style = pairs
        .find(|(key, _)| key.trim() == name)
        .map(|(_, value)| value.trim());
    in_style.or_else(|| node.attribute(name))
}

/// Whether an element is not drawn: in definitions, or switched off.
fn is_hidden(node: Node<'_, '_>) -> bool {
    node.ancestors().any(|group| {
        let kind = group.tag_name().name();
        matches!(
            kind,
            "defs" | "symbol" | "clipPath" | "mask" | "marker" | "pattern"
        ) || style_value(group, "display") == Some("none")
    })
}

/// Whether an element is drawn with dashes and dots.
fn is_center_line(node: Node<'_, '_>) -> bool {
    let dashes = style_value(node, "stroke-dasharray").unwrap_or_default();
    let lengths = dashes.split([',', ' ']).filter(|word| !word.is_empty());
    lengths.count() >= 4
}

/// The layer of an element: that of Inkscape, else its outermost group with a name.
fn layer_name(node: Node<'_, '_>) -> String {
    let groups = || {
        node.ancestors()
            .filter(|group| group.tag_name().name() == "g")
    };
    let attribute = |group: &Node<'_, '_>, name: &str| {
        let mut attributes = group.attributes();
        let found = attributes.find(|attribute| attribute.name() == name);
        found.map(|attribute| attribute.value().to_owned())
    };
    let layer = groups().find(|group| attribute(group, "groupmode").as_deref() == Some("layer"));
    let label = layer.and_then(|group| attribute(&group, "label"));
    let outermost = || groups().filter_map(|group| attribute(&group, "id")).last();
    label
        .or_else(outermost)
        .unwrap_or_else(|| ROOT_LAYER.to_owned())
}
