//! How large everything is: as the monitor asks for, or as somebody has chosen.

use egui::{Context, Event, Id, Key, Vec2};

use super::Settings;

/// The choices, per cent.
pub const CHOICES: [u16; 8] = [75, 100, 125, 150, 175, 200, 250, 300];
/// Pixels of the shorter side of a monitor for which the window is drawn.
const SHORTER_SIDE: f32 = 1080.0;

/// What a monitor asks for that has so many pixels and whose system says nothing of it
/// (`native`: pixels a point as the system wants them): whole halves, never smaller.
pub fn by_monitor(pixels: Vec2, native: f32) -> u16 {
    let times = pixels.min_elem() / SHORTER_SIDE / native.max(0.1);
    let halves = (times * 2.0).floor().clamp(2.0, 6.0);
    (halves * 50.0) as u16
}

/// The monitor that the window opened on.
#[derive(Clone, Copy, Debug)]
struct Monitor {
    pixels: Vec2,
    /// Pixels a point, as the system wants them.
    native: f32,
}

impl Monitor {
    /// As soon as it is known.
    fn of(context: &Context) -> Option<Self> {
        let id = Id::unique("monitor");
        let known = context.data(|data| data.get_temp(id));
        // Once there is a zoom, its size in points lags behind.
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

/// Draws everything as large as it is to be from the next picture on. The monitor in points
/// of that size, once they are in force.
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

/// The next choice above or below, when Ctrl and plus or minus are pressed; Ctrl+0 leaves it
/// to the monitor.
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
