//! The command `lesson` as a teacher calls it.

use super::{TempFile, run_gsk};

#[test]
fn lessons_are_listed_checked_and_run() {
    let (code, list, _) = run_gsk(&["lesson", "list"]);
    assert_eq!(code, 0);
    assert_eq!(list.lines().count(), 15, "{list}");
    assert!(list.contains("03-mdi"), "{list}");
    let (_, chinese, _) = run_gsk(&["lesson", "list", "--lang", "zh"]);
    assert!(chinese.contains("开机与机械回零"), "{chinese}");
    let (code, output, _) = run_gsk(&["lesson", "run", "08-offsets"]);
    assert_eq!(code, 0, "{output}");
    assert!(output.contains("step 6: done, "), "{output}");
    let (code, _, error) = run_gsk(&["lesson", "run", "08"]);
    assert_eq!(code, 2);
    assert!(
        error.contains("there is no lesson 08; there are 01-power-on"),
        "{error}"
    );
}

#[test]
fn errors_in_a_lesson_file_name_their_position() {
    let text = "(title: (zh: \"一\", en: \"One\"), about: (zh: \"一\", en: \"one\"), steps: [\n\
        (text: (zh: \"按\", en: \"press\"), hint: (zh: \"按\", en: \"press\"),\n\
        until: [\"mode 自动方式\"], solution: [\"press AUTO\"]),\n\
        (text: (zh: \"按\", en: \"press\"), hint: (zh: \"按\", en: \"press\"),\n\
        until: [\"lamp SBK on\"], solution: [\"press MDI\"])])\n";
    let lesson = TempFile::new("lesson.ron", text.as_bytes());
    let (code, output, _) = run_gsk(&["lesson", "check", lesson.path()]);
    assert_eq!(code, 1);
    assert!(output.contains("step 1: done"), "{output}");
    assert!(
        output.contains("step 2: its condition is not met: lamp SBK on: "),
        "{output}"
    );
    let wrong = TempFile::new(
        "wrong.ron",
        text.replace("lamp SBK on", "lamp SBKK on").as_bytes(),
    );
    let (code, _, error) = run_gsk(&["lesson", "check", wrong.path()]);
    assert_eq!(code, 2);
    assert!(
        error.contains("wrong.ron: step 2, until: lamp SBKK on: "),
        "{error}"
    );
}
