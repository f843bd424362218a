//! Every key of a scene file, section by section, in the order in which a file is written.
//!
//! `tests/scene/schema/` holds these tables against the reader (`scene/file/`): its keys, words, defaults and limits.

use super::key::{
    ANY, Key, Kind, Limits, POSITIVE, POSITIVE_OR_0, Repeats, SHARE, Section, Variant, key, kind,
    only,
};

/// Every section of a scene file.
pub(super) const SECTIONS: [&Section; 6] = [&CAMERA, &MEDIUM, &LIGHT, &PHOTONS, &ESTIMATE, &RENDER];

/// Sections that must be there.
pub(super) const REQUIRED: [&str; 2] = ["camera", "medium"];

const POINT: Kind = Kind::Numbers(3);

const CAMERA: Section = Section {
    path: "camera",
    about: "Where the image is taken from: a pinhole, which may stand inside the medium.",
    repeats: Repeats::Never,
    variants: &[only(&[
        key("position", POINT, "the pinhole").unit("m"),
        key("look_at", POINT, "a point in the middle of the image")
            .unit("m")
            .rule("not `position`"),
        key("up", POINT, "direction that the image shows upright")
            .or("[0, 1, 0]")
            .rule("not along the view"),
        key(
            "vertical_fov",
            Kind::Number(Limits {
                min: Some(0.0),
                max: Some(180.0),
                open_min: true,
                open_max: true,
            }),
            "full angle over the image height",
        )
        .unit("degrees")
        .or("35"),
        key("resolution", Kind::Pair(1, 16384), "width, height; row 0 is the top")
            .unit("pixels")
            .or("[640, 360]")
            .rule("together at most 2^25"),
    ])],
};

const PRESET: Key = key(
    "preset",
    Kind::Preset,
    "a known medium, which fills in extinction, `albedo` and `phase` where they are not given; `photonvdb presets` lists them",
)
.or_else("none");

const PHASE_KEY: Key =
    key("phase", Kind::Table(&PHASE), "where scattered light goes").or_else("isotropic");

const ALBEDO: Key =
    key("albedo", Kind::OneOrThree(SHARE), "sigma_s / sigma_t, one number or RGB").unless("preset");

const MEDIUM: Section = Section {
    path: "medium",
    about: "What scatters and absorbs. All it is surrounded by is empty space, of the same refractive index.",
    repeats: Repeats::Allowed,
    variants: &[
        kind(
            "homogeneous",
            "The same everywhere inside bounds.",
            &[
                PRESET,
                key("bounds", Kind::Table(&BOUNDS), "where it is"),
                key("sigma_t", Kind::OneOrThree(POSITIVE_OR_0), "extinction, one number or RGB")
                    .unit("1/m")
                    .unless("preset"),
                ALBEDO,
                PHASE_KEY,
            ],
        ),
        kind(
            "vdb",
            "Extinction from a density grid of an OpenVDB file: sigma_t = `density_scale` times its value.",
            &[
                PRESET,
                key("file", Kind::Path, "an OpenVDB file, relative to the scene file"),
                key("density", Kind::Text, "name of the density grid")
                    .or_else("`density`, else the only float grid"),
                key("density_scale", Kind::Number(POSITIVE_OR_0), "extinction of value 1")
                    .unit("1/m per grid value")
                    .or("1"),
                key("sdf_to_fog", Kind::Boolean, "fill a level set with fog: density 0 on its surface, 1 at depth")
                    .or("false"),
                key("precision", Kind::Word(&["single", "half"]), "floats in which densities are kept")
                    .or("\"single\""),
                Key { default: super::key::Default::Unless("color or preset"), ..ALBEDO },
                key(
                    "color",
                    Kind::Text,
                    "name of a grid of vectors (linear RGB): the albedo is `albedo`, then 1 by default, times its value",
                )
                .or_else("none"),
                PHASE_KEY,
                key("temperature", Kind::Text, "name of a grid of numbers: heat glows as a blackbody")
                    .or_else("none"),
                key("temperature_scale", Kind::Number(POSITIVE_OR_0), "kelvin = `temperature_offset` + this times the value")
                    .unit("K per grid value")
                    .or("1")
                    .needs(&["temperature"]),
                key("temperature_offset", Kind::Number(ANY), "273.15 for grids in degrees Celsius")
                    .unit("K")
                    .or("0")
                    .needs(&["temperature"]),
                key("flame", Kind::Text, "name of a grid of numbers: flames glow whether or not they absorb")
                    .or_else("none"),
                key("flame_color", Kind::OneOrThree(POSITIVE_OR_0), "emissivity of value 1; the default has the colour of 1900 K")
                    .unit("W/(m^3 sr) per grid value")
                    .or("[1, 0.23, 0]")
                    .needs(&["flame"]),
                key("emission_scale", Kind::Number(POSITIVE_OR_0), "factor on both, as a camera's exposure would be")
                    .or("1")
                    .needs(&["temperature", "flame"]),
                key("transform", Kind::Table(&TRANSFORM), "from the file's world to the scene's").or_else("none"),
            ],
        ),
    ],
};

const BOUNDS: Section = Section {
    path: "medium.bounds",
    about: "Where a homogeneous medium is: a box, a ball, or the word `infinite`, for experiments (a render of it is refused).",
    repeats: Repeats::Never,
    variants: &[
        Variant {
            about: "An axis-aligned box.",
            ..only(&[
                key("min", POINT, "lowest corner").unit("m"),
                key("max", POINT, "highest corner").unit("m").rule("above `min` on every axis"),
            ])
        },
        Variant {
            about: "A ball.",
            ..only(&[
                key("center", POINT, "its centre").unit("m"),
                key("radius", Kind::Number(POSITIVE), "its radius").unit("m"),
            ])
        },
        Variant { about: "No bounds.", word: Some("infinite"), ..only(&[]) },
    ],
};

const PHASE: Section = Section {
    path: "medium.phase",
    about: "The phase function: where scattered light goes.",
    repeats: Repeats::Never,
    variants: &[
        Variant { is_default: true, ..kind("isotropic", "All ways alike.", &[]) },
        kind(
            "henyey-greenstein",
            "Forward or backward, as Henyey and Greenstein have it.",
            &[key("g", COSINE, "mean cosine; above 0 is forward")],
        ),
        kind(
            "double-henyey-greenstein",
            "Two lobes of Henyey and Greenstein.",
            &[
                key("g1", COSINE, "mean cosine of the first lobe"),
                key("g2", COSINE, "mean cosine of the second lobe"),
                key("weight", Kind::Number(SHARE), "share of the first lobe"),
            ],
        ),
        kind(
            "draine",
            "Henyey and Greenstein's times 1 + alpha cos^2, as Draine has it: Rayleigh's with g = 0, alpha = 1.",
            &[
                key("g", COSINE, "above 0 is forward"),
                key("alpha", Kind::Number(POSITIVE_OR_0), "weight of cos^2"),
            ],
        ),
        kind(
            "droplets",
            "The water droplets of fog and clouds: Jendersie and d'Eon's fit to Mie theory (2023).",
            &[key(
                "diameter_um",
                Kind::Number(Limits { min: Some(5.0), max: Some(50.0), ..ANY }),
                "diameter of the droplets",
            )
            .unit("micrometres")],
        ),
    ],
};

const COSINE: Kind =
    Kind::Number(Limits { min: Some(-1.0), max: Some(1.0), open_min: true, open_max: true });

const TRANSFORM: Section = Section {
    path: "medium.transform",
    about: "Moves a volume after the file's own transform. Steps or a matrix.",
    repeats: Repeats::Never,
    variants: &[
        Variant {
            about: "Steps.",
            ..only(&[
                key("scale", Kind::OneOrThree(ANY), "applied first").or("1").rule("not 0"),
                key("rotate", POINT, "about the fixed x axis first, then y, then z")
                    .unit("degrees")
                    .or("[0, 0, 0]"),
                key("translate", POINT, "applied last").unit("m").or("[0, 0, 0]"),
            ])
        },
        Variant {
            about: "A matrix.",
            ..only(&[key(
                "matrix",
                Kind::Numbers(16),
                "row-major, for column vectors, translation in the 4th column",
            )
            .rule("invertible, last row 0 0 0 1")])
        },
    ],
};

const POSITION: Key = key("position", POINT, "where it is").unit("m");
const INTENSITY: Key =
    key("intensity", Kind::OneOrThree(POSITIVE_OR_0), "power per solid angle, one number or RGB")
        .unit("W/sr");
const RADIANCE: Key =
    key("radiance", Kind::OneOrThree(POSITIVE_OR_0), "one number or RGB").unit("W/(m^2 sr)");

const VISIBLE: Key =
    key("visible", Kind::Boolean, "whether the camera sees it; it shines all the same").or("true");

const NAME: Key = key(
    "name",
    Kind::Text,
    "with `--layers lights` the light's layer is `light.NAME`; lights of one name share it",
)
.or_else("its number, from 0")
.rule("up to 64 letters, digits, `_` and `-`, a letter first; not `medium`");

const LIGHT: Section = Section {
    path: "light",
    about: "One light. A scene has at least one, unless its medium glows. Light of zero power is legal.",
    repeats: Repeats::Always,
    variants: &[
        kind("point", "The same in all directions from a point.", &[NAME, POSITION, INTENSITY]),
        kind(
            "spot",
            "A point that shines within a cone.",
            &[
                NAME,
                POSITION,
                key("look_at", POINT, "a point on the axis").unit("m").rule("not `position`"),
                INTENSITY,
                key(
                    "cone_angle",
                    Kind::Number(Limits {
                        min: Some(0.001),
                        max: Some(180.0),
                        open_min: false,
                        open_max: true,
                    }),
                    "half-angle; dark outside",
                )
                .unit("degrees"),
                key(
                    "falloff_angle",
                    Kind::Number(POSITIVE_OR_0),
                    "half-angle of full intensity, from where it falls linearly in the angle",
                )
                .unit("degrees")
                .or_else("`cone_angle`: a hard edge")
                .rule("up to `cone_angle`"),
            ],
        ),
        kind(
            "directional",
            "Parallel light from infinitely far.",
            &[
                NAME,
                key("direction", POINT, "where the light travels to").rule("not zero"),
                key(
                    "irradiance",
                    Kind::OneOrThree(POSITIVE_OR_0),
                    "on a plane that faces the light, one number or RGB",
                )
                .unit("W/m^2"),
            ],
        ),
        kind("environment", "Constant radiance from all around.", &[NAME, RADIANCE]),
        kind(
            "environment",
            "Radiance from a latitude-longitude image, +y up.",
            &[
                NAME,
                key("file", Kind::Path, "an EXR image, relative to the scene file"),
                key("scale", Kind::OneOrThree(POSITIVE_OR_0), "factor on the pixels")
                    .unit("W/(m^2 sr) per pixel value")
                    .or("1"),
                key(
                    "rotation",
                    Kind::Number(ANY),
                    "turns the image about +y, counter-clockwise from above",
                )
                .unit("degrees")
                .or("0"),
            ],
        ),
        kind(
            "quad",
            "A parallelogram that shines to one side, along `edge_u` x `edge_v`.",
            &[
                NAME,
                key("corner", POINT, "where both edges begin").unit("m"),
                key("edge_u", POINT, "an edge").unit("m").rule("not zero"),
                key("edge_v", POINT, "the other edge").unit("m").rule("not parallel to `edge_u`"),
                RADIANCE,
                VISIBLE,
            ],
        ),
        kind(
            "sphere",
            "A sphere that shines outwards.",
            &[
                NAME,
                key("center", POINT, "its centre").unit("m"),
                key("radius", Kind::Number(POSITIVE), "its radius").unit("m"),
                RADIANCE,
                VISIBLE,
            ],
        ),
    ],
};

const PHOTONS: Section = Section {
    path: "photons",
    about: "How photons are emitted and followed.",
    repeats: Repeats::Never,
    variants: &[only(&[
        key(
            "count",
            Kind::Integer(1, 1_000_000_000_000),
            "photons emitted per pass; with --target-error or --time-budget the plan chooses, unless it is given",
        )
        .or("1000000"),
        key("emission", Kind::Word(&["random", "stratified", "sobol"]), "how they are sampled at the lights")
            .or("\"stratified\""),
        key("seed", Kind::Integer(0, u64::MAX), "seed of every random number").or("0"),
        key(
            "max_order",
            Kind::Integer(1, u32::MAX as u64),
            "scatterings a photon is followed through; what is cut is counted",
        )
        .or("1000"),
    ])],
};

const ESTIMATE: Section = Section {
    path: "estimate",
    about: "How the photon map is read. Any key of this section makes `render.gather` \"knn\", unless it is given.",
    repeats: Repeats::Never,
    variants: &[only(&[
        key("k", Kind::Integer(1, 1_000_000), "photons of one estimate")
            .or("50")
            .rule("at least 2 with divisor \"k-1\" or \"calibrated\""),
        key(
            "divisor",
            Kind::Word(&["k", "k-1", "k-1/2", "calibrated"]),
            "what the k nearest photons count as; \"calibrated\" measures it",
        )
        .or("\"k-1\""),
        key("kernel", Kind::Word(&["constant", "epanechnikov"]), "weight by distance")
            .or("\"constant\""),
        key("max_radius", Kind::Number(POSITIVE), "largest radius of a query")
            .unit("m")
            .or_else("a share of the medium's size"),
    ])],
};

const RENDER: Section = Section {
    path: "render",
    about: "How pixels are sampled.",
    repeats: Repeats::Never,
    variants: &[only(&[
        key("samples_per_pixel", Kind::Integer(1, 65536), "rays a pixel, jittered in a grid of that many cells").or("4"),
        key("march_samples", Kind::Integer(1, 65536), "queries a ray for light scattered twice or more; at most 2 where paths are bounced").or("8"),
        key("light_samples", Kind::Integer(1, 65536), "single-scattering points a ray and light").or("8"),
        key(
            "gather",
            Kind::Word(&["auto", "knn", "lattice", "bounce"]),
            "how light scattered twice or more is gathered from photons: \"auto\" is \"bounce\" where light scatters many times, else \"lattice\"; left out, \"knn\" with `photons_only` or any key of `[estimate]`",
        )
        .or("\"auto\"")
        .rule("\"knn\" with `photons_only`"),
        key("lattice", Kind::Integer(2, 512), "cells of the lattice along its longest side")
            .or_else("by the number of photons"),
        key("bounces", Kind::Integer(1, 1024), "collisions of a path before it ends in the lattice, with `gather` \"bounce\"").or("8"),
        key(
            "filter",
            Kind::Word(&["auto", "on", "off"]),
            "whether multiple scattering is smoothed from pixel to pixel, as far as the noise taken away exceeds the measured bias: \"auto\" is \"on\" with a target error, a time budget or `gather` \"bounce\"",
        )
        .or("\"auto\""),
        key(
            "background",
            Kind::Word(&["visible", "holdout"]),
            "whether the camera sees environments; held out, they still light the medium",
        )
        .or("\"visible\""),
        key("photons_only", Kind::Boolean, "whether single scattering, too, comes from photons").or("false"),
    ])],
};
