//! Any bytes as the frames of an AMC: every instruction set sees the same, the memory is bounded by the text, and
//! what is read is written and reads back bit-identical.
#![no_main]

use gmr_core::Isa;
use gmr_core::numbers::{Bone, FormatFrames, ParseFrames};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|input: ([u8; 4], &[u8])| {
    let (counts, text) = input;
    let names: [&[u8]; 4] = [b"root", b"a", b"thigh", b"a_name_of_twenty_byt"];
    let bones: Vec<_> = names.iter().zip(counts).map(|(name, n)| Bone { name, values: n as usize % 7 }).collect();
    let columns: usize = bones.iter().map(|bone| bone.values).sum();

    let job = ParseFrames { text, start: 0, bones: &bones };
    let read = job.run_on(Isa::Scalar);
    for isa in Isa::available() {
        let fast = job.run_on(isa);
        assert!(fast.values.iter().map(|v| v.to_bits()).eq(read.values.iter().map(|v| v.to_bits())), "{isa}");
        assert_eq!((fast.frames, &fast.fault, &fast.listed), (read.frames, &read.fault, &read.listed), "{isa}");
    }
    assert_eq!(read.values.len(), read.frames * columns);
    assert!(read.values.len() <= 4 * text.len() + (1 << 16) + columns);
    assert!(read.values.iter().all(|value| value.is_finite()));
    if let Some(fault) = &read.fault {
        assert!(fault.token.end <= text.len() && fault.frame == read.frames);
    }

    let mut again = Vec::new();
    let (frames, first_number) = (read.frames, read.first_number);
    FormatFrames { values: &read.values, bones: &bones, frames, first_number }.run(&mut again).expect("finite");
    let found = ParseFrames { text: &again, start: 0, bones: &bones }.run();
    if columns > 0 {
        assert_eq!((found.frames, found.fault), (read.frames, None));
        assert!(found.values.iter().map(|v| v.to_bits()).eq(read.values.iter().map(|v| v.to_bits())));
    }
});
