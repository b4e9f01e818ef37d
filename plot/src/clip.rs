//! Clips lines at a frame.

use crate::number_placement::PictureArea;

type ClipPoint = (f64, f64);

/// Calls `each` with every part of a polyline that is inside a frame.
pub(super) fn clip_to_frame(
    points: impl Iterator<Item = ClipPoint>,
    frame: PictureArea,
    mut each: impl FnMut(&[ClipPoint]),
) {
    let mut part: Vec<ClipPoint> = Vec::new();
    let mut points = points;
    let Some(mut last) = points.next() else {
        return;
    };
    for point in points {
        match clip_segment(last, point, frame) {
            Some((from, to)) => {
                if part.last() != Some(&from) {
                    if part.len() > 1 {
                        each(&part);
                    }
                    part.clear();
                    part.push(from);
                }
                part.push(to);
            }
            None => {
                if part.len() > 1 {
                    each(&part);
                }
                part.clear();
            }
        }
        last = point;
    }
    if part.len() > 1 {
        each(&part);
    }
}

/// The part of a straight line that is in the frame (Liang and Barsky); `None` if the line
/// misses it.
fn clip_segment(
    from: ClipPoint,
    to: ClipPoint,
    frame: PictureArea,
) -> Option<(ClipPoint, ClipPoint)> {
    let (across, down) = (to.0 - from.0, to.1 - from.1);
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    let sides = [
        (-across, from.0 - frame.0),
        (across, frame.2 - from.0),
        (-down, from.1 - frame.1),
        (down, frame.3 - from.1),
    ];
    for (outward, room) in sides {
        if outward == 0.0 {
            if room < 0.0 {
                return None;
            }
        } else if outward < 0.0 {
            first = first.max(room / outward);
        } else {
            last = last.min(room / outward);
        }
    }
    if first > last {
        return None;
    }
    let at = |part: f64| (from.0 + across * part, from.1 + down * part);
    let begin = if first > 0.0 { at(first) } else { from };
    let end = if last < 1.0 { at(last) } else { to };
    Some((begin, end))
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAME: PictureArea = (0.0, 0.0, 10.0, 10.0);

    fn parts(points: &[ClipPoint]) -> Vec<Vec<ClipPoint>> {
        let mut out = Vec::new();
        clip_to_frame(points.iter().copied(), FRAME, |part| {
            out.push(part.to_vec());
        });
        out
    }

    #[test]
    fn what_lies_inside_is_whole() {
        let inside = [(1.0, 1.0), (9.0, 1.0), (9.0, 10.0)];
        assert_eq!(parts(&inside), [inside.to_vec()]);
    }

    #[test]
    fn lines_end_at_the_frame_and_begin_there_again() {
        let through = [
            (5.0, 5.0),
            (15.0, 5.0),
            (15.0, 7.0),
            (5.0, 7.0),
            (5.0, 20.0),
        ];
        assert_eq!(
            parts(&through),
            [
                vec![(5.0, 5.0), (10.0, 5.0)],
                vec![(10.0, 7.0), (5.0, 7.0), (5.0, 10.0)],
            ]
        );
        assert!(parts(&[(-5.0, 3.0), (-5.0, 8.0), (4.0, 30.0)]).is_empty());
    }
}
