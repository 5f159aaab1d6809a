//! The window as a PNG.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, channel};

use anyhow::Context as _;
use eframe::egui::{ColorImage, Context, ScreenshotCallback, ViewportCommand};

/// Pictures that were asked for and have not arrived.
#[derive(Default)]
pub struct Screenshots {
    waiting: Option<Receiver<Arc<ColorImage>>>,
}

impl Screenshots {
    /// Asks for a picture of the window.
    pub fn take(&mut self, ctx: &Context) {
        let (send, receive) = channel();
        self.waiting = Some(receive);
        let callback = ScreenshotCallback::new(move |image| {
            // The window may have been closed meanwhile: then nobody wants it.
            let _ = send.send(image);
        });
        ctx.send_viewport_cmd(ViewportCommand::Screenshot(callback));
    }

    /// Saves what has arrived into a folder, and says where.
    pub fn save(&mut self, folder: &Path) -> Option<anyhow::Result<PathBuf>> {
        let image = self.waiting.as_ref()?.try_recv().ok()?;
        self.waiting = None;
        let file = (1..).map(|n| folder.join(format!("screenshot_{n}.png"))).find(|file| !file.exists())?;
        Some(write(&file, &image).map(|()| file))
    }
}

fn write(file: &Path, image: &ColorImage) -> anyhow::Result<()> {
    if let Some(folder) = file.parent() {
        std::fs::create_dir_all(folder)?;
    }
    let bytes: Vec<u8> = image.pixels.iter().flat_map(|color| color.to_array()).collect();
    let [width, height] = image.size.map(|side| side as u32);
    image::save_buffer(file, &bytes, width, height, image::ColorType::Rgba8)
        .with_context(|| format!("cannot write {}", file.display()))
}
