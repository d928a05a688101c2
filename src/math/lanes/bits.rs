//! Lanes one by one, for what has to be done so.

/// Numbers of the lanes that are set in a mask's bits, lowest first.
#[derive(Clone, Copy, Debug)]
pub struct Bits(pub u32);

impl Iterator for Bits {
    type Item = usize;

    #[inline(always)]
    fn next(&mut self) -> Option<usize> {
        if self.0 == 0 {
            return None;
        }
        let lane = self.0.trailing_zeros() as usize;
        self.0 &= self.0 - 1;
        Some(lane)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_set_bit_is_named_once_in_order() {
        assert_eq!(Bits(0b1000_0101).collect::<Vec<_>>(), [0, 2, 7], "some");
        assert_eq!(Bits(0).count(), 0, "none");
        assert_eq!(Bits(u32::MAX).count(), 32, "all");
    }
}
