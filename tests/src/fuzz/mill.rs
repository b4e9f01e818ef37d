//! Fuzzes the mill with any text as a program: it is interpreted, and its moves are checked
//! for continuity.

use std::time::Instant;

use gsk_core::model::{ControlModel, ModelId};
use gsk_milling::{MillMove, MillSetup, preview_while};

use super::{settings, watch};

/// Number of moves after which a program is cancelled, because it may never end.
const MAX_MOVES: u64 = 20_000;
/// Number of blocks without motion after which a program is cancelled.
const MAX_MOTIONLESS_BLOCKS: u64 = 20_000;
/// Greatest number of blocks whose duration is measured as one unit.
const MAX_SHARED_BLOCKS: u64 = 20;
/// Greatest distance of a move's start from the end of the move before, mm.
const MAX_GAP_MM: f64 = 1e-9;

pub(super) fn fuzz_mill(input: &[u8]) {
    let text = String::from_utf8_lossy(input);
    let setup = settings::setup_from_input(&text);
    let mut model = ControlModel::new(ModelId::Gsk980mdi);
    for (number, value) in settings::numeric_settings(&text) {
        // A refused setting is not made.
        let _ = model.set_parameter(number, value);
    }
    let mut mill = MillSetup::default().with(&model);
    for offset in ["1=80,5", "2=110.5,3,0,-0.02", "3=60,12"] {
        let _ = mill.memory.take_offset(offset);
    }
    let mut last: Option<MillMove> = None;
    let mut on_move = |made: &MillMove| {
        watch::record_event("move", made.kind.name());
        assert!(made.duration_s >= 0.0 && made.duration_s.is_finite());
        if let Some(last) = &last {
            let apart = (made.from + made.zero - last.to - last.zero).mm();
            // A length offset that comes into force shifts Z alone.
            let beside = apart[0].hypot(apart[1]);
            assert!(beside < MAX_GAP_MM, "{last:?} {made:?}");
        }
        last = Some(*made);
    };
    let programs = &setup.memory.programs;
    // The program cannot be cancelled between two progress callbacks. The time between them is
    // that of a block, or of a hole in it. For many blocks at once their share counts.
    let mut last_progress = (Instant::now(), 0);
    let mut on_progress = |blocks: u64| {
        let share = blocks
            .saturating_sub(last_progress.1)
            .clamp(1, MAX_SHARED_BLOCKS);
        watch::record_duration(last_progress.0.elapsed() / share as u32);
        last_progress = (Instant::now(), blocks);
    };
    let preview = preview_while(&mill, programs, &mut on_move, &mut |progress| {
        on_progress(progress.blocks);
        progress.moves < MAX_MOVES && progress.motionless < MAX_MOTIONLESS_BLOCKS
    });
    on_progress(preview.blocks);
    assert!(preview.time_s.is_finite() && preview.cutting_s <= preview.time_s + MAX_GAP_MM);
    for alarm in preview.alarm.iter().chain(&preview.further) {
        watch::record_event(
            "alarm",
            (alarm.number, watch::message_rule(&alarm.line_text())),
        );
    }
    watch::record_event("blocks", watch::order_of_magnitude(preview.blocks));
}
