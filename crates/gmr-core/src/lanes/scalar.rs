//! One frame at a time: plain numbers.

use super::{Doubles, Kernel, Lanes, Real};
use crate::Isa;

/// What both widths have in common.
macro_rules! plain_number {
    ($real:ident) => {
        #[inline(always)]
        fn splat(value: $real) -> $real {
            value
        }

        #[inline(always)]
        fn sqrt(self) -> $real {
            <$real>::sqrt(self)
        }

        #[inline(always)]
        fn abs(self) -> $real {
            <$real>::abs(self)
        }

        #[inline(always)]
        fn load(source: &[$real]) -> $real {
            source[0]
        }

        #[inline(always)]
        fn store(self, target: &mut [$real]) {
            target[0] = self;
        }

        #[inline(always)]
        fn stream(source: &[$real], target: &mut [$real]) {
            target.copy_from_slice(source);
        }

        #[inline(always)]
        fn load_columns(source: &[$real], _stride: usize) -> [$real; 4] {
            [source[0], source[1], source[2], source[3]]
        }

        #[inline(always)]
        fn store_columns(columns: [$real; 4], target: &mut [$real], _stride: usize) {
            target[..4].copy_from_slice(&columns);
        }

        #[inline(always)]
        fn load_doubles(source: &[f64], _stride: usize) -> [f64; 4] {
            [source[0], source[1], source[2], source[3]]
        }
    };
}

impl Lanes for f32 {
    type Real = f32;
    type Doubles = f64;
    const WIDTH: usize = 1;
    plain_number!(f32);

    #[inline(always)]
    fn narrow(double: f64) -> f32 {
        double as f32
    }
}

impl Lanes for f64 {
    type Real = f64;
    type Doubles = f64;
    const WIDTH: usize = 1;
    plain_number!(f64);

    #[inline(always)]
    fn narrow(double: f64) -> f64 {
        double
    }
}

impl Doubles for f64 {
    #[inline(always)]
    fn splat(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn all_at_most(self, limit: f64) -> bool {
        self <= limit
    }

    #[inline(always)]
    fn changed(self, change: fn(&mut [f64])) -> f64 {
        let mut lane = [self];
        change(&mut lane);
        lane[0]
    }
}

/// The instruction set asked for, where there is one on this machine; `run` is each one's entry for this width.
macro_rules! dispatch {
    ($real:ident, $run:ident) => {
        fn dispatch(isa: Isa, kernel: impl Kernel<$real>) {
            match isa {
                isa if !isa.is_available() => kernel.run_plain(),
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the machine has AVX-512 F, DQ, BW and VL, as just checked.
                Isa::Avx512 => unsafe { super::avx512::$run(kernel) },
                #[cfg(target_arch = "x86_64")]
                // SAFETY: the machine has AVX2, as just checked.
                Isa::Avx2 => unsafe { super::avx2::$run(kernel) },
                #[cfg(target_arch = "x86_64")]
                Isa::Sse2 => super::sse2::$run(kernel),
                #[cfg(target_arch = "aarch64")]
                Isa::Neon => super::neon::$run(kernel),
                _ => kernel.run_plain(),
            }
        }
    };
}

// The coefficients are minimax fits by Remez' exchange on [0, (pi/2)^2]: at most 4e-9 off in f32, 1e-16 in f64.
impl Real for f32 {
    const ZERO: f32 = 0.0;
    const ONE: f32 = 1.0;
    const SINE: &'static [f32] = &[1.0, -0.166_666_5, 0.008_332_912, -0.000_198_015_17, 2.591_527_7e-6];
    const COSINE: &'static [f32] =
        &[1.0, -0.5, 0.041_666_637, -0.001_388_836_1, 2.476_014_5e-5, -2.605_120_2e-7];

    #[inline(always)]
    fn from_f64(value: f64) -> f32 {
        value as f32
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self.into()
    }

    dispatch!(f32, run_f32);
}

impl Real for f64 {
    const ZERO: f64 = 0.0;
    const ONE: f64 = 1.0;
    const SINE: &'static [f64] = &[
        0.999_999_999_999_999_2,
        -0.166_666_666_666_649_73,
        0.008_333_333_333_233_26,
        -0.000_198_412_698_151_556,
        2.755_731_563_735_175e-6,
        -2.505_183_000_692_697_3e-8,
        1.604_675_710_578_628_2e-10,
        -7.359_068_985_474_472e-13,
    ];
    const COSINE: &'static [f64] = &[
        1.0,
        -0.499_999_999_999_999_7,
        0.041_666_666_666_663_88,
        -0.001_388_888_888_877_303_4,
        2.480_158_727_741_994e-5,
        -2.755_731_639_128_61e-7,
        2.087_656_184_410_564e-9,
        -1.146_290_179_893_599_4e-11,
        4.608_973_865_604_706e-14,
    ];

    #[inline(always)]
    fn from_f64(value: f64) -> f64 {
        value
    }

    #[inline(always)]
    fn to_f64(self) -> f64 {
        self
    }

    dispatch!(f64, run_f64);
}
