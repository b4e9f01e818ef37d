//! Control models: which codes each of them has, by the lists of their manuals, and the
//! alarm of every code that it has not.

use gsk_core::model::{ControlModel, ModelId};
use gsk_core::preview::preview;
use gsk_core::program::Program;
use gsk_core::setup::Setup;

/// G codes as chapter and table give them, those taken over from the GSK980TD among them.
const LATHES: [(ModelId, &[i64]); 3] = [
    (
        ModelId::Gsk980td,
        &[
            0, 1, 2, 3, 4, 28, 32, 33, 34, 40, 41, 42, 50, 65, 70, 71, 72, 73, 74, 75, 76, 90, 92,
            94, 96, 97, 98, 99,
        ],
    ),
    (
        ModelId::Ncb08,
        &[
            0, 1, 2, 3, 4, 27, 28, 32, 33, 34, 50, 65, 70, 71, 72, 73, 74, 75, 76, 90, 92, 94, 96,
            97, 98, 99,
        ],
    ),
    (
        ModelId::Hx31,
        &[
            0, 1, 2, 3, 4, 9, 20, 22, 24, 25, 26, 27, 30, 31, 33, 34, 40, 41, 42, 54, 55, 56, 57,
            71, 72, 73, 74, 75, 76, 81, 82, 83, 84, 85, 86, 87, 90, 91, 92, 96, 97, 98, 99,
        ],
    ),
];

/// The alarm of a program, if it ends with one.
fn alarm(model: ModelId, text: &str) -> Option<(u16, String)> {
    let mut setup = Setup::default();
    setup.memory.model = ControlModel::new(model);
    // The option of nose radius compensation.
    let option = setup.memory.parameters.set_bit(2, 1, true);
    assert!(option.is_ok(), "002.1");
    let mut programs = setup.memory.programs.clone();
    programs.open_external(Program::new(text));
    let preview = preview(&setup, &programs, &mut |_| {});
    preview.alarm.map(|it| (it.number, it.line_text()))
}

/// Codes are tried alone: what they want besides is another alarm than 010.
#[test]
fn every_g_code_is_there_or_alarm_010() {
    for (model, codes) in LATHES {
        for code in 0..100 {
            let text = format!("G{code:02};\nM30;\n");
            let unknown = alarm(model, &text).is_some_and(|(number, _)| number == 10);
            assert_eq!(unknown, !codes.contains(&code), "{model:?} G{code:02}");
        }
    }
}

#[test]
fn alarms_are_written_as_the_model_writes_them() {
    let shown = |model| {
        alarm(model, "G91;\n")
            .map(|(_, text)| text)
            .unwrap_or_default()
    };
    assert!(shown(ModelId::Gsk980td).starts_with("P/S 010: "));
    assert!(shown(ModelId::Ncb08).starts_with("E010: "));
}

/// The same contour in the words of each: the same path.
#[test]
fn the_same_contour_is_the_same_path() {
    let contour = "G00 X40 Z2;\nG01 Z-10 F100;\nG02 X60 Z-20 R10;\nG03 U20 W-10 R10;\nG01 X100 Z-50;\nG00 X120 Z5;\nM30;\n";
    let moves = |model| {
        let mut setup = Setup::default();
        setup.memory.model = ControlModel::new(model);
        let mut programs = setup.memory.programs.clone();
        programs.open_external(Program::new(contour));
        let mut moves = Vec::new();
        let end = preview(&setup, &programs, &mut |it| {
            moves.push((it.source.line, it.kind, it.from, it.to, it.center));
        });
        assert_eq!(end.alarm, None);
        moves
    };
    for other in [ModelId::Ncb08, ModelId::Hx31] {
        assert_eq!(moves(ModelId::Gsk980td), moves(other), "{other:?}");
    }
}
