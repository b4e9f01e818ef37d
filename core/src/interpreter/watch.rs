//! Read access for a debugger: formulas that no program contains, and the running calls.

use crate::alarm::Alarm;
use crate::command::{ProgramId, SourcePosition};
use crate::interpreter::flow::program_position::CallKind;
use crate::interpreter::host::Host;
use crate::interpreter::macros::formula;
use crate::interpreter::macros::system::VariableSources;
use crate::interpreter::macros::variable::ReadError;
use crate::interpreter::macros::variable_access::with_formula_context;
use crate::interpreter::reader::Interpreter;
use crate::program::{MacroCondition, ProgramMemory, WatchFormula};

/// A running call of a subprogram or macro, after the block read last.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RunningCall {
    /// The program whose blocks the call runs.
    pub program: ProgramId,
    /// The program that contains the calling block.
    pub caller: ProgramId,
    /// Line of the calling block in the text of `caller`, from 1.
    pub caller_line: u32,
    /// Number of runs left, the current one included.
    pub runs_left: u16,
    /// Whether the call has separate local variables: G65, G66 or a code that calls as G65.
    pub is_macro: bool,
    /// Whether no block of the current run has been read.
    pub is_at_begin: bool,
}

impl Interpreter {
    /// The running calls of the automatic run, the innermost last.
    pub(crate) fn running_calls<'a>(
        &'a self,
        programs: &'a ProgramMemory,
    ) -> impl Iterator<Item = RunningCall> + 'a {
        let position = self.main.position;
        self.main.calls.iter().map(move |call| {
            let caller = call.return_position.program;
            let text = programs.get(caller);
            let block = call.return_position.block.saturating_sub(1);
            RunningCall {
                program: call.program,
                caller,
                caller_line: text.map_or(0, |text| text.block_line(block)),
                runs_left: call.runs_left,
                is_macro: !matches!(call.kind, CallKind::Subprogram),
                is_at_begin: position == call.begin_position(),
            }
        })
    }

    /// Evaluates a formula with the variables of the innermost call; a comparison gives 1 or 0,
    /// and `None` is null.
    ///
    /// # Errors
    /// The alarms of formulas: 111, 112, 115, 119.
    pub(crate) fn evaluate_watch(
        &self,
        watch: &WatchFormula,
        host: &impl Host,
    ) -> Result<Option<f64>, Alarm> {
        let source = self.main.source.unwrap_or(SourcePosition {
            program: self.main.position.program,
            line: 0,
            sequence: None,
        });
        let sources = VariableSources {
            levels: &self.main.levels,
            state: self.state,
            source,
            has_huaxing_variables: self.has_huaxing_variables,
            host,
        };
        let value = with_formula_context(&self.main.levels, &sources, |context| {
            match &watch.comparison {
                None => formula::evaluate_formula(&watch.left, 1.0, context),
                Some((relation, right)) => {
                    let condition = MacroCondition {
                        left: watch.left.clone(),
                        relation: *relation,
                        right: right.clone(),
                    };
                    formula::is_condition_true(&condition, context).map(|holds| Some(holds.into()))
                }
            }
        });
        match value {
            Ok(value) => Ok(value),
            Err(ReadError::Fault(alarm)) => Err(alarm),
            // The host of a debugger is settled: no variable makes it wait.
            Err(ReadError::Wait) => Ok(None),
        }
    }
}
