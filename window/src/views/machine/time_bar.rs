//! Shows where the time of a program goes: a bar of its moves over time with the running
//! block, and sums by kind of move and tool.

use std::sync::Arc;

use egui::{Color32, Pos2, Rect, RichText, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use gsk_messages::{Language, say};
use gsk_runner::text_format::format_whole_seconds as clock;
use gsk_runner::times::{ProgramTimes, TimeUse};

use super::path::{BlockRef, DrawnPath, SegmentKind, nearest_point_on};
use crate::theme;

const COLUMN_COUNT: usize = 600;
/// A tip nearer to a segment than this is on it, mm.
const ON_PATH_MM: f32 = 0.05;
/// Height of the time bar, points.
const BAR_HEIGHT: f32 = 12.0;

/// The bar with the machine time of the program, and the path it was made for.
#[derive(Default)]
pub struct TimeBar {
    drawn_path: Option<Arc<DrawnPath>>,
    columns: Vec<SegmentKind>,
    /// Machine time at which the running block begins, s. A repeated block has a later time.
    block_start_s: f32,
    /// Machine time at the tip of the tool, s: within the running block.
    now_s: f32,
}

impl TimeBar {
    /// Draws bar and sums. `running`: the block that is being executed, and the tip of the tool
    /// in part coordinates.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        (times, path): (&ProgramTimes, &Arc<DrawnPath>),
        running: Option<(BlockRef, Pos2)>,
        language: Language,
    ) {
        let total_s = times.spent().total_s();
        if total_s <= 0.0 {
            return;
        }
        let known = self.drawn_path.as_ref();
        if !known.is_some_and(|known| Arc::ptr_eq(known, path)) {
            self.columns = fill_columns(path, total_s as f32);
            self.drawn_path = Some(Arc::clone(path));
        }
        self.follow(path, running);
        let share = self.elapsed_share(total_s as f32);
        self.draw_bar(ui, running.map(|_| share), times, language);
        ui.horizontal_wrapped(|ui| {
            let mut add_label = |words: String, color| ui.label(RichText::new(words).color(color));
            let all = clock(total_s);
            add_label(
                match running {
                    Some(_) => {
                        let left = clock(total_s - f64::from(self.now_s));
                        say::lathe_time_left(all, left).text(language)
                    }
                    None => say::lathe_time(all).text(language),
                },
                theme::SECONDARY_TEXT,
            );
            for what in TimeUse::ALL {
                let seconds = times.spent().seconds_of(what);
                if seconds > 0.0 {
                    let name = what.message().text(language);
                    add_label(format!("{name} {}", clock(seconds)), spending_color(what));
                }
            }
        });
    }

    /// The share of the machine time that has passed, 0 to 1.
    pub fn elapsed_share(&self, total_s: f32) -> f32 {
        (self.now_s / total_s).clamp(0.0, 1.0)
    }

    /// Follows the tip along the segments of the running block.
    fn follow(&mut self, path: &DrawnPath, running: Option<(BlockRef, Pos2)>) {
        let Some((block, tip)) = running else {
            (self.block_start_s, self.now_s) = (0.0, 0.0);
            return;
        };
        let start = block_start_s(path, block, self.block_start_s);
        if start != self.block_start_s {
            (self.block_start_s, self.now_s) = (start, start);
        }
        if let Some(at) = time_at_tip(path, block, self.now_s, tip) {
            self.now_s = self.now_s.max(at);
        }
    }

    fn draw_bar(&self, ui: &mut Ui, at: Option<f32>, times: &ProgramTimes, language: Language) {
        let size = vec2(ui.available_width(), BAR_HEIGHT);
        let (room, response) = ui.allocate_exact_size(size, Sense::HOVER);
        response.widget_info(|| {
            let name = say::lathe_time_bar().text(language);
            WidgetInfo::labeled(Role::ProgressIndicator, true, name)
        });
        let painter = ui.painter_at(room);
        let width = room.width() / COLUMN_COUNT as f32;
        for (index, kind) in self.columns.iter().enumerate() {
            let left = room.left() + index as f32 * width;
            // Slightly wider, so that no gaps remain between the columns.
            let column = Rect::from_x_y_ranges(left..=left + width + 0.5, room.y_range());
            let color = match kind {
                SegmentKind::Jump => theme::DWELL,
                SegmentKind::Rapid => theme::RAPID_PATH,
                SegmentKind::Feed => theme::FEED_PATH,
                SegmentKind::Thread => theme::THREAD_PATH,
            };
            painter.rect_filled(column, 0.0, theme::time_column(color));
        }
        if let Some(at) = at {
            let x = room.left() + at * room.width();
            let done = Rect::from_min_max(room.min, pos2(x, room.bottom()));
            painter.rect_filled(done, 0.0, theme::TIME_DONE_SHADE);
            painter.vline(x, room.y_range(), Stroke::new(2.0, theme::TIME_CURSOR));
        }
        let tools = times.tools().iter().map(|tool| {
            let time = clock(tool.times.total_s());
            let cutting = clock(tool.times.cutting_s());
            let words = say::lathe_time_of_tool(tool.tool, tool.offset, time, cutting);
            words.text(language)
        });
        let tools: Vec<String> = tools.collect();
        response.on_hover_text(tools.join("\n"));
    }
}

const fn spending_color(what: TimeUse) -> Color32 {
    match what {
        TimeUse::Rapid => theme::RAPID_PATH,
        TimeUse::Feed => theme::FEED_PATH,
        TimeUse::Thread => theme::THREAD_PATH,
        TimeUse::Dwell | TimeUse::Other => theme::DWELL_TEXT,
    }
}

/// Returns the kind of move that each column of the bar shows.
fn fill_columns(path: &DrawnPath, total_s: f32) -> Vec<SegmentKind> {
    let mut columns = vec![SegmentKind::Jump; COLUMN_COUNT];
    let column = |seconds: f32| (seconds / total_s * COLUMN_COUNT as f32) as usize;
    for (_, piece) in path.segments() {
        let (first, last) = (column(piece.start_s), column(piece.end_s));
        for index in first..=last.min(COLUMN_COUNT - 1) {
            if let Some(way) = columns.get_mut(index) {
                *way = piece.kind;
            }
        }
    }
    columns
}

/// Machine time at which the tip is on a segment of a block, s: the first such segment that does
/// not end before `earliest_s`. `None` if the tip is on no segment.
fn time_at_tip(path: &DrawnPath, block: BlockRef, earliest_s: f32, tip: Pos2) -> Option<f32> {
    let of_block = path.segments().filter(|(_, piece)| {
        piece.line == block.line && piece.program == block.program && piece.end_s >= earliest_s
    });
    let mut of_block = of_block.peekable();
    let mut last_start_s = None;
    while let Some((from, piece)) = of_block.next() {
        let nearest = nearest_point_on(from, piece.end, tip);
        // The chords of an arc have the times of the whole arc.
        let next_start_s = of_block.peek().map(|(_, next)| next.start_s);
        let is_chord = [last_start_s, next_start_s].contains(&Some(piece.start_s));
        last_start_s = Some(piece.start_s);
        if (tip - nearest).length() > ON_PATH_MM {
            continue;
        }
        let length = (piece.end - from).length();
        let share = match is_chord || length <= 0.0 {
            true => 0.0,
            false => (nearest - from).length() / length,
        };
        return Some(piece.start_s + share * (piece.end_s - piece.start_s));
    }
    None
}

/// Machine time at which a block begins, s: the first start that is not before `earliest_s`.
fn block_start_s(path: &DrawnPath, block: BlockRef, earliest_s: f32) -> f32 {
    let of_block = path
        .segments()
        .filter(|(_, piece)| piece.line == block.line && piece.program == block.program);
    let starts = of_block.map(|(_, piece)| piece.start_s);
    let (mut first, mut next) = (None, None);
    for start in starts {
        first.get_or_insert(start);
        if start >= earliest_s {
            next = Some(start);
            break;
        }
    }
    // A block without motion begins with the block before it.
    next.unwrap_or(earliest_s.max(first.unwrap_or(0.0)))
}
