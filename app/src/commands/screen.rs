//! `screen`: prints or draws one page of the LCD.

use gsk_core::setup::Setup;
use gsk_messages::{Language, say};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::pages::PAGES;
use gsk_runner::picture;

use super::{CommandError, EXIT_OK, output};
use crate::cli::ScreenArgs;
use crate::picture::check_png;

/// Limit of the machine time that the self-test picture may take after power-on, ms.
const MAX_SELF_TEST_MS: u64 = 10_000;

pub fn screen(args: &ScreenArgs) -> Result<u8, CommandError> {
    if args.list {
        let mut out = String::new();
        for row in &PAGES {
            let title = row.page.title().text(Language::Zh);
            out.push_str(&format!("{:<12} {title}\n", row.name));
        }
        output::print(&out);
        return Ok(EXIT_OK);
    }
    if let Some(path) = &args.output {
        check_png(path)?;
    }
    let name = args.page.as_deref().unwrap_or_default();
    let Some(row) = PAGES.iter().find(|row| row.name.eq_ignore_ascii_case(name)) else {
        let names: Vec<&str> = PAGES.iter().map(|row| row.name).collect();
        return Err(say::command_no_page(name, names.join(" ")).into());
    };
    let mut emulator = Emulator::new(Setup::default());
    emulator.run_until(&WaitCondition::SelfTestOver, MAX_SELF_TEST_MS);
    emulator.show_page(row.page);
    let screen = emulator.screen();
    let Some(path) = &args.output else {
        output::print(&format!("{screen}\n"));
        return Ok(EXIT_OK);
    };
    let bytes = picture::encode_lcd(&screen, emulator.panel().view().brightness)?;
    std::fs::write(path, bytes).map_err(|error| output::WriteError::new(path, error))?;
    Ok(EXIT_OK)
}
