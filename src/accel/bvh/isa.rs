//! The instruction set that searches are compiled for: box and triangle tests are vectors of four floats, which AVX encodes in
//! fewer instructions than SSE2. Answers are the same to the last bit.

use crate::math::lanes::{Isa, Kernel, Level, Scalar};

/// AVX2 where the machine has it, else what the program was built for.
pub(super) fn level() -> Level {
    #[cfg(target_arch = "x86_64")]
    if let Some(isa) = crate::math::lanes::Avx2::detect() {
        return Level::Avx2(isa);
    }
    Level::Scalar(Scalar)
}

/// Something to be compiled for an instruction set.
pub(super) struct Compiled<F>(pub(super) F);

impl<S: Isa, T, F: FnOnce() -> T> Kernel<S> for Compiled<F> {
    type Output = T;

    #[inline(always)]
    fn run(self, _isa: S) -> T {
        (self.0)()
    }
}

/// Runs `work`, of which everything inlined is compiled for `level`.
#[inline(always)]
pub(super) fn run<T>(level: Level, work: impl FnOnce() -> T) -> T {
    match level {
        #[cfg(target_arch = "x86_64")]
        Level::Avx2(isa) => isa.run(Compiled(work)),
        _ => Scalar.run(Compiled(work)),
    }
}
