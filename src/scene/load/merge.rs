//! From files that include each other to one tree.

use crate::error::{Error, Place};
use crate::scene::description::Located;
use crate::scene::load::node::{Content, Entry, Node};
use crate::scene::load::report::Report;
use crate::scene::load::source::{Source, Spot};
use crate::scene::load::{files, words};
use crate::scene::record::{Rules, Value};
use crate::trust::{Excess, Limit, Limits, Trust};
use std::collections::HashMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// How deep files may include each other whatever limits say: more might be too much for the stack.
const DEEPEST: u64 = 1000;

/// Reads files, each once.
#[derive(Debug)]
pub(crate) struct Reader {
    /// How far they are trusted.
    trust: Arc<Trust>,
    /// Bytes read so far.
    bytes: u64,
    /// Files that are being read, outermost first, with where their includes stand.
    open: Vec<(PathBuf, Option<Spot>)>,
    /// Files that were read.
    done: Vec<PathBuf>,
    /// Whether any file could not be read, so that references may point to what is missing.
    pub(crate) incomplete: bool,
}

impl Reader {
    /// Has read nothing yet.
    pub(crate) fn new(trust: Arc<Trust>) -> Self {
        Self { trust, bytes: 0, open: vec![], done: vec![], incomplete: false }
    }

    /// Files that were read.
    pub(crate) fn done(&self) -> &[PathBuf] {
        &self.done
    }

    /// The tree of a file and of what it includes; `None` with the problems reported where nothing could be read.
    /// `from` is where it is included.
    pub(crate) fn read(&mut self, path: &Path, from: Option<&Spot>, report: &mut Report) -> Option<Node> {
        // The same file by another name is the same file; what cannot be found is reported by reading it.
        let identity = path.canonicalize().unwrap_or_else(|_| path.into());
        if self.open.iter().any(|(open, _)| *open == identity) {
            self.report_cycle(&identity, path, from, report);
            return None;
        }
        if self.done.contains(&identity) {
            return None;
        }
        self.done.push(identity.clone());
        let Some(own) = self.alone(path, from, report) else {
            self.incomplete = true;
            return None;
        };
        self.open.push((identity, from.cloned()));
        let tree = self.read_includes(own, report);
        self.open.pop();
        Some(tree)
    }

    /// The tree of a file as it stands; `None` with the problems reported where it cannot be read. `from` is where it is included.
    fn alone(&mut self, path: &Path, from: Option<&Spot>, report: &mut Report) -> Option<Node> {
        let error = match self.bytes_of(path, from.is_some()) {
            Ok(bytes) => return parse(path, bytes, (self.done.len(), &self.trust), report),
            Err(error) => error,
        };
        let spot = from.cloned().unwrap_or_else(|| whole(path));
        match (error, files::fault(path, &[], &self.open_trust(from.is_some()))) {
            (Error::Refused(problem), _) => {
                let what = format!("`{}` is not read: {}", path.display(), problem.what);
                report.error(&spot, what, problem.remedy.unwrap_or_default());
            }
            (_, Some((what, remedy))) => report.error(&spot, what, remedy),
            (error, None) => {
                let cause = std::error::Error::source(&error).map_or(error.to_string(), ToString::to_string);
                report.error_without_remedy(&spot, format!("cannot read `{}`: {cause}", path.display()));
            }
        }
        None
    }

    /// All that a file holds, if that is not too much.
    fn bytes_of(&mut self, path: &Path, is_included: bool) -> crate::error::Result<Vec<u8>> {
        let trust = self.open_trust(is_included);
        let too_many = |excess: Excess| Error::Refused(excess.at(Place::file(path)));
        trust.limits.check(Limit::Files, self.done.len() as u64).map_err(too_many)?;
        let bytes = trust.read_counted(path, "cannot read", (Limit::SceneBytes, self.bytes))?;
        self.bytes += bytes.len() as u64;
        Ok(bytes)
    }

    /// How far a file is trusted: the one that the user named may lie anywhere.
    fn open_trust(&self, is_included: bool) -> Trust {
        let Trust { limits, sandbox } = &*self.trust;
        Trust { limits: *limits, sandbox: sandbox.clone().filter(|_| is_included) }
    }

    /// The tree of `own` on top of those it includes.
    fn read_includes(&mut self, own: Node, report: &mut Report) -> Node {
        let mut base = Node::empty_table(own.spot.clone());
        let items = own.get("include").and_then(Node::items).unwrap_or(&[]);
        for item in items {
            // What is wrong with the item itself is reported when the whole tree is decoded.
            let rules = Rules::default().file(&["toml"]);
            let Some(file) = Located::<PathBuf>::decode(item, "include", &rules, &mut Report::default())
            else {
                self.incomplete = true;
                continue;
            };
            let most = self.trust.limits.most(Limit::IncludeDepth).unwrap_or(DEEPEST).min(DEEPEST);
            if self.open.len() as u64 >= most {
                let what = format!("files include each other more than {most} deep");
                let allow = format!(", or allow more by `--limits include_depth={}`", most + 1);
                let allow = if most < DEEPEST { allow } else { String::new() };
                report.error(&item.spot, what, format!("include files directly{allow}"));
                self.incomplete = true;
                continue;
            }
            if let Some(included) = self.read(&file.value, Some(&item.spot), report) {
                merge(&mut base, included, report);
            }
        }
        merge(&mut base, own, report);
        base
    }

    fn report_cycle(&mut self, identity: &Path, path: &Path, from: Option<&Spot>, report: &mut Report) {
        self.incomplete = true;
        let Some(from) = from else { return };
        let start = self.open.iter().position(|(open, _)| open == identity).unwrap_or(0);
        let steps = self.open[start + 1..].iter().filter_map(|(_, spot)| spot.as_ref());
        let steps: Vec<String> = steps.chain([from]).map(|spot| spot.place().to_string()).collect();
        let what = format!("`{}` includes itself, by {}", path.display(), words::join(&steps, "and"));
        report.error(from, what, "remove one of these includes");
    }
}

/// The tree of a file that includes no others; `None` with the problems reported where it cannot be read.
pub(crate) fn read_alone(path: &Path, limits: Limits, report: &mut Report) -> Option<Node> {
    Reader::new(Arc::new(Trust { limits, sandbox: None })).alone(path, None, report)
}

/// A spot that names a file as a whole.
fn whole(path: &Path) -> Spot {
    Spot { source: Source::unread(path).into(), offset: 0 }
}

fn parse(
    path: &Path,
    bytes: Vec<u8>,
    (order, trust): (usize, &Arc<Trust>),
    report: &mut Report,
) -> Option<Node> {
    let text = match String::from_utf8(bytes) {
        Ok(text) => text,
        Err(error) => {
            let offset = error.utf8_error().valid_up_to();
            let text = String::from_utf8_lossy(error.as_bytes()).into_owned();
            let spot = Spot { source: Source::file(path, text, order, trust).into(), offset };
            report.error(&spot, "the file is not UTF-8 from here on", "save it as UTF-8");
            return None;
        }
    };
    let text = text.strip_prefix('\u{feff}').map(String::from).unwrap_or(text);
    Node::parse(&Arc::new(Source::file(path, text, order, trust)), report)
}

/// Puts `over` on top of `base`, both being tables of a whole file.
fn merge(base: &mut Node, over: Node, report: &mut Report) {
    let Content::Table(over) = over.content else { return };
    let Content::Table(entries) = &mut base.content else { return };
    let known = places(entries);
    for entry in over {
        let Some(&at) = known.get(&entry.key) else {
            entries.push(entry);
            continue;
        };
        let under = &mut entries[at];
        match (&mut under.node.content, entry.node.content) {
            (Content::Array(under), Content::Array(over)) => under.extend(over),
            (Content::Table(under), Content::Table(over)) if entry.key == "materials" => {
                add_names(under, over, report);
            }
            (Content::Table(under), Content::Table(over)) => replace_keys(under, over),
            (_, content) => under.node = Node { content, ..entry.node },
        }
    }
}

/// Where keys stand. What is put on top of them has each key once.
fn places(entries: &[Entry]) -> HashMap<String, usize> {
    entries.iter().enumerate().map(|(at, entry)| (entry.key.clone(), at)).collect()
}

fn replace_keys(under: &mut Vec<Entry>, over: Vec<Entry>) {
    let known = places(under);
    for entry in over {
        match known.get(&entry.key) {
            Some(&at) => under[at] = entry,
            None => under.push(entry),
        }
    }
}

fn add_names(under: &mut Vec<Entry>, over: Vec<Entry>, report: &mut Report) {
    let known = places(under);
    for entry in over {
        match known.get(&entry.key) {
            Some(&at) => {
                let first = under[at].spot.place();
                let what = format!("material `{}` is defined already at {first}", entry.key);
                report.error(&entry.spot, what, "give one of them another name");
            }
            None => under.push(entry),
        }
    }
}
