//! Sets the zoom of the window: suitable for the monitor, or as the operator has chosen.

use egui::{Context, Event, Id, Key, Vec2};

use crate::WindowSettings;

/// The zoom levels that the menu offers, per cent.
pub const ZOOM_CHOICES: [u16; 8] = [75, 100, 125, 150, 175, 200, 250, 300];
/// Length of the shorter side of a monitor at which the zoom is 100 per cent, pixels.
const REFERENCE_SIDE: f32 = 1080.0;

/// Zoom for a monitor with this number of pixels whose system reports no scale, per cent: a
/// multiple of 50, at least 100. `native`: physical pixels per point that the system reports.
pub fn zoom_for_monitor(pixels: Vec2, native: f32) -> u16 {
    let ratio = pixels.min_elem() / REFERENCE_SIDE / native.max(0.1);
    let halves = (ratio * 2.0).floor().clamp(2.0, 6.0);
    (halves * 50.0) as u16
}

/// The monitor on which the window opened: size and scale.
#[derive(Clone, Copy, Debug)]
struct Monitor {
    pixels: Vec2,
    /// Number of physical pixels per point that the system reports.
    pixels_per_point: f32,
}

impl Monitor {
    /// Returns the monitor of the context; `None` until the system reports it.
    fn of_context(context: &Context) -> Option<Self> {
        let id = Id::unique("monitor");
        let cached = context.data(|data| data.get_temp(id));
        // With a zoom, the reported size in points is out of date for some frames.
        if cached.is_some() || (context.zoom_factor() - 1.0).abs() > 0.001 {
            return cached;
        }
        let per_point = context.pixels_per_point();
        let monitor = context.input(|input| {
            let viewport = input.viewport();
            Some(Self {
                pixels: viewport.monitor_size? * per_point,
                pixels_per_point: viewport.native_pixels_per_point?,
            })
        });
        if let Some(found) = monitor {
            context.data_mut(|data| data.insert_temp(id, found));
        }
        monitor
    }
}

/// Applies the zoom of the settings, or that for the monitor, from the next frame on. Returns
/// the size of the monitor in points of this zoom; `None` until it is in effect.
pub fn apply(context: &Context, settings: &WindowSettings) -> Option<Vec2> {
    let monitor = Monitor::of_context(context);
    let monitor_zoom = monitor.map_or(100, |it| zoom_for_monitor(it.pixels, it.pixels_per_point));
    let zoom_factor = f32::from(settings.zoom.unwrap_or(monitor_zoom)) / 100.0;
    if (context.zoom_factor() - zoom_factor).abs() > 0.001 {
        context.set_zoom_factor(zoom_factor);
        return None;
    }
    Some(monitor?.pixels / context.pixels_per_point())
}

/// Handles the zoom keys: Ctrl with plus or minus selects the next choice, Ctrl+0 lets the
/// monitor determine the zoom.
pub fn handle_keys(context: &Context, events: &[Event], settings: &mut WindowSettings) {
    let current = (context.zoom_factor() * 100.0).round() as u16;
    for event in events {
        let Event::Key {
            key,
            pressed: true,
            modifiers,
            ..
        } = event
        else {
            continue;
        };
        if !modifiers.ctrl || modifiers.alt {
            continue;
        }
        let chosen = match key {
            Key::Plus | Key::Equals => ZOOM_CHOICES.into_iter().find(|it| *it > current),
            Key::Minus => ZOOM_CHOICES.into_iter().rfind(|it| *it < current),
            Key::Num0 => {
                settings.zoom = None;
                continue;
            }
            _ => continue,
        };
        settings.zoom = chosen.or(settings.zoom);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::vec2;

    #[test]
    fn only_a_monitor_without_system_scale_is_zoomed() {
        for (pixels, native, per_cent) in [
            (vec2(1024.0, 768.0), 1.0, 100),
            (vec2(1920.0, 1080.0), 1.0, 100),
            (vec2(2560.0, 1440.0), 1.0, 100),
            (vec2(3840.0, 2160.0), 1.0, 200),
            (vec2(3840.0, 2160.0), 2.0, 100),
            (vec2(800.0, 1280.0), 1.0, 100),
            (vec2(7680.0, 4320.0), 1.0, 300),
        ] {
            assert_eq!(
                zoom_for_monitor(pixels, native),
                per_cent,
                "{pixels} at {native}"
            );
        }
    }
}
