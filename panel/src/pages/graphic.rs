//! Draws the graphic pages: the parameters and the picture of the path (manual III-2.5.2).

use gsk_core::cnc::Cnc;
use gsk_core::units::{Axis, Point};
use gsk_messages::{Message, say};

use super::format::{CoordinateFormat, thousandths};
use super::frame;
use super::graphic_settings::GraphicSettings;
use super::view::PageView;
use crate::bitmap::{Bitmap, DotArea, Stroke};
use crate::face::PageId;
use crate::screen::Screen;
use crate::trace::PathTrace;

/// The area of the LCD in which the path is drawn.
pub(crate) const PLOT: DotArea = DotArea {
    left: 8,
    top: 24,
    right: 223,
    bottom: 199,
};

/// The dot at which the centre of the picture (图形中心) is drawn.
const CENTER: (f64, f64) = (116.0, 112.0);

/// Half the length of the lines that mark the tool, dots.
const MARKER: f64 = 3.0;

/// Draws the page with the settings of the graphic: plane, scale, centre, extents.
pub fn parameters(screen: &mut Screen, view: &PageView) {
    let settings = &view.graphic;
    let rows: [(Message, String, Option<Message>); 8] = [
        (
            say::lcd_graphic_plane(),
            u32::from(settings.zx).to_string(),
            Some(say::as_written("   (XZ:0  ZX:1)")),
        ),
        (say::lcd_graphic_scale(), settings.scale.to_string(), None),
        (
            say::lcd_graphic_center(),
            thousandths(settings.center_x),
            Some(say::lcd_graphic_x_of_work()),
        ),
        (
            say::lcd_graphic_center(),
            thousandths(settings.center_z),
            Some(say::lcd_graphic_z_of_work()),
        ),
        (say::lcd_graphic_x_max(), thousandths(settings.max_x), None),
        (say::lcd_graphic_z_max(), thousandths(settings.max_z), None),
        (say::lcd_graphic_x_min(), thousandths(settings.min_x), None),
        (say::lcd_graphic_z_min(), thousandths(settings.min_z), None),
    ];
    screen.put_message(1, 14, &say::lcd_graphic_parameters());
    let cursor = view.cursors.get(PageId::GraphPar).item.min(rows.len() - 1);
    for (index, (label, value, note)) in rows.into_iter().enumerate() {
        let row = 3 + index;
        if index == cursor {
            screen.put(row, 0, "_");
        }
        let column = screen.put_message(row, 1, &label) + 1;
        let column = screen.put(row, column, &value);
        if let Some(note) = note {
            screen.put_message(row, column, &note);
        }
    }
    frame::setting_line(screen, &format!("{:03}", cursor + 1), view);
}

/// Draws the page with the picture of the tool path.
pub fn picture(screen: &mut Screen, view: &PageView, cnc: &Cnc) {
    let display = CoordinateFormat::of(cnc);
    let at = cnc.position_absolute();
    for (row, (letter, axis)) in (2..).zip([("X", Axis::X), ("Z", Axis::Z)]) {
        screen.put(row, 29, letter);
        screen.put_right(row, 40, &display.coordinate(axis, at.get(axis)));
    }
    let choices = [
        (6, say::lcd_graphic_draw(), view.graphic.drawing),
        (7, say::lcd_graphic_stop(), !view.graphic.drawing),
        (8, say::lcd_graphic_clear(), false),
    ];
    for (row, text, chosen) in choices {
        if chosen {
            screen.put(row, 29, "*");
        }
        screen.put_message(row, 30, &text);
    }
    let plot = Plot::new(&view.graphic, display, cnc.parameters().is_up_positive());
    let dots = screen.graphic_mut();
    plot.trace(dots, &view.trace);
    plot.marker(dots, at);
}

/// Converts work coordinates (X as a radius, mm) to dots of the LCD.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plot {
    center: Point,
    dots_per_mm: f64,
    zx: bool,
    /// Whether +X points up in the ZX picture (rear tool post, 175.0 = 1).
    x_up: bool,
}

impl Plot {
    fn new(settings: &GraphicSettings, display: CoordinateFormat, x_up: bool) -> Self {
        Self {
            center: settings.center(display.diameter),
            dots_per_mm: settings.dots_per_mm(),
            zx: settings.zx,
            x_up,
        }
    }

    fn dot(&self, point: Point) -> (f64, f64) {
        let from_center = (point - self.center) * self.dots_per_mm;
        let (right, up) = match (self.zx, self.x_up) {
            (true, true) => (from_center.z, from_center.x),
            (true, false) => (from_center.z, -from_center.x),
            (false, _) => (from_center.x, from_center.z),
        };
        (CENTER.0 + right, CENTER.1 - up)
    }

    fn trace(&self, dots: &mut Bitmap, trace: &PathTrace) {
        for segment in trace.segments() {
            let stroke = if segment.rapid {
                Stroke::Dotted
            } else {
                Stroke::Solid
            };
            dots.line(self.dot(segment.from), self.dot(segment.to), stroke, PLOT);
        }
    }

    /// Draws a cross at the position `at` of the tool, in work coordinates.
    fn marker(&self, dots: &mut Bitmap, at: Point) {
        let (x, y) = self.dot(at);
        dots.line((x - MARKER, y), (x + MARKER, y), Stroke::Solid, PLOT);
        dots.line((x, y - MARKER), (x, y + MARKER), Stroke::Solid, PLOT);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings() -> GraphicSettings {
        let mut settings = GraphicSettings {
            zx: true,
            max_x: 150_000,
            max_z: 200_000,
            min_x: -10_000,
            min_z: -10_000,
            ..GraphicSettings::default()
        };
        settings.recompute();
        settings
    }

    const DIAMETER: CoordinateFormat = CoordinateFormat {
        diameter: true,
        inch: false,
    };

    #[test]
    fn the_centre_of_the_picture_is_the_centre_of_the_plot() {
        let plot = Plot::new(&settings(), DIAMETER, false);
        assert_eq!(plot.dot(Point::new(35.0, 95.0)), CENTER);
        assert_eq!(CENTER.0, f64::from((PLOT.left + PLOT.right + 1) / 2));
        assert_eq!(CENTER.1, f64::from((PLOT.top + PLOT.bottom + 1) / 2));
    }

    #[test]
    fn z_goes_right_and_x_down_for_a_front_tool_post() {
        let point = Point::new(45.0, 105.0);
        let front = Plot::new(&settings(), DIAMETER, false).dot(point);
        assert!((front.0 - 123.1).abs() < 1e-9 && (front.1 - 119.1).abs() < 1e-9);
        let rear = Plot::new(&settings(), DIAMETER, true).dot(point);
        assert!((rear.1 - 104.9).abs() < 1e-9);
        let xz = GraphicSettings {
            zx: false,
            ..settings()
        };
        let upright = Plot::new(&xz, DIAMETER, false).dot(point);
        assert!((upright.0 - 123.1).abs() < 1e-9 && (upright.1 - 104.9).abs() < 1e-9);
    }
}
