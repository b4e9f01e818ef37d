//! The light palette. It is designed apart from the dark one: neutral surfaces that are nearly
//! white, near-black text, one blue accent, and deep colours for states and paths.
//!
//! A light colour is found by the dark colour that a view draws with. Two roles that differ in
//! one palette only need two different dark colours.

use std::collections::HashMap;
use std::sync::LazyLock;

use egui::Color32;

use super::*;

/// Greys of the dark palette with their light counterparts, by increasing dark grey. Greys
/// between two rows are interpolated.
const GREYS: [(u8, u8); 22] = [
    (0, 255),
    (18, 255),
    (22, 250),
    (28, 248),
    (34, 243),
    (40, 238),
    (44, 218),
    (50, 224),
    (58, 216),
    (60, 226),
    (64, 206),
    (70, 210),
    (84, 150),
    (104, 138),
    (112, 120),
    (140, 98),
    (150, 90),
    (170, 76),
    (190, 62),
    (215, 40),
    (240, 24),
    (255, 14),
];

/// Largest difference between the channels of a colour that counts as grey.
const MAX_GREY_SPREAD: u8 = 6;

const BLUE: [u8; 3] = [10, 92, 190];
const GREEN: [u8; 3] = [16, 108, 48];
const AMBER: [u8; 3] = [132, 80, 0];
const RED: [u8; 3] = [186, 26, 20];
const ORANGE: [u8; 3] = [170, 68, 0];
const MAGENTA: [u8; 3] = [170, 24, 130];

/// Colours of the dark theme, each with its counterpart in the light theme.
const COLORS: [(Color32, [u8; 3]); 70] = [
    (ACCENT, BLUE),
    (ACCENT_GROUND, [206, 226, 252]),
    (SUCCESS, GREEN),
    (WARNING, AMBER),
    (UNSAVED_TEXT, AMBER),
    (LESSON_HINT_TEXT, AMBER),
    (ALARM_TEXT, RED),
    (COLLISION, [200, 16, 16]),
    (MACHINE_BAR_TEXT, [255, 255, 255]),
    (MACHINE_CONNECTED_GROUND, [196, 22, 18]),
    (MACHINE_DISCONNECTED_GROUND, [142, 78, 16]),
    (LATCH_RING, [255, 150, 0]),
    (LESSON_RING, [60, 220, 255]),
    (CODE_ALARM_GROUND, [255, 230, 226]),
    (CODE_G, BLUE),
    (CODE_FUNCTION, [150, 68, 0]),
    (CODE_SETTING, [136, 36, 148]),
    (CODE_OTHER, [108, 84, 0]),
    (CODE_STATEMENT, [0, 98, 114]),
    (CODE_COMMENT, [36, 104, 50]),
    (RAPID_PATH, ORANGE),
    (FEED_PATH, [0, 96, 200]),
    (THREAD_PATH, [0, 112, 48]),
    (RUNNING_PATH, [140, 104, 0]),
    (SELECTED_PATH, [190, 20, 150]),
    (PASS_PATH, [112, 88, 0]),
    (FAULT_PATH, [200, 14, 10]),
    (SPINDLE_AXIS, [160, 70, 70]),
    (SECTION, [222, 225, 230]),
    (HATCHING, [116, 120, 128]),
    (PART_OUTSIDE, [206, 209, 214]),
    (PART_EDGE, [58, 60, 64]),
    (CHUCK, [214, 220, 228]),
    (CHUCK_JAWS, [188, 198, 212]),
    (CLAMPING_EDGE, [90, 102, 122]),
    (INSERT, [232, 178, 24]),
    (TOOL_HOLDER, [180, 188, 198]),
    (TOOL_HOLDER_EDGE, [82, 90, 100]),
    (SPINDLE_MARK, [82, 98, 126]),
    (COOLANT_OPAQUE, [60, 176, 176]),
    (MEASURED_FEATURE, [116, 88, 0]),
    (KEPT_MEASUREMENT, MAGENTA),
    (CALIPER, [24, 80, 150]),
    (WITHIN_TOLERANCE, GREEN),
    (MATERIAL_LEFT, [24, 84, 200]),
    (NOSE_CENTER_PATH, [114, 48, 180]),
    (LADDER_LIVE, [0, 112, 46]),
    (LADDER_TITLE, [30, 84, 140]),
    (LADDER_FOUND, [255, 190, 0]),
    (SCOPE_X, [0, 100, 180]),
    (SCOPE_X_COMMAND, [82, 134, 180]),
    (SCOPE_Z, [150, 78, 0]),
    (SCOPE_Z_COMMAND, [172, 120, 60]),
    (SCOPE_PATH, [46, 112, 28]),
    (SCOPE_SPINDLE, [164, 28, 126]),
    (SCOPE_SPINDLE_COMMAND, [174, 98, 154]),
    (SCOPE_BIT, [18, 104, 80]),
    (SCOPE_CURSORS[0], [122, 88, 0]),
    (SCOPE_CURSORS[1], [0, 100, 108]),
    (CURVE_MEASURED, [150, 76, 0]),
    (CURVE_PROPOSED, [0, 92, 160]),
    // Colours of egui: links, errors and warnings.
    (Color32::from_rgb(90, 170, 255), BLUE),
    (Color32::from_rgb(255, 0, 0), RED),
    (Color32::from_rgb(255, 143, 0), AMBER),
    // Colours of the strokes around text cursors and selected text of egui.
    (Color32::from_rgb(192, 222, 255), BLUE),
    (Color32::from_rgb(0, 92, 128), [206, 226, 252]),
    (ERROR_TEXT, RED),
    (LADDER_RUNG_ERROR, RED),
    (LADDER_ERROR_TEXT, RED),
    (CODE_ALARM_TEXT, RED),
];

static LIGHT_COLORS: LazyLock<HashMap<Color32, [u8; 3]>> =
    LazyLock::new(|| COLORS.into_iter().collect());

/// Finds the light counterpart of a colour of the dark palette; `None` for a colour that the
/// palette does not contain.
fn find_counterpart([red, green, blue]: [u8; 3], is_opaque: bool) -> Option<[u8; 3]> {
    let least = red.min(green).min(blue);
    let most = red.max(green).max(blue);
    let color = Color32::from_rgb(red, green, blue);
    if let Some(light) = LIGHT_COLORS.get(&color) {
        return Some(*light);
    }
    if most - least <= MAX_GREY_SPREAD {
        return Some([light_grey(green); 3]);
    }
    if is_opaque {
        return None;
    }
    // Transparency rounds the channels of a colour.
    let distance = |other: &Color32| {
        let [r, g, b, _] = other.to_array();
        let steps = [r.abs_diff(red), g.abs_diff(green), b.abs_diff(blue)];
        steps.into_iter().max().unwrap_or_default()
    };
    let nearest = COLORS.iter().min_by_key(|(dark, _)| distance(dark))?;
    (distance(&nearest.0) <= 6).then_some(nearest.1)
}

fn light_grey(grey: u8) -> u8 {
    let rows = GREYS.windows(2).find_map(|rows| match rows {
        [low, high] if (low.0..=high.0).contains(&grey) => Some((*low, *high)),
        _ => None,
    });
    let Some((low, high)) = rows else { return grey };
    let share = f32::from(grey - low.0) / f32::from(high.0 - low.0);
    egui::lerp(f32::from(low.1)..=f32::from(high.1), share).round() as u8
}

/// Converts an sRGB colour of the dark theme to that of the light theme.
pub(super) fn to_light_rgb(color: [u8; 3], is_opaque: bool) -> [u8; 3] {
    find_counterpart(color, is_opaque).unwrap_or_else(|| map_lightness(color))
}

/// Lightness in the light theme as a polynomial of the lightness in the dark theme, constant
/// term first: the darkest background (0.15) becomes white, a pale ink (0.65) half dark, white
/// (1.0) nearly black. Each ink keeps at least its contrast to the background in the dark
/// theme, or a contrast of 7.
const LIGHTNESS_POLYNOMIAL: [f32; 4] = [0.9915, 0.4878, -3.1663, 1.9369];

/// Converts an sRGB colour that is not in the palette to the light theme: maps the lightness in Oklab and keeps the hue.
/// Equal steps in Oklab look equally large, so that colours that differ in the dark theme
/// differ in the light one.
fn map_lightness(color: [u8; 3]) -> [u8; 3] {
    let [lightness, a, b] = linear_to_oklab(color.map(gamma_to_linear));
    let [constant, first, second, third] = LIGHTNESS_POLYNOMIAL;
    let lightness = constant + (first + (second + third * lightness) * lightness) * lightness;
    // A colour outside the range of sRGB becomes paler until it is inside.
    let shades = [1.0, 0.9, 0.8, 0.7, 0.6, 0.5, 0.4, 0.3, 0.2, 0.1];
    let colors =
        shades.map(|saturation| oklab_to_linear([lightness, a * saturation, b * saturation]));
    let displayable = colors
        .into_iter()
        .find(|color| color.iter().all(|part| (0.0..=1.0).contains(part)))
        .unwrap_or_else(|| oklab_to_linear([lightness, 0.0, 0.0]));
    displayable.map(linear_to_gamma)
}

/// Converts linear sRGB to Oklab (B. Ottosson, 2020).
fn linear_to_oklab([r, g, b]: [f32; 3]) -> [f32; 3] {
    let l = (0.412_221_46 * r + 0.536_332_55 * g + 0.051_445_995 * b).cbrt();
    let m = (0.211_903_5 * r + 0.680_699_5 * g + 0.107_396_96 * b).cbrt();
    let s = (0.088_302_46 * r + 0.281_718_85 * g + 0.629_978_7 * b).cbrt();
    [
        0.210_454_26 * l + 0.793_617_8 * m - 0.004_072_047 * s,
        1.977_998_5 * l - 2.428_592_2 * m + 0.450_593_7 * s,
        0.025_904_037 * l + 0.782_771_77 * m - 0.808_675_77 * s,
    ]
}

/// Converts Oklab to linear sRGB.
fn oklab_to_linear([lightness, a, b]: [f32; 3]) -> [f32; 3] {
    let l = (lightness + 0.396_337_78 * a + 0.215_803_76 * b).powi(3);
    let m = (lightness - 0.105_561_346 * a - 0.063_854_17 * b).powi(3);
    let s = (lightness - 0.089_484_18 * a - 1.291_485_5 * b).powi(3);
    [
        4.076_741_7 * l - 3.307_711_6 * m + 0.230_969_94 * s,
        -1.268_438 * l + 2.609_757_4 * m - 0.341_319_38 * s,
        -0.004_196_086 * l - 0.703_418_6 * m + 1.707_614_7 * s,
    ]
}

pub(super) fn gamma_to_linear(part: u8) -> f32 {
    egui::ecolor::linear_f32_from_gamma_u8(part)
}

fn linear_to_gamma(part: f32) -> u8 {
    egui::ecolor::gamma_u8_from_linear_f32(part)
}
