//! Whole files, hostile ones too: the block after `Frame Time:` is read with the columns that the header's words
//! and the frames that its digits ask for, as the reader in Python would ask.
#![no_main]

use gmr_core::Isa;
use gmr_core::numbers::{ParseRows, count_rows};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &[u8]| {
    let lower = text.to_ascii_lowercase();
    let Some(motion) = find(&lower, b"motion") else { return };
    let columns = count(&lower[..motion], b"rotation") + count(&lower[..motion], b"position");
    let after = find(&lower[motion..], b"time:").map_or(motion, |at| motion + at + 5);
    let start = text[after..].iter().position(|byte| *byte == b'\n').map_or(after, |at| after + at);

    let job = ParseRows { text, start, columns };
    let rows = job.most_rows().min(declared(&lower[motion..]));
    assert!(rows.saturating_mul(columns) <= text.len() + columns, "more room than the text can fill");
    let mut out = vec![0.0; rows * columns];
    let read = job.run(&mut out).expect("whole rows");
    let mut scalar = vec![0.0; rows * columns];
    assert_eq!(job.run_on(Isa::Scalar, &mut scalar).expect("whole rows"), read);
    let whole = read.rows * columns;
    assert!(out[..whole].iter().map(|v| v.to_bits()).eq(scalar[..whole].iter().map(|v| v.to_bits())));
    assert!(read.end <= text.len());
    let _ = count_rows(text, read.end);
});

/// The number after `frames:`, the largest there is where it has too many digits.
fn declared(text: &[u8]) -> usize {
    let Some(at) = find(text, b"frames:") else { return 0 };
    let digits: String = text[at + 7..]
        .iter()
        .skip_while(|byte| byte.is_ascii_whitespace())
        .take_while(|byte| byte.is_ascii_digit())
        .map(|&byte| char::from(byte))
        .collect();
    if digits.is_empty() { 0 } else { digits.parse().unwrap_or(usize::MAX) }
}

fn find(text: &[u8], word: &[u8]) -> Option<usize> {
    text.windows(word.len()).position(|window| window == word)
}

fn count(text: &[u8], word: &[u8]) -> usize {
    text.windows(word.len()).filter(|window| *window == word).count()
}
