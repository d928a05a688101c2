//! Where files may lie.

use std::fmt;
use std::path::{Component, Path, PathBuf};

/// A folder that must not be left, by `..`, by links or by paths from the root.
///
/// What counts is where a file is when it is looked at: somebody who changes links meanwhile is not kept out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Sandbox {
    /// From the root, without links where it is there.
    folder: PathBuf,
    /// As it was named.
    shown: PathBuf,
}

/// That a file lies outside.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outside {
    path: PathBuf,
    folder: PathBuf,
}

impl Sandbox {
    /// In a folder, as seen from the current directory; an empty path is that directory itself.
    #[must_use]
    pub fn new(folder: &Path) -> Self {
        let shown = if folder.as_os_str().is_empty() { Path::new(".") } else { folder };
        Self { folder: resolved(shown), shown: shown.to_owned() }
    }

    /// The folder in which a file lies, as it is named.
    #[must_use]
    pub fn around(file: &Path) -> Self {
        Self::new(file.parent().unwrap_or(Path::new("")))
    }

    /// Whether a file lies in it, be it there or not; nothing is told of what is outside.
    pub fn check(&self, path: &Path) -> Result<(), Outside> {
        // Everything starts with nothing, which is what a folder that cannot be found resolves to.
        if !self.folder.as_os_str().is_empty() && resolved(path).starts_with(&self.folder) {
            return Ok(());
        }
        Err(Outside { path: path.to_owned(), folder: self.shown.clone() })
    }
}

impl fmt::Display for Outside {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { path, folder } = self;
        write!(f, "`{}` lies outside of the scene's folder `{}`", path.display(), folder.display())
    }
}

impl Outside {
    /// What to do about it.
    #[must_use]
    pub fn remedy(&self) -> String {
        "put it there, or leave out `--sandbox` if the scene is trusted".to_owned()
    }
}

/// How many links may lead on from one that leads nowhere.
const MOST_LINKS: usize = 40;

/// Where a path leads from the root, links followed as far as there is something.
fn resolved(path: &Path) -> PathBuf {
    followed(path, MOST_LINKS)
}

fn followed(path: &Path, links: usize) -> PathBuf {
    if let Ok(found) = path.canonicalize() {
        return found;
    }
    let Ok(path) = std::path::absolute(path) else { return PathBuf::new() };
    // Part by part: `..` leads up from where a link leads, not from where it stands.
    let mut found = PathBuf::new();
    for part in path.components() {
        match part {
            Component::CurDir => {}
            Component::ParentDir => _ = found.pop(),
            part => found.push(part),
        }
        if let Ok(there) = found.canonicalize() {
            found = there;
        } else if let Ok(target) = found.read_link() {
            // A link to what is not there: a file that comes later would be where it leads.
            if links == 0 {
                return PathBuf::new();
            }
            let base = found.parent().map(Path::to_owned).unwrap_or_default();
            found = followed(&base.join(target), links - 1);
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::fs;

    #[test]
    fn folders_are_not_left() {
        let dir = tempfile::tempdir().expect("a directory");
        let root = dir.path().join("scene");
        fs::create_dir_all(root.join("inner")).expect("made");
        fs::write(root.join("a.obj"), b"").expect("written");
        fs::write(dir.path().join("b.obj"), b"").expect("written");
        fs::create_dir(dir.path().join("scene2")).expect("made");
        let sandbox = Sandbox::around(&root.join("scene.toml"));
        let inside = ["a.obj", "inner/../a.obj", "inner/lost.obj", "lost/../a.obj", ".", "../scene/a.obj"];
        for path in inside {
            assert_eq!(sandbox.check(&root.join(path)), Ok(()), "{path}");
        }
        for path in
            ["../b.obj", "inner/../../b.obj", "lost/../../b.obj", "../lost.obj", "../scene2/a.obj", ".."]
        {
            assert!(sandbox.check(&root.join(path)).is_err(), "{path}");
        }
        assert_eq!(
            sandbox.check(&root.join("a.obj").canonicalize().expect("there")),
            Ok(()),
            "from the root"
        );
        let outside = sandbox.check(Path::new("/etc/passwd")).expect_err("outside").to_string();
        assert!(outside.starts_with("`/etc/passwd` lies outside of the scene's folder"), "{outside}");
    }

    #[cfg(unix)]
    #[test]
    fn links_count_for_what_they_lead_to() {
        use std::os::unix::fs::symlink;
        let dir = tempfile::tempdir().expect("a directory");
        let root = dir.path().join("scene");
        fs::create_dir_all(root.join("inner/deep")).expect("made");
        fs::create_dir(dir.path().join("other")).expect("made");
        for name in ["a.obj", "other/b.obj"] {
            fs::write(dir.path().join(name), b"").expect("written");
        }
        fs::write(root.join("own.obj"), b"").expect("written");
        let link = |target: &str, name: &str| symlink(target, root.join(name)).expect("linked");
        link("../a.obj", "file.obj");
        link("../other", "folder");
        link("../lost.obj", "dangling.obj");
        link("own.obj", "fine.obj");
        link("inner/deep", "deep");
        link("round.obj", "round.obj");
        let sandbox = Sandbox::new(&root);
        for path in ["fine.obj", "deep/../own.obj", "deep/lost.obj"] {
            assert_eq!(sandbox.check(&root.join(path)), Ok(()), "{path}");
        }
        for path in
            ["file.obj", "folder/b.obj", "folder/lost.obj", "dangling.obj", "folder/../own.obj", "round.obj"]
        {
            assert!(sandbox.check(&root.join(path)).is_err(), "{path}");
        }
        // The folder itself may be reached by a link.
        symlink(&root, dir.path().join("alias")).expect("linked");
        let sandbox = Sandbox::around(&dir.path().join("alias/scene.toml"));
        assert_eq!(sandbox.check(&dir.path().join("alias/own.obj")), Ok(()), "by the link");
        assert!(sandbox.check(&dir.path().join("alias/../a.obj")).is_err(), "beside the folder");
    }
}
