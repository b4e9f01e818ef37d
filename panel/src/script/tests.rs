use gsk_core::setup::Setup;

use super::*;
use crate::emulator::Emulator;

fn errors(text: &str) -> Vec<String> {
    let errors = Script::parse(text).expect_err("an error");
    errors.iter().map(ToString::to_string).collect()
}

fn run_text(text: &str) -> (Result<(), Failure>, Vec<Effect>, Emulator) {
    let mut emulator = Emulator::new(Setup::default());
    let script = Script::parse(text).expect("a script");
    let mut effects = Vec::new();
    let result = run(script, &mut emulator, &mut |effect,
                                                  emulator|
     -> Result<(), String> {
        if effect == Effect::Load("part.CNC".to_owned()) {
            let text = "O0001;\nG0 X100 Z50;\nM30;\n";
            emulator
                .load_program("part.CNC", text)
                .map_err(|alarm| alarm.line_text())?;
        }
        effects.push(effect);
        Ok(())
    });
    (result, effects, emulator)
}

#[test]
fn every_form_of_the_manual_page_is_read() {
    let text = "\u{feff}# a comment\n\n\
        press AUTO                     # down, up\n\
        type O0001\n\
        type G0 X#1  # comment\n\
        type \"A # B\"\n\
        hold ZM 2s\n\
        down CAN\nup CAN\n\
        load part one.CNC\n\
        load \"x.nc\"\n\
        power off\npower on\n\
        fault turret-blocked on\n\
        @12345 press CS\n\
        turn -10\n\
        wait 500ms\nwait idle 1m\nwait \"text  on the LCD\" 1.5s\nwait alarm\n\
        set X0.5 0\nfree X0.5\n\
        expect row 3 \"U 16.000\"\nexpect row R14 自动方式\n\
        expect abs 100.000 50.000\nexpect machine -1 2\nexpect rel 0 .5\n\
        expect slides -100 -150\nexpect svc 5.000\n\
        expect lamp SBK on\nexpect lamp S-SBK off\n\
        expect alarm 011\nexpect alarm none\nexpect mode 自动方式\nexpect Y0.3 1\n\
        show\nshot page.png\nshot panel.png --panel\n";
    let script = Script::parse(text).expect("a script");
    let actions: Vec<&ScriptAction> = script.lines.iter().map(|line| &line.action).collect();
    assert_eq!(actions[2], &ScriptAction::Type("G0 X#1".to_owned()));
    assert_eq!(actions[3], &ScriptAction::Type("A # B".to_owned()));
    assert_eq!(actions[4], &ScriptAction::Hold(Key::ZLeft, 2000));
    assert_eq!(actions[7], &ScriptAction::Load("part one.CNC".to_owned()));
    assert_eq!(actions[8], &ScriptAction::Load("x.nc".to_owned()));
    assert_eq!(script.lines[12].at, Some(12345));
    assert_eq!(script.lines[0].number, 3);
    assert_eq!(actions.len(), 36);
}

#[test]
fn errors_name_line_and_rule() {
    let all = errors("press AUT\nshow\nhold ZM 2\nhold ZM -1s\nprss CS\nfoo\n");
    assert_eq!(all.len(), 5);
    assert_eq!(all[0], "line 1: unknown key \"AUT\"; near: AUTO OUT");
    assert!(
        all[1].starts_with("line 3: \"2\" is not a time"),
        "{}",
        all[1]
    );
    assert!(
        all[2].starts_with("line 4: \"-1s\" is not a time"),
        "{}",
        all[2]
    );
    assert_eq!(all[3], "line 5: unknown action \"prss\"; near: press KEY");
    assert!(all[4].contains("there are press hold"), "{}", all[4]);
}

#[test]
fn what_else_can_be_wrong() {
    for (text, part) in [
        ("press", "press is written: press KEY"),
        ("press CS CS", "press is written"),
        ("press QQQQQQ", "lists the names of all keys"),
        ("type", "type is written"),
        ("type 中", "cannot be typed"),
        ("wait", "wait is written"),
        ("wait \"x\" soon", "is not a time"),
        ("wait \"x", "not closed"),
        ("wait 1e99s", "is not a time"),
        ("wait 99999999999999999999s", "is not a time"),
        ("set Y0.3 1", "not a machine input"),
        ("set X20.1 1", "X0.0 to X3.7"),
        ("set X0.9 1", "X0.9"),
        ("set X0.5 2", "should be 0 or 1"),
        ("fault door on", "there are turret-blocked"),
        ("expect row 15 x", "0 to 14"),
        ("expect abs 1 nan", "is not a coordinate"),
        ("expect slides 1", "expect is written"),
        ("expect svc five", "is not a voltage"),
        ("expect lamp POS on", "has no lamp"),
        ("expect lamp SBL on", "near: SBK"),
        ("expect lamp XYZZY on", "the strip XZERO"),
        ("expect alarm x", "not an alarm number"),
        ("expect mode AUTO", "there are 编辑方式"),
        ("expect Q0.3 1", "Q0.3"),
        ("expect", "expect is written"),
        ("shot --panel", "shot is written"),
        ("@x press CS", "is not a tick"),
        ("@5", "unknown action"),
        ("turn a", "not a whole number"),
        ("power", "power is written"),
    ] {
        let all = errors(text);
        assert!(all.len() == 1 && all[0].contains(part), "{text}: {all:?}");
    }
}

#[test]
fn a_script_runs_a_program() {
    let (result, effects, emulator) = run_text(
        "load part.CNC\n\
         press AUTO\n\
         press PRG\n\
         expect mode 自动方式\n\
         expect lamp AUTO on\n\
         expect row 14 自动方式\n\
         press CS\n\
         wait idle 60s\n\
         expect abs 100 50\n\
         expect alarm none\n\
         show\nshot panel.png --panel\n",
    );
    assert_eq!(result, Ok(()));
    assert_eq!(effects.len(), 3);
    assert!(matches!(&effects[1], Effect::Show(text) if text.contains("自动方式")));
    assert!(emulator.is_stopped());
}

#[test]
fn a_failure_says_what_was_seen_instead() {
    for (line, seen) in [
        ("expect mode 自动方式", "the mode is 录入方式"),
        ("expect row 0 综合", "row 0 reads \"现在位置(相对坐标)"),
        ("expect abs 1 2", "the coordinates are 300.000 300.000"),
        ("expect lamp SBK on", "the lamp SBK is off"),
        ("expect alarm 011", "no alarm is active"),
        ("expect Y5.5 0", "Y0005.5 is 1"),
        (
            "wait \"自动方式\" 100ms",
            "not within the time; the LCD shows\n现在位置",
        ),
    ] {
        let (result, ..) = run_text(&format!("press MDI\n{line}\n"));
        let failure = result.expect_err(line).to_string();
        assert!(
            failure.starts_with(&format!("line 2: {line}: {seen}")),
            "{failure}"
        );
    }
    let (result, ..) = run_text("press ESTOP\nexpect alarm none\n");
    let failure = result.expect_err("an alarm").to_string();
    assert!(failure.contains("alarms: "), "{failure}");
    let (result, ..) = run_text("wait 100ms\n@50 press CS\n");
    let failure = result.expect_err("too late").to_string();
    assert!(
        failure.contains("that tick has passed: it is 100"),
        "{failure}"
    );
}

#[test]
fn machine_inputs_and_power() {
    let (result, ..) = run_text(
        "set X0.5 0\nwait 100ms\nexpect X0.5 0\nexpect alarm 207\nfree X0.5\nwait 100ms\n\
         expect X0.5 1\nexpect alarm none\npress AUTO\npower off\nwait 1s\npower on\n\
         wait \"现在位置\" 5s\n",
    );
    assert_eq!(result, Ok(()));
}

#[test]
fn a_runner_can_be_driven_in_small_steps() {
    let text = "press JOG\nhold ZM 300ms\nwait idle 5s\nexpect mode 手动方式\n";
    let mut whole = Emulator::new(Setup::default());
    let mut stepwise = whole.clone();
    run(Script::parse(text).unwrap(), &mut whole, &mut |_, _| {
        Ok::<_, Failure>(())
    })
    .unwrap();
    let mut runner = Runner::new(Script::parse(text).unwrap());
    loop {
        match runner.advance(&mut stepwise, 7) {
            ScriptProgress::Running => {}
            ScriptProgress::Finished => break,
            other => panic!("{other:?}"),
        }
    }
    assert_eq!(whole, stepwise);
    assert_eq!(runner.advance(&mut stepwise, 7), ScriptProgress::Finished);
}

#[test]
fn states_of_control_panel_and_lathe_are_expected() {
    let text = "load part.CNC\npress AUTO\npress POS\n\
        expect screen \"现在位置(相对坐标)\"\nexpect page pos-rel\nexpect not page oft\n\
        expect key ESTOP up\nexpect at machine X 299..301\nexpect at abs Z 300\n\
        expect offset 1 X 0\nexpect offset 1 T 0..9\nexpect not offset 1 R 0.1..2\n\
        expect param 172 96\nexpect param 172.5 1\n\
        expect program 1\nexpect program O0001 \"x100 z50;\"\nexpect not program 2\n\
        expect selected 1\nexpect tool 1\nexpect tool 0100\nexpect not tool 2\n\
        expect spindle -0.5..0.5\nexpect run reset\nexpect parts 0\nexpect power on\n\
        expect referenced X\n\
        down AUTO\nexpect key AUTO down\nup AUTO\n\
        press CS\nexpect run run\nwait idle 60s\nexpect parts 1\nexpect abs 100 50\n\
        power off\nexpect power off\n";
    let (result, ..) = run_text(text);
    assert_eq!(result, Ok(()));
    for (line, seen) in [
        ("expect not alarm none", "the condition is true"),
        ("expect offset 1 Z 1..2", "001 Z is 0.000"),
        ("expect run hold", "the run is reset"),
        ("expect selected 1", "the program is -"),
        ("expect page oft", "the page is 现在位置(相对坐标)"),
        ("expect screen \"no such text\"", "GSK980TD"),
    ] {
        let (result, ..) = run_text(line);
        let message = result.expect_err(line).to_string();
        assert!(
            message.contains(seen) || seen == "GSK980TD" && message.contains("it is \n"),
            "{message}"
        );
    }
    for (line, wanted) in [
        ("expect at abs X 3..1", "neither a value nor a range"),
        ("expect page nowhere", "unknown page"),
        ("expect not not alarm none", "is written"),
        ("expect tool two", "is not a whole number"),
        ("expect key AUTOO down", "near: AUTO"),
        ("expect param 1.9 1", "1.9"),
        ("expect offset", "| offset 1 X -2.5 |"),
    ] {
        let all = errors(line);
        assert!(all[0].contains(wanted), "{}", all[0]);
    }
}
