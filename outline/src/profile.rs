//! Finds the outline of a part in a drawing: layers, axis, the half above it, its order, its
//! zero.
//!
//! ```text
//!      X ^         ______
//!        |   _____|      \          the outline from its right end to its left one;
//!        |  |             |         the face that parting off leaves is not part of it
//!   -----|--|-------------+----> Z
//!        left           right
//! ```

use gsk_messages::{Message, say};
use gsk_units::Point;

use crate::chain::{MAX_OUTLINE_PIECES, PieceChain, join_pieces};
use crate::crossing::find_crossing;
use crate::drawing::{
    Drawing, DrawingFault, DrawingFormat, DrawingUnit, EntityUse, MAX_SIZE_MM, TracedPiece,
};
use crate::half::take_upper_half;
use crate::piece::ProfilePiece;

/// Default of [`ProfileOptions::gap`], mm.
pub const DEFAULT_GAP_MM: f64 = 0.01;

/// Where the program zero is; the zero of X is always the axis.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum ProfileZero {
    /// Z0 is at the right end of the outline.
    #[default]
    Right,
    /// Z0 is at the left end of the outline.
    Left,
    /// A point of the drawing, mm: X is the height of the axis, Z the horizontal coordinate of
    /// Z0.
    At(Point),
}

/// How the outline is found in a drawing.
#[derive(Clone, Debug, PartialEq)]
pub struct ProfileOptions {
    /// Names of the layers with the outline; empty: all visible ones.
    pub layers: Vec<String>,
    /// The program zero.
    pub zero: ProfileZero,
    /// The unit of the drawing instead of the one that the file states.
    pub unit: Option<DrawingUnit>,
    /// Greatest distance of two ends that are one corner, mm.
    pub gap: f64,
}

impl Default for ProfileOptions {
    fn default() -> Self {
        Self {
            layers: Vec::new(),
            zero: ProfileZero::default(),
            unit: None,
            gap: DEFAULT_GAP_MM,
        }
    }
}

/// The outline to be turned, from its right end to its left one, in coordinates of the program
/// with X as a radius, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedProfile {
    pub(crate) traced: Vec<TracedPiece>,
    /// The names of the entities of [`Self::traced`], by their indices.
    pub(crate) names: Vec<Message>,
    /// What was assumed and left out.
    pub notes: Vec<Message>,
}

impl TurnedProfile {
    /// The lines and arcs in order.
    pub fn pieces(&self) -> impl Iterator<Item = &ProfilePiece> {
        self.traced.iter().map(|it| &it.piece)
    }

    /// The greatest diameter, mm.
    pub fn largest_diameter(&self) -> f64 {
        let tops = self.pieces().map(|piece| piece.bounds().1.x);
        tops.fold(0.0, f64::max) * 2.0
    }

    /// The name of the entity of a piece: kind, layer and line in the file.
    pub(crate) fn entity_name(&self, traced: &TracedPiece) -> Message {
        let name = self.names.get(traced.entity).cloned();
        name.unwrap_or_else(|| say::as_written("-"))
    }
}

impl Drawing {
    /// Finds the outline to be turned.
    ///
    /// # Errors
    /// The first rule that the drawing breaks, with entity, layer and position.
    pub fn find_profile(&self, options: &ProfileOptions) -> Result<TurnedProfile, Message> {
        self.find_profile_or_faults(options).map_err(|faults| {
            let mut messages = faults.into_iter().map(|fault| fault.message);
            messages.next().unwrap_or_else(say::outline_empty)
        })
    }

    /// Finds the outline to be turned.
    ///
    /// # Errors
    /// The faults of the drawing; faults of a kind that is found later are not among them.
    pub fn find_profile_or_faults(
        &self,
        options: &ProfileOptions,
    ) -> Result<TurnedProfile, Vec<DrawingFault>> {
        let one = |message: Message| vec![DrawingFault::from(message)];
        let mut notes = Vec::new();
        let layers = self.select_layers(&options.layers).map_err(one)?;
        self.check_supported(&layers).map_err(one)?;
        let shifted = self
            .placed_outline(&layers, options, &mut notes)
            .map_err(one)?;
        if shifted.is_empty() {
            return Err(one(self.nothing_found(&layers)));
        }
        if shifted.len() > MAX_OUTLINE_PIECES {
            return Err(one(say::outline_too_many_pieces(MAX_OUTLINE_PIECES)));
        }
        let upper = take_upper_half(self, &shifted, options.gap)?;
        let chain = join_pieces(self, &upper, options.gap)?;
        if chain.edge_lines > 0 {
            notes.push(say::outline_note_edges(chain.edge_lines));
        }
        let outline =
            orient_chain(self, chain, options.gap, &mut notes).map_err(|fault| vec![fault])?;
        if let Some((first, second, at)) = find_crossing(&outline, options.gap) {
            let names = [first, second].map(|entity| self.entity_name(entity));
            let message = say::outline_crossing(at.x * 2.0, at.z, say::several(names));
            return Err(vec![DrawingFault::new(message, at)]);
        }
        let zero = zero_position(&outline, options.zero);
        let traced = (outline.iter())
            .map(|it| it.with(it.piece.placed(1.0, Point::new(0.0, -zero))))
            .collect();
        self.note_left_out(&mut notes);
        Ok(TurnedProfile {
            traced,
            names: (0..self.entities.len())
                .map(|entity| self.entity_name(entity))
                .collect(),
            notes,
        })
    }

    /// The lines and arcs of the selected layers, with X from the axis and Z of the drawing,
    /// mm; none if a layer is unknown or a coordinate is too large.
    pub fn selected_pieces(&self, options: &ProfileOptions) -> Vec<ProfilePiece> {
        let layers = self.select_layers(&options.layers);
        let placed =
            layers.and_then(|layers| self.placed_outline(&layers, options, &mut Vec::new()));
        let placed = placed.unwrap_or_default();
        placed.iter().map(|it| it.piece).collect()
    }

    /// The pieces of the outline in the selected layers, with X from the axis.
    fn placed_outline(
        &self,
        layers: &[bool],
        options: &ProfileOptions,
        notes: &mut Vec<Message>,
    ) -> Result<Vec<TracedPiece>, Message> {
        let pieces = self.scale_pieces(layers, options, notes)?;
        let axis = self.find_axis(&pieces, layers, options, notes);
        Ok((pieces.iter())
            .filter(|it| self.is_outline(it))
            .map(|it| it.with(it.piece.placed(1.0, Point::new(-axis, 0.0))))
            .collect())
    }

    fn is_outline(&self, traced: &TracedPiece) -> bool {
        let entity = self.entities.get(traced.entity);
        entity.is_some_and(|entity| entity.entity_use == EntityUse::Outline)
    }

    /// Whether each layer is selected: the named ones, or else all visible ones.
    fn select_layers(&self, names: &[String]) -> Result<Vec<bool>, Message> {
        if names.is_empty() {
            return Ok(self.layers.iter().map(|layer| layer.is_visible).collect());
        }
        let is_known = |name: &String| self.layers.iter().any(|layer| layer.name == *name);
        if let Some(unknown) = names.iter().find(|name| !is_known(name)) {
            return Err(say::outline_no_layer(unknown, self.layer_list()));
        }
        let is_named = |name: &String| names.contains(name);
        Ok((self.layers.iter())
            .map(|layer| is_named(&layer.name))
            .collect())
    }

    /// The names of the layers with lines and arcs.
    fn layer_list(&self) -> String {
        let drawn = self.layers.iter().filter(|layer| layer.pieces > 0);
        let names: Vec<&str> = drawn.map(|layer| &layer.name[..]).take(20).collect();
        names.join(", ")
    }

    fn nothing_found(&self, layers: &[bool]) -> Message {
        match layers.iter().all(|is_selected| *is_selected) {
            true => say::outline_empty(),
            false => say::outline_empty_layers(self.layer_list()),
        }
    }

    fn check_supported(&self, layers: &[bool]) -> Result<(), Message> {
        let mut entities = self.entities.iter().enumerate();
        let unsupported = entities.find(|(_, entity)| {
            entity.entity_use == EntityUse::Unsupported && layers[entity.layer]
        });
        unsupported.map_or(Ok(()), |(index, _)| {
            Err(say::outline_unsupported(self.entity_name(index)))
        })
    }

    /// The pieces of the selected layers in millimetres.
    fn scale_pieces(
        &self,
        layers: &[bool],
        options: &ProfileOptions,
        notes: &mut Vec<Message>,
    ) -> Result<Vec<TracedPiece>, Message> {
        let stated = options.unit.map(DrawingUnit::millimetres).or(self.unit_mm);
        if stated.is_none() {
            notes.push(say::outline_note_unit());
        }
        let scale = stated.unwrap_or(1.0);
        let selected = self.pieces.iter().filter(|it| {
            let entity = self.entities.get(it.entity);
            entity.is_some_and(|entity| layers[entity.layer])
        });
        selected
            .map(|it| {
                let piece = it.piece.placed(scale, Point::default());
                let (low, high) = piece.bounds();
                let reach = [low.x, low.z, high.x, high.z].map(f64::abs);
                let size = reach.into_iter().fold(0.0, f64::max);
                // A comparison that is false for NaN, too.
                if size <= MAX_SIZE_MM {
                    Ok(it.with(piece))
                } else {
                    let name = self.entity_name(it.entity);
                    Err(say::outline_too_large(name, size, MAX_SIZE_MM))
                }
            })
            .collect()
    }

    /// The height of the axis in the drawing, mm: the given one, a horizontal centre line, the
    /// middle of an outline that is symmetric, or else zero (DXF) or the lowest point (SVG).
    fn find_axis(
        &self,
        pieces: &[TracedPiece],
        layers: &[bool],
        options: &ProfileOptions,
        notes: &mut Vec<Message>,
    ) -> f64 {
        if let ProfileZero::At(point) = options.zero {
            return point.x;
        }
        let is_center_line = |it: &&TracedPiece| {
            let entity = &self.entities[it.entity];
            let chord = it.piece.chord();
            let is_horizontal = chord.x.abs() <= options.gap && !it.piece.is_arc();
            is_horizontal && entity.entity_use == EntityUse::CenterLine && layers[entity.layer]
        };
        let center_lines = pieces.iter().filter(is_center_line);
        let longest = center_lines.max_by(|a, b| a.piece.length().total_cmp(&b.piece.length()));
        if let Some(line) = longest {
            notes.push(say::outline_note_center_line(
                self.entity_name(line.entity),
                line.piece.start.x,
            ));
            return line.piece.start.x;
        }
        let outline: Vec<&TracedPiece> = pieces.iter().filter(|it| self.is_outline(it)).collect();
        let bounds = outline.iter().map(|it| it.piece.bounds());
        let (low, high) = bounds.fold((f64::MAX, f64::MIN), |(low, high), (below, above)| {
            (low.min(below.x), high.max(above.x))
        });
        let middle = f64::midpoint(low, high);
        let straddles_zero = low < -options.gap && high > options.gap;
        let may_be_full = self.format == DrawingFormat::Svg || straddles_zero;
        let axis = if may_be_full && is_symmetric(&outline, middle, options.gap) {
            middle
        } else if self.format == DrawingFormat::Svg && !outline.is_empty() {
            low
        } else {
            0.0
        };
        notes.push(say::outline_note_axis(axis));
        axis
    }

    fn note_left_out(&self, notes: &mut Vec<Message>) {
        if self.fitted_curves > 0 {
            let tolerance = crate::curve_fit::FIT_TOLERANCE_MM;
            notes.push(say::outline_note_fitted(self.fitted_curves, tolerance));
        }
        if self.annotations > 0 {
            notes.push(say::outline_note_annotations(self.annotations));
        }
    }
}

/// Whether each corner has a counterpart at the other side of a horizontal line.
fn is_symmetric(outline: &[&TracedPiece], middle: f64, gap: f64) -> bool {
    let mut corners: Vec<Point> = (outline.iter().take(MAX_OUTLINE_PIECES))
        .flat_map(|it| [it.piece.start, it.piece.end])
        .collect();
    corners.sort_by(|a, b| a.z.total_cmp(&b.z));
    corners.iter().all(|corner| {
        let image = Point::new(2.0 * middle - corner.x, corner.z);
        let first = corners.partition_point(|other| other.z < image.z - gap);
        let near = corners[first..].iter();
        let mut near = near.take_while(|other| other.z <= image.z + gap);
        near.any(|other| (*other - image).length() <= 2.0 * gap)
    })
}

/// Orders the outline from right to left and removes the face that parting off leaves. A
/// closed section of a tube is opened: its outside remains.
fn orient_chain(
    drawing: &Drawing,
    chain: PieceChain,
    gap: f64,
    notes: &mut Vec<Message>,
) -> Result<Vec<TracedPiece>, DrawingFault> {
    let mut pieces = match chain.is_closed {
        true => {
            let (outside, bore) = open_section(chain.pieces, gap);
            notes.push(say::outline_note_bore(bore * 2.0));
            outside
        }
        false => chain.pieces,
    };
    let ends = pieces.first().zip(pieces.last());
    let Some((first, last)) = ends.map(|(first, last)| (first.piece.start, last.piece.end)) else {
        return Err(say::outline_empty().into());
    };
    if last.z > first.z {
        pieces.reverse();
        for it in &mut pieces {
            it.piece = it.piece.reversed();
        }
    }
    let is_back_face = |it: &TracedPiece| {
        !it.piece.is_arc() && it.piece.chord().z.abs() <= gap && it.piece.chord().x < 0.0
    };
    let mut has_back_face = false;
    while pieces.len() > 1 && pieces.last().is_some_and(is_back_face) {
        pieces.pop();
        has_back_face = true;
    }
    if has_back_face {
        notes.push(say::outline_note_back_face());
    }
    let (lowest, highest) = z_range(&pieces);
    let start = pieces.first().map(|it| (it.piece.start, it.entity));
    let end = pieces.last().map(|it| (it.piece.end, it.entity));
    let open_side = [(start, highest), (end, lowest)]
        .into_iter()
        .find_map(|(end, extreme)| {
            let (at, entity) = end?;
            ((at.z - extreme).abs() > gap).then_some((at, entity, extreme))
        });
    match open_side {
        Some((at, entity, extreme)) => {
            let name = drawing.entity_name(entity);
            let message = say::outline_open_side(name, at.x * 2.0, at.z, extreme);
            Err(DrawingFault::new(message, at))
        }
        None => Ok(pieces),
    }
}

/// The least and greatest Z of pieces.
fn z_range(pieces: &[TracedPiece]) -> (f64, f64) {
    let bounds = pieces.iter().map(|it| it.piece.bounds());
    bounds.fold((f64::MAX, f64::MIN), |(low, high), (below, above)| {
        (low.min(below.z), high.max(above.z))
    })
}

/// The outside of a closed section, from the lowest point of its right face to the highest one
/// of its left face, and the radius of the bore.
fn open_section(mut pieces: Vec<TracedPiece>, gap: f64) -> (Vec<TracedPiece>, f64) {
    let area: f64 = (pieces.iter())
        .map(|it| {
            let steps = (0..8).map(|index| f64::from(index) / 8.0);
            let point = |at| it.piece.point_at(at);
            steps
                .map(|at| point(at).cross(point(at + 0.125)))
                .sum::<f64>()
        })
        .sum();
    if area < 0.0 {
        pieces.reverse();
        for it in &mut pieces {
            it.piece = it.piece.reversed();
        }
    }
    let (lowest, highest) = z_range(&pieces);
    for extreme in [lowest, highest] {
        split_at_extreme(&mut pieces, extreme, gap);
    }
    let index_at = |z: f64, is_better: fn(f64, f64) -> bool| {
        let starts = pieces.iter().enumerate();
        let at_face = starts.filter(|(_, it)| (it.piece.start.z - z).abs() <= gap);
        at_face.fold(None, |best: Option<(usize, f64)>, (index, it)| match best {
            Some((_, x)) if !is_better(it.piece.start.x, x) => best,
            _ => Some((index, it.piece.start.x)),
        })
    };
    let begin = index_at(highest, |x, best| x < best).map_or(0, |(index, _)| index);
    let end = index_at(lowest, |x, best| x > best).map_or(0, |(index, _)| index);
    let count = pieces.len();
    let length = (end + count - begin) % count.max(1);
    let bore = pieces.iter().map(|it| it.piece.bounds().0.x);
    let bore = bore.fold(f64::MAX, f64::min);
    pieces.rotate_left(begin);
    pieces.truncate(if length == 0 { count } else { length });
    (pieces, bore)
}

/// Splits the arc that has its extreme along Z between its ends.
fn split_at_extreme(pieces: &mut Vec<TracedPiece>, extreme: f64, gap: f64) {
    let has_corner = (pieces.iter()).any(|it| (it.piece.start.z - extreme).abs() <= gap);
    if has_corner {
        return;
    }
    let found = pieces.iter().enumerate().find_map(|(index, it)| {
        let mut fractions = it.piece.extremes().into_iter();
        let at = fractions.find(|at| (it.piece.point_at(*at).z - extreme).abs() <= gap)?;
        Some((index, at))
    });
    if let Some((index, at)) = found {
        let traced = pieces[index];
        let (first, second) = traced.piece.split_at(at);
        pieces[index] = traced.with(first);
        pieces.insert(index + 1, traced.with(second));
    }
}

/// The Z of the program zero in the drawing, mm.
fn zero_position(outline: &[TracedPiece], zero: ProfileZero) -> f64 {
    let (lowest, highest) = z_range(outline);
    match zero {
        ProfileZero::Right => highest,
        ProfileZero::Left => lowest,
        ProfileZero::At(point) => point.z,
    }
}
