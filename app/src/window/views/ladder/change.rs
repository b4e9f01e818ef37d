//! Changes a contact or coil of a drawn rung and writes the rung as instructions again.

use gsk_core::plc::address::BitAddress;
use gsk_core::plc::{Branch, Contact, Element, Mnemonic, Network, Operand, RungBody, Statement};

/// A change to a contact or coil.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Toggle normally open and normally closed; cycle OUT, SET, RST.
    Kind,
    /// Set another address.
    Address(BitAddress),
    /// Add a contact in series after it.
    Series(BitAddress),
    /// Add a contact or coil in parallel below it.
    Parallel(BitAddress),
    /// Remove it.
    Delete,
}

/// The instructions of a rung after a change to its statement `at`; `None` if the change is
/// not possible there.
pub fn changed(network: &Network, at: usize, change: Change) -> Option<Vec<String>> {
    let RungBody::Rung { contacts, outputs } = &network.body else {
        return None;
    };
    let of_contacts = network.statements().len() - outputs.len();
    let (contacts, outputs) = match at.checked_sub(of_contacts) {
        Some(output) => (contacts.clone(), output_changed(outputs, output, change)?),
        None => {
            let mut elements = Vec::new();
            for element in contacts.iter().cloned() {
                elements.extend(element_changed(element, at, change));
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
    Some(lines(&changed))
}

pub fn lines(network: &Network) -> Vec<String> {
    let statements = network.statements();
    statements.iter().map(ToString::to_string).collect()
}

const fn contact(bit: BitAddress) -> Element {
    Element::Contact(Contact {
        bit,
        normally_closed: false,
        at: usize::MAX,
    })
}

const fn branch(element: Element) -> Branch {
    Branch {
        element,
        block: false,
        at: usize::MAX,
    }
}

/// The element after the change; `None` if it was removed.
fn element_changed(element: Element, at: usize, change: Change) -> Option<Element> {
    match element {
        Element::Contact(found) if found.at == at => match change {
            Change::Delete => None,
            Change::Kind => Some(Element::Contact(Contact {
                normally_closed: !found.normally_closed,
                ..found
            })),
            Change::Address(bit) => Some(Element::Contact(Contact { bit, ..found })),
            Change::Series(bit) => {
                let members = [Element::Contact(found), contact(bit)];
                Some(Element::Series(members.map(branch).into()))
            }
            Change::Parallel(bit) => {
                let members = [Element::Contact(found), contact(bit)];
                Some(Element::Parallel(members.map(branch).into()))
            }
        },
        Element::Contact(_) => Some(element),
        Element::Series(members) => {
            let members = members_changed(members, at, change, |element| match element {
                Element::Series(members) => Ok(members),
                other => Err(other),
            });
            joined(members, Element::Series)
        }
        Element::Parallel(members) => {
            let members = members_changed(members, at, change, |element| match element {
                Element::Parallel(members) => Ok(members),
                other => Err(other),
            });
            joined(members, Element::Parallel)
        }
    }
}

/// The members after the change. A contact that became a group of the same kind, series
/// or parallel, as `members` is replaced by the members of its group.
fn members_changed(
    members: Vec<Branch>,
    at: usize,
    change: Change,
    same_way: impl Fn(Element) -> Result<Vec<Branch>, Element>,
) -> Vec<Branch> {
    let mut changed = Vec::with_capacity(members.len() + 1);
    for member in members {
        let was_contact = matches!(member.element, Element::Contact(_));
        let Some(element) = element_changed(member.element, at, change) else {
            continue;
        };
        let put = |element| Branch { element, ..member };
        if !was_contact {
            changed.push(put(element));
            continue;
        }
        match same_way(element) {
            Ok(fellows) => changed.extend(fellows),
            Err(element) => changed.push(put(element)),
        }
    }
    changed
}

/// Joins members to a group; a single member needs no group.
fn joined(mut members: Vec<Branch>, way: impl Fn(Vec<Branch>) -> Element) -> Option<Element> {
    match members.len() {
        0 => None,
        1 => members.pop().map(|member| member.element),
        _ => Some(way(members)),
    }
}

fn output_changed(outputs: &[Statement], at: usize, change: Change) -> Option<Vec<Statement>> {
    let mut outputs = outputs.to_vec();
    let output = outputs.get_mut(at)?;
    let coil = matches!(
        output.mnemonic,
        Mnemonic::Out | Mnemonic::Set | Mnemonic::Rst
    );
    match change {
        Change::Kind => {
            output.mnemonic = match output.mnemonic {
                Mnemonic::Out => Mnemonic::Set,
                Mnemonic::Set => Mnemonic::Rst,
                Mnemonic::Rst => Mnemonic::Out,
                _ => return None,
            };
        }
        Change::Address(bit) if coil => output.operands = vec![Operand::Bit(bit)],
        Change::Parallel(bit) => {
            let below = Statement {
                mnemonic: Mnemonic::Out,
                operands: vec![Operand::Bit(bit)],
                table: Vec::new(),
                ..output.clone()
            };
            outputs.insert(at + 1, below);
        }
        Change::Delete if outputs.len() > 1 => {
            outputs.remove(at);
        }
        Change::Address(_) | Change::Series(_) | Change::Delete => return None,
    }
    Some(outputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::plc::Ladder;

    fn after(rung: &str, at: usize, change: Change) -> Option<String> {
        let ladder = Ladder::compile(&format!("END1\n{rung}\nEND2")).unwrap();
        let changed = changed(&ladder.network(2).unwrap(), at, change)?.join("\n");
        // Every change must give a valid ladder.
        Ladder::compile(&format!("END1\n{changed}\nEND2")).unwrap();
        Some(changed.replace("000", ""))
    }

    fn bit() -> BitAddress {
        "R9.0".parse().unwrap()
    }

    #[test]
    fn contacts_turn_round_and_change_their_address() {
        let rung = "LD R1.0\nOR R1.1\nANI R1.2\nOUT R2.0";
        for (at, expected) in [
            (0, "LDI R1.0\nOR R1.1\nANI R1.2\nOUT R2.0"),
            (1, "LD R1.0\nORI R1.1\nANI R1.2\nOUT R2.0"),
            (2, "LD R1.0\nOR R1.1\nAND R1.2\nOUT R2.0"),
            (3, "LD R1.0\nOR R1.1\nANI R1.2\nSET R2.0"),
        ] {
            assert_eq!(after(rung, at, Change::Kind).as_deref(), Some(expected));
        }
        let moved = after(rung, 1, Change::Address(bit()));
        assert_eq!(
            moved.as_deref(),
            Some("LD R1.0\nOR R9.0\nANI R1.2\nOUT R2.0")
        );
        let moved = after(rung, 3, Change::Address(bit()));
        assert_eq!(
            moved.as_deref(),
            Some("LD R1.0\nOR R1.1\nANI R1.2\nOUT R9.0")
        );
    }

    #[test]
    fn a_contact_is_put_behind_or_below_another() {
        let rung = "LD R1.0\nOR R1.1\nAND R1.2\nOUT R2.0";
        for (at, change, expected) in [
            (
                0,
                Change::Series(bit()),
                "LD R1.0\nAND R9.0\nOR R1.1\nAND R1.2\nOUT R2.0",
            ),
            (
                1,
                Change::Series(bit()),
                "LD R1.0\nLD R1.1\nAND R9.0\nORB\nAND R1.2\nOUT R2.0",
            ),
            (
                2,
                Change::Series(bit()),
                "LD R1.0\nOR R1.1\nAND R1.2\nAND R9.0\nOUT R2.0",
            ),
            (
                0,
                Change::Parallel(bit()),
                "LD R1.0\nOR R9.0\nOR R1.1\nAND R1.2\nOUT R2.0",
            ),
            (
                2,
                Change::Parallel(bit()),
                "LD R1.0\nOR R1.1\nLD R1.2\nOR R9.0\nANB\nOUT R2.0",
            ),
            (
                3,
                Change::Parallel(bit()),
                "LD R1.0\nOR R1.1\nAND R1.2\nOUT R2.0\nOUT R9.0",
            ),
        ] {
            assert_eq!(
                after(rung, at, change).as_deref(),
                Some(expected),
                "{at} {change:?}"
            );
        }
        assert_eq!(after(rung, 3, Change::Series(bit())), None);
    }

    #[test]
    fn what_is_deleted_leaves_the_others_joined() {
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
                after(rung, at, Change::Delete).as_deref(),
                Some(expected),
                "{at}"
            );
        }
        let single = "LD R1.0\nOUT R2.0";
        assert_eq!(after(single, 0, Change::Delete), None);
        assert_eq!(after(single, 1, Change::Delete), None);
    }
}
