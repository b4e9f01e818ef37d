//! What the window leaves out during an exam: only the control itself helps, as at the machine.

use gsk_messages::say;

use super::top_bar::TopBarRequest;
use crate::Window;
use crate::view::{VIEWS, ViewId};

/// The views that stay during an exam: the task, what is to be seen of the machine, and the bench
/// where faults are repaired.
const EXAM_VIEWS: [ViewId; 3] = [ViewId::Lesson, ViewId::Machine, ViewId::Bench];

/// What was closed for an exam.
#[derive(Debug, Default)]
pub struct ClosedForExam {
    views: Vec<ViewId>,
    /// Whether the time line was shown.
    has_timeline: bool,
}

impl Window {
    /// Whether an exam has begun and is not over.
    pub(crate) fn is_in_exam(&mut self) -> bool {
        self.views.lessons().exercises().is_in_exam()
    }

    /// Closes during an exam, in every frame, whatever is not part of it, and opens it again
    /// after the exam.
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

    /// Opens what was closed for an exam that is over.
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

/// Returns whether a learner may use an entry of the top bar during an exam: what he sees of the
/// machine, and how the window looks.
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
