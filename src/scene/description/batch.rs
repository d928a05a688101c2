//! What a batch file says: pictures to render, one after the other or side by side.

use super::{Frames, Located};
use crate::scene::load::batch;
use crate::scene::load::node::Node;
use crate::scene::load::report::Report;
use crate::scene::record::{Rules, Value, record};
use serde_json::{Map, Value as Json, json};
use std::path::PathBuf;

record! {
    /// A list of pictures to render. Files in it are as seen from its folder.
    pub struct Batch checked by batch::check {
        /// What jobs have that do not say it themselves; overrides of a job come after these.
        defaults: JobSettings;
        /// Pictures, or sequences of them.
        jobs: Vec<Located<Job>>;
    }
}

record! {
    /// A picture, or a sequence of pictures.
    pub struct Job {
        /// What the job is called, and what `{name}` stands for in names of outputs; absent: the name of the scene file.
        name: Option<Located<String>>;
        ..own: JobSettings, "Everything else.";
    }
}

record! {
    /// What is rendered, and how.
    pub struct JobSettings {
        /// The scene file.
        scene: Option<Located<PathBuf>>, file(&["toml"]);
        /// Values in place of those of the scene file, by dotted path as with `-D`: `render.spp = 64`, `shapes.model.file = "my.obj"`. A table in
        /// braces replaces what is there.
        overrides: Overrides;
        /// Frames of a sequence: a number, "A..B" with both ends rendered, "A..BxSTEP", or several with commas between. Each is rendered as
        /// by `--frames`; absent: one picture at the time of the scene file.
        frames: Option<Frames>;
        /// Files to write, .exr or .png. `{name}` is the name of the job, `####` and `{frame}` the number of the frame, with zeros before it to as many
        /// digits as there are `#`; absent: an .exr and a .png named after the job.
        outputs: Vec<Located<String>>;
        /// Further outputs of EXR files, by the names of `--aov`.
        aov: Vec<Located<String>>;
        /// The only pixels to render: x0, y0, x1, y1, the upper ends excluded.
        crop: Option<Located<[u32; 4]>>, unit("pixels");
        /// Whether colour, coverage and normals in EXR files are stored as 16-bit floats; absent: not. Other outputs keep all digits.
        half: Option<bool>;
        /// When a picture ends, whatever samples it has.
        time_limit_s: Option<f64>, unit("s"), above(0.0);
        /// The relMSE at which a picture ends, whatever samples it has.
        target_error: Option<f64>, above(0.0);
    }
}

impl Default for JobSettings {
    /// Nothing is said.
    fn default() -> Self {
        Self {
            scene: None,
            overrides: Overrides::default(),
            frames: None,
            outputs: vec![],
            aov: vec![],
            crop: None,
            half: None,
            time_limit_s: None,
            target_error: None,
        }
    }
}

/// Values of a scene file to be replaced, each as `key=value` on the command line.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Overrides(pub Vec<Located<String>>);

impl Value for Overrides {
    fn decode(node: &Node, key: &str, rules: &Rules, report: &mut Report) -> Option<Self> {
        let Some(entries) = node.entries() else {
            let remedy = format!("it must be {}", Self::expects(rules));
            report.error(&node.spot, format!("`{key}` is {}", node.kind()), remedy);
            return None;
        };
        let mut found = Vec::new();
        for entry in entries {
            batch::flatten(entry.key.clone(), &entry.node, &mut found, report)?;
        }
        Some(Self(found))
    }

    fn expects(_: &Rules) -> String {
        "a table of dotted paths, such as { render.spp = 64 }".into()
    }

    fn schema(_: &Rules, _: &mut Map<String, Json>) -> Json {
        json!({ "type": "object" })
    }

    fn to_json(&self) -> Json {
        self.0.iter().filter_map(|text| batch::entry(text)).collect()
    }

    fn absent(_: &Node) -> Option<Self> {
        Some(Self::default())
    }
}
