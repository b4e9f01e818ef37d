//! The path of a mill: seen from above (XY), from the front (XZ), from the right (YZ), and
//! as an isometric view.
//!
//! ```text
//!   title                 time
//!   tools
//!   +--------+ +-----------+
//!   |   XY   | | isometric |
//!   +--------+ +-----------+
//!   |   XZ   | |    YZ     |
//!   +--------+ +-----------+
//! ```

use gsk_messages::{Language, say};
use gsk_milling::{Further, Move, MoveKind};

use super::canvas::{Align, Canvas};
use super::clip::clipped;
use super::drawing::Look;
use super::extent::Size;
use super::legend::{EDGE, GAP, SAMPLE, width};
use super::numbers::Area;
use super::pens::Pen;
use super::pieces::Made;
use super::{Format, PictureError, png_file, svg};
use crate::mill::Times;
use crate::words::clock;

/// Points that a drawing holds.
const MOST: usize = 3_000_000;
/// An arc is drawn in chords of so many radians.
const CHORD: f64 = 0.06;
/// Units above the views, of a row of the legend, and between views.
const TOP: f64 = 44.0;
const ROW: f64 = 22.0;
const BETWEEN: f64 = 30.0;
/// From the edge of a picture to a view: its figures stand there.
const SIDE: f64 = 60.0;
const BELOW: f64 = 36.0;
/// Chords up to which a path is drawn with smooth edges.
const MOST_SMOOTH: usize = 30_000;

/// Lines of a view.
const FRAME: Pen = Pen {
    color: [0xB0; 3],
    width: 1.0,
    dash: &[],
};

/// A line that is made one way.
#[derive(Clone, Debug)]
struct Stroke {
    made: Made,
    points: Vec<[f64; 3]>,
}

/// A box around points.
#[derive(Clone, Copy, Debug)]
struct Cube {
    low: [f64; 3],
    high: [f64; 3],
}

impl Cube {
    fn reach(cube: &mut Option<Self>, point: [f64; 3]) {
        let cube = cube.get_or_insert(Self {
            low: point,
            high: point,
        });
        for (axis, value) in point.into_iter().enumerate() {
            cube.low[axis] = cube.low[axis].min(value);
            cube.high[axis] = cube.high[axis].max(value);
        }
    }

    fn corners(&self) -> [[f64; 3]; 8] {
        core::array::from_fn(|corner| {
            core::array::from_fn(|axis| match corner >> axis & 1 {
                0 => self.low[axis],
                _ => self.high[axis],
            })
        })
    }
}

/// The path, in the coordinates of the first work zero.
#[derive(Clone, Debug)]
pub struct MillDrawing {
    title: String,
    look: Look,
    strokes: Vec<Stroke>,
    tools: Vec<u16>,
    zero: Option<[f64; 3]>,
    cuts: Option<Cube>,
    all: Option<Cube>,
    times: Times,
    /// What further axes reach that have moved: mm, or degrees.
    further: Vec<(Further, f64, f64)>,
    count: usize,
    left_out: u64,
}

impl MillDrawing {
    /// A drawing without a path yet.
    pub fn new(title: impl Into<String>, look: Look) -> Self {
        Self {
            title: title.into(),
            look,
            strokes: Vec::new(),
            tools: Vec::new(),
            zero: None,
            cuts: None,
            all: None,
            times: Times::default(),
            further: Vec::new(),
            count: 0,
            left_out: 0,
        }
    }

    /// Adds a move.
    pub fn push(&mut self, made: &Move) {
        self.times.push(made);
        if made.kind == MoveKind::Dwell {
            return;
        }
        self.turn(made);
        // What only turns draws nothing.
        if made.arc.is_none() && made.from.mm() == made.to.mm() {
            return;
        }
        if self.count >= MOST {
            self.left_out += 1;
            return;
        }
        let zero = made.zero.mm();
        let first = *self.zero.get_or_insert(zero);
        let place =
            |point: [f64; 3]| core::array::from_fn(|axis| point[axis] + zero[axis] - first[axis]);
        let way = match made.kind {
            MoveKind::Rapid => Made::Rapid,
            _ => Made::Cut(self.index_of(made.tool)),
        };
        let begin: [f64; 3] = place(made.from.mm());
        let points: Vec<[f64; 3]> = corners(made).into_iter().map(place).collect();
        self.count += points.len();
        for point in core::iter::once(&begin).chain(&points) {
            Cube::reach(&mut self.all, *point);
            if way != Made::Rapid {
                Cube::reach(&mut self.cuts, *point);
            }
        }
        match self.strokes.last_mut() {
            Some(last) if last.made == way && last.points.last() == Some(&begin) => {
                last.points.extend(points);
            }
            _ => {
                let points = core::iter::once(begin).chain(points).collect();
                self.strokes.push(Stroke { made: way, points });
            }
        }
    }

    /// Takes what further axes do; of one that has never moved nothing is said.
    fn turn(&mut self, made: &Move) {
        for (further, from, to) in made.further() {
            let (least, greatest) = (from.min(to), from.max(to));
            let mut known = self.further.iter_mut();
            match known.find(|(known, ..)| *known == further) {
                Some((_, low, high)) => {
                    *low = low.min(least);
                    *high = high.max(greatest);
                }
                None if from == to => {}
                None => self.further.push((further, least, greatest)),
            }
        }
    }

    /// Moves that found no room any more.
    pub const fn left_out(&self) -> u64 {
        self.left_out
    }

    fn index_of(&mut self, tool: u16) -> u8 {
        let known = self.tools.iter().position(|known| *known == tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push(tool);
            self.tools.len() - 1
        });
        u8::try_from(index).unwrap_or(u8::MAX)
    }

    /// Around what is shown.
    fn reach(&self) -> Cube {
        let shown = match self.look.whole {
            true => self.all,
            false => self.cuts.or(self.all),
        };
        shown.unwrap_or(Cube {
            low: [-50.0; 3],
            high: [50.0; 3],
        })
    }

    /// The same with some room.
    fn cube(&self) -> Cube {
        let mut cube = self.reach();
        for axis in 0..3 {
            let room = ((cube.high[axis] - cube.low[axis]) * 0.05).max(0.5);
            cube.low[axis] -= room;
            cube.high[axis] += room;
        }
        cube
    }
}

/// Points of a move after its begin: chords of an arc; the places where axes of a rapid
/// that go by themselves arrive.
fn corners(made: &Move) -> Vec<[f64; 3]> {
    if let Some(mut parts) = made.arrivals {
        parts.sort_by(f64::total_cmp);
        let parts = parts.into_iter().filter(|part| *part > 0.0 && *part < 1.0);
        return parts.chain([1.0]).map(|part| made.at(part)).collect();
    }
    let chords = made
        .sweep()
        .map_or(1, |sweep| (sweep / CHORD).ceil().max(1.0) as u32);
    let at = |chord: u32| made.at(f64::from(chord) / f64::from(chords));
    (1..=chords).map(at).collect()
}

/// A direction from which the path is seen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum View {
    Xy,
    Xz,
    Yz,
    Isometric,
}

impl View {
    const ALL: [Self; 4] = [Self::Xy, Self::Isometric, Self::Xz, Self::Yz];

    /// Where a point lies, mm: to the right, up.
    fn see(self, [x, y, z]: [f64; 3]) -> (f64, f64) {
        // Half of the root of three.
        const COS_30: f64 = 0.866_025_403_784_438_6;
        match self {
            Self::Xy => (x, y),
            Self::Xz => (x, z),
            Self::Yz => (y, z),
            Self::Isometric => ((x - y) * COS_30, (x + y) * 0.5 + z),
        }
    }

    fn name(self, language: Language) -> String {
        match self {
            Self::Xy => "XY".to_owned(),
            Self::Xz => "XZ".to_owned(),
            Self::Yz => "YZ".to_owned(),
            Self::Isometric => say::picture_mill_isometric().text(language),
        }
    }

    /// What lies to the right and up.
    const fn axes(self) -> Option<[usize; 2]> {
        match self {
            Self::Xy => Some([0, 1]),
            Self::Xz => Some([0, 2]),
            Self::Yz => Some([1, 2]),
            Self::Isometric => None,
        }
    }
}

/// What a picture is made of, units.
#[derive(Clone, Debug)]
enum Part {
    Line(Pen, Vec<(f64, f64)>),
    Text {
        at: (f64, f64),
        words: String,
        align: Place,
    },
}

/// Where a text stands about its point.
#[derive(Clone, Copy, Debug)]
enum Place {
    Left,
    Center,
    Right,
}

/// A view in its frame.
struct Pane {
    view: View,
    frame: Area,
    /// mm at the left and at the bottom of the frame, and units of a mm.
    left: f64,
    bottom: f64,
    scale: f64,
}

impl Pane {
    fn place(&self, point: [f64; 3]) -> (f64, f64) {
        let (right, up) = self.view.see(point);
        let x = self.frame.0 + (right - self.left) * self.scale;
        (x, self.frame.3 - (up - self.bottom) * self.scale)
    }
}

/// How far a view reaches, mm: least and greatest to the right and up.
fn reach(view: View, cube: &Cube) -> [f64; 4] {
    let seen = cube.corners().map(|corner| view.see(corner));
    seen.iter().fold(
        [f64::MAX, f64::MIN, f64::MAX, f64::MIN],
        |[a, b, c, d], (right, up)| [a.min(*right), b.max(*right), c.min(*up), d.max(*up)],
    )
}

/// The four views: those along an axis at one scale, fitted into four equal fields.
fn panes(cube: &Cube, (wide, tall): (f64, f64), top: f64) -> [Pane; 4] {
    let room = (
        (wide - 2.0 * SIDE - BETWEEN - EDGE).max(80.0) / 2.0,
        (tall - top - 2.0 * BELOW - BETWEEN).max(80.0) / 2.0,
    );
    let fits = |view: View| {
        let [left, right, bottom, up] = reach(view, cube);
        (room.0 / (right - left)).min(room.1 / (up - bottom))
    };
    let flat = View::ALL
        .into_iter()
        .filter(|view| *view != View::Isometric);
    let flat = flat.map(fits).fold(f64::MAX, f64::min);
    core::array::from_fn(|index| {
        let view = View::ALL[index];
        let (column, row) = (index % 2, index / 2);
        let left = SIDE + column as f64 * (room.0 + SIDE);
        let upper = top + row as f64 * (room.1 + BELOW);
        let frame = (left, upper, left + room.0, upper + room.1);
        let scale = if view == View::Isometric {
            fits(view)
        } else {
            flat
        };
        let [least, most, bottom, up] = reach(view, cube);
        Pane {
            view,
            frame,
            left: (least + most - room.0 / scale) / 2.0,
            bottom: (bottom + up - room.1 / scale) / 2.0,
            scale,
        }
    })
}

/// The whole picture.
fn parts(drawing: &MillDrawing, language: Language) -> Vec<Part> {
    let (wide, tall) = drawing.look.size.units();
    let cube = drawing.cube();
    let (mut parts, top) = head(drawing, wide, language);
    for pane in panes(&cube, (wide, tall), top) {
        let (left, upper, right, lower) = pane.frame;
        let frame = [
            (left, upper),
            (right, upper),
            (right, lower),
            (left, lower),
            (left, upper),
        ];
        parts.push(Part::Line(FRAME, frame.to_vec()));
        parts.push(Part::Text {
            at: (left + 8.0, upper + 18.0),
            words: pane.view.name(language),
            align: Place::Left,
        });
        figures(&pane, &drawing.reach(), &mut parts);
        for rapid in [true, false] {
            let strokes = drawing.strokes.iter();
            for stroke in strokes.filter(|it| (it.made == Made::Rapid) == rapid) {
                let points = stroke.points.iter().map(|point| pane.place(*point));
                clipped(points, pane.frame, |part| {
                    parts.push(Part::Line(Pen::of(stroke.made), part.to_vec()));
                });
            }
        }
    }
    parts
}

/// Title, time and a line for each tool; the height that they take.
fn head(drawing: &MillDrawing, wide: f64, language: Language) -> (Vec<Part>, f64) {
    let times = &drawing.times;
    let whole = times.all.rapid + times.all.feed + times.all.thread + times.all.dwell;
    let cutting = times.all.feed + times.all.thread;
    let summary = say::picture_time(clock(whole), clock(cutting)).text(language);
    let mut parts = vec![
        Part::Text {
            at: (EDGE, 24.0),
            words: drawing.title.clone(),
            align: Place::Left,
        },
        Part::Text {
            at: (wide - EDGE, 24.0),
            words: summary,
            align: Place::Right,
        },
    ];
    let (mut x, mut y) = (EDGE, TOP);
    for (tool, seconds) in times.cutting() {
        let Some(index) = drawing.tools.iter().position(|known| *known == tool) else {
            continue;
        };
        let words = say::picture_mill_tool(tool, clock(seconds)).text(language);
        let entry = SAMPLE + GAP + width(&words) + BETWEEN;
        if x + entry > wide - EDGE && x > EDGE {
            (x, y) = (EDGE, y + ROW);
        }
        let made = Made::Cut(u8::try_from(index).unwrap_or(u8::MAX));
        parts.push(Part::Line(Pen::of(made), vec![(x, y), (x + SAMPLE, y)]));
        parts.push(Part::Text {
            at: (x + SAMPLE + GAP, y + 5.0),
            words,
            align: Place::Left,
        });
        x += entry;
    }
    // The path is that of X, Y and Z: what turns is told.
    for (further, least, greatest) in &drawing.further {
        let unit = if further.rotary { "°" } else { " mm" };
        let (least, greatest) = (figure(*least), figure(*greatest));
        let words = format!("{} {least} … {greatest}{unit}", further.letter);
        let entry = width(&words) + BETWEEN;
        if x + entry > wide - EDGE && x > EDGE {
            (x, y) = (EDGE, y + ROW);
        }
        parts.push(Part::Text {
            at: (x, y + 5.0),
            words,
            align: Place::Left,
        });
        x += entry;
    }
    (parts, y + ROW)
}

/// The ends of the path along the axes of a view, mm.
fn figures(pane: &Pane, cube: &Cube, parts: &mut Vec<Part>) {
    let Some([right, up]) = pane.view.axes() else {
        return;
    };
    let (left, upper, _, lower) = pane.frame;
    for (axis, level) in [(right, cube.low[right]), (right, cube.high[right])] {
        let mut point = cube.low;
        point[axis] = level;
        let (x, _) = pane.place(point);
        parts.push(Part::Text {
            at: (x, lower + 16.0),
            words: figure(level),
            align: Place::Center,
        });
    }
    for level in [cube.low[up], cube.high[up]] {
        let mut point = cube.low;
        point[up] = level;
        let (_, y) = pane.place(point);
        parts.push(Part::Text {
            at: (left - 6.0, y.clamp(upper + 10.0, lower) + 4.0),
            words: figure(level),
            align: Place::Right,
        });
    }
}

fn figure(value: f64) -> String {
    let rounded = (value * 10.0).round() / 10.0;
    if rounded == 0.0 {
        "0".to_owned()
    } else {
        rounded.to_string()
    }
}

/// The bytes of a picture file.
///
/// # Errors
/// There is no memory for it.
pub fn encode(
    format: Format,
    drawing: &MillDrawing,
    language: Language,
) -> Result<Vec<u8>, PictureError> {
    let parts = parts(drawing, language);
    match format {
        Format::Svg => Ok(to_svg(&parts, drawing.look.size).into_bytes()),
        Format::Png => {
            let mut canvas = Canvas::new(drawing.look.size)?;
            canvas.set_smooth(drawing.count <= MOST_SMOOTH);
            for part in &parts {
                match part {
                    Part::Line(pen, points) => canvas.polyline(*pen, points),
                    Part::Text { at, words, align } => {
                        let align = match align {
                            Place::Left => Align::Left,
                            Place::Center => Align::Center,
                            Place::Right => Align::Right,
                        };
                        canvas.text(at.0, at.1 - 13.0, words, align);
                    }
                }
            }
            png_file::encode(&canvas.into_pixels())
        }
    }
}

fn to_svg(parts: &[Part], size: Size) -> String {
    let mut out = svg::open(size);
    for part in parts {
        match part {
            Part::Line(pen, points) => svg::polyline(&mut out, *pen, points),
            Part::Text { at, words, align } => {
                let anchor = match align {
                    Place::Left => "start",
                    Place::Center => "middle",
                    Place::Right => "end",
                };
                svg::text(&mut out, *at, words, anchor);
            }
        }
    }
    out.push_str("</svg>\n");
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::program::{Program, ProgramMemory};

    fn drawing(text: &str) -> MillDrawing {
        let mut programs = ProgramMemory::default();
        programs.open_external(Program::new(text));
        programs.select(gsk_core::command::ProgramId::External);
        let mut drawing = MillDrawing::new("O0001 <铣>", Look::default());
        let setup = gsk_milling::MillSetup::default();
        let end = gsk_milling::preview_while(
            &setup,
            &programs,
            &mut |made| drawing.push(made),
            &mut |_| true,
        );
        assert_eq!(end.alarm, None);
        drawing
    }

    #[test]
    fn four_views_in_both_kinds_of_picture() {
        let drawing =
            drawing("T1\nG00 X0 Y0 Z5\nG01 Z-2 F100\nX40\nG02 Y20 R10\nG01 X0\nT2\nX-10\nM30\n");
        for (language, name) in [(Language::En, "isometric"), (Language::Zh, "等轴测图")] {
            let svg = encode(Format::Svg, &drawing, language).expect("picture");
            let svg = String::from_utf8(svg).expect("text");
            for part in [
                "<svg",
                ">XY<",
                ">XZ<",
                ">YZ<",
                name,
                "&lt;铣&gt;",
                "T1 ",
                "T2 ",
            ] {
                assert!(svg.contains(part), "{part}: {svg}");
            }
            // A frame for each view; a line for each tool in each view and in the legend,
            // and the rapids.
            assert!(svg.matches("<polyline").count() >= 4 + 4 * 2 + 2 + 4);
        }
        let png = encode(Format::Png, &drawing, Language::En).expect("picture");
        assert!(png.starts_with(b"\x89PNG"));
        let empty = MillDrawing::new("", Look::default());
        assert!(encode(Format::Svg, &empty, Language::En).is_ok());
    }

    #[test]
    fn what_turns_is_told_and_an_axis_of_a_rapid_arrives_by_itself() {
        let mut programs = ProgramMemory::default();
        programs.open_external(Program::new("G00 X80 Y20 A-30\nG01 A330 F3600\nM30\n"));
        programs.select(gsk_core::command::ProgramId::External);
        let drawn = |parameters: &[(u16, i32)]| {
            let mut setup = gsk_milling::MillSetup::default();
            for (number, value) in parameters {
                assert_eq!(setup.memory.model.set_parameter(*number, *value), Ok(()));
            }
            let mut drawing = MillDrawing::new("", Look::default());
            let mut take = |made: &Move| drawing.push(made);
            gsk_milling::preview_while(&setup, &programs, &mut take, &mut |_| true);
            drawing
        };
        let drawing = drawn(&[(1010, 4)]);
        let points = &drawing.strokes[0].points;
        // 0.25 s to 20 mm, 0.7 s to 80 mm at 8000 mm/min with 100 ms.
        assert_eq!((drawing.strokes.len(), points.len()), (1, 3));
        let corner = points[1];
        assert!(
            (corner[0] - 80.0 * 0.25 / 0.7).abs() < 1e-6 && corner[1] == 20.0,
            "{corner:?}"
        );
        let svg = encode(Format::Svg, &drawing, Language::En).expect("picture");
        assert!(String::from_utf8_lossy(&svg).contains("A -30 … 330°"));
        assert_eq!(drawn(&[(1010, 4), (12, 128)]).strokes[0].points.len(), 2);
    }

    #[test]
    fn views_along_an_axis_have_one_scale() {
        let drawing = drawing("G00 X0 Y0 Z0\nG01 X100 F100\nY10\nZ-5\nM30\n");
        let panes = panes(&drawing.cube(), (1280.0, 800.0), 60.0);
        assert_eq!(panes[0].scale, panes[2].scale);
        assert_eq!(panes[0].scale, panes[3].scale);
        // X lies to the right, Y up, in the frame.
        let (from, to) = (panes[0].place([0.0; 3]), panes[0].place([100.0, 10.0, 0.0]));
        assert!(to.0 > from.0 && to.1 < from.1);
        let (left, upper, right, lower) = panes[0].frame;
        assert!((left..right).contains(&to.0) && (upper..lower).contains(&to.1));
    }
}
