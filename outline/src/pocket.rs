//! Covers the pockets of an outline, so that G71 can rough it.
//!
//! ```text
//!         ____         ____        the cover goes straight over a pocket, at the diameter
//!        |    \_______/    |       in front of it
//!   -----+-----------------+---> Z
//! ```

use gsk_units::Point;

use crate::crossing::meeting_points;
use crate::piece::ProfilePiece;

/// Depth below which a pocket is rounding, mm.
const LEAST_DEPTH_MM: f64 = 0.000_5;

/// An outline whose X never becomes smaller towards the chuck.
#[derive(Clone, Debug, PartialEq)]
pub struct CoveredOutline {
    /// The pieces, with a line over each pocket.
    pub pieces: Vec<ProfilePiece>,
    /// Depth of the deepest pocket, mm; 0 without pockets.
    pub depth: f64,
}

/// Covers the pockets of an outline that never turns back towards Z+.
pub fn cover_pockets(outline: &[ProfilePiece]) -> CoveredOutline {
    let mut cover = CoverBuilder {
        pieces: Vec::new(),
        depth: 0.0,
        at: outline.first().map(|piece| piece.start).unwrap_or_default(),
    };
    for piece in outline {
        let mut rest = *piece;
        let mut done = 0.0;
        for at in piece.extremes() {
            let (first, second) = rest.split_at((at - done) / (1.0 - done));
            cover.add(&first);
            (rest, done) = (second, at);
        }
        cover.add(&rest);
    }
    if let Some(last) = outline.last() {
        let end = Point::new(cover.at.x, last.end.z);
        cover.add_line_to(end);
    }
    CoveredOutline {
        pieces: cover.pieces,
        depth: if cover.depth > LEAST_DEPTH_MM {
            cover.depth
        } else {
            0.0
        },
    }
}

struct CoverBuilder {
    pieces: Vec<ProfilePiece>,
    depth: f64,
    /// The end of the cover: the greatest X so far.
    at: Point,
}

impl CoverBuilder {
    /// Adds a piece along which X only grows or only falls.
    fn add(&mut self, piece: &ProfilePiece) {
        let top = self.at.x;
        self.depth = self.depth.max(top - piece.end.x);
        let (starts_below, ends_below) = (
            piece.start.x < top - LEAST_DEPTH_MM,
            piece.end.x < top - LEAST_DEPTH_MM,
        );
        if ends_below {
            return;
        }
        if !starts_below {
            self.push(*piece);
            return;
        }
        // The piece leaves a pocket.
        let level = ProfilePiece::line(
            Point::new(top, piece.start.z),
            Point::new(top, piece.start.z - 1.0),
        );
        let fractions = meeting_points(piece, &level).into_iter();
        let mut fractions = fractions.map(|point| piece.fraction_of(point));
        let fraction = fractions.find(|at| (0.0..=1.0).contains(at)).unwrap_or(1.0);
        let (_, rising) = piece.split_at(fraction);
        self.push(rising);
    }

    fn push(&mut self, piece: ProfilePiece) {
        self.add_line_to(Point::new(self.at.x, piece.start.z));
        self.pieces.push(ProfilePiece {
            start: self.at,
            ..piece
        });
        self.at = Point::new(piece.end.x.max(self.at.x), piece.end.z);
    }

    fn add_line_to(&mut self, end: Point) {
        if (end - self.at).length() > LEAST_DEPTH_MM {
            self.pieces.push(ProfilePiece::line(self.at, end));
            self.at = end;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rules::CutRule;

    #[test]
    fn a_pocket_is_covered_and_measured() {
        let corners = [
            (10.0, 0.0),
            (10.0, -10.0),
            (7.0, -15.0),
            (7.0, -20.0),
            (13.0, -23.0),
        ];
        let outline: Vec<ProfilePiece> = (corners.windows(2))
            .map(|pair| {
                let point = |(x, z): (f64, f64)| Point::new(x, z);
                ProfilePiece::line(point(pair[0]), point(pair[1]))
            })
            .collect();
        let cover = cover_pockets(&outline);
        assert!((cover.depth - 3.0).abs() < 1e-9);
        let ends: Vec<(f64, f64)> = (cover.pieces.iter())
            .map(|piece| (piece.end.x, libm::round(piece.end.z * 1e6) / 1e6))
            .collect();
        assert_eq!(ends, [(10.0, -10.0), (10.0, -21.5), (13.0, -23.0)]);
        assert_eq!(CutRule::Roughing.find_fault(&cover.pieces), None);
    }

    #[test]
    fn an_arc_that_falls_after_its_top_is_cut_there() {
        let ball = ProfilePiece {
            start: Point::new(0.0, 0.0),
            end: Point::new(0.0, -20.0),
            bulge: 1.0,
        };
        let outline = [ball, ProfilePiece::line(ball.end, Point::new(4.0, -20.0))];
        let cover = cover_pockets(&outline);
        assert!((cover.depth - 10.0).abs() < 1e-9);
        assert_eq!(cover.pieces.len(), 2);
        assert!((cover.pieces[0].end - Point::new(10.0, -10.0)).length() < 1e-9);
        assert_eq!(cover.pieces[1].end, Point::new(10.0, -20.0));
    }
}
