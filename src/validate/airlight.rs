//! Single scattering of a point light along rays, easy and hard ones: computed without photons, and without bias.

use super::Extent;
use super::check::{Check, Quantity};
use super::stage::{CUBE, ball, fog, one_watt, scene};
use super::truth::AirlightRay;
use crate::math::{DVec3, Ray, Stream};
use crate::render::{LitScene, Unobserved};

pub(super) fn checks(extent: Extent, truth: &[AirlightRay]) -> Vec<Check<'_>> {
    truth.iter().map(|row| along_ray(extent, row)).collect()
}

/// What is missing of an endless medium where a ball of 60 mean free paths stands in for it.
const CUT_OFF: f64 = 1e-4;

fn along_ray(extent: Extent, row: &AirlightRay) -> Check<'_> {
    let exact = Quantity::new(row.name.clone(), row.radiance);
    // One photon, for what is asked needs none.
    Check::new("airlight", vec![exact.within(CUT_OFF)], 1, move |batch| {
        let bounds = match row.medium.as_str() {
            "infinite" => ball((60.0 / row.sigma_t).clamp(11.0, 100.0)),
            _ => CUBE,
        };
        let medium = fog(bounds, row.sigma_t, row.albedo, row.g);
        let mut scene = scene(medium, vec![one_watt(DVec3::from_array(row.light))], batch)?;
        scene.photons.count = 1;
        // The second measurement takes more.
        scene.render.light_samples = extent.pick(2048, 4096) * batch.count as usize;
        let direction = DVec3::from_array(row.dir_unnormalised).normalize();
        let ray = Ray::new(DVec3::from_array(row.origin), direction);
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let end = row.tmax.unwrap_or(f64::INFINITY);
        let seen = lit.reader().radiance(&ray, end, &mut random).single_scatter;
        Ok(vec![seen.x])
    })
}
