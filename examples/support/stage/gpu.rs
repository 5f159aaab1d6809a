//! A graphics adapter with a device: what an app has anyway, long before it asks what is hidden.

use std::env;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::time::Duration;

use anyhow::{Context, bail};
use tercet::query::gpu::{GpuQueries, wgpu};
use wgpu::{Adapter, AdapterInfo, Backends, Device, DeviceDescriptor, DeviceType, Instance, Queue};

/// How long a frame may take.
const PATIENCE: Duration = Duration::from_secs(60);

/// A device, and what it runs on.
#[derive(Clone, Debug)]
pub struct Gpu {
    /// Makes buffers, textures and pipelines.
    pub device: Device,
    /// Takes work.
    pub queue: Queue,
    info: AdapterInfo,
}

impl Gpu {
    /// The most powerful adapter that there is, among those that `WGPU_BACKEND` allows; None
    /// without any.
    ///
    /// # Errors
    /// When it has no device to give.
    pub fn open() -> anyhow::Result<Option<Self>> {
        let mut descriptor = wgpu::InstanceDescriptor::new_without_display_handle();
        descriptor.backends = Backends::from_env().unwrap_or(Backends::PRIMARY | Backends::GL);
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let instance = Instance::new(descriptor);
        let Ok(adapter) = pollster::block_on(instance.request_adapter(&options)) else { return Ok(None) };
        let request = adapter.request_device(&Self::descriptor(&adapter));
        let (device, queue) = pollster::block_on(request)
            .with_context(|| format!("the graphics adapter {} cannot be used", adapter.get_info().name))?;
        Ok(Some(Self::new(&adapter, device, queue)))
    }

    /// What [`Gpu::open`] gave, where there must be something.
    ///
    /// # Errors
    /// When there is none, saying what to do.
    pub fn found(gpu: Option<Self>) -> anyhow::Result<Self> {
        let remedy = Self::remedy;
        gpu.with_context(|| format!("no graphics adapter was found; {}, or use --backend software", remedy()))
    }

    /// The device of somebody else.
    pub fn new(adapter: &Adapter, device: Device, queue: Queue) -> Self {
        Self { device, queue, info: adapter.get_info() }
    }

    /// What a device is asked for: everything optional that the engine can use, and no more.
    pub fn descriptor(adapter: &Adapter) -> DeviceDescriptor<'static> {
        DeviceDescriptor {
            required_features: GpuQueries::wanted_features(adapter),
            required_limits: adapter.limits(),
            ..Default::default()
        }
    }

    /// What to do where there is none.
    pub fn remedy() -> String {
        match env::var("WGPU_BACKEND") {
            Ok(value) => format!(
                "WGPU_BACKEND={value} allows no backend that this machine has: unset it, or set it to vulkan or gl"
            ),
            Err(_) => "install a Vulkan or OpenGL driver; Mesa's needs no GPU".to_owned(),
        }
    }

    /// Waits until everything that was submitted is done.
    ///
    /// # Errors
    /// When the device is lost, or takes longer than a minute.
    pub fn wait(&self) -> anyhow::Result<()> {
        let wait = wgpu::PollType::Wait { submission_index: None, timeout: Some(PATIENCE) };
        // A device that is lost meanwhile makes wgpu 30 panic.
        match catch_unwind(AssertUnwindSafe(|| self.device.poll(wait))) {
            Ok(polled) => polled.map(drop).with_context(|| format!("{} does not answer", self.adapter())),
            Err(_) => bail!("{} was lost", self.adapter()),
        }
    }

    /// The longest side of a picture.
    pub fn most_pixels_a_side(&self) -> u32 {
        self.device.limits().max_texture_dimension_2d
    }

    /// The adapter in words.
    pub fn adapter(&self) -> String {
        format!("{} ({})", self.info.name, self.info.backend)
    }

    /// Whether it is more than a CPU that plays the GPU's part.
    pub fn is_hardware(&self) -> bool {
        self.info.device_type != DeviceType::Cpu
    }
}
