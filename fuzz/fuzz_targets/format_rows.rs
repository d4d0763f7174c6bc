//! Any values as text: what is printed reads back bit-identical, and in no more digits than `{:e}` needs.
#![no_main]

use gmr_core::Isa;
use gmr_core::numbers::{FormatRows, ParseRows};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: (u8, Vec<(i64, u8)>)| {
    let columns = usize::from(input.0) % 5 + 1;
    let mut values: Vec<f64> = input.1.iter().map(|&(number, places)| value(number, places)).collect();
    values.truncate(values.len() / columns * columns);

    let mut text = Vec::new();
    let job = FormatRows { values: &values, columns };
    if let Err(bad) = job.run(&mut text) {
        assert!(!values[bad.row * columns + bad.field].is_finite());
        return;
    }
    for isa in Isa::available() {
        let mut again = vec![0.0; values.len()];
        let read = ParseRows { text: &text, start: 0, columns }.run_on(isa, &mut again).expect("whole rows");
        assert_eq!((read.rows, read.fault), (values.len() / columns, None));
        assert!(again.iter().map(|v| v.to_bits()).eq(values.iter().map(|v| v.to_bits())));
    }
    let tokens = text.split(|&byte| byte <= b' ').filter(|token| !token.is_empty());
    for (token, value) in tokens.zip(&values) {
        assert_eq!(digits(token), digits(format!("{value:e}").as_bytes()), "{value:e}");
    }
});

/// Short decimals and raw bits alike.
fn value(number: i64, places: u8) -> f64 {
    match places {
        0..=15 => number as f64 / 10_f64.powi(i32::from(places)),
        16..=31 => (number >> 24) as f64 / 10_f64.powi(i32::from(places) - 16),
        _ => f64::from_bits(number as u64),
    }
}

/// How many digits there are between the zeros at both ends.
fn digits(token: &[u8]) -> usize {
    let mantissa = token.split(|byte| matches!(byte, b'e' | b'E')).next().unwrap_or_default();
    let all: Vec<u8> = mantissa.iter().copied().filter(u8::is_ascii_digit).collect();
    let text = String::from_utf8(all).expect("digits");
    text.trim_matches('0').len()
}
