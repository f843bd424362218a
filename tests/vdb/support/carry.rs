//! Whatever the bytes are: reads all there is, and carries every density as far as a ray.

use photonvdb::math::{DVec3, Ray, Span};
use photonvdb::medium::grid::{DensityGrid, GridExtinction};
use photonvdb::medium::vdb::{Limits, SparseGrid, VdbFile, VolumeSource, sanitize_density};
use photonvdb::medium::{Bounds, Extinction};

/// Reads every grid of the file, sanitises it, builds its sampling structure and sends a ray through. Says how many
/// grids could be read. Panics at what must not happen.
pub fn carry(bytes: &[u8], limits: &Limits) -> usize {
    let Ok(file) = VdbFile::from_bytes(bytes.to_vec()) else {
        return 0;
    };
    #[cfg(feature = "vdb-rs")]
    compare(&file, bytes, limits);
    let can_read = |index: &usize| {
        let is_vector = file.load_vector(*index, limits).is_ok();
        let scalar = file.load_scalar(*index, limits);
        let is_scalar = scalar.is_ok();
        scalar.into_iter().for_each(|grid| trace(grid, limits));
        is_vector || is_scalar
    };
    (0..file.grids().len()).filter(can_read).count()
}

fn trace(mut grid: SparseGrid<f32>, limits: &Limits) {
    assert_eq!(grid.values.len(), 512 * grid.leaves.len());
    assert_eq!(grid.masks.len(), grid.leaves.len());
    assert!(grid.values.len() * 4 + grid.tiles.len() * 24 <= limits.max_bytes as usize);
    assert!(grid.leaves.iter().flatten().all(|along| along % 8 == 0));
    sanitize_density(&mut grid);

    let densities = DensityGrid::from_sparse(&grid);
    let Some((lower, upper)) = densities.render_bounds() else { return };
    for share in [0.0, 0.3, 0.5, 1.0] {
        let density = densities.density(lower + share * (upper - lower));
        assert!(density >= 0.0 && density.is_finite());
    }
    let extinction = GridExtinction::new(densities, grid.index_to_world, 1.0);
    let Some(Bounds::Parallelepiped(bounds)) = extinction.bounds() else { return };
    let diagonal: DVec3 = bounds.edges().into_iter().sum();
    let Some(direction) = diagonal.try_normalize() else { return };
    let ray = Ray::new(bounds.corner(), direction);
    // May be infinite or NaN where the transform is next to infinite.
    let depth = extinction.optical_depth(&ray, Span::new(0.0, diagonal.length())).x;
    assert!(depth.is_nan() || depth >= 0.0, "{depth}");
}

/// What `vdb-rs` reads of it must be the same.
#[cfg(feature = "vdb-rs")]
fn compare(file: &VdbFile, bytes: &[u8], limits: &Limits) {
    use photonvdb::medium::vdb::VdbRsFile;
    let second = VdbRsFile::from_bytes(bytes.to_vec()).expect("listed by the same reader");
    for index in 0..file.grids().len() {
        let Ok(second) = second.load_scalar(index, limits) else { continue };
        let grid = file.load_scalar(index, limits).expect("read through before");
        assert_eq!(grid.leaves, second.leaves);
        assert_eq!(grid.masks, second.masks);
        assert_eq!(grid.tiles.len(), second.tiles.len());
        let same = |(a, b): (&f32, &f32)| a == b || (a.is_nan() && b.is_nan());
        assert!(grid.values.iter().zip(&second.values).all(same));
    }
}
