//! Fits the LCD into its frame, with whole pixels per dot wherever a whole zoom fits.

use egui::{Pos2, Rect, vec2};
use gsk_panel::screen::{HEIGHT, WIDTH};

/// Minimum ratio of a zoom by whole pixels to the greatest zoom that fits; below this ratio the
/// image uses the greatest zoom.
const MIN_FILL: f32 = 0.88;

/// Position and resolution of the LCD image in the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LcdPlacement {
    /// Rectangle of the LCD image, aligned to whole pixels, points.
    pub rect: Rect,
    /// Texture pixels per dot. If no whole zoom fits, the texture is larger than the image,
    /// and the graphics card reduces it.
    pub pixels_per_dot: u32,
    /// Whether each dot is a square of whole physical pixels.
    pub is_crisp: bool,
}

/// Fits the image of the LCD into `bounds`, points.
pub fn fit(bounds: Rect, pixels_per_point: f32) -> LcdPlacement {
    let zoom = (bounds.width() * pixels_per_point / WIDTH as f32)
        .min(bounds.height() * pixels_per_point / HEIGHT as f32)
        .max(0.05);
    let whole = (zoom + 0.01).floor();
    let is_crisp = whole >= 1.0 && whole / zoom >= MIN_FILL;
    let used_zoom = if is_crisp { whole } else { zoom };
    let size = vec2(WIDTH as f32, HEIGHT as f32) * used_zoom;
    let size = vec2(size.x.round(), size.y.round());
    let corner = bounds.center() * pixels_per_point;
    let corner = Pos2::new(
        (corner.x - size.x / 2.0).round(),
        (corner.y - size.y / 2.0).round(),
    );
    let rect = Rect::from_min_size(
        Pos2::new(corner.x / pixels_per_point, corner.y / pixels_per_point),
        size / pixels_per_point,
    );
    let pixels_per_dot = if is_crisp {
        1
    } else {
        (zoom.ceil() as u32).clamp(1, 8)
    };
    LcdPlacement {
        rect,
        pixels_per_dot,
        is_crisp,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_zooms_are_used_where_they_nearly_fill() {
        let room = Rect::from_min_size(Pos2::new(28.3, 60.1), vec2(640.0, 480.0));
        for (pixels_per_point, zoom) in [(1.0, 2.0), (1.5, 3.0), (2.0, 4.0), (1.05, 2.0)] {
            let placement = fit(room, pixels_per_point);
            let physical = placement.rect.width() * pixels_per_point;
            assert!(
                placement.is_crisp && (physical - 320.0 * zoom).abs() < 0.01,
                "{placement:?}"
            );
            let left = placement.rect.left() * pixels_per_point;
            assert!((left - left.round()).abs() < 0.01);
        }
        let between = fit(room, 1.25);
        assert!(!between.is_crisp && between.pixels_per_dot == 3);
        assert!((between.rect.width() * 1.25 - 800.0).abs() < 0.01);
        let tiny = fit(Rect::from_min_size(Pos2::ZERO, vec2(100.0, 75.0)), 1.0);
        assert!(!tiny.is_crisp && tiny.pixels_per_dot == 1);
    }
}
