//! Types of numbers.

/// A type of number in a PLY file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    I64,
    U64,
    F32,
    F64,
}

impl Scalar {
    /// The type of a name of either generation. Those of 64 bits are in no specification, but in files.
    pub(super) fn named(name: &str) -> Option<Self> {
        Some(match name {
            "char" | "int8" => Self::I8,
            "uchar" | "uint8" => Self::U8,
            "short" | "int16" => Self::I16,
            "ushort" | "uint16" => Self::U16,
            "int" | "int32" => Self::I32,
            "uint" | "uint32" => Self::U32,
            "long" | "int64" => Self::I64,
            "ulong" | "uint64" => Self::U64,
            "float" | "float32" => Self::F32,
            "double" | "float64" => Self::F64,
            _ => return None,
        })
    }

    /// Bytes in binary files.
    pub(super) const fn size(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::I64 | Self::U64 | Self::F64 => 8,
        }
    }

    /// The number at the start of `bytes`, with its greatest byte first or last; `None` if it does not fit in. Whole
    /// numbers beyond 2^53 are rounded: nothing has so many entries.
    #[inline]
    #[expect(clippy::cast_precision_loss, reason = "told above")]
    pub(super) fn read<const BIG: bool>(self, bytes: &[u8]) -> Option<f64> {
        macro_rules! number {
            ($type:ty) => {{
                let bytes = *bytes.first_chunk()?;
                if BIG { <$type>::from_be_bytes(bytes) } else { <$type>::from_le_bytes(bytes) }
            }};
        }
        Some(match self {
            Self::I8 => number!(i8).into(),
            Self::U8 => number!(u8).into(),
            Self::I16 => number!(i16).into(),
            Self::U16 => number!(u16).into(),
            Self::I32 => number!(i32).into(),
            Self::U32 => number!(u32).into(),
            Self::I64 => number!(i64) as f64,
            Self::U64 => number!(u64) as f64,
            Self::F32 => number!(f32).into(),
            Self::F64 => number!(f64),
        })
    }
}
