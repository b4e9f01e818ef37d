//! Courses of a learning platform: only a page is opened by one.

use super::super::CoursePage;

/// Returns `None`: no learning platform opens the program on a computer.
pub const fn course_page() -> Option<CoursePage> {
    None
}

/// Does nothing and returns false, because there is no learning platform.
pub const fn report_course(_values: &str) -> bool {
    false
}
