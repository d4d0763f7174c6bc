//! The frames of an AMC file: a line with the frame's number, then a line a bone, its name and its values.
//!
//! A name is compared with the one that stood in this place of the first frame, and looked up only where that fails,
//! so that a file costs little more than its numbers. Lines that begin with `#`, and what follows a `#` among the
//! values, count for nothing. A bone that a frame leaves out keeps the values it had; before its first, zeros.

use super::fault::Flaw;
use super::format::{LONGEST, NotFinite, STAGE, write_value};
use super::parse::{is_padding, line_end, may_go_on, row_start, skip_blanks};
use super::scalar::{self, Token, is_line_end};
use crate::Isa;
use std::collections::HashMap;
use std::ops::Range;

/// A bone that frames may name.
#[derive(Debug, Clone, Copy)]
pub struct Bone<'a> {
    /// Its name, without blanks.
    pub name: &'a [u8],
    /// How many values it has.
    pub values: usize,
}

/// The frames of an AMC file.
#[derive(Debug, Clone, Copy)]
pub struct ParseFrames<'a> {
    /// The whole text, so that places in it mean something to whoever reads an error.
    pub text: &'a [u8],
    /// Where the first frame begins.
    pub start: usize,
    /// The bones, names all different; their values are the columns of a row, in this order.
    pub bones: &'a [Bone<'a>],
}

/// What was read of the frames.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct FramesRead {
    /// `(frames, columns)`, whole frames only.
    pub values: Vec<f64>,
    /// How many frames.
    pub frames: usize,
    /// Number of the first frame.
    pub first_number: u64,
    /// The bones as the first frame lists them.
    pub listed: Vec<usize>,
    /// Frames whose number is not the one after the number before, and the first of them.
    pub jumps: Places,
    /// Frames that leave bones out, and the first of them.
    pub missing: Places,
    /// The first bone that the first of them leaves out.
    pub missing_bone: usize,
    /// What ended the reading early.
    pub fault: Option<FrameFault>,
}

/// How often something was met, and where first.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Places {
    /// How often.
    pub count: usize,
    /// The frame of the first, from 0.
    pub frame: usize,
    /// The byte at which that frame's number stands.
    pub at: usize,
}

impl Places {
    fn add(&mut self, frame: usize, at: usize) {
        if self.count == 0 {
            (self.frame, self.at) = (frame, at);
        }
        self.count += 1;
    }
}

/// Why the reading ended early.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct FrameFault {
    /// What is wrong.
    pub flaw: FrameFlaw,
    /// Frame in which it is, from 0.
    pub frame: usize,
    /// The bone that it is about.
    pub bone: Option<usize>,
    /// Value of that bone at which it is, from 0.
    pub field: usize,
    /// The bytes that it is about; empty where something is missing.
    pub token: Range<usize>,
}

/// What is wrong with a line of a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrameFlaw {
    /// A value or the number of values; [`Flaw::Cut`] where the text ends inside a frame.
    Values(Flaw),
    /// No bone has this name.
    UnknownBone,
    /// The frame has this bone already.
    BoneTwice,
    /// The text does not begin with a frame's number.
    NoNumber,
    /// So many values are missing that the frames would take far more memory than their text.
    TooSparse,
}

impl FrameFlaw {
    /// A word for it, the same in every release.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Values(flaw) => flaw.name(),
            Self::UnknownBone => "unknown bone",
            Self::BoneTwice => "bone twice",
            Self::NoNumber => "no number",
            Self::TooSparse => "too sparse",
        }
    }
}

/// Values that a byte of text may bring about: 32 bytes of memory for one of text.
const MOST_VALUES_A_BYTE: usize = 4;

/// Values that any text may bring about.
const ALLOWANCE: usize = 1 << 16;

impl ParseFrames<'_> {
    /// Reads frames until the text ends or something is wrong.
    #[must_use]
    pub fn run(&self) -> FramesRead {
        self.run_on(Isa::current())
    }

    /// [`Self::run`] with a chosen instruction set, for tests.
    #[must_use]
    pub fn run_on(&self, isa: Isa) -> FramesRead {
        match isa {
            #[cfg(target_arch = "x86_64")]
            Isa::Avx2 | Isa::Avx512 if isa.is_available() => super::avx2::frames(self),
            #[cfg(target_arch = "aarch64")]
            Isa::Neon => super::neon::frames(self),
            _ => frames(self, |_, _| None),
        }
    }
}

/// The loop of every instruction set; `fast` is as in [`super::parse::rows`].
#[inline(always)]
pub(super) fn frames(
    job: &ParseFrames<'_>,
    fast: impl Fn(&[u8], usize) -> Option<(f64, usize)>,
) -> FramesRead {
    let mut reader = Reader::new(job);
    let mut at = next_line(job.text, job.start);
    while at < job.text.len() {
        at = match reader.frame(at, &fast) {
            Some(next) => next,
            None => break,
        };
    }
    reader.finish()
}

/// Where a bone's values go, and the last frame that had it.
#[derive(Clone, Copy)]
struct Place {
    first: usize,
    count: usize,
    /// One more than the frame.
    seen: usize,
}

/// Bytes that are compared at once.
const WORD: usize = 16;

/// A name and the blank after it, with which its lines begin.
struct Word {
    bone: usize,
    bytes: u128,
    mask: u128,
    /// What does not fit into the bytes.
    rest: Vec<u8>,
    length: usize,
}

impl Word {
    fn new(bone: usize, name: &[u8]) -> Self {
        let (mut bytes, mut mask) = ([0; WORD], [0; WORD]);
        let begins = [name, b" "].concat();
        let held = begins.len().min(WORD);
        bytes[..held].copy_from_slice(&begins[..held]);
        mask[..held].fill(0xff);
        let (bytes, mask) = (u128::from_le_bytes(bytes), u128::from_le_bytes(mask));
        Self { bone, bytes, mask, rest: begins[held..].to_vec(), length: name.len() }
    }
}

struct Reader<'a> {
    job: &'a ParseFrames<'a>,
    places: Vec<Place>,
    /// The bones as the first frame lists them.
    words: Vec<Word>,
    by_name: HashMap<&'a [u8], usize>,
    columns: usize,
    /// Bones that have values.
    valued: usize,
    read: FramesRead,
    number: u64,
    /// Bones with values that the frame before had.
    named_before: usize,
    named: usize,
    /// The byte at which the last frame's number stands.
    began: usize,
}

impl<'a> Reader<'a> {
    fn new(job: &'a ParseFrames<'a>) -> Self {
        let mut columns = 0;
        let mut places = Vec::with_capacity(job.bones.len());
        for bone in job.bones {
            places.push(Place { first: columns, count: bone.values, seen: 0 });
            columns += bone.values;
        }
        Self {
            job,
            by_name: job.bones.iter().enumerate().map(|(index, bone)| (bone.name, index)).collect(),
            columns,
            valued: places.iter().filter(|place| place.count > 0).count(),
            places,
            words: Vec::new(),
            read: FramesRead::default(),
            number: 0,
            named_before: 0,
            named: 0,
            began: job.start,
        }
    }

    /// Reads the frame whose number stands at `at`; the place of the next one's, or `None` where reading ends.
    #[inline(always)]
    fn frame(&mut self, at: usize, fast: &impl Fn(&[u8], usize) -> Option<(f64, usize)>) -> Option<usize> {
        let text = self.job.text;
        let Some((number, mut end)) = frame_number(text, at) else {
            return self.refuse(FrameFlaw::NoNumber, None, 0, at..token_end(text, at));
        };
        if !self.has_room(at) {
            return self.refuse(FrameFlaw::TooSparse, None, 0, at..end);
        }
        self.begin(number, at);
        let row = self.read.values.len() - self.columns;
        let mut step = 0;
        loop {
            let line = next_line(text, end);
            if line >= text.len() {
                return Some(line);
            }
            let (bone, after) = match self.expected(step, line) {
                Some(found) => found,
                None => match self.look_up(line) {
                    Ok(Some(found)) => found,
                    Ok(None) => return Some(line),
                    Err(token) => return self.stop(FrameFlaw::UnknownBone, None, 0, token),
                },
            };
            step += 1;
            let Place { first, count, seen } = self.places[bone];
            if seen == self.read.frames {
                return self.stop(FrameFlaw::BoneTwice, Some(bone), 0, line..after);
            }
            self.places[bone].seen = self.read.frames;
            self.named += usize::from(count > 0);
            end = skip_blanks(text, after);
            for (field, value) in self.read.values[row + first..row + first + count].iter_mut().enumerate() {
                let (number, next) = match fast(text, end) {
                    Some(read) => read,
                    None => match scalar::read(text, end) {
                        Token::Value(number, next) => (number, next),
                        other => {
                            let (flaw, token) = fault(text, other);
                            return self.stop(FrameFlaw::Values(flaw), Some(bone), field, token);
                        }
                    },
                };
                *value = number;
                end = skip_blanks(text, next);
            }
            if !is_over(text, end) {
                let rest = end..line_end(text, end);
                return self.stop(FrameFlaw::Values(Flaw::RowTooLong), Some(bone), count, rest);
            }
            if self.read.frames == 1 {
                self.read.listed.push(bone);
                self.words.push(Word::new(bone, self.job.bones[bone].name));
            }
        }
    }

    /// Whether another frame may be begun at `at`.
    #[inline]
    fn has_room(&self, at: usize) -> bool {
        let allowed = MOST_VALUES_A_BYTE * (at - self.job.start) + ALLOWANCE.max(2 * self.columns);
        self.read.values.len() + self.columns <= allowed
    }

    /// Makes room for a frame, which begins as the one before it.
    #[inline]
    fn begin(&mut self, number: u64, at: usize) {
        self.close();
        match self.read.frames {
            0 => self.read.first_number = number,
            frames if self.number.checked_add(1) != Some(number) => self.read.jumps.add(frames, at),
            _ => {}
        }
        if self.read.frames == 1 {
            self.reserve(at);
        }
        (self.number, self.began) = (number, at);
        (self.named_before, self.named) = (self.named, 0);
        let held = self.read.values.len();
        if self.read.frames > 0 {
            self.read.values.extend_from_within(held - self.columns..);
        } else {
            self.read.values.resize(self.columns, 0.0);
        }
        self.read.frames += 1;
    }

    /// Room for the frames to come, were they as long as the first.
    fn reserve(&mut self, at: usize) {
        let left = self.job.text.len() - at;
        let frames = left / (at - self.job.start).max(1) + 2;
        let most = MOST_VALUES_A_BYTE * left / self.columns.max(1);
        self.read.values.reserve_exact(frames.min(most) * self.columns);
    }

    /// Notes what the frame that ends here left out.
    #[inline]
    fn close(&mut self) {
        if self.read.frames > 0 && self.named < self.valued {
            self.note_missing();
        }
    }

    #[cold]
    fn note_missing(&mut self) {
        let frame = self.read.frames;
        let missing = |place: &Place| place.count > 0 && place.seen != frame;
        if self.read.missing.count == 0 {
            self.read.missing_bone = self.places.iter().position(missing).unwrap_or_default();
        }
        self.read.missing.add(frame - 1, self.began);
    }

    /// The bone that the first frame has in this place, where the line at `at` names it, and the byte after its name.
    #[inline(always)]
    fn expected(&self, step: usize, at: usize) -> Option<(usize, usize)> {
        let word = self.words.get(step)?;
        let window = self.job.text.get(at..at + WORD)?.first_chunk()?;
        let begins = u128::from_le_bytes(*window) & word.mask == word.bytes;
        let goes_on = || word.rest.is_empty() || self.job.text[at + WORD..].starts_with(&word.rest);
        (begins && goes_on()).then_some((word.bone, at + word.length))
    }

    /// The bone that the line at `at` names, `None` where it is the next frame's number, else its first token.
    #[cold]
    fn look_up(&self, at: usize) -> Result<Option<(usize, usize)>, Range<usize>> {
        let text = self.job.text;
        let token = at..token_end(text, at);
        if frame_number(text, at).is_some() {
            return Ok(None);
        }
        match self.by_name.get(&text[token.clone()]) {
            Some(&bone) => Ok(Some((bone, token.end))),
            None => Err(token),
        }
    }

    /// Leaves the frame that was begun out, and says why.
    #[cold]
    fn stop(
        &mut self,
        flaw: FrameFlaw,
        bone: Option<usize>,
        field: usize,
        token: Range<usize>,
    ) -> Option<usize> {
        let is_cut = flaw == FrameFlaw::UnknownBone && token.end == self.job.text.len();
        let flaw = if is_cut { FrameFlaw::Values(Flaw::Cut) } else { flaw };
        self.read.frames -= 1;
        self.read.values.truncate(self.read.frames * self.columns);
        self.refuse(flaw, bone, field, token)
    }

    /// Ends the reading and says why.
    #[cold]
    fn refuse(
        &mut self,
        flaw: FrameFlaw,
        bone: Option<usize>,
        field: usize,
        token: Range<usize>,
    ) -> Option<usize> {
        self.read.fault = Some(FrameFault { flaw, frame: self.read.frames, bone, field, token });
        None
    }

    /// What was read; a last frame that names fewer bones than the one before it was cut off.
    fn finish(mut self) -> FramesRead {
        if self.read.fault.is_none() && self.read.frames > 0 {
            let is_cut = match self.read.frames {
                1 => self.named == 0 && self.valued > 0,
                _ => self.named < self.named_before,
            };
            if is_cut {
                let end = self.job.text.len();
                self.stop(FrameFlaw::Values(Flaw::Cut), None, 0, end..end);
            } else {
                self.close();
            }
        }
        self.read.values.shrink_to_fit();
        self.read
    }
}

/// Whether nothing more stands on the line than a comment.
#[inline(always)]
fn is_over(text: &[u8], at: usize) -> bool {
    text.get(at).is_none_or(|&byte| is_line_end(byte) || byte == b'#') || is_padding(text, at)
}

/// The number of a frame and the byte after it, where the line at `at` holds nothing else.
#[inline]
fn frame_number(text: &[u8], at: usize) -> Option<(u64, usize)> {
    let digits = text[at..].iter().take_while(|byte| byte.is_ascii_digit()).count();
    if digits == 0 {
        return None;
    }
    let end = at + digits;
    let rest = skip_blanks(text, end);
    if !is_over(text, rest) {
        return None;
    }
    let number = text[at..end]
        .iter()
        .fold(0_u64, |number, digit| number.saturating_mul(10).saturating_add(u64::from(digit - b'0')));
    Some((number, rest))
}

/// The first token of the next line that holds one and is no comment; the end of the text where there is none.
#[inline(always)]
fn next_line(text: &[u8], at: usize) -> usize {
    let mut at = row_start(text, at);
    while text.get(at) == Some(&b'#') {
        at = row_start(text, line_end(text, at));
    }
    at
}

fn token_end(text: &[u8], at: usize) -> usize {
    text[at..].iter().position(|&byte| byte <= b' ').map_or(text.len(), |length| at + length.max(1))
}

#[cold]
fn fault(text: &[u8], token: Token) -> (Flaw, Range<usize>) {
    match token {
        Token::Value(_, end) => (Flaw::NotANumber, end..end),
        Token::Overflow(token) => (Flaw::Overflow, token),
        Token::Other(token)
            if token.is_empty() || text[token.start] == b'#' || is_padding(text, token.start) =>
        {
            let at_end = token.is_empty() && token.end == text.len();
            (if at_end { Flaw::Cut } else { Flaw::RowTooShort }, token.start..token.start)
        }
        Token::Other(token) if token.end == text.len() && may_go_on(&text[token.clone()]) => {
            (Flaw::Cut, token)
        }
        Token::Other(token) => (Flaw::NotANumber, token),
    }
}

/// Frames of values to AMC text.
#[derive(Debug, Clone, Copy)]
pub struct FormatFrames<'a> {
    /// The values, `(frames, columns)`.
    pub values: &'a [f64],
    /// The bones as a frame lists them; their values are the columns, in this order.
    pub bones: &'a [Bone<'a>],
    /// How many frames.
    pub frames: usize,
    /// The number of the first frame.
    pub first_number: u64,
}

impl FormatFrames<'_> {
    /// Appends the frames to `out`, each value as [`super::FormatRows`] writes it; bones without values are left out.
    ///
    /// # Errors
    /// When a value is not finite; then `out` holds what came before it in part.
    ///
    /// # Panics
    /// When there are fewer values than the frames need.
    pub fn run(&self, out: &mut Vec<u8>) -> Result<(), NotFinite> {
        let columns: usize = self.bones.iter().map(|bone| bone.values).sum();
        let mut stage = [0_u8; STAGE];
        for row in 0..self.frames {
            let number = self.first_number.saturating_add(row as u64);
            out.extend_from_slice(format!("{number}\n").as_bytes());
            let mut column = row * columns;
            for bone in self.bones.iter().filter(|bone| bone.values > 0) {
                out.extend_from_slice(bone.name);
                for values in self.values[column..column + bone.values].chunks(STAGE / LONGEST) {
                    let used = write_values(&mut stage, values)
                        .map_err(|field| NotFinite { row, field: column - row * columns + field })?;
                    out.extend_from_slice(&stage[..used]);
                    column += values.len();
                }
                out.push(b'\n');
            }
        }
        Ok(())
    }
}

/// The values, each after a blank; how many bytes they take, or the first that is not finite.
#[inline]
fn write_values(stage: &mut [u8; STAGE], values: &[f64]) -> Result<usize, usize> {
    let mut used = 0;
    for (field, &value) in values.iter().enumerate() {
        if !value.is_finite() {
            return Err(field);
        }
        stage[used] = b' ';
        used = write_value(stage, used + 1, value);
    }
    Ok(used)
}
