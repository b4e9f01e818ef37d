//! Random outlines, drawn in random order: the outline found is the one drawn, and the blocks
//! keep it within 0.001 mm.

use core::f64::consts::FRAC_PI_2;

use gsk_units::Point;

use super::*;
use crate::blocks::{ArcFormat, BlockShape, GridEnd, OutlineBlocks};

/// Number of outlines.
const ROUNDS: u64 = 400;
/// What rounding to the grid may change, mm: half an increment of X and of Z, and what an arc
/// adds.
const TOLERANCE_MM: f64 = 0.001_001;

/// An outline of 3 to 20 pieces from the axis, X growing and Z falling.
fn random_outline(numbers: &mut SeededNumbers) -> Vec<ProfilePiece> {
    let mut at = Point::default();
    let mut pieces = Vec::new();
    let count = 3 + numbers.below(18);
    for index in 0..count {
        let rise = numbers.between(0.05, 8.0);
        let run = numbers.between(0.05, 20.0);
        // The face first; no two pieces in one direction.
        let form = if index == 0 { 0 } else { 1 + numbers.below(5) };
        let step = match form {
            0 => Point::new(rise, 0.0),
            1 => Point::new(0.0, -run),
            2 => Point::new(rise, -run * 0.3),
            3 => {
                let radius = numbers.between(0.2, 6.0);
                Point::new(radius, -radius)
            }
            _ => Point::new(rise, -run * 0.5),
        };
        let end = at + step;
        let angle = libm::atan2(step.x, -step.z);
        let steepest = angle.min(FRAC_PI_2 - angle);
        let share = if form == 3 {
            1.0
        } else {
            numbers.between(0.02, 1.0)
        };
        let bulge = match form {
            3..=5 => libm::tan(steepest * share / 2.0),
            _ => 0.0,
        };
        let side = if numbers.below(2) == 0 { 1.0 } else { -1.0 };
        pieces.push(ProfilePiece {
            start: at,
            end,
            bulge: bulge * side,
        });
        at = end;
    }
    pieces
}

/// The drawing of an outline: entities in random order and direction, some as polylines.
fn random_file(pieces: &[ProfilePiece], numbers: &mut SeededNumbers) -> String {
    let mut entities = Vec::new();
    let mut rest = pieces;
    while !rest.is_empty() {
        let take = 1 + numbers.below(rest.len() as u64) as usize;
        let (group, after) = rest.split_at(take);
        rest = after;
        if numbers.below(2) == 0 {
            for piece in group {
                let turned = numbers.below(2) == 0 && !piece.is_arc();
                let piece = if turned { piece.reversed() } else { *piece };
                entities.push(dxf_entity(&piece, "0"));
            }
            continue;
        }
        let mut text = "0\nLWPOLYLINE\n8\n0\n70\n0\n".to_owned();
        for piece in group {
            let Point { x, z } = piece.start;
            text += &format!("10\n{z}\n20\n{x}\n42\n{}\n", piece.bulge);
        }
        if let Some(last) = group.last() {
            text += &format!("10\n{}\n20\n{}\n", last.end.z, last.end.x);
        }
        entities.push(text);
    }
    for index in (1..entities.len()).rev() {
        entities.swap(index, numbers.below(index as u64 + 1) as usize);
    }
    dxf_file(4, &entities.concat())
}

/// Points along an outline with their distance along a piece below 1.
fn sample(pieces: &[ProfilePiece]) -> Vec<Point> {
    let each = pieces.iter().flat_map(|piece| {
        let steps = (0..=40).map(|index| f64::from(index) / 40.0);
        steps.map(|at| piece.point_at(at))
    });
    each.collect()
}

fn distance_to(pieces: &[ProfilePiece], point: Point) -> f64 {
    let to_piece = |piece: &ProfilePiece| {
        let at = piece.fraction_of(point).clamp(0.0, 1.0);
        (piece.point_at(at) - point).length()
    };
    pieces.iter().map(to_piece).fold(f64::MAX, f64::min)
}

/// The path of blocks as the control follows it.
fn path_of(blocks: &OutlineBlocks) -> Vec<ProfilePiece> {
    let point = |end: GridEnd| Point::new(end.x as f64 / 2000.0, end.z as f64 / 1000.0);
    let mut at = point(blocks.start);
    let mut path = Vec::new();
    for block in &blocks.blocks {
        let end = point(block.end);
        let half = (end - at).length() / 2.0;
        let bulge = match block.shape {
            BlockShape::Line => 0.0,
            BlockShape::Radius { clockwise, r } => {
                let r = r as f64 / 1000.0;
                assert!(r >= half, "R {r} is too small for the chord {half}");
                let bulge = libm::tan(libm::asin(half / r) / 2.0);
                if clockwise { -bulge } else { bulge }
            }
            BlockShape::Center { clockwise, i, k } => {
                let center = at + Point::new(i as f64 / 1000.0, k as f64 / 1000.0);
                let (from, to) = (at - center, end - center);
                assert!(
                    (from.length() - to.length()).abs() < 0.002,
                    "the control moves it"
                );
                let mut sweep = libm::atan2(from.cross(to), from.dot(to));
                if clockwise != (sweep < 0.0) {
                    sweep += core::f64::consts::TAU * if clockwise { -1.0 } else { 1.0 };
                }
                libm::tan(sweep / 4.0)
            }
        };
        path.push(ProfilePiece {
            start: at,
            end,
            bulge,
        });
        at = end;
    }
    path
}

#[test]
fn the_outline_found_is_the_one_drawn() {
    for seed in 0..ROUNDS {
        let mut numbers = SeededNumbers::new(seed);
        let drawn = random_outline(&mut numbers);
        let file = random_file(&drawn, &mut numbers);
        let profile = profile_of(&file).unwrap_or_else(|error| panic!("seed {seed}: {error:?}"));
        let found: Vec<ProfilePiece> = profile.pieces().copied().collect();
        assert_eq!(found.len(), drawn.len(), "seed {seed}");
        for (one, other) in drawn.iter().zip(&found) {
            for at in [0.0, 0.37, 1.0] {
                let distance = (one.point_at(at) - other.point_at(at)).length();
                assert!(distance < 1e-6, "seed {seed}: {distance}");
            }
        }
    }
}

#[test]
fn blocks_keep_the_outline_within_a_micrometre() {
    for seed in 0..ROUNDS {
        let mut numbers = SeededNumbers::new(seed);
        let drawn = random_outline(&mut numbers);
        let file = random_file(&drawn, &mut numbers);
        let profile = profile_of(&file).expect("an outline");
        let blocks = profile
            .write_blocks(ArcFormat::RadiusOrCenter, true)
            .expect("blocks");
        let path = path_of(&blocks);
        for (points, others) in [(sample(&path), &drawn), (sample(&drawn), &path)] {
            let distances = points.into_iter().map(|point| distance_to(others, point));
            let greatest = distances.fold(0.0, f64::max);
            assert!(
                greatest <= TOLERANCE_MM,
                "seed {seed}: {greatest}\n{blocks:?}"
            );
        }
        let ends = blocks.blocks.iter().map(|block| block.end);
        let mut at = blocks.start;
        for end in ends {
            assert!(end.x >= at.x && end.z <= at.z, "seed {seed}");
            at = end;
        }
    }
}

#[test]
fn long_flat_and_half_arcs_are_exact() {
    let at = |x: f64, z: f64| Point::new(x, z);
    let arcs = [
        (at(3.333, 0.0), at(3.333, -7.777), 1.0),
        (at(3.333, 0.0), at(3.3337, -7.777), 0.999_99),
        (at(5.0, 0.0), at(5.1, -80.0), 0.000_1),
        (at(5.0, 0.0), at(25.0, -8000.0), 0.000_05),
        (at(1.0, 0.0), at(1.004, -0.004), 0.3),
    ];
    for (start, end, bulge) in arcs {
        for bulge in [bulge, -bulge] {
            let drawn = [ProfilePiece { start, end, bulge }];
            let profile = TurnedProfile {
                traced: vec![crate::drawing::TracedPiece {
                    piece: drawn[0],
                    entity: 0,
                }],
                names: Vec::new(),
                notes: Vec::new(),
            };
            let blocks = profile
                .write_blocks(ArcFormat::RadiusOrCenter, false)
                .expect("blocks");
            let path = path_of(&blocks);
            let distances = sample(&path)
                .into_iter()
                .map(|point| distance_to(&drawn, point));
            let greatest = distances.fold(0.0, f64::max);
            assert!(greatest <= 0.001_2, "{drawn:?}: {greatest}\n{blocks:?}");
        }
    }
}
