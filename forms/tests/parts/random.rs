//! Random values of forms from a seed.

use core::fmt::Display;

use gsk_forms::{FormValues, thread_rows};

/// A linear congruential generator; the same seed gives the same numbers.
pub struct Random(u64);

impl Random {
    pub const fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    fn next(&mut self) -> u64 {
        let Self(state) = self;
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        *state >> 33
    }

    pub fn index(&mut self, count: usize) -> usize {
        (self.next() % count as u64) as usize
    }

    pub fn is_lucky(&mut self) -> bool {
        self.index(2) == 0
    }

    /// A number with three places.
    pub fn between(&mut self, least: f64, most: f64) -> f64 {
        let thousandths = ((most - least) * 1000.0).max(0.0) as usize;
        ((least * 1000.0).round() + self.index(thousandths + 1) as f64) / 1000.0
    }

    fn pick<'a>(&mut self, words: &[&'a str]) -> &'a str {
        words[self.index(words.len())]
    }
}

fn set(values: &mut FormValues, id: &str, value: impl Display) {
    values.set_text(id, &value.to_string()).unwrap();
}

fn set_number(values: &mut FormValues, id: &str, value: f64) -> f64 {
    let text = format!("{value:.3}");
    set(values, id, &text);
    text.parse().unwrap()
}

/// Tool, spindle, feed and coolant.
pub fn fill_in_machine(random: &mut Random, values: &mut FormValues) {
    set(values, "TOOL", 1 + random.index(4));
    set(values, "COOL", random.pick(&["ON", "OFF"]));
    set(values, "DIR", random.pick(&["FWD", "REV"]));
    if values.field("SPIN").is_ok() {
        set(values, "SPIN", random.pick(&["RPM", "CSS"]));
    }
    if values.field("FEED").is_ok() {
        set(values, "FEED", random.pick(&["TURN", "MIN"]));
    }
}

pub fn face(random: &mut Random, values: &mut FormValues) {
    let stock = random.between(12.0, 120.0);
    set_number(values, "STOCK", stock);
    if random.is_lucky() {
        set_number(values, "BORE", random.between(4.0, stock - 6.0));
    }
    set_number(values, "ALLOW", random.between(0.2, 6.0));
    set_number(values, "DEPTH", random.between(0.3, 2.0));
    set_number(values, "FIN", random.between(0.0, 0.4));
    set(
        values,
        "NOSE",
        random.pick(&["0", "0.2", "0.4", "0.8", "1.2"]),
    );
}

/// Allowances and the insert of a profile.
fn profile(random: &mut Random, values: &mut FormValues) -> f64 {
    set_number(values, "DEPTH", random.between(0.4, 2.5));
    set_number(values, "FINX", random.between(0.0, 0.8));
    set_number(values, "FINZ", random.between(0.0, 0.3));
    let nose = random.pick(&["0", "0.2", "0.4", "0.8"]);
    set(values, "NOSE", nose);
    set(values, "N", 10 * (1 + random.index(900)));
    nose.parse().unwrap()
}

/// Length, edge and shoulder of a cylinder or taper. `step` is the height of the shoulder.
fn cylinder(random: &mut Random, values: &mut FormValues, step: f64, narrowest: f64) {
    let nose = profile(random, values);
    let length = set_number(values, "L", random.between(5.0, 60.0));
    let edge = random.pick(&["SHARP", "CHAMFER", "RADIUS"]);
    set(values, "EDGE", edge);
    if edge != "SHARP" {
        set_number(
            values,
            "C",
            random.between(0.2, (narrowest / 5.0).min(length / 4.0).min(4.0)),
        );
    }
    if random.is_lucky() && step - 1.0 > nose {
        set_number(
            values,
            "R",
            random.between(nose.max(0.1), (step - 0.9).min(length / 3.0)),
        );
    }
}

pub fn turn(random: &mut Random, values: &mut FormValues) {
    let diameter = set_number(values, "D", random.between(10.0, 80.0));
    let step = random.between(0.5, 12.0);
    set_number(values, "STOCK", diameter + 2.0 * step);
    let front = match random.is_lucky() {
        true => set_number(values, "DF", random.between(diameter * 0.6, diameter)),
        false => diameter,
    };
    cylinder(random, values, step, front);
}

pub fn bore(random: &mut Random, values: &mut FormValues) {
    let hole = set_number(values, "HOLE", random.between(14.0, 50.0));
    let step = random.between(0.5, 8.0);
    let diameter = set_number(values, "D", hole + 2.0 * step);
    if random.is_lucky() {
        set_number(values, "DF", random.between(diameter, diameter * 1.2));
    }
    cylinder(random, values, step, hole);
}

pub fn contour(random: &mut Random, values: &mut FormValues) {
    let nose = profile(random, values);
    let inside = random.is_lucky();
    let sign = if inside { -1.0 } else { 1.0 };
    let mut x = if inside {
        random.between(60.0, 90.0)
    } else {
        random.between(10.0, 20.0)
    };
    let round = |value: f64| (value * 1000.0).round() / 1000.0;
    let corner = |random: &mut Random| match random.index(4) {
        0 | 1 => String::new(),
        2 => format!("R{:.3}", random.between(nose.max(0.5), 1.9)),
        _ => format!("C{:.3}", random.between(0.3, 1.5)),
    };
    let mut z = 0.0;
    let edge = corner(random);
    let mut text = format!("X{x:.3}Z0{edge}");
    for _ in 0..2 + random.index(4) {
        let kind = random.index(4);
        let (along, across) = (random.between(5.0, 15.0), random.between(5.0, 8.0));
        let end = corner(random);
        match kind {
            0 => {
                z = round(z - along);
                text.push_str(&format!("/Z{z:.3}{end}"));
            }
            1 => {
                z = round(z - along);
                x = round(x + sign * across);
                text.push_str(&format!("/X{x:.3}L{along:.3}{end}"));
            }
            2 => {
                x = round(x + sign * across);
                let angle = random.between(20.0, 70.0);
                text.push_str(&format!("/X{x:.3}A{angle:.3}{end}"));
                z -= across / 2.0 / angle.to_radians().tan();
            }
            _ => {
                text.push_str(&format!("/X{x:.3}L{along:.3}{end}"));
                z = round(z - along);
            }
        }
    }
    // The end: a sharp corner, so that the outline is as long as its points.
    text.push_str(&format!("/L{:.3}", random.between(5.0, 9.0)));
    set(values, "POINTS", text);
    set(values, "SIDE", if inside { "IN" } else { "OUT" });
    match inside {
        true => set_number(values, "HOLE", x - 3.0),
        false => set_number(values, "STOCK", x + 3.0),
    };
}

pub fn groove(random: &mut Random, values: &mut FormValues) {
    let inside = random.is_lucky();
    set(values, "SIDE", if inside { "IN" } else { "OUT" });
    let blade = set_number(values, "TW", random.between(1.0, 5.0));
    let width = match random.index(3) {
        0 => blade,
        _ => blade + random.between(0.05, 12.0),
    };
    let width = set_number(values, "W", width);
    set_number(values, "POS", random.between(0.5, 30.0));
    let diameter = set_number(values, "D", random.between(24.0, 80.0));
    let depth = random.between(0.5, if inside { 5.0 } else { 9.0 });
    set_number(
        values,
        "DB",
        if inside {
            diameter + 2.0 * depth
        } else {
            diameter - 2.0 * depth
        },
    );
    if random.is_lucky() {
        set(values, "COUNT", 1 + random.index(4));
        set_number(values, "STEP", width + random.between(0.5, 6.0));
    }
    set_number(values, "PECK", random.between(0.5, 4.0));
}

pub fn part_off(random: &mut Random, values: &mut FormValues) {
    let diameter = set_number(values, "D", random.between(8.0, 60.0));
    set_number(values, "TW", random.between(2.0, 5.0));
    set_number(values, "L", random.between(3.0, 50.0));
    set_number(values, "PECK", random.between(0.5, 4.0));
    if random.is_lucky() {
        set_number(values, "BORE", random.between(3.0, diameter - 3.0));
    }
}

pub fn thread(random: &mut Random, values: &mut FormValues) {
    let inside = random.is_lucky();
    set(values, "SIDE", if inside { "IN" } else { "OUT" });
    let rows: Vec<_> = thread_rows().collect();
    let least = if inside { 14.0 } else { 3.0 };
    let mut row = rows[random.index(rows.len())];
    while row.diameter_mm < least {
        row = rows[random.index(rows.len())];
    }
    set(values, "THREAD", row.designation);
    set(values, "HAND", random.pick(&["RIGHT", "LEFT"]));
    let starts = match row.profile(inside).taper {
        0.0 => 1 + random.index(3),
        _ => 1,
    };
    set(values, "STARTS", starts);
    let pitch = row.pitch.mm();
    let fastest = (5_000.0 / pitch / starts as f64) as usize;
    set(values, "S", 50 + random.index(300.min(fastest - 50)));
    set_number(values, "L", random.between(12.0 * pitch, 20.0 * pitch));
    set(values, "RUNOUT", random.pick(&["0", "0.5", "1"]));
    let depth = row.profile(inside).depth();
    set_number(values, "FIRST", random.between(0.1, (depth / 2.0).max(0.1)));
    set_number(values, "LAST", random.between(0.0, 0.05));
}

pub fn drill(random: &mut Random, values: &mut FormValues) {
    set_number(values, "D", random.between(2.0, 30.0));
    set_number(values, "L", random.between(2.0, 80.0));
    set(values, "POINT", random.pick(&["118", "135", "140", "180"]));
    set_number(values, "PECK", random.between(1.0, 10.0));
}

pub fn center(random: &mut Random, values: &mut FormValues) {
    set_number(values, "D", random.between(1.0, 16.0));
    set(values, "POINT", random.pick(&["60", "90", "120"]));
    set_number(values, "DWELL", random.between(0.0, 1.0));
}
