//! A game's character driven by hand, without Python: a stick says where to, a pose comes out, in microseconds.
//!
//! The database is made once, of any clips, and saved:
//! `python -c "import gmr; gmr.matching.Database.build(gmr.read_folder('takes'), mirror=True).save('takes.gmrm')"`,
//! then `cargo run --release -p gmr-core --example drive_by_hand -- takes.gmrm`.

use std::path::Path;
use std::time::Instant;

use glam::DVec2;
use gmr_core::matching::character::Character;
use gmr_core::matching::file::open;
use gmr_core::matching::ground::{Placement, direction};
use gmr_core::matching::matcher::Status;
use gmr_core::matching::playback::HALF_LIFE;
use gmr_core::matching::settings::Settings;

/// Seconds, and what the stick asks for: metres a second, and a heading in degrees, positive to the left.
const SCRIPT: [(f64, f64, f64); 6] = [
    (3.0, 1.3, 0.0),
    (3.0, 1.3, 90.0),
    (2.0, 0.0, 90.0),
    (4.0, 2.8, -30.0),
    (2.0, 1.3, 150.0),
    (1.0, 0.0, 150.0),
];

/// Frames that are drawn each second: another rate than the database's.
const DRAWN: f64 = 144.0;

/// How fast a body is expected to do as the stick says, 1/s.
const EAGERNESS: f64 = 4.0;

/// What is expected of the body: its velocity and heading, on their way to those of the stick.
struct Wish {
    velocity: DVec2,
    heading: f64,
}

impl Wish {
    /// Where the body will be, if it goes on from `here` as it does and yields to the stick.
    fn after(&self, here: DVec2, stick: &Wish, seconds: f64) -> Placement {
        let left = (-EAGERNESS * seconds).exp();
        let position =
            here + stick.velocity * seconds + (self.velocity - stick.velocity) * ((1.0 - left) / EAGERNESS);
        Placement { position, heading: stick.heading + (self.heading - stick.heading) * left }
    }

    fn yielded(&self, stick: &Wish, seconds: f64) -> Wish {
        let left = (-EAGERNESS * seconds).exp();
        Wish {
            velocity: stick.velocity + (self.velocity - stick.velocity) * left,
            heading: stick.heading + (self.heading - stick.heading) * left,
        }
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let path = std::env::args().nth(1).ok_or("name a saved database, as the head of this example says")?;
    let begun = Instant::now();
    let (database, labels) = open(Path::new(&path))?;
    println!(
        "{} rows of {} clips opened in {:.1} ms",
        database.row_count(),
        labels.clips.len(),
        begun.elapsed().as_secs_f64() * 1e3
    );

    let mut character = Character::new(&database, &Settings::default(), HALF_LIFE, Placement::default())?;
    let mut wish = Wish { velocity: DVec2::ZERO, heading: 0.0 };
    let mut wanted = vec![Placement::default(); character.times().len()];
    let mut microseconds = Vec::new();
    for (seconds, speed, degrees) in SCRIPT {
        let stick = Wish { velocity: direction(degrees.to_radians()) * speed, heading: degrees.to_radians() };
        character.search_now();
        let mut jumps = 0;
        for _ in 0..(seconds * DRAWN) as usize {
            let here = character.placement().position;
            wish = wish.yielded(&stick, 1.0 / DRAWN);
            for (place, &ahead) in wanted.iter_mut().zip(character.times()) {
                *place = wish.after(here, &stick, ahead);
            }
            let before = character.choice().row;
            let begun = Instant::now();
            character.step(&wanted, 1.0 / DRAWN)?;
            microseconds.push(begun.elapsed().as_secs_f64() * 1e6);
            let choice = character.choice();
            jumps += u32::from(choice.row != before && choice.status == Status::Jumped);
        }
        let (place, row) = (character.placement(), character.choice().row);
        println!(
            "{speed:.1} m/s towards {degrees:4} deg: now at {:6.2} {:6.2}, facing {:4.0} deg, {jumps:2} jumps, in '{}'",
            place.position.x,
            place.position.y,
            place.heading.to_degrees(),
            labels.clips[database.clip_of()[row as usize] as usize],
        );
    }
    microseconds.sort_by(f64::total_cmp);
    let at = |share: f64| microseconds[((microseconds.len() - 1) as f64 * share) as usize];
    println!("{} steps: p50 {:.1} us, p99 {:.1} us", microseconds.len(), at(0.5), at(0.99));
    Ok(())
}
