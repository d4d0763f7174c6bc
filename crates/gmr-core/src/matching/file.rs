//! A motion database in a file: saved whole, opened by mapping it into memory.
//!
//! The file is a safetensors container (little-endian arrays behind a JSON header); docs/matching.md lists its arrays.
//! Opening looks at the header, the skeleton and the clips, and at no row: the index lies in the file too and is
//! searched there, and whatever a search, a trial or a picture needs is brought in when it is looked at. So are its
//! errors told only then, but for [`check`], which looks at the whole index.
//! A map shows what the file holds now: a saved database takes the place of the old file and never writes into it;
//! another program that cuts a mapped file short ends the process.

use std::collections::{BTreeMap, HashMap};
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::Path;
use std::sync::{Arc, OnceLock};

mod fault;
mod index;

use memmap2::Mmap;
use safetensors::tensor::{Dtype, Metadata, TensorInfo};
use safetensors::{SafeTensorError, SafeTensors};
use serde::{Deserialize, Serialize};

use super::aligned::Number;
use super::builder::check_skeleton;
use super::column::Column;
use super::database::{Clip, Database, Rows};
use super::features::{Group, Measure, Schema};
use super::index::IndexError;
use super::index::stored::Arrays;
use super::left::Left;
use super::normalization::Normalization;
use crate::skeleton::Topology;

use fault::content;
pub use fault::{Fault, FileError};

/// The string of the container's metadata that tells what the arrays do not.
const KEY: &str = "gmr_matching";
const VERSION: u32 = 3;

/// Where arrays begin: a whole number of cache lines into the file.
const LINE: usize = 64;

/// Bytes of a header at most: it is read whole.
const MOST_HEADER: u64 = 1 << 24;

/// What a database itself does not need to know.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Labels {
    /// The name of each joint.
    pub joints: Vec<String>,
    /// The name of each clip.
    pub clips: Vec<String>,
    /// Whatever else is kept with it, by name.
    pub notes: BTreeMap<String, String>,
}

#[derive(Serialize, Deserialize)]
struct Description {
    version: u32,
    rate: f64,
    candidate_count: usize,
    groups: Vec<GroupText>,
    constant_groups: Vec<usize>,
    joints: Vec<String>,
    clips: Vec<String>,
    notes: BTreeMap<String, String>,
}

#[derive(Serialize, Deserialize)]
struct GroupText {
    name: String,
    measure: String,
    #[serde(default)]
    joint: Option<usize>,
    frames: Vec<i32>,
    weight: f32,
}

/// Saves a database; an old file of that name is replaced once the new one is whole.
///
/// # Errors
/// When there is not one name for each joint and clip, or the file cannot be written.
pub fn save(database: &Database, labels: &Labels, path: &Path) -> Result<(), FileError> {
    let refuse = |what| FileError { path: path.to_owned(), fault: what };
    let counts = [
        ("joints", database.joint_count(), labels.joints.len()),
        ("clips", database.clips().len(), labels.clips.len()),
    ];
    if let Some((what, count, found)) = counts.into_iter().find(|(_, count, found)| count != found) {
        return Err(refuse(Fault::Content(format!("{found} names are given for {count} {what}"))));
    }
    let write = || -> Result<(), Fault> {
        let clips: Vec<[u32; 3]> =
            database.clips().iter().map(|clip| [clip.rows.start, clip.rows.end, clip.bones]).collect();
        let index = database.index.arrays();
        let (header, arrays) = laid_out(database, labels, &clips, &index)?;
        // Where a link stands, the file that it leads to is replaced.
        let place = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        replace(&place, &header, &arrays).map_err(Fault::Io)
    };
    write().map_err(refuse)
}

/// Opens a saved database by mapping it into memory; takes as long for many rows as for few.
///
/// # Errors
/// When the file cannot be read, is no saved database, or is of another version.
pub fn open(path: &Path) -> Result<(Database, Labels), FileError> {
    let read = || -> Result<(Database, Labels), Fault> {
        let file = File::open(path).map_err(Fault::Io)?;
        let size = file.metadata().map_err(Fault::Io)?.len();
        if size < 8 {
            return Err(Fault::Container(SafeTensorError::HeaderTooSmall));
        }
        // SAFETY: the file is mapped for reading only; that nobody cuts it short meanwhile is asked for above.
        let map = unsafe { Mmap::map(&file) }.map_err(Fault::Io)?;
        Opened::new(Arc::new(map))?.database(path)
    };
    read().map_err(|fault| FileError { path: path.to_owned(), fault })
}

/// Looks at all of the index of an opened database and holds it against the rows: whether its searches find what a
/// look at every row would find.
///
/// # Errors
/// What is wrong, where something is.
pub fn check(database: &Database) -> Result<(), IndexError> {
    database.index.check(database.features(), database.candidates(), database.tags())
}

/// An array to be written.
struct Array<'a> {
    name: &'static str,
    dtype: Dtype,
    shape: Vec<usize>,
    bytes: &'a [u8],
}

/// The header, padded so that all numbers are aligned in a map, and the arrays in the order in which they follow.
fn laid_out<'a>(
    database: &'a Database,
    labels: &Labels,
    clips: &'a [[u32; 3]],
    index: &'a Arrays<'a>,
) -> Result<(Vec<u8>, Vec<Array<'a>>), Fault> {
    let rows = &database.rows;
    let (n, j, s, t) =
        (database.row_count(), database.joint_count(), database.slot_count(), database.translated.len());
    let array = |name, dtype, shape: &[usize], bytes| Array { name, dtype, shape: shape.to_vec(), bytes };
    let topology = database.topology();
    let bone_sets = &database.bone_sets;
    let f32s = bytemuck::cast_slice::<f32, u8>;
    // The index first, where vectors are aligned; then the wider types first, so that each begins where its numbers are.
    let mut arrays = index::arrays(index);
    arrays.extend([
        array("ground", Dtype::F64, &[n, 2], bytemuck::cast_slice(&rows.ground)),
        array("heading", Dtype::F64, &[n], bytemuck::cast_slice(&rows.heading)),
        array("features", Dtype::F32, &[n, database.dims()], f32s(&rows.features)),
        array("positions", Dtype::F32, &[n, j, 3], f32s(&rows.positions)),
        array("rotations", Dtype::F32, &[n, s, 4], f32s(&rows.rotations)),
        array("translations", Dtype::F32, &[n, t, 3], f32s(&rows.translations)),
        array("steps", Dtype::F32, &[n, 3], bytemuck::cast_slice(&rows.steps)),
        array("bone_sets", Dtype::F32, &[bone_sets.len() / (3 * j).max(1), j, 3], f32s(bone_sets)),
        array("offset", Dtype::F32, &[database.dims()], f32s(&database.normalization.offset)),
        array("scale", Dtype::F32, &[database.dims()], f32s(&database.normalization.scale)),
        array("index_order", Dtype::U32, &[database.dims()], bytemuck::cast_slice(index.order)),
        array("tags", Dtype::U32, &[n], bytemuck::cast_slice(&rows.tags)),
        array("clips", Dtype::U32, &[clips.len(), 3], bytemuck::cast_slice(clips)),
        array("parents", Dtype::I32, &[j], bytemuck::cast_slice(topology.parents())),
        array("slots", Dtype::I32, &[j], bytemuck::cast_slice(topology.slots())),
        array("translated", Dtype::I32, &[t], bytemuck::cast_slice(&database.translated)),
    ]);
    if let Some(left) = &database.left {
        arrays.push(array("left", Dtype::U8, &[n], left.rows()));
    }
    let mut end = 0;
    let infos = arrays.iter().map(|array| {
        let begin = end;
        end += array.bytes.len();
        let info = TensorInfo { dtype: array.dtype, shape: array.shape.clone(), data_offsets: (begin, end) };
        (array.name.to_owned(), info)
    });
    let infos = infos.collect();
    let description = serde_json::to_string(&describe(database, labels)).map_err(Fault::from)?;
    let metadata = HashMap::from([(KEY.to_owned(), description)]);
    let metadata = Metadata::new(Some(metadata), infos).map_err(Fault::Container)?;
    let mut header = serde_json::to_vec(&metadata).map_err(Fault::from)?;
    header.resize((8 + header.len()).next_multiple_of(LINE) - 8, b' ');
    match header.len() as u64 > MOST_HEADER {
        true => Err(Fault::Container(SafeTensorError::HeaderTooLarge)),
        false => Ok((header, arrays)),
    }
}

fn describe(database: &Database, labels: &Labels) -> Description {
    let group = |group: &Group| {
        let (measure, joint) = match group.measure {
            Measure::Position { joint } => ("position", Some(joint)),
            Measure::Velocity { joint } => ("velocity", Some(joint)),
            Measure::RootPosition => ("root_position", None),
            Measure::RootFacing => ("root_facing", None),
        };
        let (name, frames) = (group.name.clone(), group.frames.clone());
        GroupText { name, measure: measure.to_owned(), joint, frames, weight: group.weight }
    };
    Description {
        version: VERSION,
        rate: database.rate,
        candidate_count: database.index.candidate_count(),
        groups: database.schema.groups().iter().map(group).collect(),
        constant_groups: database.constant_groups.clone(),
        joints: labels.joints.clone(),
        clips: labels.clips.clone(),
        notes: labels.notes.clone(),
    }
}

/// Writes beside `place`, then takes its name.
fn replace(place: &Path, header: &[u8], arrays: &[Array]) -> io::Result<()> {
    let mut name = place.file_name().unwrap_or_default().to_owned();
    name.push(format!(".{}.part", std::process::id()));
    let beside = place.with_file_name(name);
    let write = || -> io::Result<()> {
        let file = File::create_new(&beside)?;
        let mut out = BufWriter::with_capacity(1 << 20, &file);
        out.write_all(&(header.len() as u64).to_le_bytes())?;
        out.write_all(header)?;
        arrays.iter().try_for_each(|array| out.write_all(array.bytes))?;
        out.flush()?;
        drop(out);
        if place.exists() {
            file.sync_all()?;
        }
        fs::rename(&beside, place)
    };
    let written = write();
    if written.as_ref().is_err_and(|error| error.kind() != io::ErrorKind::AlreadyExists) {
        // What is half written is of no use; that it cannot be removed either says nothing new.
        let _ = fs::remove_file(&beside);
    }
    written
}

/// A mapped file whose header has been read.
struct Opened {
    map: Arc<Mmap>,
    start: usize,
    metadata: Metadata,
    description: Description,
}

impl Opened {
    fn new(map: Arc<Mmap>) -> Result<Self, Fault> {
        let length = map.first_chunk::<8>().map_or(0, |bytes| u64::from_le_bytes(*bytes));
        if length > MOST_HEADER {
            return Err(Fault::Container(SafeTensorError::HeaderTooLarge));
        }
        let (length, metadata) = SafeTensors::read_metadata(&map).map_err(Fault::Container)?;
        let text = metadata.metadata().as_ref().and_then(|strings| strings.get(KEY));
        let text = text
            .ok_or_else(|| content(format!("its metadata has no '{KEY}': it is no saved motion database")))?;
        #[derive(Deserialize)]
        struct Versioned {
            version: u32,
        }
        let Versioned { version } = serde_json::from_str(text)?;
        if version != VERSION {
            return Err(Fault::Version { found: version });
        }
        let description = serde_json::from_str(text)?;
        Ok(Self { map, start: 8 + length, metadata, description })
    }

    fn database(self, path: &Path) -> Result<(Database, Labels), Fault> {
        let tags: Column<u32> = self.column("tags", Dtype::U32, &[None])?;
        let n = tags.len();
        // Only where there are rows does the size of the file bound how wide they are.
        if n == 0 {
            return Err(content("it has no rows"));
        }
        let parents: Column<i32> = self.column("parents", Dtype::I32, &[None])?;
        let slots: Column<i32> = self.column("slots", Dtype::I32, &[Some(parents.len())])?;
        let joints = parents.len();
        let slot_count = self.width("rotations", 1)?;
        let topology = Topology::new(&parents, &slots, slot_count).map_err(content)?;
        let translated = self.column::<i32>("translated", Dtype::I32, &[None])?.to_vec();
        check_skeleton(&topology, &translated).map_err(content)?;
        let schema = self.schema(joints)?;
        let dims = schema.dims();
        if u32::try_from(n).is_err() || schema.past().saturating_add(schema.future()) >= n {
            return Err(content(format!("{n} rows hold no clip as long as its features look")));
        }
        let bone_sets: Column<f32> = self.column("bone_sets", Dtype::F32, &[None, Some(joints), Some(3)])?;
        let clips = self.clips(n, bone_sets.len() / (3 * joints).max(1))?;
        let normalization = Normalization {
            offset: self.column::<f32>("offset", Dtype::F32, &[Some(dims)])?.to_vec(),
            scale: self.column::<f32>("scale", Dtype::F32, &[Some(dims)])?.to_vec(),
        };
        let numbers = |name, shape: &[usize]| {
            let shape: Vec<_> = shape.iter().map(|&count| Some(count)).collect();
            self.column::<f32>(name, Dtype::F32, &shape)
        };
        let rows = Rows {
            features: numbers("features", &[n, dims])?,
            positions: numbers("positions", &[n, joints, 3])?,
            rotations: numbers("rotations", &[n, slot_count, 4])?,
            translations: numbers("translations", &[n, translated.len(), 3])?,
            steps: self.column("steps", Dtype::F32, &[Some(n), Some(3)])?,
            ground: self.column("ground", Dtype::F64, &[Some(n), Some(2)])?,
            heading: self.column("heading", Dtype::F64, &[Some(n)])?,
            tags,
            candidates: OnceLock::new(),
            clip_of: OnceLock::new(),
            clips,
        };
        let left = self.info("left").is_ok().then(|| self.column::<u8>("left", Dtype::U8, &[Some(n)]));
        let left = left.transpose()?;
        let index = self.index(n, dims, path)?;
        let Description { rate, constant_groups, joints: names, clips: clip_names, notes, .. } =
            self.description;
        if !(rate > 0.0 && rate <= 1e6) {
            return Err(content(format!("a rate of {rate} rows a second is not possible")));
        }
        if constant_groups.iter().any(|&group| group >= schema.groups().len()) {
            return Err(content("a constant group is not there".to_owned()));
        }
        for (what, count, found) in
            [("joints", joints, names.len()), ("clips", rows.clips.len(), clip_names.len())]
        {
            if count != found {
                return Err(content(format!("{found} names are given for {count} {what}")));
            }
        }
        let labels = Labels { joints: names, clips: clip_names, notes };
        let database = Database {
            topology,
            translated,
            bone_sets,
            schema,
            rate,
            normalization,
            constant_groups,
            index: Arc::new(index),
            rows: Arc::new(rows),
            left: left.map(|rows| Arc::new(Left::new(rows))),
        };
        Ok((database, labels))
    }

    fn schema(&self, joint_count: usize) -> Result<Schema, Fault> {
        let mut groups = Vec::new();
        for GroupText { name, measure, joint, frames, weight } in &self.description.groups {
            let joint = || joint.ok_or_else(|| content(format!("feature group '{name}' names no joint")));
            let measure = match measure.as_str() {
                "position" => Measure::Position { joint: joint()? },
                "velocity" => Measure::Velocity { joint: joint()? },
                "root_position" => Measure::RootPosition,
                "root_facing" => Measure::RootFacing,
                other => {
                    let what = format!("feature group '{name}' measures '{other}', which nobody knows");
                    return Err(content(what));
                }
            };
            groups.push(Group { name: name.clone(), measure, frames: frames.clone(), weight: *weight });
        }
        Schema::new(groups, joint_count).map_err(content)
    }

    /// The clips, which lie one after the other and are all there is.
    fn clips(&self, row_count: usize, bone_sets: usize) -> Result<Vec<Clip>, Fault> {
        let listed: Column<[u32; 3]> = self.column("clips", Dtype::U32, &[None, Some(3)])?;
        let (mut clips, mut at) = (Vec::with_capacity(listed.len()), 0);
        for (number, &[start, end, bones]) in listed.iter().enumerate() {
            if start != at || end < start || end as usize > row_count {
                let what = format!("clip {number}, of rows {start} to {end}, does not follow the one before");
                return Err(content(what));
            }
            if bones as usize >= bone_sets {
                return Err(content(format!("clip {number} has bones {bones} of {bone_sets}")));
            }
            clips.push(Clip { rows: start..end, bones });
            at = end;
        }
        if at as usize != row_count {
            return Err(content(format!("{} rows belong to no clip", row_count - at as usize)));
        }
        Ok(clips)
    }

    /// An array of this type and shape, where a length may be any.
    fn column<T: Number>(
        &self,
        name: &str,
        dtype: Dtype,
        shape: &[Option<usize>],
    ) -> Result<Column<T>, Fault> {
        let range = self.bytes(name, dtype, shape)?;
        if range.is_empty() {
            return Ok(Vec::new().into());
        }
        Column::mapped(&self.map, |map| {
            bytemuck::try_cast_slice(&map[range])
                .map_err(|_| content(format!("the array '{name}' does not begin where its numbers would")))
        })
    }

    /// Where the array lies in the file.
    fn bytes(
        &self,
        name: &str,
        dtype: Dtype,
        shape: &[Option<usize>],
    ) -> Result<std::ops::Range<usize>, Fault> {
        let info = self.info(name)?;
        let fits = info.dtype == dtype
            && info.shape.len() == shape.len()
            && info.shape.iter().zip(shape).all(|(&found, asked)| asked.is_none_or(|asked| asked == found));
        if !fits {
            let asked: Vec<String> =
                shape.iter().map(|n| n.map_or("any".to_owned(), |n| n.to_string())).collect();
            return Err(content(format!(
                "the array '{name}' is of {} and the shape {:?}, where {dtype} and ({}) is needed",
                info.dtype,
                info.shape,
                asked.join(", ")
            )));
        }
        let (begin, end) = info.data_offsets;
        Ok(self.start + begin..self.start + end)
    }

    fn width(&self, name: &str, axis: usize) -> Result<usize, Fault> {
        let width = self.info(name)?.shape.get(axis).copied();
        width.ok_or_else(|| content(format!("the array '{name}' has no axis {axis}")))
    }

    fn info(&self, name: &str) -> Result<&TensorInfo, Fault> {
        self.metadata.info(name).ok_or_else(|| content(format!("the array '{name}' is missing")))
    }
}
