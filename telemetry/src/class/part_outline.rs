//! The half section of the part, coarse: what a tile of the class shows.

use serde::{Deserialize, Serialize};

/// Greatest number of points of an outline.
const MAX_POINTS: usize = 160;
/// Greatest coordinate that a tile shows, mm.
const MAX_MM: f32 = 10_000.0;

/// The half section of the part: closed lines of points Z, X (a radius), mm.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct CoarseOutline {
    /// The lines.
    pub lines: Vec<Vec<[f32; 2]>>,
}

impl CoarseOutline {
    /// Makes an outline coarse: points that lie within a tolerance of a straight line are left
    /// out, until few enough remain.
    pub fn from_lines(lines: &[Vec<[f32; 2]>]) -> Self {
        let mut tolerance = 0.02;
        loop {
            let coarse: Vec<Vec<[f32; 2]>> = lines
                .iter()
                .map(|line| simplify(line, tolerance))
                .filter(|line| line.len() > 2)
                .collect();
            let points: usize = coarse.iter().map(Vec::len).sum();
            if points <= MAX_POINTS || tolerance > 10.0 {
                let rounded = |value: f32| (value * 100.0).round() / 100.0;
                let lines = coarse.into_iter().take(MAX_POINTS / 4);
                let lines = lines.map(|line| line.into_iter().take(MAX_POINTS));
                return Self {
                    lines: lines
                        .map(|line| line.map(|point| point.map(rounded)).collect())
                        .collect(),
                };
            }
            tolerance *= 2.0;
        }
    }

    /// Parses an outline; `None` for malformed bytes, for too many points or for points that no
    /// lathe has.
    pub fn parse(payload: &[u8]) -> Option<Self> {
        let outline: Self = serde_json::from_slice(payload).ok()?;
        let points = outline.lines.iter().flatten();
        let is_valid = |[z, x]: &[f32; 2]| z.abs() <= MAX_MM && (0.0..=MAX_MM).contains(x);
        let count = points.clone().count();
        (count <= 2 * MAX_POINTS && points.into_iter().all(is_valid)).then_some(outline)
    }

    /// The outline as JSON.
    pub fn to_json(&self) -> String {
        serde_json::to_string(self).unwrap_or_default()
    }
}

/// Leaves out points of a closed line that are closer than `tolerance` to the line between the
/// last kept point and the next one.
fn simplify(line: &[[f32; 2]], tolerance: f32) -> Vec<[f32; 2]> {
    let mut kept: Vec<[f32; 2]> = Vec::new();
    for (index, point) in line.iter().enumerate() {
        let next = line[(index + 1) % line.len()];
        let last = kept.last().copied().unwrap_or(line[line.len() - 1]);
        if distance(*point, last, next) > tolerance {
            kept.push(*point);
        }
    }
    kept
}

/// Distance of a point from the line through two others; from the first one if both are equal.
fn distance(point: [f32; 2], from: [f32; 2], to: [f32; 2]) -> f32 {
    let (dz, dx) = (to[0] - from[0], to[1] - from[1]);
    let (pz, px) = (point[0] - from[0], point[1] - from[1]);
    let length = dz.hypot(dx);
    match length > 1e-6 {
        true => (dz * px - dx * pz).abs() / length,
        false => pz.hypot(px),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn outlines_are_coarse_and_keep_their_corners() {
        // A rectangle with many points on its edges.
        let mut line: Vec<[f32; 2]> = (0..1000).map(|z| [z as f32 * 0.1, 0.0]).collect();
        line.push([100.0, 20.0]);
        line.push([0.0, 20.0]);
        let outline = CoarseOutline::from_lines(&[line]);
        assert_eq!(outline.lines.len(), 1);
        let corners = &outline.lines[0];
        assert!(
            corners.len() <= 5 && corners.contains(&[100.0, 20.0]),
            "{corners:?}"
        );
        assert_eq!(
            CoarseOutline::parse(outline.to_json().as_bytes()),
            Some(outline)
        );
        // A thread has more corners than a tile shows.
        let zigzag: Vec<[f32; 2]> = (0..5000)
            .map(|at| [at as f32 * 0.5, 10.0 + (at % 2) as f32])
            .collect();
        let points: usize = CoarseOutline::from_lines(&[zigzag])
            .lines
            .iter()
            .map(Vec::len)
            .sum();
        assert!(points <= MAX_POINTS, "{points}");
    }

    #[test]
    fn malformed_outlines_are_refused() {
        for text in [
            "",
            "7",
            r#"{"lines":[[[1]]]}"#,
            r#"{"lines":[[[1,-5]]]}"#,
            r#"{"lines":[[[1e30,5]]]}"#,
        ] {
            assert_eq!(CoarseOutline::parse(text.as_bytes()), None, "{text}");
        }
        let many = CoarseOutline {
            lines: vec![vec![[0.0, 0.0]; 2 * MAX_POINTS + 1]],
        };
        assert_eq!(CoarseOutline::parse(many.to_json().as_bytes()), None);
    }
}
