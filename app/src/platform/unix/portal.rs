//! Whether the desktop has a file dialog to offer. Its answer to a program without one
//! is the same as that of a user who gave up.

/// Whether there is a file dialog of the desktop. Waits for a desktop that has to start
/// it first.
pub fn file_dialog_answers() -> bool {
    pollster::block_on(version()).is_ok()
}

/// Version of the portal's file dialog.
async fn version() -> zbus::Result<u32> {
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
