//! The sample programs that the executable contains.

use std::path::Path;

use gsk_core::model::ModelId;
use gsk_core::program::{self, Program};

use gsk_host::job::{self, SelectedJob};
use gsk_host::kernel::{OpenedProgram, StorePolicy};
use gsk_messages::{Language, Message, say};

use crate::widgets::card::{CardPicture, SampleOutline};
use crate::widgets::icons::Icon;

#[derive(Debug)]
pub struct ProgramSample {
    /// Name of the sample's program file.
    pub name: &'static str,
    /// The control model for which the program is written.
    model: ModelId,
    /// Returns a description of what the sample demonstrates.
    description: fn() -> Message,
    text: &'static str,
    /// Text of its job file (stock and tools); `None` if it has none.
    job: Option<&'static str>,
    /// Texts of the subprograms that the sample calls.
    subprograms: &'static [&'static str],
}

/// A request of the operator to open a sample program.
#[derive(Clone, Copy, Debug)]
pub struct SampleRequest {
    /// The sample program that the operator has chosen.
    pub sample: &'static ProgramSample,
    /// Whether the lathe starts to cut the sample at once.
    pub starts: bool,
}

macro_rules! text {
    ($name:literal) => {
        include_str!(concat!("../../assets/programs/", $name))
    };
}

macro_rules! sample {
    (@job) => {
        None
    };
    (@job $job:literal) => {
        Some(text!($job))
    };
    (@model) => {
        ModelId::Gsk980td
    };
    (@model $model:ident) => {
        ModelId::$model
    };
    ($name:literal, $shows:ident $(, for $model:ident)? $(, job $job:literal)? $(, calls $called:literal)*) => {
        ProgramSample {
            name: $name,
            model: sample!(@model $($model)?),
            description: say::$shows,
            text: text!($name),
            job: sample!(@job $($job)?),
            subprograms: &[$(text!($called)),*],
        }
    };
}

/// The samples of all models in the order of the menu.
static SAMPLES: [ProgramSample; 11] = [
    sample!(
        "01-stepped-shaft.CNC",
        sample_stepped_shaft,
        job "01-stepped-shaft.job.ron"
    ),
    sample!("02-bushing.CNC", sample_bushing, job "02-bushing.job.ron"),
    sample!(
        "03-grooved-pin.CNC",
        sample_grooved_pin,
        job "03-grooved-pin.job.ron",
        calls "O1031.CNC"
    ),
    sample!(
        "04-manual-example.CNC",
        sample_manual_example,
        job "04-manual-example.job.ron"
    ),
    sample!("faulty/01-arc-too-small.CNC", sample_faulty_arc),
    sample!("faulty/02-no-feed.CNC", sample_faulty_no_feed),
    sample!(
        "faulty/03-missing-subprogram.CNC",
        sample_faulty_no_subprogram
    ),
    sample!(
        "ncb08/01-stepped-pin.CNC",
        sample_stepped_pin,
        for Ncb08,
        job "ncb08/01-stepped-pin.job.ron"
    ),
    sample!(
        "ncb08/02-outputs.CNC",
        sample_outputs,
        for Ncb08,
        job "ncb08/02-outputs.job.ron"
    ),
    sample!(
        "hx31/01-turned-pin.CNC",
        sample_turned_pin,
        for Hx31,
        job "hx31/01-turned-pin.job.ron"
    ),
    sample!(
        "hx31/02-grooves.CNC",
        sample_grooves,
        for Hx31,
        job "hx31/02-grooves.job.ron"
    ),
];

/// Outlines of the parts that the samples cut, by the file names of the samples.
static OUTLINES: [(&str, SampleOutline); 8] = [
    (
        "01-stepped-shaft.CNC",
        &[
            (0.0, 0.0),
            (0.0, 8.0),
            (2.0, 10.0),
            (20.0, 10.0),
            (35.0, 15.0),
            (50.0, 15.0),
            (55.0, 20.0),
            (59.0, 25.0),
            (72.0, 25.0),
            (72.0, 0.0),
        ],
    ),
    (
        "02-bushing.CNC",
        &[
            (0.0, 0.0),
            (0.0, 21.5),
            (1.0, 22.5),
            (25.0, 22.5),
            (25.0, 29.0),
            (36.0, 29.0),
            (36.0, 0.0),
        ],
    ),
    (
        "03-grooved-pin.CNC",
        &[
            (0.0, 0.0),
            (0.0, 14.0),
            (12.0, 14.0),
            (12.0, 11.0),
            (16.0, 11.0),
            (16.0, 14.0),
            (28.0, 14.0),
            (28.0, 11.0),
            (32.0, 11.0),
            (32.0, 14.0),
            (50.0, 14.0),
            (50.0, 0.0),
        ],
    ),
    (
        "04-manual-example.CNC",
        &[
            (0.0, 0.0),
            (0.0, 18.0),
            (2.0, 20.0),
            (34.0, 20.0),
            (34.0, 15.0),
            (40.0, 15.0),
            (40.0, 20.0),
            (60.0, 30.0),
            (90.0, 30.0),
            (90.0, 0.0),
        ],
    ),
    (
        "ncb08/01-stepped-pin.CNC",
        &[
            (0.0, 0.0),
            (0.0, 11.0),
            (1.0, 12.0),
            (30.0, 12.0),
            (30.0, 14.0),
            (30.6, 15.4),
            (32.0, 16.0),
            (45.0, 16.0),
            (45.0, 20.0),
            (56.0, 20.0),
            (56.0, 0.0),
        ],
    ),
    (
        "ncb08/02-outputs.CNC",
        &[
            (0.0, 0.0),
            (0.0, 11.0),
            (15.0, 11.0),
            (15.0, 13.0),
            (30.0, 13.0),
            (30.0, 15.0),
            (42.0, 15.0),
            (42.0, 0.0),
        ],
    ),
    (
        "hx31/01-turned-pin.CNC",
        &[
            (0.0, 0.0),
            (0.0, 13.0),
            (2.0, 15.0),
            (30.0, 15.0),
            (30.0, 20.0),
            (42.0, 20.0),
            (42.0, 0.0),
        ],
    ),
    (
        "hx31/02-grooves.CNC",
        &[
            (0.0, 0.0),
            (0.0, 20.0),
            (10.0, 20.0),
            (10.0, 16.0),
            (13.0, 16.0),
            (13.0, 20.0),
            (18.0, 20.0),
            (18.0, 16.0),
            (21.0, 16.0),
            (21.0, 20.0),
            (26.0, 20.0),
            (26.0, 16.0),
            (29.0, 16.0),
            (29.0, 20.0),
            (42.0, 20.0),
            (42.0, 0.0),
        ],
    ),
];

/// The samples of a control model, in the order of the menu.
pub fn samples_of(model: ModelId) -> impl Iterator<Item = &'static ProgramSample> {
    SAMPLES.iter().filter(move |sample| sample.model == model)
}

/// The samples of a control model that run to their end without an alarm.
pub fn good_samples(model: ModelId) -> impl Iterator<Item = &'static ProgramSample> {
    samples_of(model).filter(|sample| !sample.name.starts_with("faulty/"))
}

impl ProgramSample {
    /// Returns what the sample demonstrates, for the menu.
    pub fn description_text(&self, language: Language) -> String {
        (self.description)().text(language)
    }

    /// Returns the picture on the sample's card: the part that the sample cuts.
    pub fn picture(&self) -> CardPicture {
        let outline = OUTLINES.iter().find(|(name, _)| *name == self.name);
        outline.map_or(CardPicture::Icon(Icon::SAMPLE), |(_, outline)| {
            CardPicture::Part(outline)
        })
    }

    /// Converts the sample to a program that can be opened in the control.
    pub fn to_opened(&self) -> OpenedProgram {
        let called = self.subprograms.iter().map(|text| Program::new(*text));
        let mut parts = program::split_programs(self.text).into_iter();
        let program = parts.next();
        OpenedProgram {
            name: self.name.to_owned(),
            path: None,
            store_policy: StorePolicy::AskOperator,
            program: program.unwrap_or_else(|| Program::new(self.text)),
            subprograms: parts.chain(called).collect(),
        }
    }
}

/// Finds the job of the sample that has the same text as `program`; `None` for other programs.
pub fn job_of(program: &Program) -> Option<SelectedJob> {
    let is_same_text =
        |sample: &&ProgramSample| sample.to_opened().program.text() == program.text();
    let sample = SAMPLES.iter().find(is_same_text)?;
    let file = sample.name.replace(".CNC", ".job.ron");
    let job = job::parse(Path::new(&file), sample.job?).ok()?;
    Some(SelectedJob {
        job,
        file: Some(file.into()),
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    #[test]
    fn every_sample_of_the_folder_is_in_the_menu_with_a_unique_number() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../assets/programs");
        let mut files = BTreeSet::new();
        for place in ["", "faulty/", "ncb08/", "hx31/"] {
            for entry in std::fs::read_dir(folder.join(place)).unwrap() {
                let name = entry.unwrap().file_name().into_string().unwrap();
                if name.ends_with(".CNC") && !name.starts_with('O') {
                    files.insert(format!("{place}{name}"));
                }
            }
        }
        let names = SAMPLES.iter().map(|sample| sample.name.to_owned());
        assert_eq!(names.collect::<BTreeSet<_>>(), files);
        let numbers = SAMPLES.iter().map(|it| it.to_opened().program.number());
        let numbers: BTreeSet<_> = numbers.map(Option::unwrap).collect();
        assert_eq!(numbers.len(), SAMPLES.len());
        for model in [ModelId::Ncb08, ModelId::Hx31] {
            assert_eq!(samples_of(model).count(), 2, "{model:?}");
        }
        for sample in ModelId::ALL.into_iter().flat_map(good_samples) {
            let chosen = job_of(&sample.to_opened().program).unwrap();
            assert!(!chosen.job.tools.is_empty(), "{}", sample.name);
            let picture = sample.picture();
            assert!(matches!(picture, CardPicture::Part(_)), "{}", sample.name);
        }
        assert!(job_of(&Program::new("O0001\nM30\n")).is_none());
        let pin = SAMPLES[2].to_opened();
        assert_eq!(pin.subprograms[0].number(), Some(1031));
    }
}
