//! Colours, text sizes and spacing of the window. Views draw in the dark palette below. For
//! light surroundings each colour is replaced by its counterpart in the [light palette](light),
//! just before a frame is shown. Panel, LCD and the lit part are images and look the same in
//! both themes.

mod light;
#[cfg(test)]
mod tests;

use std::cell::Cell;

use egui::epaint::shape_transform::adjust_colors;
use egui::{
    Color32, Context, FontId, FullOutput, Id, Painter, Plugin, Pos2, Rect, Shape, Style, TextStyle,
    TextureHandle, TextureId, TextureOptions, pos2,
};

// Accent.

/// Accent colour: selection, links, the current step, connections and marks of changes.
pub const ACCENT: Color32 = Color32::from_rgb(104, 178, 255);
/// Background colour of selected text and rows.
pub const ACCENT_GROUND: Color32 = Color32::from_rgb(24, 72, 128);

// Text.

/// Default colour of text.
pub const TEXT: Color32 = Color32::from_gray(225);
/// Colour of the message text in the top bar.
pub const MESSAGE_TEXT: Color32 = Color32::from_gray(220);
/// Colour of the text of rows in lists and tables.
pub const ROW_TEXT: Color32 = Color32::from_gray(215);
/// Colour of emphasized text, such as the step of a lesson, and of an icon under the pointer.
pub const BRIGHT_TEXT: Color32 = Color32::WHITE;
/// Colour of view titles, times and received lines.
pub const SECONDARY_TEXT: Color32 = Color32::from_gray(200);
/// Colour of unobtrusive text: states over the picture, keys of views, positions that match.
pub const QUIET_TEXT: Color32 = Color32::from_gray(190);
/// Colour of notes, file names and idle icons.
pub const NOTE_TEXT: Color32 = Color32::from_gray(170);
/// Colour of the state text of the machine view while there is no warning.
pub const STATE_TEXT: Color32 = Color32::from_gray(160);
/// Colour of explanations and of egui's weak text. It is opaque, because a half-transparent one
/// would be paler on a light background.
pub const WEAK_TEXT: Color32 = Color32::from_gray(150);
/// Colour of the hint in the top bar while there is no message.
pub const HINT_TEXT: Color32 = Color32::from_gray(140);
/// Colour of text on lamps, signs and flags in bright colours.
pub const TEXT_ON_BRIGHT: Color32 = Color32::BLACK;

// Grounds.

/// Transparent fill colour, for shapes that are not filled.
pub const NO_FILL: Color32 = Color32::TRANSPARENT;
/// Background colour of the window.
pub const WINDOW_GROUND: Color32 = Color32::from_gray(22);
/// Background colour of drawings: lathe, ladder, scope.
pub const DRAWING_GROUND: Color32 = Color32::from_gray(18);
/// Background colour of lists and forms in a view.
pub const SIDE_GROUND: Color32 = Color32::from_gray(28);
/// Background colour of the bars of the window and of its views.
pub const BAR_GROUND: Color32 = Color32::from_gray(34);
/// Background colour of the tab bar and of the header of a view.
pub const HEADER_GROUND: Color32 = Color32::from_gray(40);

/// Colour of the shade on a row under the pointer.
pub fn row_hover() -> Color32 {
    Color32::from_white_alpha(10)
}

/// Colour of a splitter between two panes that is not in use.
pub const SPLITTER: Color32 = Color32::from_gray(44);
/// Colour of a splitter that has the pointer or the focus.
pub const SPLITTER_ACTIVE: Color32 = ACCENT;
/// Tint for images that are drawn in their own colours.
pub const NO_TINT: Color32 = Color32::WHITE;

// Buttons that select one of several values.

/// Background colour of the button of a choice that is selected.
pub const CHOICE_SELECTED_GROUND: Color32 = Color32::from_gray(58);
pub const CHOICE_SELECTED_TEXT: Color32 = Color32::from_gray(210);
/// Background colour of the buttons of a choice that are not selected.
pub const CHOICE_GROUND: Color32 = Color32::from_gray(42);

// Success, warning, danger.

/// Colour of marks for states that are complete, valid or connected.
pub const SUCCESS: Color32 = Color32::from_rgb(110, 230, 120);
/// Colour of the text about a job that is saved and valid.
pub const JOB_VALID: Color32 = SUCCESS;
/// Colour of a connection that moves the machine, and of the lines sent to it.
pub const BUSY: Color32 = ACCENT;
/// Colour of marks for states that are uncertain, waiting or on trial, and of the signs of the top
/// bar.
pub const WARNING: Color32 = Color32::from_rgb(255, 196, 90);
/// Colour that marks a forced PLC bit.
pub const FORCED: Color32 = WARNING;
/// Colour of the text of unsaved changes, and of the reason why the control refuses them.
pub const UNSAVED_TEXT: Color32 = Color32::from_rgb(255, 214, 110);
/// Colour that marks a value that differs from the delivered one.
pub const DIFFERS: Color32 = ACCENT;
/// Colour of the text of alarms, faults and failed transfers.
pub const ALARM_TEXT: Color32 = Color32::from_rgb(255, 120, 96);
/// Colour of the text about an error in typed input.
pub const ERROR_TEXT: Color32 = Color32::from_rgb(255, 150, 110);
/// Colour of the text about an error in an address that was typed in the scope.
pub const SCOPE_ERROR_TEXT: Color32 = ERROR_TEXT;
/// Colour of the text about an error in a job.
pub const JOB_ERROR: Color32 = ALARM_TEXT;
/// Colour that marks a collision, and the end of a path by an alarm.
pub const COLLISION: Color32 = Color32::from_rgb(255, 70, 60);

// The bar that warns of a real machine.

/// Colour of the text in the warning bar of a real machine, white in both themes. In the dark theme
/// it is one step off white, to be distinguishable from other white text.
pub const MACHINE_BAR_TEXT: Color32 = Color32::from_rgb(255, 255, 254);
/// Background colour of the warning bar while the board can move the slides.
pub const MACHINE_CONNECTED_GROUND: Color32 = Color32::from_rgb(208, 30, 24);
/// Background colour of the warning bar while the board is off or lost.
pub const MACHINE_DISCONNECTED_GROUND: Color32 = Color32::from_rgb(150, 84, 20);

// Rings around keys of the panel, and lamps of the bench.

/// Colour of the ring around a latched key.
pub const LATCH_RING: Color32 = Color32::from_rgb(255, 150, 0);
/// Colour of the ring around a key that the operator should press in a lesson.
pub const LESSON_RING: Color32 = Color32::from_rgb(60, 220, 255);
pub const LAMP_ON: Color32 = SUCCESS;
pub const LAMP_OFF: Color32 = Color32::from_gray(62);
pub const LAMP_OFF_TEXT: Color32 = Color32::from_gray(170);

// Lessons.

/// Colour of the current step of a lesson, and of a demonstration.
pub const LESSON_STEP: Color32 = ACCENT;
/// Colour of the mark of a lesson step that is not done.
pub const LESSON_OPEN: Color32 = Color32::from_gray(104);
pub const LESSON_HINT_TEXT: Color32 = Color32::from_rgb(255, 214, 130);

// Part programs.

pub const CODE_GROUND: Color32 = Color32::from_gray(22);
pub const CODE_ALARM_GROUND: Color32 = Color32::from_rgb(70, 28, 26);
/// Colour of words that raise an alarm, and of characters that belong to no word.
pub const CODE_ALARM_TEXT: Color32 = Color32::from_rgb(255, 110, 96);
/// Colour of the mark of a breakpoint beside its line number.
pub const BREAKPOINT: Color32 = CODE_ALARM_TEXT;
pub const LINE_NUMBER_GROUND: Color32 = Color32::from_gray(30);
pub const LINE_NUMBER_TEXT: Color32 = Color32::from_gray(140);
/// Colour of block and program numbers in a program text.
pub const CODE_NAME: Color32 = Color32::from_gray(150);
/// Colour of G words in a program text.
pub const CODE_G: Color32 = Color32::from_rgb(110, 180, 255);
/// Colour of M words in a program text.
pub const CODE_FUNCTION: Color32 = Color32::from_rgb(255, 170, 90);
/// Colour of S, F and T words in a program text.
pub const CODE_SETTING: Color32 = Color32::from_rgb(225, 150, 230);
pub const CODE_AXIS: Color32 = Color32::from_rgb(240, 240, 240);
pub const CODE_OTHER: Color32 = Color32::from_rgb(230, 215, 140);
pub const CODE_STATEMENT: Color32 = Color32::from_rgb(150, 215, 225);
pub const CODE_COMMENT: Color32 = Color32::from_rgb(120, 190, 130);
/// Colour of end of block, block skip and program mark in a program text.
pub const CODE_MARK: Color32 = Color32::from_gray(140);

// Paths of the tool.

pub const RAPID_PATH: Color32 = Color32::from_rgb(255, 150, 60);
pub const FEED_PATH: Color32 = Color32::from_rgb(90, 180, 255);
pub const THREAD_PATH: Color32 = Color32::from_rgb(80, 225, 120);
/// Colour of the path of the running block.
pub const RUNNING_PATH: Color32 = Color32::from_rgb(255, 255, 140);

/// Returns the colour of the glow around the path of the running block.
pub fn running_glow() -> Color32 {
    RUNNING_PATH.gamma_multiply(0.3)
}

/// Colour of the path of the selected block.
pub const SELECTED_PATH: Color32 = Color32::from_rgb(255, 110, 220);
/// Colour of the path of the selected pass of a cycle.
pub const PASS_PATH: Color32 = Color32::from_rgb(255, 245, 170);
/// Colour of the path of the block that raises an alarm.
pub const FAULT_PATH: Color32 = Color32::from_rgb(255, 60, 50);
/// Colour of dwells in the time bar, and of times without a known move.
pub const DWELL: Color32 = Color32::from_gray(64);
pub const DWELL_TEXT: Color32 = Color32::from_gray(150);
/// Colour of the shade on the elapsed part of the time bar.
pub const TIME_DONE_SHADE: Color32 = Color32::from_black_alpha(110);
/// Colour of the line at the current time in the time bar.
pub const TIME_CURSOR: Color32 = Color32::WHITE;

/// Returns the colour of a column of the time bar whose moves have the colour `path` in the
/// picture.
pub fn time_column(path: Color32) -> Color32 {
    path.gamma_multiply(0.75)
}

/// Colour of the cuts with the greatest force.
const LOAD_GREATEST: Color32 = Color32::from_rgb(255, 110, 50);

/// Returns the colour of a cut by its share of the greatest force, 0 to 1.
pub fn load_color(share: f32) -> Color32 {
    match share < 0.5 {
        true => FEED_PATH.lerp_to_gamma(WARNING, share * 2.0),
        false => WARNING.lerp_to_gamma(LOAD_GREATEST, share * 2.0 - 1.0),
    }
}

// Time line of the session.

pub const TIMELINE_GROUND: Color32 = DRAWING_GROUND;
/// Colour of the shade on the time line after the past moment that is shown.
pub const TIMELINE_LATER_SHADE: Color32 = TIME_DONE_SHADE;
pub const TIMELINE_BLOCK: Color32 = FEED_PATH;
pub const TIMELINE_KEY: Color32 = SUCCESS;
pub const TIMELINE_INPUT: Color32 = CODE_SETTING;
pub const TIMELINE_ALARM: Color32 = ALARM_TEXT;
pub const TIMELINE_COLLISION: Color32 = COLLISION;
/// Colour of the mark at which the abandoned future starts on the time line.
pub const TIMELINE_BRANCH: Color32 = WARNING;
pub const TIMELINE_HANDLE: Color32 = TIME_CURSOR;

// Drawing of the part.

pub const GRID_LINE: Color32 = Color32::from_gray(34);
/// Colour of the numbers at grid lines.
pub const GRID_TEXT: Color32 = Color32::from_gray(150);
pub const SPINDLE_AXIS: Color32 = Color32::from_rgb(176, 120, 120);
/// Background colour of text over the picture.
pub const PICTURE_LABEL_GROUND: Color32 = Color32::from_rgba_premultiplied(12, 12, 12, 170);
/// Fill colour of the cut face of the half section.
pub const SECTION: Color32 = Color32::from_rgb(81, 81, 84);
/// Colour of the hatch lines on the cut face of the half section.
pub const HATCHING: Color32 = Color32::from_rgb(166, 164, 156);
/// Fill colour of the outside of the part, below the axis.
pub const PART_OUTSIDE: Color32 = Color32::from_rgb(74, 74, 76);
pub const PART_EDGE: Color32 = Color32::from_rgb(196, 196, 192);
pub const CHUCK: Color32 = Color32::from_rgb(44, 50, 60);
pub const CHUCK_JAWS: Color32 = Color32::from_rgb(62, 72, 88);
pub const CLAMPING_EDGE: Color32 = Color32::from_rgb(104, 116, 136);
pub const INSERT: Color32 = Color32::from_rgb(240, 200, 60);
pub const INSERT_EDGE: Color32 = Color32::WHITE;
pub const TOOL_HOLDER: Color32 = Color32::from_rgb(98, 104, 112);
pub const TOOL_HOLDER_EDGE: Color32 = Color32::from_rgb(150, 156, 164);
/// Colour of the marks on the turning spindle, and of the coolant nozzle.
pub const SPINDLE_MARK: Color32 = Color32::from_rgb(150, 164, 186);
/// Colour of coolant. Its hue differs from those of the paths.
pub const COOLANT: Color32 = Color32::from_rgba_unmultiplied_const(70, 190, 190, 110);
const COOLANT_OPAQUE: Color32 = Color32::from_rgb(70, 190, 190);

// Measurement of the part.

/// Colour of the measured feature of the part under the pointer.
pub const MEASURED_FEATURE: Color32 = Color32::from_rgb(255, 240, 120);
/// Colour of a measured feature that the user has kept in the picture.
pub const KEPT_MEASUREMENT: Color32 = Color32::from_rgb(255, 150, 220);
pub const CALIPER: Color32 = Color32::from_rgb(190, 220, 255);
pub const CALIPER_LABEL_GROUND: Color32 = Color32::from_rgba_premultiplied(10, 12, 16, 220);
pub const WITHIN_TOLERANCE: Color32 = Color32::from_rgb(90, 215, 110);
pub const MATERIAL_LEFT: Color32 = Color32::from_rgb(80, 150, 255);
pub const CUT_TOO_DEEP: Color32 = COLLISION;
pub const PROGRAMMED_PATH: Color32 = Color32::WHITE;
/// Colour of the path of the centre of the tool nose.
pub const NOSE_CENTER_PATH: Color32 = Color32::from_rgb(200, 130, 255);

/// Returns the colour of a path under the microscope, which is fainter than `path`.
pub fn microscope_path(path: Color32) -> Color32 {
    path.gamma_multiply(0.6)
}

// Ladder.

/// Colour of the parts of a rung through which power flows.
pub const LADDER_LIVE: Color32 = Color32::from_rgb(96, 226, 118);
/// Colour of the parts of a rung through which no power flows.
pub const LADDER_DEAD: Color32 = Color32::from_gray(118);
/// Colour of the power rails, and of symbols of elements without power.
pub const LADDER_RAIL: Color32 = Color32::from_gray(150);
pub const LADDER_COMMENT: Color32 = Color32::from_gray(146);
pub const LADDER_TITLE: Color32 = Color32::from_rgb(150, 190, 230);
pub const LADDER_SELECTED: Color32 = ACCENT;
/// Background colour of a ladder element that the search has found.
pub const LADDER_FOUND_GROUND: Color32 = Color32::from_rgba_unmultiplied_const(255, 214, 90, 38);
const LADDER_FOUND: Color32 = Color32::from_rgb(255, 214, 90);
pub const LADDER_BOX_GROUND: Color32 = Color32::from_gray(30);
/// Background colour of the label between two rungs.
pub const LADDER_MARK_GROUND: Color32 = Color32::from_gray(40);
/// Colour of the frame around a rung that does not compile, and of its error text.
pub const LADDER_RUNG_ERROR: Color32 = Color32::from_rgb(255, 110, 90);
/// Colour of errors in the compiler's list.
pub const LADDER_ERROR_TEXT: Color32 = Color32::from_rgb(255, 130, 104);

/// Returns the fill colour of a contact or coil with power.
pub fn ladder_live_ground() -> Color32 {
    LADDER_LIVE.gamma_multiply(0.35)
}

/// Returns the colour of the frame around a ladder element under the pointer.
pub fn ladder_hover() -> Color32 {
    LADDER_SELECTED.gamma_multiply(0.5)
}

// Scope and curves.

pub const SCOPE_GRID: Color32 = Color32::from_gray(46);
pub const SCOPE_ZERO_LINE: Color32 = Color32::from_gray(74);
pub const SCOPE_FRAME: Color32 = Color32::from_gray(84);
/// Colour of the numbers at the scales of scope and curves.
pub const SCALE_TEXT: Color32 = Color32::from_gray(160);
pub const SCOPE_LANE_TEXT: Color32 = Color32::from_gray(205);
/// Colour of the scope trace of the actual values of X.
pub const SCOPE_X: Color32 = Color32::from_rgb(92, 190, 255);
pub const SCOPE_X_COMMAND: Color32 = Color32::from_rgb(64, 118, 158);
/// Colour of the scope trace of the actual values of Z.
pub const SCOPE_Z: Color32 = Color32::from_rgb(255, 176, 72);
pub const SCOPE_Z_COMMAND: Color32 = Color32::from_rgb(164, 118, 58);
/// Colour of the scope trace of values along the path.
pub const SCOPE_PATH: Color32 = Color32::from_rgb(140, 222, 120);
/// Colour of the scope trace of the actual values of the spindle.
pub const SCOPE_SPINDLE: Color32 = Color32::from_rgb(238, 130, 208);
pub const SCOPE_SPINDLE_COMMAND: Color32 = Color32::from_rgb(150, 88, 132);
pub const SCOPE_BIT: Color32 = Color32::from_rgb(150, 214, 190);
pub const SCOPE_CURSORS: [Color32; 2] = [
    Color32::from_rgb(255, 226, 90),
    Color32::from_rgb(120, 226, 226),
];
/// Colour of the grid lines of pitch error curves.
pub const CURVE_GRID: Color32 = Color32::from_gray(52);
pub const CURVE_CURRENT: Color32 = Color32::from_gray(150);
pub const CURVE_MEASURED: Color32 = Color32::from_rgb(255, 180, 90);
pub const CURVE_PROPOSED: Color32 = Color32::from_rgb(90, 200, 255);

/// Returns the fill colour of the scope lane of a bit while the bit is 1.
pub fn scope_bit_ground() -> Color32 {
    SCOPE_BIT.gamma_multiply(0.25)
}

// The type scale: three sizes. Colours give the second weight.

const SMALL: f32 = 11.0;
const BODY: f32 = 13.0;
const LARGE: f32 = 16.0;

/// Text size of the 0 or 1 in a lamp, points.
pub const LAMP_SIZE: f32 = SMALL;
/// Text size of numbers at the grid of the picture and at curves, points.
pub const SCALE_SIZE: f32 = SMALL;
/// Text size of the names of bits in the scope, points.
pub const BIT_NAME_SIZE: f32 = SMALL;
/// Text size of comments in drawings and of figures of the scope, points.
pub const ANNOTATION_SIZE: f32 = BODY;
/// Text size of addresses and values in drawings and of line numbers, points.
pub const LABEL_SIZE: f32 = BODY;
/// Text size of the number keys of a form, points.
pub const KEY_TEXT_SIZE: f32 = LARGE;
/// Text size of the titles of rungs, points.
pub const TITLE_SIZE: f32 = BODY;
/// Text size of part programs, and of sentences that are read at a distance, points.
pub const READING_SIZE: f32 = LARGE;
/// Text size of the step of a lesson, large buttons, readings of the caliper and the state of
/// a real machine, points.
pub const LARGE_SIZE: f32 = LARGE;
/// Size of an icon from the icon font, points.
pub const ICON_SIZE: f32 = LARGE;
/// Size of an icon that is drawn as a picture, points.
pub const PICTURE_ICON_SIZE: f32 = 2.0 * LARGE;
/// Text size of the message at the end of a lesson, points.
pub const LESSON_END_SIZE: f32 = LARGE;
/// Text size of the warning of a real machine, points.
pub const MACHINE_WARNING_SIZE: f32 = LARGE;

// Spacing, points: two steps.

const SPACE: f32 = 4.0;
const WIDE_SPACE: f32 = 8.0;

/// Sets the text styles and text colours of all windows.
pub fn set_text_style(style: &mut Style) {
    style.text_styles = [
        (TextStyle::Small, FontId::proportional(SMALL)),
        (TextStyle::Body, FontId::proportional(BODY)),
        (TextStyle::Button, FontId::proportional(BODY)),
        (TextStyle::Monospace, FontId::monospace(BODY)),
        (TextStyle::Heading, FontId::proportional(LARGE)),
    ]
    .into();
    style.visuals.override_text_color = Some(TEXT);
    style.visuals.weak_text_color = Some(WEAK_TEXT);
    style.visuals.hyperlink_color = ACCENT;
    style.visuals.selection.bg_fill = ACCENT_GROUND;
    style.visuals.selection.stroke.color = ACCENT;
    style.spacing.item_spacing = egui::vec2(WIDE_SPACE, SPACE);
    style.spacing.button_padding = egui::vec2(SPACE, SPACE / 2.0);
    style.spacing.menu_margin = egui::Margin::same(WIDE_SPACE as i8);
}

// The light theme.

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

/// Whether the context uses the light theme.
pub fn is_light(context: &Context) -> bool {
    let light = context.with_plugin(|plugin: &mut ThemePlugin| plugin.light);
    light.unwrap_or(false)
}

/// Returns the background colour of a window in the light or the dark theme.
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

/// Converts the colours of a shape to the light theme, unless it is an image.
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
    let [red, green, blue] = light::to_light_rgb([red, green, blue], cover == u8::MAX);
    let light = Color32::from_rgba_unmultiplied(red, green, blue, cover);
    LAST_CONVERSION.set((color, light));
    light
}
