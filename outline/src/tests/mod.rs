//! Tests of whole drawings: files in, outlines, blocks and messages out.

mod damaged;
mod drawings;
mod random_outlines;
mod refusals;

use core::fmt::Write as _;

use gsk_messages::Message;
use gsk_units::Point;

use crate::{ProfileOptions, ProfilePiece, TurnedProfile, read_drawing};

/// A sequence of numbers from a seed: xorshift.
struct SeededNumbers(u64);

impl SeededNumbers {
    fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15) | 1)
    }

    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, limit: u64) -> u64 {
        (self.next() >> 11) % limit
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.below(1_000_001) as f64 / 1e6
    }
}

/// A DXF file with these entities.
fn dxf_file(unit: u8, entities: &str) -> String {
    format!(
        "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n{unit}\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n\
         {entities}0\nENDSEC\n0\nEOF\n"
    )
}

/// A line or arc as a DXF entity.
fn dxf_entity(piece: &ProfilePiece, layer: &str) -> String {
    let mut text = String::new();
    match piece.center() {
        None => {
            let (a, b) = (piece.start, piece.end);
            let _ = write!(
                text,
                "0\nLINE\n8\n{layer}\n10\n{}\n20\n{}\n11\n{}\n21\n{}\n",
                a.z, a.x, b.z, b.x
            );
        }
        Some(center) => {
            let angle = |point: Point| {
                let from = point - center;
                libm::atan2(from.x, from.z).to_degrees()
            };
            let (mut begin, mut end) = (angle(piece.start), angle(piece.end));
            if piece.bulge < 0.0 {
                core::mem::swap(&mut begin, &mut end);
            }
            let _ = write!(
                text,
                "0\nARC\n8\n{layer}\n10\n{}\n20\n{}\n40\n{}\n50\n{begin}\n51\n{end}\n",
                center.z,
                center.x,
                piece.radius()
            );
        }
    }
    text
}

/// Lines through corners (Z, radius).
fn lines(corners: &[(f64, f64)]) -> Vec<ProfilePiece> {
    let point = |(z, x): (f64, f64)| Point::new(x, z);
    (corners.windows(2))
        .map(|pair| ProfilePiece::line(point(pair[0]), point(pair[1])))
        .collect()
}

fn dxf_of_pieces(pieces: &[ProfilePiece]) -> String {
    let entities: String = pieces.iter().map(|piece| dxf_entity(piece, "0")).collect();
    dxf_file(4, &entities)
}

fn profile_of(file: &str) -> Result<TurnedProfile, Message> {
    profile_with(file, &ProfileOptions::default())
}

fn profile_with(file: &str, options: &ProfileOptions) -> Result<TurnedProfile, Message> {
    read_drawing(file.as_bytes())?.find_profile(options)
}

/// The corners of an outline: diameter and Z.
fn corners_of(profile: &TurnedProfile) -> Vec<(f64, f64)> {
    let ends: Vec<Point> = profile.pieces().map(|piece| piece.end).collect();
    let start = profile.pieces().next().map(|piece| piece.start);
    let points = start.into_iter().chain(ends);
    points
        .map(|point| {
            let rounded = |value: f64| libm::round(value * 1e6) / 1e6;
            (rounded(point.x * 2.0), rounded(point.z))
        })
        .collect()
}

/// The row of the message that a file is refused with.
fn refusal(file: &str) -> String {
    match profile_of(file) {
        Ok(profile) => panic!("not refused: {profile:?}"),
        Err(message) => message.id().name().to_owned(),
    }
}
