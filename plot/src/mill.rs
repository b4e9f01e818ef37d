//! The path of a mill: from above (XY), from the front (XZ), from the right (YZ), and in an
//! isometric view. A view across a hole shows it as a circle with a cross.
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

mod holes;
mod items;
mod views;

use gsk_messages::Language;
use gsk_milling::{FurtherAxis, MillMove, MillMoveKind};

use crate::canvas::{PictureCanvas, TextAlign};
use crate::drawing::DrawingOptions;
use crate::extent::PictureSize;
use crate::path_pieces::PathLine;
use crate::{PictureError, PictureFormat, png_file, svg};
use gsk_runner::mill::MillTimes;
use holes::HoleFinder;
use items::{PictureItem, TextAnchor};

/// Maximum number of points that a drawing stores.
const MAX_POINTS: usize = 3_000_000;
/// Angle that each chord of an arc spans, radians.
const CHORD_ANGLE_RAD: f64 = 0.06;
/// Maximum number of points of a path that is drawn with smooth edges.
const MAX_SMOOTH_CHORDS: usize = 30_000;

/// Successive lines of the same kind through these points, mm.
#[derive(Clone, Debug)]
struct MillStroke {
    line_kind: PathLine,
    points: Vec<[f64; 3]>,
}

/// The box that contains all points added: least and greatest X, Y, Z, mm.
#[derive(Clone, Copy, Debug)]
struct PathBox {
    low: [f64; 3],
    high: [f64; 3],
}

impl PathBox {
    fn widen(cube: &mut Option<Self>, point: [f64; 3]) {
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

/// The drawing of a mill program's path, built move by move, in the coordinates of the first
/// work zero.
#[derive(Clone, Debug)]
pub struct MillDrawing {
    title: String,
    options: DrawingOptions,
    strokes: Vec<MillStroke>,
    tools: Vec<u16>,
    holes: HoleFinder,
    zero: Option<[f64; 3]>,
    cut_box: Option<PathBox>,
    full_box: Option<PathBox>,
    times: MillTimes,
    /// Least and greatest value of each further axis (the fourth or fifth) that has moved: mm,
    /// or degrees.
    further: Vec<(FurtherAxis, f64, f64)>,
    point_count: usize,
    omitted_moves: u64,
}

impl MillDrawing {
    /// Creates a drawing without a path. `title` is the text in its upper left corner.
    pub fn new(title: impl Into<String>, options: DrawingOptions) -> Self {
        Self {
            title: title.into(),
            options,
            strokes: Vec::new(),
            tools: Vec::new(),
            holes: HoleFinder::default(),
            zero: None,
            cut_box: None,
            full_box: None,
            times: MillTimes::default(),
            further: Vec::new(),
            point_count: 0,
            omitted_moves: 0,
        }
    }

    /// Adds a move to the drawn path and to the machine times.
    pub fn add_move(&mut self, made: &MillMove) {
        self.times.add_move(made);
        if made.kind == MillMoveKind::Dwell {
            return;
        }
        self.add_further_axes(made);
        // A move of a rotary axis alone draws nothing.
        if made.arc.is_none() && made.from.mm() == made.to.mm() {
            return;
        }
        if self.point_count >= MAX_POINTS {
            self.omitted_moves += 1;
            return;
        }
        let zero = made.zero.mm();
        let first = *self.zero.get_or_insert(zero);
        let from_first_zero =
            |point: [f64; 3]| core::array::from_fn(|axis| point[axis] + zero[axis] - first[axis]);
        let line_kind = match made.kind {
            MillMoveKind::Rapid => PathLine::Rapid,
            _ => PathLine::Cut(self.tool_index(made.tool)),
        };
        let begin: [f64; 3] = from_first_zero(made.from.mm());
        let tool = match line_kind {
            PathLine::Cut(tool) => tool,
            _ => 0,
        };
        let end = from_first_zero(made.to.mm());
        self.holes.follow(made.kind, (begin, end), tool);
        let points: Vec<[f64; 3]> = move_points(made).into_iter().map(from_first_zero).collect();
        self.point_count += points.len();
        for point in core::iter::once(&begin).chain(&points) {
            PathBox::widen(&mut self.full_box, *point);
            if line_kind != PathLine::Rapid {
                PathBox::widen(&mut self.cut_box, *point);
            }
        }
        match self.strokes.last_mut() {
            Some(last) if last.line_kind == line_kind && last.points.last() == Some(&begin) => {
                last.points.extend(points);
            }
            _ => {
                let points = core::iter::once(begin).chain(points).collect();
                self.strokes.push(MillStroke { line_kind, points });
            }
        }
    }

    /// Widens the ranges of the further axes to include a move. Axes that never move are not
    /// shown.
    fn add_further_axes(&mut self, made: &MillMove) {
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

    /// Number of moves that are missing in the drawing because they did not fit into memory.
    pub const fn omitted_moves(&self) -> u64 {
        self.omitted_moves
    }

    fn tool_index(&mut self, tool: u16) -> u8 {
        let known = self.tools.iter().position(|known| *known == tool);
        let index = known.unwrap_or_else(|| {
            self.tools.push(tool);
            self.tools.len() - 1
        });
        u8::try_from(index).unwrap_or(u8::MAX)
    }

    /// The bounds that the picture is fitted to, mm: the cuts or the whole path.
    fn shown_box(&self) -> PathBox {
        let shown = match self.options.shows_whole_path {
            true => self.full_box,
            false => self.cut_box.or(self.full_box),
        };
        shown.unwrap_or(PathBox {
            low: [-50.0; 3],
            high: [50.0; 3],
        })
    }

    /// The bounds that the picture is fitted to, with a margin of 5 per cent, mm.
    fn box_with_margin(&self) -> PathBox {
        let mut cube = self.shown_box();
        for axis in 0..3 {
            let room = ((cube.high[axis] - cube.low[axis]) * 0.05).max(0.5);
            cube.low[axis] -= room;
            cube.high[axis] += room;
        }
        cube
    }
}

/// Points of a move after its start, mm: ends of the chords of an arc, and the points where
/// the axes of a rapid without interpolation arrive.
fn move_points(made: &MillMove) -> Vec<[f64; 3]> {
    if let Some(mut parts) = made.arrivals {
        parts.sort_by(f64::total_cmp);
        let parts = parts.into_iter().filter(|part| *part > 0.0 && *part < 1.0);
        return parts.chain([1.0]).map(|part| made.at(part)).collect();
    }
    let chords = made
        .sweep()
        .map_or(1, |sweep| (sweep / CHORD_ANGLE_RAD).ceil().max(1.0) as u32);
    let at = |chord: u32| made.at(f64::from(chord) / f64::from(chords));
    (1..=chords).map(at).collect()
}

/// Draws the path of a mill as a picture file and returns the bytes of the file. `language` is
/// that of its texts.
///
/// # Errors
/// There is not enough memory.
pub fn encode_mill(
    format: PictureFormat,
    drawing: &MillDrawing,
    language: Language,
) -> Result<Vec<u8>, PictureError> {
    let parts = items::picture_items(drawing, language);
    match format {
        PictureFormat::Svg => Ok(to_svg(&parts, drawing.options.size).into_bytes()),
        PictureFormat::Png => {
            let mut canvas = PictureCanvas::new(drawing.options.size)?;
            canvas.set_smooth(drawing.point_count <= MAX_SMOOTH_CHORDS);
            for part in &parts {
                match part {
                    PictureItem::Line(pen, points) => canvas.draw_polyline(*pen, points),
                    PictureItem::Text {
                        position: at,
                        text: words,
                        anchor: align,
                    } => {
                        let align = match align {
                            TextAnchor::Left => TextAlign::Left,
                            TextAnchor::Center => TextAlign::Center,
                            TextAnchor::Right => TextAlign::Right,
                        };
                        canvas.draw_text(at.0, at.1 - 13.0, words, align);
                    }
                }
            }
            png_file::encode(&canvas.into_pixels())
        }
    }
}

fn to_svg(parts: &[PictureItem], size: PictureSize) -> String {
    let mut out = svg::begin_file(size);
    for part in parts {
        match part {
            PictureItem::Line(pen, points) => svg::write_polyline(&mut out, *pen, points),
            PictureItem::Text {
                position: at,
                text: words,
                anchor: align,
            } => {
                let anchor = match align {
                    TextAnchor::Left => "start",
                    TextAnchor::Center => "middle",
                    TextAnchor::Right => "end",
                };
                svg::write_text(&mut out, *at, words, anchor);
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
        let mut drawing = MillDrawing::new("O0001 <铣>", DrawingOptions::default());
        let setup = gsk_milling::MillSetup::default();
        let end = gsk_milling::preview_while(
            &setup,
            &programs,
            &mut |made| drawing.add_move(made),
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
            let svg = encode_mill(PictureFormat::Svg, &drawing, language).expect("picture");
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
            // A frame for each view. A line for each tool in each view and in the legend, and
            // the rapids.
            assert!(svg.matches("<polyline").count() >= 4 + 4 * 2 + 2 + 4);
        }
        let png = encode_mill(PictureFormat::Png, &drawing, Language::En).expect("picture");
        assert!(png.starts_with(b"\x89PNG"));
        let empty = MillDrawing::new("", DrawingOptions::default());
        assert!(encode_mill(PictureFormat::Svg, &empty, Language::En).is_ok());
    }

    #[test]
    fn rotary_axes_are_reported_and_rapid_axes_arrive_separately() {
        let mut programs = ProgramMemory::default();
        programs.open_external(Program::new("G00 X80 Y20 A-30\nG01 A330 F3600\nM30\n"));
        programs.select(gsk_core::command::ProgramId::External);
        let drawn = |parameters: &[(u16, i32)]| {
            let mut setup = gsk_milling::MillSetup::default();
            for (number, value) in parameters {
                assert_eq!(setup.memory.model.set_parameter(*number, *value), Ok(()));
            }
            let mut drawing = MillDrawing::new("", DrawingOptions::default());
            let mut take = |made: &MillMove| drawing.add_move(made);
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
        let svg = encode_mill(PictureFormat::Svg, &drawing, Language::En).expect("picture");
        assert!(String::from_utf8_lossy(&svg).contains("A -30 … 330°"));
        assert_eq!(drawn(&[(1010, 4), (12, 128)]).strokes[0].points.len(), 2);
    }

    #[test]
    fn holes_are_marked_in_the_view_from_above() {
        let drawing = drawing(
            "T1\nG00 X0 Y0 Z5\nG83 X10 Y10 Z-9 R2 Q4 F100\nX30\nG80\nG00 X50\nG01 Z-2\n\
             X60\nG00 Z5\nM30\n",
        );
        let parts = items::picture_items(&drawing, Language::En);
        // A circle has 17 points with its first point again at its end; XY alone shows it.
        let is_circle = |part: &&PictureItem| matches!(part, PictureItem::Line(_, points) if points.len() == 17);
        assert_eq!(parts.iter().filter(is_circle).count(), 2);
    }

    #[test]
    fn views_along_an_axis_have_one_scale() {
        let drawing = drawing("G00 X0 Y0 Z0\nG01 X100 F100\nY10\nZ-5\nM30\n");
        let panes = views::lay_out_panes(&drawing.box_with_margin(), (1280.0, 800.0), 60.0);
        assert_eq!(panes[0].units_per_mm, panes[2].units_per_mm);
        assert_eq!(panes[0].units_per_mm, panes[3].units_per_mm);
        // X to the right, Y up, in the frame.
        let (from, to) = (
            panes[0].to_units([0.0; 3]),
            panes[0].to_units([100.0, 10.0, 0.0]),
        );
        assert!(to.0 > from.0 && to.1 < from.1);
        let (left, upper, right, lower) = panes[0].frame;
        assert!((left..right).contains(&to.0) && (upper..lower).contains(&to.1));
    }
}
