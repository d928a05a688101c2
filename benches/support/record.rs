//! Tables beside the benches, with the machine they belong to.

#![expect(clippy::print_stdout, reason = "says where the record is")]

use specula::bench::machine::Machine;
use specula::math::lanes::VARIABLE;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Where the record `file` is.
pub(crate) fn place(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/record").join(file)
}

/// Writes `benches/record/<name>.csv`, with the instruction set in its name where the environment asks for one: a line on machine
/// and build, then the table.
pub(crate) fn record(name: &str, passes: usize, table: &str) -> std::io::Result<()> {
    let machine = Machine::here();
    let asked = std::env::var(VARIABLE).unwrap_or_default();
    let suffix = if asked.is_empty() { String::new() } else { format!("_{asked}") };
    let file = place(&format!("{name}{suffix}.csv"));
    let head = [
        format!("machine: {}", machine.name()),
        format!("lanes: {}", machine.isa),
        format!("rustc: {}", machine.build.rustc),
        format!("commit: {}", said("git", &["describe", "--always", "--dirty"])),
        format!("date: {}", said("date", &["-u", "+%F"])),
        format!("passes: {passes}"),
    ];
    std::fs::write(&file, format!("# {}\n{table}", head.join("; ")))?;
    println!("\nrecorded in {}", file.display());
    Ok(())
}

/// What a command prints, on one line; nothing if there is no such command.
fn said(program: &str, arguments: &[&str]) -> String {
    let output = Command::new(program).args(arguments).current_dir(env!("CARGO_MANIFEST_DIR")).output();
    output.map(|output| String::from_utf8_lossy(&output.stdout).trim().replace(',', " ")).unwrap_or_default()
}
