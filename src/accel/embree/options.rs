//! What scenes are built for.

use embree4_sys as sys;

/// How much time a build may take for the sake of faster queries.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Fastest build (Morton codes), slower queries.
    Low,
    /// Binned surface area heuristic.
    #[default]
    Medium,
    /// With spatial splits. Together with `robust` or `compact` Embree builds as for `Medium`.
    High,
}

/// What a scene is built for. The default is the fastest: medium quality, nothing else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SceneOptions {
    /// Effort of the build.
    pub quality: Quality,
    /// Avoid optimisations that lose accuracy: no ray slips between neighbouring triangles; queries cost a quarter more.
    pub robust: bool,
    /// Half the memory; queries cost a third more.
    pub compact: bool,
    /// Prefer quick rebuilds after [`super::Scene::reopen`].
    pub dynamic: bool,
    /// Hold two triangles in a row as one quad where they can be its halves: read where meshes are made. Builds in half the
    /// time, saves a fifth to a third of the memory, and slows coherent packets.
    pub quads: bool,
}

impl SceneOptions {
    pub(super) fn flags(self) -> sys::RTCSceneFlags {
        let flag = |set, flag| if set { flag } else { sys::RTC_SCENE_FLAG_NONE };
        flag(self.robust, sys::RTC_SCENE_FLAG_ROBUST)
            | flag(self.compact, sys::RTC_SCENE_FLAG_COMPACT)
            | flag(self.dynamic, sys::RTC_SCENE_FLAG_DYNAMIC)
    }

    pub(super) fn quality(self) -> sys::RTCBuildQuality {
        match self.quality {
            Quality::Low => sys::RTC_BUILD_QUALITY_LOW,
            Quality::Medium => sys::RTC_BUILD_QUALITY_MEDIUM,
            Quality::High => sys::RTC_BUILD_QUALITY_HIGH,
        }
    }
}
