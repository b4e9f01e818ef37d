//! Sets the zoom of the window: suitable for the monitor, or as the operator has chosen.

use egui::{Context, Event, Id, Key, Vec2};

use super::Settings;

/// The choices of the menu, per cent.
pub const CHOICES: [u16; 8] = [75, 100, 125, 150, 175, 200, 250, 300];
/// Pixels of the shorter side of a monitor at which the zoom is 100 per cent.
const SHORTER_SIDE: f32 = 1080.0;

/// Zoom for a monitor with `pixels` whose system reports no scale, per cent: a multiple of 50,
/// at least 100. `native`: physical pixels per point that the system reports.
pub fn by_monitor(pixels: Vec2, native: f32) -> u16 {
    let times = pixels.min_elem() / SHORTER_SIDE / native.max(0.1);
    let halves = (times * 2.0).floor().clamp(2.0, 6.0);
    (halves * 50.0) as u16
}

/// The monitor on which the window opened.
#[derive(Clone, Copy, Debug)]
struct Monitor {
    pixels: Vec2,
    /// Physical pixels per point that the system reports.
    native: f32,
}

impl Monitor {
    /// The monitor of the context, as soon as the system reports it.
    fn of(context: &Context) -> Option<Self> {
        let id = Id::unique("monitor");
        let known = context.data(|data| data.get_temp(id));
        // With a zoom, the reported size in points is out of date for some frames.
        if known.is_some() || (context.zoom_factor() - 1.0).abs() > 0.001 {
            return known;
        }
        let per_point = context.pixels_per_point();
        let found = context.input(|input| {
            let viewport = input.viewport();
            Some(Self {
                pixels: viewport.monitor_size? * per_point,
                native: viewport.native_pixels_per_point?,
            })
        });
        if let Some(found) = found {
            context.data_mut(|data| data.insert_temp(id, found));
        }
        found
    }
}

/// Applies the zoom of the settings, or of the monitor, from the next frame on. Returns the
/// size of the monitor in points of this zoom, once it is in effect.
pub fn follow(context: &Context, settings: &Settings) -> Option<Vec2> {
    let monitor = Monitor::of(context);
    let asked = monitor.map_or(100, |it| by_monitor(it.pixels, it.native));
    let wanted = f32::from(settings.zoom.unwrap_or(asked)) / 100.0;
    if (context.zoom_factor() - wanted).abs() > 0.001 {
        context.set_zoom_factor(wanted);
        return None;
    }
    Some(monitor?.pixels / context.pixels_per_point())
}

/// Handles the zoom keys: Ctrl with plus or minus selects the next choice, Ctrl+0 leaves the
/// zoom to the monitor.
pub fn typed(context: &Context, events: &[Event], settings: &mut Settings) {
    let now = (context.zoom_factor() * 100.0).round() as u16;
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
            Key::Plus | Key::Equals => CHOICES.into_iter().find(|it| *it > now),
            Key::Minus => CHOICES.into_iter().rfind(|it| *it < now),
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
    fn only_a_monitor_whose_system_says_nothing_asks_for_more() {
        for (pixels, native, per_cent) in [
            (vec2(1024.0, 768.0), 1.0, 100),
            (vec2(1920.0, 1080.0), 1.0, 100),
            (vec2(2560.0, 1440.0), 1.0, 100),
            (vec2(3840.0, 2160.0), 1.0, 200),
            (vec2(3840.0, 2160.0), 2.0, 100),
            (vec2(800.0, 1280.0), 1.0, 100),
            (vec2(7680.0, 4320.0), 1.0, 300),
        ] {
            assert_eq!(by_monitor(pixels, native), per_cent, "{pixels} at {native}");
        }
    }
}
