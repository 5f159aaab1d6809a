//! `--record FILE`: the run, taken down to be replayed.

use std::fs::File;
use std::io::BufWriter;
use std::path::PathBuf;

use anyhow::Context;
use tercet::geom::View;
use tercet::record::Recorder;
use tercet::scene::{Scene, SceneConfig};

use super::flags::Flags;
use super::run::Eye;
use super::stage::Stage;

/// A recording in the making, if there is to be one.
pub struct Recording(Option<(PathBuf, Recorder<BufWriter<File>>)>);

impl Recording {
    /// Begins one if the flags say so: before anything is done to the scene.
    ///
    /// # Errors
    /// When the file cannot be written, or the policy is one of which there is nothing to record.
    pub fn new(
        flags: &Flags,
        config: &SceneConfig,
        scene: &mut Scene,
        eye: &Eye,
        stage: &mut Stage,
        about: &str,
    ) -> anyhow::Result<Self> {
        let Some(path) = &flags.record else { return Ok(Self(None)) };
        let file = File::create(path).with_context(|| format!("cannot write {}", path.display()))?;
        let about = format!("{about}, seed {}, {}", flags.seed, stage.backend());
        let recorder = Recorder::new(BufWriter::new(file), config, scene, eye, &about)?;
        stage.listen(true);
        Ok(Self(Some((path.clone(), recorder))))
    }

    /// To be called just before the stage's frame.
    pub fn begin(&mut self, scene: &mut Scene, view: &View, eye: &Eye) {
        if let Some((_, recorder)) = &mut self.0 {
            recorder.begin(scene, view, eye);
        }
    }

    /// To be called after it.
    pub fn end(&mut self, eye: &Eye, stage: &mut Stage) -> anyhow::Result<()> {
        if let Some((_, recorder)) = &mut self.0 {
            match stage {
                Stage::Software(stage) => recorder.end(eye, stage.log())?,
                Stage::Wgpu(stage) => recorder.end(eye, stage.log())?,
                // Refused with the flags.
                Stage::GpuDriven(_) => {}
            }
        }
        Ok(())
    }

    /// Writes the end, and says how to replay it.
    pub fn finish(self) -> anyhow::Result<()> {
        if let Some((path, recorder)) = self.0 {
            recorder.finish()?;
            let path = path.display();
            println!("recorded; replay it with: cargo run --release --example replay -- {path}");
        }
        Ok(())
    }
}
