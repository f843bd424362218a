//! Plane-parallel slabs: what they reflect and let pass, and the fluence by depth, for light along the normal and for the
//! same radiance from all sides (among them van de Hulst's albedo 0.9, g 0.75, thickness 2).
//!
//! A slab is a box a million times wider than light wanders. Photons scatter on: from every collision one direction is
//! drawn from the phase function, and the transmittance along it is the share that leaves there without another collision.

use std::f64::consts::PI;

use super::Extent;
use super::check::{Batch, Check, Quantity};
use super::error::ValidateError;
use super::kernel::{at_end, centered};
use super::stage::{collided, emission, fog, frame, needle, power, scene, trace};
use super::truth::{SlabFluence, SlabTruth, Truth};
use crate::light::{Light, QuadLight};
use crate::math::{DVec3, Ray, Rgb, Stream};
use crate::medium::{Bounds, Extinction, MediumExtinction};
use crate::scene::Scene;
use crate::trace::Photon;

const GROUP: &str = "slab";

/// Half-width of the box in mean free paths.
const HALF_WIDTH: f64 = 1e6;

/// Far below every share: what passes the thickness that stands in for none.
const CUT_OFF: f64 = 1e-15;

/// How light falls in.
#[derive(Clone, Copy, Debug)]
pub(super) enum Incidence {
    Normal,
    Diffuse,
}

impl Incidence {
    const ALL: [Self; 2] = [Self::Normal, Self::Diffuse];

    fn name(self) -> &'static str {
        match self {
            Self::Normal => "normal",
            Self::Diffuse => "diffuse",
        }
    }

    /// A light of 1 W that shines into the slab at the origin.
    fn light(self) -> Light {
        match self {
            Self::Normal => needle(DVec3::NEG_Z, DVec3::Z, 1e-6),
            Self::Diffuse => {
                let edge = 1e-3;
                let (edge_u, edge_v) = (DVec3::X * edge, DVec3::Y * edge);
                let radiance = Rgb::splat(1.0 / (PI * edge * edge));
                Light::Quad(QuadLight {
                    corner: DVec3::ZERO,
                    edge_u,
                    edge_v,
                    radiance,
                    is_visible: true,
                })
            }
        }
    }
}

/// A slab of fog.
#[derive(Clone, Copy, Debug)]
pub(super) struct Slab {
    /// \[1/m\]
    pub sigma_t: f64,
    /// sigma_s / sigma_t.
    pub albedo: f64,
    /// Mean cosine.
    pub g: f64,
    /// Optical thickness.
    pub tau: f64,
}

impl Slab {
    /// A thickness that lets nothing pass stands in for one without end: 20 diffusion lengths or more.
    fn new(albedo: f64, g: f64, tau: Option<f64>) -> Self {
        let decay = (3.0 * (1.0 - albedo) * (1.0 - albedo * g)).sqrt().min(1.0);
        Self { sigma_t: 1.0, albedo, g, tau: tau.unwrap_or(25.0 / decay + 20.0) }
    }

    fn scene(self, incidence: Incidence, batch: Batch) -> Result<Scene, ValidateError> {
        let half_width = HALF_WIDTH / self.sigma_t;
        let min = DVec3::new(-half_width, -half_width, 0.0);
        let max = DVec3::new(half_width, half_width, self.tau / self.sigma_t);
        let medium = fog(Bounds::Box { min, max }, self.sigma_t, self.albedo, self.g);
        scene(medium, vec![incidence.light()], batch)
    }

    /// Shares of the light that are reflected, that pass, and that escape altogether.
    pub fn shares(self, incidence: Incidence, batch: Batch) -> Result<Vec<f64>, ValidateError> {
        let scene = self.scene(incidence, batch)?;
        let traced = trace(&scene);
        let (reflected, scattered) = next_flights(&scene, self, &traced.photons, batch.seed);
        let passed = scattered + unscattered(&scene);
        Ok(vec![reflected, passed, traced.balance.escaped.x])
    }

    fn name(self, tau: Option<f64>, incidence: Incidence) -> String {
        let tau = tau.map_or("inf".into(), |tau| tau.to_string());
        format!("albedo {}, g {}, tau {tau}, {}", self.albedo, self.g, incidence.name())
    }
}

pub(super) fn checks(extent: Extent, truth: &Truth) -> Vec<Check<'_>> {
    let van_de_hulst = |albedo, g, tau| (albedo, g, tau) == (0.9, 0.75, Some(2.0));
    let of_slabs = truth.slab.iter().filter(move |row| {
        let is_quick = (row.albedo, row.g, row.tau) == (1.0, 0.0, Some(1.0));
        extent.is_full() || is_quick || van_de_hulst(row.albedo, row.g, row.tau)
    });
    let of_depths = truth
        .slab_fluence
        .iter()
        .filter(move |row| extent.is_full() || van_de_hulst(row.albedo, row.g, row.tau));
    let slabs = of_slabs.flat_map(|row| Incidence::ALL.map(|way| shares(extent, row, way)));
    let depths = of_depths.flat_map(|row| Incidence::ALL.map(|way| by_depth(extent, row, way)));
    slabs.chain(depths).collect()
}

/// What is reflected, what passes, and what escapes altogether.
fn shares(extent: Extent, row: &SlabTruth, incidence: Incidence) -> Check<'_> {
    let slab = Slab::new(row.albedo, row.g, row.tau);
    let (reflected, passed) = match incidence {
        Incidence::Normal => (row.reflected_normal, row.passed_normal),
        Incidence::Diffuse => (row.reflected_diffuse, row.passed_diffuse),
    };
    // Long paths are as good as many photons.
    let collisions = if row.albedo < 1.0 {
        (1.0 - reflected - passed) / (1.0 - row.albedo)
    } else {
        2.0 * slab.tau
    };
    let budget = extent.pick(2000.0, 1000.0) * (30.0 / collisions.max(30.0));
    let count = (budget as u64).max(100);
    let name = slab.name(row.tau, incidence);
    let scattered_on = passed - (-slab.tau).exp();
    let is_seen = |share: f64| if share > 0.0 { Check::total(count) * share * 4.0 } else { 1e9 };
    let quantities = vec![
        Quantity::new(format!("{name}: reflected"), reflected).seen_by(is_seen(reflected)),
        Quantity::new(format!("{name}: passed"), passed).give_or_take(CUT_OFF).seen_by(
            match row.albedo {
                0.0 => f64::INFINITY,
                _ => is_seen(scattered_on.max(0.0)),
            },
        ),
        Quantity::new(format!("{name}: escaped"), reflected + passed)
            .seen_by(is_seen(reflected + passed)),
    ];
    Check::new(GROUP, quantities, count, move |batch| slab.shares(incidence, batch))
}

/// Power that leaves below and above after each collision, without another.
fn next_flights(scene: &Scene, slab: Slab, photons: &[Photon], seed: u64) -> (f64, f64) {
    let MediumExtinction::Uniform(extinction) = &scene.medium.extinction else { return (0.0, 0.0) };
    let frame = frame(scene);
    let mut random = Stream::Experiment.random(seed, 1);
    let (mut below, mut above) = (0.0, 0.0);
    for photon in photons {
        let incoming = DVec3::from_array(photon.direction.map(f64::from)).normalize();
        let direction = scene.medium.phase.sample_direction(incoming, &mut random);
        let ray = Ray::new(frame.to_world(photon.position), direction);
        let Some(span) = scene.medium.bounds.intersect(&ray) else { continue };
        let leaving = power(photon) * slab.albedo * extinction.transmittance(&ray, span).x;
        *(if direction.z < 0.0 { &mut below } else { &mut above }) += leaving;
    }
    (below, above)
}

/// Power that passes without any collision.
fn unscattered(scene: &Scene) -> f64 {
    let MediumExtinction::Uniform(extinction) = &scene.medium.extinction else { return 0.0 };
    let emission = emission(scene, extinction);
    let photons = (0..emission.count()).filter_map(|index| emission.photon(index));
    photons
        .map(|photon| {
            let span = scene.medium.bounds.intersect(&photon.ray);
            photon.power.x * span.map_or(1.0, |s| extinction.transmittance(&photon.ray, s).x)
        })
        .sum()
}

/// Fluence by depth: collisions, for sigma_t is 1.
fn by_depth(extent: Extent, row: &SlabFluence, incidence: Incidence) -> Check<'_> {
    let slab = Slab::new(row.albedo, row.g, row.tau);
    let count = extent.pick(3000, 10_000);
    let fluences = match incidence {
        Incidence::Normal => &row.phi_normal,
        Incidence::Diffuse => &row.phi_diffuse,
    };
    let name = slab.name(row.tau, incidence);
    let end = row.tau.unwrap_or(f64::INFINITY);
    let quantity = |(&depth, &phi): (&f64, &f64)| {
        // At the surfaces the fluence falls with a logarithm.
        let (bias, width) = match width(depth, end) {
            Some(width) => (1e-3, 2.0 * width),
            None => (1e-2, SURFACE_LAYER),
        };
        let seen = Check::total(count) * phi * width;
        let of = Quantity::new(format!("{name}: fluence at {depth}"), phi);
        of.within(bias).seen_by(seen)
    };
    let mut quantities: Vec<Quantity> = row.depth.iter().zip(fluences).map(quantity).collect();
    // What does not escape is absorbed: the same photons by another road.
    quantities.push(Quantity::new(format!("{name}: absorbed + escaped"), 1.0));
    Check::new(GROUP, quantities, count, move |batch| {
        let scene = slab.scene(incidence, batch)?;
        let traced = trace(&scene);
        let frame = frame(&scene);
        let at = |depth: f64| {
            let photons = traced.photons.iter();
            let sum = photons.map(|photon| {
                let z = frame.to_world(photon.position).z;
                let weight = match width(depth, end) {
                    Some(width) => centered(z, depth, width),
                    None => at_end((z - depth).abs(), SURFACE_LAYER),
                };
                weight * power(photon)
            });
            sum.sum::<f64>()
        };
        let mut figures: Vec<f64> = row.depth.iter().map(|&depth| at(depth)).collect();
        let absorbed = (1.0 - slab.albedo) * collided(&traced);
        figures.push(absorbed + traced.balance.escaped.x);
        Ok(figures)
    })
}

/// Depth over which the fluence at a surface is read.
const SURFACE_LAYER: f64 = 0.02;

/// Half-width of the layer about a depth; `None` on a surface.
fn width(depth: f64, end: f64) -> Option<f64> {
    let inside = depth.min(end - depth);
    (inside > 0.0).then(|| (0.5 * inside).min(0.3))
}
