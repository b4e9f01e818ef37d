//! Downloads of files from the page.

use std::io;
use std::path::{Path, PathBuf};

use js_sys::{Array, Uint8Array};
use wasm_bindgen::{JsCast, JsValue};
use web_sys::{Blob, HtmlAnchorElement, Url};

use crate::platform::PdfPrint;

/// Offers a file with these contents as a download; the browser reports a failure to the user.
pub fn download(path: &Path, bytes: &[u8]) {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    // The browser reports to the user what it refuses.
    let _ = hand_out(&name, bytes);
}

fn hand_out(name: &str, bytes: &[u8]) -> Result<(), JsValue> {
    let parts = Array::of1(&Uint8Array::from(bytes));
    let blob = Blob::new_with_u8_array_sequence(&parts)?;
    let address = Url::create_object_url_with_blob(&blob)?;
    let document = web_sys::window().and_then(|window| window.document());
    let document = document.ok_or(JsValue::NULL)?;
    let link = document
        .create_element("a")?
        .dyn_into::<HtmlAnchorElement>()?;
    link.set_href(&address);
    link.set_download(name);
    // The address stays valid: a browser may read it much later.
    link.click();
    Ok(())
}

/// Offers a page as a download, which the browser opens. Returns its name.
///
/// # Errors
/// Never.
pub fn open_page_file(name: &str, page: &[u8]) -> io::Result<PathBuf> {
    let path = PathBuf::from(name);
    download(&path, page);
    Ok(path)
}

/// Prints nothing: a page starts no program.
///
/// # Errors
/// Never.
pub const fn print_page_as_pdf(_page: &[u8], _target: &Path) -> io::Result<PdfPrint> {
    Ok(PdfPrint::NoBrowser)
}
