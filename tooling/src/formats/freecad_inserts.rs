//! Tool bits of FreeCAD's add-on for lathes: inserts by tip angle, size, nose and rotation.
//!
//! Its shapes are rhombi (`Iso_shape_C`, `D`, `S`) and a triangle (`Iso_shape_T`). `TipAngle`
//! overrides the angle of a rhombus, so a V insert is a `D` with 35°. `EdgeLength` is the diameter
//! of the inscribed circle: the drawn rhombi have it between parallel edges, and the tables of the
//! add-on give it for every letter. `Rotation` is the angle from Z+ to the bisector of the tip.

use gsk_messages::{Message, say};
use gsk_workpiece::tool::{Insert, InsertLetter, Tool};
use serde_json::Value;

use super::freecad_quantity::{QuantityUnit, parse_quantity};

/// How the file names of the add-on's shapes begin, before the letter.
const SHAPE_PREFIX: &str = "iso_shape_";
/// Greatest difference of an angle from a whole one that counts as equal, degrees: FreeCAD writes
/// two decimals.
const ANGLE_TOLERANCE_DEGREES: f64 = 0.005_001;

/// Keys of the parameters.
const TIP_ANGLE: &str = "TipAngle";
const SIZE: &str = "EdgeLength";
const NOSE: &str = "TipRadius";
const ROTATION: &str = "Rotation";

/// A parameter of a tool bit: key, value and unit.
pub(super) type BitParameter = (&'static str, f64, &'static str);

/// The shape of the add-on for a tool and its parameters; `None` for a tool without one: other
/// kinds of tools, round and trigon inserts, and tips 0 and 9, which have no direction.
pub(super) fn insert_parameters(tool: &Tool) -> Option<(&'static str, Vec<BitParameter>)> {
    let Insert::Turning {
        letter,
        entering,
        size,
        nose,
    } = tool.insert
    else {
        return None;
    };
    let shape = match letter {
        InsertLetter::C => "Iso_shape_C",
        InsertLetter::D | InsertLetter::V => "Iso_shape_D",
        InsertLetter::S => "Iso_shape_S",
        InsertLetter::T => "Iso_shape_T",
        InsertLetter::W | InsertLetter::R => return None,
    };
    let bisector = 180.0 - entering - letter.corner() / 2.0;
    let rotation = match tool.tip {
        1 => 180.0 + bisector,
        2 => 360.0 - bisector,
        3 => bisector,
        4 => 180.0 - bisector,
        5 => 180.0,
        6 => 270.0,
        7 => 0.0,
        8 => 90.0,
        _ => return None,
    };
    let parameters = vec![
        // The add-on does not use it; FreeCAD's operations refuse a tool without one.
        ("Diameter", size, "mm"),
        (SIZE, size, "mm"),
        (ROTATION, rotation, "°"),
        (TIP_ANGLE, letter.corner(), "°"),
        (NOSE, nose, "mm"),
    ];
    Some((shape, parameters))
}

/// The tool of a bit of the add-on, with the usual holder of its direction; `None` if the bit has
/// another shape. `shape` is the name of the shape file without folders and ending, in lower case.
pub(super) fn parse_insert(shape: &str, bit: &Value) -> Option<Result<Tool, Message>> {
    let letter = shape.strip_prefix(SHAPE_PREFIX)?;
    Some(parse_parameters(letter, bit))
}

fn parse_parameters(shape: &str, bit: &Value) -> Result<Tool, Message> {
    let angles = QuantityUnit::Angle;
    let letter = insert_letter(shape, read(bit, TIP_ANGLE, angles)?)
        .map_err(|rule| refused(bit, TIP_ANGLE, rule))?;
    let rotation = read(bit, ROTATION, angles)?.rem_euclid(360.0);
    let (tip, bisector) = direction(rotation);
    let mut tool = Tool {
        tip,
        ..Tool::turning()
    };
    if tool.is_internal() {
        tool.holder = Tool::boring().holder;
    }
    let size = read(bit, SIZE, QuantityUnit::Length)?;
    let nose = read(bit, NOSE, QuantityUnit::Length)?;
    // A valid insert takes one value after the other, so that a broken rule names its parameter.
    let mut set = |key: &str, entering: f64, nose: f64| {
        tool.insert = Insert::Turning {
            letter,
            entering,
            size,
            nose,
        };
        tool.check().map_err(|rule| refused(bit, key, rule))
    };
    let symmetric = symmetric_entering(letter);
    set(SIZE, symmetric, 0.0)?;
    set(NOSE, symmetric, nose)?;
    set(ROTATION, 180.0 - bisector - letter.corner() / 2.0, nose)?;
    Ok(tool)
}

/// The insert of a shape with a tip angle, or the angles that the shape can have.
fn insert_letter(shape: &str, tip_angle: f64) -> Result<InsertLetter, Message> {
    let letters: &[InsertLetter] = match shape {
        "c" | "d" | "s" | "v" => &[
            InsertLetter::C,
            InsertLetter::D,
            InsertLetter::V,
            InsertLetter::S,
        ],
        "t" => &[InsertLetter::T],
        _ => return Err(say::tool_freecad_letter(shape.to_uppercase())),
    };
    let is_equal = |it: &&InsertLetter| is_near(it.corner(), tip_angle);
    let found = letters.iter().find(is_equal).copied();
    let known: Vec<String> = letters
        .iter()
        .map(|it| format!("{}° ({it:?})", it.corner()))
        .collect();
    found.ok_or_else(|| say::tool_freecad_tip_angle(known.join(", ")))
}

/// The tip number at a rotation, and the angle from the spindle axis to the bisector of the tip in
/// the mirror image with tip 3.
fn direction(rotation: f64) -> (u8, f64) {
    for (tip, angle) in [(7, 0.0), (8, 90.0), (5, 180.0), (6, 270.0), (7, 360.0)] {
        if is_near(rotation, angle) {
            // Such a tool is symmetric: its entering angle follows from its corner.
            return (tip, 90.0);
        }
    }
    match rotation {
        it if it < 90.0 => (3, it),
        it if it < 180.0 => (4, 180.0 - it),
        it if it < 270.0 => (1, it - 180.0),
        it => (2, 360.0 - it),
    }
}

/// The entering angle of an insert whose bisector is at right angles to the spindle axis, degrees.
fn symmetric_entering(letter: InsertLetter) -> f64 {
    90.0 - letter.corner() / 2.0
}

fn is_near(a: f64, b: f64) -> bool {
    libm::fabs(a - b) <= ANGLE_TOLERANCE_DEGREES
}

fn parameter<'a>(bit: &'a Value, key: &str) -> Option<&'a Value> {
    bit.get("parameter")?.get(key)
}

fn read(bit: &Value, key: &str, unit: QuantityUnit) -> Result<f64, Message> {
    let value = parameter(bit, key).ok_or_else(|| say::tool_freecad_list(key))?;
    parse_quantity(value, unit).ok_or_else(|| refused(bit, key, unit.rule()))
}

/// The rule that a parameter breaks, with its key and its text.
fn refused(bit: &Value, key: &str, rule: Message) -> Message {
    let text = match parameter(bit, key) {
        Some(Value::String(text)) => text.clone(),
        Some(other) => other.to_string(),
        None => String::new(),
    };
    say::tool_freecad_value(key, text, rule)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_messages::Language;
    use serde_json::json;

    fn bit(shape: &str, values: [&str; 4]) -> (String, Value) {
        let [angle, size, nose, rotation] = values;
        let parameter = json!({
            "Diameter": "1.48 mm", "TipAngle": angle, "EdgeLength": size, "TipRadius": nose,
            "Rotation": rotation,
        });
        (shape.to_owned(), json!({ "parameter": parameter }))
    }

    fn parse(shape: &str, values: [&str; 4]) -> Result<Tool, String> {
        let (shape, bit) = bit(shape, values);
        let tool = parse_insert(&shape, &bit).expect("a shape of the add-on");
        tool.map_err(|it| it.text(Language::En))
    }

    /// The bits that the add-on ships (CCMT070204R, DCMT070204R, TCMT110204R).
    #[test]
    fn shipped_bits_give_their_inserts() {
        for (shape, angle, rotation, letter, entering) in [
            ("c", "80.00 °", "45.00 °", InsertLetter::C, 95.0),
            ("d", "55.00 °", "45.00 °", InsertLetter::D, 107.5),
            ("t", "60.00 °", "60.00 °", InsertLetter::T, 90.0),
        ] {
            let shape = format!("iso_shape_{shape}");
            let tool = parse(&shape, [angle, "6.35 mm", "0.40 mm", rotation]).unwrap();
            let expected = Insert::Turning {
                letter,
                entering,
                size: 6.35,
                nose: 0.4,
            };
            assert_eq!((tool.insert, tool.tip), (expected, 3), "{shape}");
        }
        let refused = parse("iso_shape_s", ["90.00 °", "9.53 mm", "0.40 mm", "45.00 °"]);
        let refused = refused.unwrap_err();
        assert!(
            refused.starts_with("`Rotation` is 45.00 °: entering angle") && refused.contains("88"),
            "{refused}"
        );
    }

    #[test]
    fn units_and_directions_are_read() {
        let values = ["35 deg", "0.375 in", "400 µm", "1.0471975512 rad"];
        let tool = parse("iso_shape_d", values).unwrap();
        let Insert::Turning {
            letter,
            entering,
            size,
            nose,
        } = tool.insert
        else {
            panic!("{tool:?}");
        };
        assert_eq!(letter, InsertLetter::V);
        let expected = [(entering, 102.5), (size, 9.525), (nose, 0.4)];
        assert!(expected.iter().all(|(a, b)| (a - b).abs() < 1e-6));
        for (rotation, tip) in [
            ("45 °", 3),
            ("135 °", 4),
            ("225 °", 1),
            ("315 °", 2),
            ("-45 °", 2),
            ("90 °", 8),
            ("180 °", 5),
            ("270 °", 6),
            ("0 °", 7),
            ("360 °", 7),
        ] {
            let values = ["80 °", "12.70 mm", "0.80 mm", rotation];
            let tool = parse("iso_shape_c", values).unwrap();
            assert_eq!(tool.tip, tip, "{rotation}");
            assert_eq!(tool.is_internal(), matches!(tip, 1 | 2 | 6), "{rotation}");
        }
    }

    #[test]
    fn a_bad_value_is_named_with_its_rule() {
        let good = ["80 °", "12.70 mm", "0.80 mm", "45 °"];
        for (shape, index, text, wanted) in [
            (
                "c",
                0,
                "81 °",
                "`TipAngle` is 81 °: must be 80° (C), 55° (D), 35° (V), 90° (S)",
            ),
            ("t", 0, "80 °", "`TipAngle` is 80 °: must be 60° (T)"),
            ("w", 0, "80 °", "shape W"),
            ("c", 0, "80 mm", "`TipAngle` is 80 mm: must be an angle"),
            (
                "c",
                1,
                "12.70 °",
                "`EdgeLength` is 12.70 °: must be a length",
            ),
            (
                "c",
                1,
                "1e999 mm",
                "`EdgeLength` is 1e999 mm: must be a length",
            ),
            (
                "c",
                1,
                "-3 mm",
                "`EdgeLength` is -3 mm: inscribed circle, mm: -3 is outside 2",
            ),
            (
                "c",
                2,
                "8 mm",
                "`TipRadius` is 8 mm: nose radius, mm: 8 is outside 0",
            ),
            ("c", 2, "NaN", "`TipRadius` is NaN: must be a length"),
            ("c", 3, "41 °", "`Rotation` is 41 °: entering angle"),
        ] {
            let mut values = good;
            values[index] = text;
            let error = parse(&format!("iso_shape_{shape}"), values).unwrap_err();
            assert!(error.contains(wanted), "{text}: {error}");
        }
        let (shape, mut bit) = bit("iso_shape_c", good);
        bit["parameter"]
            .as_object_mut()
            .unwrap()
            .remove("TipRadius");
        let missing = parse_insert(&shape, &bit).unwrap().unwrap_err();
        assert!(missing.text(Language::En).contains("`TipRadius`"));
        assert!(parse_insert("endmill", &bit).is_none());
    }
}
