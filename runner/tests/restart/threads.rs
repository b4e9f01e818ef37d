//! Restarts at every block of programs with threads, surface speed and feed per revolution: each
//! pass meets the groove of the uninterrupted run.

use gsk_core::command::ExecutedMove;
use gsk_core::units::Feed;
use gsk_messages::say;
use gsk_runner::restart::find_block;

use super::programs::TestProgram;
use super::{
    BlockNumber, Figures, HELIX_MM, Random, RecordedRun, SAME_MM, interrupted, restart,
    uninterrupted,
};

const fn program(name: &'static str, text: &'static str) -> TestProgram {
    TestProgram {
        name,
        text,
        subprograms: &[],
        macro_b: false,
    }
}

/// The control begins a thread with a tick: at these speeds a turn has a whole number of ticks, so
/// that all passes begin at the same angle.
const PROGRAMS: [TestProgram; 5] = [
    program(
        "G92, two starts, taper, inch",
        "G50 X100 Z100;\nG97 S1000 M03;\nT0101;\nG00 X32 Z5;\nG92 X29 Z-10 F1.5 L2;\nX28.6;\n\
         G00 X33;\nG92 X30 Z-8 R-1 F2;\nG00 X30;\nG92 X27 Z-6 I16;\nG00 X100 Z100;\nM30;\n",
    ),
    program(
        "G76",
        "G50 X100 Z100;\nG97 S800 M03;\nT0101;\nG00 X32 Z5;\nG76 P020060 Q100 R0.05;\n\
         G76 X28.4 Z-8 P800 Q300 F1.5;\nG00 X100 Z100;\nM05;\nM30;\n",
    ),
    program(
        "G34 and G32",
        "G50 X100 Z100;\nG97 S300 M04;\nT0101;\nG00 X28 Z5;\nG34 Z-6 F1.5 R0.1;\nG00 X40;\n\
         Z5;\nX27.5;\nG32 Z-4 F2;\nG32 X30 Z-8;\nG00 X40;\nG00 X100 Z100;\nM30;\n",
    ),
    program(
        "G96 G99",
        "G50 X120 Z100;\nG50 S1200;\nG96 S90 M03;\nG99 T0101;\nG00 X50 Z1;\nG01 X30 F0.3;\n\
         Z-6 F0.2;\nG02 X40 Z-11 R5;\nG00 X54 Z2;\nG96 S60;\nG90 X46 Z-8 F0.3;\nX44;\n\
         G00 X120 Z100;\nM30;\n",
    ),
    program(
        "G96 to a thread and back",
        "G50 X120 Z100;\nG50 S1500;\nG96 S100 M03;\nG99 T0303;\nG00 X40 Z2;\nG01 Z-6 F0.3;\n\
         G00 X44 Z4;\nG97 S750;\nG04 X2;\nG92 X39 Z-5 F1.5;\nX38.6;\nG96 S80;\nG00 X38 Z1;\n\
         G01 Z-3 F0.2;\nG98 G01 X42 F300;\nG00 X120 Z100;\nM30;\n",
    ),
];

const TAP: TestProgram = program(
    "G33",
    "G50 X100 Z100;\nG97 S300 M03;\nT0202;\nG00 X0 Z5;\nG33 Z-8 F1.5;\nM03;\nG04 X1;\n\
     G33 Z-10 F1.5;\nG00 X100 Z100;\nM30;\n",
);
/// A tap follows the spindle that the ladder stops: its end differs by the way in the three slots
/// that read and switch its M05, mm.
const TAP_REACH_MM: f64 = 1.5 * 300.0 / 60.0 * 0.025;

/// The angle of a helix in the middle of its way, in turns, with its lead, mm; `None` for a move that is no
/// thread of one lead along Z.
fn helix(run: &RecordedRun, number: usize) -> Option<(f64, f64)> {
    let executed: &ExecutedMove = &run.moves[number];
    executed.conditions.thread?;
    let Some(Feed::PerRevolution(lead)) = executed.feed else {
        return None;
    };
    let begin = number.checked_sub(1).map_or(0, |it| run.move_ends[it]);
    let end = run.move_ends[number];
    let half = f64::midpoint(run.path[begin].z, run.path[end].z);
    let is_beyond = |tick: &usize| (run.path[*tick].z - half) * (run.path[end].z - half) > 0.0;
    let middle = (begin + 1..end).find(is_beyond)?;
    let way = run.path[middle + 1].z - run.path[middle - 1].z;
    let turned = (run.angles[middle + 1] - run.angles[middle - 1] + 540.0).rem_euclid(360.0);
    let direction = (way * (turned - 180.0)).signum();
    Some((
        run.path[middle].z / lead - direction * run.angles[middle] / 360.0,
        lead,
    ))
}

/// The greatest distance between the threads of two runs, move by move, along the work, mm.
/// `first` and `first_reference` are the numbers of the first compared moves.
pub fn greatest_helix_distance(
    run: &RecordedRun,
    first: usize,
    reference: &RecordedRun,
    first_reference: usize,
) -> f64 {
    let moves = first..run.moves.len();
    let distances = moves.filter_map(|number| {
        let (angle, lead) = helix(run, number)?;
        let (wanted, _) = helix(reference, number - first + first_reference)?;
        let turns = angle - wanted;
        Some((turns - turns.round()).abs() * lead)
    });
    distances.fold(0.0, f64::max)
}

/// Restarts at every block, and at every pass of its cycles.
fn restart_everywhere(program: &TestProgram, reach: f64) -> Figures {
    let (now, part) = interrupted(program, &mut Random(0x9e37_79b9_7f4a_7c15));
    let reference = uninterrupted(&now, &part);
    let mut worst = Figures::default();
    for number in 1..=reference.blocks.len() as u64 {
        worst.add(&restart(&now, &part, &reference, (number, None), reach));
        for pass in 2.. {
            let found = find_block(&now, None, &mut BlockNumber(number), Some(pass));
            match found {
                Ok(_) => {
                    let at = (number, Some(pass));
                    worst.add(&restart(&now, &part, &reference, at, reach));
                }
                Err(why) => {
                    let is_last = why == say::restart_pass_missing(pass);
                    assert!(is_last || why == say::restart_block_ended(), "{why}");
                    break;
                }
            }
        }
    }
    println!("{}: {worst:?}", program.name);
    worst
}

#[test]
fn every_block_and_pass_of_a_thread_meets_its_groove() {
    let mut greatest = Figures::default();
    for program in &PROGRAMS {
        greatest.add(&restart_everywhere(program, SAME_MM));
    }
    assert!(greatest.helix_mm < HELIX_MM, "{greatest:?}");
    assert!(greatest.path_mm < 0.005, "{greatest:?}");
    assert!(greatest.part_mm3 < 1.0, "{greatest:?}");
}

#[test]
fn every_block_of_a_tap_ends_at_its_depth() {
    let greatest = restart_everywhere(&TAP, TAP_REACH_MM);
    assert!(greatest.path_mm < TAP_REACH_MM, "{greatest:?}");
}
