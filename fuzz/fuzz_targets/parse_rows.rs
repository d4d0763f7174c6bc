//! Any bytes as a block of numbers: every instruction set sees the same, and what is read is what
//! `str::parse` reads token by token.
#![no_main]

use gmr_core::Isa;
use gmr_core::numbers::{ParseRows, RowsRead, count_rows};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: (u8, &[u8])| {
    let (columns, text) = input;
    let job = ParseRows { text, start: 0, columns: usize::from(columns) % 7 + 1 };
    let rows = job.most_rows();
    assert!(rows * job.columns <= text.len() / 2 + 1 + job.columns, "more room than the text can fill");

    let (values, read) = run(&job, Isa::Scalar, rows);
    for isa in Isa::available() {
        let (fast, seen) = run(&job, isa, rows);
        assert_eq!(seen, read, "{isa}");
        assert!(fast.iter().map(|v| v.to_bits()).eq(values.iter().map(|v| v.to_bits())), "{isa}");
    }
    check_values(&job, &values, &read);
    if let Some(fault) = &read.fault {
        assert!(fault.token.end <= text.len() && fault.row == read.rows && fault.field <= job.columns);
        assert!(fault.line(text) <= text.len() + 1);
    }
    assert!(count_rows(text, read.end) <= text.len());
});

fn run(job: &ParseRows<'_>, isa: Isa, rows: usize) -> (Vec<f64>, RowsRead) {
    let mut out = vec![0.0; rows * job.columns];
    let read = job.run_on(isa, &mut out).expect("whole rows");
    out.truncate(read.rows * job.columns);
    (out, read)
}

/// The tokens up to the last whole row, parsed by the standard library.
fn check_values(job: &ParseRows<'_>, values: &[f64], read: &RowsRead) {
    let text = &job.text[..read.end];
    let tokens = text.split(|&byte| byte <= b' ').filter(|token| !token.is_empty());
    let expected: Vec<u64> = tokens
        .map(|token| {
            std::str::from_utf8(token).expect("a number").parse::<f64>().expect("a number").to_bits()
        })
        .collect();
    assert_eq!(values.iter().map(|v| v.to_bits()).collect::<Vec<_>>(), expected);
    assert!(values.iter().all(|value| value.is_finite()));
}
