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

/// The WGSL of every pass. The defaults are the files in `shaders/`; another source is for working
/// around a driver, and for tests that break one on purpose.
#[derive(Clone, Debug)]
pub struct Shaders {
    /// [`Counting::Fragments`].
    pub count_fragments: Shader,
    /// [`Counting::Workgroups`].
    pub count_workgroups: Shader,
}

impl Shaders {
    /// The source that a way of counting uses.
    pub fn source(&self, counting: Counting, multisampled: bool) -> &str {
        let shader = match counting {
            Counting::Fragments => &self.count_fragments,
            Counting::Workgroups => &self.count_workgroups,
        };
        if multisampled { &shader.multisampled } else { &shader.single }
    }
}

/// A pass behind what all passes share.
macro_rules! shader {
    ($pass:literal) => {
        Shader {
            single: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/question.wgsl"),
                include_str!("../../../shaders/shared/depth.wgsl"),
                include_str!(concat!("../../../shaders/", $pass)),
            )),
            multisampled: Cow::Borrowed(concat!(
                include_str!("../../../shaders/shared/question.wgsl"),
                include_str!("../../../shaders/shared/depth_multisampled.wgsl"),
                include_str!(concat!("../../../shaders/", $pass)),
            )),
        }
    };
}

impl Default for Shaders {
    fn default() -> Self {
        Self {
            count_fragments: shader!("count_fragments.wgsl"),
            count_workgroups: shader!("count_workgroups.wgsl"),
        }
    }
}
