//! One frame at a time: plain numbers.

use super::{Lanes, Real};

macro_rules! plain_number {
    ($real:ty) => {
        impl Lanes for $real {
            type Real = $real;
            const WIDTH: usize = 1;

            #[inline(always)]
            fn splat(value: $real) -> $real {
                value
            }

            #[inline(always)]
            fn sqrt(self) -> $real {
                <$real>::sqrt(self)
            }
        }

        impl Real for $real {
            const ZERO: $real = 0.0;
            const ONE: $real = 1.0;

            #[inline(always)]
            fn from_f64(value: f64) -> $real {
                value as $real
            }

            #[inline(always)]
            fn to_f64(self) -> f64 {
                self.into()
            }
        }
    };
}

plain_number!(f32);
plain_number!(f64);
