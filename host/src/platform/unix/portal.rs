//! Checks whether the desktop has a file dialog. Without one, a request for a dialog
//! returns the same as a dialog that the user has cancelled.

/// Whether the desktop has a file dialog. Waits at most 3 s for a desktop that must start its
/// dialog service first.
pub fn has_file_dialog() -> bool {
    pollster::block_on(portal_version()).is_ok()
}

/// Returns the version of the file dialog of the desktop portal.
async fn portal_version() -> zbus::Result<u32> {
    const LONGEST: std::time::Duration = std::time::Duration::from_secs(3);
    let session = zbus::connection::Builder::session()?
        .method_timeout(LONGEST)
        .build()
        .await?;
    let portal = zbus::Proxy::new(
        &session,
        "org.freedesktop.portal.Desktop",
        "/org/freedesktop/portal/desktop",
        "org.freedesktop.portal.FileChooser",
    )
    .await?;
    portal.get_property("version").await
}
