//! Extinction from a density grid: sigma_t = density_scale * density, trilinear between voxels.

/// Extinction of a density grid in world space.
#[derive(Debug)]
pub struct GridExtinction {}
