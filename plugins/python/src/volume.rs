//! `read_vdb` and `write_vdb`: grids as dense arrays.

use std::path::PathBuf;

use numpy::ndarray::ArrayD;
use numpy::{AllowTypeChange, PyArray, PyArray2, PyArrayDyn, PyArrayLikeDyn};
use photonvdb::math::{DAffine3, DVec3};
use photonvdb::medium::vdb::{
    DenseBox, GridClass, GridToWrite, IndexBox, Limits, SparseGrid, ValuesToWrite, VdbFile,
    VolumeSource, WriteCompression, WriteOptions, find_density_or_level_set, find_grid,
    write_vdb as write_grids,
};
use pyo3::prelude::*;

use crate::array::{Floats, to_array};
use crate::error::{IntoPyErr, refused};
use crate::input::Count;
use crate::run::{run, thread_pool};

/// Array, index to world, origin.
type Volume<'py> = (Bound<'py, PyArrayDyn<f32>>, Bound<'py, PyArray2<f64>>, (i32, i32, i32));

/// A grid of an OpenVDB file as a dense array: the box of its active voxels, inactive ones between them included.
///
/// Returns `(array, index_to_world, origin)`. The float32 array has the shape (nx, ny, nz), or (nx, ny, nz, 3) of vectors;
/// `array[i, j, k]` is the voxel `origin + (i, j, k)`, whose centre lies at `index_to_world @ (x, y, z, 1)`. Without `grid` the
/// file's only grid is read, or "density". What needs more than `max_memory` bytes is refused (8 GiB by default).
#[pyfunction]
#[pyo3(signature = (path, grid=None, *, max_memory=None))]
pub fn read_vdb<'py>(
    py: Python<'py>,
    path: PathBuf,
    grid: Option<&str>,
    max_memory: Option<Count>,
) -> PyResult<Volume<'py>> {
    let limits = max_memory.map_or_else(Limits::default, |bytes| Limits { max_bytes: bytes.0 });
    let pool = thread_pool(None)?;
    let read = run(py, &pool, None, |_| {
        let file = VdbFile::open_within(&path, &limits).map_err(IntoPyErr::into_py_err)?;
        let index = match grid {
            Some(name) => find_grid(&file, name),
            None if file.grids().len() == 1 => Ok(0),
            None => find_density_or_level_set(&file, "density", false),
        };
        let index = index.map_err(IntoPyErr::into_py_err)?;
        let summary = &file.grids()[index];
        let bounds = summary.active_bbox;
        if summary.value_type.starts_with("vec") {
            let grid = file.load_vector(index, &limits).map_err(IntoPyErr::into_py_err)?;
            let (dense, index_to_world) = dense(grid, bounds, &limits)?;
            let shape = [&dense.size[..], &[3]].concat();
            Ok((shape, dense.values.into_flattened(), dense.origin, index_to_world))
        } else {
            let grid = file.load_scalar(index, &limits).map_err(IntoPyErr::into_py_err)?;
            let (dense, index_to_world) = dense(grid, bounds, &limits)?;
            Ok((dense.size.to_vec(), dense.values, dense.origin, index_to_world))
        }
    })?;
    let (shape, values, [i, j, k], index_to_world) = read.map_err(|error: PyErr| error)?;
    let array: ArrayD<f32> = to_array(shape, values)?;
    let rows = matrix_rows(index_to_world);
    Ok((PyArray::from_owned_array(py, array), PyArray2::from_vec2(py, &rows)?, (i, j, k)))
}

/// The box of the active voxels, none where there are none.
fn dense<T: Copy + PartialEq + Send + Sync>(
    grid: SparseGrid<T>,
    bounds: Option<IndexBox>,
    limits: &Limits,
) -> PyResult<(DenseBox<T>, DAffine3)> {
    let index_to_world = grid.index_to_world;
    let Some(bounds) = bounds else {
        return Ok((DenseBox { origin: [0; 3], size: [0; 3], values: Vec::new() }, index_to_world));
    };
    let rest = Limits { max_bytes: limits.max_bytes.saturating_sub(grid.memory_bytes()) };
    let dense = grid.to_dense(bounds, &rest).map_err(IntoPyErr::into_py_err)?;
    Ok((dense, index_to_world))
}

/// Writes an array of shape (nx, ny, nz), or (nx, ny, nz, 3) of vectors, as a grid of an OpenVDB file, in place of what was
/// there: voxels that differ from `background` are active. The arguments are as `read_vdb` returns them; `class_` is "fog volume",
/// "level set", "staggered" or "unknown", `compression` "blosc", "zip", "mask" or "none", and `half` stores 16 bits.
#[pyfunction]
#[pyo3(signature = (path, array, index_to_world=None, origin=(0, 0, 0), *, name="density", background=0.0, class_=None,
    compression="blosc", half=false))]
#[allow(clippy::too_many_arguments)]
pub fn write_vdb(
    py: Python<'_>,
    path: PathBuf,
    array: PyArrayLikeDyn<'_, f32, AllowTypeChange>,
    index_to_world: Option<Floats<'_>>,
    origin: (i32, i32, i32),
    name: &str,
    background: f32,
    class_: Option<&str>,
    compression: &str,
    half: bool,
) -> PyResult<()> {
    let index_to_world = index_to_world.as_ref().map_or(Ok(DAffine3::IDENTITY), affine)?;
    let compression = match compression {
        "blosc" => WriteCompression::Blosc,
        "zip" => WriteCompression::Zip,
        "mask" => WriteCompression::ActiveMask,
        "none" => WriteCompression::None,
        _ => {
            return Err(refused(format!(
                "compression: {compression:?} is none of blosc, zip, mask, none"
            )));
        }
    };
    let options = WriteOptions { compression, half };
    let class = class_.map(class_named).transpose()?;
    let origin = [origin.0, origin.1, origin.2];
    let pool = thread_pool(None)?;
    let file = File { path, name, class, index_to_world, options };
    let view = array.as_array();
    // Python may change the array while it is written: values are copied, once.
    match *view.shape() {
        [x, y, z] => {
            let values = view.iter().copied().collect();
            let dense = DenseBox { origin, size: [x, y, z], values };
            run(py, &pool, None, |_| file.put(&dense, background, GridClass::FogVolume))?
        }
        [x, y, z, 3] => {
            let values = view.rows().into_iter().map(|row| [row[0], row[1], row[2]]).collect();
            let dense = DenseBox { origin, size: [x, y, z], values };
            run(py, &pool, None, |_| file.put(&dense, [background; 3], GridClass::Unknown))?
        }
        ref shape => Err(refused(format!(
            "array: of shape {shape:?}, where (nx, ny, nz) or (nx, ny, nz, 3) is wanted"
        ))),
    }
}

/// What is written, but for its values.
struct File<'a> {
    path: PathBuf,
    name: &'a str,
    class: Option<GridClass>,
    index_to_world: DAffine3,
    options: WriteOptions,
}

impl File<'_> {
    fn put<T>(&self, dense: &DenseBox<T>, background: T, class: GridClass) -> PyResult<()>
    where
        T: Copy + PartialEq + Send + Sync,
        for<'a> ValuesToWrite<'a>: From<&'a SparseGrid<T>>,
    {
        let grid = SparseGrid::from_dense(dense, background, self.index_to_world)
            .map_err(IntoPyErr::into_py_err)?;
        let class = self.class.unwrap_or(class);
        let grid = GridToWrite { class, ..GridToWrite::new(self.name, &grid) };
        let written = write_grids(&self.path, &[grid], &self.options);
        written.map(|_| ()).map_err(IntoPyErr::into_py_err)
    }
}

fn class_named(word: &str) -> PyResult<GridClass> {
    match (GridClass::from_word(word), word) {
        (GridClass::Unknown, "unknown") => Ok(GridClass::Unknown),
        (GridClass::Unknown, _) => Err(refused(format!(
            "class_: {word:?} is none of fog volume, level set, staggered, unknown"
        ))),
        (class, _) => Ok(class),
    }
}

/// The four rows of a matrix that maps columns (x, y, z, 1).
fn matrix_rows(map: DAffine3) -> Vec<Vec<f64>> {
    let columns = [map.matrix3.x_axis, map.matrix3.y_axis, map.matrix3.z_axis, map.translation];
    let mut rows: Vec<Vec<f64>> =
        (0..3).map(|row| columns.iter().map(|column| column[row]).collect()).collect();
    rows.push(vec![0.0, 0.0, 0.0, 1.0]);
    rows
}

fn affine(matrix: &Floats<'_>) -> PyResult<DAffine3> {
    let matrix = matrix.as_array();
    if matrix.shape() != [4, 4] {
        let shape = matrix.shape();
        return Err(refused(format!("index_to_world: of shape {shape:?}, where (4, 4) is wanted")));
    }
    let row = |row: usize| [0, 1, 2, 3].map(|column| matrix[[row, column]]);
    if row(3) != [0.0, 0.0, 0.0, 1.0] {
        return Err(refused("index_to_world: its last row is not 0, 0, 0, 1"));
    }
    let column = |c: usize| DVec3::new(matrix[[0, c]], matrix[[1, c]], matrix[[2, c]]);
    Ok(DAffine3::from_cols(column(0), column(1), column(2), column(3)))
}
