//! Saved motion databases: any bytes as a file, and a sound file of which words were changed, also with the sums of its
//! index put right. What opens is searched, played and cut; what passes the whole check answers as a look at every row.
#![no_main]

use std::ops::Range;
use std::path::PathBuf;
use std::sync::LazyLock;

use gmr_core::Topology;
use gmr_core::matching::builder::{ClipPoses, DatabaseBuilder};
use gmr_core::matching::database::Database;
use gmr_core::matching::features::Schema;
use gmr_core::matching::file::{Labels, check, open, save};
use gmr_core::matching::index::{Hit, Query, brute_force};
use gmr_core::matching::settings::Settings;
use gmr_core::matching::path::Segment;
use gmr_core::matching::request::Tracking;
use gmr_core::matching::root::RootTrack;
use gmr_core::matching::trial::{Profile, Progress, Trials, run_trials};
use libfuzzer_sys::fuzz_target;

static PLACE: LazyLock<PathBuf> =
    LazyLock::new(|| std::env::temp_dir().join(format!("gmr-fuzz-{}.gmrm", std::process::id())));

static SOUND: LazyLock<Vec<u8>> = LazyLock::new(|| {
    save(&walks(), &labels(), &PLACE).expect("saved");
    std::fs::read(&*PLACE).expect("a file")
});

fuzz_target!(|bytes: &[u8]| {
    let Some((&kind, edits)) = bytes.split_first() else { return };
    // A header's length begins a file; no header is as long as one that begins with these.
    let file = match kind {
        0xfe => edited(edits),
        0xff => resealed(edited(edits)),
        _ => bytes.to_vec(),
    };
    std::fs::write(&*PLACE, file).expect("written");
    match open(&PLACE) {
        Err(error) => assert!(error.to_string().len() < 2000, "a long sentence: {error}"),
        Ok((database, _)) => use_all_of(&database),
    }
});

/// The sound file with words at places of it, eight bytes each.
fn edited(edits: &[u8]) -> Vec<u8> {
    let mut file = SOUND.clone();
    for edit in edits.as_chunks::<8>().0 {
        let (at, word) = edit.split_at(4);
        let at = 4 * (u32::from_le_bytes(at.try_into().expect("4 bytes")) as usize % (file.len() / 4));
        file[at..at + 4].copy_from_slice(word);
    }
    file
}

/// A file whose sums are those of its blocks, as docs/matching.md defines them.
fn resealed(mut file: Vec<u8>) -> Vec<u8> {
    let leaves = ["index_rows", "index_frames", "index_tags", "index_row_codes"].map(array);
    let nodes = ["index_boxes", "index_lowest", "index_node_tags", "index_grids", "index_box_codes"].map(array);
    let layout = ["index_order", "index_mean", "index_axes"].map(array);
    let leaf_count = leaves[1].len() / 32;
    let node_count = nodes[1].len() / 32;
    let parts = |arrays: &[Range<usize>], at: usize, count: usize| -> Vec<Vec<u8>> {
        let part = |array: &Range<usize>| {
            let size = array.len() / count;
            file[array.clone()][at * size..][..size].to_vec()
        };
        arrays.iter().map(part).collect()
    };
    let blocks = (0..leaf_count).map(|leaf| parts(&leaves, leaf, leaf_count));
    let blocks = blocks.chain((0..node_count).map(|node| parts(&nodes, node, node_count)));
    let blocks = blocks.chain([vec![parts(&layout, 0, 1).concat()]]);
    let sums: Vec<u8> = blocks.enumerate().flat_map(|(block, arrays)| sum(block, &arrays).to_le_bytes()).collect();
    file[array("index_sums")].copy_from_slice(&sums);
    file
}

/// The sum of a block, each of whose arrays is continued by zeros to a whole line.
fn sum(block: usize, arrays: &[Vec<u8>]) -> u64 {
    let mut lanes = [0_u32; 8];
    for array in arrays {
        let mut array = array.clone();
        array.resize(array.len().next_multiple_of(32), 0);
        for line in array.chunks_exact(32) {
            for (lane, word) in lanes.iter_mut().zip(line.as_chunks::<4>().0) {
                *lane = (lane.rotate_left(5) ^ u32::from_le_bytes(*word)).wrapping_mul(0x9e37_79b1);
            }
        }
    }
    lanes.iter().fold(block as u64, |sum, &lane| {
        (sum.rotate_left(29) ^ u64::from(lane)).wrapping_mul(0x9e37_79b9_7f4a_7c15)
    })
}

/// Where an array lies in the sound file.
fn array(name: &str) -> Range<usize> {
    let length = u64::from_le_bytes(*SOUND.first_chunk().expect("a length")) as usize;
    let header = std::str::from_utf8(&SOUND[8..8 + length]).expect("text");
    let told = header.split_once(&format!("\"{name}\":")).expect("the array").1;
    let told = told.split_once("\"data_offsets\":[").expect("its place").1;
    let (begin, rest) = told.split_once(',').expect("two numbers");
    let end = rest.split_once(']').expect("two numbers").0;
    let number = |text: &str| 8 + length + text.parse::<usize>().expect("a number");
    number(begin)..number(end)
}

fn use_all_of(database: &Database) {
    let rows = database.row_count();
    assert_eq!(database.candidates().len(), rows);
    assert_eq!(database.clip_of().len(), rows);
    let is_right = check(database).is_ok();
    for step in [0.1, -1.0, 30.0] {
        let features: Vec<f32> = (0..database.dims()).map(|dim| step * (dim as f32 - 13.0) / 27.0).collect();
        let weights: Vec<f32> = (0..database.dims()).map(|dim| (dim % 3) as f32).collect();
        for (weights, tags) in [(None, 0), (None, 2), (Some(&weights[..]), 0)] {
            let query = Query { weights, tags, ..Query::new(&features) };
            let mut hits = [Hit::NONE; 3];
            let Ok(found) = database.index().search_top(&query, &mut hits) else { continue };
            assert!(hits[..found].iter().all(|hit| (hit.frame as usize) < rows));
            if is_right {
                let (candidates, all_tags) = (database.candidates(), Some(database.tags()));
                let best = brute_force::search_top(database.features(), candidates, all_tags, &query, 3);
                assert_eq!(hits[..found], best[..]);
            }
        }
    }
    for row in 0..rows as u32 {
        assert!(database.next_row(row).is_none_or(|next| (next as usize) < rows));
        assert_eq!(database.offsets(row).len(), 3 * database.joint_count());
    }
    let left: Vec<bool> = (0..rows).map(|row| row % 90 != 3).collect();
    if let Ok(part) = database.subset(&left, 1) {
        let _ = part.index().search(&Query::new(&vec![0.5; part.dims()]));
    }
    // What trials ask for is bounded by their length; a file's rate multiplies it.
    if database.rate() <= 240.0 {
        let segments = vec![Segment { duration: 0.5, speed: 1.4, turn_rate: 0.3, drift: 0.0 }];
        let (profiles, settings) = ([Profile { segments, record_from: 0.0 }], Settings::default());
        let trials =
            Trials { database, profiles: &profiles, tracking: Tracking::Time, settings: &settings, threads: 1 };
        let _ = run_trials(&trials, &Progress::default());
    }
}

/// Hips and two feet, straight ahead and faster, 80 frames each.
fn walks() -> Database {
    let topology = Topology::new(&[-1, 0, 0], &[-1, 0, 0], 1).expect("a skeleton");
    let schema = Schema::locomotion(1, 2, 0, 3).expect("a schema");
    let mut builder = DatabaseBuilder::new(topology, vec![0], schema, 60.0).expect("a builder");
    let frames = 80_usize;
    for speed in [0.02_f32, 0.05] {
        let z = |i: usize| speed * i as f32;
        let swing = |i: usize| 0.2 * (0.3 * i as f32).sin();
        let positions = (0..frames).flat_map(|i| {
            [0.0, 0.9, z(i), 0.1, 0.0, z(i) + swing(i), -0.1, 0.0, z(i) - swing(i)]
        });
        builder
            .add_clip(&ClipPoses {
                positions: &positions.collect::<Vec<f32>>(),
                rotations: &[0.0, 0.0, 0.0, 1.0].repeat(frames),
                translations: &(0..frames).flat_map(|i| [0.0, 0.9, f64::from(z(i))]).collect::<Vec<f64>>(),
                offsets: &[0.0, 0.9, 0.0, 0.1, -0.9, 0.0, -0.1, -0.9, 0.0],
                root: &RootTrack {
                    ground: (0..frames).map(|i| [0.0, f64::from(z(i))]).collect(),
                    heading: vec![0.0; frames],
                },
                tags: &(0..frames).map(|i| i as u32 / 20).collect::<Vec<u32>>(),
            })
            .expect("a clip");
    }
    builder.finish(None, 1).expect("a database")
}

fn labels() -> Labels {
    let names = |names: &[&str]| names.iter().map(|&name| name.to_owned()).collect();
    Labels { joints: names(&["hips", "left", "right"]), clips: names(&["slow", "fast"]), ..Labels::default() }
}
