//! Prints what must be equal on every system: the hashes of the session of `determinism`, or, for
//! given files, the marks of results and the replays of recordings. On a page the text goes into
//! the element `golden`; the element `files` contains the files, one a line: name and hexadecimal
//! bytes.

use gsk_tests::determinism::trace_session;
use gsk_tests::marks::{NamedFile, mark_and_replay};

fn main() {
    gsk_tests::install_texts();
    print_text(&describe().unwrap_or_else(|error| error));
}

fn describe() -> Result<String, String> {
    let files = given_files()?;
    if files.is_empty() {
        return trace_session(&[]).map(|trace| format!("{trace:?}\n"));
    }
    Ok(mark_and_replay(&files))
}

#[cfg(not(target_arch = "wasm32"))]
fn given_files() -> Result<Vec<NamedFile>, String> {
    let paths = std::env::args().skip(1).map(std::path::PathBuf::from);
    let files = paths.map(|path| {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let bytes = std::fs::read(&path).map_err(|error| format!("{}: {error}", path.display()))?;
        Ok((name.into_owned(), bytes))
    });
    files.collect()
}

#[cfg(not(target_arch = "wasm32"))]
fn print_text(text: &str) {
    print!("{text}");
}

#[cfg(target_arch = "wasm32")]
fn given_files() -> Result<Vec<NamedFile>, String> {
    let text = element("files").and_then(|element| element.text_content());
    let text = text.unwrap_or_default();
    let lines = text.lines().filter_map(|line| line.trim().split_once(' '));
    lines
        .map(|(name, digits)| {
            let bytes = bytes_from_hex(digits).ok_or_else(|| format!("{name}: not hexadecimal"))?;
            Ok((name.to_owned(), bytes))
        })
        .collect()
}

#[cfg(target_arch = "wasm32")]
fn bytes_from_hex(digits: &str) -> Option<Vec<u8>> {
    let pairs = digits.as_bytes().chunks(2);
    pairs
        .map(|pair| u8::from_str_radix(core::str::from_utf8(pair).ok()?, 16).ok())
        .collect()
}

#[cfg(target_arch = "wasm32")]
fn print_text(text: &str) {
    if let Some(element) = element("golden") {
        element.set_text_content(Some(text));
    }
}

#[cfg(target_arch = "wasm32")]
fn element(id: &str) -> Option<web_sys::Element> {
    let document = web_sys::window()?.document()?;
    document.get_element_by_id(id)
}
