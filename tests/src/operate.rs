//! Runs cases with an operator script.

use std::path::Path;

use gsk_messages::{Message, say};
use gsk_panel::emulator::Emulator;
use gsk_panel::panel::SerialFile;
use gsk_panel::script::Script;
use gsk_runner::partner::{Partner, TextPartner};
use gsk_runner::picture::PictureError;
use gsk_runner::script::{ScriptEnd, Session, Surroundings};

use crate::case::Case;
use crate::picture;

const SCREEN: &str = "screen.txt";
const SENT: &str = "sent.txt";
const PICTURE: &str = "screen.png";

/// Runs the script and compares the LCD at its end, as text and as a picture.
pub(crate) fn run(case: &Case, folder: &Path, name: &str, update: bool) -> Result<(), String> {
    let text = crate::read(folder, name)?;
    let script = Script::parse(&text).map_err(|errors| {
        let lines: Vec<String> = errors
            .iter()
            .map(|error| format!("{name}: {error}"))
            .collect();
        lines.join("\n")
    })?;
    let mut emulator = Emulator::new(case.setup.at_the_panel()?);
    emulator.panel.connect(case.partner);
    let mut files = Files { folder };
    let end = Session::new(&mut emulator, &mut files).run(script);
    if let ScriptEnd::Failed(failure) = end {
        return Err(format!("{name}: {failure}\n{}", screen_text(&emulator)));
    }
    compare_sent(folder, &mut emulator, update)?;
    compare_text(folder, &emulator, update)?;
    compare_picture(folder, &emulator, update)
}

/// The files of a case, by the names in its script.
struct Files<'a> {
    folder: &'a Path,
}

impl Files<'_> {
    fn file(&self, name: &str) -> Result<SerialFile, String> {
        Ok(SerialFile {
            name: name.to_owned(),
            text: crate::read(self.folder, name)?,
        })
    }
}

impl Surroundings for Files<'_> {
    type Error = Message;

    fn show(&mut self, screen: &str) {
        println!("{screen}");
    }

    fn shot(
        &mut self,
        _name: &str,
        _bytes: &dyn Fn() -> Result<Vec<u8>, PictureError>,
    ) -> Result<(), Message> {
        Ok(())
    }

    fn program(&mut self, name: &str) -> Result<SerialFile, Message> {
        self.file(name).map_err(say::as_written)
    }

    fn transfer(&mut self, name: &str) -> Result<SerialFile, Message> {
        self.file(name).map_err(say::as_written)
    }

    fn told(&mut self, said: &Message) {
        println!("{said}");
    }

    fn partner(&mut self, name: &str) -> Result<Box<dyn Partner>, Message> {
        Ok(Box::new(TextPartner::new(self.program(name)?.text)))
    }
}

/// Compares the files that the partner at the serial port received, in their order. A last
/// line `…` matches everything that follows.
fn compare_sent(folder: &Path, emulator: &mut Emulator, update: bool) -> Result<(), String> {
    let Some(expected) = crate::read_if_there(folder, SENT)? else {
        return Ok(());
    };
    let files = emulator.panel.take_sent().into_iter();
    let seen: String = files
        .map(|file| format!("== {}\n{}", file.name, file.text))
        .collect();
    let begins = expected.strip_suffix("…\n");
    if seen == expected || begins.is_some_and(|begin| seen.starts_with(begin)) {
        return Ok(());
    }
    if update {
        return crate::write(folder, SENT, &seen);
    }
    Err(format!("{SENT} differs, sent was\n{seen}"))
}

fn compare_text(folder: &Path, emulator: &Emulator, update: bool) -> Result<(), String> {
    let Some(expected) = crate::read_if_there(folder, SCREEN)? else {
        return Ok(());
    };
    let seen = screen_text(emulator);
    if seen == expected {
        return Ok(());
    }
    if update {
        return crate::write(folder, SCREEN, &seen);
    }
    let mut lines = vec![format!("{SCREEN} differs:")];
    for (row, (expected, seen)) in padded(&expected).zip(padded(&seen)).take(15).enumerate() {
        if expected != seen {
            lines.push(format!("R{row:<2} expected |{expected}"));
            lines.push(format!("    seen     |{seen}"));
        }
    }
    Err(lines.join("\n"))
}

/// The picture shows more than the text: character styles, large figures, the graphic.
fn compare_picture(folder: &Path, emulator: &Emulator, update: bool) -> Result<(), String> {
    let path = folder.join(PICTURE);
    if !path.exists() {
        return Ok(());
    }
    let wrong = |error: std::io::Error| format!("{PICTURE}: {error}");
    let stored = std::fs::read(&path).map_err(wrong)?;
    let (screen, brightness) = (emulator.screen(), emulator.panel.view().brightness);
    if picture::shows(&stored, &screen, brightness) {
        return Ok(());
    }
    if update {
        let file = picture::encode(&screen, brightness)?;
        return std::fs::write(&path, file).map_err(wrong);
    }
    Err(format!("{PICTURE} differs from what the LCD shows"))
}

fn padded(text: &str) -> impl Iterator<Item = &str> {
    text.lines().chain(core::iter::repeat(""))
}

/// The LCD as 15 lines without trailing spaces.
fn screen_text(emulator: &Emulator) -> String {
    let screen = emulator.screen().text();
    screen
        .lines()
        .map(|line| format!("{}\n", line.trim_end()))
        .collect()
}
