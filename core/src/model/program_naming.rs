//! The names of programs as a control model writes them.

use serde::{Deserialize, Serialize};

/// How a control model writes the name of a program.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ProgramNaming {
    /// O and four digits: `O0021`.
    #[default]
    Letter,
    /// `%P` and two digits: `%P21`.
    Percent,
}

impl ProgramNaming {
    /// Returns the name of the program with this number.
    pub fn name(self, number: u16) -> String {
        match self {
            Self::Letter => format!("O{number:04}"),
            Self::Percent => format!("%P{number:02}"),
        }
    }

    /// Whether alarms need not store it: it is that of the GSK980TD.
    pub(crate) const fn is_letter(&self) -> bool {
        matches!(self, Self::Letter)
    }
}

#[cfg(test)]
mod tests {
    use super::ProgramNaming;
    use crate::model::ModelId;

    #[test]
    fn the_example_of_each_model_is_its_name() {
        for model in ModelId::ALL {
            let record = model.record();
            let example = record.program_naming().name(1);
            assert_eq!(example, record.program_name, "{model:?}");
        }
        assert_eq!(ProgramNaming::Percent.name(21), "%P21");
        assert_eq!(ProgramNaming::Letter.name(21), "O0021");
    }
}
