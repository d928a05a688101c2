//! The log on standard error: plain lines for people, or JSON.

use std::fmt;
use std::io;

use tracing::{Event, Level, Subscriber};
use tracing_subscriber::fmt::format::{FormatEvent, FormatFields, Writer};
use tracing_subscriber::fmt::{FmtContext, FormattedFields, fmt};
use tracing_subscriber::registry::LookupSpan;

use super::args::{LogArgs, LogFormat, LogLevel};
use crate::error::Problem;

/// Starts the log as asked for.
pub(super) fn start(args: &LogArgs) {
    let default = if args.quiet { Level::WARN } else { Level::INFO };
    let level = args.log_level.map_or(default, |level| match level {
        LogLevel::Error => Level::ERROR,
        LogLevel::Warn => Level::WARN,
        LogLevel::Info => Level::INFO,
        LogLevel::Debug => Level::DEBUG,
        LogLevel::Trace => Level::TRACE,
    });
    start_with(args.log_format, level);
}

/// Starts a log for people, for commands that have no flags for it.
pub(super) fn start_if_not_yet() {
    start_with(LogFormat::Text, Level::WARN);
}

/// Logs warnings, one a line.
pub(super) fn warn(warnings: &[Problem]) {
    warnings.iter().for_each(|warning| tracing::warn!("{warning}"));
}

/// Does nothing if there is a log already.
fn start_with(format: LogFormat, level: Level) {
    let builder = fmt().with_max_level(level).with_writer(io::stderr).with_ansi(false);
    let started = match format {
        LogFormat::Text => builder.event_format(Plain).try_init(),
        LogFormat::Json => builder.json().with_target(false).try_init(),
    };
    // The only failure is that it was started before.
    drop(started);
}

/// `warning: what; remedy`, without times and origins; ordinary lines without a word before them.
struct Plain;

impl<S, N> FormatEvent<S, N> for Plain
where
    S: Subscriber + for<'a> LookupSpan<'a>,
    N: for<'a> FormatFields<'a> + 'static,
{
    fn format_event(
        &self,
        context: &FmtContext<'_, S, N>,
        mut writer: Writer<'_>,
        event: &Event<'_>,
    ) -> fmt::Result {
        writer.write_str(match *event.metadata().level() {
            Level::ERROR => "error: ",
            Level::WARN => "warning: ",
            Level::INFO => "",
            Level::DEBUG => "debug: ",
            Level::TRACE => "trace: ",
        })?;
        // Which of several pictures it is about.
        if let Some(scope) = context.event_scope() {
            for span in scope.from_root() {
                if let Some(fields) = span.extensions().get::<FormattedFields<N>>() {
                    write!(writer, "{fields}: ")?;
                }
            }
        }
        context.field_format().format_fields(writer.by_ref(), event)?;
        writeln!(writer)
    }
}
