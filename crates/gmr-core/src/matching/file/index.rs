//! The arrays of the index in a saved database.

use std::path::Path;

use safetensors::tensor::Dtype;

use super::{Array, Fault, Opened, content};
use crate::matching::index::Index;
use crate::matching::index::stored::{Arrays, Parts, WIDTH, counts};

/// The arrays in the order in which they lie; each is a multiple of 32 bytes long, but for the last two.
pub(super) fn arrays<'a>(tree: &'a Arrays<'a>) -> Vec<Array<'a>> {
    let (leaves, nodes, dims) = (tree.frames.len(), tree.lowest.len(), tree.order.len());
    let array = |name, dtype, shape: &[usize], bytes| Array { name, dtype, shape: shape.to_vec(), bytes };
    vec![
        array("index_rows", Dtype::F32, &[leaves, dims, WIDTH], bytemuck::cast_slice(tree.rows)),
        array("index_frames", Dtype::U32, &[leaves, WIDTH], bytemuck::cast_slice(tree.frames)),
        array("index_tags", Dtype::U32, &[leaves, WIDTH], bytemuck::cast_slice(tree.tags)),
        array("index_boxes", Dtype::U32, &[nodes, dims, WIDTH], bytemuck::cast_slice(tree.boxes)),
        array("index_lowest", Dtype::U32, &[nodes, WIDTH], bytemuck::cast_slice(tree.lowest)),
        array("index_node_tags", Dtype::U32, &[nodes, WIDTH], bytemuck::cast_slice(tree.node_tags)),
        array("index_sums", Dtype::U64, &[leaves + nodes], bytemuck::cast_slice(&tree.sums)),
    ]
}

impl Opened {
    /// The index over `row_count` rows of `dims` numbers, searched where it lies; none of its rows is read.
    pub(super) fn index(&self, row_count: usize, dims: usize, path: &Path) -> Result<Index, Fault> {
        let candidate_count = self.description.candidate_count;
        if candidate_count > row_count {
            return Err(content(format!("{candidate_count} candidates are told of among {row_count} rows")));
        }
        let (leaf_count, node_count) = counts(candidate_count);
        let (leaves, nodes, dims) = (Some(leaf_count), Some(node_count), Some(dims));
        let width = Some(WIDTH);
        let parts = Parts {
            file: path.to_owned(),
            frame_count: row_count,
            candidate_count,
            order: self.column::<u32>("index_order", Dtype::U32, &[dims])?.to_vec(),
            rows: self.column("index_rows", Dtype::F32, &[leaves, dims, width])?,
            frames: self.column("index_frames", Dtype::U32, &[leaves, width])?,
            tags: self.column("index_tags", Dtype::U32, &[leaves, width])?,
            boxes: self.column("index_boxes", Dtype::U32, &[nodes, dims, width])?,
            lowest: self.column("index_lowest", Dtype::U32, &[nodes, width])?,
            node_tags: self.column("index_node_tags", Dtype::U32, &[nodes, width])?,
            sums: self.column("index_sums", Dtype::U64, &[Some(leaf_count + node_count)])?,
        };
        Index::in_file(parts).map_err(content)
    }
}
