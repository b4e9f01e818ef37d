//! Makes the practice machine of a lesson: a control in its delivery state, with the settings
//! of the lesson. It contains nothing of the learner's own memory.

use gsk_core::command::ProgramId;
use gsk_core::machine::LoadLimits;
use gsk_core::memory::ToolOffset;
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_core::units::{Diameter, Point};
use gsk_messages::{Message, say};
use gsk_panel::emulator::{Emulator, WaitCondition};
use gsk_panel::pages::POWER_ON_TICKS;
use gsk_panel::script::{Runner, Script, ScriptAction, ScriptError, ScriptProgress};
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::stock::Stock;
use gsk_workpiece::tool::Tool;
use serde::Deserialize;

/// The largest coordinate of the control, mm.
const MAX_COORDINATE_MM: f64 = 9999.999;
/// Time limit of the preparation script, ms of machine time.
const MAX_PREPARATION_MS: u64 = 600_000;

/// The initial state of a lesson (field `begins`), as written in the lesson file.
#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct LessonStartFile {
    /// Control model of the practice machine, by its word on the command line; `None` for the
    /// GSK980TD.
    model: Option<String>,
    /// Whether both axes are referenced.
    referenced: bool,
    /// Position of the slides: X as a diameter and Z, machine coordinates, mm; `None` for the usual
    /// one.
    slides: Option<(f64, f64)>,
    /// Absolute position that the display shows at `slides`: X as a diameter and Z, mm; `None` for
    /// the usual one.
    absolute: Option<(f64, f64)>,
    /// Parameter settings: `"22=3800"` for a number, `"1.4=0"` for bit 4 of parameter 1.
    params: Vec<String>,
    /// Tool offset settings: `"1=X,Z,R,T"`.
    offsets: Vec<String>,
    /// Texts of the programs in the memory; the first is selected.
    programs: Vec<String>,
    /// What spindle, chuck and bars bear, and whether a cut above it breaks something, as in a
    /// machine file.
    load: LoadLimits,
    /// Whether the machine begins with the power-on picture.
    picture: bool,
    /// Operator script, line by line, that prepares the machine before the first step.
    before: Vec<String>,
}

/// The initial state of the practice machine of a lesson.
#[derive(Clone, Debug)]
pub struct LessonStart {
    setup: Setup,
    shows_power_on_picture: bool,
    preparation: Script,
}

impl LessonStart {
    /// Checks the initial state and creates it.
    ///
    /// # Errors
    /// The rule that is broken.
    pub fn read(raw: LessonStartFile) -> Result<Self, Message> {
        let mut setup = Setup::delivered().with_chuck();
        if let Some(word) = &raw.model {
            let id = ModelId::from_command_word(word).filter(|id| !id.is_mill());
            let id = id.ok_or_else(|| say::lesson_unknown_model(word))?;
            setup.memory.set_model(ControlModel::new(id));
        }
        setup.referenced = raw.referenced;
        setup.lathe.load = raw.load;
        if let Err(errors) = setup.lathe.check()
            && let Some(error) = errors.into_iter().next()
        {
            return Err(say::subject_reason(error.field, error.rule));
        }
        let point = |(x, z): (f64, f64)| Point::from_diameter(Diameter(x), z);
        let positions = raw.slides.iter().chain(&raw.absolute);
        for value in positions.flat_map(|(x, z)| [*x, *z]) {
            if !value.is_finite() || value.abs() > MAX_COORDINATE_MM {
                return Err(say::lesson_beyond(value, MAX_COORDINATE_MM));
            }
        }
        setup.start = Some(raw.slides.map_or_else(|| setup.lathe.start(), point));
        setup.absolute = raw.absolute.map(point);
        if let Some((_, ends)) = setup.axes_beyond_ends().first() {
            return Err(say::lesson_slides_beyond(ends.minus, ends.plus));
        }
        for word in &raw.params {
            set_parameter(&mut setup, word)?;
        }
        for word in &raw.offsets {
            set_offset(&mut setup, word)?;
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
                    | ScriptAction::Udisk(_)
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
            shows_power_on_picture: raw.picture,
            preparation: before,
        })
    }

    /// Control model of the practice machine.
    pub const fn model(&self) -> ModelId {
        self.setup.memory.model.id()
    }

    /// Whether a cut above the limits breaks something.
    pub(crate) const fn has_load_events(&self) -> bool {
        self.setup.lathe.load.events
    }

    /// Position of the slides, machine coordinates, at which the tip of a tool of length 0 is at
    /// the zero of the part. The absolute position that the lesson begins with is true; without
    /// one the tip begins at X 100 Z 100.
    pub(crate) fn part_zero(&self) -> DiameterPoint {
        let tip = Point::from_diameter(Diameter(100.0), 100.0);
        let slides = self.setup.start.unwrap_or_default();
        (slides - self.setup.absolute.unwrap_or(tip)).into()
    }

    /// Creates the machine and runs the preparation script on it, so that it is ready for the
    /// first step.
    ///
    /// # Errors
    /// The preparation script fails or takes too long.
    pub fn create_machine(&self) -> Result<Emulator, Message> {
        let mut emulator = Emulator::new(self.setup.clone());
        if self.shows_power_on_picture {
            return Ok(emulator);
        }
        emulator.run_until(&WaitCondition::SelfTestOver, POWER_ON_TICKS + 1000);
        let mut runner = Runner::new(self.preparation.clone());
        match runner.advance(&mut emulator, MAX_PREPARATION_MS) {
            ScriptProgress::Finished => Ok(emulator),
            ScriptProgress::Failed(failure) => Err(failure.message()),
            ScriptProgress::Running | ScriptProgress::Effect(_) => {
                Err(say::lesson_before_too_long())
            }
        }
    }
}

/// Creates the stock and tools of a lesson that names no job: a bar and four tools.
pub(crate) fn usual_job() -> Job {
    let mut job = Job::new(Stock::bar(50.0, 0.0, 60.0));
    let tools = [
        Tool::turning(),
        Tool::grooving(3.0),
        Tool::threading(60.0),
        Tool::boring(),
    ];
    job.tools = (1..).zip(tools).collect();
    job
}

fn split_assignment(word: &str) -> Result<(&str, &str), Message> {
    word.split_once('=').ok_or_else(|| say::lesson_word(word))
}

fn parse_number<T: core::str::FromStr>(text: &str, word: &str) -> Result<T, Message> {
    text.trim().parse().map_err(|_| say::lesson_word(word))
}

fn set_parameter(setup: &mut Setup, word: &str) -> Result<(), Message> {
    let (name, value) = split_assignment(word)?;
    let parameters = &mut setup.memory.parameters;
    let set = match name.split_once('.') {
        Some((name, bit)) => {
            let on = parse_number::<u8>(value, word)? == 1;
            parameters.set_bit(parse_number(name, word)?, parse_number(bit, word)?, on)
        }
        None => parameters.set(parse_number(name, word)?, parse_number(value, word)?),
    };
    set.map_err(|error| say::subject_reason(word, error.message()))
}

fn set_offset(setup: &mut Setup, word: &str) -> Result<(), Message> {
    let (name, values) = split_assignment(word)?;
    let values = values
        .split(',')
        .map(|value| parse_number::<f64>(value, word));
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
    let set = setup.memory.offsets.set(parse_number(name, word)?, row);
    set.map_err(|alarm| say::subject_reason(word, alarm.reason()))
}
