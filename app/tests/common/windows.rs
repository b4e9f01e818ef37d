//! Renders the separate windows of views. A test harness without a display does not have them.

use std::cell::RefCell;
use std::rc::Rc;

use egui::{
    Context, Event, ImmediateViewport, Modifiers, PointerButton, Pos2, RawInput, Rect,
    ViewportInfo, pos2,
};

use super::WindowBench;

/// A separate window as it was drawn.
pub struct DrawnWindow {
    /// Its rectangle on the screen without frame and title; `None` if it requested no
    /// position.
    pub bounds: Option<Rect>,
    /// Its labels, each with its centre.
    pub labels: Vec<(String, Pos2)>,
}

impl DrawnWindow {
    /// The centre of a label.
    pub fn label_center(&self, text: &str) -> Option<Pos2> {
        let label = self.labels.iter().find(|(label, _)| label == text);
        label.map(|(_, center)| *center)
    }
}

/// The windows beside the main one.
pub struct ViewWindows {
    all: Rc<RefCell<Vec<DrawnWindow>>>,
    /// Input for the first of them.
    events: Rc<RefCell<Vec<Event>>>,
}

impl ViewWindows {
    /// Lets views have separate windows from now on.
    pub fn enable(bench: &WindowBench) -> Self {
        bench.harness.ctx.set_embed_viewports(false);
        let windows = Self {
            all: Rc::default(),
            events: Rc::default(),
        };
        let (all, events) = (Rc::clone(&windows.all), Rc::clone(&windows.events));
        Context::set_immediate_viewport_renderer(move |context, window| {
            let shown = draw_window(context, window, events.take());
            all.borrow_mut().push(shown);
        });
        windows
    }

    /// Draws the next frame and returns its windows.
    pub fn draw_frame(&self, bench: &mut WindowBench) -> Vec<DrawnWindow> {
        self.all.borrow_mut().clear();
        bench.harness.step();
        self.all.take()
    }

    /// Clicks a label in the first window.
    #[track_caller]
    pub fn click(&self, bench: &mut WindowBench, label: &str) {
        let windows = self.draw_frame(bench);
        let pos = windows.first().and_then(|it| it.label_center(label));
        let pos = pos.expect("there is no such label");
        self.events.borrow_mut().push(Event::PointerMoved(pos));
        for pressed in [true, false] {
            self.events.borrow_mut().push(Event::PointerButton {
                pos,
                button: PointerButton::Primary,
                pressed,
                modifiers: Modifiers::default(),
            });
            self.draw_frame(bench);
        }
    }
}

fn draw_window(
    context: &Context,
    mut window: ImmediateViewport<'_>,
    events: Vec<Event>,
) -> DrawnWindow {
    let (size, corner) = (window.builder.inner_size, window.builder.position);
    let id = window.ids.this;
    let input = RawInput {
        viewport_id: id,
        viewports: std::iter::once((id, ViewportInfo::default())).collect(),
        screen_rect: size.map(|size| Rect::from_min_size(Pos2::ZERO, size)),
        focused: false,
        events,
        ..RawInput::default()
    };
    let mut output = context.run_ui(input, |ui| (window.viewport_ui_cb)(ui));
    // No renderer paints these windows: their textures are dropped.
    output.textures_delta.clear();
    let update = output.platform_output.accesskit_update;
    let nodes = update.into_iter().flat_map(|update| update.nodes);
    let labels = nodes.filter_map(|(_, node)| {
        let bounds = node.bounds().unwrap_or_default();
        let (x, y) = ((bounds.x0 + bounds.x1) / 2.0, (bounds.y0 + bounds.y1) / 2.0);
        let text = node.label().or_else(|| node.value())?;
        Some((text.to_owned(), pos2(x as f32, y as f32)))
    });
    DrawnWindow {
        bounds: corner
            .zip(size)
            .map(|(corner, size)| Rect::from_min_size(corner, size)),
        labels: labels.collect(),
    }
}
