//! A medium whose scattered light lies in a lattice.

use std::time::Instant;

use crate::emission::{Emission, EmissionSettings};
use glam::Vec3A;

use crate::lattice::{
    CameraDeposit, CellLight, Cells, Deposit, DirectedDeposit, Lamps, LatticeShape, LightLattice,
};
use crate::light::LightChoice;
use crate::medium::{Extinction, Phase};
use crate::render::lit_medium::{scene_emission, trace_settings};
use crate::render::{Observer, RenderError, RenderReport, Stage, memory};
use crate::scene::Scene;
use crate::trace::trace_into;

/// Photons for which a lattice of its own is worth its memory.
const PHOTONS_A_TASK: u64 = 4096;

/// Most lattices filled at once.
const MAX_TASKS: u64 = 4;

/// Photons that leave along one ray through a grid, which costs as much to walk as a dozen photons to follow, and through a
/// uniform medium, where only the way to the ray is saved.
const PHOTONS_A_RAY: [u64; 2] = [8, 4];

/// Fewer photons than this do not share rays: their number is exact.
const FEWEST_TO_SHARE: u64 = 4096;

/// The photons of a pass.
pub fn emission<'a, E: Extinction>(scene: &'a Scene, extinction: &E, photons: u64) -> Emission<'a> {
    // Photons of one place and direction would go the same way: a glowing medium sends each by its own.
    let photons_a_ray = match scene.medium.emissivity {
        None if photons >= FEWEST_TO_SHARE => PHOTONS_A_RAY[usize::from(E::IS_UNIFORM)],
        _ => 1,
    };
    let settings = EmissionSettings {
        kind: scene.photons.emission,
        count: photons,
        photons_per_ray: photons_a_ray,
        seed: scene.photons.seed,
    };
    scene_emission(scene, extinction, settings)
}

/// Who reads a lattice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ReadFrom {
    /// The camera alone.
    Camera,
    /// Places all over the medium, in any direction.
    Anywhere,
    /// Places all over the medium, for light from all directions alike: [`LightLattice::fluence`].
    Fluence,
}

/// Traces the photons of one pass, of the chosen lights, into a lattice. Adds to `report`.
///
/// # Errors
/// An infinite medium, or no room for the cells.
pub fn trace<E: Extinction>(
    scene: &Scene,
    extinction: &E,
    emission: &Emission,
    (resolution, from, choice): (usize, ReadFrom, LightChoice),
    observer: &dyn Observer,
    report: &mut RenderReport,
) -> Result<LightLattice, RenderError> {
    let bounds = &scene.medium.bounds;
    let shape = LatticeShape::new(bounds, resolution).ok_or(RenderError::InfiniteMedium)?;
    let lamps = Lamps::of(&scene.lights, choice, bounds, shape.cell_edge());
    let shape = shape.with_lamps(lamps);
    let mut fill = Fill { scene, extinction, emission, shape: &shape, observer, report };
    let is_grey = scene.is_grey() && !E::IS_CHROMATIC;
    // What scatters all ways alike is the same from anywhere.
    let is_directed = from == ReadFrom::Anywhere && !scene.medium.phase.is_isotropic();
    let phase = if from == ReadFrom::Fluence { Phase::Isotropic } else { scene.medium.phase };
    Ok(match (is_grey, is_directed) {
        (true, false) => LightLattice::Grey(fill.towards_camera::<f32>(phase)?),
        (false, false) => LightLattice::Colored(fill.towards_camera::<Vec3A>(phase)?),
        (true, true) => LightLattice::DirectedGrey(
            fill.levels(|| DirectedDeposit::<E, f32>::new(&shape, extinction))?,
        ),
        (false, true) => LightLattice::DirectedColored(
            fill.levels(|| DirectedDeposit::<E, Vec3A>::new(&shape, extinction))?,
        ),
    })
}

/// What fills a lattice.
struct Fill<'a, E> {
    scene: &'a Scene,
    extinction: &'a E,
    emission: &'a Emission<'a>,
    shape: &'a LatticeShape,
    observer: &'a dyn Observer,
    report: &'a mut RenderReport,
}

impl<E: Extinction> Fill<'_, E> {
    fn towards_camera<L: CellLight>(&mut self, phase: Phase) -> Result<[Cells<L>; 2], RenderError> {
        let (shape, extinction) = (self.shape, self.extinction);
        let camera = self.scene.camera.position();
        self.levels(|| CameraDeposit::<E, L>::new(shape, extinction, phase, camera))
    }

    fn levels<D: Deposit>(
        &mut self,
        deposit: impl Fn() -> D,
    ) -> Result<[Cells<D::Cell>; 2], RenderError> {
        let Self { scene, extinction, emission, shape, observer, report } = self;
        let started = Instant::now();
        let medium = &scene.medium;
        let tasks = (emission.chosen_count() / PHOTONS_A_TASK).clamp(1, MAX_TASKS);
        check_memory::<D::Cell>(shape.cell_count(), tasks)?;
        observer.stage_started(Stage::Trace, emission.chosen_count());
        let deposits = (0..tasks).map(|_| deposit()).collect();
        let settings = trace_settings(scene);
        let advanced = |steps| observer.advanced(steps);
        let (deposits, balance) =
            trace_into(emission, medium, *extinction, settings, deposits, advanced);
        observer.stage_finished(Stage::Trace);
        report.seconds.trace += started.elapsed().as_secs_f64();
        report.emitted_count += emission.chosen_count();
        report.power.average_in(&balance, report.passes_done);

        let started = Instant::now();
        let sums = deposits.into_iter().map(Deposit::into_sums).collect();
        let fine = Cells::from_sums(shape, sums);
        let coarse = fine.coarser();
        report.seconds.build += started.elapsed().as_secs_f64();
        Ok([fine.sharpened(), coarse.sharpened()])
    }
}

/// Refuses cells that memory has no room for: of every task, sharpened, and those twice as long.
fn check_memory<L>(cells: usize, tasks: u64) -> Result<(), RenderError> {
    let bytes = (tasks + 2) * (cells * size_of::<L>()) as u64;
    let what = || format!("a lattice of {cells} cells");
    memory::check(bytes, what, "take fewer (--lattice), or a larger --target-error")
}

/// The finest lattice: 150 million cells.
pub const MAX_RESOLUTION: usize = 512;

/// Cells along the longest side for a number of photons in all: interpolation errs as the square of a cell, noise
/// as its inverse root, so that their sum is least where cells shrink with the fifth root of the photons. Light varies more
/// in a grid than in a uniform medium.
pub fn resolution<E: Extinction>(photons: u64) -> usize {
    let cells = if E::IS_UNIFORM { 24.0 } else { 36.0 };
    let cells = cells * (photons as f64 / 1.5e5).powf(0.2);
    (cells as usize).clamp(8, MAX_RESOLUTION)
}
