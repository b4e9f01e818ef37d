//! Tests how well the panel fills its pane in each layout at six sizes of the window.

use egui::{Rect, pos2, vec2};

use super::Scales;
use super::{LAYOUTS, Layouts, WindowPane, panel_placement};
use panel_placement::MIN_LEGEND_HEIGHT;

const SIZES: [(f32, f32); 6] = [
    (800.0, 600.0),
    (1024.0, 768.0),
    (1366.0, 768.0),
    (1920.0, 1080.0),
    (2560.0, 1440.0),
    (1080.0, 1920.0),
];
/// Total height of the top bar and the message line, points.
const BARS: f32 = 50.0;
/// Share of its pane that the panel at most leaves unused, per cent.
const MAX_UNUSED: f32 = 10.0;

fn panel_pane(layouts: &Layouts, (width, height): (f32, f32)) -> Option<Rect> {
    let room = Rect::from_min_size(pos2(0.0, 28.0), vec2(width, height - BARS));
    let arranged = layouts.arrange(room, Scales::new(1.0));
    let mut panes = arranged.panes.into_iter();
    panes.find_map(|(pane, bounds)| (pane == WindowPane::Panel).then_some(bounds))
}

#[test]
#[allow(clippy::print_stdout, reason = "the table is read with --nocapture")]
fn legends_are_readable_in_each_layout() {
    println!(
        "{:<10} {:<10} pane       legend px  LCD px/dot  unused %",
        "size", "layout"
    );
    for size in SIZES {
        for row in &LAYOUTS {
            let layouts = Layouts::with_layout(row.layout);
            let Some(pane) = panel_pane(&layouts, size) else {
                continue;
            };
            let legend = panel_placement::legend_height(pane, 1.0);
            let zoom = panel_placement::lcd_zoom(pane, 1.0);
            let placed = panel_placement::place_panel(pane, 1.0);
            let unused = 100.0 * panel_placement::unused_share(&placed, pane);
            let (width, height) = size;
            println!(
                "{:<10} {:<10} {:>4.0}x{:<5.0} {legend:>8.1} {zoom:>10.2} {unused:>9.0}",
                format!("{width}x{height}"),
                format!("{:?}", row.layout),
                pane.width(),
                pane.height(),
            );
            assert!(unused < MAX_UNUSED, "{size:?} {:?}: {unused} %", row.layout);
            if width > 800.0 {
                assert!(legend >= MIN_LEGEND_HEIGHT, "{size:?} {:?}", row.layout);
            }
            assert!(
                (zoom - zoom.round()).abs() < 0.01,
                "{size:?}: {zoom} pixels per dot"
            );
        }
    }
}
