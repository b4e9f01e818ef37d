//! `keys`, `parameters`, `alarms`, `signals`, `faults`: print the tables of the control.

use gsk_core::machine::FAULTS;
use gsk_core::model::ModelId;
use gsk_core::{alarm, memory};
use gsk_messages::{Language, Message, say};
use gsk_milling::mill_parameter_rows;
use gsk_panel::face::face_of;
use gsk_panel::keys::{Bit, KeyRole, STRIP};
use gsk_panel::signals;
use gsk_runner::report::class_name;
use gsk_window::pc_name;
use serde_json::{Value, json};

use super::{CommandError, EXIT_OK, output};
use crate::cli::{ModelTableArgs, TableArgs};

/// A table to print: heading and rows as text, and the rows as JSON.
struct PrintedTable {
    heading: Vec<&'static str>,
    rows: Vec<Vec<String>>,
    json: Vec<Value>,
}

impl PrintedTable {
    fn new(heading: &[&'static str]) -> Self {
        Self {
            heading: heading.to_vec(),
            rows: Vec::new(),
            json: Vec::new(),
        }
    }

    fn push(&mut self, row: Vec<String>, json: Value) {
        self.rows.push(row);
        self.json.push(json);
    }

    fn print(self, args: &TableArgs) -> Result<u8, CommandError> {
        let filter = args.filter.as_deref().map(str::to_lowercase);
        let wanted = |row: &[String]| {
            filter
                .as_ref()
                .is_none_or(|filter| row.iter().any(|cell| cell.to_lowercase().contains(filter)))
        };
        let mut out = String::new();
        if args.json {
            let chosen: Vec<&Value> = self
                .rows
                .iter()
                .zip(&self.json)
                .filter(|(row, _)| wanted(row))
                .map(|(_, json)| json)
                .collect();
            out = serde_json::to_string_pretty(&chosen)?;
            out.push('\n');
            output::print(&out);
            return Ok(EXIT_OK);
        }
        let heading: Vec<String> = self.heading.iter().map(ToString::to_string).collect();
        let shown: Vec<&Vec<String>> = std::iter::once(&heading)
            .chain(self.rows.iter().filter(|row| wanted(row)))
            .collect();
        let widths: Vec<usize> = (0..heading.len())
            .map(|column| {
                shown
                    .iter()
                    .map(|row| text_width(&row[column]))
                    .max()
                    .unwrap_or(0)
            })
            .collect();
        for row in shown {
            let mut line = String::new();
            for (cell, width) in row.iter().zip(&widths) {
                line.push_str(cell);
                line.push_str(&" ".repeat(width - text_width(cell) + 2));
            }
            out.push_str(line.trim_end());
            out.push('\n');
        }
        output::print(&out);
        Ok(EXIT_OK)
    }
}

/// The width of a text in terminal columns; a Chinese character takes two.
fn text_width(text: &str) -> usize {
    gsk_panel::glyphs::text_columns(text)
}

fn format_bit(area: char, bit: Bit) -> String {
    format!("{area}{}.{}", bit.byte, bit.bit)
}

/// Prints the keys of a model's panel and the lamps of the status strip.
pub fn keys(args: &ModelTableArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let mut table = PrintedTable::new(&match language {
        Some(Language::Zh) => [
            "名称",
            "键面",
            "电脑键",
            "触点",
            "指示灯",
            "中文",
            "ENGLISH",
        ],
        Some(Language::En) | None => [
            "ID", "LABEL", "PC KEY", "CONTACT", "LAMP", "中文", "ENGLISH",
        ],
    });
    for row in face_of(args.model).keys() {
        let contact = match row.role {
            KeyRole::Machine(contact) => format_bit('X', contact),
            _ => String::new(),
        };
        let lamp = row
            .lamp
            .map(|lamp| format_bit('Y', lamp))
            .unwrap_or_default();
        let label = row.legend.join(" ");
        let json = json!({
            "id": row.id, "label": label, "pc": row.pc, "contact": contact, "lamp": lamp,
            "zh": row.name_zh, "en": row.name_en,
        });
        let cells = [
            row.id,
            &label,
            &pc_name(row.pc),
            &contact,
            &lamp,
            row.name_zh,
            row.name_en,
        ];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    for row in STRIP.iter().filter(|row| row.fitted) {
        let lamp = format_bit('Y', row.lamp);
        let json = json!({
            "id": row.id, "label": row.label, "lamp": lamp, "zh": row.name_zh, "en": row.name_en,
        });
        let cells = [row.id, row.label, "", "", &lamp, row.name_zh, row.name_en];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    table.print(&args.table)
}

/// Prints the parameter table of a control model.
pub fn parameters(args: &ModelTableArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let table = match args.model {
        ModelId::Gsk980td => lathe_parameters(language),
        model if model.is_mill() => mill_parameters(language),
        model => model_parameters(model, language),
    };
    table.print(&args.table)
}

/// Lists the parameters of the mill. The column ACTS marks those that `check` and `plot`
/// apply, and gives the reason for the others.
fn mill_parameters(language: Option<Language>) -> PrintedTable {
    let mut table = PrintedTable::new(&match language {
        Some(Language::Zh) => [
            "参数号",
            "符号",
            "各轴",
            "单位",
            "范围",
            "有效",
            "中文",
            "ENGLISH",
        ],
        Some(Language::En) | None => [
            "NUMBER", "SYMBOL", "AXES", "UNIT", "RANGE", "ACTS", "中文", "MEANING",
        ],
    });
    for row in mill_parameter_rows() {
        let number = match row.bit {
            Some(bit) => format!("{:03}.{bit}", row.number),
            None => format!("{:03}", row.number),
        };
        let json = json!({
            "number": row.number, "bit": row.bit, "symbol": row.symbol,
            "each_axis": !row.axes.is_empty(), "axes": describe_axes(row.axes, None), "unit": row.unit, "range": row.range,
            "acts": row.without_effect.is_none(), "zh": row.zh, "en": row.en,
            "reason": row.without_effect.map(|reason| reason.message().text(Language::En)),
        });
        let axes = describe_axes(row.axes, language);
        let spoken = language.unwrap_or(Language::En);
        let acts = match row.without_effect {
            None => say::mill_parameter_acts().text(spoken),
            Some(reason) => reason.message().text(spoken),
        };
        let cells = [
            &number, row.symbol, &axes, row.unit, row.range, &acts, row.zh, row.en,
        ];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    table
}

/// Formats the names of the axes that have a parameter of the mill.
fn describe_axes(axes: &[u16], language: Option<Language>) -> String {
    let message = match axes {
        [] => return String::new(),
        [4, 5] => say::table_axes_additional(),
        [1, 2, 3] => say::table_axes_linear(),
        _ => say::table_axes_all(),
    };
    message.text(language.unwrap_or(Language::En))
}

/// Lists the parameters that a lathe model has in addition to those of the GSK980TD.
fn model_parameters(model: ModelId, language: Option<Language>) -> PrintedTable {
    let mut table = PrintedTable::new(&match language {
        Some(Language::Zh) => ["参数号", "单位", "范围", "出厂值", "中文", "ENGLISH"],
        Some(Language::En) | None => ["NUMBER", "UNIT", "RANGE", "FACTORY", "中文", "MEANING"],
    });
    for (number, row) in model.record().parameters() {
        let (zh, en) = (row.name(Language::Zh), row.name(Language::En));
        let range = format!("{}..{}", row.range.0, row.range.1);
        let json = json!({
            "number": number, "unit": row.unit, "range": range, "factory": row.delivered,
            "zh": zh, "en": en,
        });
        let (number, factory) = (format!("{number:03}"), row.delivered.to_string());
        let cells = [&number, &*row.unit, &range, &factory, zh, en];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    table
}

fn lathe_parameters(language: Option<Language>) -> PrintedTable {
    let mut table = PrintedTable::new(&match language {
        Some(Language::Zh) => [
            "参数号",
            "符号",
            "单位",
            "范围",
            "出厂值",
            "中文",
            "ENGLISH",
        ],
        Some(Language::En) | None => [
            "NUMBER", "SYMBOL", "UNIT", "RANGE", "FACTORY", "中文", "MEANING",
        ],
    });
    for row in memory::parameter_rows() {
        let number = match row.bit {
            Some(bit) => format!("{:03}.{bit}", row.number),
            None => format!("{:03}", row.number),
        };
        let value = row.factory_value(memory::ElectronicDisk::N0);
        let factory = if row.state {
            format!("{value:08b}")
        } else {
            value.to_string()
        };
        let range = row.range.to_string();
        let json = json!({
            "number": row.number, "bit": row.bit, "symbol": row.symbol, "unit": row.unit,
            "range": range, "factory": value, "zh": row.meaning_zh, "en": row.meaning_en,
        });
        let cells = [
            &number,
            row.symbol,
            row.unit,
            &range,
            &factory,
            row.meaning_zh,
            row.meaning_en,
        ];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    table
}

/// Prints the alarm table with causes and remedies.
pub fn alarms(args: &TableArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let heading = match language {
        Some(Language::Zh) => ["类别", "报警号", "中文", "ENGLISH", "原因", "处理"],
        Some(Language::En) | None => ["CLASS", "NUMBER", "中文", "MEANING", "CAUSE", "CURE"],
    };
    let mut table = PrintedTable::new(&heading);
    for row in alarm::rows() {
        let number = if row.last == row.number {
            format!("{:03}", row.number)
        } else {
            format!("{:03}-{:03}", row.number, row.last)
        };
        let class = class_name(row.class);
        let json = json!({
            "class": class, "number": row.number, "last": row.last, "zh": row.text_zh,
            "en": row.meaning_en, "cause": row.cause_en, "cure": row.cleared_by_en,
        });
        let advice = row.advice.as_ref();
        let [cause, cure] = match language {
            Some(Language::Zh) => [advice.map(|it| it.cause_zh), advice.map(|it| it.remedy_zh)]
                .map(Option::unwrap_or_default),
            Some(Language::En) | None => [row.cause_en, row.cleared_by_en],
        };
        let cells = [class, &number, row.text_zh, row.meaning_en, cause, cure];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    table.print(args)
}

/// Prints the table of PLC signals.
pub fn signals(args: &TableArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let spoken = language.unwrap_or(Language::En);
    let mut table = PrintedTable::new(&match spoken {
        Language::Zh => ["地址", "符号", "方向", "作用处", "中文", "ENGLISH"],
        Language::En => [
            "ADDRESS",
            "SYMBOL",
            "DIRECTION",
            "ACTS IN",
            "中文",
            "ENGLISH",
        ],
    });
    for row in signals::rows() {
        let json = json!({
            "address": row.address, "symbol": row.symbol, "direction": row.direction,
            "zh": row.text_zh, "en": row.text_en, "manual": row.manual, "acts": row.acts,
        });
        let direction = match spoken {
            Language::Zh => gsk_help::signal_direction(row, spoken),
            Language::En => row.direction.to_owned(),
        };
        let acts = describe_signal_effect(row.acts)
            .map_or_else(|| row.acts.to_owned(), |it| it.text(spoken));
        let cells = [
            row.address,
            row.symbol,
            &direction,
            &acts,
            row.text_zh,
            row.text_en,
        ];
        table.push(cells.map(str::to_owned).to_vec(), json);
    }
    table.print(args)
}

/// Translates the text of the signal table that names the effect of a signal; `None` for an unknown
/// text.
fn describe_signal_effect(written: &str) -> Option<Message> {
    Some(match written {
        "control" => say::table_acts_control(),
        "control ladder" => say::table_acts_control_ladder(),
        "engine" => say::table_acts_engine(),
        "free" => say::table_acts_free(),
        "ladder" => say::table_acts_ladder(),
        "ladder; kept for the edge, without function on this lathe" => say::table_acts_edge(),
        "control ladder; where the ladder names it (.MCODE), else alarm 019" => {
            say::table_acts_no_option_stop()
        }
        "none: this lathe has no Y axis" => say::table_acts_no_y(),
        "none: this lathe has two axes" => say::table_acts_two_axes(),
        written => {
            let pin = "none: stands in one table of the manual only; the pin is ";
            say::table_acts_one_table(written.strip_prefix(pin)?)
        }
    })
}

/// Prints the list of faults of the simulated lathe.
pub fn faults(args: &TableArgs, language: Option<Language>) -> Result<u8, CommandError> {
    let heading = match language {
        Some(Language::Zh) => ["名称", "中文", "ENGLISH", "作用"],
        Some(Language::En) | None => ["NAME", "中文", "FAULT", "WHAT IT DOES"],
    };
    let mut table = PrintedTable::new(&heading);
    for row in &FAULTS {
        let [zh, en] = [Language::Zh, Language::En].map(|language| row.label().text(language));
        let [effect_zh, effect] =
            [Language::Zh, Language::En].map(|language| row.effect().text(language));
        let json = json!({
            "name": row.name, "zh": zh, "en": en, "effect": effect, "effect_zh": effect_zh,
        });
        let shown = match language {
            Some(Language::Zh) => effect_zh,
            Some(Language::En) | None => effect,
        };
        table.push(vec![row.name.to_owned(), zh, en, shown], json);
    }
    table.print(args)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_word_of_the_table_of_signals_is_known() {
        for row in signals::rows() {
            let text = describe_signal_effect(row.acts).map(|it| it.text(Language::En));
            assert_eq!(text.as_deref(), Some(row.acts), "{}", row.address);
            let direction = gsk_help::signal_direction(row, Language::Zh);
            let words = direction.replace("PLC", "").replace("CNC", "");
            assert!(
                !words.contains(|it: char| it.is_ascii_alphabetic()),
                "{direction}"
            );
        }
    }

    #[test]
    fn the_numbers_of_the_axes_of_a_mill_are_known() {
        for row in mill_parameter_rows() {
            let known: [&[u16]; 4] = [&[], &[4, 5], &[1, 2, 3], &[1, 2, 3, 4, 5]];
            assert!(known.contains(&row.axes), "{}", row.number);
        }
    }
}
