//! A 64-bit hash of everything that determines an image: the scene's values and the content of the files it
//! names, whatever the format, order, spelling or place of those files.
//!
//! FNV-1a (Fowler, Noll and Vo) over 64-bit words with an added shift, since FNV's product moves bits upwards
//! only. Tells scenes apart; no defence against forgery.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use super::error::Problem;
use super::file::{LightSection, MediumSection, SceneFile};

const OFFSET_BASIS: u64 = 0xcbf2_9ce4_8422_2325;
const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Bytes of a file hashed at a time, a multiple of 8.
const BLOCK_BYTES: u64 = 1 << 16;

/// The hash of a scene file whose own files are relative to `directory`.
pub(super) fn scene_hash(file: &SceneFile, directory: &Path) -> Result<u64, Problem> {
    let mut values = file.clone();
    let mut hash = OFFSET_BASIS;
    for (key, path) in values.named_files() {
        hash = hash_file(hash, &directory.join(&*path)).map_err(|error| {
            Problem::new(key, format!("cannot read {}: {error}", path.display()))
        })?;
        // The place of a file does not change the image.
        *path = PathBuf::new();
    }
    let values = serde_json::to_vec(&values).map_err(|e| Problem::new("scene", e.to_string()))?;
    Ok(hash_bytes(hash, &values))
}

impl SceneFile {
    /// The files that the scene names, each with the path of its key.
    fn named_files(&mut self) -> impl Iterator<Item = (String, &mut PathBuf)> {
        let medium = match &mut self.medium {
            MediumSection::Vdb { file, .. } => Some(("medium.file".into(), file)),
            MediumSection::Homogeneous { .. } => None,
        };
        let lights = self.lights.iter_mut().enumerate().filter_map(|(index, light)| match light {
            LightSection::ImageEnvironment { file, .. } => {
                Some((format!("light[{index}].file"), file))
            }
            _ => None,
        });
        medium.into_iter().chain(lights)
    }
}

fn hash_file(mut hash: u64, path: &Path) -> io::Result<u64> {
    let mut file = File::open(path)?;
    let mut block = Vec::new();
    loop {
        block.clear();
        let length = file.by_ref().take(BLOCK_BYTES).read_to_end(&mut block)?;
        hash = hash_bytes(hash, &block);
        if length == 0 {
            return Ok(hash);
        }
    }
}

/// Hashes bytes and their number, so that zeros at the end count.
fn hash_bytes(hash: u64, bytes: &[u8]) -> u64 {
    let words = bytes.chunks(8).map(|chunk| {
        let mut word = [0; 8];
        word[..chunk.len()].copy_from_slice(chunk);
        u64::from_le_bytes(word)
    });
    words.chain([bytes.len() as u64]).fold(hash, |hash, word| {
        let product = (hash ^ word).wrapping_mul(PRIME);
        product ^ (product >> 32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bit_counts() {
        let bytes: Vec<u8> = (0..100).collect();
        let mut seen = vec![hash_bytes(OFFSET_BASIS, &bytes), hash_bytes(OFFSET_BASIS, &[])];
        for bit in 0..800 {
            let mut changed = bytes.clone();
            changed[bit / 8] ^= 1 << (bit % 8);
            seen.push(hash_bytes(OFFSET_BASIS, &changed));
        }
        seen.extend((1..20).map(|zeros| hash_bytes(OFFSET_BASIS, &vec![0; zeros])));
        let count = seen.len();
        seen.sort_unstable();
        seen.dedup();
        assert_eq!(seen.len(), count);
    }
}
