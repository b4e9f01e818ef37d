//! The part of XPath by which clients select components and data items:
//! `//Axes//DataItem[@type="POSITION" and @subType="ACTUAL"]|//Path`.
//!
//! Steps are `/` and `//` with the name of an element or `*`, and predicates that compare
//! attributes, joined by `and` and `or`. A component selects all data items inside it.

use crate::model::{COMPONENTS, Component, DATA_ITEMS, DataItem, component_index};

/// Greatest length of an XPath expression, bytes.
const MAX_LENGTH: usize = 1024;
/// Greatest number of steps and comparisons in an XPath expression.
const MAX_TERMS: usize = 64;

/// An element of the probe document, to which a step of an XPath expression is compared.
#[derive(Clone, Copy)]
enum Node {
    /// `MTConnectDevices`, `Devices`, or a group inside a component: `Components`, `DataItems`.
    Group(&'static str),
    Component(&'static Component),
    Item(&'static DataItem),
}

impl Node {
    const fn element(self) -> &'static str {
        match self {
            Self::Group(name) => name,
            Self::Component(component) => component.element,
            Self::Item(_) => "DataItem",
        }
    }

    fn attribute(self, name: &str) -> Option<&'static str> {
        let value = match (self, name) {
            (Self::Component(component), "id") => component.id,
            (Self::Component(component), "name") => component.name.unwrap_or("lathe"),
            (Self::Item(item), "id" | "name") => item.id,
            (Self::Item(item), "type") => item.item_type,
            (Self::Item(item), "subType") => item.sub_type,
            (Self::Item(item), "category") => item.category.name(),
            (Self::Item(item), "units") => item.units,
            (Self::Item(item), "coordinateSystem") => item.coordinates,
            _ => "",
        };
        (!value.is_empty()).then_some(value)
    }
}

/// Returns the elements from the root of the probe document down to a data item.
fn ancestry(item: &'static DataItem) -> Vec<Node> {
    let mut nodes = vec![Node::Item(item)];
    let mut next = component_index(item.component).map(|index| &COMPONENTS[index]);
    let mut group = "DataItems";
    while let Some(component) = next {
        nodes.push(Node::Group(group));
        nodes.push(Node::Component(component));
        group = "Components";
        next = component
            .parent
            .and_then(component_index)
            .map(|index| &COMPONENTS[index]);
    }
    nodes.push(Node::Group("Devices"));
    nodes.push(Node::Group("MTConnectDevices"));
    nodes.reverse();
    nodes
}

#[derive(Debug, PartialEq, Eq)]
struct AttributeTest {
    attribute: String,
    value: String,
    is_equal: bool,
}

/// The comparisons in brackets of a step: alternatives, each a list of comparisons that must all
/// hold.
type Predicate = Vec<Vec<AttributeTest>>;

#[derive(Debug, PartialEq, Eq)]
struct Step {
    /// Whether further elements may be between this step and the one before (`//`).
    is_deep: bool,
    /// Name of the element; `None` for `*`, any element.
    element: Option<String>,
    predicates: Vec<Predicate>,
}

impl Step {
    fn accepts(&self, node: Node) -> bool {
        let has_name = self
            .element
            .as_ref()
            .is_none_or(|name| name == node.element());
        has_name
            && self.predicates.iter().all(|predicate| {
                let holds = |test: &AttributeTest| {
                    let value = node.attribute(&test.attribute);
                    value.is_some_and(|value| (value == test.value) == test.is_equal)
                };
                predicate.iter().any(|all| all.iter().all(holds))
            })
    }
}

/// Returns for each data item, by its index, whether an XPath expression selects it.
///
/// # Errors
///
/// Returns an error with the position if the expression is outside the supported part of XPath.
pub(crate) fn select_items(expression: &str) -> Result<Vec<bool>, String> {
    if expression.len() > MAX_LENGTH {
        return Err(format!("The path is longer than {MAX_LENGTH} bytes."));
    }
    let mut scanner = Scanner {
        text: expression,
        terms: 0,
    };
    let mut selected = vec![false; DATA_ITEMS.len()];
    loop {
        let steps = scanner.read_path()?;
        for (item, is_selected) in DATA_ITEMS.iter().zip(&mut selected) {
            *is_selected |= selects(&steps, &ancestry(item));
        }
        if !scanner.take("|") {
            break;
        }
    }
    scanner.skip_spaces();
    match scanner.text {
        "" => Ok(selected),
        rest => Err(format!("The path cannot be read from `{rest}` on.")),
    }
}

/// Whether the steps of an XPath expression lead to one of `nodes`, each the child of the one
/// before.
fn selects(steps: &[Step], nodes: &[Node]) -> bool {
    // Depths at which the steps so far may end; -1 is the root above the document.
    let mut ends: Vec<isize> = vec![-1];
    for step in steps {
        let mut next = Vec::new();
        for (depth, node) in nodes.iter().enumerate() {
            let depth = depth as isize;
            let is_reached = ends.iter().any(|end| match step.is_deep {
                true => *end < depth,
                false => end + 1 == depth,
            });
            if is_reached && step.accepts(*node) {
                next.push(depth);
            }
        }
        ends = next;
    }
    !ends.is_empty()
}

struct Scanner<'a> {
    text: &'a str,
    terms: usize,
}

impl Scanner<'_> {
    fn skip_spaces(&mut self) {
        self.text = self.text.trim_start();
    }

    fn take(&mut self, word: &str) -> bool {
        self.skip_spaces();
        let rest = self.text.strip_prefix(word);
        self.text = rest.unwrap_or(self.text);
        rest.is_some()
    }

    fn expect(&mut self, word: &str) -> Result<(), String> {
        match self.take(word) {
            true => Ok(()),
            false => Err(format!("The path lacks `{word}` before `{}`.", self.text)),
        }
    }

    fn count_term(&mut self) -> Result<(), String> {
        self.terms += 1;
        match self.terms > MAX_TERMS {
            true => Err(format!("The path has more than {MAX_TERMS} terms.")),
            false => Ok(()),
        }
    }

    fn read_name(&mut self) -> Result<String, String> {
        self.skip_spaces();
        let is_name =
            |character: char| character.is_ascii_alphanumeric() || "_-:.".contains(character);
        let end = self.text.find(|character| !is_name(character));
        let (name, rest) = self.text.split_at(end.unwrap_or(self.text.len()));
        if name.is_empty() {
            return Err(format!("The path lacks a name before `{}`.", self.text));
        }
        self.text = rest;
        // The prefix of a namespace says nothing here: there is one.
        let local = name.rsplit(':').next().unwrap_or(name);
        Ok(local.to_owned())
    }

    fn read_path(&mut self) -> Result<Vec<Step>, String> {
        let mut steps = Vec::new();
        loop {
            let is_deep = self.take("//");
            if !is_deep && !self.take("/") {
                return match steps.is_empty() {
                    true => Err("The path must begin with `/` or `//`.".to_owned()),
                    false => Ok(steps),
                };
            }
            self.count_term()?;
            let element = match self.take("*") {
                true => None,
                false => Some(self.read_name()?),
            };
            let mut predicates = Vec::new();
            while self.take("[") {
                predicates.push(self.read_predicate()?);
                self.expect("]")?;
            }
            steps.push(Step {
                is_deep,
                element,
                predicates,
            });
        }
    }

    fn read_predicate(&mut self) -> Result<Predicate, String> {
        let mut alternatives = vec![vec![self.read_test()?]];
        loop {
            if self.take("and ") {
                let test = self.read_test()?;
                if let Some(last) = alternatives.last_mut() {
                    last.push(test);
                }
            } else if self.take("or ") {
                alternatives.push(vec![self.read_test()?]);
            } else {
                return Ok(alternatives);
            }
        }
    }

    fn read_test(&mut self) -> Result<AttributeTest, String> {
        self.count_term()?;
        self.expect("@")?;
        let attribute = self.read_name()?;
        let is_equal = !self.take("!");
        self.expect("=")?;
        let quote = if self.take("'") { '\'' } else { '"' };
        if quote == '"' {
            self.expect("\"")?;
        }
        let Some((value, rest)) = self.text.split_once(quote) else {
            return Err("The path has a quote without an end.".to_owned());
        };
        let value = value.to_owned();
        self.text = rest;
        Ok(AttributeTest {
            attribute,
            value,
            is_equal,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn ids(path: &str) -> Vec<&'static str> {
        let selected = select_items(path).expect(path);
        let items = DATA_ITEMS.iter().zip(selected);
        items
            .filter_map(|(item, on)| on.then_some(item.id))
            .collect()
    }

    #[test]
    fn paths_of_clients_select_their_items() {
        assert_eq!(ids("//DataItem").len(), DATA_ITEMS.len());
        assert_eq!(ids("//Device").len(), DATA_ITEMS.len() - 1);
        assert_eq!(
            ids("//Axes//DataItem[@type=\"POSITION\" and @coordinateSystem='WORK']"),
            ["x_work", "z_work"]
        );
        assert_eq!(
            ids("//Linear[@name='X']"),
            ["x_machine", "x_work", "x_load", "x_travel", "x_drive"]
        );
        assert_eq!(
            ids("/MTConnectDevices/Devices/Device/DataItems/DataItem"),
            ["avail", "asset_changed", "asset_removed"]
        );
        assert_eq!(
            ids("//DataItem[@type='EXECUTION' or @type='AVAILABILITY']|//*[@id='line']"),
            ["agent_avail", "avail", "execution", "line"]
        );
        assert_eq!(ids("//m:Chuck"), ["chuck_state"]);
        assert!(ids("//Door").is_empty() && ids("/Axes").is_empty());
        assert_eq!(
            ids("//Controller/DataItems/DataItem[@category!='SAMPLE'][@id!='estop']"),
            ["message", "system", "logic", "link"]
        );
    }

    #[test]
    fn malformed_paths_are_refused() {
        for path in [
            "",
            "DataItem",
            "//",
            "///X",
            "//DataItem[",
            "//DataItem[@type]",
            "//DataItem[@type='A]",
            "//DataItem[@type=A]",
            "//Axes]",
            "//Axes||//Path",
            "//DataItem[position()=1]",
        ] {
            assert!(select_items(path).is_err(), "{path}");
        }
        assert!(select_items(&"//a".repeat(65)).is_err());
        assert!(select_items(&"/".repeat(2000)).is_err());
    }
}
