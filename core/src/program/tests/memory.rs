//! Program memory and MDI block.

use super::super::*;
use crate::cnc::{Cnc, ControlRequest};
use crate::command::ProgramId;
use crate::memory::ControlParameters;
use crate::model::{ControlModel, ModelId, ProgramNaming};
use crate::setup::Setup;

#[test]
fn programs_are_stored_and_selected() {
    let mut memory = ProgramMemory::default();
    assert_eq!(memory.selected(), None);
    assert_eq!(memory.store("G0 X1;").unwrap_err().number, 74);
    assert_eq!(memory.store("O5;\nM30;").unwrap(), 5);
    assert_eq!(memory.store("O3;\nM30;\n").unwrap(), 3);
    assert_eq!(memory.selected(), Some(ProgramId::Stored(5)));
    assert!(!memory.select(ProgramId::Stored(9)));
    assert!(memory.select(ProgramId::Stored(3)));
    assert!(!memory.select(ProgramId::External));
    memory.open_external(Program::new("G0 X1;"));
    assert!(memory.select(ProgramId::External));
    assert!(memory.select(ProgramId::Stored(5)));
    assert_eq!(memory.selected(), Some(ProgramId::Stored(5)));
    assert_eq!(
        memory.iter().map(|(number, _)| number).collect::<Vec<_>>(),
        [3, 5]
    );
    assert_eq!((memory.count(), memory.free_count()), (2, 191));
    assert_eq!(
        (memory.characters(), memory.free_characters()),
        (17, 2_999_983)
    );
    assert_eq!(memory.receive("O5;").unwrap_err().number, 73);
    assert_eq!(memory.store("O5;").unwrap(), 5);
    assert_eq!(memory.stored(5).unwrap().text(), "O5;");
    assert!(memory.get(ProgramId::Mdi).is_none());
}

#[test]
fn programs_are_managed() {
    let mut memory = ProgramMemory::default();
    memory.create(1, ProgramNaming::Letter).unwrap();
    assert_eq!(
        memory.create(1, ProgramNaming::Letter).unwrap_err().number,
        110
    );
    assert_eq!(
        memory
            .create(10_000, ProgramNaming::Letter)
            .unwrap_err()
            .number,
        74
    );
    memory.copy(1, 2).unwrap();
    assert_eq!(memory.stored(2).unwrap().text(), "O0002;\n");
    assert_eq!(memory.copy(9, 3).unwrap_err().number, 71);
    assert_eq!(memory.copy(1, 2).unwrap_err().number, 110);
    memory.rename(1, 7).unwrap();
    assert_eq!(memory.selected(), Some(ProgramId::Stored(7)));
    assert_eq!(memory.rename(7, 2).unwrap_err().number, 110);
    assert_eq!(memory.rename(1, 3).unwrap_err().number, 71);
    assert_eq!(memory.rename(7, 10_000).unwrap_err().number, 74);
    memory.delete(7).unwrap();
    assert_eq!(memory.selected(), Some(ProgramId::Stored(2)));
    assert_eq!(memory.delete(7).unwrap_err().number, 71);
    memory.delete_range(&(0..=8999));
    assert_eq!((memory.count(), memory.selected()), (0, None));
}

#[test]
fn a_full_memory_raises_alarms() {
    let mut memory = ProgramMemory::default();
    for number in 0..193 {
        memory.create(number, ProgramNaming::Letter).unwrap();
    }
    assert_eq!(
        memory
            .create(500, ProgramNaming::Letter)
            .unwrap_err()
            .number,
        72
    );
    memory.store("O0;").unwrap();
    memory.delete(1).unwrap();
    let half = format!("O1;({})", "外".repeat(1_500_000));
    memory.store(half.clone()).unwrap();
    assert_eq!(
        memory.store(half.replace("O1", "O2")).unwrap_err().number,
        68
    );
    memory.store(half).unwrap();
}

#[test]
fn an_mdi_block_is_typed() {
    let parameters = ControlParameters::default();
    let mut mdi = MdiBlock::default();
    assert!(mdi.is_empty());
    mdi.enter("G50", &parameters, false).unwrap();
    mdi.enter("X50", &parameters, false).unwrap();
    mdi.enter("z 100;", &parameters, false).unwrap();
    assert_eq!(mdi.text(), "G50 X50 Z 100");
    mdi.enter("X-12.5", &parameters, false).unwrap();
    assert_eq!(mdi.entered_number(b'X'), Some("-12.5"));
    assert_eq!(mdi.entered_number(b'U'), None);
    assert_eq!(
        mdi.block(&parameters).unwrap().to_string(),
        "G50 X-12.5 Z100;"
    );
    for (word, alarm) in [
        ("X99999", 43),
        ("A5", 9),
        ("X", 5),
        ("5", 6),
        ("外", 6),
        ("G65", 125),
        ("X1X", 18),
    ] {
        let before = mdi.clone();
        assert_eq!(
            mdi.enter(word, &parameters, false).unwrap_err().number,
            alarm,
            "{word}"
        );
        assert_eq!(mdi, before);
    }
    mdi.enter("G0", &parameters, false).unwrap();
    assert_eq!(mdi.text(), "G0 X-12.5 Z 100");
    mdi.enter("G1 G98 F100", &parameters, false).unwrap();
    assert_eq!(mdi.text(), "G1 X-12.5 Z 100 G98 F100");
    assert_eq!(mdi.program().block_count(), 1);
    mdi.clear();
    assert!(mdi.is_empty());
    mdi.enter("G65", &parameters, false).unwrap();
    mdi.enter("H31", &parameters, false).unwrap();
    mdi.enter("P#201", &parameters, false).unwrap();
    mdi.enter("R30000", &parameters, false).unwrap();
    assert_eq!(
        mdi.block(&parameters).unwrap().to_string(),
        "G65 H31 P#201 R30000;"
    );
}

#[test]
fn a_percent_name_is_a_number_too() {
    let program = Program::new("%P55\nN10 G00 X1\nM02\n");
    assert_eq!(program.number(), Some(55));
    let again = program.renumbered(7);
    assert_eq!(again.text(), "%P07\nN10 G00 X1\nM02\n");
    assert_eq!(again.number(), Some(7));
    // An O word has precedence, and a single % is the start of a tape.
    assert_eq!(Program::new("%P55\nO0001\nM30\n").number(), Some(1));
    for text in ["%\nG00 X1\n", "%P\nG00\n", "%P12345\n", "P55\n"] {
        assert_eq!(Program::new(text).number(), None, "{text:?}");
    }
}

#[test]
fn a_model_with_a_small_disk_refuses_the_31st_program() {
    let mut setup = Setup::default();
    setup.memory.model = ControlModel::new(ModelId::Hx31);
    for number in 1..=31 {
        setup.memory.programs.store(format!("O{number};")).unwrap();
    }
    // What an earlier version has stored remains, and can be replaced and deleted.
    let mut cnc = Cnc::new(setup);
    assert_eq!(
        (cnc.programs().count(), cnc.programs().free_count()),
        (31, 0)
    );
    let store = |text: &str| ControlRequest::StoreProgram(text.to_owned());
    assert_eq!(cnc.request(store("O31;\nM30;")), Ok(()));
    assert_eq!(cnc.request(store("O40;")).unwrap_err().number, 72);
    let mut memory = cnc.programs().retained();
    memory.delete(1).unwrap();
    assert_eq!(memory.store("O40;").unwrap_err().number, 72);
    memory.delete(2).unwrap();
    memory.store("O40;").unwrap();
    let large = format!("O40;({})", "x".repeat(131_072));
    assert_eq!(memory.store(large).unwrap_err().number, 68);
}
