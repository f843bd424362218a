//! Extinction that vanishes or is enormous, albedo 0 and 1, and transmittances below the smallest number.

use super::super::check::{Check, Quantity};
use super::super::error::ValidateError;
use super::super::report::Row;
use super::super::slab::{Incidence, Slab};
use super::super::stage::{
    CUBE, ball, collided, fog, one_watt, passing_ray, scene, trace, white_sky,
};
use super::{FEW, noisy};
use crate::math::{DVec3, Ray, Rgb, Span, Stream};
use crate::medium::{Extinction, Flight, UniformExtinction};
use crate::render::{LitScene, Unobserved};

const VANISHING: &str = "sigma_t -> 0";
const ENORMOUS: &str = "sigma_t = 1e4";
const ENDS: &str = "albedo 0 and 1";
const UNDERFLOW: &str = "exp underflow, log 0";

pub(super) fn rows() -> Result<Vec<Row>, ValidateError> {
    let mut rows = vanishing()?;
    rows.extend(enormous()?);
    rows.extend(albedo_at_its_ends()?);
    rows.extend(underflow());
    Ok(rows)
}

fn vanishing() -> Result<Vec<Row>, ValidateError> {
    let ray = Ray::new(DVec3::new(0.3, 0.2, -5.0), DVec3::Z);
    let forever = Span::new(0.0, f64::INFINITY);
    let mut rows = Vec::new();
    let thin = UniformExtinction { sigma_t: 1e-9 };
    let opacity = thin.opacity(&ray, Span::new(0.0, 1.0), Rgb::ONE);
    rows.push(Row::exact(VANISHING, "opacity of depth 1e-9", 1e-9 - 5e-19, opacity, 1e-24));
    let empty = UniformExtinction { sigma_t: 0.0 };
    let passes = |u| empty.invert_flight(&ray, forever, Rgb::ONE, u);
    let escapes = [0.0, 0.5, 1.0 - f64::EPSILON].map(passes);
    let all = escapes.iter().all(|flight| *flight == Flight::Escape { weight: Rgb::ONE });
    rows.push(Row::holds(VANISHING, "no collision on an endless ray where sigma_t is 0", all));
    let depth = empty.optical_depth(&ray, forever).x;
    rows.push(Row::exact(VANISHING, "depth of an endless ray there", 0.0, depth, 0.0));
    // Light scattered once grows as sigma_t does; the random numbers are the same.
    let seen = |sigma_t: f64| {
        let scene = scene(fog(CUBE, sigma_t, 0.9, 0.0), vec![one_watt(DVec3::ZERO)], FEW)?;
        let stored = trace(&scene).photons.iter().any(|photon| !photon.power[0].is_finite());
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut random = Stream::Experiment.random(0, 0);
        let seen = lit.reader().radiance(&ray, f64::INFINITY, &mut random);
        Ok::<_, ValidateError>((seen, stored))
    };
    let (unit, _) = seen(1e-9)?;
    for sigma_t in [1e-30, 1e-300] {
        let (light, is_broken) = seen(sigma_t)?;
        let ratio = light.single_scatter.x / sigma_t / (unit.single_scatter.x / 1e-9);
        rows.push(Row::exact(VANISHING, format!("{sigma_t:e}: light is linear"), 1.0, ratio, 1e-6));
        let transmittance = light.transmittance.x;
        rows.push(Row::exact(VANISHING, format!("{sigma_t:e}: T"), 1.0, transmittance, 0.0));
        let is_finite = light.multiple_scatter.is_finite() && !is_broken;
        rows.push(Row::holds(VANISHING, format!("{sigma_t:e}: photons are finite"), is_finite));
    }
    let (light, _) = seen(0.0)?;
    let scattered = light.single_scatter.x + light.multiple_scatter.x;
    rows.push(Row::exact(VANISHING, "0: scattered light", 0.0, scattered, 0.0));
    rows.push(Row::exact(VANISHING, "0: T", 1.0, light.transmittance.x, 0.0));
    Ok(rows)
}

fn enormous() -> Result<Vec<Row>, ValidateError> {
    // Chandrasekhar's H function: the reflectance of a half-space of albedo 0.9.
    let slab = Slab { sigma_t: 1e4, albedo: 0.9, g: 0.0, tau: 1e4 };
    let quantities = vec![
        Quantity::new(
            "slab of 1 m, albedo 0.9: reflected as by a half-space",
            0.414_947_479_130_817,
        ),
        Quantity::new("slab of 1 m, albedo 0.9: passed", 0.0),
    ];
    let reflection =
        Check::new(ENORMOUS, quantities, 2000, move |batch| slab.shares(Incidence::Normal, batch));
    let of_furnace = Quantity::new("ball of 1 mm: white furnace", 1.0).within(0.01);
    let furnace = Check::new(ENORMOUS, vec![of_furnace], 2000, |batch| {
        let mut scene = scene(fog(ball(1e-3), 1e4, 1.0, 0.0), vec![white_sky()], batch)?;
        scene.render.photons_only = true;
        scene.estimate.k = 50;
        let lit = LitScene::prepare(&scene, &Unobserved)?;
        let mut reader = lit.reader();
        let mut random = Stream::Experiment.random(batch.seed, 0);
        let mut seen = |step: i32| {
            let ray = passing_ray(2e-5 * f64::from(step), 0.01, &mut random);
            let light = reader.radiance(&ray, f64::INFINITY, &mut random);
            light.single_scatter.x + light.multiple_scatter.x + light.emission.x
        };
        Ok(vec![(0..30).map(&mut seen).sum::<f64>() / 30.0])
    });
    let mut rows = noisy(&[reflection, furnace])?;
    let mut scene = scene(fog(ball(1e-3), 1e4, 1.0, 0.0), vec![one_watt(DVec3::ZERO)], FEW)?;
    scene.photons.max_order = 10;
    let balance = trace(&scene).balance;
    let kept = (balance.escaped + balance.truncated + balance.absorbed).x / balance.emitted.x;
    rows.push(Row::exact(ENORMOUS, "cut at order 10: escaped + cut off", 1.0, kept, 1e-12));
    let is_told = balance.truncated.x > 0.1;
    rows.push(Row::holds(ENORMOUS, "cut at order 10: what is cut off is counted", is_told));
    Ok(rows)
}

fn albedo_at_its_ends() -> Result<Vec<Row>, ValidateError> {
    let light = || vec![one_watt(DVec3::new(0.2, 0.1, -0.3))];
    let black = trace(&scene(fog(CUBE, 1.5, 0.0, 0.5), light(), FEW)?);
    let white = trace(&scene(fog(CUBE, 1.5, 1.0, 0.5), light(), FEW)?);
    let scattered = black.photons.iter().filter(|photon| photon.order > 0).count() as f64;
    let lost = black.balance.absorbed.x;
    let left = white.balance.escaped.x / white.balance.emitted.x;
    Ok(vec![
        Row::exact(ENDS, "0: photons that scattered", 0.0, scattered, 0.0),
        Row::exact(ENDS, "0: collided over absorbed", 1.0, collided(&black) / lost, 1e-6),
        Row::exact(ENDS, "1: absorbed", 0.0, white.balance.absorbed.x, 0.0),
        Row::exact(ENDS, "1: escaped over emitted", 1.0, left, 1e-12),
    ])
}

fn underflow() -> Vec<Row> {
    let ray = Ray::new(DVec3::ZERO, DVec3::X);
    let transmittance = |depth: f64| {
        UniformExtinction { sigma_t: depth }.transmittance(&ray, Span::new(0.0, 1.0)).x
    };
    let flight = |u: f64| {
        let extinction = UniformExtinction { sigma_t: 1.0 };
        match extinction.invert_flight(&ray, Span::new(0.0, f64::INFINITY), Rgb::ONE, u) {
            Flight::Collision { distance, .. } => distance,
            Flight::Escape { .. } => f64::INFINITY,
        }
    };
    let last = 1.0 - 0.5 * f64::EPSILON;
    vec![
        Row::exact(UNDERFLOW, "T of depth 1000", 0.0, transmittance(1e3), 0.0),
        Row::exact(UNDERFLOW, "T of an infinite depth", 0.0, transmittance(f64::INFINITY), 0.0),
        // f32 has no such number.
        Row::exact(UNDERFLOW, "-ln T of depth 200", 200.0, -transmittance(200.0).ln(), 1e-12),
        Row::exact(UNDERFLOW, "shortest flight", 0.0, flight(0.0), 0.0),
        Row::exact(UNDERFLOW, "longest flight", 53.0 * std::f64::consts::LN_2, flight(last), 1e-12),
    ]
}
