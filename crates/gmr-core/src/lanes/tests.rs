//! Every instruction set of this machine moves and computes as plain numbers do.

use super::{Doubles, Kernel, Lanes, Real};
use crate::Isa;

/// What each of some rows of four numbers becomes in a register's lane, and its way back into memory.
struct Trip<'a, T> {
    source: &'a [T],
    doubles: &'a [f64],
    stride: usize,
    target: &'a mut [T],
    changed: &'a mut [T],
}

impl<T: Real> Kernel<T> for Trip<'_, T> {
    #[inline(always)]
    fn run<L: Lanes<Real = T>>(self) {
        for start in (0..32).step_by(L::WIDTH) {
            let at = start * self.stride;
            let [x, y, z, w] = L::load_columns(&self.source[at..], self.stride);
            L::store_columns([x, y, z, w], &mut self.target[at..], self.stride);
            let [a, b, c, d] = L::load_doubles(&self.doubles[at..], self.stride);
            let root = L::narrow(a * b + (c - d).changed(|v| v.iter_mut().for_each(|v| *v *= 3.0))).sqrt();
            let same = [x + y, x * y - z, w / y, root + L::splat(T::ONE)];
            L::store_columns(same, &mut self.changed[at..], self.stride);
        }
        for start in (0..32).step_by(L::WIDTH) {
            let run = L::load(&self.source[32 * self.stride - 32 + start..]);
            (run + run).store(&mut self.changed[self.source.len() + start..]);
        }
    }
}

fn trip<T: Real>(isa: Isa, stride: usize) -> (Vec<u64>, Vec<u64>, Vec<u64>) {
    let doubles: Vec<f64> =
        (0..32 * stride + 4).map(|k| 1.0 + (k as f64 * 0.618).fract() + k as f64).collect();
    let source: Vec<T> = doubles.iter().map(|&x| T::from_f64(x)).collect();
    let (mut target, mut changed) = (vec![T::ZERO; source.len()], vec![T::ZERO; source.len() + 32]);
    T::dispatch(
        isa,
        Trip { source: &source, doubles: &doubles, stride, target: &mut target, changed: &mut changed },
    );
    let bits = |v: Vec<T>| v.into_iter().map(|x| x.to_f64().to_bits()).collect();
    (bits(source), bits(target), bits(changed))
}

#[test]
fn every_instruction_set_loads_stores_and_computes_as_plain_numbers_do() {
    for stride in [4, 5, 11, 64] {
        let (plain_f32, plain_f64) = (trip::<f32>(Isa::Scalar, stride), trip::<f64>(Isa::Scalar, stride));
        for row in 0..32 {
            assert_eq!(plain_f32.0[row * stride..][..4], plain_f32.1[row * stride..][..4]);
        }
        for isa in Isa::available() {
            assert_eq!(trip::<f32>(isa, stride), plain_f32, "{isa}, stride {stride}");
            assert_eq!(trip::<f64>(isa, stride), plain_f64, "{isa}, stride {stride}");
        }
    }
}

/// What each number of a register is without its sign, and where rows go that are named.
struct Scattered<'a, T> {
    source: &'a [T],
    rows: &'a [u16],
    target: &'a mut [[T; 4]],
}

impl<T: Real> Kernel<T> for Scattered<'_, T> {
    #[inline(always)]
    fn run<L: Lanes<Real = T>>(self) {
        for start in (0..16).step_by(L::WIDTH) {
            let [x, y, z, w] = L::load_columns(&self.source[4 * start..], 4);
            L::scatter_columns([x, y.abs(), z, w], self.target, &self.rows[start..]);
        }
    }
}

fn scattered<T: Real>(isa: Isa, rows: &[u16]) -> Vec<[T; 4]> {
    let source: Vec<T> = (0..64).map(|k| T::from_f64(f64::from(k) - 31.5)).collect();
    let mut target = vec![[T::ZERO; 4]; 20];
    T::dispatch(isa, Scattered { source: &source, rows, target: &mut target });
    target
}

#[test]
fn rows_go_where_they_are_named_and_numbers_lose_their_sign() {
    let rows: [u16; 16] = [3, 1, 19, 0, 7, 6, 18, 9, 2, 4, 5, 17, 12, 11, 10, 8];
    for isa in Isa::available() {
        let (found, doubles) = (scattered::<f32>(isa, &rows), scattered::<f64>(isa, &rows));
        for (lane, &row) in rows.iter().enumerate() {
            let first = 4.0 * lane as f32 - 31.5;
            let expected = [first, (first + 1.0).abs(), first + 2.0, first + 3.0];
            assert_eq!(found[usize::from(row)], expected, "{isa}");
            assert_eq!(doubles[usize::from(row)], expected.map(f64::from), "{isa}");
        }
        assert_eq!(found[13..17], [[0.0; 4]; 4], "{isa}");
    }
}

#[test]
fn rows_that_are_not_there_are_never_written() {
    for isa in Isa::available() {
        for lane in 0..16 {
            let mut rows = [0; 16];
            rows[lane] = 20;
            assert!(std::panic::catch_unwind(|| scattered::<f32>(isa, &rows)).is_err(), "{isa}, lane {lane}");
        }
    }
}

struct Within<'a>(usize, f64, &'a mut bool);

impl Kernel<f32> for Within<'_> {
    #[inline(always)]
    fn run<L: Lanes<Real = f32>>(self) {
        let mut rows = [0.0; 4 * 16];
        rows[4 * (self.0 % L::WIDTH)] = self.1;
        let [lanes, ..] = L::load_doubles(&rows, 4);
        *self.2 = lanes.all_at_most(1.0);
    }
}

#[test]
fn a_large_number_is_seen_in_any_lane_and_so_is_nan() {
    for isa in Isa::available() {
        for lane in 0..16 {
            for (value, expected) in [(2.0, false), (f64::INFINITY, false), (1.0, true), (f64::NAN, false)] {
                let mut found = !expected;
                f32::dispatch(isa, Within(lane, value, &mut found));
                assert_eq!(found, expected, "{isa}, lane {lane}, {value}");
            }
        }
    }
}

#[test]
#[should_panic]
fn rows_outside_the_array_are_never_touched() {
    let mut found = [0.0_f32; 8];
    let source = [0.0_f32; 4];
    f32::dispatch(
        Isa::best(),
        Trip { source: &source, doubles: &[0.0; 200], stride: 4, target: &mut found, changed: &mut [] },
    );
}
