//! Pictures within a page: as text that a browser takes for a file.

use crate::image::tone::Development;
use crate::image::{Image, png};
use crate::measure::magma;
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

/// The address of a picture, developed; empty if it cannot be written.
pub(super) fn developed(picture: &Image, development: Development) -> String {
    let bytes: Vec<u8> = picture.pixels().iter().flat_map(|&colour| development.bytes(colour)).collect();
    address([picture.width(), picture.height()], &bytes)
}

/// The address of errors from 0 to 1 in the colours of magma.
pub(super) fn coloured(size: [u32; 2], errors: &[f32]) -> String {
    let bytes: Vec<u8> = errors.iter().flat_map(|&error| magma::colour(error)).collect();
    address(size, &bytes)
}

fn address(size: [u32; 2], bytes: &[u8]) -> String {
    let mut file = Vec::new();
    if png::encode(&mut file, size, bytes).is_err() {
        return String::new();
    }
    format!("data:image/png;base64,{}", BASE64_STANDARD.encode(file))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rgb;

    #[test]
    fn what_an_address_holds_is_the_picture() {
        let picture = Image::from_pixels(2, 1, vec![Rgb::BLACK, Rgb::gray(1e3)]).expect("two");
        let address = developed(&picture, Development::default());
        let text = address.strip_prefix("data:image/png;base64,").expect("an address");
        let bytes = BASE64_STANDARD.decode(text).expect("base 64");
        let read = ::image::load_from_memory(&bytes).expect("a picture").into_rgb8();
        assert_eq!(read.as_raw(), &[0, 0, 0, 255, 255, 255], "pixels");
        assert!(coloured([1, 1], &[0.5]).starts_with("data:image/png"), "colours");
    }
}
