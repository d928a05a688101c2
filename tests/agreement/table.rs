//! What was found, printed, and with `SPECULA_RECORD` kept.

#![expect(clippy::print_stdout, reason = "tells what was found")]

use crate::shots::Verdict;
use std::fmt::Write as _;
use std::path::Path;
use std::sync::Mutex;

/// Whether tables are to be kept.
pub(crate) fn is_recording() -> bool {
    std::env::var_os("SPECULA_RECORD").is_some()
}

/// So many samples, and sixteen times as many for the record.
pub(crate) fn samples(spp: u32) -> u32 {
    if is_recording() { spp * 16 } else { spp }
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
