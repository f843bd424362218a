//! Light baked into voxels: fluence, and what it makes a medium glow, on the tree of a density grid.
//!
//! At the middle of every active voxel the fluence is \[W/m^2\]
//!
//! ```text
//! Phi = sum over lights of irradiance times transmittance  +  scattered light, from photons
//! ```
//!
//! The first is exact, the second the mean over passes of the lattice or of the k nearest photons. What is scattered
//! from there, were it scattered all ways alike, is an emission of sigma_s Phi / (4 pi) \[W/(m^3 sr)\]: any renderer that can show an
//! emissive volume shows multiple scattering with it. The light that the medium sends out by itself is in the fluence it causes, not in
//! this emission.

mod direct;
mod voxels;

pub use voxels::even_densities;

use std::time::Instant;

use direct::DirectLight;
use rayon::prelude::*;
use voxels::{Voxel, Voxels};

use crate::light::LightChoice;
use crate::math::Rgb;
use crate::medium::vdb::{Limits, SparseGrid};
use crate::medium::{Bounds, Extinction, ISOTROPIC, Medium, MediumExtinction};
use crate::render::lit_lattice::ReadFrom;
use crate::render::passes::pass_seed;
use crate::render::{Gather, LitMedium, Observer, RenderError, RenderReport, Stage, lit_lattice};
use crate::scene::Scene;

/// How light is baked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BakeOptions {
    /// Independent passes of photons, whose mean is taken: at least 1.
    pub passes: u32,
    /// Directions looked at towards each light that has extent, from every voxel: at least 1.
    pub light_samples: usize,
    /// Number of the medium, from 0, that scatters what becomes emission.
    pub medium: usize,
    /// What the grids may take.
    pub limits: Limits,
}

/// Light on the tree of a density grid: the same active voxels, of which each has its own value.
#[derive(Clone, Debug)]
pub struct Baked {
    /// Fluence of direct and scattered light \[W/m^2\], RGB.
    pub fluence: SparseGrid<[f32; 3]>,
    /// In-scattered emission sigma_s / (4 pi) times fluence \[W/(m^3 sr)\], RGB.
    pub emission: SparseGrid<[f32; 3]>,
    /// How it was made.
    pub report: BakeReport,
}

/// Figures of baked light.
#[derive(Clone, Copy, Debug, Default)]
pub struct BakeReport {
    /// Photons, powers and seconds; their `gather` is that of the voxels.
    pub photons: RenderReport,
    /// Voxels with light.
    pub voxel_count: u64,
    /// Mean fluence of these \[W/m^2\].
    pub mean_fluence: Rgb,
    /// Power that the medium scatters, or 4 pi times the emission in all: the integral of sigma_s times fluence \[W\].
    pub scattered: Rgb,
    /// Power that the medium absorbs: the integral of sigma_a times fluence \[W\].
    pub absorbed: Rgb,
}

/// Bakes a scene's light into the active voxels of a grid of densities in the scene's world ([`Scene::load_densities`],
/// [`even_densities`]). Fluence is read from the k nearest photons where the scene says so, else from the lattice. Ends early, but
/// after at least a pass, where the observer asks for it.
///
/// # Errors
/// An infinite medium, no such medium, or more voxels or photons than memory allows.
pub fn bake(
    scene: &Scene,
    densities: &SparseGrid<f32>,
    options: &BakeOptions,
    observer: &dyn Observer,
) -> Result<Baked, RenderError> {
    if matches!(scene.medium.bounds, Bounds::Infinite) {
        return Err(RenderError::InfiniteMedium);
    }
    let number = options.medium;
    let medium = scene.medium.volume(number).ok_or(RenderError::NoSuchMedium { number })?;
    let voxels = Voxels::of(densities, &options.limits)?;
    let report = RenderReport::default();
    let mut baking = Baking { scene, medium, voxels, options, observer, report };
    let fluence = match &scene.medium.extinction {
        MediumExtinction::Uniform(uniform) => baking.fluence(uniform)?,
        MediumExtinction::Chromatic(chromatic) => baking.fluence(chromatic)?,
        MediumExtinction::Grid(grid) => baking.fluence(&**grid)?,
        MediumExtinction::Several(volumes) => baking.fluence(&**volumes)?,
    };
    Ok(baking.finish(fluence))
}

/// Light under way into voxels.
struct Baking<'a> {
    scene: &'a Scene,
    /// The one that scatters.
    medium: &'a Medium,
    voxels: Voxels,
    options: &'a BakeOptions,
    observer: &'a dyn Observer,
    report: RenderReport,
}

impl Baking<'_> {
    /// Fluence of all voxels of all leaves, 0 where they are inactive.
    fn fluence<E: Extinction>(&mut self, extinction: &E) -> Result<Vec<[f32; 3]>, RenderError> {
        let scattered = match self.scene.render.gather {
            Gather::Knn => self.scattered_knn(extinction)?,
            Gather::Auto | Gather::Lattice | Gather::Bounce => {
                self.scattered_lattice(extinction)?
            }
        };
        let mut fluence = scattered;
        let passes = f64::from(self.report.passes_done.max(1));
        let direct = DirectLight {
            scene: self.scene,
            extinction,
            samples: self.options.light_samples.max(1),
            near: self.voxels.ball_radius() / 3.0_f64.sqrt(),
        };
        self.add(&mut fluence, || |voxel: Voxel, sum| direct.fluence(voxel) + sum / passes);
        Ok(fluence)
    }

    /// The sum over passes of what the lattice holds.
    fn scattered_lattice<E: Extinction>(
        &mut self,
        extinction: &E,
    ) -> Result<Vec<[f32; 3]>, RenderError> {
        let Self { scene, observer, .. } = *self;
        let photons = scene.photons.count;
        let total = photons.saturating_mul(u64::from(self.options.passes));
        let resolution = scene.render.lattice;
        let resolution = resolution.unwrap_or_else(|| lit_lattice::resolution::<E>(total));
        let mut emission = lit_lattice::emission(scene, extinction, photons);
        let mut sums = self.voxels.zeros();
        while !self.has_ended() {
            emission.reseed(pass_seed(scene.photons.seed, self.report.passes_done));
            let how = (resolution, ReadFrom::Fluence, LightChoice::All);
            let (report, ball_radius) = (&mut self.report, self.voxels.ball_radius());
            let lattice = lit_lattice::trace(scene, extinction, &emission, how, observer, report)?;
            self.add(&mut sums, || {
                |voxel: Voxel, sum| match scene.medium.bounds.contains(voxel.middle) {
                    // Between cells that were sharpened it may read a little below 0.
                    true => sum + lattice.fluence(voxel.middle, ball_radius).max(Rgb::ZERO),
                    false => sum,
                }
            });
            self.pass_finished();
        }
        Ok(sums)
    }

    /// The sum over passes of what the k nearest photons say.
    fn scattered_knn<E: Extinction>(
        &mut self,
        extinction: &E,
    ) -> Result<Vec<[f32; 3]>, RenderError> {
        let Self { scene, observer, .. } = *self;
        let mut sums = self.voxels.zeros();
        while !self.has_ended() {
            let seed = pass_seed(scene.photons.seed, self.report.passes_done);
            let lit = LitMedium::prepare(scene, extinction, seed, observer, &mut self.report)?;
            self.add(&mut sums, || {
                let mut reader = lit.reader();
                move |voxel: Voxel, sum| match scene.medium.bounds.contains(voxel.middle) {
                    true => sum + reader.estimator().fluence(voxel.middle).value.max(Rgb::ZERO),
                    false => sum,
                }
            });
            self.pass_finished();
        }
        Ok(sums)
    }

    /// Puts `next` of what is there into every active voxel. Every thread has its own.
    fn add<F: FnMut(Voxel, Rgb) -> Rgb>(
        &mut self,
        light: &mut [[f32; 3]],
        next: impl Fn() -> F + Sync,
    ) {
        let started = Instant::now();
        let (voxels, observer) = (&self.voxels, self.observer);
        observer.stage_started(Stage::Gather, voxels.active_count());
        light.par_chunks_mut(voxels::LEAF_LEN).enumerate().for_each_init(
            &next,
            |next, (leaf, light)| {
                let mut done = 0;
                for voxel in voxels.active_of(leaf) {
                    let here = &mut light[voxel.offset];
                    *here = stored(next(voxel, rgb(*here)));
                    done += 1;
                }
                observer.advanced(done);
            },
        );
        observer.stage_finished(Stage::Gather);
        self.report.seconds.gather += started.elapsed().as_secs_f64();
    }

    fn has_ended(&self) -> bool {
        let done = self.report.passes_done;
        done > 0 && (done >= self.options.passes || self.observer.cancelled())
    }

    fn pass_finished(&mut self) {
        self.report.passes_done += 1;
        self.observer.pass_finished(self.report.passes_done, None);
    }

    /// What the fluence makes of the medium.
    fn finish(self, fluence: Vec<[f32; 3]>) -> Baked {
        let Self { medium, voxels, report, .. } = self;
        let mut emission = voxels.zeros();
        // By leaves, added in order: the same for any number of threads.
        let sums: Vec<LeafSums> = emission
            .par_chunks_mut(voxels::LEAF_LEN)
            .enumerate()
            .map(|(leaf, emission)| {
                let mut sums = LeafSums::default();
                for voxel in voxels.active_of(leaf) {
                    let light = rgb(fluence[leaf * voxels::LEAF_LEN + voxel.offset]);
                    let sigma_t = medium.extinction.sigma_t(voxel.middle);
                    let sigma_s = sigma_t * medium.albedo_at(voxel.middle);
                    emission[voxel.offset] = stored(sigma_s * light * ISOTROPIC);
                    sums.fluence += light;
                    sums.scattered += sigma_s * light;
                    sums.absorbed += (sigma_t - sigma_s) * light;
                }
                sums
            })
            .collect();
        let sum = |of: fn(&LeafSums) -> Rgb| sums.iter().map(of).sum::<Rgb>();
        let voxel_count = voxels.active_count();
        let volume = voxels.voxel_volume();
        let report = BakeReport {
            photons: report,
            voxel_count,
            mean_fluence: sum(|leaf| leaf.fluence) / voxel_count.max(1) as f64,
            scattered: sum(|leaf| leaf.scattered) * volume,
            absorbed: sum(|leaf| leaf.absorbed) * volume,
        };
        Baked { fluence: voxels.grid(fluence), emission: voxels.grid(emission), report }
    }
}

/// Sums over the voxels of a leaf.
#[derive(Clone, Copy, Debug, Default)]
struct LeafSums {
    fluence: Rgb,
    scattered: Rgb,
    absorbed: Rgb,
}

fn rgb(light: [f32; 3]) -> Rgb {
    Rgb::from_array(light.map(f64::from))
}

fn stored(light: Rgb) -> [f32; 3] {
    light.as_vec3().to_array()
}
