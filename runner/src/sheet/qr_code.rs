//! A QR code as SVG.

use core::fmt::Write;

use qrcodegen::{QrCode, QrCodeEcc};

/// Width of the light border around the QR code, modules.
const BORDER: i32 = 4;

/// The QR code of a text; `None` for a text that is too long for one.
pub(super) fn render_code(text: &str) -> Option<String> {
    let code = QrCode::encode_text(text, QrCodeEcc::Medium).ok()?;
    let size = code.size();
    let whole = size + 2 * BORDER;
    let mut out = format!(
        "<svg class=\"qr\" viewBox=\"0 0 {whole} {whole}\" shape-rendering=\"crispEdges\">\
         <rect width=\"{whole}\" height=\"{whole}\" fill=\"#fff\"/><path d=\""
    );
    for y in 0..size {
        for x in (0..size).filter(|x| code.get_module(*x, y)) {
            let _ = write!(out, "M{},{}h1v1h-1z", x + BORDER, y + BORDER);
        }
    }
    out.push_str("\"/></svg>");
    Some(out)
}
