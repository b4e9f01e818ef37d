//! Programs of the usual shapes, of any length.

use std::fmt::Write as _;

/// A reproducible source of numbers (xorshift).
struct Random(u32);

impl Random {
    const fn number_between(&mut self, least: i32, most: i32) -> i32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        least + (self.0 % (most - least + 1) as u32) as i32
    }
}

/// A program text with the position of the tool in thousandths of a millimetre, X as a
/// diameter.
struct Writer {
    text: String,
    x: i32,
    z: i32,
}

/// Formats thousandths of a millimetre as the number of a word.
fn mm(thousandths: i32) -> String {
    let sign = if thousandths < 0 { "-" } else { "" };
    let size = thousandths.unsigned_abs();
    format!("{sign}{}.{:03}", size / 1000, size % 1000)
}

impl Writer {
    /// A program at the start of its contour, ready to cut.
    fn new(head: &str, x: i32, z: i32) -> Self {
        let text = format!(
            "O0001;\nG98 G97 G40;\n{head}M03 S600;\nG00 X{} Z{};\nG01 F200;\n",
            mm(x),
            mm(z)
        );
        Self { text, x, z }
    }

    fn line(&mut self, words: &str) {
        self.text.push_str(words);
        self.text.push_str(";\n");
    }

    /// Adds a block with a relative move, in thousandths of a millimetre.
    fn cut(&mut self, code: &str, x: i32, z: i32, tail: &str) {
        self.x += x;
        self.z += z;
        let (x, z) = (mm(self.x), mm(self.z));
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "{code}X{x} Z{z}{tail};");
    }

    fn end(mut self) -> String {
        self.line("G00 X150. Z50.");
        self.line("M05");
        self.line("M30");
        self.text
    }
}

/// All shapes with their names.
pub fn all_shapes() -> [(&'static str, String); 6] {
    let [lines, arcs, calls, contour] = long_shapes(100_000);
    [
        lines,
        arcs,
        calls,
        ("G71 roughing", roughing(90)),
        contour,
        ("macro loop", macro_loop(8000)),
    ]
}

/// The shapes of any length, with this number of moves.
pub fn long_shapes(moves: u32) -> [(&'static str, String); 4] {
    [
        ("short lines", short_lines(moves)),
        ("mixed arcs", mixed_arcs(moves)),
        ("subprogram calls", subprogram_calls(moves / 20)),
        ("compensated contour", compensated_contour(moves)),
    ]
}

/// A rippled cylinder of lines of some hundredths of a millimetre, back and forth.
pub fn short_lines(blocks: u32) -> String {
    let mut random = Random(980);
    let mut writer = Writer::new("", 40_000, 0);
    let mut back = 1;
    for _ in 0..blocks {
        if !(-290_000..=0).contains(&(writer.z - back * 60)) {
            back = -back;
        }
        let outward = if writer.x < 40_000 { 2 } else { -2 };
        let (x, z) = (random.number_between(1, 20), random.number_between(20, 60));
        writer.cut("", outward * x, -back * z, "");
    }
    writer.end()
}

/// Steps of a line, a quarter arc with I and K and a quarter arc with R, back and forth.
fn mixed_arcs(blocks: u32) -> String {
    let mut random = Random(981);
    let mut writer = Writer::new("", 60_000, -1000);
    let mut along = -1;
    for _ in 0..blocks / 3 {
        if writer.z < -280_000 {
            along = 1;
        } else if writer.z > -10_000 {
            along = -1;
        }
        let outward = if writer.x < 60_000 { 1 } else { -1 };
        let radius = random.number_between(1, 9) * 100;
        writer.cut("G01 ", outward * 2 * radius, along * 700, "");
        // About a centre beside the tool in Z, then about one beside it in X.
        let turn = if outward == along { "G02 " } else { "G03 " };
        let center = format!(" I0. K{}", mm(along * radius));
        writer.cut(turn, outward * 2 * radius, along * radius, &center);
        let rounded = format!(" R{}", mm(radius));
        writer.cut(turn, -outward * 2 * radius, along * radius, &rounded);
    }
    writer.end()
}

/// Calls of a subprogram of eight moves that calls another.
fn subprogram_calls(calls: u32) -> String {
    let mut writer = Writer::new("", 50_000, 0);
    for _ in 0..calls {
        writer.line("M98 P0002");
    }
    let mut text = writer.end();
    text.push_str("O0002;\nG01 U-1.;\nW-1.5;\nU0.5 W-0.5;\nU0.5 W0.5;\n");
    text.push_str("U1.;\nW1.;\nU-0.5 W0.25;\nU-0.5 W0.25;\nM98 P0003;\nM99;\n");
    text.push_str("O0003;\nG01 U0.2;\nG01 U-0.2;\nM99;\n");
    text
}

/// A profile of lines and arcs that rises, roughed in cuts of 0.005 mm.
fn roughing(elements: u32) -> String {
    let mut writer = Writer::new("", 102_000, 2000);
    writer.line("G71 U0.005 R0.5");
    writer.line("G71 P10 Q20 U0. W0. F150");
    writer.line("N10 G00 X10.");
    writer.line("G01 Z0. F100");
    (writer.x, writer.z) = (10_000, 0);
    for element in 0..elements {
        match element % 4 {
            0 => writer.cut("G01 ", 1000, -700, ""),
            1 => writer.cut("G03 ", 1000, -500, " R0.5"),
            2 => writer.cut("G01 ", 0, -900, ""),
            _ => writer.cut("G02 ", 1000, -500, " R0.5"),
        }
    }
    writer.cut("N20 G01 ", 1000, -500, "");
    writer.line("G70 P10 Q20");
    writer.end()
}

/// A long shaft under G42: slopes, and sometimes a bump of an arc.
fn compensated_contour(blocks: u32) -> String {
    let mut random = Random(982);
    let mut writer = Writer::new("T0101;\n", 60_000, 5000);
    // Passes of 200 blocks from right to left, each with a separate approach.
    for _ in 0..blocks / 200 {
        writer.line("G42 G00 X40. Z2.");
        writer.line("G01 Z1. F200");
        (writer.x, writer.z) = (40_000, 1000);
        for block in 0..194 {
            if block % 10 == 9 {
                writer.cut("G03 ", 0, -1000, " R1.");
                writer.line("G01");
            } else {
                let x = 40_000 + 2 * random.number_between(-60, 60) - writer.x;
                writer.cut("", x, -1000, "");
            }
        }
        writer.line("X50.");
        writer.line("G40 G00 X60. Z-200.");
        writer.line("Z5.");
    }
    writer.end()
}

/// A loop of ten operations and two jumps.
fn macro_loop(turns: u32) -> String {
    let mut writer = Writer::new("", 50_000, 0);
    for variable in 201..=210 {
        writer.line(&format!("G65 H01 P#{variable} Q0"));
    }
    for operation in [
        "N100 G65 H02 P#202 Q#202 R7",
        "G65 H86 P110 Q#202 R90000",
        "G65 H03 P#202 Q#202 R90000",
        "N110 G65 H04 P#203 Q#202 R3",
        "G65 H05 P#204 Q#203 R11",
        "G65 H03 P#205 Q#204 R#202",
        "G65 H22 P#206 Q#205",
        "G65 H23 P#207 Q#206 R97",
        "G65 H02 P#208 Q#208 R#207",
        "G65 H03 P#209 Q#208 R#207",
        "G65 H05 P#210 Q#209 R3",
        "G65 H02 P#201 Q#201 R1",
    ] {
        writer.line(operation);
    }
    writer.line(&format!("G65 H84 P100 Q#201 R{turns}"));
    writer.end()
}
