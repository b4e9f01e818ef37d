//! Evaluates statements of macro B: values, jumps, loops and calls.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::ProgramId;
use crate::interpreter::flow::program_position::{CallKind, ProgramCall, ProgramPosition};
use crate::interpreter::macros::formula::{self, FormulaContext, evaluate_formula};
use crate::interpreter::macros::levels::{LocalVariables, ModalCall, RunningLoop};
use crate::interpreter::macros::variable::ReadError;
use crate::program::{
    CodeCall, FormulaCode, IfAction, MacroAssignment, MacroCall, MacroStatement, Program,
    ProgramBlock, ProgramMemory, Syntax,
};

/// Greatest depth to which macro calls can be nested.
pub(crate) const MAX_MACRO_DEPTH: usize = 4;
/// Number of the variable whose assignment raises an alarm.
const ALARM_VARIABLE: u32 = 3000;
/// Greatest number that a program may assign to #3000.
const MAX_ALARM_NUMBER: f64 = 99.0;
/// Greatest number of characters of the alarm text after #3000.
const MAX_ALARM_TEXT_CHARS: usize = 26;
/// Greatest number of groups of I, J and K in a call.
const MAX_ARGUMENT_GROUPS: u8 = 10;

/// The effect of a macro B statement, which the caller carries out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum StatementEffect {
    /// Sets the variable with this number to a value, or with `None` to null.
    Assign(u32, Option<f64>),
    /// The statement jumps to this sequence number (GOTO).
    Jump(i64),
    /// Runs the blocks of this loop, at its DO, for the first time or again.
    Enter(RunningLoop),
    /// Jumps from END back to its DO, which is the block with this index.
    Repeat(u32),
    /// Leaves a loop: jumps to the block after the END with this index.
    Leave(u32),
    /// Calls a macro (G65) with these values of its local variables.
    Call(ProgramCall, LocalVariables),
    /// The statement puts this modal call into force (G66).
    Modal(ModalCall),
    /// The statement cancels the modal call that was made last (G67).
    CancelModal,
    /// Changes nothing and continues with the next block, as after a condition that does not
    /// hold.
    Nothing,
}

/// The data that determine the effect of a statement, besides its formulas: program, block and
/// running calls.
pub(crate) struct StatementContext<'a> {
    pub(crate) program: &'a Program,
    pub(crate) programs: &'a ProgramMemory,
    pub(crate) position: ProgramPosition,
    pub(crate) calls: &'a [ProgramCall],
    pub(crate) syntax: Syntax,
    /// The innermost running loop, which a DO repeats or an END ends; `None` outside loops.
    pub(crate) current_loop: Option<RunningLoop>,
}

/// Evaluates a statement without changing anything; the caller carries out the effect.
///
/// # Errors
/// The alarm of the statement or of a formula, or a variable that cannot be read yet.
pub(crate) fn evaluate_statement(
    statement: &MacroStatement,
    context: &StatementContext<'_>,
    formula_context: FormulaContext<'_>,
) -> Result<StatementEffect, ReadError> {
    match statement {
        MacroStatement::Assign(assignment) => evaluate_assignment(assignment, formula_context),
        MacroStatement::Goto(target) => evaluate_jump(target, formula_context),
        MacroStatement::If(condition, then) => match (
            formula::is_condition_true(condition, formula_context)?,
            then,
        ) {
            (false, _) => Ok(StatementEffect::Nothing),
            (true, IfAction::Goto(target)) => evaluate_jump(target, formula_context),
            (true, IfAction::Assign(assignment)) => {
                evaluate_assignment(assignment, formula_context)
            }
        },
        MacroStatement::Do(condition, number) => {
            let known_loop = context
                .current_loop
                .filter(|it| it.first_block == context.position.block);
            let entered = match known_loop {
                Some(known) => known,
                None => context.find_loop(*number)?,
            };
            let is_continued = match condition {
                Some(condition) => formula::is_condition_true(condition, formula_context)?,
                None => true,
            };
            Ok(if is_continued {
                StatementEffect::Enter(entered)
            } else {
                StatementEffect::Leave(entered.last_block)
            })
        }
        MacroStatement::End(number) => {
            let is_matching_loop =
                |it: &RunningLoop| it.number == *number && it.last_block == context.position.block;
            let ended = context.current_loop.filter(is_matching_loop);
            let ended = ended.ok_or_else(|| loop_alarm(say::loop_end_alone(*number)))?;
            Ok(StatementEffect::Repeat(ended.first_block))
        }
        MacroStatement::Call(call) => {
            let caller = MacroCaller {
                name: "G65",
                max_runs: 99,
                codes_ordinary: false,
            };
            evaluate_macro_call(call, &caller, context, formula_context)
        }
        MacroStatement::ModalCall(_) if context.position.program == ProgramId::Mdi => {
            Err(mdi_call_alarm("G66"))
        }
        MacroStatement::ModalCall(call) => Ok(StatementEffect::Modal(ModalCall {
            program: context.find_called_program("G66", call, formula_context)?,
            runs: evaluate_runs(call, 9999, formula_context)?,
            arguments: evaluate_arguments(call, formula_context)?,
        })),
        MacroStatement::CancelModalCall => Ok(StatementEffect::CancelModal),
        // A block of words is no statement; the reader evaluates its words.
        MacroStatement::Words(_) => Ok(StatementEffect::Nothing),
    }
}

/// The code that calls a macro, and the limits of the call.
struct MacroCaller<'a> {
    name: &'a str,
    /// Greatest number of runs that the call may command.
    max_runs: i64,
    /// Whether codes that call by parameters are ordinary codes in the macro, which call no
    /// program.
    codes_ordinary: bool,
}

fn evaluate_macro_call(
    call: &MacroCall,
    caller: &MacroCaller<'_>,
    context: &StatementContext<'_>,
    formula_context: FormulaContext<'_>,
) -> Result<StatementEffect, ReadError> {
    if context.position.program == ProgramId::Mdi {
        return Err(mdi_call_alarm(caller.name));
    }
    let nested = context.calls.iter().filter(|it| !it.kind.is_subprogram());
    if nested.count() >= MAX_MACRO_DEPTH {
        let detail = say::call_too_deep(caller.name, MAX_MACRO_DEPTH + 1, MAX_MACRO_DEPTH);
        return Err(Alarm::new(number::CALL_TOO_DEEP).with_detail(detail).into());
    }
    let program_call = ProgramCall {
        program: context.find_called_program(caller.name, call, formula_context)?,
        runs_left: evaluate_runs(call, caller.max_runs, formula_context)?,
        return_position: context.position.next_block(),
        kind: CallKind::Macro,
        first_block: 0,
        block_count: None,
        codes_ordinary: caller.codes_ordinary,
    };
    Ok(StatementEffect::Call(
        program_call,
        evaluate_arguments(call, formula_context)?,
    ))
}

/// Evaluates the macro call that a G or M code makes by a parameter of macro B.
///
/// # Errors
/// As for [`evaluate_statement`].
pub(crate) fn evaluate_code_call(
    code_call: &CodeCall,
    context: &StatementContext<'_>,
    formula_context: FormulaContext<'_>,
) -> Result<StatementEffect, ReadError> {
    let (letter, code) = code_call.code;
    let caller = MacroCaller {
        name: &format!("{letter}{code:02}"),
        max_runs: 9999,
        codes_ordinary: letter == 'G',
    };
    evaluate_macro_call(&code_call.call, &caller, context, formula_context)
}

fn mdi_call_alarm(name: &str) -> ReadError {
    let detail = say::macro_call_in_mdi(name);
    Alarm::new(number::BAD_G).with_detail(detail).into()
}

fn evaluate_assignment(
    assignment: &MacroAssignment,
    formula_context: FormulaContext<'_>,
) -> Result<StatementEffect, ReadError> {
    let variable = evaluate_formula(&assignment.variable, 1.0, formula_context)?;
    let variable = formula::to_variable_number(variable.unwrap_or(0.0))?;
    let value = evaluate_formula(&assignment.value, 1.0, formula_context)?;
    if variable == ALARM_VARIABLE {
        return Err(program_alarm(value, &assignment.comment).into());
    }
    Ok(StatementEffect::Assign(variable, value))
}

/// The alarm 3000 + n with `text` that `#3000=n (text)` raises; an empty `value` counts as 0.
/// If n is out of range, the alarm for a value out of range.
fn program_alarm(value: Option<f64>, text: &str) -> Alarm {
    let value = formula::round_half_away(value.unwrap_or(0.0));
    if !(0.0..=MAX_ALARM_NUMBER).contains(&value) {
        let detail = say::macro_alarm_out_of_range(value);
        return Alarm::new(number::OUT_OF_RANGE).with_detail(detail);
    }
    let text: String = text.chars().take(MAX_ALARM_TEXT_CHARS).collect();
    Alarm::new(number::MACRO_ALARM + value as u16).with_detail(say::as_written(text))
}

fn evaluate_jump(
    target: &FormulaCode,
    formula_context: FormulaContext<'_>,
) -> Result<StatementEffect, ReadError> {
    let target = evaluate_integer(target, formula_context)?;
    if (1..=9999).contains(&target) {
        return Ok(StatementEffect::Jump(target));
    }
    let detail = say::goto_out_of_range(target);
    Err(Alarm::new(number::BAD_JUMP).with_detail(detail).into())
}

fn evaluate_integer(
    expression: &FormulaCode,
    formula_context: FormulaContext<'_>,
) -> Result<i64, ReadError> {
    let value = evaluate_formula(expression, 1.0, formula_context)?;
    Ok(formula::round_half_away(value.unwrap_or(0.0)) as i64)
}

fn evaluate_runs(
    call: &MacroCall,
    max_runs: i64,
    formula_context: FormulaContext<'_>,
) -> Result<u16, ReadError> {
    let Some(runs) = &call.runs else {
        return Ok(1);
    };
    let runs = evaluate_integer(runs, formula_context)?;
    if (1..=max_runs).contains(&runs) {
        return Ok(runs as u16);
    }
    let detail = say::macro_runs_out_of_range(runs, max_runs);
    Err(Alarm::new(number::OUT_OF_RANGE).with_detail(detail).into())
}

/// Evaluates the arguments of a call to the local variables of the macro.
///
/// I, J and K form groups. A letter that does not follow the previous one of them in the
/// alphabet begins the next group, so one rule reads both argument lists of the manual.
fn evaluate_arguments(
    call: &MacroCall,
    formula_context: FormulaContext<'_>,
) -> Result<LocalVariables, ReadError> {
    let arguments = call.arguments.iter().map(|(address, value)| {
        let value = evaluate_formula(value, 0.001, formula_context)?;
        Ok((*address, value))
    });
    locals_from_arguments(arguments)
}

/// Converts arguments (letter and value) to the local variables of a macro.
///
/// # Errors
/// 129 for a letter that is no argument, or for more than 10 groups of I, J and K.
pub(crate) fn locals_from_arguments(
    arguments: impl Iterator<Item = Result<(u8, Option<f64>), ReadError>>,
) -> Result<LocalVariables, ReadError> {
    let mut locals = LocalVariables::new();
    let (mut group, mut last) = (0_u8, None);
    for argument in arguments {
        let (address, value) = argument?;
        let variable = match address {
            b'I' | b'J' | b'K' => {
                let rank = address - b'I';
                group += u8::from(last.is_some_and(|last| rank <= last));
                last = Some(rank);
                if group >= MAX_ARGUMENT_GROUPS {
                    let detail = say::macro_argument_groups(MAX_ARGUMENT_GROUPS);
                    return Err(Alarm::new(number::BAD_ARGUMENT).with_detail(detail).into());
                }
                4 + 3 * group + rank
            }
            b'A'..=b'C' => address - b'A' + 1,
            b'D'..=b'F' => address - b'D' + 7,
            b'H' => 11,
            b'M' => 13,
            b'Q'..=b'Z' => address - b'Q' + 17,
            _ => {
                let detail = say::macro_argument_address(char::from(address));
                return Err(Alarm::new(number::BAD_ARGUMENT).with_detail(detail).into());
            }
        };
        match value {
            Some(value) => locals.insert(variable, formula::round_to_stored(value)),
            None => locals.remove(&variable),
        };
    }
    Ok(locals)
}

fn loop_alarm(detail: gsk_messages::Message) -> ReadError {
    Alarm::new(number::LOOP_MISMATCH).with_detail(detail).into()
}

impl StatementContext<'_> {
    fn find_called_program(
        &self,
        name: &str,
        call: &MacroCall,
        formula_context: FormulaContext<'_>,
    ) -> Result<ProgramId, ReadError> {
        let Some(program) = &call.program else {
            let detail = say::call_without_program();
            return Err(Alarm::new(number::CALL_WITHOUT_P)
                .with_detail(detail)
                .into());
        };
        let number = evaluate_integer(program, formula_context)?;
        let program = u16::try_from(number)
            .ok()
            .and_then(|it| self.programs.find_called(it));
        program.ok_or_else(|| {
            let detail = say::call_program_missing(name, number);
            Alarm::new(number::TARGET_MISSING)
                .with_detail(detail)
                .into()
        })
    }

    /// Finds the END of the loop `number` that begins at this block. Loops in between must lie
    /// inside this loop as a whole.
    fn find_loop(&self, number: u8) -> Result<RunningLoop, ReadError> {
        let first = self.position.block;
        let mut open = vec![number];
        let mut block = ProgramBlock::default();
        for index in first + 1..self.program.block_count() {
            if self.program.read(index, self.syntax, &mut block).is_err() {
                continue;
            }
            match block.macro_statement() {
                Some(MacroStatement::Do(_, inner)) if open.contains(inner) => {
                    return Err(loop_alarm(say::loop_twice(*inner)));
                }
                Some(MacroStatement::Do(_, inner)) => open.push(*inner),
                Some(MacroStatement::End(ended)) if open.last() != Some(ended) => {
                    return Err(loop_alarm(say::loop_end_alone(*ended)));
                }
                Some(MacroStatement::End(_)) => {
                    open.pop();
                    if open.is_empty() {
                        return Ok(RunningLoop {
                            call_depth: self.calls.len(),
                            number,
                            first_block: first,
                            last_block: index,
                        });
                    }
                }
                _ => {}
            }
        }
        Err(loop_alarm(say::loop_without_end(number)))
    }
}
