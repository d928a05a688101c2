//! What was found, printed, and with `SPECULA_RECORD` kept.

#![expect(clippy::print_stdout, reason = "tells what was found")]

use crate::shots::{Shot, Verdict};
use specula::image::{Window, exr};
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Mutex;

/// Whether tables are to be kept.
pub(crate) fn is_recording() -> bool {
    std::env::var_os("SPECULA_RECORD").is_some()
}

/// So many samples, and four times as many for the record.
pub(crate) fn samples(spp: u32) -> u32 {
    if is_recording() { spp * 4 } else { spp }
}

/// A table of pictures against references.
pub(crate) const HEAD: &str = "| scene | spp | mean, % | deviations | noise-corrected RMSE, % of the mean | pixels beyond | worst z | mean z^2 | remarks |\n|---|---|---|---|---|---|---|---|---|\n";

/// A row of it.
pub(crate) fn row(scene: &str, spp: u32, verdict: &Verdict, remarks: &str) -> String {
    let Verdict { count, beyond, worst, square, bias, bias_deviations, rmse } = verdict;
    format!(
        "| {scene} | {spp} | {:+.3} | {bias_deviations:.1} | {:.2} | {beyond} of {count} | {worst:.1} | {square:.2} | {remarks} |\n",
        bias * 100.0,
        rmse * 100.0
    )
}

/// Prints a table; where tables are kept, it takes the place of the one before between the marks of that name.
pub(crate) fn tell(name: &str, table: &str) {
    static FILE: Mutex<()> = Mutex::new(());
    println!("{name}\n{table}");
    if !is_recording() {
        return;
    }
    let _alone = FILE.lock().expect("nobody panics with it");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record/peers_agreement.md");
    let mut text = std::fs::read_to_string(&path).unwrap_or_default();
    let [start, end] = [format!("<!-- {name} -->\n"), format!("<!-- end of {name} -->\n")];
    match (text.find(&start), text.find(&end)) {
        (Some(from), Some(to)) => text.replace_range(from + start.len()..to, table),
        _ => {
            let _ = write!(text, "\n{start}{table}{end}");
        }
    }
    std::fs::write(&path, text).expect("written");
}

/// Both pictures and their difference, for eyes, where `SPECULA_DUMP` names a folder.
pub(crate) fn dump(name: &str, found: &Shot, truth: &Shot) {
    let Some(folder) = std::env::var_os("SPECULA_DUMP") else { return };
    let size = found.size.map(|n| u32::try_from(n).expect("small"));
    let channel = |name: String, of: &dyn Fn(usize) -> f64| {
        #[expect(clippy::cast_possible_truncation, reason = "to look at")]
        let samples = exr::Samples::Float((0..found.mean.len()).map(|i| of(i) as f32).collect());
        exr::Channel { name, samples }
    };
    let mut channels = Vec::new();
    for (c, letter) in ["R", "G", "B"].into_iter().enumerate() {
        channels.push(channel(format!("ours.{letter}"), &|i| found.mean[i][c]));
        channels.push(channel(format!("theirs.{letter}"), &|i| truth.mean[i][c]));
        channels.push(channel(format!("deviation.{letter}"), &|i| found.variance[i][c].sqrt()));
    }
    let (full, window) = (size, Window::whole(size[0], size[1]));
    let picture = exr::Picture { full, window, channels, attributes: Vec::new(), warnings: Vec::new() };
    exr::write(&Path::new(&folder).join(format!("{name}.exr")), picture).expect("written");
}
