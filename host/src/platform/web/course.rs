//! Courses of a learning platform: the page of a package has the script `scorm.js`, which connects
//! it to the platform and is `gskCourse` here.

use std::cell::RefCell;

use js_sys::{Function, Reflect};
use wasm_bindgen::{JsCast, JsValue};

use super::super::CoursePage;

/// Name of the JavaScript object that connects to the learning platform.
const ADAPTER: &str = "gskCourse";

thread_local! {
    /// The file of the course; `None` if the page is opened without one.
    static COURSE: RefCell<Option<Vec<u8>>> = const { RefCell::new(None) };
}

/// Returns the script's object; `None` if the page does not belong to a package.
fn adapter() -> Option<JsValue> {
    let window = web_sys::window()?;
    let adapter = Reflect::get(window.as_ref(), &ADAPTER.into()).ok()?;
    adapter.is_object().then_some(adapter)
}

/// Returns whether the page belongs to a SCORM package.
pub fn is_packed() -> bool {
    adapter().is_some()
}

/// Returns whether a learning platform has opened the page.
pub fn is_connected() -> bool {
    field("isConnected").and_then(|it| it.as_bool()) == Some(true)
}

fn field(name: &str) -> Option<JsValue> {
    Reflect::get(&adapter()?, &name.into()).ok()
}

fn call(name: &str, value: &JsValue) -> Option<JsValue> {
    let function: Function = field(name)?.dyn_into().ok()?;
    function.call1(&adapter()?, value).ok()
}

/// Stores the content of the course file, which was fetched.
pub fn set_course(file: Vec<u8>) {
    COURSE.set(Some(file));
}

/// Returns the exercises that a learning platform has opened; `None` if the page is opened
/// without them.
pub fn course_page() -> Option<CoursePage> {
    let file = COURSE.with_borrow(Clone::clone)?;
    let suspended = call("suspended", &JsValue::UNDEFINED).and_then(|it| it.as_string());
    let learner = field("learner").and_then(|it| it.as_string());
    Some(CoursePage {
        file,
        suspended: suspended.unwrap_or_default(),
        learner: learner.unwrap_or_default(),
    })
}

/// Stores values, as JSON, in the learning platform. Returns whether it has accepted them.
pub fn report_course(values: &str) -> bool {
    call("report", &values.into()).and_then(|it| it.as_bool()) == Some(true)
}
