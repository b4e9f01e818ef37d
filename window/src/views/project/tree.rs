//! The tree of a project (manual PLC-V 4): its nodes, and the values that belong to each.

use gsk_core::model::ProgramNaming;
use gsk_messages::{Message, say};
use gsk_project::{ProjectKey, ProjectSection, ProjectState};

/// A node of the tree that shows a project.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum ProjectNode {
    /// 工程: the node of the whole project.
    Project,
    Plc,
    /// 显示信息表: the node of the ladder's messages.
    Messages,
    /// 主程序: the node of the ladder's rungs.
    Ladder,
    /// 初始化数据表: the node of the ladder's start values.
    Initial,
    /// The node of the PLC data that is retained at power-off.
    Retained,
    /// CNC配置: the node of the control's data.
    Cnc,
    /// 参数: the node of the parameters.
    Parameters,
    /// 刀具偏置: the node of the tool offsets.
    Offsets,
    /// 螺距补偿: the node of the pitch error tables.
    Pitch,
    Variables,
    /// Format and control model of the project, and the settings of the control.
    Settings,
    /// The node of the counters and of the panel settings that are retained.
    Counters,
    /// The node of the electronic disks, which are stored sets of parameters.
    Disks,
    /// 零件加工程序: the node of the part programs.
    Programs,
    /// The node of a program with this number, and its job file.
    Program(u16),
    Machine,
}

struct NodeRow {
    node: ProjectNode,
    /// Indent level in the tree, 1 for the nodes below the project.
    depth: u8,
    name: fn() -> Message,
}

const fn row(node: ProjectNode, depth: u8, name: fn() -> Message) -> NodeRow {
    NodeRow { node, depth, name }
}

/// The rows of the tree below the project. The programs follow the last row.
const ROWS: [NodeRow; 15] = [
    row(ProjectNode::Plc, 1, say::project_node_plc),
    row(ProjectNode::Messages, 2, say::project_node_messages),
    row(ProjectNode::Ladder, 2, say::project_node_ladder),
    row(ProjectNode::Initial, 2, say::project_node_initial),
    row(ProjectNode::Retained, 2, say::project_node_kept),
    row(ProjectNode::Cnc, 1, say::project_node_cnc),
    row(ProjectNode::Parameters, 2, say::project_node_parameters),
    row(ProjectNode::Offsets, 2, say::project_node_offsets),
    row(ProjectNode::Pitch, 2, say::project_node_pitch),
    row(ProjectNode::Variables, 2, say::project_node_variables),
    row(ProjectNode::Settings, 2, say::project_node_settings),
    row(ProjectNode::Counters, 2, say::project_node_counters),
    row(ProjectNode::Disks, 2, say::project_node_disks),
    row(ProjectNode::Machine, 1, say::project_node_machine),
    row(ProjectNode::Programs, 1, say::project_node_programs),
];

/// A node of the project tree as it is drawn.
pub struct TreeEntry {
    pub node: ProjectNode,
    /// Indent level of the node in the tree; 0 for the project.
    pub depth: u8,
    pub name: NodeName,
}

/// The name of a node as the tree shows it.
pub enum NodeName {
    /// A name that is translated into the language of the window.
    Text(Message),
    /// The number of a program as name: `O0001`.
    Program(String),
}

/// The nodes of the tree of a project in order. `programs` includes those that only the other
/// side of a comparison has.
pub fn tree_entries(name: &str, programs: &[u16], naming: ProgramNaming) -> Vec<TreeEntry> {
    let entry = |node, depth, name| TreeEntry { node, depth, name };
    let mut all = Vec::with_capacity(ROWS.len() + programs.len() + 1);
    let title = say::project_node_project(name);
    all.push(entry(ProjectNode::Project, 0, NodeName::Text(title)));
    for row in &ROWS {
        all.push(entry(row.node, row.depth, NodeName::Text((row.name)())));
    }
    all.extend(programs.iter().map(|number| {
        let name = NodeName::Program(naming.name(*number));
        entry(ProjectNode::Program(*number), 2, name)
    }));
    all
}

/// The nodes one level below `node`, with their names; programs are left out.
pub fn children(node: ProjectNode) -> impl Iterator<Item = (ProjectNode, Message)> {
    let at = ROWS.iter().position(|row| row.node == node);
    let depth = at.and_then(|at| ROWS.get(at)).map_or(0, |row| row.depth);
    let rows = ROWS.iter().skip(at.map_or(0, |at| at + 1));
    rows.take_while(move |row| row.depth > depth)
        .filter(move |row| row.depth == depth + 1)
        .map(|row| (row.node, (row.name)()))
}

/// Which parts of two ladders differ. A ladder is one value, but three nodes of the tree.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LadderParts {
    messages: bool,
    rungs: bool,
    initial: bool,
}

impl LadderParts {
    /// Compares the ladders of two projects part by part.
    pub fn compare(old: &ProjectState, new: &ProjectState) -> Self {
        let [old, new] = [old.ladder(), new.ladder()];
        Self {
            messages: old.messages() != new.messages(),
            rungs: rung_lines(old.source()) != rung_lines(new.source()),
            initial: old.start_values() != new.start_values(),
        }
    }
}

/// The lines of a ladder without those of messages and start values.
fn rung_lines(source: &str) -> Vec<&str> {
    let is_rung_line = |line: &&str| {
        let word = line.split_whitespace().next().unwrap_or_default();
        !word.eq_ignore_ascii_case(".MSG") && !word.eq_ignore_ascii_case(".INIT")
    };
    source.lines().filter(is_rung_line).collect()
}

impl ProjectNode {
    /// The nodes that contain a value, from the whole project down to a leaf. `parts`: the
    /// parts of the ladder that differ.
    pub fn containing(key: ProjectKey, parts: LadderParts) -> impl Iterator<Item = Self> {
        let program = match key {
            ProjectKey::Program(number) | ProjectKey::Job(number) => Some(Self::Program(number)),
            _ => None,
        };
        let rows = ROWS.iter().map(|row| row.node);
        core::iter::once(Self::Project)
            .chain(rows)
            .filter(move |node| node.contains(key, parts))
            .chain(program)
    }

    /// Whether the node contains a value. `parts`: the parts of the ladder that differ, since
    /// the ladder is one value.
    pub fn contains(self, key: ProjectKey, parts: LadderParts) -> bool {
        let section = ProjectSection::from_key(key);
        match self {
            Self::Project => true,
            Self::Plc => matches!(section, ProjectSection::Ladder | ProjectSection::Data),
            Self::Messages => section == ProjectSection::Ladder && parts.messages,
            Self::Ladder => section == ProjectSection::Ladder && parts.rungs,
            Self::Initial => section == ProjectSection::Ladder && parts.initial,
            Self::Retained => section == ProjectSection::Data,
            Self::Cnc => children(self).any(|(node, _)| node.contains(key, parts)),
            Self::Parameters => {
                section == ProjectSection::Parameters
                    || matches!(key, ProjectKey::ModelParameter(_))
            }
            Self::Offsets => section == ProjectSection::Offsets,
            Self::Pitch => section == ProjectSection::Pitch,
            Self::Variables => section == ProjectSection::Variables,
            Self::Settings => {
                section == ProjectSection::Settings
                    || matches!(key, ProjectKey::Format | ProjectKey::Model)
            }
            Self::Counters => matches!(section, ProjectSection::Counters | ProjectSection::Panel),
            Self::Disks => section == ProjectSection::Disks,
            Self::Programs => matches!(section, ProjectSection::Programs | ProjectSection::Jobs),
            Self::Program(number) => {
                matches!(key, ProjectKey::Program(own) | ProjectKey::Job(own) if own == number)
            }
            Self::Machine => section == ProjectSection::Machine,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_core::setup::Setup;

    /// Checks that every value belongs to exactly one leaf of the tree.
    #[test]
    fn every_value_belongs_to_one_leaf() {
        let mut setup = Setup::delivered();
        setup.memory.programs.store("O0003;\nM30;\n").unwrap();
        let state =
            ProjectState::from_setup(&setup).with_texts([(ProjectKey::Machine, "()".into())]);
        let parts = LadderParts {
            rungs: true,
            ..LadderParts::default()
        };
        let leaves = ROWS
            .iter()
            .map(|row| row.node)
            .filter(|node| !matches!(node, ProjectNode::Plc | ProjectNode::Cnc));
        let leaves: Vec<ProjectNode> = leaves.collect();
        for key in state.entries().keys() {
            let found: Vec<&ProjectNode> = leaves
                .iter()
                .filter(|it| it.contains(*key, parts))
                .collect();
            assert_eq!(found.len(), 1, "{key:?}: {found:?}");
            let all: Vec<ProjectNode> = ProjectNode::containing(*key, parts).collect();
            assert!(all.contains(found[0]) && all[0] == ProjectNode::Project);
            assert!(all.iter().all(|node| node.contains(*key, parts)));
        }
        assert!(ProjectNode::Program(3).contains(ProjectKey::Program(3), parts));
        assert!(!ProjectNode::Program(3).contains(ProjectKey::Program(4), parts));
    }
}
