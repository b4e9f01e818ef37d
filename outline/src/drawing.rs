//! A drawing as read from a file: lines and arcs with the entities they come from.

use gsk_messages::{Message, say};
use gsk_units::Point;

use crate::piece::ProfilePiece;

/// Greatest number of lines and arcs of a drawing.
pub(crate) const MAX_PIECES: usize = 100_000;
/// Greatest coordinate of a drawing, mm.
pub(crate) const MAX_SIZE_MM: f64 = 10_000.0;

/// Greatest number of faults of one kind that are reported.
pub(crate) const MAX_FAULTS: usize = 20;

/// A unit of length of a drawing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingUnit {
    /// Micrometres.
    Micrometre,
    /// Millimetres.
    Millimetre,
    /// Centimetres.
    Centimetre,
    /// Metres.
    Metre,
    /// Inches.
    Inch,
    /// Feet.
    Foot,
}

impl DrawingUnit {
    /// The length of the unit, mm.
    pub const fn millimetres(self) -> f64 {
        match self {
            Self::Micrometre => 0.001,
            Self::Millimetre => 1.0,
            Self::Centimetre => 10.0,
            Self::Metre => 1000.0,
            Self::Inch => 25.4,
            Self::Foot => 304.8,
        }
    }

    /// The sign of the unit.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Micrometre => "µm",
            Self::Millimetre => "mm",
            Self::Centimetre => "cm",
            Self::Metre => "m",
            Self::Inch => "in",
            Self::Foot => "ft",
        }
    }
}

/// What an entity is for the outline.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum EntityUse {
    /// Its lines and arcs are drawn.
    Outline,
    /// A centre line, which marks the axis.
    CenterLine,
    /// It has a shape that is not read.
    Unsupported,
}

/// An entity of a drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct DrawnEntity {
    /// Its name in the file: `LINE`, `path`.
    pub(crate) kind: String,
    /// Its first line in the file, from 1.
    pub(crate) line: usize,
    /// Its layer, an index into the layers of the drawing.
    pub(crate) layer: usize,
    pub(crate) entity_use: EntityUse,
}

/// A line or an arc with the entity that it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct TracedPiece {
    pub(crate) piece: ProfilePiece,
    /// An index into the entities of the drawing.
    pub(crate) entity: usize,
}

impl TracedPiece {
    pub(crate) const fn with(self, piece: ProfilePiece) -> Self {
        Self { piece, ..self }
    }
}

/// A rule that a drawing breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawingFault {
    /// The rule, with entity, layer and position.
    pub message: Message,
    /// Where it is broken: X from the axis, a radius, and Z of the drawing, mm; `None` if it
    /// concerns the whole drawing.
    pub at: Option<Point>,
}

impl DrawingFault {
    pub(crate) const fn new(message: Message, at: Point) -> Self {
        Self {
            message,
            at: Some(at),
        }
    }
}

impl From<Message> for DrawingFault {
    fn from(message: Message) -> Self {
        Self { message, at: None }
    }
}

/// A layer of a drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct DrawingLayer {
    /// Its name.
    pub name: String,
    /// Whether the layer is switched on and not frozen.
    pub is_visible: bool,
    /// Number of its lines and arcs.
    pub pieces: usize,
}

/// The format of a drawing file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DrawingFormat {
    /// Drawing exchange format, as text.
    Dxf,
    /// Scalable vector graphics.
    Svg,
}

/// A drawing as read from a file, in its units. Its horizontal axis is Z, to the right; its
/// vertical one X, a radius, upwards.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    pub(crate) format: DrawingFormat,
    /// The length of a unit of the coordinates, mm; `None` if the file does not state it.
    pub(crate) unit_mm: Option<f64>,
    pub(crate) layers: Vec<DrawingLayer>,
    pub(crate) entities: Vec<DrawnEntity>,
    pub(crate) pieces: Vec<TracedPiece>,
    /// The number of texts, dimensions and hatches that were left out.
    pub(crate) annotations: usize,
    /// The number of curves that were replaced by arcs.
    pub(crate) fitted_curves: usize,
}

impl Drawing {
    pub(crate) const fn new(format: DrawingFormat) -> Self {
        Self {
            format,
            unit_mm: None,
            layers: Vec::new(),
            entities: Vec::new(),
            pieces: Vec::new(),
            annotations: 0,
            fitted_curves: 0,
        }
    }

    /// The layers, in the order of the file.
    pub fn layers(&self) -> &[DrawingLayer] {
        &self.layers
    }

    /// The format of the file.
    pub const fn format(&self) -> DrawingFormat {
        self.format
    }

    /// The index of a layer, which is added if it is new.
    pub(crate) fn layer_index(&mut self, name: &str) -> usize {
        let known = self.layers.iter().position(|layer| layer.name == name);
        known.unwrap_or_else(|| {
            self.layers.push(DrawingLayer {
                name: name.to_owned(),
                is_visible: true,
                pieces: 0,
            });
            self.layers.len() - 1
        })
    }

    /// Adds an entity with its lines and arcs; those without length are left out.
    ///
    /// # Errors
    /// A coordinate is not finite, or the drawing has too many lines and arcs.
    pub(crate) fn add(
        &mut self,
        entity: DrawnEntity,
        pieces: impl IntoIterator<Item = ProfilePiece>,
    ) -> Result<(), Message> {
        let index = self.entities.len();
        let layer = entity.layer;
        self.entities.push(entity);
        for piece in pieces {
            let Point { x, z } = piece.start + piece.end;
            if !(x.is_finite() && z.is_finite() && piece.bulge.is_finite()) {
                return Err(say::outline_not_finite(self.entity_name(index)));
            }
            if piece.chord().length() == 0.0 {
                continue;
            }
            if self.pieces.len() >= MAX_PIECES {
                return Err(say::outline_too_many_pieces(MAX_PIECES));
            }
            self.pieces.push(TracedPiece {
                piece,
                entity: index,
            });
            self.layers[layer].pieces += 1;
        }
        Ok(())
    }

    /// The name of an entity in messages: kind, layer and line.
    pub(crate) fn entity_name(&self, index: usize) -> Message {
        let Some(entity) = self.entities.get(index) else {
            return say::as_written("-");
        };
        let layer = self.layers.get(entity.layer).map(|layer| &layer.name[..]);
        say::outline_entity(&entity.kind, layer.unwrap_or_default(), entity.line)
    }
}
