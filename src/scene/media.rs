//! The medium of a scene from its sections: one, or several volumes together.
//!
//! Volumes that name the same file share it while they are read, and the grids they have in common for good. What is held already
//! counts towards the limit on memory of what is read next.

use std::collections::HashMap;
use std::path::{Path, PathBuf};

use super::emission;
use super::error::Problem;
use super::file::MediumSection;
use super::grid_reader::GridReader;
use super::grid_use::GridUse;
use super::hash::FileHashes;
use super::loaded_grids::LoadedGrids;
use super::volume::{self, DensityVolume, VolumeRules};
use crate::math::Rgb;
use crate::medium::vdb::{Limits, SparseGrid, VdbFile};
use crate::medium::{ChromaticExtinction, Medium, MediumExtinction, UniformExtinction};

/// What reading the media of a scene leads to, besides them.
#[derive(Debug, Default)]
pub(super) struct MediaNotes {
    /// What had to be mended.
    pub warnings: Vec<String>,
    /// The grids used, each once.
    pub grids: Vec<GridUse>,
    /// Of the files read.
    pub hashes: FileHashes,
}

/// The medium that `sections` make together; their files are relative to `directory`.
pub(super) fn read(
    sections: &[MediumSection],
    directory: &Path,
    rules: &VolumeRules,
    notes: &mut MediaNotes,
) -> Result<Medium, Problem> {
    let identities: Vec<Option<PathBuf>> =
        sections.iter().map(|section| identity(section, directory)).collect();
    let mut open = HashMap::new();
    let mut loaded = LoadedGrids::default();
    let mut media = Vec::with_capacity(sections.len());
    for (number, section) in sections.iter().enumerate() {
        let key = if sections.len() == 1 { "medium".into() } else { format!("medium[{number}]") };
        let (MediumSection::Vdb { file, .. }, Some(identity)) = (section, &identities[number])
        else {
            media.push(homogeneous(section)?);
            continue;
        };
        let source = open.remove(identity);
        let rules = VolumeRules { limits: limits_beside(rules, &open, &notes.grids), ..*rules };
        let source = match source {
            Some(source) => source,
            None => volume::open(&directory.join(file), &key, &rules)?,
        };
        notes.hashes.insert(format!("{key}.file"), source.content_hash());
        media.push(from_file(section, &source, key, &rules, notes, &mut loaded)?);
        if identities[number + 1..].contains(&identities[number]) {
            open.insert(identity.clone(), source);
        }
    }
    Medium::of_volumes(media).map_err(|error| Problem::new("medium", error.to_string()))
}

/// The file of a volume, however it is spelt.
fn identity(section: &MediumSection, directory: &Path) -> Option<PathBuf> {
    let MediumSection::Vdb { file, .. } = section else { return None };
    let path = directory.join(file);
    Some(path.canonicalize().unwrap_or(path))
}

/// What is left of the limits beside the grids and files that are held.
fn limits_beside(
    rules: &VolumeRules,
    open: &HashMap<PathBuf, VdbFile>,
    grids: &[GridUse],
) -> Limits {
    let held: u64 = grids.iter().map(|grid| grid.memory_bytes).sum();
    let beside_grids = Limits { max_bytes: rules.limits.max_bytes.saturating_sub(held) };
    open.values().fold(beside_grids, |limits, file| file.limits_beside(&limits))
}

fn homogeneous(section: &MediumSection) -> Result<Medium, Problem> {
    let MediumSection::Homogeneous { bounds, sigma_t, albedo, phase } = section else {
        return Err(Problem::new("medium.file", "names no file"));
    };
    Ok(Medium {
        bounds: bounds.bounds(),
        extinction: homogeneous_extinction(*sigma_t),
        albedo: *albedo,
        color: None,
        phase: phase.phase(),
        emissivity: None,
    })
}

fn homogeneous_extinction(sigma_t: Rgb) -> MediumExtinction {
    if sigma_t == Rgb::splat(sigma_t.x) {
        MediumExtinction::Uniform(UniformExtinction { sigma_t: sigma_t.x })
    } else {
        MediumExtinction::Chromatic(ChromaticExtinction { sigma_t })
    }
}

/// The densities of a section's grid as they are rendered, in the scene's world; `None` of a homogeneous medium.
pub(super) fn read_tree(
    section: &MediumSection,
    key: String,
    directory: &Path,
    rules: &VolumeRules,
) -> Result<Option<SparseGrid<f32>>, Problem> {
    let MediumSection::Vdb {
        file, density, density_scale, sdf_to_fog, precision, transform, ..
    } = section
    else {
        return Ok(None);
    };
    let source = &volume::open(&directory.join(file), &key, rules)?;
    let density = DensityVolume {
        grid: density.as_deref(),
        sdf_to_fog: *sdf_to_fog,
        precision: *precision,
        density_scale: *density_scale,
    };
    // What is mended was told when the scene was loaded.
    let MediaNotes { warnings, grids, .. } = &mut MediaNotes::default();
    let (transform, loaded) = (transform.affine(), &mut LoadedGrids::default());
    let mut reader = GridReader { source, key, transform, rules, warnings, grids, loaded };
    density.read_tree(&mut reader).map(Some)
}

/// The volume at key path `key`.
fn from_file(
    section: &MediumSection,
    source: &VdbFile,
    key: String,
    rules: &VolumeRules,
    notes: &mut MediaNotes,
    loaded: &mut LoadedGrids,
) -> Result<Medium, Problem> {
    let MediumSection::Vdb {
        density,
        density_scale,
        sdf_to_fog,
        precision,
        albedo,
        color,
        phase,
        emission,
        transform,
        ..
    } = section
    else {
        return homogeneous(section);
    };
    let MediaNotes { warnings, grids, .. } = notes;
    let transform = transform.affine();
    let mut reader = GridReader { source, key, transform, rules, warnings, grids, loaded };
    let density = DensityVolume {
        grid: density.as_deref(),
        sdf_to_fog: *sdf_to_fog,
        precision: *precision,
        density_scale: *density_scale,
    };
    let (bounds, extinction) = density.read(&mut reader)?;
    let color = color.as_deref().map(|name| reader.read_color(name).map(Box::new));
    let (color, phase) = (color.transpose()?, phase.phase());
    let medium = Medium { bounds, extinction, albedo: *albedo, color, phase, emissivity: None };
    match emission {
        Some(section) => emission::read(section, medium, &mut reader),
        None => Ok(medium),
    }
}
