//! Assets: the tools of the job, and the selected program.

use std::sync::Arc;

use gsk_core::program::Program;
use gsk_workpiece::job::{DiameterPoint, Job};
use gsk_workpiece::tool::{Insert, Tool};

use crate::time_stamp::TimeStamp;
use crate::value::tool_asset_id;
use crate::xml::XmlWriter;

/// Greatest number of stored assets.
pub(crate) const ASSET_BUFFER_SIZE: usize = 1024;
/// Name of the XML element of a tool asset.
const TOOL_ELEMENT: &str = "CuttingTool";
/// Name of the XML element of a program asset.
const FILE_ELEMENT: &str = "File";

/// The job and the program whose tools and text are the assets at one moment.
#[derive(Clone, Debug, Default)]
pub struct AgentAssets {
    /// Job of the selected program, whose tools are assets; `None` without one.
    pub job: Option<Job>,
    /// Name and text of the selected program; `None` without one.
    pub program: Option<(String, Program)>,
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) enum AssetContent {
    Tool {
        number: u8,
        tool: Tool,
        /// Length of the tool in X and Z, mm; `None` if the job does not have it.
        length: Option<DiameterPoint>,
    },
    Program {
        text: Arc<str>,
    },
}

#[derive(Clone, Debug, PartialEq)]
pub(crate) struct StoredAsset {
    pub(crate) id: Arc<str>,
    pub(crate) time: TimeStamp,
    pub(crate) is_removed: bool,
    pub(crate) content: AssetContent,
}

impl StoredAsset {
    /// Returns the name of the XML element, which is the type of the asset.
    pub(crate) const fn element(&self) -> &'static str {
        match self.content {
            AssetContent::Tool { .. } => TOOL_ELEMENT,
            AssetContent::Program { .. } => FILE_ELEMENT,
        }
    }
}

/// Whether an asset is new or changed, or was removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum AssetChange {
    Changed,
    Removed,
}

/// The stored assets, the latest last. Removed ones stay stored until newer ones need their space.
#[derive(Debug, Default)]
pub(crate) struct AssetBuffer {
    entries: Vec<StoredAsset>,
}

impl AssetBuffer {
    /// Stores the current assets; returns the changed and removed ones, each with XML element and
    /// identifier.
    pub(crate) fn update(
        &mut self,
        time: TimeStamp,
        assets: &AgentAssets,
    ) -> Vec<(AssetChange, &'static str, Arc<str>)> {
        let current = list_assets(time, assets);
        let mut changes = Vec::new();
        for entry in &mut self.entries {
            let remains = current.iter().any(|asset| asset.id == entry.id);
            if !remains && !entry.is_removed {
                entry.is_removed = true;
                entry.time = time;
                changes.push((AssetChange::Removed, entry.element(), Arc::clone(&entry.id)));
            }
        }
        for asset in current {
            let is_known = (self.entries.iter())
                .any(|it| it.id == asset.id && !it.is_removed && it.content == asset.content);
            if !is_known {
                self.entries.retain(|entry| entry.id != asset.id);
                changes.push((AssetChange::Changed, asset.element(), Arc::clone(&asset.id)));
                self.entries.push(asset);
            }
        }
        if self.entries.len() > ASSET_BUFFER_SIZE {
            let surplus = self.entries.len() - ASSET_BUFFER_SIZE;
            self.entries.drain(..surplus);
        }
        changes
    }

    /// Returns the number of stored assets that are not removed.
    pub(crate) fn count(&self) -> usize {
        self.entries.iter().filter(|it| !it.is_removed).count()
    }

    /// Returns the asset with this identifier; `None` if it is not stored.
    pub(crate) fn get(&self, id: &str) -> Option<&StoredAsset> {
        self.entries.iter().find(|asset| &*asset.id == id)
    }

    /// Returns all stored assets, also removed ones, the newest first.
    pub(crate) fn newest_first(&self) -> impl Iterator<Item = &StoredAsset> {
        self.entries.iter().rev()
    }
}

fn list_assets(time: TimeStamp, assets: &AgentAssets) -> Vec<StoredAsset> {
    let stored = |id: String, content| StoredAsset {
        id: id.into(),
        time,
        is_removed: false,
        content,
    };
    let tools = assets.job.iter().flat_map(|job| {
        job.tools.iter().map(|(&number, tool)| {
            let content = AssetContent::Tool {
                number,
                tool: tool.clone(),
                length: job.lengths.get(&number).copied(),
            };
            stored(tool_asset_id(number), content)
        })
    });
    let program = assets.program.iter().map(|(name, program)| {
        let content = AssetContent::Program {
            text: program.text().into(),
        };
        stored(name.clone(), content)
    });
    tools.chain(program).collect()
}

/// Returns the FNV-1a hash of a text, which is the version of a program asset.
pub(crate) fn text_hash(text: &str) -> u64 {
    let hash = |hash: u64, byte: u8| (hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    text.bytes().fold(0xcbf2_9ce4_8422_2325, hash)
}

/// Writes one asset as XML. `device` is the identifier of the lathe, `base_url` the address of the
/// agent.
pub(crate) fn write_asset(xml: &mut XmlWriter, asset: &StoredAsset, device: &str, base_url: &str) {
    xml.open(asset.element())
        .attribute("assetId", &asset.id)
        .attribute("timestamp", asset.time)
        .attribute("deviceUuid", device)
        .attribute_if("removed", asset.is_removed.then_some("true"));
    match &asset.content {
        AssetContent::Tool {
            number,
            tool,
            length,
        } => {
            xml.attribute("serialNumber", format_args!("{device}.{}", asset.id))
                .attribute("toolId", &asset.id);
            write_life_cycle(xml, *number, tool, *length);
        }
        AssetContent::Program { text } => {
            xml.attribute("name", &asset.id)
                .attribute("mediaType", "text/plain")
                .attribute("applicationCategory", "PART")
                .attribute("applicationType", "PRODUCTION_PROGRAM")
                .attribute("state", "PRODUCTION")
                .attribute("size", text.len())
                .attribute("versionId", format_args!("{:016x}", text_hash(text)));
            xml.open("FileLocation")
                .attribute("href", format_args!("{base_url}/programs/{}", asset.id))
                .close();
            xml.element("CreationTime", asset.time);
        }
    }
    xml.close();
}

fn write_life_cycle(xml: &mut XmlWriter, number: u8, tool: &Tool, length: Option<DiameterPoint>) {
    xml.open("CuttingToolLifeCycle");
    xml.open("CutterStatus")
        .element("Status", "AVAILABLE")
        .close();
    xml.element("ProgramToolNumber", number);
    xml.open("Location")
        .attribute("type", "STATION")
        .text(number)
        .close();
    if let Some(length) = length {
        xml.open("Measurements");
        write_measurement(xml, "FunctionalLength", "LF", "MILLIMETER", length.z);
        xml.close();
    }
    xml.open("CuttingItems").attribute("count", 1);
    xml.open("CuttingItem").attribute("indices", 1);
    xml.open("Measurements");
    match tool.insert {
        Insert::Turning { entering, size, .. } => {
            write_measurement(xml, "CornerRadius", "RE", "MILLIMETER", tool.nose());
            write_measurement(xml, "IncribedCircleDiameter", "IC", "MILLIMETER", size);
            write_measurement(xml, "ToolCuttingEdgeAngle", "KAPR", "DEGREE", entering);
        }
        Insert::Grooving { width, nose, .. } => {
            write_measurement(xml, "CornerRadius", "RE", "MILLIMETER", nose);
            write_measurement(xml, "CuttingEdgeLength", "L", "MILLIMETER", width);
        }
        Insert::Threading { angle, nose, .. } => {
            write_measurement(xml, "CornerRadius", "RE", "MILLIMETER", nose);
            write_measurement(xml, "StepIncludedAngle", "STA", "DEGREE", angle);
        }
        Insert::Drill {
            diameter, point, ..
        } => {
            write_measurement(xml, "CuttingDiameter", "DC", "MILLIMETER", diameter);
            write_measurement(xml, "PointAngle", "SIG", "DEGREE", point);
        }
    }
    xml.close().close().close().close();
}

fn write_measurement(
    xml: &mut XmlWriter,
    element: &'static str,
    code: &str,
    units: &str,
    value: f64,
) {
    xml.open(element)
        .attribute("code", code)
        .attribute("units", units)
        .text(value)
        .close();
}

#[cfg(test)]
mod tests {
    use super::*;
    use gsk_workpiece::stock::Stock;

    #[test]
    fn changes_of_the_job_are_changes_of_assets() {
        let mut buffer = AssetBuffer::default();
        let mut job = Job::new(Stock::bar(40.0, 1.0, 50.0));
        job.tools.insert(1, Tool::turning());
        job.tools.insert(2, Tool::drill(8.0));
        let mut assets = AgentAssets {
            job: Some(job.clone()),
            program: Some(("O0001".to_owned(), Program::new("O0001;\nM30;\n"))),
        };
        let changes = buffer.update(TimeStamp(1), &assets);
        let ids: Vec<&str> = changes.iter().map(|change| &*change.2).collect();
        assert_eq!(ids, ["T01", "T02", "O0001"]);
        assert!(buffer.update(TimeStamp(2), &assets).is_empty());
        job.tools.remove(&1);
        job.tools.insert(2, Tool::drill(9.0));
        assets.job = Some(job);
        let changes = buffer.update(TimeStamp(3), &assets);
        let (removed, changed) = (AssetChange::Removed, AssetChange::Changed);
        assert_eq!(
            changes,
            [
                (removed, TOOL_ELEMENT, "T01".into()),
                (changed, TOOL_ELEMENT, "T02".into())
            ]
        );
        assert_eq!(buffer.count(), 2);
        let removed = buffer.get("T01").expect("a removed asset");
        assert!(removed.is_removed && removed.time == TimeStamp(3));
    }
}
