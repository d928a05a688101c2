//! What the program says of itself: schema, completions, manual pages.

use std::io;
use std::path::Path;

use clap::CommandFactory as _;
use clap_complete::Shell;
use clap_mangen::Man;

use super::args::{Args, SchemaOf};
use super::output;
use crate::error::{Error, Problem, Result};
use crate::image::atomic;
use crate::scene;

/// Prints the JSON Schema of a kind of file.
pub(super) fn schema(of: SchemaOf) -> Result<()> {
    let schema = match of {
        SchemaOf::Scene => scene::schema(),
        SchemaOf::Batch => scene::schema_of_batch(),
    };
    output::print(format!("{schema:#}\n").as_bytes())
}

/// Prints a completion script.
pub(super) fn completions(shell: Shell) -> Result<()> {
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Args::command(), "specula", &mut script);
    output::print(&script)
}

/// Prints the page of the program, or writes all pages to a directory and prints their names.
pub(super) fn man(dir: Option<&Path>) -> Result<()> {
    let mut command = Args::command();
    command.build();
    let Some(dir) = dir else {
        return output::print(&page(command)?);
    };
    if !dir.is_dir() {
        let problem = Problem::new(format!("there is no directory `{}`", dir.display()));
        return Err(problem.remedy("create it first").into());
    }
    let mut names = String::new();
    for command in pages(command) {
        let path = dir.join(Man::new(command.clone()).get_filename());
        let text = page(command)?;
        atomic::write(&path, |file| io::Write::write_all(file, &text))?;
        names += &format!("{}\n", path.display());
    }
    output::print(names.as_bytes())
}

/// The command and its subcommands, and theirs, which have got their full names by being built.
fn pages(command: clap::Command) -> Vec<clap::Command> {
    let subcommands = command.get_subcommands().filter(|sub| sub.get_name() != "help").cloned();
    let subcommands: Vec<_> = subcommands.flat_map(pages).collect();
    std::iter::once(command).chain(subcommands).collect()
}

/// The text of a page.
fn page(command: clap::Command) -> Result<Vec<u8>> {
    let mut text = Vec::new();
    Man::new(command).manual("Specula").render(&mut text).map_err(|source| Error::Io {
        path: "manual page".into(),
        what: "cannot write",
        source,
    })?;
    Ok(text)
}
