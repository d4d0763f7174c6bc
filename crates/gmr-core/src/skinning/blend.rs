//! The job: a skin, and where its joints are in each frame.

use super::arrangement::WINDOW;
use super::bones::{self, Bones};
use super::method::Method;
use super::work::{Frame, Work};
use super::{Skin, SkinError, block};
use crate::Isa;
use crate::error::ShapeError;
use crate::kinematics::{Piece, take};
use crate::lanes::cache;
use crate::parallel::for_each_piece;

/// The job.
#[derive(Debug, Clone, Copy)]
pub struct Blend<'a> {
    /// The mesh and its influences.
    pub skin: &'a Skin,
    /// (F, B, 4, 4): the current world matrix of each joint times the inverse of its bind matrix, rows first.
    pub transforms: &'a [f64],
    /// F.
    pub frame_count: usize,
    /// How they are blended.
    pub method: Method<'a>,
    /// How many threads share the work; 0: all cores. The bits do not depend on it.
    pub threads: usize,
}

/// Where the answer goes.
#[derive(Debug)]
pub struct Blended<'a> {
    /// (F, V, 3).
    pub positions: &'a mut [f32],
    /// (F, V, 3), of length 1; of length 0 where the transforms flatten a vertex's surroundings.
    pub normals: Option<&'a mut [f32]>,
}

/// Frames whose bones are made ready at a time: the vertices of a tile meet all of them while they are near.
const FRAMES_PER_PIECE: usize = 16;

/// Windows of vertices that a thread takes at a time.
const WINDOWS_PER_PIECE: usize = 8;
const VERTICES_PER_PIECE: usize = WINDOWS_PER_PIECE * WINDOW;

/// Computes positions and, where there is room for them, normals.
///
/// NaN in a transform gives NaN in the vertices that follow its joint in that frame, and nothing else.
///
/// # Errors
/// When a length does not fit, a transform is not affine, or normals are asked for that the skin does not have.
pub fn blend(job: &Blend<'_>, out: Blended<'_>) -> Result<(), SkinError> {
    blend_on(Isa::current(), job, out)
}

/// [`blend`] on a given instruction set. All give the same bits.
///
/// # Errors
/// As there; and when this machine cannot run `isa`.
pub fn blend_on(isa: Isa, job: &Blend<'_>, out: Blended<'_>) -> Result<(), SkinError> {
    check(isa, job, &out)?;
    let row = 3 * job.skin.vertex_count;
    if row == 0 {
        return Ok(());
    }
    let centers = match job.method {
        Method::Centers(centers) => job.skin.arranged(centers),
        _ => vec![],
    };
    let is_large = cache::is_large(out.positions);
    let ranges = job.skin.vertex_count.div_ceil(VERTICES_PER_PIECE);
    let positions = cut(Some(out.positions), row);
    let normals = cut(out.normals, row);
    let transforms_per_frame = 16 * job.skin.joint_count;
    for_each_piece(job.frame_count.div_ceil(FRAMES_PER_PIECE) * ranges, job.threads, |index| {
        let (group, range) = (index / ranges, index % ranges);
        let frames = group * FRAMES_PER_PIECE..job.frame_count.min((group + 1) * FRAMES_PER_PIECE);
        let windows = range * WINDOWS_PER_PIECE;
        let windows = windows..job.skin.arrangement.windows.len().min(windows + WINDOWS_PER_PIECE);
        let mut frames: Vec<Frame<'_>> = frames
            .map(|frame| Frame {
                bones: Bones::new(
                    job.skin,
                    &job.transforms[frame * transforms_per_frame..][..transforms_per_frame],
                    job.method,
                ),
                positions: take(&positions, frame * ranges + range).unwrap_or_default(),
                normals: take(&normals, frame * ranges + range),
            })
            .collect();
        let work = Work { skin: job.skin, method: job.method, centers: &centers, windows, is_large };
        block::run(isa, &work, &mut frames);
    });
    Ok(())
}

/// The rows of frames, each cut into the vertices of a piece.
fn cut(array: Option<&mut [f32]>, row: usize) -> Vec<Piece<'_, f32>> {
    let rows = array.into_iter().flat_map(|array| array.chunks_mut(row));
    rows.flat_map(|row| row.chunks_mut(3 * VERTICES_PER_PIECE)).map(|piece| Some(piece).into()).collect()
}

fn check(isa: Isa, job: &Blend<'_>, out: &Blended<'_>) -> Result<(), SkinError> {
    if !isa.is_available() {
        return Err(SkinError::Isa(isa));
    }
    let (skin, joint_count) = (job.skin, job.skin.joint_count);
    let room = job.frame_count * 3 * skin.vertex_count;
    ShapeError::check("transforms", job.frame_count * joint_count * 16, job.transforms.len())?;
    ShapeError::check("positions", room, out.positions.len())?;
    if let Some(normals) = &out.normals {
        if !skin.has_normals() {
            return Err(SkinError::NoNormals);
        }
        ShapeError::check("normals", room, normals.len())?;
    }
    if let Method::Centers(centers) = job.method {
        ShapeError::check("centers", 3 * skin.vertex_count, centers.len())?;
    }
    bones::check(job.transforms, joint_count)
}
