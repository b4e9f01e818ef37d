//! How the machine file names a pin of a board.

/// `^` pull-up, `!` level turned over, name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PinName<'a> {
    pub(super) pull_up: bool,
    pub(super) inverted: bool,
    /// As the board names it; empty: not wired.
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
    fn signs_stand_in_front_in_any_order() {
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
