//! Checks that every page of the page table has its case: the keys that open it, and the LCD
//! as text and as a picture.

use gsk_core::model::ModelId;
use gsk_help::{Subject, topic_of};
use gsk_messages::Language;
use gsk_panel::face::{Face, face_of};
use gsk_panel::keys::KeyRow;
use gsk_panel::pages::{PAGES, PageId, PageRow};
use gsk_tests::{case_dir, repository};

/// The lathes with a face of their own, and the folders of their cases.
const MODELS: [(ModelId, [&str; 3]); 2] = [
    (ModelId::Ncb08, ["ncb08", "ncb08-keys", "ncb08-pages"]),
    (ModelId::Hx31, ["hx31", "hx31-keys", "hx31-pages"]),
];
/// Number of scripts about the panel of a model.
const PANEL_SCRIPTS: usize = 40;

#[test]
fn every_page_has_its_case() {
    let title = |page: PageId| page.title().text(Language::Zh);
    let pages = PAGES.iter().map(|row| (row.name, title(row.page)));
    for (name, title) in pages.chain([("power-on", String::new())]) {
        let folder = case_dir(&format!("page-{name}")).expect(name);
        let file = |name: &str| std::fs::read(folder.join(name)).unwrap_or_default();
        let text = String::from_utf8(file("screen.txt")).unwrap();
        let rows: Vec<&str> = text.lines().collect();
        assert_eq!(rows.len(), 15, "page-{name}/screen.txt: rows");
        let head: String = rows[0].chars().take(title.chars().count()).collect();
        assert_eq!(head, title, "page-{name}/screen.txt: title");
        assert!(
            file("screen.png").starts_with(b"\x89PNG"),
            "page-{name}/screen.png"
        );
        let script = String::from_utf8(file("operate.txt")).unwrap();
        assert!(
            script.contains("press") || name == "power-on",
            "page-{name}: keys"
        );
    }
}

/// The pages of a face that the GSK980TD does not have.
fn own_pages(face: &Face) -> impl Iterator<Item = &'static PageRow> {
    let main = face_of(ModelId::Gsk980td);
    face.pages
        .iter()
        .filter(|row| main.page(row.page).is_none())
}

/// The keys of a face that the GSK980TD does not have.
fn own_keys(face: &'static Face) -> impl Iterator<Item = &'static KeyRow> {
    let main = face_of(ModelId::Gsk980td);
    face.keys().filter(|row| main.key(row.key).is_none())
}

#[test]
fn every_key_and_page_of_a_model_has_its_script() {
    for (model, folders) in MODELS {
        let scripts: Vec<String> = folders
            .iter()
            .flat_map(|folder| {
                let folder = repository().join("tests/cases/models").join(folder);
                std::fs::read_dir(folder).unwrap()
            })
            .filter_map(|case| {
                std::fs::read_to_string(case.unwrap().path().join("operate.txt")).ok()
            })
            .collect();
        assert!(scripts.len() > PANEL_SCRIPTS, "{model:?}");
        let lines: Vec<&str> = scripts.iter().flat_map(|script| script.lines()).collect();
        let face = face_of(model);
        for row in face.pages {
            let wanted = format!("expect page {}", row.name);
            let by_display = face.pages.iter().any(|other| {
                let same = other.key == row.key && other.display == row.display;
                same && lines.contains(&&*format!("expect page {}", other.name))
            });
            let own = own_pages(face).any(|own| own.page == row.page);
            assert!(by_display, "{model:?}: {wanted}");
            assert!(!own || lines.contains(&&*wanted), "{model:?}: {wanted}");
        }
        for row in own_keys(face) {
            let pressed = format!("press {}", row.id);
            assert!(
                lines.iter().any(|line| line.starts_with(&pressed)),
                "{model:?}: {pressed}"
            );
        }
    }
}

#[test]
fn every_key_and_page_of_a_model_has_help() {
    for (model, _) in MODELS {
        let face = face_of(model);
        let keys = own_keys(face).map(|row| Subject::Key(row.id));
        for subject in keys.chain(own_pages(face).map(|row| Subject::Page(row.name))) {
            let topic = topic_of(model, subject).expect("a topic");
            for language in [Language::En, Language::Zh] {
                assert!(!topic.rule(language).is_empty(), "{model:?}: {subject:?}");
            }
        }
        assert!(
            topic_of(model, Subject::Key("YM")).is_none(),
            "{model:?} has no Y axis"
        );
    }
    let main = topic_of(ModelId::Gsk980td, Subject::Key("CHUCK"));
    assert!(main.is_none(), "the GSK980TD has no such key");
}

#[test]
fn cases_named_in_the_tables_of_models_exist() {
    for name in ["docs/models.md", "docs/models.zh-CN.md"] {
        let text = std::fs::read_to_string(repository().join(name)).unwrap();
        let quoted = text.split('`').skip(1).step_by(2);
        let cases = quoted.filter(|word| {
            let folder = word.split_once('/').map(|(folder, _)| folder);
            MODELS
                .iter()
                .any(|(_, folders)| folder.is_some_and(|it| folders.contains(&it)))
        });
        let mut count = 0;
        for case in cases {
            let folder = repository().join("tests/cases/models").join(case);
            assert!(folder.join("case.ron").is_file(), "{name}: {case}");
            count += 1;
        }
        assert!(count > 80, "{name}: {count}");
    }
}

/// The rows of the table of a model in a document: what the manual names, and its cases.
fn proof_rows(text: &str, folder: &str) -> Vec<(String, String)> {
    let lines: Vec<&str> = text.lines().collect();
    let is_heading =
        |line: &&str| line.starts_with("| Page, key") || line.starts_with("| 页面、按键");
    let tables = lines.split(is_heading).skip(1);
    // After the heading comes the line of the columns; the table ends at a blank line.
    let tables = tables.map(|lines| {
        let rows = lines
            .iter()
            .skip(1)
            .take_while(|line| line.starts_with('|'));
        let cells = rows.filter_map(|line| {
            let cells = line.strip_prefix("| ")?.strip_suffix(" |")?;
            let (named, proof) = cells.split_once(" | ")?;
            Some((named.to_owned(), proof.to_owned()))
        });
        cells.collect::<Vec<_>>()
    });
    let mut tables = tables.filter(|rows| rows.iter().any(|(_, proof)| proof.contains(folder)));
    tables.next().unwrap_or_default()
}

/// The numbers after `letter` in a text, ranges such as `X0 to X7` and `P200~P231` included.
fn numbers_after(letter: char, text: &str) -> Vec<u16> {
    let text = text.replace(" to ", "~").replace('～', "~");
    let mut found = Vec::new();
    for part in text.split(|c: char| !(c.is_ascii_alphanumeric() || c == '~')) {
        let number = |word: &str| word.strip_prefix(letter)?.parse::<u16>().ok();
        match part.split_once('~') {
            Some((first, last)) => {
                let ends = number(first).zip(number(last));
                found.extend(ends.into_iter().flat_map(|(first, last)| first..=last));
            }
            None => found.extend(number(part)),
        }
    }
    found
}

/// The table of a model has all that the program derives of it (keys, parameters, contacts) and
/// all that `model-contents.tsv` lists, each with a case or the words for a title alone.
#[test]
fn the_table_of_a_model_is_complete() {
    let contents = include_str!("../model-contents.tsv");
    for (name, title_only) in [
        ("docs/models.md", "title only in the source"),
        ("docs/models.zh-CN.md", "资料中只有标题"),
    ] {
        let text = std::fs::read_to_string(repository().join(name)).unwrap();
        for (model, folders) in MODELS {
            let rows = proof_rows(&text, folders[1]);
            assert!(rows.len() > 20, "{name}, {model:?}: {} rows", rows.len());
            for (named, proof) in &rows {
                let is_proved = proof.contains('`') || proof == title_only;
                assert!(is_proved, "{name}, {model:?}: {named} has no case");
            }
            let named: String = rows.iter().map(|(named, _)| format!("{named} ;")).collect();
            let face = face_of(model);
            for key in own_keys(face).filter(|key| !key.id.starts_with('F')) {
                let legend = key.legend.first().copied().unwrap_or(key.name_zh);
                let is_named = named.contains(legend) || named.contains(key.id);
                assert!(is_named, "{name}, {model:?}: key {} ({legend})", key.id);
            }
            for number in model.record().parameters().keys() {
                let is_named = numbers_after('P', &named).contains(number);
                assert!(is_named, "{name}, {model:?}: P{number}");
            }
            if model == ModelId::Ncb08 {
                for (letter, contacts) in [('X', face.inputs), ('Y', face.outputs)] {
                    let listed = numbers_after(letter, &named);
                    for number in 0..contacts.len() as u16 {
                        assert!(listed.contains(&number), "{name}: {letter}{number}");
                    }
                }
            }
            let words = contents.lines().filter_map(|line| line.split_once('\t'));
            for (_, word) in words.filter(|(of, _)| *of == model.command_word()) {
                let mut parts = named.split(|c: char| !(c.is_ascii_alphanumeric() || c == '.'));
                let is_named = parts.any(|part| part == word);
                assert!(is_named, "{name}, {model:?}: {word}");
            }
        }
    }
}
