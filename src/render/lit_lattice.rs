//! A medium whose scattered light lies in a lattice.

use std::time::Instant;

use crate::lattice::{CellLight, Cells, Deposit, LatticeShape, LightLattice};
use crate::medium::Extinction;
use crate::render::lit_medium::{scene_emission, trace_settings};
use crate::render::{Observer, RenderError, RenderReport, Stage};
use crate::scene::Scene;
use crate::trace::trace_into;

/// Photons for which a lattice of its own is worth its memory.
const PHOTONS_A_TASK: u64 = 4096;

/// Most lattices filled at once.
const MAX_TASKS: u64 = 4;

/// Photons that leave along one ray through a grid, which costs as much to walk as a dozen photons to follow, and through a
/// uniform medium, where only the way to the ray is saved.
const PHOTONS_A_RAY: [u64; 2] = [16, 4];

/// Emits and traces the photons of one pass into a lattice. Adds to `report`.
///
/// # Errors
/// An infinite medium.
pub fn trace<E: Extinction>(
    scene: &Scene,
    extinction: &E,
    seed: u64,
    observer: &dyn Observer,
    report: &mut RenderReport,
) -> Result<LightLattice, RenderError> {
    let resolution = scene.render.lattice.unwrap_or_else(|| resolution(scene.photons.count));
    let bounds = &scene.medium.bounds;
    let shape = LatticeShape::new(bounds, resolution).ok_or(RenderError::InfiniteMedium)?;
    let mut fill = Fill { scene, extinction, shape: &shape, seed, observer, report };
    Ok(match scene.is_grey() && !E::IS_CHROMATIC {
        true => LightLattice::Grey(fill.cells()),
        false => LightLattice::Colored(fill.cells()),
    })
}

/// What fills a lattice.
struct Fill<'a, E> {
    scene: &'a Scene,
    extinction: &'a E,
    shape: &'a LatticeShape,
    seed: u64,
    observer: &'a dyn Observer,
    report: &'a mut RenderReport,
}

impl<E: Extinction> Fill<'_, E> {
    fn cells<L: CellLight>(&mut self) -> Cells<L> {
        let Self { scene, extinction, shape, seed, observer, report } = self;
        let started = Instant::now();
        let medium = &scene.medium;
        // Photons of one place and direction would go the same way: a glowing medium sends each by its own.
        let photons_a_ray = match medium.emissivity {
            Some(_) => 1,
            None => PHOTONS_A_RAY[usize::from(E::IS_UNIFORM)],
        };
        let emission = scene_emission(scene, *extinction, photons_a_ray, *seed);
        observer.stage_started(Stage::Trace, emission.count());
        let tasks = (emission.count() / PHOTONS_A_TASK).clamp(1, MAX_TASKS);
        let camera = scene.camera.position();
        let deposit = |_| Deposit::<E, L>::new(shape, *extinction, medium.phase, camera);
        let deposits = (0..tasks).map(deposit).collect();
        let settings = trace_settings(scene);
        let advanced = |steps| observer.advanced(steps);
        let (deposits, balance) =
            trace_into(&emission, medium, *extinction, settings, deposits, advanced);
        observer.stage_finished(Stage::Trace);
        report.seconds.trace += started.elapsed().as_secs_f64();
        report.emitted_count += emission.count();
        report.power.average_in(&balance, report.passes_done);

        let started = Instant::now();
        let sums = deposits.into_iter().map(Deposit::into_sums).collect();
        let cells = Cells::from_sums(shape, sums);
        report.seconds.build += started.elapsed().as_secs_f64();
        cells
    }
}

/// Cells along the longest side for a number of photons: interpolation errs as the square of a cell, noise
/// as its inverse root, so that their sum is least where cells shrink with the fifth root of the photons.
fn resolution(photons: u64) -> usize {
    let cells = 64.0 * (photons as f64 / 1.5e5).powf(0.2);
    (cells as usize).clamp(8, 192)
}
