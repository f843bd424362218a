//! A scene a million times smaller, larger, or a million times its size away, makes the same image; so does one as small as an atom or as large
//! as a nebula.

use crate::grid_support::cloud;
use crate::transport_support::*;
use photonvdb::camera::Camera;
use photonvdb::film::{Film, RgbImage, compare};
use photonvdb::light::{DirectionalLight, Light, PointLight, QuadLight, SphereLight, SpotLight};
use photonvdb::math::{DAffine3, DVec3, Rgb};
use photonvdb::medium::{Bounds, Medium};
use photonvdb::render::{Gather, RenderOptions, Unobserved, render};
use photonvdb::scene::{RenderSettings, Scene};

/// Where a scene of size 1 about the origin is put.
#[derive(Clone, Copy, Debug)]
struct Place {
    scale: f64,
    shift: DVec3,
}

impl Place {
    fn point(self, x: f64, y: f64, z: f64) -> DVec3 {
        DVec3::new(x, y, z) * self.scale + self.shift
    }

    /// Intensities grow with the square of the distances, so that irradiances are the same.
    fn lights(self) -> Vec<Light> {
        let intensity = Rgb::ONE * (self.scale * self.scale);
        let position = self.point(-3.0, 1.5, 0.5);
        vec![
            Light::Point(PointLight { position: self.point(0.3, 0.4, 0.2), intensity }),
            Light::Spot(SpotLight {
                position,
                axis: (self.point(0.0, 0.0, 0.0) - position).normalize(),
                intensity: intensity * 30.0,
                cone_angle: 0.2,
                falloff_angle: 0.1,
            }),
            Light::Directional(DirectionalLight {
                direction: DVec3::new(0.6, -0.48, 0.64),
                irradiance: Rgb::ONE,
            }),
            Light::Quad(QuadLight {
                corner: self.point(-1.0, 2.0, -1.0),
                edge_u: DVec3::X * self.scale,
                edge_v: DVec3::Z * self.scale,
                radiance: Rgb::ONE,
                is_visible: true,
            }),
            Light::Sphere(SphereLight {
                center: self.point(1.5, 0.5, 1.2),
                radius: 0.3 * self.scale,
                radiance: Rgb::ONE,
                is_visible: true,
            }),
            white_sky(),
        ]
    }

    fn image(self, medium: Medium, gather: Gather) -> Film {
        let (position, middle) = (self.point(2.2, 1.8, 4.2), self.point(0.0, 0.0, 0.0));
        let lights = self.lights();
        let camera = Camera::look_at(position, middle, DVec3::Y, 0.66, [24, 24]).unwrap();
        let base = scene(medium, white_sky(), 20_000);
        let settings = RenderSettings { gather, ..base.render };
        let scene = Scene { camera, lights, render: settings, ..base };
        render(&scene, &RenderOptions::passes(1), &Unobserved).unwrap().film
    }

    fn medium(self, kind: usize) -> Medium {
        let (min, max) = (self.point(-1.0, -1.0, -1.0), self.point(1.0, 1.0, 1.0));
        let cube = Bounds::Box { min, max };
        let ball = Bounds::Sphere { center: self.point(0.0, 0.0, 0.0), radius: self.scale };
        match kind {
            0 => grey_fog(cube, 1.5 / self.scale, 0.9, 0.4),
            1 => fog(ball, Rgb::new(0.5, 1.0, 2.0) / self.scale, Rgb::splat(0.9), 0.0),
            _ => {
                let place = DAffine3::from_scale(DVec3::splat(0.1 * self.scale));
                let place = DAffine3::from_translation(self.shift) * place;
                grid_medium(cloud(10).extinction(place, 4.0 / self.scale), Rgb::splat(0.9), 0.3)
            }
        }
    }
}

#[test]
fn size_and_place_do_not_matter() {
    let home = Place { scale: 1.0, shift: DVec3::ZERO };
    let places = [
        Place { scale: 1e-6, ..home },
        Place { scale: 1e6, ..home },
        Place { shift: DVec3::new(1e6, -1e6, 5e5), ..home },
        Place { scale: 1e6, shift: DVec3::splat(1e12) },
        Place { scale: 1e-13, ..home },
        Place { scale: 1e16, ..home },
    ];
    let cases = (0..3).flat_map(|kind| [(kind, Gather::Knn), (kind, Gather::Lattice)]);
    for (kind, gather) in cases {
        let expected = RgbImage::from(&home.image(home.medium(kind), gather));
        for place in places {
            let image = RgbImage::from(&place.image(place.medium(kind), gather));
            let error = compare(&image, &expected).unwrap();
            println!("medium {kind}, {gather:?}, {place:?}: {error:?}");
            assert!(error.rel_rmse < 1e-4, "medium {kind}, {gather:?}, {place:?}: {error:?}");
        }
    }
}
