//! Tests of the contrast, the type scale and the light palette.

use std::fs;
use std::path::{Path, PathBuf};

use super::*;

/// Minimum contrast of a text to its ground in both themes.
const MIN_TEXT_CONTRAST: f32 = 4.5;
/// Minimum contrast of lines, marks and fills to their ground in both themes.
const MIN_GRAPHIC_CONTRAST: f32 = 3.0;
/// Source text before a colour constant. The list after it has functions that set a text
/// size if a digit follows.
const COLOR_TYPE: &str = "Color32::";
const SIZE_FUNCTIONS: [&str; 4] = [
    "FontId::proportional(",
    "FontId::monospace(",
    "FontId::new(",
    ".size(",
];
/// Source texts by which code outside the theme would define a colour.
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

/// Whether `code` begins with a digit after any spaces.
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
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    collect_sources(&folder, &mut files);
    assert!(files.len() > 30, "the window is elsewhere now");
    files.sort();
    let mut found = Vec::new();
    for path in files.iter().filter(|path| {
        !path.ends_with("src/theme.rs")
            && !path.parent().is_some_and(|it| it.ends_with("src/theme"))
    }) {
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
            vec![LINE_NUMBER_TEXT, BREAKPOINT],
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
        ("curves", curves, bars),
    ]
}

/// Lines and marks, and the grounds they are drawn on in the dark theme.
fn graphics_on_grounds() -> Vec<(&'static str, Vec<Color32>, Vec<Color32>)> {
    let paths = vec![
        RAPID_PATH,
        FEED_PATH,
        THREAD_PATH,
        RUNNING_PATH,
        SELECTED_PATH,
        PASS_PATH,
        FAULT_PATH,
        COLLISION,
    ];
    let part = vec![
        PART_EDGE,
        CLAMPING_EDGE,
        TOOL_HOLDER_EDGE,
        SPINDLE_MARK,
        SPINDLE_AXIS,
    ];
    let measured = vec![
        CALIPER,
        MEASURED_FEATURE,
        KEPT_MEASUREMENT,
        NOSE_CENTER_PATH,
    ];
    let traces = vec![
        SCOPE_X,
        SCOPE_X_COMMAND,
        SCOPE_Z,
        SCOPE_Z_COMMAND,
        SCOPE_SPINDLE,
        SCOPE_SPINDLE_COMMAND,
        SCOPE_BIT,
    ];
    let drawing = vec![DRAWING_GROUND];
    vec![
        ("paths", paths, drawing.clone()),
        ("part and machine", part, drawing.clone()),
        ("hatching", vec![HATCHING], vec![SECTION]),
        ("measurements", measured, drawing.clone()),
        ("traces", traces, drawing.clone()),
        ("ladder", vec![LADDER_DEAD, LADDER_SELECTED], drawing),
        ("splitter", vec![SPLITTER_ACTIVE], vec![WINDOW_GROUND]),
        (
            "lesson steps",
            vec![LESSON_OPEN, LESSON_STEP],
            vec![SIDE_GROUND],
        ),
    ]
}

#[test]
#[allow(clippy::print_stdout, reason = "the figures are read with --nocapture")]
fn texts_and_graphics_have_contrast_in_both_themes() {
    let texts = texts_on_grounds()
        .into_iter()
        .map(|it| (it, MIN_TEXT_CONTRAST));
    let graphics = graphics_on_grounds()
        .into_iter()
        .map(|it| (it, MIN_GRAPHIC_CONTRAST));
    let mut faults = Vec::new();
    for ((what, inks, grounds), least) in texts.chain(graphics) {
        for ink in inks {
            for ground in &grounds {
                let dark = contrast(ink, *ground);
                let light = contrast(to_light(ink), to_light(*ground));
                let [ink, ground] = [ink, *ground].map(|color| color.to_hex());
                let row = format!("{what}: {ink} on {ground}: dark {dark:.1}, light {light:.1}");
                println!("{row}");
                if dark.min(light) < least {
                    faults.push(row);
                }
            }
        }
    }
    assert!(faults.is_empty(), "too faint:\n{}", faults.join("\n"));
}

#[test]
fn the_type_scale_has_three_sizes() {
    let mut style = Style::default();
    set_text_style(&mut style);
    let mut sizes: Vec<f32> = style.text_styles.values().map(|font| font.size).collect();
    sizes.extend([
        LAMP_SIZE,
        SCALE_SIZE,
        BIT_NAME_SIZE,
        ANNOTATION_SIZE,
        LABEL_SIZE,
    ]);
    sizes.extend([
        TITLE_SIZE,
        READING_SIZE,
        LARGE_SIZE,
        LESSON_END_SIZE,
        MACHINE_WARNING_SIZE,
    ]);
    sizes.sort_by(f32::total_cmp);
    sizes.dedup();
    assert_eq!(sizes, [SMALL, BODY, LARGE]);
}

#[test]
fn light_surfaces_are_neutral_and_nearly_white() {
    for ground in [
        WINDOW_GROUND,
        DRAWING_GROUND,
        SIDE_GROUND,
        BAR_GROUND,
        HEADER_GROUND,
    ] {
        let [red, green, blue, _] = to_light(ground).to_array();
        assert!(red >= 236 && red == green && green == blue, "{ground:?}");
    }
}

/// The contrast ratio of two colours by the W3C accessibility guidelines.
fn contrast(one: Color32, other: Color32) -> f32 {
    let luminance = |color: Color32| {
        let [r, g, b] = [color.r(), color.g(), color.b()].map(light::gamma_to_linear);
        0.2126 * r + 0.7152 * g + 0.0722 * b
    };
    let (one, other) = (luminance(one) + 0.05, luminance(other) + 0.05);
    one.max(other) / one.min(other)
}

#[test]
fn hues_of_colors_outside_the_palette_are_kept() {
    let [red, green, blue] = light::to_light_rgb([250, 112, 99], true);
    assert!(red > green + 60 && red > blue + 60, "{red} {green} {blue}");
    let [red, green, blue] = light::to_light_rgb([112, 178, 250], true);
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
