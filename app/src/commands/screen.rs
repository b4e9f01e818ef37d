//! `screen`: prints or draws one page of the LCD.

use gsk_core::model::ControlModel;
use gsk_core::setup::Setup;
use gsk_messages::{Language, say};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::face::face_of;

use super::{CommandError, EXIT_OK, output};
use crate::cli::ScreenArgs;
use crate::picture::check_png;

/// Limit of the machine time that the self-test picture may take after power-on, ms.
const MAX_SELF_TEST_MS: u64 = 10_000;

pub fn screen(args: &ScreenArgs) -> Result<u8, CommandError> {
    let face = face_of(args.model);
    if args.list {
        let mut out = String::new();
        for row in face.pages {
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
    let Some(row) = face.page_named(name) else {
        let names: Vec<&str> = face.pages.iter().map(|row| row.name).collect();
        return Err(say::command_no_page(name, names.join(" ")).into());
    };
    let mut setup = Setup::default();
    setup.memory.model = ControlModel::new(args.model);
    let mut emulator = Emulator::new(setup);
    emulator.run_until(&WaitCondition::SelfTestOver, MAX_SELF_TEST_MS);
    emulator.show_page(row.page);
    let screen = emulator.screen();
    let Some(path) = &args.output else {
        output::print(&format!("{screen}\n"));
        return Ok(EXIT_OK);
    };
    let bytes = gsk_plot::encode_lcd(&screen, emulator.panel().view().brightness)?;
    std::fs::write(path, bytes).map_err(|error| output::WriteError::new(path, error))?;
    Ok(EXIT_OK)
}
