//! Fuzzes the mill with any text as a program: it is interpreted, and its moves are checked
//! for continuity.

use std::time::Instant;

use gsk_core::model::{ControlModel, ModelId};
use gsk_milling::{MillMove, MillSetup, preview_while};

use super::{settings, watch};

/// Number of moves after which a program is cancelled; it may never end.
const MOVES: u64 = 20_000;
/// Number of blocks without motion after which it is cancelled.
const MOTIONLESS: u64 = 20_000;
/// Greatest number of blocks that share one measured time.
const SHARES: u64 = 20;
/// Greatest distance of a move's start from the end of the move before, mm.
const APART: f64 = 1e-9;

pub(super) fn run(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let setup = settings::setup(&text);
    let mut model = ControlModel::new(ModelId::Gsk980mdi);
    for (number, value) in settings::numbers(&text) {
        // A refused setting is not made.
        let _ = model.set_parameter(number, value);
    }
    let mut mill = MillSetup::default().with(&model);
    for offset in ["1=80,5", "2=110.5,3,0,-0.02", "3=60,12"] {
        let _ = mill.memory.take_offset(offset);
    }
    let mut last: Option<MillMove> = None;
    let mut take = |made: &MillMove| {
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
    // The program cannot be cancelled between two progress callbacks. The time between them is
    // that of a block, or of a hole in it. For many blocks at once their share counts.
    let mut asked = (Instant::now(), 0);
    let mut note = |blocks: u64| {
        let share = blocks.saturating_sub(asked.1).clamp(1, SHARES);
        watch::took(asked.0.elapsed() / share as u32);
        asked = (Instant::now(), blocks);
    };
    let preview = preview_while(&mill, programs, &mut take, &mut |progress| {
        note(progress.blocks);
        progress.moves < MOVES && progress.motionless < MOTIONLESS
    });
    note(preview.blocks);
    assert!(preview.time_s.is_finite() && preview.cutting_s <= preview.time_s + APART);
    for alarm in preview.alarm.iter().chain(&preview.further) {
        watch::seen("alarm", (alarm.number, watch::rule(&alarm.line_text())));
    }
    watch::seen("blocks", watch::roughly(preview.blocks));
}
