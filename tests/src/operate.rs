//! Runs cases with an operator script.

use std::path::Path;

use gsk_messages::{Language, Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::{SerialCable, SerialFile};
use gsk_panel::script::Script;
use gsk_panel::why::CauseChain;
use gsk_runner::partner::{ProgramPartner, TextPartner};
use gsk_runner::script::{ScriptEnd, ScriptHost, ScriptPicture, ScriptSession};

use crate::case::TestCase;
use crate::picture;

const SCREEN_FILE: &str = "screen.txt";
const SENT_FILE: &str = "sent.txt";
const PICTURE_FILE: &str = "screen.png";

/// Runs the operator script of a case, and compares the LCD at its end, as text and as a
/// picture.
pub(crate) fn run_script_case(
    case: &TestCase,
    folder: &Path,
    name: &str,
    update: bool,
) -> Result<(), String> {
    let text = crate::read_case_file(folder, name)?;
    let script = Script::parse(&text).map_err(|errors| {
        let lines: Vec<String> = errors
            .iter()
            .map(|error| format!("{name}: {error}"))
            .collect();
        lines.join("\n")
    })?;
    let mut emulator = Emulator::new(case.setup.script_setup()?);
    if case.partner {
        emulator.connect_cable(SerialCable::Simulated);
    }
    let mut files = CaseFiles { folder };
    let end = ScriptSession::new(&mut emulator, &mut files).run(script);
    if let ScriptEnd::Failed(failure) = end {
        return Err(format!("{name}: {failure}\n{}", screen_text(&emulator)));
    }
    compare_sent(folder, &mut emulator, update)?;
    compare_text(folder, &emulator, update)?;
    compare_picture(folder, &emulator, update)
}

/// Gives a script access to the files in the folder of its case.
struct CaseFiles<'a> {
    folder: &'a Path,
}

impl CaseFiles<'_> {
    fn read(&self, name: &str) -> Result<SerialFile, String> {
        Ok(SerialFile {
            name: name.to_owned(),
            text: crate::read_case_file(self.folder, name)?,
        })
    }
}

impl ScriptHost for CaseFiles<'_> {
    type Error = Message;

    fn show_chain(&mut self, chain: &CauseChain) {
        println!("{}", chain.text(Language::En));
    }

    fn show_screen(&mut self, screen: &str) {
        println!("{screen}");
    }

    fn store_picture(
        &mut self,
        _name: &str,
        _picture: ScriptPicture,
        _emulator: &Emulator,
    ) -> Result<(), Message> {
        Ok(())
    }

    fn read_program(&mut self, name: &str) -> Result<SerialFile, Message> {
        self.read(name).map_err(say::as_written)
    }

    fn read_transfer_file(&mut self, name: &str) -> Result<SerialFile, Message> {
        self.read(name).map_err(say::as_written)
    }

    fn show_refusal(&mut self, message: &Message) {
        println!("{message}");
    }

    fn open_partner(&mut self, name: &str) -> Result<Box<dyn ProgramPartner>, Message> {
        Ok(Box::new(TextPartner::new(self.read_program(name)?.text)))
    }
}

/// Compares the files that the partner at the serial port has received with the expected ones,
/// in their order. A last line `…` in the expectation matches everything that follows.
fn compare_sent(folder: &Path, emulator: &mut Emulator, update: bool) -> Result<(), String> {
    let Some(expected) = crate::read_optional_file(folder, SENT_FILE)? else {
        return Ok(());
    };
    let files = emulator.take_sent().into_iter();
    let seen: String = files
        .map(|file| format!("== {}\n{}", file.name, file.text))
        .collect();
    let begins = expected.strip_suffix("…\n");
    if seen == expected || begins.is_some_and(|begin| seen.starts_with(begin)) {
        return Ok(());
    }
    if update {
        return crate::write_expectation(folder, SENT_FILE, &seen);
    }
    Err(format!("{SENT_FILE} differs, sent was\n{seen}"))
}

fn compare_text(folder: &Path, emulator: &Emulator, update: bool) -> Result<(), String> {
    let Some(expected) = crate::read_optional_file(folder, SCREEN_FILE)? else {
        return Ok(());
    };
    let seen = screen_text(emulator);
    if seen == expected {
        return Ok(());
    }
    if update {
        return crate::write_expectation(folder, SCREEN_FILE, &seen);
    }
    let mut lines = vec![format!("{SCREEN_FILE} differs:")];
    for (row, (expected, seen)) in screen_lines(&expected)
        .zip(screen_lines(&seen))
        .take(15)
        .enumerate()
    {
        if expected != seen {
            lines.push(format!("R{row:<2} expected |{expected}"));
            lines.push(format!("    seen     |{seen}"));
        }
    }
    Err(lines.join("\n"))
}

/// Compares the LCD with the picture of the case, if there is one. The picture shows more than
/// the text: character styles, large figures, the graphic.
fn compare_picture(folder: &Path, emulator: &Emulator, update: bool) -> Result<(), String> {
    let path = folder.join(PICTURE_FILE);
    if !path.exists() {
        return Ok(());
    }
    let file_error = |error: std::io::Error| format!("{PICTURE_FILE}: {error}");
    let stored = std::fs::read(&path).map_err(file_error)?;
    let (screen, brightness) = (emulator.screen(), emulator.panel().view().brightness);
    if picture::is_same_picture(&stored, &screen, brightness) {
        return Ok(());
    }
    if update {
        let file = picture::encode(&screen, brightness)?;
        return std::fs::write(&path, file).map_err(file_error);
    }
    Err(format!("{PICTURE_FILE} differs from what the LCD shows"))
}

fn screen_lines(text: &str) -> impl Iterator<Item = &str> {
    text.lines().chain(core::iter::repeat(""))
}

/// Returns the text of the LCD as 15 lines without trailing spaces.
fn screen_text(emulator: &Emulator) -> String {
    let screen = emulator.screen().text();
    screen
        .lines()
        .map(|line| format!("{}\n", line.trim_end()))
        .collect()
}
