//! Finds the program that a code calls: by parameters of the control model, and by its own
//! number.
//!
//! ```text
//!   220–229   a G code    O9010–O9019   with arguments, as G65
//!   230–239   an M code   O9020–O9029   with arguments, as G65
//!   240–242   an M code   O9001–O9003   as M98
//!   243       every T     O9000         as M98 (of the mill 040.5)
//!
//!   of the mill:
//!   6044–6046 M codes from 6044 on, 6046 of them, call O(6045) and on, as M98
//!   M9000 to M9999 call the program of their number, with arguments
//! ```

use serde::Deserialize;

use super::{ControlModel, ModelId, code_calls};

/// The G codes of macro B that call programs or cancel calls, G65 to G67.
const CALLS: core::ops::RangeInclusive<u16> = 65..=67;
/// The greatest number of a program.
const LAST_PROGRAM: i64 = 9999;

/// The parameters that assign subprograms to a range of M codes.
#[derive(Clone, Debug, Deserialize)]
pub(crate) struct CallRange {
    /// Number of the parameter that has the first M code of the range.
    first: u16,
    /// Number of the parameter that has the program number that the first code calls.
    program: u16,
    /// Number of the parameter that has the number of codes in the range; 0 for no codes.
    count: u16,
    /// M codes that keep their function even if they are within the range.
    reserved: Vec<i64>,
}

impl ControlModel {
    /// The number of the subprogram that the M code `code` calls because it is in a range of
    /// calling codes; `None` if it is not.
    pub fn m_subprogram(&self, code: i64) -> Option<i64> {
        let range = self.record().m_calls.as_ref()?;
        let value = |number| i64::from(self.parameter(number));
        let (program, count) = (value(range.program), value(range.count));
        let off = count == 0 || program + count - 1 > LAST_PROGRAM;
        let index = code - value(range.first);
        let calls = !off && !range.reserved.contains(&code) && (0..count).contains(&index);
        calls.then_some(program + index)
    }

    /// Whether the M code `code` calls the program whose number it is, as a macro.
    pub fn is_macro_m_code(&self, code: i64) -> bool {
        let macros = self.record().m_macros;
        macros.is_some_and(|(first, last)| (first..=last).contains(&code))
    }

    /// The code that calls a program because of this parameter of macro B; 0 as delivered, so that
    /// a program is checked without reading the parameters of the model.
    pub(crate) fn calling_code(&self, parameter: u16) -> i32 {
        match self.id() {
            ModelId::Gsk980td | ModelId::Gsk980mdi => {
                self.parameters.get(&parameter).copied().unwrap_or(0)
            }
            // The NC-B08 assigns its inputs by these numbers, the Huaxing has none of them.
            ModelId::Hx31 | ModelId::Ncb08 => 0,
        }
    }

    /// Whether a parameter assigns a program to at least one G code.
    pub fn has_g_calls(&self) -> bool {
        let mut parameters = code_calls::FIRST_G_PARAMETER..code_calls::FIRST_G_PARAMETER + 10;
        parameters.any(|number| self.calling_code(number) != 0)
    }

    /// Whether each T word calls a program, because of a parameter.
    pub(crate) fn has_t_calls(&self) -> bool {
        match self.id().is_mill() {
            true => self.parameter(code_calls::MILL_T_PARAMETER) >> code_calls::MILL_T_BIT & 1 == 1,
            false => self.calling_code(code_calls::T_PARAMETER) != 0,
        }
    }

    /// The number of the program that a G, M or T word with the number `code` calls; `None` if
    /// it calls none. The result ignores that within a running call the code may be an
    /// ordinary one.
    pub fn called_program(&self, letter: u8, code: i64) -> Option<u16> {
        let number = u16::try_from(code).ok()?;
        let nth = |parameters: core::ops::Range<u16>, program: u16| {
            let mut all = (program..).zip(parameters);
            let called =
                all.find(|(_, parameter)| self.calling_code(*parameter) == i32::from(number));
            called.map(|(program, _)| program).filter(|_| number != 0)
        };
        let ten = |first: u16| first..first + 10;
        match letter {
            b'G' if CALLS.contains(&number) => None,
            b'G' => nth(
                ten(code_calls::FIRST_G_PARAMETER),
                code_calls::FIRST_G_PROGRAM,
            ),
            b'M' if self.is_macro_m_code(code) => Some(number),
            b'M' => {
                let by_range = self.m_subprogram(code);
                let plain =
                    code_calls::FIRST_PLAIN_M_PARAMETER..code_calls::FIRST_PLAIN_M_PARAMETER + 3;
                by_range
                    .and_then(|program| u16::try_from(program).ok())
                    .or_else(|| {
                        nth(
                            ten(code_calls::FIRST_M_PARAMETER),
                            code_calls::FIRST_M_PROGRAM,
                        )
                    })
                    .or_else(|| nth(plain, code_calls::FIRST_PLAIN_M_PROGRAM))
            }
            b'T' => self.has_t_calls().then_some(code_calls::T_PROGRAM),
            _ => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn with(id: ModelId, parameters: &[(u16, i32)]) -> ControlModel {
        let mut model = ControlModel::new(id);
        for (number, value) in parameters {
            assert_eq!(model.set_parameter(*number, *value), Ok(()));
        }
        model
    }

    #[test]
    fn codes_call_by_parameters() {
        let parameters = [(221, 81), (230, 60), (242, 7), (243, 1)];
        let model = with(ModelId::Gsk980td, &parameters);
        assert_eq!(model.called_program(b'G', 81), Some(9011));
        assert_eq!(model.called_program(b'G', 65), None);
        assert_eq!(model.called_program(b'M', 60), Some(9020));
        assert_eq!(model.called_program(b'M', 7), Some(9003));
        assert_eq!(model.called_program(b'M', 0), None);
        assert_eq!(model.called_program(b'T', 101), Some(9000));
        assert_eq!(ControlModel::default().called_program(b'T', 1), None);
    }

    /// `calling_code` relies on it.
    #[test]
    fn no_code_calls_as_delivered() {
        let calling = code_calls::FIRST_G_PARAMETER..=code_calls::T_PARAMETER;
        for id in [ModelId::Gsk980td, ModelId::Gsk980mdi] {
            for (number, parameter) in id.record().parameters() {
                let assigns = calling.contains(number);
                assert!(!assigns || parameter.delivered == 0, "{id:?} {number}");
            }
        }
    }

    #[test]
    fn an_input_of_the_ncb08_calls_no_program() {
        let model = with(ModelId::Ncb08, &[(230, 3)]);
        assert!(!model.has_g_calls());
        assert_eq!(model.called_program(b'G', 12), None);
        assert_eq!(model.called_program(b'M', 3), None);
    }

    /// Parameters 6044 to 6046: facts C32 and C33.
    #[test]
    fn codes_of_a_mill_call_by_a_range() {
        let range = [(6044, 2000), (6045, 300), (6046, 100)];
        let model = with(ModelId::Gsk980mdi, &range);
        assert_eq!(model.called_program(b'M', 2000), Some(300));
        assert_eq!(model.called_program(b'M', 2099), Some(399));
        assert_eq!(model.called_program(b'M', 2100), None);
        assert_eq!(model.called_program(b'M', 9005), Some(9005));
        let off = with(ModelId::Gsk980mdi, &[(6045, 9990), (6046, 11)]);
        assert_eq!(off.called_program(b'M', 3), None);
    }
}
