//! The command `lesson` as a teacher calls it.

use super::{Scratch, said};

#[test]
fn lessons_are_listed_checked_and_played() {
    let (code, list, _) = said(&["lesson", "list"]);
    assert_eq!(code, 0);
    assert_eq!(list.lines().count(), 10, "{list}");
    assert!(list.contains("03-mdi"), "{list}");
    let (_, chinese, _) = said(&["lesson", "list", "--lang", "zh"]);
    assert!(chinese.contains("开机与机械回零"), "{chinese}");
    let (code, played, _) = said(&["lesson", "run", "08-offsets"]);
    assert_eq!(code, 0, "{played}");
    assert!(played.contains("step 6: done, "), "{played}");
    let (code, _, wrong) = said(&["lesson", "run", "08"]);
    assert_eq!(code, 2);
    assert!(
        wrong.contains("there is no lesson 08; there are 01-power-on"),
        "{wrong}"
    );
}

#[test]
fn the_file_of_a_teacher_is_checked_with_its_place() {
    let text = "(title: (zh: \"一\", en: \"One\"), about: (zh: \"一\", en: \"one\"), steps: [\n\
        (text: (zh: \"按\", en: \"press\"), hint: (zh: \"按\", en: \"press\"),\n\
        until: [\"mode 自动方式\"], solution: [\"press AUTO\"]),\n\
        (text: (zh: \"按\", en: \"press\"), hint: (zh: \"按\", en: \"press\"),\n\
        until: [\"lamp SBK on\"], solution: [\"press MDI\"])])\n";
    let mine = Scratch::new("lesson.ron", text.as_bytes());
    let (code, played, _) = said(&["lesson", "check", mine.path()]);
    assert_eq!(code, 1);
    assert!(played.contains("step 1: done"), "{played}");
    assert!(
        played.contains("step 2: does not come true: lamp SBK on: "),
        "{played}"
    );
    let wrong = Scratch::new(
        "wrong.ron",
        text.replace("lamp SBK on", "lamp SBKK on").as_bytes(),
    );
    let (code, _, complaint) = said(&["lesson", "check", wrong.path()]);
    assert_eq!(code, 2);
    assert!(
        complaint.contains("wrong.ron: step 2, until: lamp SBKK on: "),
        "{complaint}"
    );
}
