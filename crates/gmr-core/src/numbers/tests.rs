use super::*;
use crate::Isa;
use proptest::prelude::*;

fn read_on(isa: Isa, text: &[u8], columns: usize, rows: usize) -> (Vec<u64>, RowsRead) {
    let job = ParseRows { text, start: 0, columns };
    let mut out = vec![0.0; columns * rows];
    let read = job.run_on(isa, &mut out).unwrap();
    out.truncate(columns * read.rows);
    (out.into_iter().map(f64::to_bits).collect(), read)
}

fn fault(text: &str, columns: usize) -> Fault {
    let (_, read) = read_on(Isa::best(), text.as_bytes(), columns, 9);
    read.fault.unwrap_or_else(|| panic!("{text:?} has no fault"))
}

fn print(values: &[f64], columns: usize) -> String {
    let mut out = Vec::new();
    FormatRows { values, columns }.run(&mut out).unwrap();
    String::from_utf8(out).unwrap()
}

/// A blank tail and room for eight let a token be taken by the readers that look at so much at once, and a short tail
/// by those that look at 16 bytes.
fn read_one(token: &str) -> Option<u64> {
    let texts = [format!("{token:<120}"), format!("{token}{:17}", "")];
    let read = |isa| texts.iter().map(move |text| read_on(isa, text.as_bytes(), 1, 8).0);
    let values: Vec<_> = Isa::available().flat_map(read).collect();
    assert!(values.windows(2).all(|pair| pair[0] == pair[1]), "instruction sets differ on {token:?}");
    values[0].first().copied()
}

fn short_decimal() -> impl Strategy<Value = f64> {
    (-1_000_000_000_000_i64..1_000_000_000_000, 0..12_i32).prop_map(|(number, places)| {
        let text = format!("{number}e-{places}");
        text.parse().unwrap()
    })
}

fn any_finite() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits).prop_filter("finite", |value| value.is_finite()),
        short_decimal(),
        (-200.0..200.0_f64),
        (-200.0..200.0_f32).prop_map(f64::from),
        any::<i64>().prop_map(|number| number as f64),
    ]
}

/// Decimals that lie in the middle of two doubles, or a last digit beside.
fn halfway() -> impl Strategy<Value = String> {
    (1_u64 << 52..1 << 53, 0..4_u32, -1..2_i64).prop_map(|(mantissa, places, off)| {
        // (m + 1/2) / 2^places, in units of 10^-(places + 1).
        let tenfold = u128::from(2 * mantissa + 1) * 5_u128.pow(places + 1);
        let digits = (tenfold as i128 + i128::from(off)).to_string();
        let (whole, fraction) = digits.split_at(digits.len() - places as usize - 1);
        format!("{whole}.{fraction}")
    })
}

fn decimal_text() -> impl Strategy<Value = String> {
    prop_oneof![
        "-?[0-9]{1,4}\\.[0-9]{0,6}",
        "-?[0-9]{0,20}\\.[0-9]{1,22}",
        "-?0\\.0{0,9}[1-9][0-9]{14,18}(e-[0-9])?",
        halfway(),
        "[+-]?[0-9]{1,25}(\\.[0-9]{0,25})?([eE][+-]?[0-9]{1,3})?",
    ]
}

/// Tokens, mostly short decimals, with what stands behind each: mostly a space, and a line's end after so many.
fn rows_of_tokens(columns: usize) -> impl Strategy<Value = String> {
    let token = prop_oneof![
        60 => "-?[0-9]{1,3}\\.[0-9]{1,6}",
        20 => "-?[0-9]{0,8}\\.?[0-9]{1,7}",
        2 => "-?[0-9]{1,2}\\.[0-9]{1,4}e-?[0-9]{1,2}",
        2 => "-?[0-9]\\.[0-9]{11,18}",
        1 => "[-.0-9]{1,18}",
        1 => "[-+.eE]{1,2}[0-9]{0,3}[-+.eE]{0,2}",
    ];
    let blank =
        prop_oneof![80 => Just(" "), 8 => Just("\t"), 4 => Just("  "), 1 => Just("\x0b"), 1 => Just("\n")];
    let line_end = prop_oneof![40 => Just("\n"), 40 => Just(" \r\n"), 4 => Just("\n \n"), 1 => Just(" ")];
    proptest::collection::vec((token, blank, line_end), 1..80).prop_map(move |tokens| {
        let behind =
            |k: usize, blank, line_end| if (k + 1).is_multiple_of(columns) { line_end } else { blank };
        let tokens = tokens.into_iter().enumerate();
        tokens.map(|(k, (token, blank, line_end))| token + behind(k, blank, line_end)).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: if cfg!(miri) { 24 } else { 4000 }, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_printed_reads_back_bit_identical(value in any_finite()) {
        let text = print(&[value], 1);
        prop_assert_eq!(read_one(text.trim_end()), Some(value.to_bits()), "{}", text);
    }

    #[test]
    fn what_is_printed_is_as_short_as_the_standard_library_can_say_it(value in any_finite()) {
        let text = print(&[value], 1);
        // Of two equally short decimals equally far away either will do.
        prop_assert_eq!(extent(text.trim_end()), extent(&format!("{value:e}")));
    }

    #[test]
    fn ordinary_magnitudes_are_printed_without_an_exponent(value in 1e-7..1e21_f64, power in -7..20_i32) {
        for value in [value, 10_f64.powi(power), -10_f64.powi(power)] {
            prop_assert!(!print(&[value], 1).contains('e'), "{}", value);
        }
    }

    #[test]
    fn every_decimal_is_read_as_the_standard_library_reads_it(text in decimal_text()) {
        let value: f64 = text.parse().unwrap();
        prop_assert_eq!(read_one(&text), value.is_finite().then_some(value.to_bits()), "{}", text);
    }

    #[test]
    fn all_instruction_sets_see_the_same_in_any_soup(text in "[-0-9. \n]{0,80}|[-+0-9.eE ,n\r\n\t\\x00\\x01\\x0b]{0,60}", columns in 1..6_usize) {
        let scalar = read_on(Isa::Scalar, text.as_bytes(), columns, 40);
        for isa in Isa::available() {
            prop_assert_eq!(&read_on(isa, text.as_bytes(), columns, 40), &scalar);
        }
    }

    #[test]
    fn all_instruction_sets_see_the_same_in_rows_of_tokens(
        (columns, text) in (1..30_usize).prop_flat_map(|columns| (Just(columns), rows_of_tokens(columns))),
    ) {
        let scalar = read_on(Isa::Scalar, text.as_bytes(), columns, 40);
        for isa in Isa::available() {
            prop_assert_eq!(&read_on(isa, text.as_bytes(), columns, 40), &scalar, "{:?}", text);
        }
    }

    #[test]
    fn no_bytes_at_all_make_it_panic_or_read_more_rows_than_there_is_room_for(text in proptest::collection::vec(any::<u8>(), 0..200), columns in 1..4_usize) {
        let most = ParseRows { text: &text, start: 0, columns }.most_rows();
        let (_, read) = read_on(Isa::best(), &text, columns, most + 3);
        prop_assert!(read.rows <= most);
        if let Some(fault) = read.fault {
            prop_assert!(fault.token.end <= text.len() && fault.line(&text) >= 1);
        }
    }

    #[test]
    fn rows_read_back_as_they_were(values in proptest::collection::vec(any_finite(), 1..60), columns in 1..7_usize) {
        let rows = values.len() / columns;
        let values = &values[..rows * columns];
        let (read, end) = read_on(Isa::best(), print(values, columns).as_bytes(), columns, rows + 2);
        prop_assert_eq!((end.rows, end.fault), (rows, None));
        prop_assert!(read.iter().eq(values.iter().map(|value| value.to_bits()).collect::<Vec<_>>().iter()));
    }

    #[test]
    fn a_text_that_is_cut_is_cut_and_nothing_else(values in proptest::collection::vec(any_finite(), 6), cut in 0.0..1.0_f64) {
        let text = print(&values, 3);
        let text = &text.as_bytes()[..(cut * text.len() as f64) as usize];
        let (_, read) = read_on(Isa::best(), text, 3, 2);
        prop_assert!(read.fault.is_none_or(|fault| fault.flaw == Flaw::Cut));
    }
}

/// Whether there is a minus, how many digits there are between the zeros at both ends, and the first one's power of ten.
fn extent(text: &str) -> (bool, usize, i32) {
    let (number, exponent) = text.split_once('e').unwrap_or((text, "0"));
    let number = number.trim_start_matches('-');
    let (whole, fraction) = number.split_once('.').unwrap_or((number, ""));
    let all = format!("{whole}{fraction}");
    let digits = all.trim_start_matches('0');
    let leading = (all.len() - digits.len()) as i32;
    let power =
        if digits.is_empty() { 0 } else { exponent.parse::<i32>().unwrap() + whole.len() as i32 - leading };
    (text.starts_with('-'), digits.trim_end_matches('0').len(), power)
}

#[test]
fn every_length_and_every_place_of_the_point_is_read_alike() {
    for length in 1..20 {
        for point in 0..=length {
            let digits = &"1234567890987654321"[..length];
            let token = format!("{}.{}", &digits[..point], &digits[point..]);
            for token in [digits, &token, &format!("-{token}")] {
                assert_eq!(read_one(token), Some(token.parse::<f64>().unwrap().to_bits()), "{token}");
            }
        }
    }
}

#[test]
fn a_decimal_in_the_middle_of_two_doubles_goes_to_the_even_one() {
    for (token, value) in [
        ("9007199254740993", 9_007_199_254_740_992.0),
        ("9007199254740995.0", 9_007_199_254_740_996.0),
        ("4503599627370496.5", 4_503_599_627_370_496.0),
        ("-4503599627370497.5", -4_503_599_627_370_498.0),
        ("1125899906842624.125", 1_125_899_906_842_624.0),
        ("4503599627370496.51", 4_503_599_627_370_497.0),
        ("0.0000000000000000000000000", 0.0),
    ] {
        assert_eq!(read_one(token), Some(f64::to_bits(value)), "{token}");
    }
}

#[test]
fn blank_lines_tabs_and_all_line_ends_are_no_values() {
    let text = b"\r\n\t 1.5\t-2  \r\n\r\n \t\n3 4.25 \r5. .5\n\n \0\0\x1a\n\0";
    let (values, read) = read_on(Isa::best(), text, 2, 9);
    assert_eq!(values, [1.5, -2.0, 3.0, 4.25, 5.0, 0.5].map(f64::to_bits));
    assert_eq!(read.fault, None);
}

#[test]
fn reading_ends_with_the_rows_that_were_asked_for() {
    let text = b"1 2\n3 4\n5 6\nrest";
    let (_, read) = read_on(Isa::best(), text, 2, 2);
    assert_eq!((read.rows, read.end, read.fault), (2, 7, None));
    assert_eq!(count_rows(text, 7), 2);
    assert_eq!(count_rows(b"1 2\n \r\n\0\n\x1a", 3), 0);
}

#[test]
fn what_is_no_finite_decimal_is_refused_where_it_stands() {
    for token in [
        "nan",
        "inf",
        "-inf",
        "NaN",
        "1,5",
        "1.#IND",
        "-1.#QNAN",
        "0x10",
        "1e",
        "--1",
        "1.2.3",
        "-",
        ".",
        "1-2",
        "e5",
        "\x01",
        "1\u{fffd}",
    ] {
        let text = format!("1 2\n3 {token} \n{}", "5 6\n".repeat(40));
        let found = fault(&text, 2);
        assert_eq!((found.flaw, found.row, found.field), (Flaw::NotANumber, 1, 1), "{token}");
        assert_eq!(&text[found.token.clone()], token);
        assert_eq!(found.line(text.as_bytes()), 2);
    }
    assert_eq!(fault("1e999\n", 1).flaw, Flaw::Overflow);
}

#[test]
fn a_row_of_the_wrong_length_is_refused() {
    let short = fault("1 2 3\r\n4 5\r\n6 7 8\r\n", 3);
    assert_eq!((short.flaw, short.row, short.field), (Flaw::RowTooShort, 1, 2));
    let text = "1 2 3\r4 5 6 7 8\r";
    let long = fault(text, 3);
    assert_eq!((long.flaw, long.row, long.line(text.as_bytes())), (Flaw::RowTooLong, 1, 2));
    assert_eq!(&text[long.token], "7 8");
}

#[test]
fn zeros_keep_their_sign_and_whole_numbers_have_no_point() {
    assert_eq!(
        print(&[0.0, -0.0, 1.0, -18.0446, 1e-7, 1e21, 100.0, 1e20], 4),
        "0 -0 1 -18.0446\n0.0000001 1e+21 100 100000000000000000000\n"
    );
}

#[test]
fn what_has_no_decimal_is_named() {
    let job = FormatRows { values: &[1.0, 2.0, 3.0, f64::NAN], columns: 2 };
    assert_eq!(job.run(&mut Vec::new()), Err(NotFinite { row: 1, field: 1 }));
}

#[test]
fn output_that_holds_no_whole_rows_is_refused() {
    let job = ParseRows { text: b"1 2 3", start: 0, columns: 2 };
    assert!(job.run(&mut [0.0; 3]).is_err());
}
