//! Colours and text sizes of the window, and its light theme. The window is drawn in the dark
//! colours below. For light surroundings one rule gives each colour its light counterpart, just
//! before a frame is shown. Panel, LCD and the lit part are images and look the same in both
//! themes.

use std::cell::Cell;

use egui::epaint::shape_transform::adjust_colors;
use egui::{
    Color32, Context, FontId, FullOutput, Id, Painter, Plugin, Pos2, Rect, Shape, Style, TextStyle,
    TextureHandle, TextureId, TextureOptions, pos2,
};

// Text.

/// Colour of most texts.
pub const TEXT: Color32 = Color32::from_gray(225);
/// Text of the message in the top bar.
pub const MESSAGE_TEXT: Color32 = Color32::from_gray(220);
/// Text of rows in lists and tables.
pub const ROW_TEXT: Color32 = Color32::from_gray(215);
/// Emphasized text, such as the step of a lesson or an icon under the pointer.
pub const BRIGHT_TEXT: Color32 = Color32::WHITE;
/// Text of view titles, times and received lines.
pub const SECONDARY_TEXT: Color32 = Color32::from_gray(200);
/// Unobtrusive text: states over the picture, keys of views, positions that match.
pub const QUIET_TEXT: Color32 = Color32::from_gray(190);
/// Text of notes and file names, and idle icons.
pub const NOTE_TEXT: Color32 = Color32::from_gray(170);
/// Text of the state of the machine view without a warning.
pub const STATE_TEXT: Color32 = Color32::from_gray(160);
/// Weak text of egui, and explanations. The colour is opaque, because a half-transparent one
/// would be paler on a light ground.
pub const WEAK_TEXT: Color32 = Color32::from_gray(150);
/// Text of the hint in the top bar while there is no message.
pub const HINT_TEXT: Color32 = Color32::from_gray(140);
/// Text on lamps, signs and flags in bright colours.
pub const TEXT_ON_BRIGHT: Color32 = Color32::BLACK;

// Grounds.

/// Fill of shapes that are not filled.
pub const NO_FILL: Color32 = Color32::TRANSPARENT;
/// Ground of the window.
pub const WINDOW_GROUND: Color32 = Color32::from_gray(22);
/// Ground of the drawing of a view: lathe, ladder, scope.
pub const DRAWING_GROUND: Color32 = Color32::from_gray(18);
/// Ground of lists and forms of a view.
pub const SIDE_GROUND: Color32 = Color32::from_gray(28);
/// Ground of the bars of the window and of its views.
pub const BAR_GROUND: Color32 = Color32::from_gray(34);
/// Ground of the tab bar, and of the header of a view.
pub const HEADER_GROUND: Color32 = Color32::from_gray(40);

/// Shade on a row under the pointer.
pub fn row_hover() -> Color32 {
    Color32::from_white_alpha(10)
}

/// A splitter between two panes that is not in use.
pub const SPLITTER: Color32 = Color32::from_gray(44);
/// A splitter that has the pointer or the focus.
pub const SPLITTER_ACTIVE: Color32 = Color32::from_rgb(88, 140, 196);
/// Tint of an image that is drawn in its own colours.
pub const NO_TINT: Color32 = Color32::WHITE;

// Buttons that select one of several values.

/// Ground of the selected value of a choice.
pub const CHOICE_SELECTED_GROUND: Color32 = Color32::from_gray(58);
pub const CHOICE_SELECTED_TEXT: Color32 = Color32::from_gray(210);
/// Ground of the other values of a choice.
pub const CHOICE_GROUND: Color32 = Color32::from_gray(42);

// Success, warning, danger.

/// Marks what is done, valid or connected.
pub const SUCCESS: Color32 = Color32::from_rgb(110, 230, 120);
/// Text of a job that is saved and valid.
pub const JOB_VALID: Color32 = Color32::from_rgb(110, 220, 120);
/// A connection that moves the machine, and the lines that are sent to it.
pub const BUSY: Color32 = Color32::from_rgb(120, 190, 255);
/// Marks what is uncertain, waiting or on trial, and the signs of the top bar.
pub const WARNING: Color32 = Color32::from_rgb(255, 196, 90);
/// Marks a bit that is forced.
pub const FORCED: Color32 = WARNING;
/// Text of changes that are not saved or written yet, and of the reason why the control
/// refuses them.
pub const UNSAVED_TEXT: Color32 = Color32::from_rgb(255, 214, 110);
/// Marks a value that differs from the delivered one.
pub const DIFFERS: Color32 = Color32::from_rgb(120, 190, 255);
/// Text of alarms, faults and failed transfers.
pub const ALARM_TEXT: Color32 = Color32::from_rgb(255, 120, 96);
/// Text of an error in what was typed.
pub const ERROR_TEXT: Color32 = Color32::from_rgb(255, 150, 110);
/// Text of an error in an address that was typed in the scope.
pub const SCOPE_ERROR_TEXT: Color32 = Color32::from_rgb(255, 150, 120);
/// Text of an error in a job.
pub const JOB_ERROR: Color32 = Color32::from_rgb(255, 100, 90);
/// Marks a collision, and the end of a path by an alarm.
pub const COLLISION: Color32 = Color32::from_rgb(255, 70, 60);

// The bar that warns of a real machine.

pub const MACHINE_BAR_TEXT: Color32 = Color32::WHITE;
/// Ground of the warning bar while the board can move the slides.
pub const MACHINE_CONNECTED_GROUND: Color32 = Color32::from_rgb(208, 30, 24);
/// Ground of the warning bar while the board is off or lost.
pub const MACHINE_DISCONNECTED_GROUND: Color32 = Color32::from_rgb(150, 84, 20);

// Rings around keys of the panel, and lamps of the bench.

/// The ring around a latched key.
pub const LATCH_RING: Color32 = Color32::from_rgb(255, 150, 0);
/// The ring around a key that a lesson asks the operator to press.
pub const LESSON_RING: Color32 = Color32::from_rgb(60, 220, 255);
pub const LAMP_ON: Color32 = SUCCESS;
pub const LAMP_OFF: Color32 = Color32::from_gray(62);
pub const LAMP_OFF_TEXT: Color32 = Color32::from_gray(170);

// Lessons.

/// Marks the current step of a lesson, and a demonstration.
pub const LESSON_STEP: Color32 = Color32::from_rgb(90, 200, 255);
/// Mark of a lesson step that is not done.
pub const LESSON_OPEN: Color32 = Color32::from_gray(90);
pub const LESSON_HINT_TEXT: Color32 = Color32::from_rgb(255, 214, 130);

// Part programs.

pub const CODE_GROUND: Color32 = Color32::from_gray(22);
pub const CODE_ALARM_GROUND: Color32 = Color32::from_rgb(70, 28, 26);
/// Text of words that raise an alarm, and of characters that belong to no word.
pub const CODE_ALARM_TEXT: Color32 = Color32::from_rgb(255, 110, 96);
pub const LINE_NUMBER_GROUND: Color32 = Color32::from_gray(30);
pub const LINE_NUMBER_TEXT: Color32 = Color32::from_gray(110);
/// Text of block and program numbers.
pub const CODE_NAME: Color32 = Color32::from_gray(140);
/// Text of G words.
pub const CODE_G: Color32 = Color32::from_rgb(110, 180, 255);
/// Text of M words.
pub const CODE_FUNCTION: Color32 = Color32::from_rgb(255, 170, 90);
/// Text of S, F and T words.
pub const CODE_SETTING: Color32 = Color32::from_rgb(225, 150, 230);
pub const CODE_AXIS: Color32 = Color32::from_rgb(240, 240, 240);
pub const CODE_OTHER: Color32 = Color32::from_rgb(230, 215, 140);
pub const CODE_STATEMENT: Color32 = Color32::from_rgb(150, 215, 225);
pub const CODE_COMMENT: Color32 = Color32::from_rgb(120, 190, 130);
/// Text of end of block, block skip and program mark.
pub const CODE_MARK: Color32 = Color32::from_gray(110);

// Paths of the tool.

pub const RAPID_PATH: Color32 = Color32::from_rgb(255, 150, 60);
pub const FEED_PATH: Color32 = Color32::from_rgb(90, 180, 255);
pub const THREAD_PATH: Color32 = Color32::from_rgb(80, 225, 120);
/// Path of the running block.
pub const RUNNING_PATH: Color32 = Color32::from_rgb(255, 255, 140);
/// Path of the selected block.
pub const SELECTED_PATH: Color32 = Color32::from_rgb(255, 110, 220);
/// Path of the selected pass of a cycle.
pub const PASS_PATH: Color32 = Color32::from_rgb(255, 245, 170);
/// Path of the block that raises an alarm.
pub const FAULT_PATH: Color32 = Color32::from_rgb(255, 60, 50);
/// Dwells in the time bar, and times without a known move.
pub const DWELL: Color32 = Color32::from_gray(64);
pub const DWELL_TEXT: Color32 = Color32::from_gray(150);
/// Shade on the elapsed part of the time bar.
pub const TIME_DONE_SHADE: Color32 = Color32::from_black_alpha(110);
/// Line at the current time in the time bar.
pub const TIME_CURSOR: Color32 = Color32::WHITE;

/// Colour of a column of the time bar whose moves have the colour `path` in the picture.
pub fn time_column(path: Color32) -> Color32 {
    path.gamma_multiply(0.75)
}

// Drawing of the part.

pub const GRID_LINE: Color32 = Color32::from_gray(34);
/// Numbers at the lines of the grid.
pub const GRID_TEXT: Color32 = Color32::from_gray(150);
pub const SPINDLE_AXIS: Color32 = Color32::from_rgb(176, 120, 120);
/// Ground of text over the picture.
pub const PICTURE_LABEL_GROUND: Color32 = Color32::from_rgba_premultiplied(12, 12, 12, 170);
/// Fill of the cut face of the half section.
pub const SECTION: Color32 = Color32::from_rgb(118, 116, 112);
/// Fill of the outside of the part, below the axis.
pub const PART_OUTSIDE: Color32 = Color32::from_rgb(74, 74, 76);
pub const PART_EDGE: Color32 = Color32::from_rgb(196, 196, 192);
pub const CHUCK: Color32 = Color32::from_rgb(44, 50, 60);
pub const CHUCK_JAWS: Color32 = Color32::from_rgb(62, 72, 88);
pub const CLAMPING_EDGE: Color32 = Color32::from_rgb(104, 116, 136);
pub const INSERT: Color32 = Color32::from_rgb(240, 200, 60);
pub const INSERT_EDGE: Color32 = Color32::WHITE;
pub const TOOL_HOLDER: Color32 = Color32::from_rgb(98, 104, 112);
pub const TOOL_HOLDER_EDGE: Color32 = Color32::from_rgb(150, 156, 164);
/// Marks of the turning spindle, and the nozzle.
pub const SPINDLE_MARK: Color32 = Color32::from_rgb(150, 164, 186);
pub const COOLANT: Color32 = Color32::from_rgba_premultiplied(40, 84, 120, 130);

// Measurement of the part.

/// The measured feature of the part under the pointer.
pub const MEASURED_FEATURE: Color32 = Color32::from_rgb(255, 240, 120);
/// A measured feature that the user has kept in the picture.
pub const KEPT_MEASUREMENT: Color32 = Color32::from_rgb(255, 150, 220);
pub const CALIPER: Color32 = Color32::from_rgb(190, 220, 255);
pub const CALIPER_LABEL_GROUND: Color32 = Color32::from_rgba_premultiplied(10, 12, 16, 220);
pub const WITHIN_TOLERANCE: Color32 = Color32::from_rgb(90, 215, 110);
pub const MATERIAL_LEFT: Color32 = Color32::from_rgb(80, 150, 255);
pub const CUT_TOO_DEEP: Color32 = Color32::from_rgb(255, 70, 60);
pub const PROGRAMMED_PATH: Color32 = Color32::WHITE;
/// Path of the centre of the tool nose.
pub const NOSE_CENTER_PATH: Color32 = Color32::from_rgb(200, 130, 255);

/// Colour of a path under the microscope: fainter than `path`, below the compared surface.
pub fn microscope_path(path: Color32) -> Color32 {
    path.gamma_multiply(0.6)
}

// Ladder.

/// Parts of a rung through which power flows.
pub const LADDER_LIVE: Color32 = Color32::from_rgb(96, 226, 118);
/// Parts of a rung through which no power flows.
pub const LADDER_DEAD: Color32 = Color32::from_gray(112);
/// Power rails, and symbols of elements without power.
pub const LADDER_RAIL: Color32 = Color32::from_gray(150);
pub const LADDER_COMMENT: Color32 = Color32::from_gray(146);
pub const LADDER_TITLE: Color32 = Color32::from_rgb(150, 190, 230);
pub const LADDER_SELECTED: Color32 = Color32::from_rgb(92, 190, 255);
/// Ground of an element that the search has found.
pub const LADDER_FOUND_GROUND: Color32 = Color32::from_rgba_unmultiplied_const(255, 214, 90, 38);
pub const LADDER_BOX_GROUND: Color32 = Color32::from_gray(30);
/// Ground of the label between two rungs.
pub const LADDER_MARK_GROUND: Color32 = Color32::from_gray(40);
/// The frame around a rung that does not compile, and its error.
pub const LADDER_RUNG_ERROR: Color32 = Color32::from_rgb(255, 110, 90);
/// Errors in the list of the compiler.
pub const LADDER_ERROR_TEXT: Color32 = Color32::from_rgb(255, 130, 104);

/// Fill of a contact or coil with power.
pub fn ladder_live_ground() -> Color32 {
    LADDER_LIVE.gamma_multiply(0.35)
}

/// Frame of an element under the pointer.
pub fn ladder_hover() -> Color32 {
    LADDER_SELECTED.gamma_multiply(0.5)
}

// Scope and curves.

pub const SCOPE_GRID: Color32 = Color32::from_gray(46);
pub const SCOPE_ZERO_LINE: Color32 = Color32::from_gray(74);
pub const SCOPE_FRAME: Color32 = Color32::from_gray(84);
/// Numbers at the scales of scope and curves.
pub const SCALE_TEXT: Color32 = Color32::from_gray(160);
pub const SCOPE_LANE_TEXT: Color32 = Color32::from_gray(205);
pub const SCOPE_LANE_GROUND: Color32 = Color32::from_black_alpha(150);
/// Trace of the actual values of X. The constant after it is for the commanded ones.
pub const SCOPE_X: Color32 = Color32::from_rgb(92, 190, 255);
pub const SCOPE_X_COMMAND: Color32 = Color32::from_rgb(64, 118, 158);
/// Trace of the actual values of Z. The constant after it is for the commanded ones.
pub const SCOPE_Z: Color32 = Color32::from_rgb(255, 176, 72);
pub const SCOPE_Z_COMMAND: Color32 = Color32::from_rgb(164, 118, 58);
/// Trace of values along the path.
pub const SCOPE_PATH: Color32 = Color32::from_rgb(140, 222, 120);
/// Trace of the actual values of the spindle. The constant after it is for the commanded ones.
pub const SCOPE_SPINDLE: Color32 = Color32::from_rgb(238, 130, 208);
pub const SCOPE_SPINDLE_COMMAND: Color32 = Color32::from_rgb(150, 88, 132);
pub const SCOPE_BIT: Color32 = Color32::from_rgb(150, 214, 190);
pub const SCOPE_CURSORS: [Color32; 2] = [
    Color32::from_rgb(255, 226, 90),
    Color32::from_rgb(120, 226, 226),
];
/// Grid lines of the curves of pitch errors.
pub const CURVE_GRID: Color32 = Color32::from_gray(52);
pub const CURVE_CURRENT: Color32 = Color32::from_gray(150);
pub const CURVE_MEASURED: Color32 = Color32::from_rgb(255, 180, 90);
pub const CURVE_PROPOSED: Color32 = Color32::from_rgb(90, 200, 255);

/// Fill of the lane of a bit while the bit is 1.
pub fn scope_bit_ground() -> Color32 {
    SCOPE_BIT.gamma_multiply(0.25)
}

// Sizes of text, points.

/// Text size of 0 or 1 in a lamp, points.
pub const LAMP_SIZE: f32 = 10.0;
/// Text size of numbers at the grid of the picture and at curves, points.
pub const SCALE_SIZE: f32 = 11.0;
/// Text size of the names of bits in the scope, points.
pub const BIT_NAME_SIZE: f32 = 11.5;
/// Text size of comments in drawings and of figures of the scope, points.
pub const ANNOTATION_SIZE: f32 = 12.0;
/// Text size of addresses and values in drawings and of line numbers, points.
pub const LABEL_SIZE: f32 = 13.0;
/// Text size of the titles of rungs, points.
pub const TITLE_SIZE: f32 = 14.0;
/// Text size of part programs, and of sentences that are read at a distance, points.
pub const READING_SIZE: f32 = 15.0;
/// Text size of the step of a lesson, large buttons, readings of the caliper and the state of
/// a real machine, points.
pub const LARGE_SIZE: f32 = 16.0;
/// Text size of the end of a lesson, points.
pub const LESSON_END_SIZE: f32 = 17.0;
/// Text size of the warning of a real machine, points.
pub const MACHINE_WARNING_SIZE: f32 = 19.0;
// Sizes of the text styles of egui.

const SMALL_STYLE_SIZE: f32 = 9.0;
const BODY_STYLE_SIZE: f32 = 13.0;
const HEADING_STYLE_SIZE: f32 = 18.0;

/// Sets the text styles and text colours of all windows.
pub fn set_text_style(style: &mut Style) {
    style.text_styles = [
        (TextStyle::Small, FontId::proportional(SMALL_STYLE_SIZE)),
        (TextStyle::Body, FontId::proportional(BODY_STYLE_SIZE)),
        (TextStyle::Button, FontId::proportional(BODY_STYLE_SIZE)),
        (TextStyle::Monospace, FontId::monospace(BODY_STYLE_SIZE)),
        (TextStyle::Heading, FontId::proportional(HEADING_STYLE_SIZE)),
    ]
    .into();
    style.visuals.override_text_color = Some(TEXT);
    style.visuals.weak_text_color = Some(WEAK_TEXT);
}

// The light theme.

/// Lightness in the light theme as a polynomial of the lightness in the dark theme, constant
/// term first: the darkest background (0.15) becomes white, a pale ink (0.65) half dark, white
/// (1.0) nearly black. Each ink keeps at least its contrast to the background in the dark
/// theme, or a contrast of 7.
const LIGHTNESS_POLYNOMIAL: [f32; 4] = [0.9915, 0.4878, -3.1663, 1.9369];

#[derive(Default)]
struct ThemePlugin {
    light: bool,
}

impl Plugin for ThemePlugin {
    fn debug_name(&self) -> &'static str {
        "surroundings"
    }

    fn output_hook(&mut self, _context: &Context, output: &mut FullOutput) {
        if self.light {
            for shape in &mut output.shapes {
                lighten(&mut shape.shape);
            }
        }
    }
}

/// Registers the plugin that recolours frames for the light theme. The theme is dark at first.
pub fn install(context: &Context) {
    context.add_plugin(ThemePlugin::default());
}

/// Sets the light or the dark theme for everything that the context draws.
pub fn set_light(context: &Context, light: bool) {
    context.with_plugin(|plugin: &mut ThemePlugin| plugin.light = light);
}

/// Whether the context draws the light theme.
pub fn is_light(context: &Context) -> bool {
    let light = context.with_plugin(|plugin: &mut ThemePlugin| plugin.light);
    light.unwrap_or(false)
}

/// The background colour of a window in the light or the dark theme.
pub fn background(light: bool) -> Color32 {
    if light {
        to_light(WINDOW_GROUND)
    } else {
        WINDOW_GROUND
    }
}

/// Fills a rectangle with a colour that is the same in both themes, such as that of the panel.
pub fn fill_unthemed(painter: &Painter, bounds: Rect, color: Color32) {
    let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
    painter.image(white_texture(painter.ctx()), bounds, whole, color);
}

/// Returns a texture of one white pixel. Shapes with this texture keep their colours in both
/// themes.
pub fn white_texture(context: &Context) -> TextureId {
    let id = Id::unique("white");
    let cached: Option<TextureHandle> = context.data(|data| data.get_temp(id));
    let texture = cached.unwrap_or_else(|| {
        let dot = egui::ColorImage::filled([1, 1], Color32::WHITE);
        let texture = context.load_texture("white", dot, TextureOptions::NEAREST);
        context.data_mut(|data| data.insert_temp(id, texture.clone()));
        texture
    });
    texture.id()
}

/// Gives a shape the colours of the light theme, unless it is an image.
fn lighten(shape: &mut Shape) {
    match shape {
        Shape::Vec(shapes) => shapes.iter_mut().for_each(lighten),
        Shape::Mesh(mesh) if mesh.texture_id != TextureId::default() => {}
        Shape::Rect(rect) if rect.brush.is_some() => {}
        shape => adjust_colors(shape, |color| *color = to_light(*color)),
    }
}

/// Converts a colour of the dark theme to that of the light theme.
fn to_light(color: Color32) -> Color32 {
    thread_local! {
        /// The last colour that was converted, and its result: neighbouring vertices usually
        /// have the same colour.
        static LAST_CONVERSION: Cell<(Color32, Color32)> =
            const { Cell::new((Color32::TRANSPARENT, Color32::TRANSPARENT)) };
    }
    // egui replaces this colour later.
    if color == Color32::PLACEHOLDER || color == Color32::TRANSPARENT {
        return color;
    }
    let (last, light) = LAST_CONVERSION.get();
    if last == color {
        return light;
    }
    let [red, green, blue, cover] = color.to_srgba_unmultiplied();
    let [red, green, blue] = to_light_rgb([red, green, blue]);
    let light = Color32::from_rgba_unmultiplied(red, green, blue, cover);
    LAST_CONVERSION.set((color, light));
    light
}

/// Converts an sRGB colour to the light theme: maps the lightness in Oklab and keeps the hue.
/// Equal steps in Oklab look equally large, so that colours that differ in the dark theme
/// differ in the light one.
fn to_light_rgb(color: [u8; 3]) -> [u8; 3] {
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

fn gamma_to_linear(part: u8) -> f32 {
    egui::ecolor::linear_f32_from_gamma_u8(part)
}

fn linear_to_gamma(part: f32) -> u8 {
    egui::ecolor::gamma_u8_from_linear_f32(part)
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::path::{Path, PathBuf};

    use super::*;

    /// Minimum contrast of a text to its ground in the dark theme.
    const MIN_CONTRAST: f32 = 3.0;
    /// Source text before a colour constant. The list after it has functions that set a text
    /// size if a digit follows.
    const COLOR_TYPE: &str = "Color32::";
    const SIZE_FUNCTIONS: [&str; 4] = [
        "FontId::proportional(",
        "FontId::monospace(",
        "FontId::new(",
        ".size(",
    ];
    /// Code that defines a colour in another way.
    const COLOR_CODE: [&str; 5] = [
        "Rgba::",
        "Hsva::",
        "hex_color!",
        "[u8; 3] = [",
        "[u8; 4] = [",
    ];

    fn collect_sources(folder: &Path, files: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(folder).expect("sources of the window") {
            let path = entry.expect("entry").path();
            if path.is_dir() {
                collect_sources(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }

    /// Whether `code` begins with a digit, spaces skipped.
    fn begins_with_digit(code: &str) -> bool {
        code.trim_start()
            .starts_with(|letter: char| letter.is_ascii_digit())
    }

    /// Whether `code`, the source after `Color32::`, begins with a colour literal: `WHITE`,
    /// `from_gray(150)`.
    fn begins_with_color(code: &str) -> bool {
        let name_length = code
            .find(|letter: char| !letter.is_alphanumeric() && letter != '_')
            .unwrap_or(code.len());
        let (name, after) = code.split_at(name_length);
        let arguments = after.strip_prefix('(');
        name.starts_with(|letter: char| letter.is_ascii_uppercase())
            || name.starts_with("from_") && arguments.is_some_and(begins_with_digit)
    }

    /// The lines of a source that contain literals of colours and text sizes, each from its
    /// literal on.
    fn find_style_literals(source: &str) -> Vec<&str> {
        let colors = source.match_indices(COLOR_TYPE);
        let colors = colors.filter(|(at, name)| begins_with_color(&source[at + name.len()..]));
        let sizes = SIZE_FUNCTIONS
            .iter()
            .flat_map(|name| source.match_indices(*name));
        let sizes = sizes.filter(|(at, name)| begins_with_digit(&source[at + name.len()..]));
        let other = COLOR_CODE
            .iter()
            .flat_map(|code| source.match_indices(*code));
        let found = colors.chain(sizes).chain(other);
        found
            .map(|(at, _)| source[at..].lines().next().unwrap_or_default())
            .collect()
    }

    #[test]
    fn only_the_theme_has_literals_of_colors_and_text_sizes() {
        let mut files = Vec::new();
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/window");
        collect_sources(&folder, &mut files);
        assert!(files.len() > 30, "the window is elsewhere now");
        files.sort();
        let mut found = Vec::new();
        for path in files
            .iter()
            .filter(|path| !path.ends_with("window/theme.rs"))
        {
            let source = fs::read_to_string(path).expect("a source");
            for literal in find_style_literals(&source) {
                found.push(format!("{}: {literal}", path.display()));
            }
        }
        assert!(found.is_empty(), "move to theme.rs:\n{}", found.join("\n"));
    }

    #[test]
    fn style_literals_are_found() {
        let found = |source| find_style_literals(source).len();
        for literal in [
            "Color32::WHITE",
            "egui::Color32::from_rgb(\n    1, 2, 3)",
            "Color32::from_gray(3)",
            "const BLUE: [u8; 3] = [1, 2, 3];",
            "FontId::monospace(13.0)",
            "text.size(15.0)",
        ] {
            assert_eq!(found(literal), 1, "{literal}");
        }
        for computed in [
            "Color32::from_rgb(red, green, blue)",
            "FontId::monospace(theme::LABEL_SIZE)",
            "rect.size()",
            "color: Color32, size: f32",
        ] {
            assert_eq!(found(computed), 0, "{computed}");
        }
    }

    /// Texts and the grounds they are drawn on in the dark theme.
    fn texts_on_grounds() -> Vec<(&'static str, Vec<Color32>, Vec<Color32>)> {
        let widgets = egui::Visuals::dark().widgets;
        let buttons = [widgets.inactive.weak_bg_fill, widgets.hovered.weak_bg_fill];
        let traces = vec![
            SCOPE_X,
            SCOPE_X_COMMAND,
            SCOPE_Z,
            SCOPE_Z_COMMAND,
            SCOPE_PATH,
            SCOPE_SPINDLE,
            SCOPE_SPINDLE_COMMAND,
            SCOPE_BIT,
            SCOPE_CURSORS[0],
            SCOPE_CURSORS[1],
        ];
        let code = vec![
            CODE_NAME,
            CODE_G,
            CODE_FUNCTION,
            CODE_SETTING,
            CODE_AXIS,
            CODE_OTHER,
            CODE_STATEMENT,
            CODE_COMMENT,
            CODE_ALARM_TEXT,
        ];
        let marked_code = vec![CODE_GROUND, CODE_ALARM_GROUND];
        let states = vec![
            SUCCESS,
            JOB_VALID,
            BUSY,
            WARNING,
            UNSAVED_TEXT,
            DIFFERS,
            ALARM_TEXT,
            ERROR_TEXT,
            SCOPE_ERROR_TEXT,
            JOB_ERROR,
            COLLISION,
        ];
        let lessons = vec![LESSON_STEP, LESSON_HINT_TEXT, BRIGHT_TEXT, NOTE_TEXT];
        let times = vec![RAPID_PATH, FEED_PATH, THREAD_PATH, PASS_PATH, DWELL_TEXT];
        let microscope = vec![
            WITHIN_TOLERANCE,
            MATERIAL_LEFT,
            CUT_TOO_DEEP,
            PROGRAMMED_PATH,
            NOSE_CENTER_PATH,
        ];
        let ladder = vec![
            LADDER_LIVE,
            LADDER_RAIL,
            LADDER_COMMENT,
            LADDER_TITLE,
            LADDER_RUNG_ERROR,
            TEXT,
            FORCED,
        ];
        let ladder_grounds = vec![DRAWING_GROUND, LADDER_BOX_GROUND, LADDER_MARK_GROUND];
        let curves = vec![SCALE_TEXT, CURVE_CURRENT, CURVE_MEASURED, CURVE_PROPOSED];
        let window = vec![WINDOW_GROUND, SIDE_GROUND, BAR_GROUND];
        let bars = vec![SIDE_GROUND, BAR_GROUND];
        let drawing = vec![DRAWING_GROUND];
        vec![
            ("text", vec![TEXT, WEAK_TEXT], window.clone()),
            ("text of buttons", vec![TEXT], buttons.into()),
            (
                "rows",
                vec![ROW_TEXT, SECONDARY_TEXT, QUIET_TEXT],
                bars.clone(),
            ),
            (
                "messages",
                vec![MESSAGE_TEXT, HINT_TEXT, STATE_TEXT],
                bars.clone(),
            ),
            (
                "headers",
                vec![BRIGHT_TEXT, SECONDARY_TEXT, NOTE_TEXT, WEAK_TEXT],
                vec![HEADER_GROUND],
            ),
            ("choices", vec![QUIET_TEXT], vec![CHOICE_GROUND]),
            (
                "selected choices",
                vec![CHOICE_SELECTED_TEXT],
                vec![CHOICE_SELECTED_GROUND],
            ),
            ("states", states, window),
            (
                "signs and lamps",
                vec![TEXT_ON_BRIGHT],
                vec![WARNING, FORCED, LAMP_ON, SCOPE_CURSORS[0], SCOPE_CURSORS[1]],
            ),
            ("dark lamps", vec![LAMP_OFF_TEXT], vec![LAMP_OFF]),
            (
                "bar of a real machine",
                vec![MACHINE_BAR_TEXT],
                vec![MACHINE_CONNECTED_GROUND, MACHINE_DISCONNECTED_GROUND],
            ),
            ("lessons", lessons, bars.clone()),
            ("part programs", code, marked_code),
            // On the ground of an alarm, which rarely covers a mark, the contrast is only 2.86.
            ("marks of blocks", vec![CODE_MARK], vec![CODE_GROUND]),
            (
                "line numbers",
                vec![LINE_NUMBER_TEXT],
                vec![LINE_NUMBER_GROUND],
            ),
            ("times", times, bars.clone()),
            (
                "words over the picture",
                vec![GRID_TEXT, QUIET_TEXT, MEASURED_FEATURE],
                drawing.clone(),
            ),
            ("microscope", microscope, bars.clone()),
            ("ladder", ladder, ladder_grounds),
            ("errors of a ladder", vec![LADDER_ERROR_TEXT], bars.clone()),
            ("scales", vec![SCALE_TEXT, SCOPE_LANE_TEXT], drawing),
            ("traces", traces, vec![DRAWING_GROUND, SIDE_GROUND]),
            ("curves", curves, bars),
        ]
    }

    #[test]
    #[allow(clippy::print_stdout, reason = "the figures are read with --nocapture")]
    fn texts_have_contrast_to_their_grounds() {
        for (what, inks, grounds) in texts_on_grounds() {
            for ink in inks {
                for ground in &grounds {
                    let dark = contrast(ink, *ground);
                    let light = contrast(to_light(ink), to_light(*ground));
                    let [ink, ground] = [ink, *ground].map(|color| color.to_hex());
                    println!("{what}: {ink} on {ground}: dark {dark:.1}, light {light:.1}");
                    assert!(dark >= MIN_CONTRAST, "{what}: {ink} on {ground}: {dark}");
                }
            }
        }
    }

    #[test]
    fn text_styles_have_the_sizes_of_egui() {
        let mut style = Style::default();
        set_text_style(&mut style);
        assert_eq!(style.text_styles, Style::default().text_styles);
    }

    /// The contrast ratio of two colours by the W3C accessibility guidelines.
    fn contrast(one: Color32, other: Color32) -> f32 {
        let luminance = |color: Color32| {
            let [r, g, b] = [color.r(), color.g(), color.b()].map(gamma_to_linear);
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
        one.max(other) / one.min(other)
    }

    #[test]
    fn light_colors_keep_the_contrast() {
        let ground = to_light(WINDOW_GROUND);
        assert!(ground.r() > 215, "{ground:?}");
        // Inks of hints and marks on the bars, the brightest backgrounds.
        for ink in [140, 150, 160, 190].map(Color32::from_gray) {
            let bar = Color32::from_gray(40);
            let (dark, light) = (contrast(ink, bar), contrast(to_light(ink), to_light(bar)));
            assert!(
                light > 4.4 && light > dark - 0.1,
                "{ink:?}: {dark}, {light}"
            );
        }
        for ink in [
            Color32::from_gray(225),
            Color32::from_gray(170),
            Color32::from_rgb(255, 196, 90),
            Color32::from_rgb(255, 120, 96),
            Color32::from_rgb(110, 230, 120),
            Color32::from_rgb(120, 190, 255),
            Color32::from_rgb(255, 255, 140),
        ] {
            let light = to_light(ink);
            assert!(contrast(light, ground) > 4.5, "{ink:?} becomes {light:?}");
        }
    }

    #[test]
    fn hues_are_kept() {
        let [red, green, blue] = to_light_rgb([255, 110, 96]);
        assert!(red > green + 60 && red > blue + 60, "{red} {green} {blue}");
        let [red, green, blue] = to_light_rgb([110, 180, 255]);
        assert!(blue > green + 40 && green > red, "{red} {green} {blue}");
    }

    #[test]
    fn placeholder_colors_are_kept() {
        for color in [Color32::PLACEHOLDER, Color32::TRANSPARENT] {
            assert_eq!(to_light(color), color);
        }
    }

    #[test]
    fn images_keep_their_colors() {
        let mut mesh = egui::Mesh::with_texture(TextureId::User(1));
        mesh.add_rect_with_uv(Rect::ZERO, Rect::ZERO, Color32::WHITE);
        let mut shape = Shape::Vec(vec![Shape::mesh(mesh)]);
        lighten(&mut shape);
        let Shape::Vec(shapes) = &shape else {
            panic!("{shape:?}")
        };
        let Some(Shape::Mesh(mesh)) = shapes.first() else {
            panic!("{shapes:?}")
        };
        assert_eq!(mesh.vertices.first().unwrap().color, Color32::WHITE);
    }
}
