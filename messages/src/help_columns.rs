//! The last columns of the tables of alarms, parameters and signals: what the help says about a
//! row.

use crate::Language;

/// What the help says about a row of a table, in both languages.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct HelpColumns {
    rule: [&'static str; 2],
    example: [&'static str; 2],
    /// The section of the manual that describes the subject; empty if none does.
    pub source: &'static str,
}

impl HelpColumns {
    /// Reads the five columns `rule_en`, `rule_zh`, `example_en`, `example_zh` and `source`.
    /// `None` if one of them is missing; `-` is an empty text.
    pub fn read(fields: &mut dyn Iterator<Item = &'static str>) -> Option<Self> {
        let mut text = || {
            fields
                .next()
                .map(|text| if text == "-" { "" } else { text })
        };
        let [rule_en, rule_zh] = [text()?, text()?];
        let [example_en, example_zh] = [text()?, text()?];
        Some(Self {
            rule: [rule_zh, rule_en],
            example: [example_zh, example_en],
            source: text()?,
        })
    }

    /// What the subject is for, what it does and what surprises users. Empty if the other
    /// columns contain everything.
    pub const fn rule(&self, language: Language) -> &'static str {
        self.rule[column(language)]
    }

    /// A worked example; empty if there is none.
    pub const fn example(&self, language: Language) -> &'static str {
        self.example[column(language)]
    }

    /// Columns with this rule, Chinese first, and nothing else.
    pub const fn from_rule(rule: [&'static str; 2]) -> Self {
        Self {
            rule,
            example: [""; 2],
            source: "",
        }
    }
}

const fn column(language: Language) -> usize {
    match language {
        Language::Zh => 0,
        Language::En => 1,
    }
}
