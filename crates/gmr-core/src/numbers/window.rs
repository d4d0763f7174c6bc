//! The decimals in 64 bytes of text, found all at once by arithmetic on words that have a bit for each byte.
//!
//! A reader that looks for the end of one number before it can begin the next waits at each of them; here all places
//! are known after a few dozen steps, and no number waits for another. The method is in the manner of G. Langdale and
//! D. Lemire, "Parsing gigabytes of JSON per second", VLDB Journal 28 (2019).

/// Bytes of a window.
pub(super) const SPAN: usize = 64;

/// What 64 bytes are: a bit for each, the lowest for the first, before which no token may begin.
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    /// Bytes up to `' '`.
    pub(super) ends: u64,
    /// Spaces and tabs.
    pub(super) blanks: u64,
    /// `0` to `9`.
    pub(super) digits: u64,
    /// `.`
    pub(super) points: u64,
    /// `-`
    pub(super) minuses: u64,
}

/// Where `[-]digits[.digits]`, with one digit at least and 15 bytes at most, lies in a window.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Decimal {
    /// The first byte.
    pub(super) start: usize,
    /// Bytes up to the point, or to the end where there is none.
    pub(super) point: usize,
    /// Bytes up to the end.
    pub(super) length: usize,
}

/// Decimals with nothing but blanks between them, the first of which is to be taken next.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decimals {
    starts: u64,
    ends: u64,
    /// Points and ends.
    marks: u64,
}

impl Window {
    /// The decimals that end in the window before anything that is neither decimal nor blank.
    #[inline(always)]
    pub(super) fn decimals(self) -> Decimals {
        let Self { ends, blanks, digits, points, minuses } = self;
        let inside = !ends;
        let starts = inside & !(inside << 1);
        // Added to the digits, what follows a point is carried over them to the byte behind.
        let behind_fraction = (points << 1).wrapping_add(digits) & !digits;
        let strange = !(ends + digits + points + minuses)
            | minuses & (!starts | ends >> 1)
            | points & !(digits << 1 | digits >> 1)
            | behind_fraction & inside
            | sixteenth(inside);
        let stops = strange | ends & !blanks;
        let up_to_stop = stops ^ stops.wrapping_sub(1);
        Decimals { starts, ends: ends & (inside << 1) & up_to_stop, marks: points + ends }
    }
}

/// The bits that end sixteen in a row.
#[inline(always)]
fn sixteenth(bits: u64) -> u64 {
    let second = bits & bits << 1;
    let fourth = second & second << 2;
    let eighth = fourth & fourth << 4;
    eighth & eighth << 8
}

impl Decimals {
    /// How many there are.
    #[inline(always)]
    pub(super) fn count(&self) -> usize {
        self.ends.count_ones() as usize
    }

    /// The next one, with any numbers where there is none.
    #[inline(always)]
    pub(super) fn take(&mut self) -> Decimal {
        let (start, end) = (self.starts.trailing_zeros(), self.ends.trailing_zeros());
        self.starts &= self.starts.wrapping_sub(1);
        self.ends &= self.ends.wrapping_sub(1);
        let point = self.marks.wrapping_shr(start).trailing_zeros();
        Decimal { start: start as usize, point: point as usize, length: end.wrapping_sub(start) as usize }
    }

    /// The byte after the last of those that have been taken of `all`, which must be one at least.
    #[inline(always)]
    pub(super) fn end_of_taken(&self, all: &Self) -> usize {
        SPAN - 1 - (self.ends ^ all.ends).leading_zeros() as usize
    }
}
