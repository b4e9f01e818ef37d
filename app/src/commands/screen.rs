//! `screen`: one page of the LCD as text or picture.

use gsk_core::setup::Setup;
use gsk_panel::emulator::{Condition, Emulator};
use gsk_panel::pages::PAGES;
use gsk_panel::raster;

use super::{FINE, output};
use crate::cli::ScreenArgs;
use crate::picture;

/// Dots of the LCD are so many pixels wide.
const SCALE: u32 = 2;
/// The self-test picture is gone after this, ms.
const SELF_TEST_MS: u64 = 10_000;

/// Prints or draws a page.
pub fn screen(args: &ScreenArgs) -> Result<u8, String> {
    if args.list {
        let mut out = String::new();
        for row in &PAGES {
            out.push_str(&format!("{:<12} {}\n", row.name, row.title));
        }
        output::print(&out)?;
        return Ok(FINE);
    }
    let name = args.page.as_deref().unwrap_or_default();
    let Some(row) = PAGES.iter().find(|row| row.name.eq_ignore_ascii_case(name)) else {
        let names: Vec<&str> = PAGES.iter().map(|row| row.name).collect();
        return Err(format!(
            "there is no page `{name}`; the pages are: {}",
            names.join(" ")
        ));
    };
    let mut emulator = Emulator::new(Setup::default());
    emulator.run_until(&Condition::SelfTestOver, SELF_TEST_MS);
    emulator.panel.show(row.page);
    let screen = emulator.screen();
    let Some(path) = &args.output else {
        output::print(&format!("{screen}\n"))?;
        return Ok(FINE);
    };
    let picture = raster::render(&screen, SCALE, emulator.panel.view().brightness)
        .ok_or("no memory for the picture")?;
    let bytes = picture::encode_png(&picture)?;
    std::fs::write(path, bytes)
        .map_err(|error| format!("{} cannot be written: {error}", path.display()))?;
    Ok(FINE)
}
