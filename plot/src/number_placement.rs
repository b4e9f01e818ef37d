//! Places the numbers of blocks at their ends, so that none covers another one.

use crate::text_width::text_width;

/// Height of a block label, picture units.
pub(super) const HEIGHT: f64 = 16.0;

/// Gap between the end of a block and its label, picture units.
const NUMBER_GAP: f64 = 4.0;

/// Side length of a square of the occupancy map, picture units.
const SQUARE_SIDE: f64 = 8.0;

/// A block label with its position in the picture.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedNumber {
    /// End point of the block, picture units.
    pub end: (f64, f64),
    /// Upper left corner of the label's text, picture units.
    pub corner: (f64, f64),
    /// The text of the label: `N10`, or the line number.
    pub text: String,
}

/// An area of the picture in picture units: left, top, right, bottom.
pub(super) type PictureArea = (f64, f64, f64, f64);

/// Places labels at the ends of blocks in the free parts of a frame, in their order. Labels
/// without free space are omitted.
pub(super) fn place_numbers(
    numbers: impl Iterator<Item = ((f64, f64), String)>,
    frame: PictureArea,
    occupancy: &mut OccupancyMap,
) -> Vec<PlacedNumber> {
    let inside =
        |(x, y): (f64, f64)| (frame.0..=frame.2).contains(&x) && (frame.1..=frame.3).contains(&y);
    numbers
        .filter(|(end, _)| inside(*end))
        .filter_map(|(end, words)| {
            let wide = text_width(&words);
            let (left, right) = (end.0 - NUMBER_GAP - wide, end.0 + NUMBER_GAP);
            let (above, below) = (end.1 - HEIGHT, end.1);
            let corners = [(right, above), (left, above), (right, below), (left, below)];
            let at = corners
                .into_iter()
                .find(|(x, y)| occupancy.occupy((*x, *y, x + wide, y + HEIGHT)))?;
            Some(PlacedNumber {
                end,
                corner: at,
                text: words,
            })
        })
        .collect()
}

/// The squares of a frame that texts already occupy.
pub(super) struct OccupancyMap {
    frame: PictureArea,
    across: usize,
    squares: Vec<bool>,
}

impl OccupancyMap {
    /// Creates a map of a frame without occupied squares.
    pub fn new(frame: PictureArea) -> Self {
        let squares = |length: f64| (length.max(0.0) / SQUARE_SIDE).ceil() as usize + 1;
        let (across, down) = (squares(frame.2 - frame.0), squares(frame.3 - frame.1));
        Self {
            frame,
            across,
            squares: vec![false; across * down],
        }
    }

    /// Occupies an area, in picture units, if it is in the frame and free. Returns whether it
    /// was.
    pub fn occupy(&mut self, area: PictureArea) -> bool {
        let (left, top, right, bottom) = self.frame;
        if area.0 < left || area.1 < top || area.2 > right || area.3 > bottom {
            return false;
        }
        let square = |from: f64, to: f64| ((to - from) / SQUARE_SIDE) as usize;
        let columns = square(left, area.0)..=square(left, area.2);
        let rows = square(top, area.1)..=square(top, area.3);
        let all = || {
            let across = self.across;
            let columns = columns.clone();
            rows.clone()
                .flat_map(move |row| columns.clone().map(move |column| row * across + column))
        };
        let taken: Vec<usize> = all().collect();
        let free = |index: &usize| self.squares.get(*index) == Some(&false);
        if !taken.iter().all(free) {
            return false;
        }
        for index in taken {
            if let Some(square) = self.squares.get_mut(index) {
                *square = true;
            }
        }
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_do_not_cover_each_other_and_stay_in_the_frame() {
        let frame = (70.0, 60.0, 570.0, 360.0);
        let ends = (0..500).map(|index| {
            let at = f64::from(index);
            ((60.0 + at * 1.1, 50.0 + at * 0.7), format!("N{index}"))
        });
        let numbers = place_numbers(ends, frame, &mut OccupancyMap::new(frame));
        assert!((20..200).contains(&numbers.len()), "{}", numbers.len());
        let area = |number: &PlacedNumber| {
            let (x, y) = number.corner;
            (x, y, x + text_width(&number.text), y + HEIGHT)
        };
        for (index, number) in numbers.iter().enumerate() {
            let (left, top, right, bottom) = area(number);
            assert!(left >= frame.0 && top >= frame.1 && right <= frame.2 && bottom <= frame.3);
            for other in &numbers[..index] {
                let other = area(other);
                let apart =
                    left >= other.2 || right <= other.0 || top >= other.3 || bottom <= other.1;
                assert!(apart, "{number:?}");
            }
        }
    }
}
