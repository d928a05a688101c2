//! Byte tables that reverse the bits of 32-bit words by byte shuffles.

/// The bytes of four words, each in reverse order.
pub(super) const BYTES_REVERSED: [u8; 16] = [3, 2, 1, 0, 7, 6, 5, 4, 11, 10, 9, 8, 15, 14, 13, 12];

/// The upper half of a byte reversed: what becomes its lower half.
pub(super) const HIGH_REVERSED: [u8; 16] = [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15];

/// The lower half of a byte reversed: what becomes its upper half.
pub(super) const LOW_REVERSED: [u8; 16] = shifted(HIGH_REVERSED);

const fn shifted(mut table: [u8; 16]) -> [u8; 16] {
    let mut i = 0;
    while i < 16 {
        table[i] <<= 4;
        i += 1;
    }
    table
}

/// The first eight bytes, for the intrinsics that take halves.
pub(super) const fn low_half(bytes: [u8; 16]) -> i64 {
    (u128::from_le_bytes(bytes) & 0xFFFF_FFFF_FFFF_FFFF) as i64
}

/// The last eight bytes, for the intrinsics that take halves.
pub(super) const fn high_half(bytes: [u8; 16]) -> i64 {
    (u128::from_le_bytes(bytes) >> 64) as i64
}
