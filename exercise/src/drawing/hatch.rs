//! Hatches the cut material of a section.

use super::PaperPoint;

/// Returns hatch lines at 45° inside a closed polygon, `distance` apart, in units of the drawing.
pub fn hatch(polygon: &[PaperPoint], distance: f64) -> Vec<[PaperPoint; 2]> {
    // Along a line at 45° the sum of both coordinates is constant.
    let sums = polygon.iter().map(|point| point.right + point.down);
    let (least, most) = sums.fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), sum| {
        (least.min(sum), most.max(sum))
    });
    let mut lines = Vec::new();
    if !(least.is_finite() && most.is_finite() && distance > 0.0) {
        return lines;
    }
    let first = (least / distance).ceil() as i64;
    let last = (most / distance).floor() as i64;
    for number in first..=last {
        // A little beside the corners, which usually have whole coordinates.
        let sum = number as f64 * distance + distance * 1e-3;
        let mut crossings: Vec<PaperPoint> = Vec::new();
        for (index, from) in polygon.iter().enumerate() {
            let to = polygon[(index + 1) % polygon.len()];
            let (before, after) = (from.right + from.down - sum, to.right + to.down - sum);
            if (before < 0.0) == (after < 0.0) {
                continue;
            }
            let part = before / (before - after);
            crossings.push(PaperPoint {
                right: from.right + (to.right - from.right) * part,
                down: from.down + (to.down - from.down) * part,
            });
        }
        crossings.sort_by(|one, other| one.right.total_cmp(&other.right));
        lines.extend(crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
    }
    lines
}
