//! The document with assets.

use super::{DocumentContext, add_sizes};
use crate::assets::{ASSET_BUFFER_SIZE, StoredAsset, write_asset};

/// Writes a document with assets; `count` is the number of all stored ones.
pub(crate) fn write_assets(
    context: DocumentContext<'_>,
    count: usize,
    assets: &[&StoredAsset],
) -> String {
    let mut xml = context.begin("MTConnectAssets");
    add_sizes(
        &mut xml,
        &[
            ("assetBufferSize", &ASSET_BUFFER_SIZE),
            ("assetCount", &count),
        ],
    );
    xml.close();
    xml.open("Assets");
    for asset in assets {
        let identity = context.identity;
        write_asset(&mut xml, asset, &identity.uuid, &identity.base_url);
    }
    xml.finish()
}
