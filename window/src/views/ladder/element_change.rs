//! Changes a contact or coil of a drawn rung and writes the rung as instructions again.

use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Branch, Contact, Element, Mnemonic, Network, Operand, RungBody, Statement};

/// A change to the selected contact or coil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ElementChange {
    /// Toggle a contact between normally open and normally closed, or cycle a coil through
    /// OUT, SET and RST.
    ToggleKind,
    /// Replace the address of the element by this one.
    SetAddress(BitAddress),
    /// Add a contact of this address in series after the selected one.
    AddSeries(BitAddress),
    /// Add a contact or coil of this address in parallel below the selected one.
    AddParallel(BitAddress),
    /// Remove the selected contact or coil from its rung.
    Delete,
}

/// The instructions of a rung, one line each, after a change to its statement with index `at`
/// (0: the first of the rung); `None` if the change is not possible there.
pub fn change_rung(network: &Network, at: usize, change: ElementChange) -> Option<Vec<String>> {
    let RungBody::Rung { contacts, outputs } = &network.body else {
        return None;
    };
    let contact_count = network.statements().len() - outputs.len();
    let (contacts, outputs) = match at.checked_sub(contact_count) {
        Some(output) => (contacts.clone(), change_output(outputs, output, change)?),
        None => {
            let mut elements = Vec::new();
            for element in contacts.iter().cloned() {
                elements.extend(change_element(element, at, change));
            }
            (elements, outputs.clone())
        }
    };
    if contacts.is_empty() {
        return None;
    }
    let changed = Network {
        body: RungBody::Rung { contacts, outputs },
        ..network.clone()
    };
    Some(format_rung(&changed))
}

pub fn format_rung(network: &Network) -> Vec<String> {
    let statements = network.statements();
    statements.iter().map(ToString::to_string).collect()
}

const fn new_contact(bit: BitAddress) -> Element {
    Element::Contact(Contact {
        bit,
        normally_closed: false,
        at: usize::MAX,
    })
}

const fn new_branch(element: Element) -> Branch {
    Branch {
        element,
        block: false,
        at: usize::MAX,
    }
}

/// The element after the change to its statement with index `at`; `None` if the element was
/// removed.
fn change_element(element: Element, at: usize, change: ElementChange) -> Option<Element> {
    match element {
        Element::Contact(found) if found.at == at => match change {
            ElementChange::Delete => None,
            ElementChange::ToggleKind => Some(Element::Contact(Contact {
                normally_closed: !found.normally_closed,
                ..found
            })),
            ElementChange::SetAddress(bit) => Some(Element::Contact(Contact { bit, ..found })),
            ElementChange::AddSeries(bit) => {
                let members = [Element::Contact(found), new_contact(bit)];
                Some(Element::Series(members.map(new_branch).into()))
            }
            ElementChange::AddParallel(bit) => {
                let members = [Element::Contact(found), new_contact(bit)];
                Some(Element::Parallel(members.map(new_branch).into()))
            }
        },
        Element::Contact(_) => Some(element),
        Element::Series(members) => {
            let members = change_members(members, at, change, |element| match element {
                Element::Series(members) => Ok(members),
                other => Err(other),
            });
            join_members(members, Element::Series)
        }
        Element::Parallel(members) => {
            let members = change_members(members, at, change, |element| match element {
                Element::Parallel(members) => Ok(members),
                other => Err(other),
            });
            join_members(members, Element::Parallel)
        }
    }
}

/// The members of a group after the change. A contact that became a group of the same kind,
/// series or parallel, is replaced by the members of that group; `members_if_same` returns
/// them.
fn change_members(
    members: Vec<Branch>,
    at: usize,
    change: ElementChange,
    members_if_same: impl Fn(Element) -> Result<Vec<Branch>, Element>,
) -> Vec<Branch> {
    let mut changed = Vec::with_capacity(members.len() + 1);
    for member in members {
        let was_contact = matches!(member.element, Element::Contact(_));
        let Some(element) = change_element(member.element, at, change) else {
            continue;
        };
        let with_element = |element| Branch { element, ..member };
        if !was_contact {
            changed.push(with_element(element));
            continue;
        }
        match members_if_same(element) {
            Ok(group) => changed.extend(group),
            Err(element) => changed.push(with_element(element)),
        }
    }
    changed
}

/// Joins members to an element: a group, or a single member itself; `None` without members.
fn join_members(
    mut members: Vec<Branch>,
    make_group: impl Fn(Vec<Branch>) -> Element,
) -> Option<Element> {
    match members.len() {
        0 => None,
        1 => members.pop().map(|member| member.element),
        _ => Some(make_group(members)),
    }
}

fn change_output(
    outputs: &[Statement],
    at: usize,
    change: ElementChange,
) -> Option<Vec<Statement>> {
    let mut outputs = outputs.to_vec();
    let output = outputs.get_mut(at)?;
    let is_coil = matches!(
        output.mnemonic,
        Mnemonic::Out | Mnemonic::Set | Mnemonic::Rst
    );
    match change {
        ElementChange::ToggleKind => {
            output.mnemonic = match output.mnemonic {
                Mnemonic::Out => Mnemonic::Set,
                Mnemonic::Set => Mnemonic::Rst,
                Mnemonic::Rst => Mnemonic::Out,
                _ => return None,
            };
        }
        ElementChange::SetAddress(bit) if is_coil => output.operands = vec![Operand::Bit(bit)],
        ElementChange::AddParallel(bit) => {
            let below = Statement {
                mnemonic: Mnemonic::Out,
                operands: vec![Operand::Bit(bit)],
                table: Vec::new(),
                ..output.clone()
            };
            outputs.insert(at + 1, below);
        }
        ElementChange::Delete if outputs.len() > 1 => {
            outputs.remove(at);
        }
        ElementChange::SetAddress(_) | ElementChange::AddSeries(_) | ElementChange::Delete => {
            return None;
        }
    }
    Some(outputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::plc::Ladder;

    fn rung_after(rung: &str, at: usize, change: ElementChange) -> Option<String> {
        let ladder = Ladder::compile(&format!("END1\n{rung}\nEND2")).unwrap();
        let changed = change_rung(&ladder.network(2).unwrap(), at, change)?.join("\n");
        // Every change must give a valid ladder.
        Ladder::compile(&format!("END1\n{changed}\nEND2")).unwrap();
        Some(changed.replace("000", ""))
    }

    fn bit() -> BitAddress {
        "R9.0".parse().unwrap()
    }

    #[test]
    fn contacts_toggle_and_change_their_address() {
        let rung = "LD R1.0\nOR R1.1\nANI R1.2\nOUT R2.0";
        for (at, expected) in [
            (0, "LDI R1.0\nOR R1.1\nANI R1.2\nOUT R2.0"),
            (1, "LD R1.0\nORI R1.1\nANI R1.2\nOUT R2.0"),
            (2, "LD R1.0\nOR R1.1\nAND R1.2\nOUT R2.0"),
            (3, "LD R1.0\nOR R1.1\nANI R1.2\nSET R2.0"),
        ] {
            assert_eq!(
                rung_after(rung, at, ElementChange::ToggleKind).as_deref(),
                Some(expected)
            );
        }
        let moved = rung_after(rung, 1, ElementChange::SetAddress(bit()));
        assert_eq!(
            moved.as_deref(),
            Some("LD R1.0\nOR R9.0\nANI R1.2\nOUT R2.0")
        );
        let moved = rung_after(rung, 3, ElementChange::SetAddress(bit()));
        assert_eq!(
            moved.as_deref(),
            Some("LD R1.0\nOR R1.1\nANI R1.2\nOUT R9.0")
        );
    }

    #[test]
    fn a_contact_is_added_after_or_below_another() {
        let rung = "LD R1.0\nOR R1.1\nAND R1.2\nOUT R2.0";
        for (at, change, expected) in [
            (
                0,
                ElementChange::AddSeries(bit()),
                "LD R1.0\nAND R9.0\nOR R1.1\nAND R1.2\nOUT R2.0",
            ),
            (
                1,
                ElementChange::AddSeries(bit()),
                "LD R1.0\nLD R1.1\nAND R9.0\nORB\nAND R1.2\nOUT R2.0",
            ),
            (
                2,
                ElementChange::AddSeries(bit()),
                "LD R1.0\nOR R1.1\nAND R1.2\nAND R9.0\nOUT R2.0",
            ),
            (
                0,
                ElementChange::AddParallel(bit()),
                "LD R1.0\nOR R9.0\nOR R1.1\nAND R1.2\nOUT R2.0",
            ),
            (
                2,
                ElementChange::AddParallel(bit()),
                "LD R1.0\nOR R1.1\nLD R1.2\nOR R9.0\nANB\nOUT R2.0",
            ),
            (
                3,
                ElementChange::AddParallel(bit()),
                "LD R1.0\nOR R1.1\nAND R1.2\nOUT R2.0\nOUT R9.0",
            ),
        ] {
            assert_eq!(
                rung_after(rung, at, change).as_deref(),
                Some(expected),
                "{at} {change:?}"
            );
        }
        assert_eq!(rung_after(rung, 3, ElementChange::AddSeries(bit())), None);
    }

    #[test]
    fn deleting_an_element_keeps_the_others_joined() {
        let rung = "LD R1.0\nOR R1.1\nLD R1.2\nAND R1.3\nORB\nAND R1.4\nOUT R2.0\nSET R2.1";
        for (at, expected) in [
            (
                0,
                "LD R1.1\nLD R1.2\nAND R1.3\nORB\nAND R1.4\nOUT R2.0\nSET R2.1",
            ),
            (
                2,
                "LD R1.0\nOR R1.1\nLD R1.3\nORB\nAND R1.4\nOUT R2.0\nSET R2.1",
            ),
            (
                5,
                "LD R1.0\nOR R1.1\nLD R1.2\nAND R1.3\nORB\nOUT R2.0\nSET R2.1",
            ),
            (
                6,
                "LD R1.0\nOR R1.1\nLD R1.2\nAND R1.3\nORB\nAND R1.4\nSET R2.1",
            ),
        ] {
            assert_eq!(
                rung_after(rung, at, ElementChange::Delete).as_deref(),
                Some(expected),
                "{at}"
            );
        }
        let single = "LD R1.0\nOUT R2.0";
        assert_eq!(rung_after(single, 0, ElementChange::Delete), None);
        assert_eq!(rung_after(single, 1, ElementChange::Delete), None);
    }
}
