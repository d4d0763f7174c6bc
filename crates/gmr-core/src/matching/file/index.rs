//! The arrays of the index in a saved database.

use std::path::Path;

use safetensors::tensor::Dtype;

use super::{Array, Fault, Opened, content};
use crate::matching::index::Index;
use crate::matching::index::stored::{Arrays, Parts, W, axis_blocks, counts, grid_width, pairs};

/// The arrays in the order in which they lie: those first that are a multiple of 32 bytes long.
pub(super) fn arrays<'a>(tree: &'a Arrays<'a>) -> Vec<Array<'a>> {
    let (leaves, nodes, dims) = (tree.frames.len(), tree.lowest.len(), tree.order.len());
    let array = |name, dtype, shape: &[usize], bytes| Array { name, dtype, shape: shape.to_vec(), bytes };
    vec![
        array("index_rows", Dtype::F32, &[leaves, dims, W], bytemuck::cast_slice(tree.rows)),
        array("index_frames", Dtype::U32, &[leaves, W], bytemuck::cast_slice(tree.frames)),
        array("index_tags", Dtype::U32, &[leaves, W], bytemuck::cast_slice(tree.tags)),
        array("index_boxes", Dtype::U32, &[nodes, dims, W], bytemuck::cast_slice(tree.boxes)),
        array("index_lowest", Dtype::U32, &[nodes, W], bytemuck::cast_slice(tree.lowest)),
        array("index_node_tags", Dtype::U32, &[nodes, W], bytemuck::cast_slice(tree.node_tags)),
        array("index_grids", Dtype::F32, &[nodes, grid_width(dims)], bytemuck::cast_slice(tree.grids)),
        array("index_box_codes", Dtype::U8, &[nodes, pairs(dims), 2, W, 2], tree.box_codes),
        array("index_row_codes", Dtype::U8, &[leaves, pairs(dims), W, 2], tree.row_codes),
        array(
            "index_axes",
            Dtype::F64,
            &[tree.axes.len() / (dims * W), dims, W],
            bytemuck::cast_slice(tree.axes),
        ),
        array("index_mean", Dtype::F64, &[dims], bytemuck::cast_slice(tree.mean)),
        array("index_sums", Dtype::U64, &[tree.sums.len()], bytemuck::cast_slice(&tree.sums)),
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
        let (leaves, nodes, width) = (Some(leaf_count), Some(node_count), Some(W));
        let (row_width, axes, pairs) = (dims, axis_blocks(dims), Some(pairs(dims)));
        let dims = Some(dims);
        let parts = Parts {
            file: path.to_owned(),
            frame_count: row_count,
            candidate_count,
            order: self.column::<u32>("index_order", Dtype::U32, &[dims])?.to_vec(),
            mean: self.column::<f64>("index_mean", Dtype::F64, &[dims])?.to_vec(),
            axes: self.column::<f64>("index_axes", Dtype::F64, &[Some(axes), dims, width])?.to_vec(),
            grids: self.column("index_grids", Dtype::F32, &[nodes, Some(grid_width(row_width))])?,
            box_codes: self.column("index_box_codes", Dtype::U8, &[nodes, pairs, Some(2), width, Some(2)])?,
            row_codes: self.column("index_row_codes", Dtype::U8, &[leaves, pairs, width, Some(2)])?,
            rows: self.column("index_rows", Dtype::F32, &[leaves, dims, width])?,
            frames: self.column("index_frames", Dtype::U32, &[leaves, width])?,
            tags: self.column("index_tags", Dtype::U32, &[leaves, width])?,
            boxes: self.column("index_boxes", Dtype::U32, &[nodes, dims, width])?,
            lowest: self.column("index_lowest", Dtype::U32, &[nodes, width])?,
            node_tags: self.column("index_node_tags", Dtype::U32, &[nodes, width])?,
            sums: self.column("index_sums", Dtype::U64, &[Some(leaf_count + node_count + 1)])?,
        };
        Index::in_file(parts).map_err(content)
    }
}
