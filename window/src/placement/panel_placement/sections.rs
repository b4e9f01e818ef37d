//! Arranges the sections of the panel in a pane.

use egui::{Rect, Vec2, pos2, vec2};
use gsk_panel::faceplate::{self, PanelArea, SIZE};

use super::{MAX_LCD_STRETCH, MAX_STRETCH, PlacedArea};

/// Factor by which a section at most grows beyond the common scale to fill its cell.
const MAX_GROWTH: f32 = 1.3;

/// An arrangement of sections: a column at the left, and beside it rows of columns.
pub(super) struct SectionArrangement {
    side: &'static [usize],
    rows: &'static [&'static [&'static [usize]]],
}

// Indices of the sections.
const LCD: usize = 0;
const NAME: usize = 1;
const EDIT: usize = 2;
const MODES: usize = 3;
const DIRECTIONS: usize = 4;
const RUN: usize = 5;
const ADDITIONAL: usize = 6;

/// The arrangements of the sections, from that of a wide pane to that of an upright one.
pub(super) static ARRANGEMENTS: [SectionArrangement; 12] = [
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD], &[NAME, EDIT]],
            &[&[MODES], &[DIRECTIONS], &[RUN], &[ADDITIONAL]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[EDIT]],
            &[&[MODES], &[DIRECTIONS], &[RUN], &[ADDITIONAL]],
        ],
    },
    SectionArrangement {
        side: &[LCD, NAME],
        rows: &[&[&[EDIT], &[ADDITIONAL, DIRECTIONS]], &[&[MODES], &[RUN]]],
    },
    SectionArrangement {
        side: &[LCD, NAME, RUN, ADDITIONAL],
        rows: &[&[&[EDIT]], &[&[MODES], &[DIRECTIONS]]],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[ADDITIONAL, DIRECTIONS]],
            &[&[EDIT], &[MODES, RUN]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[EDIT], &[ADDITIONAL, DIRECTIONS]],
            &[&[MODES], &[RUN]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[MODES, RUN]],
            &[&[EDIT], &[ADDITIONAL, DIRECTIONS]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[ADDITIONAL, DIRECTIONS, RUN]],
            &[&[EDIT], &[MODES]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[ADDITIONAL, RUN]],
            &[&[EDIT], &[DIRECTIONS]],
            &[&[MODES]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME], &[ADDITIONAL, RUN]],
            &[&[EDIT]],
            &[&[MODES], &[DIRECTIONS]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME]],
            &[&[EDIT], &[ADDITIONAL, DIRECTIONS]],
            &[&[MODES], &[RUN]],
        ],
    },
    SectionArrangement {
        side: &[],
        rows: &[
            &[&[LCD, NAME]],
            &[&[EDIT]],
            &[&[MODES], &[DIRECTIONS]],
            &[&[RUN], &[ADDITIONAL]],
        ],
    },
];

/// An arrangement of the sections with its scales, points per panel unit.
pub(super) struct SectionPlan {
    arrangement: &'static SectionArrangement,
    lcd_scale: f32,
    pub(super) key_scale: f32,
}

impl SectionPlan {
    /// Finds the largest keys at which the arrangement fits into `room`.
    pub(super) fn fit(
        arrangement: &'static SectionArrangement,
        lcd_scale: f32,
        room: Vec2,
    ) -> Self {
        let mut plan = Self {
            arrangement,
            lcd_scale,
            key_scale: 0.0,
        };
        let (mut low, mut high) = (0.0, room.max_elem() / SIZE.1 * 2.0);
        for _ in 0..14 {
            plan.key_scale = f32::midpoint(low, high);
            let size = plan.size();
            if size.x <= room.x && size.y <= room.y {
                low = plan.key_scale;
            } else {
                high = plan.key_scale;
            }
        }
        plan.key_scale = low;
        plan
    }

    fn section_size(&self, section: usize) -> Vec2 {
        let Some(area) = PanelArea::SECTIONS.get(section) else {
            return Vec2::ZERO;
        };
        let scale = match section {
            LCD => self.lcd_scale,
            // It has no keys, and is no wider than the LCD.
            NAME => (self.key_scale * 0.75).min(self.lcd_scale * 1.15),
            // It has large parts and no legends.
            ADDITIONAL => self.key_scale * 0.9,
            _ => self.key_scale,
        };
        vec2(area.rect.w, area.rect.h) * scale
    }

    fn column_size(&self, column: &[usize]) -> Vec2 {
        let sizes = column.iter().map(|section| self.section_size(*section));
        sizes.fold(Vec2::ZERO, |sum, size| {
            vec2(sum.x.max(size.x), sum.y + size.y)
        })
    }

    /// The width to which a column can be stretched. That of the LCD does not grow.
    fn max_width(&self, column: &[usize]) -> f32 {
        match column.contains(&LCD) {
            true => self.section_size(LCD).x * MAX_LCD_STRETCH,
            false => self.column_size(column).x * MAX_GROWTH * MAX_STRETCH,
        }
    }

    fn row_size(&self, row: &[&[usize]]) -> Vec2 {
        let sizes = row.iter().map(|column| self.column_size(column));
        sizes.fold(Vec2::ZERO, |sum, size| {
            vec2(sum.x + size.x, sum.y.max(size.y))
        })
    }

    fn rows_size(&self) -> Vec2 {
        let sizes = self.arrangement.rows.iter().map(|row| self.row_size(row));
        sizes.fold(Vec2::ZERO, |sum, size| {
            vec2(sum.x.max(size.x), sum.y + size.y)
        })
    }

    fn size(&self) -> Vec2 {
        let (side, rows) = (self.column_size(self.arrangement.side), self.rows_size());
        vec2(side.x + rows.x, side.y.max(rows.y))
    }

    /// Places the sections in `bounds`. Each row and column gets an equal part of the remaining
    /// space, a column no more than it can fill. Its sections grow and are stretched into it.
    pub(super) fn place(&self, bounds: Rect, pixels_per_point: f32) -> Vec<PlacedArea> {
        let mut placed = Vec::new();
        let SectionArrangement { side, rows } = self.arrangement;
        let mut beside = bounds;
        if !side.is_empty() {
            let spare = bounds.width() - self.size().x;
            let widths = [
                (self.column_size(side).x, self.max_width(side)),
                (self.rows_size().x, f32::INFINITY),
            ];
            let at = bounds.left() + share_width(&widths, spare)[0];
            let (side_cell, rest) = bounds.split_left_right_at_x(at);
            self.place_column(side, side_cell, pixels_per_point, &mut placed);
            beside = rest;
        }
        let extra_height = (bounds.height() - self.rows_size().y) / rows.len() as f32;
        let mut y = bounds.top();
        for row in *rows {
            let row_size = self.row_size(row);
            let row_height = row_size.y + extra_height;
            let widths: Vec<(f32, f32)> = row
                .iter()
                .map(|column| (self.column_size(column).x, self.max_width(column)))
                .collect();
            let widths = share_width(&widths, beside.width() - row_size.x);
            let mut x = beside.left();
            for (column, width) in row.iter().zip(widths) {
                let cell = Rect::from_min_size(pos2(x, y), vec2(width, row_height));
                self.place_column(column, cell, pixels_per_point, &mut placed);
                x += width;
            }
            y += row_height;
        }
        placed
    }

    fn place_column(
        &self,
        column: &[usize],
        cell: Rect,
        pixels_per_point: f32,
        placed: &mut Vec<PlacedArea>,
    ) {
        let is_fixed = column.contains(&LCD);
        let growth = match is_fixed {
            true => 1.0,
            false => cell.height() / self.column_size(column).y,
        };
        let sections: Vec<GrownSection> = column
            .iter()
            .filter_map(|section| {
                let rect = PanelArea::SECTIONS.get(*section)?.rect;
                let size = self.section_size(*section);
                let growth = growth.min(cell.width() / size.x).clamp(1.0, MAX_GROWTH);
                let max_stretch = match *section {
                    LCD => MAX_LCD_STRETCH,
                    _ => MAX_STRETCH,
                };
                Some(GrownSection {
                    rect,
                    scale: size.x * growth / rect.w,
                    max_stretch,
                })
            })
            .collect();
        let heights = share_height(&sections, cell.height());
        let widths = sections.iter().map(|it| it.max_width().min(cell.width()));
        // The left edges are in one line.
        let widest = widths.fold(0.0, f32::max);
        let left = cell.center().x - widest / 2.0;
        let used: f32 = heights.iter().sum();
        let gap = (cell.height() - used).max(0.0) / (column.len() + 1) as f32;
        let mut top = cell.top() + gap;
        for (section, height) in sections.iter().zip(heights) {
            let width = section.max_width().min(widest);
            let available = Rect::from_min_size(pos2(left, top), vec2(width, height));
            let scales = (section.scale, section.max_stretch);
            placed.push(PlacedArea::fill(
                section.rect,
                available,
                scales,
                pixels_per_point,
            ));
            top += height + gap;
        }
    }
}

/// Divides `spare` width equally among columns, none wider than it can be stretched unless all
/// are. `widths`: width and greatest width of each column.
fn share_width(widths: &[(f32, f32)], spare: f32) -> Vec<f32> {
    let mut shared: Vec<f32> = widths.iter().map(|(width, _)| *width).collect();
    let mut rest = spare;
    // In each round at least one column reaches its limit, or all space is shared.
    for _ in widths {
        let growing = shared.iter().zip(widths).filter(|(now, it)| **now < it.1);
        let count = growing.count();
        if rest <= 0.0 || count == 0 {
            break;
        }
        let share = rest / count as f32;
        for (now, (_, most)) in shared.iter_mut().zip(widths) {
            let more = share.min((most - *now).max(0.0));
            *now += more;
            rest -= more;
        }
    }
    let equal = rest / widths.len().max(1) as f32;
    shared.iter().map(|width| width + equal).collect()
}

/// A section with the scale to which it has grown, before it is stretched.
struct GrownSection {
    rect: faceplate::Rect,
    scale: f32,
    max_stretch: f32,
}

impl GrownSection {
    fn height(&self) -> f32 {
        self.rect.h * self.scale
    }

    fn max_height(&self) -> f32 {
        self.height() * self.max_stretch
    }

    fn max_width(&self) -> f32 {
        self.rect.w * self.scale * self.max_stretch
    }
}

/// Divides the height of a column among its sections: in proportion to their heights, none
/// higher than it can be stretched.
fn share_height(sections: &[GrownSection], available: f32) -> Vec<f32> {
    let mut heights: Vec<f32> = sections.iter().map(GrownSection::height).collect();
    // In each round at least one section reaches its limit, or all space is shared.
    for _ in sections {
        let rest = available - heights.iter().sum::<f32>();
        let growing = |(section, height): &(&GrownSection, &f32)| **height < section.max_height();
        let pairs = sections.iter().zip(&heights);
        let sum: f32 = pairs.filter(growing).map(|(_, height)| height).sum();
        if rest <= 0.0 || sum <= 0.0 {
            break;
        }
        let factor = 1.0 + rest / sum;
        for (section, height) in sections.iter().zip(&mut heights) {
            *height = (*height * factor).min(section.max_height());
        }
    }
    heights
}
