//! Which instruction set the kernels use: chosen once, at run time.
//!
//! `GMR_ISA=scalar|sse2|avx2|avx512|neon` forces one (for tests and bug reports); one that the machine
//! cannot run, or that nobody knows, is refused with a panic-free message by [`Isa::from_environment`].

use std::fmt;
use std::sync::OnceLock;

/// An instruction set for which kernels have a twin.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Isa {
    /// Plain Rust: the definition of every kernel.
    Scalar,
    /// x86-64's base line, 4 lanes.
    Sse2,
    /// AVX2 with FMA and BMI, which no processor lacks that has it, 8 lanes.
    Avx2,
    /// AVX-512 F, DQ, BW and VL, 16 lanes.
    Avx512,
    /// AArch64's base line, 4 lanes.
    Neon,
}

impl Isa {
    /// Every instruction set there is code for, slowest first.
    pub const ALL: [Self; 5] = [Self::Scalar, Self::Sse2, Self::Avx2, Self::Avx512, Self::Neon];

    /// The name used by `GMR_ISA`.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            Self::Sse2 => "sse2",
            Self::Avx2 => "avx2",
            Self::Avx512 => "avx512",
            Self::Neon => "neon",
        }
    }

    /// Whether this machine can run it.
    #[must_use]
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Sse2 => true,
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => {
                is_x86_feature_detected!("avx2")
                    && is_x86_feature_detected!("fma")
                    && is_x86_feature_detected!("bmi1")
                    && is_x86_feature_detected!("bmi2")
                    && is_x86_feature_detected!("lzcnt")
                    && is_x86_feature_detected!("popcnt")
            }
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512bw")
                    && is_x86_feature_detected!("avx512vl")
                    && Self::Avx2.is_available()
            }
            #[cfg(target_arch = "aarch64")]
            Self::Neon => true,
            #[allow(unreachable_patterns)]
            _ => false,
        }
    }

    /// Those that this machine can run, slowest first.
    pub fn available() -> impl Iterator<Item = Self> {
        Self::ALL.into_iter().filter(|isa| isa.is_available())
    }

    /// The fastest that this machine can run.
    #[must_use]
    pub fn best() -> Self {
        Self::available().last().unwrap_or(Self::Scalar)
    }

    /// What `GMR_ISA` asks for, or the best where it is unset.
    ///
    /// # Errors
    /// When `GMR_ISA` names an instruction set that is unknown or that this machine lacks.
    pub fn from_environment() -> Result<Self, UnknownIsa> {
        match std::env::var("GMR_ISA") {
            Err(_) => Ok(Self::best()),
            Ok(name) if name.is_empty() => Ok(Self::best()),
            Ok(name) => Self::available().find(|isa| isa.name() == name).ok_or(UnknownIsa { asked: name }),
        }
    }

    /// The instruction set of this process: `GMR_ISA` where it can be honoured, else the best.
    #[must_use]
    pub fn current() -> Self {
        static CHOSEN: OnceLock<Isa> = OnceLock::new();
        *CHOSEN.get_or_init(|| Self::from_environment().unwrap_or_else(|_| Self::best()))
    }
}

impl fmt::Display for Isa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// `GMR_ISA` asks for what this machine does not have.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct UnknownIsa {
    /// What it asked for.
    pub asked: String,
}

impl fmt::Display for UnknownIsa {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let known: Vec<_> = Isa::available().map(Isa::name).collect();
        write!(f, "GMR_ISA={} cannot be used here; this machine runs {}", self.asked, known.join(", "))
    }
}

impl std::error::Error for UnknownIsa {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scalar_is_always_available_and_best_is_available() {
        assert!(Isa::Scalar.is_available());
        assert!(Isa::best().is_available());
    }
}
