//! The shaders' sources. WGSL has no includes: the parts are put together when the crate is built.

use std::borrow::Cow;

use super::Counting;

/// The source of a pass, for targets with one sample a pixel and with several.
#[derive(Clone, Debug)]
pub struct Shader {
    /// For one sample a pixel.
    pub single: Cow<'static, str>,
    /// For several.
    pub multisampled: Cow<'static, str>,
}

impl Shader {
    /// The one for a number of samples.
    pub fn source(&self, multisampled: bool) -> &str {
        if multisampled { &self.multisampled } else { &self.single }
    }
}

/// The WGSL of every pass. The defaults are the files in `shaders/`; another source is for working
/// around a driver, and for tests that break one on purpose.
#[derive(Clone, Debug)]
pub struct Shaders {
    /// [`Counting::Fragments`].
    pub count_fragments: Shader,
    /// [`Counting::Workgroups`].
    pub count_workgroups: Shader,
    /// [`Counting::Subgroups`].
    pub count_subgroups: Shader,
    /// [`Counting::Blocks`].
    pub count_blocks: Shader,
    /// What [`Counting::Blocks`] gathers first.
    pub gather_blocks: Shader,
    /// [`AnyBy::Native`](super::AnyBy::Native), for any number of samples.
    pub ask_natively: Cow<'static, str>,
    /// Proxies from boxes, for sweeps; for any number of samples.
    pub project: Cow<'static, str>,
    /// [`SweepTest::Raster`](crate::query::SweepTest::Raster).
    pub sweep_raster: Shader,
    /// Where the tree's nodes lie on the screen, for [`SweepTest::Rays`](crate::query::SweepTest::Rays);
    /// for any number of samples.
    pub enclose: Cow<'static, str>,
    /// The list of a sweep's groups; for any number of samples.
    pub enlist: Cow<'static, str>,
    /// [`SweepTest::Rays`](crate::query::SweepTest::Rays).
    pub sweep_rays: Shader,
    /// [`SweepTest::Owners`](crate::query::SweepTest::Owners).
    pub sweep_owners: Shader,
    /// The pyramid of farthest depths.
    pub build_pyramid: Shader,
    /// [`SweepTest::HiZ`](crate::query::SweepTest::HiZ).
    pub sweep_hi_z: Shader,
    /// What the pyramid shows to be hidden, and a few samples to be seen, before closer tests.
    pub prune: Shader,
    /// Which nodes of the tree hold what was drawn first, in an indirect frame by rays.
    pub mark: Cow<'static, str>,
    /// Its groups, and its loose objects.
    pub extract: Cow<'static, str>,
    /// Its verdicts in the order of meshes.
    pub spread: Cow<'static, str>,
    /// Which objects a list of an indirect frame holds.
    pub select: Cow<'static, str>,
    /// Who is forgotten of those that own no sample, in an indirect frame with an item buffer.
    pub filter: Cow<'static, str>,
    /// Instances and arguments of an indirect frame.
    pub compact: Cow<'static, str>,
}

impl Shaders {
    /// The source that a way of counting uses.
    pub fn source(&self, counting: Counting, multisampled: bool) -> &str {
        let shader = match counting {
            Counting::Fragments => &self.count_fragments,
            Counting::Workgroups => &self.count_workgroups,
            Counting::Subgroups => &self.count_subgroups,
            Counting::Blocks => &self.count_blocks,
        };
        shader.source(multisampled)
    }

    /// The source that gathers blocks.
    pub fn gather_blocks_source(&self, multisampled: bool) -> &str {
        self.gather_blocks.source(multisampled)
    }
}

/// A pass, after the parts that it shares with others: what it reads of the frame, depth if nothing else
/// is named, and the rest.
macro_rules! shader {
    ([$single:literal, $multisampled:literal] $($part:literal),*) => {
        shader!([bare $single, $multisampled] "shared/question.wgsl", $($part),*)
    };
    // Without the proxies as they are mostly read.
    ([bare $single:literal, $multisampled:literal] $($part:literal),*) => {
        Shader {
            single: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/proxy.wgsl"),
                include_str!("../../../shaders/shared/frame.wgsl"),
                include_str!(concat!("../../../shaders/", $single)),
                $(include_str!(concat!("../../../shaders/", $part))),*
            )),
            multisampled: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/proxy.wgsl"),
                include_str!("../../../shaders/shared/frame.wgsl"),
                include_str!(concat!("../../../shaders/", $multisampled)),
                $(include_str!(concat!("../../../shaders/", $part))),*
            )),
        }
    };
    ($($part:literal),*) => {
        shader!(["shared/depth.wgsl", "shared/depth_multisampled.wgsl"] $($part),*)
    };
}

impl Default for Shaders {
    fn default() -> Self {
        Self {
            count_fragments: shader!(
                "shared/counts.wgsl",
                "shared/corner.wgsl",
                "shared/rectangle.wgsl",
                "count_fragments.wgsl"
            ),
            count_workgroups: shader!(
                "shared/counts.wgsl",
                "shared/tiles.wgsl",
                "shared/add_lanes.wgsl",
                "count_workgroups.wgsl"
            ),
            count_subgroups: shader!(
                "shared/counts.wgsl",
                "shared/tiles.wgsl",
                "shared/add_subgroups.wgsl",
                "count_workgroups.wgsl"
            ),
            count_blocks: shader!("shared/counts.wgsl", "shared/tiles.wgsl", "count_blocks.wgsl"),
            gather_blocks: shader!("gather_blocks.wgsl"),
            ask_natively: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/proxy.wgsl"),
                include_str!("../../../shaders/shared/frame.wgsl"),
                include_str!("../../../shaders/shared/question.wgsl"),
                include_str!("../../../shaders/ask_natively.wgsl"),
            )),
            project: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/proxy.wgsl"),
                include_str!("../../../shaders/shared/verdict.wgsl"),
                include_str!("../../../shaders/shared/nodes.wgsl"),
                include_str!("../../../shaders/sweep/place.wgsl"),
                include_str!("../../../shaders/sweep/project.wgsl"),
            )),
            sweep_raster: shader!(
                "shared/verdict.wgsl",
                "shared/corner.wgsl",
                "shared/rectangle.wgsl",
                "shared/listed_rectangle.wgsl",
                "sweep/raster.wgsl"
            ),
            enclose: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/verdict.wgsl"),
                include_str!("../../../shaders/shared/nodes.wgsl"),
                include_str!("../../../shaders/sweep/place.wgsl"),
                include_str!("../../../shaders/sweep/enclose.wgsl"),
            )),
            enlist: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/proxy.wgsl"),
                include_str!("../../../shaders/shared/verdict.wgsl"),
                include_str!("../../../shaders/shared/nodes.wgsl"),
                include_str!("../../../shaders/shared/listed.wgsl"),
                include_str!("../../../shaders/shared/list_group.wgsl"),
                include_str!("../../../shaders/sweep/enlist.wgsl"),
            )),
            sweep_rays: shader!(
                "shared/verdict.wgsl",
                "shared/nodes.wgsl",
                "shared/corner.wgsl",
                "shared/listed_rectangle.wgsl",
                "sweep/rays.wgsl"
            ),
            sweep_owners: shader!(
                ["shared/ids.wgsl", "shared/ids_multisampled.wgsl"]
                "shared/verdict.wgsl",
                "sweep/owners.wgsl"
            ),
            build_pyramid: shader!("shared/pyramid.wgsl", "sweep/pyramid.wgsl"),
            sweep_hi_z: shader!(
                "shared/verdict.wgsl",
                "shared/pyramid.wgsl",
                "shared/farthest.wgsl",
                "sweep/hi_z.wgsl"
            ),
            prune: shader!(
                [bare "shared/depth.wgsl", "shared/depth_multisampled.wgsl"]
                "shared/verdict.wgsl",
                "shared/nodes.wgsl",
                "shared/pyramid.wgsl",
                "shared/farthest.wgsl",
                "shared/listed.wgsl",
                "sweep/prune.wgsl"
            ),
            mark: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/nodes.wgsl"),
                include_str!("../../../shaders/shared/marks.wgsl"),
                include_str!("../../../shaders/indirect/mark.wgsl"),
            )),
            extract: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/proxy.wgsl"),
                include_str!("../../../shaders/shared/verdict.wgsl"),
                include_str!("../../../shaders/shared/nodes.wgsl"),
                include_str!("../../../shaders/shared/marks.wgsl"),
                include_str!("../../../shaders/shared/listed.wgsl"),
                include_str!("../../../shaders/shared/list_group.wgsl"),
                include_str!("../../../shaders/indirect/extract.wgsl"),
            )),
            spread: Cow::Borrowed(include_str!("../../../shaders/indirect/spread.wgsl")),
            select: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/verdict.wgsl"),
                include_str!("../../../shaders/indirect/select.wgsl"),
            )),
            filter: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/verdict.wgsl"),
                include_str!("../../../shaders/indirect/filter.wgsl"),
            )),
            compact: Cow::Borrowed(include_str!("../../../shaders/indirect/compact.wgsl")),
        }
    }
}
