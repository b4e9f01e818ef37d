//! What the window leaves out during an exam: only the control itself helps, as at the machine.

use gsk_messages::say;

use super::top_bar::TopBarRequest;
use crate::Window;
use crate::view::{VIEWS, ViewId};

/// The views that may be open during an exam: the task, the machine, and the bench where faults are
/// repaired.
const EXAM_VIEWS: [ViewId; 3] = [ViewId::Lesson, ViewId::Machine, ViewId::Bench];

/// The views and bars that were closed when an exam began, to be opened again after it.
#[derive(Debug, Default)]
pub struct ClosedForExam {
    views: Vec<ViewId>,
    /// Whether the time line was shown before the exam.
    has_timeline: bool,
}

impl Window {
    /// Whether an exam has begun and has not ended.
    pub(crate) fn is_in_exam(&mut self) -> bool {
        self.views.lessons().exercises().is_in_exam()
    }

    /// In every frame of an exam, closes all views and bars that an exam excludes, and opens them
    /// again after the exam.
    pub(crate) fn restrict_to_exam(&mut self) {
        if !self.is_in_exam() {
            return self.open_closed_views();
        }
        let closed = self.closed_for_exam.get_or_insert_default();
        self.why.close();
        self.network.close();
        let layouts = &mut self.settings.layouts;
        for view in VIEWS.iter().map(|row| row.view) {
            if layouts.is_open(view) && !EXAM_VIEWS.contains(&view) {
                layouts.toggle(view);
                closed.views.push(view);
            }
        }
        closed.has_timeline |= self.settings.timeline;
        if !layouts.is_open(ViewId::Lesson) {
            layouts.dock(ViewId::Lesson);
        }
        if self.help.is_open() {
            self.help.close();
            self.show_message(say::exam_no_help());
        }
        self.first_start = None;
        self.is_key_map_open = false;
        self.settings.timeline = false;
    }

    /// Opens the views and bars that were closed for an exam that has ended.
    fn open_closed_views(&mut self) {
        let Some(closed) = self.closed_for_exam.take() else {
            return;
        };
        for view in closed.views {
            if !self.settings.layouts.is_open(view) {
                self.settings.layouts.toggle(view);
            }
        }
        self.settings.timeline |= closed.has_timeline;
        // The learner reads the end of the exam.
        self.show_view(ViewId::Lesson);
    }
}

/// Returns whether a learner may use an entry of the top bar during an exam: entries about the view
/// of the machine and the look of the window.
pub fn is_allowed_in_exam(request: &TopBarRequest) -> bool {
    match request {
        TopBarRequest::ToggleView(view) => EXAM_VIEWS.contains(view),
        TopBarRequest::Layout(_)
        | TopBarRequest::ToggleLight
        | TopBarRequest::Sound(_)
        | TopBarRequest::ToggleFingers
        | TopBarRequest::Zoom(_)
        | TopBarRequest::SwitchLanguage => true,
        _ => false,
    }
}
