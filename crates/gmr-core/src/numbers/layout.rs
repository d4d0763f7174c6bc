//! Tables that the fast number readers share: how to line up the digits of a token, and powers of ten.

/// Bytes that one register holds, and so one more than the longest token that the fast readers take.
pub(super) const WIDTH: usize = 16;

/// Shapes that a token can have: its length and where its point is, both below [`WIDTH`].
const SHAPES: usize = WIDTH * WIDTH;

/// Where a token of `length` bytes whose point is at `point` stands in the tables; `point == length` means that it has
/// none. Of other numbers it makes some place in the tables.
#[inline(always)]
pub(super) fn shape(length: usize, point: usize) -> usize {
    length.wrapping_mul(WIDTH).wrapping_add(point) % SHAPES
}

/// What to divide the digits of a token of each shape by, taken as a whole number.
pub(super) static DIVISORS: [f64; SHAPES] = divisors();

const fn divisors() -> [f64; SHAPES] {
    let mut table = [1.0; SHAPES];
    let mut length = 0;
    while length < WIDTH {
        let mut point = 0;
        while point < length {
            table[length * WIDTH + point] = EXACT_POWERS[length - point - 1];
            point += 1;
        }
        length += 1;
    }
    table
}

/// Powers of ten that an `f64` holds exactly.
pub(super) const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18,
    1e19, 1e20, 1e21, 1e22,
];

/// Which byte of a token of each shape goes where, so that its digits end at the last lane and its point is gone.
pub(super) static GATHER: [[u8; WIDTH]; SHAPES] = gather();

const fn gather() -> [[u8; WIDTH]; SHAPES] {
    // An index with its high bit set gives a zero byte on x86, one of 16 or more on AArch64.
    let mut table = [[0x80; WIDTH]; SHAPES];
    let mut length = 0;
    while length < WIDTH {
        let mut point = 0;
        while point < WIDTH {
            let mut lane = WIDTH;
            let mut byte = length;
            while byte > 0 {
                byte -= 1;
                if byte != point {
                    lane -= 1;
                    table[length * WIDTH + point][lane] = byte as u8;
                }
            }
            point += 1;
        }
        length += 1;
    }
    table
}

/// `5^k`, as long as it is a `u64`.
pub(super) const FIVES: [u64; 28] = {
    let mut powers = [1; 28];
    let mut k = 1;
    while k < powers.len() {
        powers[k] = 5 * powers[k - 1];
        k += 1;
    }
    powers
};
