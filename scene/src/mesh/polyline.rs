//! Closed lines with fewer points.

use glam::Vec2;

/// Removes points of a closed line that are closer than `tolerance` to the line without them.
pub(crate) fn simplify(points: &[Vec2], tolerance: f32) -> Vec<Vec2> {
    let Some(&first) = points.first() else {
        return Vec::new();
    };
    let mut keep = vec![false; points.len()];
    let farthest = (0..points.len())
        .max_by(|&a, &b| {
            points[a]
                .distance(first)
                .total_cmp(&points[b].distance(first))
        })
        .unwrap_or(0);
    keep[0] = true;
    keep[farthest] = true;
    let mut open = vec![(0, farthest), (farthest, points.len())];
    while let Some((from, to)) = open.pop() {
        let (a, b) = (points[from], points[to % points.len()]);
        let along = (b - a).normalize_or_zero();
        let distance = |at: usize| match along == Vec2::ZERO {
            true => points[at].distance(a),
            false => along.perp_dot(points[at] - a).abs(),
        };
        let worst = (from + 1..to).max_by(|&p, &q| distance(p).total_cmp(&distance(q)));
        if let Some(at) = worst.filter(|&at| distance(at) > tolerance) {
            keep[at] = true;
            open.extend([(from, at), (at, to)]);
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}
