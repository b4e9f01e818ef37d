//! Selects the language: from `--lang`, else from the operating system.

use std::env;
use std::ffi::OsString;

use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use gsk_runner::Language;

/// Creates the parser for the value of `--lang`.
pub(super) fn language_parser() -> impl TypedValueParser<Value = Language> {
    let words = [("zh", "Chinese"), ("en", "English")];
    // The parser accepts no other word.
    PossibleValuesParser::new(words.map(|(word, help)| PossibleValue::new(word).help(help)))
        .map(|word| parse_language(&word).unwrap_or_default())
}

/// The default language of a command: Chinese on a Chinese system, else `None`, as without
/// `--lang` (COMMAND-8).
pub fn system_language() -> Option<Language> {
    let chinese = locale().is_some_and(|it| is_chinese(&it));
    chinese.then_some(Language::Zh)
}

/// The language of the window at the first start, before one is selected (WINDOW-16).
pub fn first_window_language() -> Language {
    window_language(locale().as_deref())
}

/// English if the locale names another language than Chinese; Chinese, the panel's default, if
/// it is Chinese or names none.
fn window_language(locale: Option<&str>) -> Language {
    match locale {
        Some(name) if !is_chinese(name) && !is_unset(name) => Language::En,
        _ => Language::Zh,
    }
}

/// Whether a locale names no language: `C`, `POSIX`, `C.UTF-8`.
fn is_unset(locale: &str) -> bool {
    let name = locale.split('.').next().unwrap_or_default();
    matches!(name, "C" | "POSIX")
}

/// Returns the locale of the user's account; `None` if the system reports none.
fn locale() -> Option<String> {
    // The first variable that is set decides, as usual. This holds on Windows, too, for
    // shells ported from Unix; otherwise the operating system decides.
    let variables = ["LC_ALL", "LC_MESSAGES", "LANG"].map(env::var);
    let first_set = variables.into_iter().flatten().find(|it| !it.is_empty());
    first_set.or_else(system)
}

/// The language for error messages about a command line that may be malformed: the value of
/// `--lang` in `words`, else the language of the operating system.
pub fn find_language(words: &[OsString]) -> Option<Language> {
    let mut words = words.iter().filter_map(|word| word.to_str());
    let mut requested = None;
    while let Some(word) = words.next() {
        let value = match word {
            "--lang" => words.next(),
            word => word.strip_prefix("--lang="),
        };
        requested = value.and_then(parse_language).or(requested);
    }
    requested.or_else(system_language)
}

fn parse_language(word: &str) -> Option<Language> {
    match word {
        "zh" => Some(Language::Zh),
        "en" => Some(Language::En),
        _ => None,
    }
}

#[cfg(any(unix, windows))]
fn system() -> Option<String> {
    sys_locale::get_locale()
}

/// Returns `None`: a page in a browser has no command line.
#[cfg(not(any(unix, windows)))]
const fn system() -> Option<String> {
    None
}

/// Whether a locale such as `zh_CN.UTF-8` or `zh-Hans-CN` is Chinese.
pub fn is_chinese(locale: &str) -> bool {
    locale.split(['_', '-', '.', '@']).next() == Some("zh")
}

#[cfg(test)]
mod tests {
    use super::{is_chinese, window_language};
    use gsk_messages::Language;

    #[test]
    fn the_first_window_speaks_the_language_of_the_system() {
        for (locale, language) in [
            (Some("en_US.UTF-8"), Language::En),
            (Some("de-CH"), Language::En),
            (Some("zh_CN.UTF-8"), Language::Zh),
            (Some("C.UTF-8"), Language::Zh),
            (Some("POSIX"), Language::Zh),
            (None, Language::Zh),
        ] {
            assert_eq!(window_language(locale), language, "{locale:?}");
        }
    }

    #[test]
    fn the_first_part_of_a_locale_is_its_language() {
        for locale in [
            "zh",
            "zh_CN.UTF-8",
            "zh_TW@radical",
            "zh-Hans-CN",
            "zh.UTF-8",
        ] {
            assert!(is_chinese(locale), "{locale}");
        }
        for locale in [
            "",
            "C",
            "POSIX",
            "C.UTF-8",
            "en_HK.UTF-8",
            "de_CH",
            "zhx_CN",
        ] {
            assert!(!is_chinese(locale), "{locale}");
        }
    }
}
