//! Names of programs in reports, as the control model writes them.

use gsk_core::command::ProgramId;
use gsk_core::model::{ControlModel, ModelId};
use gsk_core::program::Program;
use gsk_core::setup::Setup;
use gsk_messages::Language;
use gsk_runner::report::annotations::collect_annotations;
use gsk_runner::report::check_program;

#[test]
fn an_alarm_in_a_subprogram_names_it_as_the_model_does() {
    for (model, call, name) in [
        (ModelId::Gsk980td, "M98 P0021;\nM30;\n", "O0021"),
        (ModelId::Hx31, "G20 N21;\nM02;\n", "%P21"),
    ] {
        let mut setup = Setup::default();
        setup.memory.model = ControlModel::new(model);
        setup
            .memory
            .programs
            .store("O21;\nG00 X5;\nG19 X1;\nM99;\n")
            .unwrap();
        setup.memory.programs.open_external(Program::new(call));
        setup.memory.programs.select(ProgramId::External);
        let language = Some(Language::En);
        let report = check_program("part.CNC", &setup, language, &mut |_| (), &mut |_| true);
        let alarm = report.alarm.as_ref().expect("alarm");
        assert_eq!(alarm.program, Some(ProgramId::Stored(21)));
        let text = report.to_text(language);
        assert!(text.contains(&format!(", {name}")), "{text}");
        let annotations = collect_annotations(&report, language);
        let text = &annotations.first().expect("annotation").text;
        assert!(text.contains(name), "{text}");
    }
}
