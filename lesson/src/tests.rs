use std::sync::Arc;

use gsk_messages::Language;
use gsk_panel::keys::KEYS;
use gsk_panel::panel::KeyEvent;

use super::*;
use crate::solution_player::StepResult;
use gsk_runner::machining::Machining;
use gsk_runner::machining::live_part::LivePart;

fn lesson(steps: &str) -> String {
    format!(
        "(title: (zh: \"一\", en: \"One\"), about: (zh: \"一\", en: \"one\"),\n\
         begins: (before: [\"press MDI\"]),\n steps: [{steps}])"
    )
}

fn step(fields: &str) -> String {
    format!("(text: (zh: \"按\", en: \"press\"), hint: (zh: \"按\", en: \"press\"), {fields}),")
}

fn parse_lesson(text: &str) -> Result<Lesson, String> {
    Lesson::read("lessons/mine.ron", text).map_err(|error| error.message().text(Language::En))
}

#[test]
fn the_lessons_of_the_program_are_read_and_their_solutions_come_true() {
    assert_eq!(built_in_lessons().len(), LESSONS.len());
    let mut faults = Vec::new();
    for (name, text) in &LESSONS {
        let lesson = Lesson::read(name, text).unwrap_or_else(|error| panic!("{error}"));
        let lesson = Arc::new(lesson);
        let outcomes = solution_player::play_lesson(&lesson).expect(name);
        let wrong = (1..).zip(&outcomes);
        let wrong = wrong.filter(|(_, outcome)| !matches!(outcome, StepResult::Done(_)));
        faults.extend(wrong.map(|(step, outcome)| match outcome {
            StepResult::Failed(why) => format!("{name}, step {step}: {why}"),
            _ => format!("{name}, step {step}: {outcome:?}"),
        }));
        if outcomes.len() == lesson.steps.len() && faults.is_empty() {
            let machine =
                solution_player::machine_at_step(&lesson, lesson.steps.len()).expect(name);
            assert!(machine.is_stopped(), "{name}");
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn errors_name_file_step_field_and_rule() {
    for (fields, wanted) in [
        (
            "until: [], solution: [\"press AUTO\"]",
            "lessons/mine.ron: step 1, until: the condition is missing",
        ),
        (
            "until: [\"mode auto\"], solution: [\"press AUTO\"]",
            "step 1, until: mode auto: ",
        ),
        (
            "until: [\"alarm none\"], solution: [\"wait 1s\", \"press AUT\"]",
            "step 1, solution: line 2: unknown key",
        ),
        (
            "until: [\"alarm none\"], solution: [\"power off\"]",
            "is not a manual action",
        ),
        (
            "until: [\"alarm none\"], solution: []",
            "step 1, solution: the field is empty",
        ),
        (
            "until: [\"page nowhere\"], solution: [\"press CS\"]",
            "unknown page \"nowhere\"; there are",
        ),
        (
            "until: [\"at abs X 3..1\"], solution: [\"press CS\"]",
            "\"3..1\" is neither a value nor a range",
        ),
        (
            "until: [\"offset 1\"], solution: [\"press CS\"]",
            "expect is written: expect screen",
        ),
        (
            "keys: [\"AUTOO\"], until: [\"alarm none\"], solution: [\"press CS\"]",
            "step 1, keys: ",
        ),
        ("untill: []", "lessons/mine.ron: line 3: "),
    ] {
        let message = parse_lesson(&lesson(&step(fields))).expect_err(fields);
        assert!(message.contains(wanted), "{message}");
    }
    let none = parse_lesson(&lesson("")).expect_err("no steps");
    assert!(none.contains("steps: 0 steps"), "{none}");
    let begins = lesson(&step("until: [\"alarm none\"], solution: [\"press CS\"]"));
    for (before, wanted) in [
        ("before: [\"press MDI\"]", ""),
        ("picture: true", ""),
        (
            "picture: true, before: [\"press MDI\"]",
            "no action is possible before",
        ),
        ("params: [\"1.3\"]", "begins: \"1.3\" is not understood"),
        ("offsets: [\"99=1\"]", "begins: 99=1: "),
        ("slides: (9999, 0)", "beyond their travel"),
        ("absolute: (NaN, 0)", "NaN is not a finite number"),
        ("offsets: [\"1=NaN\"]", "\"1=NaN\" is not understood"),
        ("programs: [\"G00 X1;\"]", "begins with its number"),
        ("before: [\"load a.nc\"]", "needs a file"),
    ] {
        let read = parse_lesson(&begins.replace("before: [\"press MDI\"]", before));
        match wanted {
            "" => assert!(read.is_ok()),
            wanted => {
                let message = read.expect_err(before);
                assert!(message.contains(wanted), "{message}");
            }
        }
    }
}

/// A pass with 1.25 mm a turn, more than a nose of 0.4 mm bears.
#[test]
fn a_cut_above_the_limits_of_a_lesson_breaks_the_insert() {
    for (load, is_done) in [("load: (events: true),", true), ("", false)] {
        let text = format!(
            "(title: (zh: \"一\", en: \"One\"), about: (zh: \"一\", en: \"one\"),\n\
             begins: (referenced: true, {load} offsets: [\"1=-160,-220,0.4,3\"], programs: [\
             \"O0030;T0101;M3S800;G0X54Z2;G90X46Z-40F1000;G0X100Z50;M30;\"]),\n\
             job: (stock: (form: Bar(diameter: 50), length: 120, overhang: 70), tools: {{ 1: (\
             insert: Turning(letter: C, entering: 95, size: 12.7, nose: 0.4), tip: 3) }},\n\
             zero: (x: -160, z: -220), lengths: {{ 1: (x: 0, z: 0) }}),\n steps: [{}])",
            step(
                "until: [\"fault insert-broken on\"], \
                 solution: [\"press AUTO\", \"press CS\", \"wait 20s\"]"
            )
        );
        let lesson = Arc::new(parse_lesson(&text.replace(';', ";\\n")).expect("a lesson"));
        let outcomes = solution_player::play_lesson(&lesson).expect("a machine");
        let done = matches!(outcomes[..], [StepResult::Done(_)]);
        assert_eq!(done, is_done, "{load}: {outcomes:?}");
    }
    let negative = lesson(&step("until: [\"alarm none\"], solution: [\"press CS\"]"));
    let negative = negative.replace("before: [\"press MDI\"]", "load: (grip_nm: -1)");
    let error = parse_lesson(&negative).expect_err("a negative torque");
    assert!(error.contains("begins: load.grip_nm: "), "{error}");
}

/// A lesson of three steps: AUTO, then single block, then JOG.
fn three_steps() -> Arc<Lesson> {
    let steps = [
        "until: [\"mode 自动方式\"], solution: [\"press AUTO\"]",
        "needs: [\"mode 自动方式\"], until: [\"lamp SBK on\"], solution: [\"press SBK\"]",
        "until: [\"mode 手动方式\", \"lamp SBK on\"], solution: [\"press JOG\"], \
         wrong: [(when: [\"mode 编辑方式\"], say: (zh: \"错\", en: \"no\"))]",
    ];
    let text = lesson(&steps.map(step).concat());
    Arc::new(parse_lesson(&text).expect("a lesson"))
}

fn run(practice: &mut Practice, machine: &mut Emulator, ticks: u64) {
    for _ in 0..ticks {
        practice.tick(machine);
    }
}

fn press(practice: &mut Practice, machine: &mut Emulator, key: Key) {
    practice.interrupt(machine);
    machine.key_down(key);
    run(practice, machine, 100);
    machine.key_up(key);
    run(practice, machine, 400);
}

#[test]
fn a_coordinate_comes_true_where_the_slide_stops() {
    let away = "until: [\"not at machine Z -0.005..0.005\"], solution: [\"press JOG\"]";
    let text = lesson(&step(away)).replace("begins: (", "begins: (slides: (0, 0), ");
    let begun = parse_lesson(&text).map(|lesson| Practice::begin(Arc::new(lesson)));
    let (mut practice, mut machine) = begun.expect("a lesson").expect("a machine");
    press(&mut practice, &mut machine, Key::Jog);
    assert_eq!(practice.view().step, 0);
    let start = machine.cnc().position_machine().z;
    machine.key_down(Key::ZLeft);
    run(&mut practice, &mut machine, 500);
    assert!(machine.cnc().position_machine().z < start - 0.1);
    assert_eq!(practice.view().step, 0, "it passes");
    machine.key_up(Key::ZLeft);
    run(&mut practice, &mut machine, 500);
    assert_eq!(practice.view().step, 1, "it stands");
}

#[test]
fn the_step_follows_the_machine_forth_and_back() {
    let (mut practice, mut machine) = Practice::begin(three_steps()).expect("a machine");
    assert_eq!(practice.view().step, 0);
    press(&mut practice, &mut machine, Key::Auto);
    assert_eq!(practice.view().step, 1);
    // The second step's requirement is lost: back to the step that establishes it.
    press(&mut practice, &mut machine, Key::Edit);
    let view = practice.view();
    assert_eq!(view.step, 0);
    let why = view.sent_back.map(|why| why.to_string());
    assert_eq!(why.as_deref(), Some("the mode is 编辑方式"));
    press(&mut practice, &mut machine, Key::Auto);
    assert_eq!(practice.view().sent_back, None);
    press(&mut practice, &mut machine, Key::SingleBlock);
    assert_eq!(practice.view().step, 2);
    // The third step has no requirement: the mistake is shown and the learner stays.
    press(&mut practice, &mut machine, Key::Edit);
    assert_eq!(practice.view().step, 2);
    assert_eq!(practice.view().remark, LessonRemark::Mistake(0));
    press(&mut practice, &mut machine, Key::EmergencyStop);
    press(&mut practice, &mut machine, Key::Auto);
    assert_eq!(practice.view().remark, LessonRemark::EmergencyStop);
    practice.go_back(&mut machine);
    assert_eq!(practice.view().step, 1);
    run(&mut practice, &mut machine, 100);
    assert_eq!(
        practice.view().step,
        1,
        "back is where the step began, not where it ended"
    );
    practice.restart(&mut machine);
    assert_eq!(practice.view().step, 0);
    let begin = practice.lesson().start.create_machine().expect("a machine");
    assert_eq!(machine.screen().text(), begin.screen().text());
}

#[test]
fn what_is_shown_stops_at_the_first_key_of_the_learner() {
    let (mut practice, mut machine) = Practice::begin(three_steps()).expect("a machine");
    practice.show_me(&mut machine);
    assert!(practice.view().showing);
    run(&mut practice, &mut machine, 50);
    assert!(machine.panel().is_held(Key::Auto));
    practice.interrupt(&mut machine);
    assert!(!practice.view().showing);
    assert!(!machine.panel().is_held(Key::Auto));
}

#[test]
fn an_alarm_of_what_is_shown_leads_to_the_state_of_the_lesson() {
    let lesson = built_in_lessons().into_iter().next().expect("a lesson");
    let (mut practice, mut machine) = Practice::begin(Arc::new(lesson)).expect("a machine");
    for _ in 0..3 {
        practice.show_me(&mut machine);
        while practice.view().showing {
            run(&mut practice, &mut machine, 100);
        }
    }
    assert_eq!(practice.view().step, 3);
    // The learner releases the key when X slows down on its deceleration switch.
    machine.key_down(Key::XDown);
    let (mut x, mut fastest) = (machine.cnc().position_machine().x, 0.0);
    loop {
        run(&mut practice, &mut machine, 10);
        let now = machine.cnc().position_machine().x;
        let speed = (now - core::mem::replace(&mut x, now)).abs();
        if speed < 0.5 * fastest {
            break;
        }
        fastest = speed.max(fastest);
    }
    machine.key_up(Key::XDown);
    run(&mut practice, &mut machine, 3000);
    practice.show_me(&mut machine);
    run(&mut practice, &mut machine, 4000);
    assert!(practice.view().replaced, "{}", machine.screen());
    while practice.view().showing {
        run(&mut practice, &mut machine, 100);
    }
    assert_eq!(practice.view().step, 4);
}

/// Generates random numbers that are the same in every run.
struct LessonRandom(u64);

impl LessonRandom {
    fn below(&mut self, limit: usize) -> usize {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (self.0 >> 33) as usize % limit
    }
}

/// Presses `keys` random keys: some at the same time, some held long.
fn press_random_keys(
    practice: &mut Practice,
    machine: &mut Emulator,
    random: &mut LessonRandom,
    keys: usize,
) {
    for _ in 0..keys {
        practice.interrupt(machine);
        match random.below(12) {
            0 => {
                machine.turn(random.below(41) as i32 - 20);
            }
            1 => {
                machine.key(KeyEvent::ReleaseAll);
            }
            _ => {
                let key = KEYS[random.below(KEYS.len())].key;
                machine.key_down(key);
                run(practice, machine, 20 + random.below(60) as u64);
                if random.below(8) > 0 {
                    machine.key_up(key);
                }
            }
        }
        run(practice, machine, 20);
    }
    machine.key(KeyEvent::ReleaseAll);
}

/// Presses *Show me* until the lesson ends. Returns the number of presses; `None` if the
/// lesson does not end.
fn show_to_the_end(practice: &mut Practice, machine: &mut Emulator) -> Option<usize> {
    let steps = practice.lesson().steps.len();
    for shown in 0..3 * steps {
        if practice.view().step == steps {
            return Some(shown);
        }
        practice.show_me(machine);
        for _ in 0..6_000 {
            run(practice, machine, 100);
            if !practice.view().showing {
                break;
            }
        }
    }
    (practice.view().step == steps).then_some(3 * steps)
}

/// From any state that a learner has reached at a step, *Show me* leads to the end, and *Begin
/// again* to the beginning.
fn check_recovery(lesson: &Arc<Lesson>, step: usize, keys: usize) {
    let mut chance = LessonRandom(step as u64 * 7919 + lesson.steps.len() as u64);
    let (mut practice, mut machine) = Practice::begin(Arc::clone(lesson)).expect("a machine");
    for _ in 0..3 * step {
        if practice.view().step >= step {
            break;
        }
        practice.show_me(&mut machine);
        while practice.view().showing {
            run(&mut practice, &mut machine, 100);
        }
    }
    press_random_keys(&mut practice, &mut machine, &mut chance, keys);
    let shown = show_to_the_end(&mut practice, &mut machine);
    assert!(
        shown.is_some(),
        "{}, step {}: stranded at {:?}\n{}",
        lesson.name,
        step + 1,
        practice.view(),
        machine.screen()
    );
    practice.restart(&mut machine);
    assert_eq!(practice.view().step, 0);
}

#[test]
fn no_learner_is_stranded_in_a_short_lesson() {
    let lesson = three_steps();
    for step in 0..lesson.steps.len() {
        check_recovery(&lesson, step, 60);
    }
}

/// Tries random keys in every step of every lesson; `LESSON_KEYS=200` presses more keys.
#[test]
fn no_learner_is_stranded_in_the_built_in_lessons() {
    let keys = std::env::var("LESSON_KEYS")
        .ok()
        .and_then(|it| it.parse().ok());
    for lesson in built_in_lessons() {
        let lesson = Arc::new(lesson);
        for step in 0..lesson.steps.len() {
            check_recovery(&lesson, step, keys.unwrap_or(50));
        }
    }
}

/// Plays a lesson to its end with its own keys. Returns whether something was cut, and adds the
/// first collision of each step to `faults`.
fn play_with_part(lesson: &Arc<Lesson>, faults: &mut Vec<String>) -> bool {
    let mut live = LivePart::new(Machining::new(lesson.stock_and_tools()));
    let (mut practice, mut machine) = Practice::begin(Arc::clone(lesson)).expect("a machine");
    while practice.view().step < lesson.steps.len() {
        let step = practice.view().step;
        let place = format!("{}, step {}", lesson.name, step + 1);
        practice.show_me(&mut machine);
        let mut fault = None;
        while practice.view().showing {
            practice.tick(&mut machine);
            let found = live.follow_tick(machine.simulation());
            if let (None, Some(first)) = (&fault, found.first()) {
                fault = Some(format!("{place}: {first:?}"));
            }
        }
        faults.extend(fault);
        assert!(practice.view().step > step, "{place}");
    }
    live.machining().scene().part().version() > 0
}

/// No demonstration causes a collision, as on a real machine. A lesson that names a job cuts;
/// the usual bar is there to see the machine.
#[test]
fn demonstrations_hit_nothing() {
    let mut faults = Vec::new();
    for lesson in built_in_lessons().into_iter().map(Arc::new) {
        let cuts = play_with_part(&lesson, &mut faults);
        assert!(cuts || lesson.job.is_none(), "{}: it cuts", lesson.name);
    }
    for shown in demonstrations() {
        play_with_part(&shown.lesson, &mut faults);
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// The pictures of the machine show a tool in front of the bar from the first step on.
#[test]
fn every_lesson_begins_with_a_tool_at_the_part() {
    for lesson in built_in_lessons().into_iter().map(Arc::new) {
        let job = lesson.stock_and_tools();
        let (_, machine) = Practice::begin(Arc::clone(&lesson)).expect("a machine");
        let station = machine.lathe().station().expect("a tool is in position");
        assert!(job.tools.contains_key(&station), "{}", lesson.name);
        let zero = job.zero.expect("the part has a place").point();
        let tip = machine.cnc().position_machine() - zero;
        assert!((0.0..=120.0).contains(&tip.z), "{}: {tip:?}", lesson.name);
        assert!((0.0..=60.0).contains(&tip.x), "{}: {tip:?}", lesson.name);
    }
}

/// The hint of the first lesson leads off the deceleration switch, wherever the return was
/// interrupted on it.
#[test]
fn an_interrupted_zero_return_is_repeated_as_the_hint_says() {
    let first = built_in_lessons().into_iter().next().expect("a lesson");
    let lesson = Arc::new(first);
    let mut interrupted = 0;
    for held in [600, 800, 1_000, 1_500, 3_000, 6_000, 9_000] {
        let (mut practice, mut machine) = Practice::begin(Arc::clone(&lesson)).expect("a machine");
        let hold = |practice: &mut Practice, machine: &mut Emulator, key, ticks| {
            machine.key_down(key);
            run(practice, machine, ticks);
            machine.key_up(key);
            run(practice, machine, 1_000);
        };
        for key in [Key::EmergencyStop, Key::Position, Key::MachineZero] {
            press(&mut practice, &mut machine, key);
        }
        hold(&mut practice, &mut machine, Key::XDown, held);
        let slide = machine.lathe().slide_position().diameter().0;
        if practice.view().step > 3 || !(-60.0..=-10.0).contains(&slide) {
            continue;
        }
        interrupted += 1;
        press(&mut practice, &mut machine, Key::Jog);
        press(&mut practice, &mut machine, Key::Rapid);
        hold(&mut practice, &mut machine, Key::XUp, 1_000);
        press(&mut practice, &mut machine, Key::MachineZero);
        hold(&mut practice, &mut machine, Key::XDown, 40_000);
        let view = practice.view();
        assert_eq!(view.step, 4, "{held} ms: {view:?}\n{}", machine.screen());
    }
    assert!(interrupted > 1, "{interrupted} returns ended on the switch");
}
