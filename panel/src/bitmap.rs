//! Stores a one-bit picture of the LCD's size and draws lines on it.

use crate::lcd::{COLUMNS, HEIGHT, WIDTH};

/// A picture of the whole LCD, 320×240 dots, one bit each.
#[derive(Clone, PartialEq, Eq)]
pub struct Bitmap {
    /// 40 bytes a dot row; bit 7 of a byte is its leftmost dot.
    bytes: Box<[u8]>,
}

/// A rectangle of LCD dots; the edge dots belong to it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct DotArea {
    /// X of the leftmost dots in the rectangle, from 0.
    pub left: i32,
    /// Y of the topmost dots, from 0 (top of the LCD).
    pub top: i32,
    /// X of the rightmost dots in the rectangle.
    pub right: i32,
    /// Y of the lowest dots in the rectangle.
    pub bottom: i32,
}

impl DotArea {
    /// The rectangle of the whole LCD.
    pub const LCD: Self = Self {
        left: 0,
        top: 0,
        right: WIDTH as i32 - 1,
        bottom: HEIGHT as i32 - 1,
    };

    /// Returns whether the dot (`x`, `y`) is inside the rectangle.
    pub const fn contains(&self, x: i32, y: i32) -> bool {
        x >= self.left && x <= self.right && y >= self.top && y <= self.bottom
    }
}

/// The dot pattern of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stroke {
    /// Draws every dot of the line.
    Solid,
    /// Draws every third dot, counted from the LCD's edge, so that segments of a path join
    /// without a seam.
    Dotted,
}

impl Stroke {
    /// Whether the line's dot at `along`, its coordinate on the longer axis, is drawn.
    const fn draws(self, along: i32) -> bool {
        match self {
            Self::Solid => true,
            Self::Dotted => along.rem_euclid(3) == 0,
        }
    }
}

impl Default for Bitmap {
    fn default() -> Self {
        Self::new()
    }
}

impl Bitmap {
    /// Creates a picture in which no dot is set.
    pub fn new() -> Self {
        Self {
            bytes: vec![0; COLUMNS * HEIGHT].into_boxed_slice(),
        }
    }

    /// Clears every dot of the picture.
    pub fn clear(&mut self) {
        self.bytes.fill(0);
    }

    /// Returns the 40 bytes of dot row `y` (from 0 at the top), the leftmost dot in bit 7 of
    /// the first. Returns an empty slice below the LCD.
    pub fn row(&self, y: usize) -> &[u8] {
        self.bytes
            .get(y * COLUMNS..(y + 1) * COLUMNS)
            .unwrap_or(&[])
    }

    /// Returns whether the dot (`x`, `y`) is set; `false` outside the LCD.
    pub fn get(&self, x: i32, y: i32) -> bool {
        if !DotArea::LCD.contains(x, y) {
            return false;
        }
        self.bytes[y as usize * COLUMNS + x as usize / 8] & (0x80 >> (x % 8)) != 0
    }

    /// Sets the dot (`x`, `y`). Ignores dots outside the LCD.
    pub fn set(&mut self, x: i32, y: i32) {
        if DotArea::LCD.contains(x, y) {
            self.bytes[y as usize * COLUMNS + x as usize / 8] |= 0x80 >> (x % 8);
        }
    }

    /// Sets every dot that is set in the picture `other`.
    pub fn add(&mut self, other: &Self) {
        for (mine, theirs) in self.bytes.iter_mut().zip(&other.bytes) {
            *mine |= theirs;
        }
    }

    /// Sets those of eight dots that are 1 in `dots` (bit 7 leftmost), then inverts all eight
    /// if `invert` is true. `column` counts bytes from the left edge.
    pub(crate) fn combine(&mut self, column: usize, y: usize, dots: u8, invert: bool) {
        if column < COLUMNS && y < HEIGHT {
            let byte = &mut self.bytes[y * COLUMNS + column];
            *byte |= dots;
            if invert {
                *byte = !*byte;
            }
        }
    }

    /// Draws a line between two points, in dots with fractions. Dots outside `area` are not
    /// drawn.
    pub fn line(&mut self, from: (f64, f64), to: (f64, f64), stroke: Stroke, area: DotArea) {
        let Some((from, to)) = clip(from, to, area) else {
            return;
        };
        self.dot_line(from, to, stroke);
    }

    /// Draws a line between two dots of the LCD (Bresenham).
    fn dot_line(&mut self, (mut x, mut y): (i32, i32), (x1, y1): (i32, i32), stroke: Stroke) {
        let (dx, dy) = ((x1 - x).abs(), -(y1 - y).abs());
        let (step_x, step_y) = ((x1 - x).signum(), (y1 - y).signum());
        let along_x = dx >= -dy;
        let mut error = dx + dy;
        loop {
            if stroke.draws(if along_x { x } else { y }) {
                self.set(x, y);
            }
            if x == x1 && y == y1 {
                return;
            }
            let twice = 2 * error;
            if twice >= dy {
                error += dy;
                x += step_x;
            }
            if twice <= dx {
                error += dx;
                y += step_y;
            }
        }
    }
}

impl core::fmt::Debug for Bitmap {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        let dots: u32 = self.bytes.iter().map(|byte| byte.count_ones()).sum();
        write!(f, "Bitmap({dots} dots)")
    }
}

/// Returns both ends of the line's part inside `area`, as dots; `None` if the line misses it.
fn clip(from: (f64, f64), to: (f64, f64), area: DotArea) -> Option<((i32, i32), (i32, i32))> {
    let (start, end) = (nearest(from), nearest(to));
    if area.contains(start.0, start.1) && area.contains(end.0, end.1) {
        return Some((start, end));
    }
    let (dx, dy) = (to.0 - from.0, to.1 - from.1);
    if !(dx.is_finite() && dy.is_finite()) {
        return None;
    }
    let left = f64::from(area.left) - 0.5;
    let right = f64::from(area.right) + 0.5;
    let top = f64::from(area.top) - 0.5;
    let bottom = f64::from(area.bottom) + 0.5;
    let edges = [
        (-dx, from.0 - left),
        (dx, right - from.0),
        (-dy, from.1 - top),
        (dy, bottom - from.1),
    ];
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for (toward, margin) in edges {
        if toward == 0.0 {
            if margin < 0.0 {
                return None;
            }
            continue;
        }
        let at = margin / toward;
        if toward < 0.0 {
            first = first.max(at);
        } else {
            last = last.min(at);
        }
    }
    if first > last {
        return None;
    }
    let dot_at = |at: f64| {
        let (x, y) = nearest((from.0 + dx * at, from.1 + dy * at));
        (
            x.clamp(area.left, area.right),
            y.clamp(area.top, area.bottom),
        )
    };
    Some((dot_at(first), dot_at(last)))
}

/// Returns the dot of the LCD nearest to a point.
fn nearest((x, y): (f64, f64)) -> (i32, i32) {
    ((x + 0.5).floor() as i32, (y + 0.5).floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dots(bitmap: &Bitmap) -> Vec<(i32, i32)> {
        (0..HEIGHT as i32)
            .flat_map(|y| (0..WIDTH as i32).map(move |x| (x, y)))
            .filter(|(x, y)| bitmap.get(*x, *y))
            .collect()
    }

    #[test]
    fn a_line_contains_both_ends() {
        let mut bitmap = Bitmap::new();
        bitmap.line((1.0, 1.0), (4.0, 2.0), Stroke::Solid, DotArea::LCD);
        assert_eq!(dots(&bitmap), [(1, 1), (2, 1), (3, 2), (4, 2)]);
    }

    #[test]
    fn a_point_is_one_dot() {
        let mut bitmap = Bitmap::new();
        bitmap.line((7.4, 3.6), (7.4, 3.6), Stroke::Solid, DotArea::LCD);
        assert_eq!(dots(&bitmap), [(7, 4)]);
    }

    #[test]
    fn a_line_is_cut_to_its_area() {
        let area = DotArea {
            left: 10,
            top: 10,
            right: 12,
            bottom: 12,
        };
        let mut bitmap = Bitmap::new();
        bitmap.line((-1e9, 11.0), (1e9, 11.0), Stroke::Solid, area);
        bitmap.line((0.0, 0.0), (300.0, 9.0), Stroke::Solid, area);
        bitmap.line((f64::NAN, 0.0), (11.0, 11.0), Stroke::Solid, area);
        assert_eq!(dots(&bitmap), [(10, 11), (11, 11), (12, 11)]);
    }

    #[test]
    fn a_dotted_line_is_the_same_in_segments() {
        let mut whole = Bitmap::new();
        whole.line((0.0, 5.0), (30.0, 5.0), Stroke::Dotted, DotArea::LCD);
        let mut segments = Bitmap::new();
        for x in 0..30 {
            let x = f64::from(x);
            segments.line((x, 5.0), (x + 1.0, 5.0), Stroke::Dotted, DotArea::LCD);
        }
        assert_eq!(dots(&whole), dots(&segments));
        assert_eq!(dots(&whole).len(), 11);
    }
}
