//! A saved database opens with the same bits; what is no saved database is refused in a sentence.
#![cfg(feature = "file")]

mod synthetic;

use std::path::PathBuf;

use gmr_core::matching::database::Database;
use gmr_core::matching::file::{Labels, check, open, save};
use gmr_core::matching::index::{Hit, Query, brute_force};
use gmr_core::matching::path::Segment;
use gmr_core::matching::request::Tracking;
use gmr_core::matching::settings::Settings;
use gmr_core::matching::trial::{Profile, Progress, Trials, run_trials};
use proptest::prelude::*;
use synthetic::{RATE, Skeleton, Walk, database, database_at, database_with_a_past};

/// A file that is gone when this is dropped.
struct Place(PathBuf);

impl Place {
    fn new(name: &str) -> Self {
        Self(std::env::temp_dir().join(format!("gmr-{}-{name}", std::process::id())))
    }
}

impl Drop for Place {
    fn drop(&mut self) {
        let _ = std::fs::remove_file(&self.0);
    }
}

fn walks() -> [Walk; 3] {
    let walk = |speed, turn_rate, tags, leg| Walk { speed, turn_rate, tags, leg, ..Walk::default() };
    [walk(1.0, 0.0, 1, 0.9), walk(2.0, 0.7, 3, 0.8), walk(1.5, -1.0, 2, 0.9)]
}

fn labels(database: &Database) -> Labels {
    let names = |what: &str, count| (0..count).map(|i| format!("{what} \u{e9}{i}")).collect();
    Labels {
        joints: names("joint", database.joint_count()),
        clips: names("clip", database.clips().len()),
        notes: [("note".to_owned(), "{\"a\": 1}".to_owned())].into(),
    }
}

fn log(database: &Database) -> String {
    let segments = vec![Segment { duration: 9.0, speed: 1.4, turn_rate: 0.3, drift: 0.0 }];
    let (profiles, settings) = ([Profile { segments, record_from: 0.0 }], Settings::default());
    let tracking = Tracking::Time;
    let trials = Trials { database, profiles: &profiles, tracking, settings: &settings, threads: 1 };
    format!("{:?}", run_trials(&trials, &Progress::default()).unwrap())
}

#[test]
fn what_is_opened_has_the_bits_of_what_was_saved() {
    let carried = database_at(RATE, Skeleton::Carried, &walks());
    let part = {
        let whole = database(&walks());
        let left: Vec<bool> = (0..whole.row_count()).map(|row| !(250..=400).contains(&row)).collect();
        whole.subset(&left, 1).unwrap()
    };
    for (number, saved) in
        [database(&walks()), carried, database_with_a_past(&walks()), part].into_iter().enumerate()
    {
        let place = Place::new(&format!("bits{number}"));
        save(&saved, &labels(&saved), &place.0).unwrap();
        let bytes = std::fs::read(&place.0).unwrap();
        let (opened, read) = open(&place.0).unwrap();
        assert_eq!(read, labels(&saved));
        assert_eq!(check(&opened), Ok(()));
        assert_eq!(opened.features(), saved.features());
        assert_eq!(opened.positions(), saved.positions());
        assert_eq!(opened.rotations(), saved.rotations());
        assert_eq!(opened.translations(), saved.translations());
        assert!(opened.steps().eq(saved.steps()));
        assert_eq!((opened.ground(), opened.heading()), (saved.ground(), saved.heading()));
        assert!((0..900).all(|row| opened.has_row(row) == saved.has_row(row)));
        assert_eq!((opened.tags(), opened.candidates()), (saved.tags(), saved.candidates()));
        assert_eq!((opened.clips(), opened.clip_of()), (saved.clips(), saved.clip_of()));
        assert_eq!((opened.schema(), opened.normalization()), (saved.schema(), saved.normalization()));
        assert_eq!(opened.offsets(400), saved.offsets(400));
        assert_eq!((opened.rate(), opened.translated()), (saved.rate(), saved.translated()));
        for row in (0..saved.row_count() as u32).step_by(37) {
            let query = Query { tags: 2, ..Query::new(saved.feature_row(row)) };
            assert_eq!(opened.index().search(&query), saved.index().search(&query));
        }
        assert_eq!(log(&opened), log(&saved));

        // Saved again over the file that is mapped, it is the same file, and the map still holds.
        save(&opened, &read, &place.0).unwrap();
        assert_eq!(std::fs::read(&place.0).unwrap(), bytes);
        assert_eq!(opened.features(), saved.features());
    }
}

#[test]
fn what_is_no_saved_database_is_refused_in_a_sentence() {
    let saved = database(&walks());
    let place = Place::new("whole");
    save(&saved, &labels(&saved), &place.0).unwrap();
    let whole = std::fs::read(&place.0).unwrap();
    let text = |from: &str, to: &str| {
        let start = whole.windows(from.len()).position(|window| window == from.as_bytes()).unwrap();
        let mut bytes = whole.clone();
        assert_eq!(from.len(), to.len());
        bytes[start..start + to.len()].copy_from_slice(to.as_bytes());
        bytes
    };
    let place = Place::new("broken");
    let refusal = |bytes: &[u8]| {
        std::fs::write(&place.0, bytes).unwrap();
        open(&place.0).unwrap_err().to_string()
    };
    for (bytes, words) in [
        (Vec::new(), "header too small"),
        (b"HIERARCHY".to_vec(), "header too large"),
        (whole[..whole.len() - 1].to_vec(), "not fully covered"),
        (text("gmr_matching", "gmr_watching"), "it is no saved motion database"),
        (text("\"version\\\"", "\"VERSION\\\""), "missing field `version`"),
        (
            text("version\\\":3,", "version\\\":1,"),
            "it is of version 1, where this gmr reads version 3; build the database",
        ),
        (text("candidate_count\\\":720", "candidate_count\\\":990"), "990 candidates are told of among"),
        (text("candidate_count\\\":720", "candidate_count\\\":721"), "the array 'index_row_codes' is of U8"),
        (text("\"heading\"", "\"handing\""), "the array 'heading' is missing"),
        (text("root_facing", "root_farcing".get(..11).unwrap()), "which nobody knows"),
        (text("\"rate\\\":60.0", "\"rate\\\":-0.0"), "a rate of -0 rows a second"),
        (text("[20,40,60]", "[20,40,6e]"), "its description is not as it should be"),
        (text("joint \u{e9}0\\\",", "joint \u{e9}0\\\" "), "its description is not as it should be"),
    ] {
        let message = refusal(&bytes);
        assert!(message.contains(words), "{words}: {message}");
    }
    let missing = open(&place.0.with_extension("none")).unwrap_err().to_string();
    assert!(missing.contains("gmr-") && missing.contains("No such file"), "{missing}");
    let nameless = save(&saved, &Labels::default(), &place.0).unwrap_err().to_string();
    assert!(nameless.contains("0 names are given for 4 joints"), "{nameless}");
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, ..ProptestConfig::default() })]

    /// Wherever a byte is changed, the file opens or is refused; what opens can be searched and played.
    #[test]
    fn a_damaged_file_does_no_harm(at in any::<prop::sample::Index>(), byte in any::<u8>(), in_header in any::<bool>()) {
        let saved = database(&[Walk { frames: 70, ..Walk::default() }]);
        let place = Place::new("damaged");
        save(&saved, &labels(&saved), &place.0).unwrap();
        let mut bytes = std::fs::read(&place.0).unwrap();
        let header = 8 + u64::from_le_bytes(*bytes.first_chunk().unwrap()) as usize;
        let at = if in_header { at.index(header) } else { header + at.index(bytes.len() - header) };
        bytes[at] = byte;
        std::fs::write(&place.0, &bytes).unwrap();
        if let Ok((opened, _)) = open(&place.0) {
            let query = vec![0.1; opened.dims()];
            // What is damaged is refused where it is met, and never answered wrongly.
            if let Ok(found) = opened.index().search(&Query::new(&query)) {
                let of = |hit: Hit| brute_force::cost(&query, saved.feature_row(hit.frame));
                prop_assert!(found.is_none_or(|hit| hit.cost == of(hit)));
            }
            let _ = check(&opened);
            prop_assert_eq!(opened.candidates().len(), opened.row_count());
            prop_assert_eq!(opened.clip_of().len(), opened.row_count());
            for row in 0..opened.row_count() as u32 {
                let next = opened.next_row(row);
                prop_assert!(next.is_none_or(|next| (next as usize) < opened.row_count()));
                prop_assert_eq!(opened.offsets(row).len(), 3 * opened.joint_count());
            }
        }
    }
}
