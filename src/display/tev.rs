//! Messages to the viewer tev.
//!
//! Each is its length in bytes, these four included, a byte that says of which kind it is, and what belongs to it. Numbers have their least
//! byte first, texts end with a zero byte. Pixels are 32-bit floats; where those of a channel begin and how far they are apart is said in
//! floats. By the description that comes with the viewer (Müller, tev, `src/python/ipc.py`).

use crate::image::Window;

/// A new black picture.
const CREATE_IMAGE: u8 = 4;

/// Pixels of a rectangle, of any number of channels (the third version of this message).
const UPDATE_IMAGE: u8 = 6;

/// What is shown: red, green, blue and coverage.
const CHANNELS: [&str; 4] = ["R", "G", "B", "A"];

/// That a picture of that width and height begins, which the viewer is to show. One of the same name is replaced.
pub(super) fn create(name: &str, [width, height]: [u32; 2]) -> Vec<u8> {
    let mut message = Message::new(CREATE_IMAGE, true, name);
    message.number(width);
    message.number(height);
    message.channels();
    message.end()
}

/// The pixels of a rectangle, by row.
pub(super) fn update(name: &str, window: Window, pixels: &[[f32; 4]]) -> Vec<u8> {
    let mut message = Message::new(UPDATE_IMAGE, false, name);
    message.channels();
    [window.x0, window.y0, window.width(), window.height()].into_iter().for_each(|x| message.number(x));
    // All channels of a pixel stand side by side.
    let (first, step): ([i64; 4], [i64; 4]) = ([0, 1, 2, 3], [4; 4]);
    first.into_iter().chain(step).for_each(|x| message.0.extend(x.to_le_bytes()));
    message.0.reserve(4 * CHANNELS.len() * pixels.len());
    pixels.iter().flatten().for_each(|x| message.0.extend(x.to_le_bytes()));
    message.end()
}

struct Message(Vec<u8>);

impl Message {
    fn new(kind: u8, takes_focus: bool, name: &str) -> Self {
        let mut message = Self(vec![0, 0, 0, 0, kind, u8::from(takes_focus)]);
        message.text(name);
        message
    }

    fn text(&mut self, text: &str) {
        self.0.extend(text.bytes().filter(|&byte| byte != 0));
        self.0.push(0);
    }

    /// Sizes and places of pictures fit into 31 bits.
    fn number(&mut self, number: u32) {
        self.0.extend(number.to_le_bytes());
    }

    fn channels(&mut self) {
        self.number(4);
        CHANNELS.into_iter().for_each(|name| self.text(name));
    }

    fn end(mut self) -> Vec<u8> {
        let length = u32::try_from(self.0.len()).unwrap_or(u32::MAX);
        self.0[..4].copy_from_slice(&length.to_le_bytes());
        self.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn messages_are_spelled_as_the_viewer_reads_them() {
        let wanted = b"\x21\0\0\0\x04\x01a.toml\0\x80\x02\0\0\xe0\x01\0\0\x04\0\0\0R\0G\0B\0A\0";
        assert_eq!(create("a.toml", [640, 480]), wanted, "create");
        let window = Window { x0: 16, y0: 3, x1: 17, y1: 4 };
        let mut wanted =
            b"\x74\0\0\0\x06\x00a\0\x04\0\0\0R\0G\0B\0A\0\x10\0\0\0\x03\0\0\0\x01\0\0\0\x01\0\0\0".to_vec();
        wanted.extend([0, 1, 2, 3, 4, 4, 4, 4].into_iter().flat_map(i64::to_le_bytes));
        wanted.extend([0.5, 1.0, 2.0, 0.25].into_iter().flat_map(f32::to_le_bytes));
        assert_eq!(wanted.len(), 0x74, "as long as it says");
        assert_eq!(update("a", window, &[[0.5, 1.0, 2.0, 0.25]]), wanted, "update");
    }
}
