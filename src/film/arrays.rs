//! Sums of a film as bytes: one array after the other, little-endian.
//!
//! ```text
//! u32  samples of each pixel, by row
//! f64  sums of weights
//! f64  sums of values, as many for each pixel as the layout has
//! f64  sums of weight times value, likewise
//! f64  seven sums of squares for each pixel, where variance is kept
//! where numbers of things are kept, for each pixel:
//!   u32  1 where something is seen, else 0
//!   u32  the nearest object, its material, and its distance as an f32
//!   u32  how many objects, then how many materials it has; then of all pixels, objects first:
//!   u32  their numbers
//!   f64  samples and sum of weights of each
//! ```

use super::aov::{Aov, Layout};
use super::shares::{Seen, Share, Shares};
use super::sums::Film;
use super::tile::Squares;
use crate::image::Window;
use std::io::{self, Read, Write};

/// A number of fixed size.
pub trait Number: Copy + Default {
    /// Its bytes.
    type Bytes: AsRef<[u8]> + AsMut<[u8]> + Default + Copy;

    /// Least byte first.
    fn to_bytes(self) -> Self::Bytes;

    /// The number of those bytes.
    fn of_bytes(bytes: Self::Bytes) -> Self;
}

macro_rules! number {
    ($Type:ty, $len:literal) => {
        impl Number for $Type {
            type Bytes = [u8; $len];

            fn to_bytes(self) -> [u8; $len] {
                self.to_le_bytes()
            }

            fn of_bytes(bytes: [u8; $len]) -> Self {
                Self::from_le_bytes(bytes)
            }
        }
    };
}

number!(u32, 4);
number!(f32, 4);
number!(f64, 8);

/// Numbers that go through memory at once.
const BLOCK: usize = 1 << 13;

/// Writes numbers, one after the other.
pub fn write_numbers<T: Number>(
    into: &mut dyn Write,
    numbers: impl IntoIterator<Item = T>,
) -> io::Result<()> {
    let mut bytes = Vec::with_capacity(BLOCK * size_of::<T>());
    for number in numbers {
        bytes.extend_from_slice(number.to_bytes().as_ref());
        if bytes.len() >= BLOCK * size_of::<T>() {
            into.write_all(&bytes)?;
            bytes.clear();
        }
    }
    into.write_all(&bytes)
}

/// The next `count` numbers.
pub fn read_numbers<T: Number>(from: &mut dyn Read, count: usize) -> io::Result<Vec<T>> {
    let size = size_of::<T>();
    let mut numbers = Vec::with_capacity(count);
    let mut bytes = vec![0; BLOCK.min(count) * size];
    while numbers.len() < count {
        let block = &mut bytes[..BLOCK.min(count - numbers.len()) * size];
        from.read_exact(block)?;
        numbers.extend(block.chunks_exact(size).map(|chunk| {
            let mut bytes = T::Bytes::default();
            bytes.as_mut().copy_from_slice(chunk);
            T::of_bytes(bytes)
        }));
    }
    Ok(numbers)
}

impl Film {
    /// How many objects and how many materials pixels have, all pixels together.
    pub fn shares(&self) -> [u64; 2] {
        let count = |of: fn(&Shares) -> usize| self.sums.shares.iter().map(|shares| of(shares) as u64).sum();
        [count(|shares| shares.objects.len()), count(|shares| shares.materials.len())]
    }

    /// Bytes of the sums of a film with those [`Film::shares`]; `None` of more than there can be.
    pub fn bytes(window: Window, layout: &Layout, shares: [u64; 2]) -> Option<u64> {
        let pixels = u64::from(window.width()) * u64::from(window.height());
        let values = layout.len() as u64;
        let squares = if layout.has(Aov::Variance) { 7 * 8 } else { 0 };
        let ids = if layout.has_ids() { 6 * 4 } else { 0 };
        let all = shares[0].checked_add(shares[1])?.checked_mul(4 + 2 * 8)?;
        pixels.checked_mul(4 + 8 + 2 * 8 * values + squares + ids)?.checked_add(all)
    }

    /// Writes the sums: [`Film::bytes`] bytes.
    pub fn write(&self, into: &mut dyn Write) -> io::Result<()> {
        let sums = &self.sums;
        write_numbers(into, sums.counts.iter().copied())?;
        write_numbers(into, sums.weights.iter().copied())?;
        write_numbers(into, sums.plain.iter().copied())?;
        write_numbers(into, sums.weighted.iter().copied())?;
        write_numbers(into, sums.squares.iter().flat_map(|squares| squares.to_array()))?;
        let seen = |shares: &Shares| match shares.nearest {
            Some(Seen { object, material, depth }) => [1, object, material, depth.to_bits()],
            None => [0; 4],
        };
        write_numbers(into, sums.shares.iter().flat_map(seen))?;
        #[expect(clippy::cast_possible_truncation, reason = "fewer things than 2^32")]
        let lengths = |shares: &Shares| [shares.objects.len() as u32, shares.materials.len() as u32];
        write_numbers(into, sums.shares.iter().flat_map(lengths))?;
        let all = || {
            let objects = sums.shares.iter().flat_map(|shares| &shares.objects);
            objects.chain(sums.shares.iter().flat_map(|shares| &shares.materials))
        };
        write_numbers(into, all().map(|share| share.id))?;
        write_numbers(into, all().flat_map(|share| [share.count, share.weight]))
    }

    /// Takes the sums that another film of this window and layout, and with those [`Film::shares`], has written.
    ///
    /// Fails where `from` ends early or contradicts itself. Memory is taken for what the window and `shares` say, so whoever asks has
    /// compared [`Film::bytes`] with what is there.
    pub fn read(&mut self, shares: [u64; 2], from: &mut dyn Read) -> io::Result<()> {
        let (pixels, values) = (self.window().area(), self.layout().len());
        let sums = &mut self.sums;
        sums.counts = read_numbers(from, pixels)?;
        sums.weights = read_numbers(from, pixels)?;
        sums.plain = read_numbers(from, pixels * values)?;
        sums.weighted = read_numbers(from, pixels * values)?;
        let squares: Vec<f64> = read_numbers(from, 7 * sums.squares.len())?;
        sums.squares = squares.as_chunks().0.iter().map(|&sums| Squares::of_array(sums)).collect();
        if sums.shares.is_empty() {
            return if shares == [0; 2] { Ok(()) } else { Err(contradiction()) };
        }
        let seen: Vec<u32> = read_numbers(from, 4 * pixels)?;
        let lengths: Vec<u32> = read_numbers(from, 2 * pixels)?;
        let (seen, lengths) = (seen.as_chunks::<4>().0, lengths.as_chunks::<2>().0);
        for (kind, told) in shares.into_iter().enumerate() {
            if lengths.iter().map(|lengths| u64::from(lengths[kind])).sum::<u64>() != told {
                return Err(contradiction());
            }
        }
        let count = usize::try_from(shares[0] + shares[1]).map_err(|_| contradiction())?;
        let ids: Vec<u32> = read_numbers(from, count)?;
        let numbers: Vec<f64> = read_numbers(from, 2 * count)?;
        let mut all = ids.into_iter().zip(numbers.as_chunks::<2>().0).map(|(id, &[count, weight])| Share {
            id,
            count,
            weight,
        });
        for ((shares, &lengths), &[is_seen, object, material, depth]) in
            sums.shares.iter_mut().zip(lengths).zip(seen)
        {
            // Pictures count things from 1.
            if is_seen != 0 && object.max(material) == u32::MAX {
                return Err(contradiction());
            }
            let seen = Seen { object, material, depth: f32::from_bits(depth) };
            shares.nearest = (is_seen != 0).then_some(seen);
            shares.objects = all.by_ref().take(lengths[0] as usize).collect();
        }
        for (shares, lengths) in sums.shares.iter_mut().zip(lengths) {
            shares.materials = all.by_ref().take(lengths[1] as usize).collect();
        }
        Ok(())
    }
}

fn contradiction() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, "numbers of things that do not add up")
}
