//! Converts rungs to ladder diagrams of contacts and outputs, and back to instruction
//! lists.
//!
//! ```text
//! LD a          a     c
//! OR b       ─┬─┤├─┬──┤├──( y )     Series [ Parallel [a, b], c ]
//! AND c       └─┤├─┘
//! OUT y         b
//! ```
//!
//! The diagram keeps whether a contact is written as a contact (`AND c`) or as a block
//! (`LD c`, `ANB`), so that it converts back to the same list.

use crate::address::BitAddress;
use crate::instruction::{InstructionRole, Mnemonic, Operand, Statement};
use crate::ladder::{Ladder, Rung};

/// One contact of a ladder diagram: the bit that it reads.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Contact {
    /// The bit that the contact reads.
    pub bit: BitAddress,
    /// Whether the contact is normally closed, so that it conducts while the bit is 0.
    pub normally_closed: bool,
    /// Index of the contact's statement in the rung, from 0.
    pub at: usize,
}

/// A contact, or several elements in series or in parallel.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Element {
    /// A single contact.
    Contact(Contact),
    /// Elements in series, from left to right.
    Series(Vec<Branch>),
    /// Elements in parallel, from top to bottom.
    Parallel(Vec<Branch>),
}

/// One member of a series or parallel connection.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Branch {
    /// The contact or the connection of elements that forms this member.
    pub element: Element,
    /// Whether the member is written as a block, with LD and ANB or ORB. A member of
    /// several contacts is always a block.
    pub block: bool,
    /// Index in the rung, from 0, of the statement that connects the member to the members
    /// before it.
    pub at: usize,
}

/// One rung as a ladder diagram.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Network {
    /// Number of the rung, from 1.
    pub number: u32,
    /// Title (`.NET`) that starts with this rung; `None` without one.
    pub title: Option<String>,
    /// Index of the rung's first statement in the program, from 0.
    pub first: usize,
    /// The contacts and outputs of the rung, or its structural instruction.
    pub body: RungBody,
}

/// The contents of a rung: a structural instruction, or contacts and outputs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum RungBody {
    /// The rung consists of one structural instruction: END1, END2, LBL, SP or SPE.
    Structure(Statement),
    /// The rung consists of contacts and outputs.
    Rung {
        /// The contacts as one element. Only a rung without output has several elements; the
        /// compiler warns that such a rung has no effect.
        contacts: Vec<Element>,
        /// Coils and function instructions, all with the same input.
        outputs: Vec<Statement>,
    },
}

/// The power flow at one statement of a rung, for the live view.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct PowerFlow {
    /// Whether the contact conducts or the bit of the coil is 1.
    pub closed: bool,
    /// Whether power reaches the right side of the contact or the input of the output.
    pub live: bool,
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Connection {
    Series,
    Parallel,
}

impl Element {
    /// Connects a member in series or in parallel. A series that gets another member in series
    /// stays one series.
    fn join(self, connection: Connection, member: Branch) -> Element {
        let first = |element| Branch {
            element,
            block: false,
            at: member.at,
        };
        match (connection, self) {
            (Connection::Series, Element::Series(mut members)) => {
                members.push(member);
                Element::Series(members)
            }
            (Connection::Parallel, Element::Parallel(mut members)) => {
                members.push(member);
                Element::Parallel(members)
            }
            (Connection::Series, element) => Element::Series(vec![first(element), member]),
            (Connection::Parallel, element) => Element::Parallel(vec![first(element), member]),
        }
    }

    /// Returns the number of columns and rows that the contacts of the element take.
    #[must_use]
    pub fn size(&self) -> (usize, usize) {
        match self {
            Element::Contact(_) => (1, 1),
            Element::Series(members) => members
                .iter()
                .map(|member| member.element.size())
                .fold((0, 0), |(wide, high), (columns, rows)| {
                    (wide + columns, high.max(rows))
                }),
            Element::Parallel(members) => members
                .iter()
                .map(|member| member.element.size())
                .fold((0, 0), |(wide, high), (columns, rows)| {
                    (wide.max(columns), high + rows)
                }),
        }
    }

    /// The column, from 0, of the contact whose statement has the index `at` in the rung; `None`
    /// if the element has no such contact.
    fn column_of(&self, at: usize) -> Option<usize> {
        match self {
            Element::Contact(contact) => (contact.at == at).then_some(0),
            Element::Series(members) => {
                let mut column = 0;
                members.iter().find_map(|member| {
                    let found = member.element.column_of(at).map(|own| column + own);
                    column += member.element.size().0;
                    found
                })
            }
            Element::Parallel(members) => members
                .iter()
                .find_map(|member| member.element.column_of(at)),
        }
    }

    fn write_list(&self, list: &mut Vec<(Mnemonic, Option<BitAddress>)>) {
        let (connection, members) = match self {
            Element::Contact(contact) => {
                list.push((contact_mnemonic(None, contact), Some(contact.bit)));
                return;
            }
            Element::Series(members) => (Connection::Series, members),
            Element::Parallel(members) => (Connection::Parallel, members),
        };
        for (index, member) in members.iter().enumerate() {
            match &member.element {
                element if index == 0 => element.write_list(list),
                Element::Contact(contact) if !member.block => {
                    list.push((
                        contact_mnemonic(Some(connection), contact),
                        Some(contact.bit),
                    ));
                }
                element => {
                    element.write_list(list);
                    let joint = match connection {
                        Connection::Series => Mnemonic::Anb,
                        Connection::Parallel => Mnemonic::Orb,
                    };
                    list.push((joint, None));
                }
            }
        }
    }

    /// Propagates power from the left through the element, records it in `states`, and
    /// returns the power on the right.
    fn propagate_power(
        &self,
        live: bool,
        closed: &impl Fn(&Contact) -> bool,
        states: &mut [PowerFlow],
    ) -> bool {
        match self {
            Element::Contact(contact) => {
                let closed = closed(contact);
                let state = PowerFlow {
                    closed,
                    live: live && closed,
                };
                if let Some(state_slot) = states.get_mut(contact.at) {
                    *state_slot = state;
                }
                state.live
            }
            Element::Series(members) => members.iter().fold(live, |live, member| {
                let out = member.element.propagate_power(live, closed, states);
                set_joint_power(member, out, states);
                out
            }),
            Element::Parallel(members) => members.iter().fold(false, |out, member| {
                let out = member.element.propagate_power(live, closed, states) || out;
                set_joint_power(member, out, states);
                out
            }),
        }
    }
}

/// Records the power flow at the ORB or ANB that connects `member`: `live` is the power after
/// the connected blocks.
fn set_joint_power(member: &Branch, live: bool, states: &mut [PowerFlow]) {
    let is_joint = member.block || !matches!(member.element, Element::Contact(_));
    if is_joint && let Some(state_slot) = states.get_mut(member.at) {
        *state_slot = PowerFlow { closed: live, live };
    }
}

fn contact_mnemonic(connection: Option<Connection>, contact: &Contact) -> Mnemonic {
    match (connection, contact.normally_closed) {
        (None, false) => Mnemonic::Ld,
        (None, true) => Mnemonic::Ldi,
        (Some(Connection::Series), false) => Mnemonic::And,
        (Some(Connection::Series), true) => Mnemonic::Ani,
        (Some(Connection::Parallel), false) => Mnemonic::Or,
        (Some(Connection::Parallel), true) => Mnemonic::Ori,
    }
}

impl Network {
    fn new(rung: &Rung<'_>, first: usize) -> Network {
        let body = match rung.statements {
            [mark] if mark.mnemonic.row().role == InstructionRole::Structure => {
                RungBody::Structure(mark.clone())
            }
            statements => draw_rung(statements),
        };
        Network {
            number: rung.number,
            title: rung.title.map(str::to_owned),
            first,
            body,
        }
    }

    /// Returns the instruction list of the diagram. Contacts have the line number of the
    /// first output, or 0 without outputs.
    #[must_use]
    pub fn statements(&self) -> Vec<Statement> {
        let (contacts, outputs) = match &self.body {
            RungBody::Structure(mark) => return vec![mark.clone()],
            RungBody::Rung { contacts, outputs } => (contacts, outputs),
        };
        let mut list = Vec::new();
        for element in contacts {
            element.write_list(&mut list);
        }
        let line = outputs.first().map_or(0, |output| output.line);
        list.into_iter()
            .map(|(mnemonic, bit)| Statement {
                mnemonic,
                operands: bit.map(Operand::Bit).into_iter().collect(),
                table: Vec::new(),
                line,
                rung: self.number,
            })
            .chain(outputs.iter().cloned())
            .collect()
    }

    /// Returns the column, from 1, of the statement with index `at` in the rung: that of its
    /// contact, for an output the one after the contacts, 1 for a structural instruction, ANB
    /// and ORB.
    #[must_use]
    pub fn column(&self, at: usize) -> usize {
        let RungBody::Rung { contacts, outputs } = &self.body else {
            return 1;
        };
        let mut column = 1;
        for element in contacts {
            if let Some(own) = element.column_of(at) {
                return column + own;
            }
            column += element.size().0;
        }
        let first_output = self.statements().len() - outputs.len();
        if at >= first_output { column } else { 1 }
    }

    /// Returns the power flow, one state for each statement of the rung. `bit` returns the
    /// value of a bit.
    pub fn power_flow(&self, bit: impl Fn(BitAddress) -> bool) -> Vec<PowerFlow> {
        let RungBody::Rung { contacts, outputs } = &self.body else {
            return vec![PowerFlow::default()];
        };
        let of_outputs = self.statements().len() - outputs.len();
        let mut states = vec![PowerFlow::default(); of_outputs];
        let closed = |contact: &Contact| bit(contact.bit) != contact.normally_closed;
        let live = contacts.iter().fold(false, |_, element| {
            element.propagate_power(true, &closed, &mut states)
        });
        states.extend(outputs.iter().map(|output| PowerFlow {
            closed: written_bit(output).is_some_and(&bit),
            live,
        }));
        states
    }
}

/// Returns the bit that an output statement writes; `None` if the statement has no such
/// operand.
fn written_bit(output: &Statement) -> Option<BitAddress> {
    let kinds = output.mnemonic.row().operands.iter();
    kinds
        .zip(&output.operands)
        .find_map(|(kind, operand)| match operand {
            Operand::Bit(bit) if kind.is_written() => Some(*bit),
            _ => None,
        })
}

fn draw_rung(statements: &[Statement]) -> RungBody {
    let mut contacts: Vec<Element> = Vec::new();
    let mut outputs = Vec::new();
    for (at, statement) in statements.iter().enumerate() {
        let contact = |normally_closed| match statement.operands.first() {
            Some(Operand::Bit(bit)) => Some(Element::Contact(Contact {
                bit: *bit,
                normally_closed,
                at,
            })),
            _ => None,
        };
        let (connection, member) = match statement.mnemonic {
            Mnemonic::Ld => (None, contact(false)),
            Mnemonic::Ldi => (None, contact(true)),
            Mnemonic::And => (Some(Connection::Series), contact(false)),
            Mnemonic::Ani => (Some(Connection::Series), contact(true)),
            Mnemonic::Or => (Some(Connection::Parallel), contact(false)),
            Mnemonic::Ori => (Some(Connection::Parallel), contact(true)),
            Mnemonic::Anb => (Some(Connection::Series), contacts.pop()),
            Mnemonic::Orb => (Some(Connection::Parallel), contacts.pop()),
            _ => {
                outputs.push(statement.clone());
                continue;
            }
        };
        let Some(element) = member else { continue };
        let joined = match (connection, contacts.pop()) {
            (Some(connection), Some(before)) => before.join(
                connection,
                Branch {
                    element,
                    block: matches!(statement.mnemonic, Mnemonic::Anb | Mnemonic::Orb),
                    at,
                },
            ),
            (_, before) => {
                contacts.extend(before);
                element
            }
        };
        contacts.push(joined);
    }
    RungBody::Rung { contacts, outputs }
}

impl Ladder {
    /// Returns the ladder diagrams of all rungs, in program order.
    pub fn networks(&self) -> impl Iterator<Item = Network> + '_ {
        let mut first = 0;
        self.rungs().map(move |rung| {
            let network = Network::new(&rung, first);
            first += rung.statements.len();
            network
        })
    }

    /// Returns the ladder diagram of the rung with this number, from 1; `None` without such a
    /// rung.
    #[must_use]
    pub fn network(&self, number: u32) -> Option<Network> {
        let statements = self.statements();
        let first = statements.partition_point(|statement| statement.rung < number);
        let end = statements.partition_point(|statement| statement.rung <= number);
        let rung = Rung {
            number,
            title: self.title_at(first),
            step: 0,
            statements: statements.get(first..end).filter(|rung| !rung.is_empty())?,
        };
        Some(Network::new(&rung, first))
    }

    /// Returns the source text with the lines of one rung replaced; empty `lines` delete
    /// the rung.
    ///
    /// Everything outside the lines of the rung stays unchanged. The new text is not checked.
    #[must_use]
    pub fn source_with_rung(&self, number: u32, lines: &str) -> String {
        let statements = self.statements().iter();
        let mut of_rung = statements.filter(|statement| statement.rung == number);
        let Some(first) = of_rung.next().map(|statement| statement.line) else {
            return self.source().to_owned();
        };
        let last = of_rung
            .next_back()
            .map_or(first, |statement| statement.line);
        let mut text = String::with_capacity(self.source().len() + lines.len());
        for (line, number) in self.source().lines().zip(1..) {
            if number == first && !lines.is_empty() {
                text.push_str(lines.trim_end_matches('\n'));
                text.push('\n');
            }
            if !(first..=last).contains(&number) {
                text.push_str(line);
                text.push('\n');
            }
        }
        text
    }
}
