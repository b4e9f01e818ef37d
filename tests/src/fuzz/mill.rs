//! Any text as a program of the mill: read, carried out, its moves held together.

use std::cell::Cell;
use std::time::Instant;

use gsk_core::model::{ControlModel, ModelId};
use gsk_milling::{MillSetup, Move, preview_while};

use super::{settings, watch};

/// Moves after which a program is given up; it may never end.
const MOVES: u64 = 20_000;
/// Blocks without any.
const MOTIONLESS: u64 = 20_000;
/// How far a move may begin from the end of the one before it, mm.
const APART: f64 = 1e-9;

pub(super) fn run(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let setup = settings::setup(&text);
    let mut model = ControlModel::new(ModelId::Gsk980mdi);
    for (number, value) in settings::numbers(&text) {
        // A setting that is refused is a setting that is not made.
        let _ = model.set_parameter(number, value);
    }
    let mut mill = MillSetup::default().with(&model);
    for offset in ["1=80,5", "2=110.5,3,0,-0.02", "3=60,12"] {
        let _ = mill.memory.take_offset(offset);
    }
    let mut last: Option<Move> = None;
    // Moves of one source are those of a block, and of the blocks between two questions at
    // most.
    let begun = Cell::new(Instant::now());
    let mut source = None;
    let mut take = |made: &Move| {
        if source != Some(made.source) {
            source = Some(made.source);
            watch::took(begun.replace(Instant::now()).elapsed());
        }
        watch::seen("move", made.kind.name());
        assert!(made.duration_s >= 0.0 && made.duration_s.is_finite());
        if let Some(last) = &last {
            let apart = (made.from + made.zero - last.to - last.zero).mm();
            // A length offset that comes into force shifts Z alone.
            let beside = apart[0].hypot(apart[1]);
            assert!(beside < APART, "{last:?} {made:?}");
        }
        last = Some(*made);
    };
    let programs = &setup.memory.programs;
    let preview = preview_while(&mill, programs, &mut take, &mut |progress| {
        watch::took(begun.replace(Instant::now()).elapsed());
        progress.moves < MOVES && progress.motionless < MOTIONLESS
    });
    watch::took(begun.get().elapsed());
    assert!(preview.time_s.is_finite() && preview.cutting_s <= preview.time_s + APART);
    for alarm in preview.alarm.iter().chain(&preview.further) {
        watch::seen("alarm", (alarm.number, watch::rule(&alarm.line_text())));
    }
    watch::seen("blocks", watch::roughly(preview.blocks));
}
