//! Prints the hashes of the session of `determinism`, to compare systems. On a page they
//! become the text of its element `golden`.

fn main() {
    let text = match gsk_tests::determinism::trace_session(&[]) {
        Ok(trace) => format!("{trace:?}"),
        Err(error) => error,
    };
    print_text(&text);
}

#[cfg(not(target_arch = "wasm32"))]
fn print_text(text: &str) {
    println!("{text}");
}

#[cfg(target_arch = "wasm32")]
fn tell(text: &str) {
    let document = web_sys::window().and_then(|window| window.document());
    if let Some(element) = document.and_then(|document| document.get_element_by_id("golden")) {
        element.set_text_content(Some(text));
    }
}
