//! Shows where the time of a program goes: a bar of its moves over time with the running
//! block, and sums by kind of move and tool.

use std::sync::Arc;

use egui::{Color32, Rect, RichText, Role, Sense, Stroke, Ui, WidgetInfo, pos2, vec2};
use gsk_messages::{Language, say};
use gsk_runner::times::{Spending, Times};
use gsk_runner::words::clock_in_seconds as clock;

use super::lines;
use super::path::{Block, Path, Way};

const COLUMNS: usize = 600;
/// Height of the bar, points.
const HEIGHT: f32 = 12.0;
/// Dwells and times without a known move.
const WAIT: Color32 = Color32::from_gray(64);

/// The time bar, and the path it was made for.
#[derive(Default)]
pub struct Clock {
    made_for: Option<Arc<Path>>,
    columns: Vec<Way>,
    /// Machine time of the running block, s. A repeated block has a later time.
    at_s: f32,
}

impl Clock {
    /// Draws bar and sums. `running`: the block that is being executed.
    pub fn show(
        &mut self,
        ui: &mut Ui,
        (times, path): (&Times, &Arc<Path>),
        running: Option<Block>,
        language: Language,
    ) {
        let whole = times.spent().whole();
        if whole <= 0.0 {
            return;
        }
        let known = self.made_for.as_ref();
        if !known.is_some_and(|known| Arc::ptr_eq(known, path)) {
            self.columns = columns(path, whole as f32);
            self.made_for = Some(Arc::clone(path));
        }
        self.at_s = running.map_or(0.0, |block| began(path, block, self.at_s));
        let share = (self.at_s / whole as f32).clamp(0.0, 1.0);
        self.bar(ui, running.map(|_| share), times, language);
        ui.horizontal_wrapped(|ui| {
            let mut said = |words: String, color| ui.label(RichText::new(words).color(color));
            let all = clock(whole);
            said(
                match running {
                    Some(_) => {
                        let left = clock(whole - f64::from(self.at_s));
                        say::lathe_time_left(all, left).text(language)
                    }
                    None => say::lathe_time(all).text(language),
                },
                Color32::from_gray(200),
            );
            for what in Spending::ALL {
                let seconds = times.spent().on(what);
                if seconds > 0.0 {
                    let name = what.words().text(language);
                    said(format!("{name} {}", clock(seconds)), color_of(what));
                }
            }
        });
    }

    fn bar(&self, ui: &mut Ui, at: Option<f32>, times: &Times, language: Language) {
        let size = vec2(ui.available_width(), HEIGHT);
        let (room, response) = ui.allocate_exact_size(size, Sense::HOVER);
        response.widget_info(|| {
            let name = say::lathe_time_bar().text(language);
            WidgetInfo::labeled(Role::ProgressIndicator, true, name)
        });
        let painter = ui.painter_at(room);
        let width = room.width() / COLUMNS as f32;
        for (index, way) in self.columns.iter().enumerate() {
            let left = room.left() + index as f32 * width;
            // Slightly wider, so that no gaps remain between the columns.
            let column = Rect::from_x_y_ranges(left..=left + width + 0.5, room.y_range());
            let color = match way {
                Way::Jump => WAIT,
                Way::Rapid => lines::RAPID,
                Way::Feed => lines::FEED,
                Way::Thread => lines::THREAD,
            };
            painter.rect_filled(column, 0.0, color.gamma_multiply(0.75));
        }
        if let Some(at) = at {
            let x = room.left() + at * room.width();
            let done = Rect::from_min_max(room.min, pos2(x, room.bottom()));
            painter.rect_filled(done, 0.0, Color32::from_black_alpha(110));
            painter.vline(x, room.y_range(), Stroke::new(2.0, Color32::WHITE));
        }
        let tools = times.tools().iter().map(|tool| {
            let time = clock(tool.spent.whole());
            let cutting = clock(tool.spent.cutting());
            let words = say::lathe_time_of_tool(tool.tool, tool.offset, time, cutting);
            words.text(language)
        });
        let tools: Vec<String> = tools.collect();
        response.on_hover_text(tools.join("\n"));
    }
}

const fn color_of(what: Spending) -> Color32 {
    match what {
        Spending::Rapid => lines::RAPID,
        Spending::Feed => lines::FEED,
        Spending::Thread => lines::THREAD,
        Spending::Dwell | Spending::Other => Color32::from_gray(150),
    }
}

/// The kind of move in each column of the bar.
fn columns(path: &Path, whole: f32) -> Vec<Way> {
    let mut columns = vec![Way::Jump; COLUMNS];
    let column = |seconds: f32| (seconds / whole * COLUMNS as f32) as usize;
    for (_, piece) in path.pieces() {
        let (first, last) = (column(piece.start_s), column(piece.end_s));
        for index in first..=last.min(COLUMNS - 1) {
            if let Some(way) = columns.get_mut(index) {
                *way = piece.way;
            }
        }
    }
    columns
}

/// Machine time at which a block begins, s: the first start that is not before `since`.
fn began(path: &Path, block: Block, since: f32) -> f32 {
    let of_block = path
        .pieces()
        .filter(|(_, piece)| piece.line == block.line && piece.program == block.program);
    let starts = of_block.map(|(_, piece)| piece.start_s);
    let (mut first, mut next) = (None, None);
    for start in starts {
        first.get_or_insert(start);
        if start >= since {
            next = Some(start);
            break;
        }
    }
    // A block without motion begins with the block before it.
    next.unwrap_or(since.max(first.unwrap_or(0.0)))
}
