//! The entities of a DXF file as lines and arcs.

use core::f64::consts::TAU;

use gsk_messages::{Message, say};
use gsk_units::Point;

use super::tags::{GroupTag, unescape};
use crate::curve_fit::{FIT_TOLERANCE_MM, fit_arcs};
use crate::drawing::{Drawing, DrawnEntity, EntityUse};
use crate::piece::ProfilePiece;

/// Entities without a shape of the part: texts, dimensions, hatches, frames.
const ANNOTATIONS: [&str; 17] = [
    "ACAD_PROXY_ENTITY",
    "ACAD_TABLE",
    "ARC_DIMENSION",
    "ATTDEF",
    "ATTRIB",
    "DIMENSION",
    "HATCH",
    "IMAGE",
    "LEADER",
    "MTEXT",
    "MULTILEADER",
    "POINT",
    "TEXT",
    "TOLERANCE",
    "VIEWPORT",
    "WIPEOUT",
    "XLINE",
];
/// Words in the names of line types of centre lines.
const CENTER_LINE_TYPES: [&str; 5] = ["CENTER", "CENTRE", "DASHDOT", "ACAD_ISO04", "ACAD_ISO10"];

/// An entity: its tags up to the next one.
#[derive(Clone, Copy)]
struct EntityTags<'a> {
    kind: &'a str,
    line: usize,
    tags: &'a [GroupTag<'a>],
}

impl<'a> EntityTags<'a> {
    fn find(&self, code: i32) -> Option<&'a GroupTag<'a>> {
        self.tags.iter().find(|tag| tag.code == code)
    }

    fn text(&self, code: i32) -> &'a str {
        self.find(code).map_or("", |tag| tag.value)
    }

    fn flags(&self, code: i32) -> i64 {
        self.find(code).map_or(0, GroupTag::flags)
    }

    /// A number; `default` if it is missing.
    fn number_or(&self, code: i32, default: f64) -> Result<f64, Message> {
        self.find(code).map_or(Ok(default), GroupTag::number)
    }

    fn number(&self, code: i32) -> Result<f64, Message> {
        let tag = self.find(code);
        tag.ok_or_else(|| say::outline_value_missing(self.line, self.kind, code))?
            .number()
    }

    /// The point whose horizontal coordinate has this code; the vertical one has the code 10
    /// higher.
    fn point(&self, code: i32) -> Result<Point, Message> {
        Ok(Point::new(self.number(code + 10)?, self.number(code)?))
    }

    /// Whether the plane of the entity is seen from its other side, so that it is mirrored;
    /// `None` if the plane is inclined.
    fn is_mirrored(&self) -> Result<Option<bool>, Message> {
        let normal = [(210, 0.0), (220, 0.0), (230, 1.0)];
        let mut values = [0.0; 3];
        for (value, (code, default)) in values.iter_mut().zip(normal) {
            *value = self.number_or(code, default)?;
        }
        let is_flat = values[0].abs() < 1e-9 && values[1].abs() < 1e-9;
        Ok(is_flat.then_some(values[2] < 0.0))
    }
}

/// Reads entities with the line types of their layers.
#[derive(Default)]
pub(super) struct EntityReader {
    /// Line type of each layer.
    line_types: Vec<String>,
}

impl EntityReader {
    /// Stores the line type of a layer.
    pub(super) fn set_line_type(&mut self, layer: usize, line_type: &str) {
        if self.line_types.len() <= layer {
            self.line_types.resize(layer + 1, String::new());
        }
        line_type.clone_into(&mut self.line_types[layer]);
    }

    /// Reads all entities of a section.
    pub(super) fn read_all(
        &self,
        section: &[GroupTag<'_>],
        drawing: &mut Drawing,
    ) -> Result<(), Message> {
        let starts: Vec<usize> = (0..section.len())
            .filter(|at| section[*at].code == 0)
            .collect();
        let entity = |index: usize| {
            let start = *starts.get(index)?;
            let end = starts.get(index + 1).copied().unwrap_or(section.len());
            Some(EntityTags {
                kind: section[start].value,
                line: section[start].line,
                tags: &section[start + 1..end],
            })
        };
        let mut index = 0;
        while let Some(head) = entity(index) {
            index += 1;
            let mut vertices = Vec::new();
            if head.kind == "POLYLINE" {
                while let Some(vertex) = entity(index).filter(|it| it.kind == "VERTEX") {
                    vertices.push(vertex);
                    index += 1;
                }
            }
            self.read_entity(head, &vertices, drawing)?;
        }
        Ok(())
    }

    fn read_entity(
        &self,
        entity: EntityTags<'_>,
        vertices: &[EntityTags<'_>],
        drawing: &mut Drawing,
    ) -> Result<(), Message> {
        let is_hidden = entity.flags(60) == 1 || entity.flags(67) == 1;
        if is_hidden || entity.kind == "SEQEND" || entity.kind == "VERTEX" {
            return Ok(());
        }
        if ANNOTATIONS.contains(&entity.kind) {
            drawing.annotations += 1;
            return Ok(());
        }
        let layer = match entity.text(8) {
            "" => drawing.layer_index("0"),
            name => drawing.layer_index(&unescape(name)),
        };
        let tolerance = FIT_TOLERANCE_MM / drawing.unit_mm.unwrap_or(1.0);
        let pieces = read_pieces(entity, vertices, tolerance)?;
        let entity_use = match &pieces {
            None => EntityUse::Unsupported,
            Some(_) if self.is_center_line(entity.text(6), layer) => EntityUse::CenterLine,
            Some(_) => EntityUse::Outline,
        };
        if entity.kind == "ELLIPSE" {
            drawing.fitted_curves += 1;
        }
        let drawn = DrawnEntity {
            kind: entity.kind.to_owned(),
            line: entity.line,
            layer,
            entity_use,
        };
        drawing.add(drawn, pieces.unwrap_or_default())
    }

    /// Whether the line type of an entity, or else of its layer, is that of a centre line.
    fn is_center_line(&self, line_type: &str, layer: usize) -> bool {
        let own = line_type.to_ascii_uppercase();
        let name = match own.as_str() {
            "" | "BYLAYER" => {
                let name = self.line_types.get(layer).map(String::as_str);
                name.unwrap_or_default().to_ascii_uppercase()
            }
            _ => own,
        };
        CENTER_LINE_TYPES.iter().any(|word| name.contains(word))
    }
}

/// The lines and arcs of an entity; `None` if its shape is not read.
fn read_pieces(
    entity: EntityTags<'_>,
    vertices: &[EntityTags<'_>],
    tolerance: f64,
) -> Result<Option<Vec<ProfilePiece>>, Message> {
    // A line has no plane: its coordinates are those of the drawing.
    if entity.kind == "LINE" {
        let line = ProfilePiece::line(entity.point(10)?, entity.point(11)?);
        return Ok(Some(vec![line]));
    }
    let pieces = match entity.kind {
        "ARC" => {
            let [begin, end] = [50, 51].map(|code| entity.number(code).map(f64::to_radians));
            read_arc(entity, begin?, end?)?
        }
        "CIRCLE" => read_arc(entity, 0.0, TAU)?,
        "ELLIPSE" => return read_ellipse(entity, tolerance).map(Some),
        "LWPOLYLINE" => join_vertices(&read_light_vertices(entity)?, entity.flags(70)),
        "POLYLINE" if entity.flags(70) & !(1 | 128) == 0 => {
            let corner =
                |vertex: &EntityTags<'_>| Ok((vertex.point(10)?, vertex.number_or(42, 0.0)?));
            let corners: Result<Vec<_>, Message> = vertices.iter().map(corner).collect();
            join_vertices(&corners?, entity.flags(70))
        }
        _ => return Ok(None),
    };
    Ok(match entity.is_mirrored()? {
        None => None,
        Some(false) => Some(pieces),
        Some(true) => Some(pieces.iter().map(mirror_horizontally).collect()),
    })
}

fn read_arc(entity: EntityTags<'_>, begin: f64, end: f64) -> Result<Vec<ProfilePiece>, Message> {
    let (center, radius) = (entity.point(10)?, entity.number(40)?);
    if radius <= 0.0 {
        return Err(say::outline_bad_number(entity.line, radius));
    }
    // From start to end counter-clockwise.
    let turn = libm::fmod(end - begin, TAU);
    let sweep = if turn <= 0.0 { turn + TAU } else { turn };
    let sweep = if sweep < 1e-12 { TAU } else { sweep };
    Ok(ProfilePiece::from_center(center, radius, begin, sweep))
}

fn read_ellipse(entity: EntityTags<'_>, tolerance: f64) -> Result<Vec<ProfilePiece>, Message> {
    let (center, major) = (entity.point(10)?, entity.point(11)?);
    let ratio = entity.number(40)?;
    let (from, to) = (entity.number_or(41, 0.0)?, entity.number_or(42, TAU)?);
    let is_turned = entity.is_mirrored()? == Some(true);
    let minor = major.left() * if is_turned { -ratio } else { ratio };
    let to = if to <= from { to + TAU } else { to };
    let point_at = |t: f64| center + major * libm::cos(t) + minor * libm::sin(t);
    Ok(fit_arcs(&point_at, (from, to.min(from + TAU)), tolerance))
}

/// The corners of a light polyline with their bulges.
fn read_light_vertices(entity: EntityTags<'_>) -> Result<Vec<(Point, f64)>, Message> {
    let mut corners: Vec<(Point, f64)> = Vec::new();
    for tag in entity.tags {
        match (tag.code, corners.last_mut()) {
            (10, _) => corners.push((Point::new(0.0, tag.number()?), 0.0)),
            (20, Some((corner, _))) => corner.x = tag.number()?,
            (42, Some((_, bulge))) => *bulge = tag.number()?,
            _ => {}
        }
    }
    Ok(corners)
}

/// Joins corners by lines and arcs; flag 1 closes them.
fn join_vertices(corners: &[(Point, f64)], flags: i64) -> Vec<ProfilePiece> {
    let closing = if flags & 1 == 1 {
        corners.first()
    } else {
        None
    };
    let next = corners.iter().skip(1).chain(closing);
    let pieces = corners.iter().zip(next);
    pieces
        .flat_map(|((from, bulge), (to, _))| ProfilePiece::from_bulge(*from, *to, *bulge))
        .collect()
}

/// The piece mirrored left to right.
fn mirror_horizontally(piece: &ProfilePiece) -> ProfilePiece {
    let mirror = |point: Point| Point::new(point.x, -point.z);
    ProfilePiece {
        start: mirror(piece.start),
        end: mirror(piece.end),
        bulge: -piece.bulge,
    }
}
