//! The page that shows the machine in a browser, without a way to operate it.

use gsk_messages::{Language, Message, say};

/// The page; `{{name}}` is replaced by a text.
const TEMPLATE: &str = include_str!("../../../../assets/pages/machine.html");

/// Returns the HTML of the agent's page in a language.
pub(super) fn render_page(language: Language) -> String {
    let code = match language {
        Language::Zh => "zh-CN",
        Language::En => "en",
    };
    let mut page = TEMPLATE.replace("{{language}}", code);
    for (name, message) in texts() {
        let text = message.text(language);
        page = page.replace(&format!("{{{{{name}}}}}"), &text);
    }
    page
}

/// Returns the texts of the page, each with its name in the template.
fn texts() -> [(&'static str, Message); 21] {
    [
        ("title", say::page_title()),
        ("lost", say::page_connection_lost()),
        ("no_alarm", say::page_no_alarm()),
        ("program", say::page_program()),
        ("block", say::page_block()),
        ("left", say::page_time_left()),
        ("spent", say::page_time_spent()),
        ("parts", say::page_parts()),
        ("work", say::page_work_position()),
        ("machine", say::page_machine_position()),
        ("feed", say::page_feed()),
        ("speed", say::page_speed()),
        ("load", say::page_load()),
        ("tool", say::page_tool()),
        ("read_only", say::page_read_only()),
        ("active", say::page_active()),
        ("hold", say::page_feed_hold()),
        ("interrupted", say::page_interrupted()),
        ("stopped", say::page_stopped()),
        ("ready", say::page_ready()),
        ("unavailable", say::page_unavailable()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_text_of_the_page_is_replaced() {
        for language in [Language::En, Language::Zh] {
            let page = render_page(language);
            assert!(!page.contains("{{"), "{page}");
        }
        for (name, _) in texts() {
            assert!(TEMPLATE.contains(&format!("{{{{{name}}}}}")), "{name}");
        }
    }
}
