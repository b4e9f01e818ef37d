//! Parses the pin names of the machine file.

/// A pin name with its signs: `^` for a pull-up, `!` for an inverted level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PinName<'a> {
    pub(super) pull_up: bool,
    pub(super) inverted: bool,
    /// The board's name of the pin; empty if the pin is not wired.
    pub(super) name: &'a str,
}

impl<'a> PinName<'a> {
    pub(super) fn read(text: &'a str) -> Self {
        let name = text.trim_start_matches(['^', '!', ' ']).trim_end();
        let signs = &text[..text.len() - text.trim_start_matches(['^', '!', ' ']).len()];
        Self {
            pull_up: signs.contains('^'),
            inverted: signs.contains('!'),
            name,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn signs_are_accepted_in_any_order() {
        let both = PinName {
            pull_up: true,
            inverted: true,
            name: "PA3",
        };
        for text in ["^!PA3", "!^PA3", " ! ^ PA3 "] {
            assert_eq!(PinName::read(text), both);
        }
        assert_eq!(PinName::read("gpio4").name, "gpio4");
        assert_eq!(PinName::read("^ ").name, "");
    }
}
