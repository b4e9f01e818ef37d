//! Which kinds of warnings are reported, and which are errors.

use std::collections::BTreeMap;

use gsk_core::preview::Lint;

/// What a warning of a kind is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LintLevel {
    /// It is not reported.
    Allow,
    /// It is reported.
    #[default]
    Warn,
    /// It is reported as an error.
    Deny,
}

/// The level of each kind: its own, else that of all.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LintLevels {
    all: LintLevel,
    own: BTreeMap<Lint, LintLevel>,
}

impl LintLevels {
    /// Sets the level of a kind; `None` sets that of all kinds without a level of their own.
    pub fn set(&mut self, lint: Option<Lint>, level: LintLevel) {
        match lint {
            Some(lint) => {
                self.own.insert(lint, level);
            }
            None => self.all = level,
        }
    }

    /// The level of a kind.
    pub fn level(&self, lint: Lint) -> LintLevel {
        self.own.get(&lint).copied().unwrap_or(self.all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_level_of_a_kind_precedes_that_of_all() {
        let mut levels = LintLevels::default();
        assert_eq!(levels.level(Lint::SlowFeed), LintLevel::Warn);
        levels.set(Some(Lint::SlowFeed), LintLevel::Allow);
        levels.set(None, LintLevel::Deny);
        assert_eq!(levels.level(Lint::SlowFeed), LintLevel::Allow);
        assert_eq!(levels.level(Lint::NoOffset), LintLevel::Deny);
    }
}
