//! Evaluates statements of macro B: values, jumps, loops and calls.

use gsk_messages::say;

use crate::alarm::{Alarm, number};
use crate::command::ProgramId;
use crate::interpreter::context::place::{Call, CallKind, Place};
use crate::interpreter::macros::formula::{self, Read, evaluate};
use crate::interpreter::macros::levels::{Locals, Loop, Modal};
use crate::interpreter::macros::variable::NotNow;
use crate::program::{
    Assignment, Block, CodeCall, Expression, MacroCall, Program, ProgramMemory, Statement, Syntax,
    Then,
};

/// Greatest depth of nested macro calls.
pub(crate) const MACRO_LEVELS: usize = 4;
/// The variable that raises an alarm.
const FIRST_ALARM: u32 = 3000;
/// Greatest number of an alarm of a program.
const LAST_ALARM: f64 = 99.0;
/// Greatest number of characters of an alarm text.
const ALARM_TEXT: usize = 26;
/// Greatest number of groups of I, J and K in a call.
const GROUPS: u8 = 10;

/// What a statement does. The caller carries it out.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Outcome {
    /// Sets a variable to a value, or to null.
    Assign(u32, Option<f64>),
    /// Jumps to a sequence number.
    Goto(i64),
    /// Enters a loop, or repeats it.
    Enter(Loop),
    /// Jumps from END back to its DO, at this block.
    Repeat(u32),
    /// Jumps to the block after this END.
    Leave(u32),
    /// Calls a macro with arguments (G65).
    Call(Call, Locals),
    /// Starts a modal call (G66).
    Modal(Modal),
    /// Cancels a modal call (G67).
    CancelModal,
    /// Continues with the next block.
    Nothing,
}

/// The position of a statement: program, block and calls.
pub(crate) struct Here<'a> {
    pub(crate) program: &'a Program,
    pub(crate) programs: &'a ProgramMemory,
    pub(crate) place: Place,
    pub(crate) calls: &'a [Call],
    pub(crate) syntax: Syntax,
    /// The loop that begins at this block, or the innermost one at an END.
    pub(crate) within: Option<Loop>,
}

/// Evaluates a statement. Nothing changes.
///
/// # Errors
/// The alarm of the statement or of a formula, or a variable that cannot be read yet.
pub(crate) fn carry_out(
    statement: &Statement,
    here: &Here<'_>,
    read: Read<'_>,
) -> Result<Outcome, NotNow> {
    match statement {
        Statement::Assign(assignment) => assign(assignment, read),
        Statement::Goto(target) => goto(target, read),
        Statement::If(condition, then) => match (formula::holds(condition, read)?, then) {
            (false, _) => Ok(Outcome::Nothing),
            (true, Then::Goto(target)) => goto(target, read),
            (true, Then::Assign(assignment)) => assign(assignment, read),
        },
        Statement::Do(condition, number) => {
            let known = here.within.filter(|it| it.first == here.place.block);
            let entered = match known {
                Some(known) => known,
                None => here.find_loop(*number)?,
            };
            let goes_on = match condition {
                Some(condition) => formula::holds(condition, read)?,
                None => true,
            };
            Ok(if goes_on {
                Outcome::Enter(entered)
            } else {
                Outcome::Leave(entered.last)
            })
        }
        Statement::End(number) => {
            let ends = |it: &Loop| it.number == *number && it.last == here.place.block;
            let ended = here.within.filter(ends);
            let ended = ended.ok_or_else(|| loops_wrong(say::loop_end_alone(*number)))?;
            Ok(Outcome::Repeat(ended.first))
        }
        Statement::Call(call) => {
            let by = By {
                name: "G65",
                most: 99,
                codes_ordinary: false,
            };
            macro_call(call, &by, here, read)
        }
        Statement::ModalCall(_) if here.place.program == ProgramId::Mdi => Err(call_in_mdi("G66")),
        Statement::ModalCall(call) => Ok(Outcome::Modal(Modal {
            program: here.called("G66", call, read)?,
            runs: runs(call, 9999, read)?,
            arguments: arguments(call, read)?,
        })),
        Statement::CancelModalCall => Ok(Outcome::CancelModal),
        // A block of words is no statement; the reader evaluates its words.
        Statement::Words(_) => Ok(Outcome::Nothing),
    }
}

/// The code that calls a macro, and the limits of the call.
struct By<'a> {
    name: &'a str,
    /// Greatest number of runs.
    most: i64,
    /// Whether codes that call by parameters are ordinary codes in the macro.
    codes_ordinary: bool,
}

fn macro_call(
    call: &MacroCall,
    by: &By<'_>,
    here: &Here<'_>,
    read: Read<'_>,
) -> Result<Outcome, NotNow> {
    if here.place.program == ProgramId::Mdi {
        return Err(call_in_mdi(by.name));
    }
    let nested = here.calls.iter().filter(|it| !it.kind.is_subprogram());
    if nested.count() >= MACRO_LEVELS {
        let detail = say::call_too_deep(by.name, MACRO_LEVELS + 1, MACRO_LEVELS);
        return Err(Alarm::new(number::CALL_TOO_DEEP).because(detail).into());
    }
    let call_of = Call {
        program: here.called(by.name, call, read)?,
        runs: runs(call, by.most, read)?,
        back: here.place.after(),
        kind: CallKind::Macro,
        first: 0,
        blocks: None,
        codes_ordinary: by.codes_ordinary,
    };
    Ok(Outcome::Call(call_of, arguments(call, read)?))
}

/// Evaluates the call that a G or M code makes by a parameter.
///
/// # Errors
/// As for [`carry_out`].
pub(crate) fn carry_out_code_call(
    code_call: &CodeCall,
    here: &Here<'_>,
    read: Read<'_>,
) -> Result<Outcome, NotNow> {
    let (letter, code) = code_call.code;
    let by = By {
        name: &format!("{letter}{code:02}"),
        most: 9999,
        codes_ordinary: letter == 'G',
    };
    macro_call(&code_call.call, &by, here, read)
}

fn call_in_mdi(name: &str) -> NotNow {
    let detail = say::macro_call_in_mdi(name);
    Alarm::new(number::BAD_G).because(detail).into()
}

fn assign(assignment: &Assignment, read: Read<'_>) -> Result<Outcome, NotNow> {
    let variable = evaluate(&assignment.variable, 1.0, read)?;
    let variable = formula::variable_number(variable.unwrap_or(0.0))?;
    let value = evaluate(&assignment.value, 1.0, read)?;
    if variable == FIRST_ALARM {
        return Err(program_alarm(value, &assignment.comment).into());
    }
    Ok(Outcome::Assign(variable, value))
}

/// The alarm of `#3000=n (text)`.
fn program_alarm(value: Option<f64>, text: &str) -> Alarm {
    let value = formula::rounded(value.unwrap_or(0.0));
    if !(0.0..=LAST_ALARM).contains(&value) {
        let detail = say::macro_alarm_out_of_range(value);
        return Alarm::new(number::OUT_OF_RANGE).because(detail);
    }
    let text: String = text.chars().take(ALARM_TEXT).collect();
    Alarm::new(number::MACRO_ALARM + value as u16).because(say::as_written(text))
}

fn goto(target: &Expression, read: Read<'_>) -> Result<Outcome, NotNow> {
    let target = whole(target, read)?;
    if (1..=9999).contains(&target) {
        return Ok(Outcome::Goto(target));
    }
    let detail = say::goto_out_of_range(target);
    Err(Alarm::new(number::BAD_JUMP).because(detail).into())
}

fn whole(expression: &Expression, read: Read<'_>) -> Result<i64, NotNow> {
    let value = evaluate(expression, 1.0, read)?;
    Ok(formula::rounded(value.unwrap_or(0.0)) as i64)
}

fn runs(call: &MacroCall, most: i64, read: Read<'_>) -> Result<u16, NotNow> {
    let Some(runs) = &call.runs else {
        return Ok(1);
    };
    let runs = whole(runs, read)?;
    if (1..=most).contains(&runs) {
        return Ok(runs as u16);
    }
    let detail = say::macro_runs_out_of_range(runs, most);
    Err(Alarm::new(number::OUT_OF_RANGE).because(detail).into())
}

/// The local variables that the arguments of a call set.
///
/// I, J and K count in groups. One that does not follow the last of them in the alphabet
/// begins the next group, so one rule reads both argument lists of the manual.
fn arguments(call: &MacroCall, read: Read<'_>) -> Result<Locals, NotNow> {
    let arguments = call.arguments.iter().map(|(address, value)| {
        let value = evaluate(value, 0.001, read)?;
        Ok((*address, value))
    });
    arguments_of(arguments)
}

/// The local variables of arguments whose values are known.
///
/// # Errors
/// 129 for a letter that is no argument, or too many groups.
pub(crate) fn arguments_of(
    arguments: impl Iterator<Item = Result<(u8, Option<f64>), NotNow>>,
) -> Result<Locals, NotNow> {
    let mut locals = Locals::new();
    let (mut group, mut last) = (0_u8, None);
    for argument in arguments {
        let (address, value) = argument?;
        let variable = match address {
            b'I' | b'J' | b'K' => {
                let rank = address - b'I';
                group += u8::from(last.is_some_and(|last| rank <= last));
                last = Some(rank);
                if group >= GROUPS {
                    let detail = say::macro_argument_groups(GROUPS);
                    return Err(Alarm::new(number::BAD_ARGUMENT).because(detail).into());
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
                return Err(Alarm::new(number::BAD_ARGUMENT).because(detail).into());
            }
        };
        match value {
            Some(value) => locals.insert(variable, formula::kept(value)),
            None => locals.remove(&variable),
        };
    }
    Ok(locals)
}

fn loops_wrong(detail: gsk_messages::Message) -> NotNow {
    Alarm::new(number::LOOP_MISMATCH).because(detail).into()
}

impl Here<'_> {
    fn called(&self, name: &str, call: &MacroCall, read: Read<'_>) -> Result<ProgramId, NotNow> {
        let Some(program) = &call.program else {
            let detail = say::call_without_program();
            return Err(Alarm::new(number::CALL_WITHOUT_P).because(detail).into());
        };
        let number = whole(program, read)?;
        let found = u16::try_from(number)
            .ok()
            .and_then(|it| self.programs.find(it));
        found.ok_or_else(|| {
            let detail = say::call_program_missing(name, number);
            Alarm::new(number::TARGET_MISSING).because(detail).into()
        })
    }

    /// The loop that begins at this block, with the index of its END. Loops in between must
    /// lie inside it as a whole.
    fn find_loop(&self, number: u8) -> Result<Loop, NotNow> {
        let first = self.place.block;
        let mut open = vec![number];
        let mut block = Block::default();
        for index in first + 1..self.program.block_count() {
            if self.program.read(index, self.syntax, &mut block).is_err() {
                continue;
            }
            match block.macro_statement() {
                Some(Statement::Do(_, inner)) if open.contains(inner) => {
                    return Err(loops_wrong(say::loop_twice(*inner)));
                }
                Some(Statement::Do(_, inner)) => open.push(*inner),
                Some(Statement::End(ended)) if open.last() != Some(ended) => {
                    return Err(loops_wrong(say::loop_end_alone(*ended)));
                }
                Some(Statement::End(_)) => {
                    open.pop();
                    if open.is_empty() {
                        return Ok(Loop {
                            depth: self.calls.len(),
                            number,
                            first,
                            last: index,
                        });
                    }
                }
                _ => {}
            }
        }
        Err(loops_wrong(say::loop_without_end(number)))
    }
}
