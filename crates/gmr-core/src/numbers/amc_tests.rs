use super::*;
use crate::Isa;
use proptest::prelude::*;

const BONES: [Bone<'_>; 4] = [
    Bone { name: b"root", values: 3 },
    Bone { name: b"back", values: 1 },
    Bone { name: b"stiff", values: 0 },
    Bone { name: b"a_name_of_twenty_byt", values: 2 },
];

fn read_on(isa: Isa, text: &[u8], start: usize) -> FramesRead {
    ParseFrames { text, start, bones: &BONES }.run_on(isa)
}

/// What every instruction set reads alike.
fn read(text: &str) -> FramesRead {
    let read: Vec<_> = Isa::available().map(|isa| read_on(isa, text.as_bytes(), 0)).collect();
    assert!(read.windows(2).all(|pair| pair[0] == pair[1]), "instruction sets differ on {text:?}");
    read[0].clone()
}

fn fault(text: &str) -> FrameFault {
    read(text).fault.unwrap_or_else(|| panic!("{text:?} has no fault"))
}

const FRAME: &str = "root 1 -2.5 3e-2\nback 4\na_name_of_twenty_byt 5.25 -6\n";

#[test]
fn values_go_to_the_columns_of_their_bones_whatever_the_order() {
    let found = read(&format!("# head\n7\n{FRAME}8\nback 40\na_name_of_twenty_byt 50 60\nroot 10 20 30\n"));
    assert_eq!(found.values, [1.0, -2.5, 0.03, 4.0, 5.25, -6.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0]);
    assert_eq!((found.frames, found.first_number, found.fault), (2, 7, None));
    assert_eq!(found.listed, [0, 1, 3]);
    assert_eq!((found.jumps.count, found.missing.count), (0, 0));
}

#[test]
fn long_names_are_told_apart_by_their_ends() {
    let names: [&[u8]; 3] = [b"a_name_of_sixteen", b"a_name_of_sixteen_and", b"a_name_of_sixtee"];
    let bones = names.map(|name| Bone { name, values: 1 });
    let read = |text: &str| ParseFrames { text: text.as_bytes(), start: 0, bones: &bones }.run();
    let frame = "a_name_of_sixteen 1\na_name_of_sixteen_and 2\na_name_of_sixtee 3\n";
    let turned = "a_name_of_sixtee 6\na_name_of_sixteen_and\t5\na_name_of_sixteen 4\n";
    let found = read(&format!("1\n{frame}2\n{turned}3\n{frame}"));
    assert_eq!((found.frames, found.fault), (3, None));
    assert_eq!(found.values, [1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 1.0, 2.0, 3.0]);
    let found = read(&format!("1\n{frame}2\na_name_of_sixteenth 4\n"));
    assert_eq!(found.fault.map(|fault| fault.flaw), Some(FrameFlaw::UnknownBone));
}

#[test]
fn blanks_comments_line_ends_and_padding_change_nothing() {
    let plain = read(&format!("1\n{FRAME}2\n{FRAME}"));
    for text in [
        format!("1\n{FRAME}2\n{FRAME}").replace('\n', "\r\n"),
        format!("1\n{FRAME}2\n{FRAME}").replace('\n', "\r"),
        format!("1\n{FRAME}2\n{FRAME}").replace('\n', " # note\n\n").replace(' ', "\t  "),
        format!("  1 \n{FRAME}# note 1 2\n2\n{FRAME}\0\0\0\x1a"),
        format!("1\n{FRAME}2\n{}", FRAME.trim_end()),
        format!("1\nstiff\n{FRAME}2\n{FRAME}stiff \n"),
    ] {
        let found = read(&text);
        assert_eq!((&found.values, found.fault), (&plain.values, None), "{text:?}");
    }
}

#[test]
fn a_bone_that_a_frame_leaves_out_keeps_its_values() {
    let found = read(&format!("1\nback 4\n2\n{FRAME}3\nback 9\nroot 7 8 9\n4\n{FRAME}"));
    assert_eq!(found.values[..6], [0.0, 0.0, 0.0, 4.0, 0.0, 0.0]);
    assert_eq!(found.values[12..18], [7.0, 8.0, 9.0, 9.0, 5.25, -6.0]);
    assert_eq!(found.missing, Places { count: 2, frame: 0, at: 0 });
    assert_eq!(found.missing_bone, 0);
}

#[test]
fn numbers_that_skip_or_repeat_are_counted() {
    let found = read(&format!("1\n{FRAME}2\n{FRAME}5\n{FRAME}5\n{FRAME}6\n{FRAME}"));
    assert_eq!((found.frames, found.jumps.count, found.jumps.frame), (5, 2, 2));
    let huge = "1".repeat(40);
    let found = read(&format!("{huge}\n{FRAME}{huge}\n{FRAME}"));
    assert_eq!((found.first_number, found.jumps.count), (u64::MAX, 1));
}

#[test]
fn what_is_wrong_is_told_with_its_place() {
    let cases = [
        ("1\nroot 1 2\n2\n", FrameFlaw::Values(Flaw::RowTooShort), Some(0), 2, ""),
        ("1\nroot 1 2 # 3\n2\n", FrameFlaw::Values(Flaw::RowTooShort), Some(0), 2, ""),
        ("1\nback 1 2 3\n", FrameFlaw::Values(Flaw::RowTooLong), Some(1), 1, "2 3"),
        ("1\nstiff 1\n2\n", FrameFlaw::Values(Flaw::RowTooLong), Some(2), 0, "1"),
        ("1\nback nan\n2\n", FrameFlaw::Values(Flaw::NotANumber), Some(1), 0, "nan"),
        ("1\nback 1,5\n2\n", FrameFlaw::Values(Flaw::NotANumber), Some(1), 0, "1,5"),
        ("1\nback 1e999\n2\n", FrameFlaw::Values(Flaw::Overflow), Some(1), 0, "1e999"),
        ("1\nroot 1 2 3\nhand 1\n", FrameFlaw::UnknownBone, None, 0, "hand"),
        ("1\nback 1\nback 1\n", FrameFlaw::BoneTwice, Some(1), 0, "back"),
        ("root 1 2 3\n", FrameFlaw::NoNumber, None, 0, "root"),
        ("1.5\nback 1\n", FrameFlaw::NoNumber, None, 0, "1.5"),
        ("1\nback 1\n2.5\n", FrameFlaw::UnknownBone, None, 0, "2.5"),
    ];
    for (text, flaw, bone, field, token) in cases {
        let found = fault(text);
        assert_eq!((found.flaw, found.bone, found.field), (flaw, bone, field), "{text:?}");
        assert_eq!(&text[found.token], token, "{text:?}");
    }
}

#[test]
fn a_text_that_ends_inside_a_frame_loses_that_frame_only() {
    let text = format!("1\n{FRAME}2\n{FRAME}");
    let whole = read(&text);
    for end in 0..text.len() {
        let found = read(&text[..end]);
        assert!(found.values.len() == 6 * found.frames && found.frames <= 2);
        if let Some(fault) = &found.fault {
            assert_eq!(fault.flaw, FrameFlaw::Values(Flaw::Cut), "{end}");
        }
        if found.frames == 2 {
            assert_eq!(found.values[..11], whole.values[..11]);
        }
    }
    assert_eq!(read(&format!("1\n{FRAME}2")).frames, 1);
    assert_eq!(fault("1\nback 1\n2\nba").flaw, FrameFlaw::Values(Flaw::Cut));
}

#[test]
fn frames_that_name_hardly_anything_end_before_they_fill_the_memory() {
    let bones = [Bone { name: b"a", values: 10_000 }, Bone { name: b"b", values: 1 }];
    let text = "1\nb 1\n".repeat(100_000);
    let found = ParseFrames { text: text.as_bytes(), start: 0, bones: &bones }.run();
    assert_eq!(found.fault.map(|fault| fault.flaw), Some(FrameFlaw::TooSparse));
    assert!(found.values.len() <= 4 * text.len() + 70_000);
    assert_eq!(read("").frames, 0);
}

fn any_values() -> impl Strategy<Value = Vec<f64>> {
    let short = (-99_999_999_i64..99_999_999, 0_i32..9).prop_map(|(n, p)| n as f64 / 10_f64.powi(p));
    let any = any::<f64>().prop_filter("finite", |value| value.is_finite());
    prop::collection::vec(prop_oneof![3 => short, 1 => any], 0..60).prop_map(|mut values| {
        values.truncate(values.len() / 6 * 6);
        values
    })
}

proptest! {
    #[test]
    fn what_is_written_reads_back_bit_identical(values in any_values(), first_number in 0_u64..1_000_000) {
        let frames = values.len() / 6;
        let mut text = Vec::new();
        FormatFrames { values: &values, bones: &BONES, frames, first_number }.run(&mut text).unwrap();
        for isa in Isa::available() {
            let found = read_on(isa, &text, 0);
            prop_assert_eq!((found.frames, &found.fault), (frames, &None));
            prop_assert!(found.values.iter().map(|v| v.to_bits()).eq(values.iter().map(|v| v.to_bits())));
            prop_assert_eq!(found.first_number, if frames > 0 { first_number } else { 0 });
        }
    }

    #[test]
    fn any_bytes_are_read_alike_by_every_instruction_set(
        parts in prop::collection::vec(prop::sample::select(vec![
            "1\n", "2\n", "root ", "back ", "stiff", "a_name_of_twenty_byt ", "1 2 3", "4", "-.5 6e3", "\n",
            "\r\n", " ", "#", "nan", "\0", "\x1a", "1e", "-", ":DEGREES", "\t", "99999999999999999999999",
        ]), 0..40),
        start in 0_usize..9,
    ) {
        let text = parts.concat();
        let scalar = read_on(Isa::Scalar, text.as_bytes(), start);
        prop_assert_eq!(scalar.values.len(), 6 * scalar.frames);
        for isa in Isa::available() {
            prop_assert_eq!(&read_on(isa, text.as_bytes(), start), &scalar);
        }
    }
}

#[test]
fn a_value_that_is_not_finite_is_told_with_its_place() {
    let mut values = [0.0; 12];
    values[10] = f64::NAN;
    let job = FormatFrames { values: &values, bones: &BONES, frames: 2, first_number: 1 };
    assert_eq!(job.run(&mut Vec::new()), Err(NotFinite { row: 1, field: 4 }));
}
