//! The printed ladder: one HTML page, which a browser previews and prints on A4 or as PDF (manual
//! PLC-III 3.2.1, 打印 and 打印预览).

use gsk_core::plc::{Ladder, Network, RungBody};
use gsk_messages::{Language, say};

use super::parameters::list_parameters;
use super::rung_drawing::RungDrawing;
use crate::html::HtmlWriter;

/// The CSS style sheet of the page.
const STYLE: &str = include_str!("ladder.css");
/// Number of columns of contacts above which the page is printed across.
const MAX_UPRIGHT_COLUMNS: usize = 7;

/// Writes a ladder as an HTML page that loads nothing: the version page, the diagram with row
/// numbers and comments, messages, and the parameters. `name` is the name of the file.
pub fn print_ladder(ladder: &Ladder, name: &str, language: Language) -> String {
    let mut page = HtmlWriter::new(language);
    let title = format!("{} {name}", page.text(&say::ladder_print_title()));
    page.begin(&title, STYLE);
    let columns = ladder.networks().map(|network| columns(&network)).max();
    let columns = columns.unwrap_or(1);
    page.raw(match columns > MAX_UPRIGHT_COLUMNS {
        true => "<main class=\"wide\">",
        false => "<main>",
    });
    write_head(&mut page, ladder, &title);
    for network in ladder.networks() {
        if let Some(title) = &network.title {
            page.raw("\n<h2>");
            page.escaped(title);
            page.raw("</h2>\n");
        }
        match &network.body {
            RungBody::Structure(mark) => {
                page.raw("<p class=\"mark\">");
                page.escaped(&format!("{:04}  {mark}", network.number));
                page.raw("</p>\n");
            }
            RungBody::Rung { contacts, outputs } => {
                let mut drawing = RungDrawing::new(ladder, language, columns);
                page.picture(&drawing.draw(network.number, contacts, outputs));
            }
        }
    }
    write_messages(&mut page, ladder);
    write_parameters(&mut page, ladder);
    page.raw("</main>\n");
    page.finish()
}

/// Returns the number of columns that the contacts of a rung take.
fn columns(network: &Network) -> usize {
    match &network.body {
        RungBody::Structure(_) => 0,
        RungBody::Rung { contacts, .. } => contacts.iter().map(|element| element.size().0).sum(),
    }
}

fn write_head(page: &mut HtmlWriter, ladder: &Ladder, title: &str) {
    page.raw("<h1>");
    page.escaped(title);
    page.raw("</h1>\n<p>");
    let header = ladder.header();
    let fields = [
        &header.unit,
        &header.author,
        &header.version,
        &header.remark,
    ];
    let fields: Vec<&str> = fields
        .into_iter()
        .map(String::as_str)
        .filter(|field| !field.is_empty())
        .collect();
    page.escaped(&fields.join(" · "));
    page.raw("</p>\n<p>");
    page.message(&say::ladder_size(
        ladder.steps(),
        ladder.rung_count(),
        ladder.part_count(),
    ));
    page.raw("</p>\n");
}

fn write_messages(page: &mut HtmlWriter, ladder: &Ladder) {
    if ladder.messages().is_empty() {
        return;
    }
    page.heading(&say::ladder_tab_messages());
    page.begin_table(&[
        say::ladder_column_message_address(),
        say::ladder_column_message_number(),
        say::ladder_column_message_text(),
    ]);
    for message in ladder.messages() {
        let number = format!("{:04}", message.number);
        page.row(&[&message.bit.to_string(), &number, &message.text]);
    }
    page.end_table();
}

fn write_parameters(page: &mut HtmlWriter, ladder: &Ladder) {
    let parameters = list_parameters(ladder, page.language());
    if parameters.is_empty() {
        return;
    }
    page.heading(&say::ladder_tab_parameters());
    page.begin_table(&[
        say::ladder_column_address(),
        say::ladder_column_initial_value(),
        say::ladder_column_preset(),
        say::ladder_column_rows(),
        say::ladder_column_comment(),
    ]);
    for parameter in parameters {
        page.row(&[
            &parameter.address.to_string(),
            &parameter
                .start
                .map_or_else(String::new, |it| it.to_string()),
            &parameter.preset_text(),
            &parameter.rows_text(),
            &parameter.meaning,
        ]);
    }
    page.end_table();
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::setup::standard_ladder;

    #[test]
    fn every_rung_of_the_standard_ladder_is_on_the_page() {
        let ladder = standard_ladder();
        for language in [Language::En, Language::Zh] {
            let page = print_ladder(&ladder, "standard.il", language);
            let drawn = page.matches("<svg").count() + page.matches("class=\"mark\"").count();
            assert_eq!(drawn, ladder.rung_count() as usize);
            for rung in 1..=ladder.rung_count() {
                assert!(page.contains(&format!(">{rung:04}")), "{rung}");
            }
            assert!(page.contains("X0000.5") && page.contains("<td>A0000.0</td>"));
            assert!(!page.contains("NaN"));
        }
        let page = print_ladder(&ladder, "standard.il", Language::Zh);
        assert!(page.contains("急停") && page.contains("显示信息表"));
    }

    #[test]
    fn texts_of_the_ladder_are_escaped() {
        let source = ".REMARK \"<b>&\"\n.CMT X0.0 \"<i>\" \"<i>\"\nEND1\n.NET \"a<b\"\nLD X0.0\n\
                      OUT R1.0\nEND2";
        let ladder = Ladder::compile(source).expect("a ladder");
        let page = print_ladder(&ladder, "<x>.il", Language::En);
        assert!(page.contains("&lt;b&gt;&amp;") && page.contains("a&lt;b"));
        assert!(!page.contains("<i>") && !page.contains("<x>"));
    }
}
