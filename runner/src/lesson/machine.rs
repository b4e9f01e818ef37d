//! Makes the practice machine of a lesson: a control in its delivery state, with the settings
//! of the lesson. It contains nothing of the learner's own memory.

use gsk_core::command::ProgramId;
use gsk_core::memory::ToolOffset;
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::{Diameter, Point};
use gsk_messages::{Message, say};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::pages::POWER_ON_TICKS;
use gsk_panel::script::{Runner, Script, ScriptAction, ScriptError, ScriptProgress};
use serde::Deserialize;

/// The largest coordinate of the control, mm.
const LARGEST: f64 = 9999.999;
/// Time limit of the preparation script, ms of machine time.
const LONGEST: u64 = 600_000;

/// The field `begins`, as written in the file.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct BeginsFile {
    /// Whether both axes are referenced.
    referenced: bool,
    /// Position of the slides: X as a diameter and Z, machine coordinates.
    slides: Option<(f64, f64)>,
    /// Displayed absolute position at that point: X as a diameter and Z.
    absolute: Option<(f64, f64)>,
    /// Parameters: `"22=3800"`, `"1.4=0"`.
    params: Vec<String>,
    /// Offsets: `"1=X,Z,R,T"`.
    offsets: Vec<String>,
    /// Programs; the first is selected.
    programs: Vec<String>,
    /// Whether the learner sees the power-on picture.
    picture: bool,
    /// An operator script that runs before the first step.
    before: Vec<String>,
}

/// The initial state of the practice machine of a lesson.
#[derive(Clone, Debug)]
pub struct Begins {
    setup: Setup,
    picture: bool,
    before: Script,
}

impl Begins {
    pub(super) fn read(raw: BeginsFile) -> Result<Self, Message> {
        let mut setup = Setup::delivered().with_chuck();
        setup.referenced = raw.referenced;
        let point = |(x, z): (f64, f64)| Point::from_diameter(Diameter(x), z);
        let places = raw.slides.iter().chain(&raw.absolute);
        for value in places.flat_map(|(x, z)| [*x, *z]) {
            if !value.is_finite() || value.abs() > LARGEST {
                return Err(say::lesson_beyond(value, LARGEST));
            }
        }
        setup.start = Some(raw.slides.map_or_else(|| setup.lathe.start(), point));
        setup.absolute = raw.absolute.map(point);
        if let Some((_, ends)) = setup.beyond_ends().first() {
            return Err(say::lesson_slides_beyond(ends.minus, ends.plus));
        }
        for word in &raw.params {
            parameter(&mut setup, word)?;
        }
        for word in &raw.offsets {
            offset(&mut setup, word)?;
        }
        let mut first = None;
        for text in raw.programs {
            if Program::new(text.as_str()).number().is_none() {
                return Err(say::lesson_program_without_number());
            }
            let stored = setup.memory.programs.store(text);
            let number = stored.map_err(|alarm| alarm.reason())?;
            first.get_or_insert(number);
        }
        if let Some(number) = first {
            setup.memory.programs.select(ProgramId::Stored(number));
        }
        let before = Script::parse(&raw.before.join("\n"))
            .map_err(|errors| say::several(errors.iter().map(ScriptError::message)))?;
        let needs_files = |action: &ScriptAction| {
            matches!(
                action,
                ScriptAction::Load(_)
                    | ScriptAction::Receive(_)
                    | ScriptAction::Dnc(_)
                    | ScriptAction::Show
                    | ScriptAction::Shot { .. }
            )
        };
        if let Some(line) = before.lines.iter().find(|line| needs_files(&line.action)) {
            return Err(say::in_line(line.number, say::lesson_no_files(&line.text)));
        }
        if raw.picture && !before.lines.is_empty() {
            return Err(say::lesson_picture_or_before());
        }
        Ok(Self {
            setup,
            picture: raw.picture,
            before,
        })
    }

    /// Creates the machine and runs the preparation script on it, so that it is ready for the
    /// first step.
    ///
    /// # Errors
    /// The preparation script fails or takes too long.
    pub fn machine(&self) -> Result<Emulator, Message> {
        let mut emulator = Emulator::new(self.setup.clone());
        if self.picture {
            return Ok(emulator);
        }
        emulator.run_until(&WaitCondition::SelfTestOver, POWER_ON_TICKS + 1000);
        let mut runner = Runner::new(self.before.clone());
        match runner.advance(&mut emulator, LONGEST) {
            ScriptProgress::Finished => Ok(emulator),
            ScriptProgress::Failed(failure) => Err(failure.message()),
            ScriptProgress::Running | ScriptProgress::Effect(_) => {
                Err(say::lesson_before_too_long())
            }
        }
    }
}

fn parts(word: &str) -> Result<(&str, &str), Message> {
    word.split_once('=').ok_or_else(|| say::lesson_word(word))
}

fn number<T: core::str::FromStr>(text: &str, word: &str) -> Result<T, Message> {
    text.trim().parse().map_err(|_| say::lesson_word(word))
}

fn parameter(setup: &mut Setup, word: &str) -> Result<(), Message> {
    let (name, value) = parts(word)?;
    let parameters = &mut setup.memory.parameters;
    let set = match name.split_once('.') {
        Some((name, bit)) => {
            let on = number::<u8>(value, word)? == 1;
            parameters.set_bit(number(name, word)?, number(bit, word)?, on)
        }
        None => parameters.set(number(name, word)?, number(value, word)?),
    };
    set.map_err(|error| say::subject_reason(word, error.message()))
}

fn offset(setup: &mut Setup, word: &str) -> Result<(), Message> {
    let (name, values) = parts(word)?;
    let values = values.split(',').map(|value| number::<f64>(value, word));
    let values = values.collect::<Result<Vec<_>, _>>()?;
    if values.len() > 4 || values.iter().any(|value| !value.is_finite()) {
        return Err(say::lesson_word(word));
    }
    let value = |index: usize| values.get(index).copied().unwrap_or_default();
    let row = ToolOffset {
        x: value(0),
        z: value(1),
        r: value(2),
        t: value(3) as u8,
    };
    let set = setup.memory.offsets.set(number(name, word)?, row);
    set.map_err(|alarm| say::subject_reason(word, alarm.reason()))
}
