//! A register type from the intrinsics of its instruction set.
//!
//! What differs between instruction sets is named, operation by operation; what is the same everywhere is here. The
//! functions that are named take and give raw registers:
//!
//! - `read(start)` and `write(start, register)`: consecutive numbers, one to a lane;
//! - `stream(start, register)`: `write` past the caches, where the instruction set can, to an aligned place;
//! - `load(start, stride)` and `store(columns, start, stride)`: [`Lanes::load_columns`](super::Lanes::load_columns)
//!   and its inverse, of rows that are known to lie inside the array;
//! - `scatter(columns, start, rows)`: the same to rows of four numbers, named for each lane;
//! - `narrow(first, second)`: the `f64` of the first half of the lanes and of the second, as `f32`;
//! - `all_at_most(lanes, limit)`: whether no lane is greater than the same lane of `limit`, or NaN.

/// `Name = raw register of WIDTH numbers`, then the intrinsics and functions that carry out each operation.
macro_rules! register {
    (
        $(#[$doc:meta])* $name:ident = $raw:ident of $width:literal f32, two of $doubles:ident beside it;
        add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, sqrt $sqrt:ident, abs $abs:ident,
        splat $splat:ident, read $read:ident, write $write:ident, stream $stream:ident,
        load $load:ident, store $store:ident, scatter $scatter:ident, narrow $narrow:ident,
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        struct $name($raw);

        register!(@operators $name, $add, $sub, $mul, $div);

        impl $crate::lanes::Lanes for $name {
            type Real = f32;
            type Doubles = $crate::lanes::pair::Pair<$doubles>;
            const WIDTH: usize = $width;

            register!(@lanes $name, f32, $width, $sqrt, $abs, $splat, $read, $write, $stream, $load, $store);

            #[inline(always)]
            fn scatter_columns([x, y, z, w]: [Self; 4], target: &mut [[f32; 4]], rows: &[u16]) {
                let rows = &rows[..$width];
                let highest = rows.iter().fold(0, |highest, &row| if row > highest { row } else { highest });
                assert!(usize::from(highest) < target.len(), "rows outside the array");
                // SAFETY: registers exist only where `dispatch` has found the instruction set; so many rows are
                // named, all of them inside `target`, as just checked.
                unsafe { $scatter([x.0, y.0, z.0, w.0], target.as_mut_ptr().cast(), rows.as_ptr()) }
            }

            #[inline(always)]
            fn load_doubles(source: &[f64], stride: usize) -> [Self::Doubles; 4] {
                $crate::lanes::pair::Pair::load_columns(source, stride)
            }

            #[inline(always)]
            fn narrow(doubles: Self::Doubles) -> Self {
                // SAFETY: registers exist only where `dispatch` has found the instruction set.
                Self(unsafe { $narrow(doubles.0.0, doubles.1.0) })
            }
        }
    };
    (
        $(#[$doc:meta])* $name:ident = $raw:ident of $width:literal f64;
        add $add:ident, sub $sub:ident, mul $mul:ident, div $div:ident, sqrt $sqrt:ident, abs $abs:ident,
        splat $splat:ident, read $read:ident, write $write:ident, stream $stream:ident,
        load $load:ident, store $store:ident, all_at_most $all_at_most:ident,
    ) => {
        $(#[$doc])*
        #[derive(Clone, Copy)]
        struct $name($raw);

        register!(@operators $name, $add, $sub, $mul, $div);

        impl $crate::lanes::Lanes for $name {
            type Real = f64;
            type Doubles = Self;
            const WIDTH: usize = $width;

            register!(@lanes $name, f64, $width, $sqrt, $abs, $splat, $read, $write, $stream, $load, $store);

            #[inline(always)]
            fn load_doubles(source: &[f64], stride: usize) -> [Self; 4] {
                Self::load_columns(source, stride)
            }

            #[inline(always)]
            fn narrow(doubles: Self) -> Self {
                doubles
            }
        }

        impl $crate::lanes::Doubles for $name {
            #[inline(always)]
            fn splat(value: f64) -> Self {
                <Self as $crate::lanes::Lanes>::splat(value)
            }

            #[inline(always)]
            fn all_at_most(self, limit: f64) -> bool {
                // SAFETY: registers exist only where `dispatch` has found the instruction set.
                unsafe { $all_at_most(self.0, $splat(limit)) }
            }

            #[inline(always)]
            fn changed(self, change: fn(&mut [f64])) -> Self {
                // SAFETY: a register is its lanes, and any bits are a number.
                let mut lanes: [f64; $width] = unsafe { std::mem::transmute(self.0) };
                change(&mut lanes);
                // SAFETY: as above.
                Self(unsafe { std::mem::transmute::<[f64; $width], $raw>(lanes) })
            }
        }
    };
    (@lanes $name:ident, $real:ident, $width:literal, $sqrt:ident, $abs:ident, $splat:ident, $read:ident, $write:ident, $stream:ident, $load:ident, $store:ident) => {
        #[inline(always)]
        fn splat(value: $real) -> Self {
            // SAFETY: registers exist only where `dispatch` has found the instruction set.
            Self(unsafe { $splat(value) })
        }

        #[inline(always)]
        fn sqrt(self) -> Self {
            // SAFETY: as for `splat`.
            Self(unsafe { $sqrt(self.0) })
        }

        #[inline(always)]
        fn abs(self) -> Self {
            // SAFETY: as for `splat`.
            Self(unsafe { $abs(self.0) })
        }

        #[inline(always)]
        fn load(source: &[$real]) -> Self {
            assert!($width <= source.len(), "lanes outside the array");
            // SAFETY: as for `splat`; so many numbers lie in `source`, as just checked.
            Self(unsafe { $read(source.as_ptr()) })
        }

        #[inline(always)]
        fn store(self, target: &mut [$real]) {
            assert!($width <= target.len(), "lanes outside the array");
            // SAFETY: as for `splat`; so many numbers lie in `target`, as just checked.
            unsafe { $write(target.as_mut_ptr(), self.0) }
        }

        #[inline(always)]
        fn stream(source: &[$real], target: &mut [$real]) {
            $crate::lanes::check_lines(source, target);
            if cfg!(miri) {
                return target.copy_from_slice(source);
            }
            const LINE: usize = $crate::lanes::cache::LINE / size_of::<$real>();
            for (from, to) in source.as_chunks::<LINE>().0.iter().zip(target.as_chunks_mut::<LINE>().0) {
                for at in (0..LINE).step_by($width) {
                    // SAFETY: as for `splat`; registers divide a line, and the target's begins where one begins.
                    unsafe { $stream(to.as_mut_ptr().add(at), $read(from.as_ptr().add(at))) }
                }
            }
        }

        #[inline(always)]
        fn load_columns(source: &[$real], stride: usize) -> [Self; 4] {
            $crate::lanes::check_rows($width, stride, source.len());
            // SAFETY: as for `splat`; the rows lie inside `source`, as just checked.
            let [x, y, z, w] = unsafe { $load(source.as_ptr(), stride) };
            [Self(x), Self(y), Self(z), Self(w)]
        }

        #[inline(always)]
        fn store_columns([x, y, z, w]: [Self; 4], target: &mut [$real], stride: usize) {
            $crate::lanes::check_rows($width, stride, target.len());
            // SAFETY: as for `splat`; the rows lie inside `target`, as just checked.
            unsafe { $store([x.0, y.0, z.0, w.0], target.as_mut_ptr(), stride) }
        }
    };
    (@operators $name:ident, $add:ident, $sub:ident, $mul:ident, $div:ident) => {
        register!(@operator $name, Add, add, $add);
        register!(@operator $name, Sub, sub, $sub);
        register!(@operator $name, Mul, mul, $mul);
        register!(@operator $name, Div, div, $div);
    };
    (@operator $name:ident, $operator:ident, $method:ident, $intrinsic:ident) => {
        impl std::ops::$operator for $name {
            type Output = Self;

            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // SAFETY: registers exist only where `dispatch` has found the instruction set.
                Self(unsafe { $intrinsic(self.0, other.0) })
            }
        }
    };
}
