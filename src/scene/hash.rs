//! A 64-bit hash of everything that determines an image: the scene's values and the content of the files it
//! names, whatever the format, order, spelling or place of those files.
//!
//! Files are hashed in parallel, by whoever reads them (`math/content_hash.rs`); a file that only this module
//! opens is read in chunks.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::error::Problem;
use super::file::{LightSection, MediumSection, SceneFile};
use crate::math::content_hash::{CHUNK_BYTES, hash_bytes, hash_chunk, hash_chunks};

/// The hashes of files that were read already, by the paths of the keys that name them.
pub(super) type FileHashes = HashMap<String, u64>;

/// The hash of a scene file whose own files are relative to `directory`.
pub(super) fn scene_hash(
    file: &SceneFile,
    directory: &Path,
    known: &FileHashes,
) -> Result<u64, Problem> {
    let mut values = file.clone();
    let mut hashes = Vec::new();
    for (key, path) in values.named_files() {
        let hash = match known.get(&key) {
            Some(&hash) => hash,
            None => hash_file(&directory.join(&*path)).map_err(|error| {
                Problem::new(key, format!("cannot read {}: {error}", path.display()))
            })?,
        };
        hashes.push(hash);
        // The place of a file does not change the image.
        *path = PathBuf::new();
    }
    let values = serde_json::to_vec(&values).map_err(|e| Problem::new("scene", e.to_string()))?;
    hashes.push(hash_bytes(&values));
    Ok(hash_chunks(&hashes, values.len() as u64))
}

impl SceneFile {
    /// The files that the scene names, relative to `directory`, each with the path of its key (`medium.file`).
    pub fn files(&self, directory: &Path) -> Vec<(String, PathBuf)> {
        let mut file = self.clone();
        file.named_files().map(|(key, path)| (key, directory.join(path))).collect()
    }

    /// The files that the scene names, each with the path of its key.
    fn named_files(&mut self) -> impl Iterator<Item = (String, &mut PathBuf)> {
        let is_one = self.media.len() == 1;
        let media = self.media.iter_mut().enumerate().filter_map(move |(index, medium)| {
            let MediumSection::Vdb { file, .. } = medium else { return None };
            let key = if is_one { "medium.file".into() } else { format!("medium[{index}].file") };
            Some((key, file))
        });
        let lights =
            self.lights.iter_mut().enumerate().filter_map(|(index, light)| {
                match &mut light.light {
                    LightSection::ImageEnvironment { file, .. } => {
                        Some((format!("light[{index}].file"), file))
                    }
                    _ => None,
                }
            });
        media.chain(lights)
    }
}

fn hash_file(path: &Path) -> io::Result<u64> {
    let mut file = File::open(path)?;
    let (mut chunk, mut chunks, mut len) = (Vec::new(), Vec::new(), 0);
    loop {
        chunk.clear();
        file.by_ref().take(CHUNK_BYTES as u64).read_to_end(&mut chunk)?;
        if chunk.is_empty() {
            return Ok(hash_chunks(&chunks, len));
        }
        chunks.push(hash_chunk(&chunk));
        len += chunk.len() as u64;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_has_the_hash_of_its_bytes() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("image.exr");
        for len in [0, 1, CHUNK_BYTES, 2 * CHUNK_BYTES + 1] {
            let bytes: Vec<u8> = (0..len).map(|n| (n % 251) as u8).collect();
            std::fs::write(&path, &bytes).unwrap();
            assert_eq!(hash_file(&path).unwrap(), hash_bytes(&bytes));
        }
    }
}
