//! Volumetric photon mapping of homogeneous and OpenVDB media.
//!
//! ```text
//! scene ──▶ emission ──▶ trace ──▶ map ──▶ estimate ──▶ render ──▶ film
//!   │  light, medium         │
//!   └────────────────────────┘
//! ```
//!
//! Each stage has its own type, and the next one takes only that:
//!
//! | stage | from | to |
//! |---|---|---|
//! | [`scene`] | a scene file and the files it names | [`Scene`](scene::Scene): camera, [`Medium`](medium::Medium), [`Light`](light::Light)s |
//! | [`scene`] | a scene | [`Plan`](scene::Plan): what it needs of the program, and nothing more |
//! | [`emission`] | lights | [`EmittedPhoton`](emission::EmittedPhoton): ray, power, first free flight |
//! | [`trace`] | emitted photons | [`Photon`](trace::Photon): place, direction of travel, power, order of a collision |
//! | [`map`] | photons | [`PhotonMap`](map::PhotonMap): a tree over their places |
//! | [`estimate`] | the map | [`Estimate`](estimate::Estimate): power density, fluence; light scattered towards a direction |
//! | [`render`] | camera rays and estimates | [`Film`](film::Film): radiance by origin, transmittance |
//! | [`lab`] | models and experiments | what estimates get wrong: exact and measured bias and variance |
//! | [`reference`](mod@crate::reference) | a scene | the same image without photons, by a path tracer whose mean is exact |
//! | [`validate`] | exact answers of radiative transfer | what the renderer measures of them |
//! | [`film`] | the film | an OpenEXR image with its layers, a PNG preview |
//!
//! [`medium`] knows how light is attenuated and scattered, and reads and writes OpenVDB files ([`medium::vdb`]); [`light`] knows
//! how strongly a place is lit; [`camera`] makes rays; [`math`] holds what all share.
//!
//! # From a scene file to pixels
//!
//! [`SceneFile`](scene::SceneFile) documents every key of a scene file.
//!
//! ```
//! use photonvdb::render::{RenderOptions, Unobserved, render};
//! use photonvdb::scene::{Overrides, Scene};
//!
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! let draft = Overrides {
//!     photons: Some(10_000),
//!     resolution: Some([16, 16]),
//!     ..Overrides::default()
//! };
//! let scene = Scene::load_with("examples/scenes/fog_spot.toml".as_ref(), &draft)?;
//! let rendering = render(&scene, &RenderOptions::passes(1), &Unobserved)?;
//! let middle = rendering.film.pixels[8 * 16 + 8];
//! assert!(middle.radiance().min_element() > 0.0);
//! assert!(middle.alpha() > 0.0 && middle.alpha() < 1.0);
//! # Ok(())
//! # }
//! ```
//!
//! # In a host renderer
//!
//! A [`LitScene`](render::LitScene) is a scene with its photon map. Each thread takes a
//! [`LightReader`](render::LightReader) of its own and asks for the light along a segment of a ray, and its
//! transmittance. `examples/03_host_renderer.rs` composites surfaces of its own that way.
//!
//! # Conventions
//!
//! SI units; right-handed world space; linear RGB with Rec.709 primaries; radians in code, degrees in files. A stored
//! photon's direction is its direction of travel, its power that before the albedo. Equal seeds give equal
//! results, byte for byte, for any number of threads.
//!
//! # Features
//!
//! - `vdb-rs` (off): `medium::vdb::VdbRsFile`, which has the public crate `vdb-rs` read the grids it reads right. Needs a C
//!   compiler. The built-in [`VdbFile`](medium::vdb::VdbFile) reads these and all others.

pub mod camera;
pub mod emission;
pub mod estimate;
pub mod files;
pub mod film;
pub mod lab;
pub mod lattice;
pub mod light;
pub mod map;
pub mod math;
pub mod medium;
pub mod reference;
pub mod render;
pub mod scene;
pub mod trace;
pub mod validate;
