//! Checks that every page of the page table has its case: the keys that open it, and the LCD
//! as text and as a picture.

use gsk_messages::Language;
use gsk_panel::pages::{PAGES, PageId};
use gsk_tests::case_dir;

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
