//! A connection to a viewer.

use crate::display::queue::Queue;
use std::io::{self, ErrorKind, Write as _};
use std::net::{TcpStream, ToSocketAddrs as _};
use std::sync::Arc;
use std::time::Duration;

/// How long a viewer may take to answer.
const ANSWER: Duration = Duration::from_secs(2);

/// How often a thread that cannot send looks whether that still matters.
const LOOK: Duration = Duration::from_millis(200);

/// A connection over which messages go, whole or not at all as far as the viewer reads them.
#[derive(Debug)]
pub(super) struct Link {
    stream: TcpStream,
    queue: Arc<Queue>,
}

impl Link {
    /// To a place `HOST:PORT`.
    pub(super) fn open(place: &str, queue: &Arc<Queue>) -> io::Result<Self> {
        let mut last = io::Error::new(ErrorKind::NotFound, "there is no such host");
        for address in place.to_socket_addrs()? {
            match TcpStream::connect_timeout(&address, ANSWER) {
                Ok(stream) => {
                    stream.set_write_timeout(Some(LOOK))?;
                    // Tiles are small, and the viewer is to have them now.
                    stream.set_nodelay(true)?;
                    return Ok(Self { stream, queue: queue.clone() });
                }
                Err(error) => last = error,
            }
        }
        Err(last)
    }

    /// Whether the viewer has closed it.
    pub(super) fn is_closed(&self) -> bool {
        let peek = || {
            self.stream.set_nonblocking(true)?;
            let found = self.stream.peek(&mut [0]);
            self.stream.set_nonblocking(false)?;
            found
        };
        // Viewers say nothing: there is something to read only where there is an end.
        peek().map_or_else(|error| error.kind() != ErrorKind::WouldBlock, |bytes| bytes == 0)
    }

    /// Sends a message, however long the viewer takes, as long as anybody waits for it.
    pub(super) fn send(&mut self, message: &[u8]) -> io::Result<()> {
        let mut left = message;
        while !left.is_empty() {
            match self.stream.write(left) {
                Ok(0) => return Err(ErrorKind::WriteZero.into()),
                Ok(written) => {
                    left = &left[written..];
                    self.queue.sent();
                }
                Err(error)
                    if matches!(
                        error.kind(),
                        ErrorKind::WouldBlock | ErrorKind::TimedOut | ErrorKind::Interrupted
                    ) =>
                {
                    if self.queue.is_abandoned() {
                        return Err(error);
                    }
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }
}
