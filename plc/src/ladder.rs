//! The compiled ladder and its properties.

use serde::{Deserialize, Serialize, Serializer};

use crate::check;
use crate::code::{self, Code};
use crate::diagnostic::{CompileError, CompileErrors};
use crate::directive::{Comment, Directives, Header, LadderMessage, MCode, PlcAddress, StartValue};
use crate::instruction::{Mnemonic, Operand, Statement};
use crate::parser;
use crate::rung_dependencies::RungDependencies;

/// A compiled ladder program. It is immutable and can be shared in an `Arc`.
///
/// It is serialized as its source text and compiled again when it is deserialized.
#[derive(Clone, Debug, Deserialize)]
#[serde(try_from = "String")]
pub struct Ladder {
    source: String,
    directives: Directives,
    statements: Vec<Statement>,
    code: Code,
    /// The bytes that each rung reads and writes; `None` if the ladder has jumps or
    /// subprograms.
    dependencies: Option<RungDependencies>,
    warnings: Vec<CompileError>,
    steps: u32,
    level1_steps: u32,
    rungs: u32,
}

/// One rung of the ladder with its instructions.
#[derive(Clone, Copy, Debug)]
pub struct Rung<'a> {
    /// Number of the rung, from 1.
    pub number: u32,
    /// Title (`.NET`) of the network that starts with this rung; `None` without a title.
    pub title: Option<&'a str>,
    /// Step number of the first instruction, from 0.
    pub step: u32,
    /// The instructions of the rung, in their order.
    pub statements: &'a [Statement],
}

impl Ladder {
    /// Compiles an instruction list.
    ///
    /// # Errors
    ///
    /// All rules that the text breaks, with line and rung.
    pub fn compile(source: &str) -> Result<Ladder, CompileErrors> {
        let parsed = parser::parse(source);
        let (structure, found, mut warnings) = check::check(&parsed.statements);
        let mut errors = parsed.errors;
        errors.extend(found);
        errors.sort_by_key(|error| error.line);
        warnings.sort_by_key(|warning| warning.line);
        if !errors.is_empty() {
            return Err(CompileErrors { errors, warnings });
        }
        let code = code::generate(&parsed.statements, &structure, &parsed.directives);
        let dependencies = RungDependencies::from_code(&code, &parsed.statements);
        let mut directives = parsed.directives;
        directives.messages.sort_by_key(|message| message.bit);
        directives.comments.sort_by_key(|comment| comment.subject);
        directives.comments.dedup_by_key(|comment| comment.subject);
        Ok(Ladder {
            source: source.to_owned(),
            directives,
            statements: parsed.statements,
            code,
            dependencies,
            warnings,
            steps: structure.steps,
            level1_steps: structure.level1_steps,
            rungs: parsed.rungs,
        })
    }

    /// Returns the source text from which the ladder was compiled.
    #[must_use]
    pub fn source(&self) -> &str {
        &self.source
    }

    /// Returns design unit, author, version and remark, as the version page shows them.
    #[must_use]
    pub fn header(&self) -> &Header {
        &self.directives.header
    }

    /// Returns the warnings of the compiler, W01 to W04.
    #[must_use]
    pub fn warnings(&self) -> &[CompileError] {
        &self.warnings
    }

    /// Returns the number of steps of the whole program, at most 5000.
    #[must_use]
    pub fn steps(&self) -> u32 {
        self.steps
    }

    /// Returns the number of steps of level 1, including END1.
    #[must_use]
    pub fn level1_steps(&self) -> u32 {
        self.level1_steps
    }

    /// Returns the number of parts of level 2. Each slot of 8 ms runs one part.
    #[must_use]
    pub fn part_count(&self) -> usize {
        self.code.part_ends.len()
    }

    /// Returns the number of rungs of the ladder.
    #[must_use]
    pub fn rung_count(&self) -> u32 {
        self.rungs
    }

    /// Returns the messages that the ladder can request, in the order of their request bits.
    #[must_use]
    pub fn messages(&self) -> &[LadderMessage] {
        &self.directives.messages
    }

    /// Returns the names of addresses, in address order. Of several names for one address only
    /// the first is kept.
    #[must_use]
    pub fn comments(&self) -> &[Comment] {
        &self.directives.comments
    }

    /// Returns the Chinese and English name of an address; `None` without one.
    #[must_use]
    pub fn comment(&self, subject: PlcAddress) -> Option<&Comment> {
        let comments = &self.directives.comments;
        let found = comments.binary_search_by_key(&subject, |comment| comment.subject);
        found.ok().and_then(|at| comments.get(at))
    }

    /// Returns the initial values of retained addresses, for an empty retained memory.
    #[must_use]
    pub fn start_values(&self) -> &[StartValue] {
        &self.directives.start_values
    }

    /// Returns the M codes that the ladder implements in addition to those of the control.
    #[must_use]
    pub fn m_codes(&self) -> &[MCode] {
        &self.directives.m_codes
    }

    /// Returns all instructions, in program order.
    #[must_use]
    pub fn statements(&self) -> &[Statement] {
        &self.statements
    }

    /// Returns the rungs, in program order.
    pub fn rungs(&self) -> impl Iterator<Item = Rung<'_>> {
        let mut first = 0;
        let mut step = 0;
        let chunks = self.statements.chunk_by(|a, b| a.rung == b.rung);
        chunks.map(move |statements| {
            let rung = Rung {
                number: statements.first().map_or(0, |statement| statement.rung),
                title: self.title_at(first),
                step,
                statements,
            };
            first += statements.len();
            step += statements.iter().map(Statement::steps).sum::<u32>();
            rung
        })
    }

    /// Returns the labels in program order, each with the number of the rung that the label
    /// starts.
    pub fn labels(&self) -> impl Iterator<Item = (u16, u32)> {
        self.statements
            .iter()
            .filter_map(|s| match (s.mnemonic, s.operands.first()) {
                (Mnemonic::Lbl, Some(Operand::Label(label))) => Some((*label, s.rung)),
                _ => None,
            })
    }

    /// Returns the title directly before the statement with index `first`; `None` without one.
    /// Of several titles the last counts.
    pub(crate) fn title_at(&self, first: usize) -> Option<&str> {
        let network_titles = &self.directives.network_titles;
        let end = network_titles.partition_point(|network| network.statement <= first);
        let network = network_titles.get(end.checked_sub(1)?)?;
        (network.statement == first).then_some(network.title.as_str())
    }

    pub(crate) fn code(&self) -> &Code {
        &self.code
    }

    pub(crate) const fn dependencies(&self) -> Option<&RungDependencies> {
        self.dependencies.as_ref()
    }

    pub(crate) fn directives(&self) -> &Directives {
        &self.directives
    }
}

impl PartialEq for Ladder {
    /// Two ladders are equal if their source texts are equal.
    fn eq(&self, other: &Ladder) -> bool {
        self.source == other.source
    }
}

impl Eq for Ladder {}

// By hand: `into` would copy the compiled ladder for each hash of a recording.
impl Serialize for Ladder {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self.source.serialize(serializer)
    }
}

impl TryFrom<String> for Ladder {
    type Error = CompileErrors;

    fn try_from(source: String) -> Result<Ladder, CompileErrors> {
        Ladder::compile(&source)
    }
}
