//! Files that are either complete or not there: written under a temporary name in the same directory,
//! then renamed over the old file.

use std::fs::{self, File, OpenOptions};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

/// A file could not be created, filled or put in place. What stood there before is untouched.
#[derive(Debug, thiserror::Error)]
#[error("cannot write {path}: {source}", path = path.display())]
pub struct WriteFailure {
    /// The file.
    pub path: PathBuf,
    /// Why.
    pub source: io::Error,
}

/// Writes a file so that `path` holds either what it held before or all of the new content. Returns
/// what `write` does.
///
/// `write` fills a new file that lies beside `path`; when it succeeds the file takes the place of
/// `path`, when it fails the file is removed. A symbolic link keeps pointing to the file it names, and
/// a device or a pipe (`/dev/null`, `/dev/stdout`) receives the finished content.
///
/// # Errors
/// [`WriteFailure`] with `path` and the cause: the directory is missing or not writable, the disk is
/// full, `path` is a directory; or the error of `write`.
pub fn write_beside<T, E: From<WriteFailure>>(
    path: &Path,
    write: impl FnOnce(&mut File) -> Result<T, E>,
) -> Result<T, E> {
    let failure = |source| WriteFailure { path: path.to_path_buf(), source };
    let target = Target::of(path).map_err(failure)?;
    let mut temporary = Temporary::create(target.directory(), &target.path).map_err(failure)?;
    let written = write(&mut temporary.file)?;
    // A full disk shows here at the latest.
    let placed = temporary.file.sync_all().and_then(|()| target.receive(&temporary));
    placed.map_err(failure)?;
    Ok(written)
}

/// Tells early, before an expensive computation, whether [`write_beside`] can create a file beside `path`.
///
/// # Errors
/// [`WriteFailure`] with `path` and the cause.
pub fn check_writable(path: &Path) -> Result<(), WriteFailure> {
    let created = Target::of(path)
        .and_then(|target| Temporary::create(target.directory(), &target.path).map(drop));
    created.map_err(|source| WriteFailure { path: path.to_path_buf(), source })
}

/// Where the content goes.
struct Target {
    /// `path` with symbolic links resolved.
    path: PathBuf,
    /// A device or a pipe, which must not be replaced by a file.
    is_special: bool,
}

impl Target {
    fn of(path: &Path) -> io::Result<Self> {
        match fs::metadata(path) {
            Ok(found) if found.is_dir() => Err(io::Error::other("it is a directory")),
            Ok(found) if found.is_file() => {
                Ok(Self { path: fs::canonicalize(path)?, is_special: false })
            }
            Ok(_) => Ok(Self { path: path.to_path_buf(), is_special: true }),
            Err(_) => Ok(Self { path: path.to_path_buf(), is_special: false }),
        }
    }

    fn directory(&self) -> PathBuf {
        match self.path.parent() {
            _ if self.is_special => std::env::temp_dir(),
            Some(parent) if parent != Path::new("") => parent.to_path_buf(),
            _ => PathBuf::from("."),
        }
    }

    fn receive(&self, temporary: &Temporary) -> io::Result<()> {
        if self.is_special {
            let mut device = OpenOptions::new().write(true).open(&self.path)?;
            io::copy(&mut File::open(&temporary.path)?, &mut device)?;
            return Ok(());
        }
        fs::rename(&temporary.path, &self.path)
    }
}

/// A file that is removed when dropped, unless it was renamed before.
struct Temporary {
    path: PathBuf,
    file: File,
}

impl Temporary {
    fn create(directory: PathBuf, target: &Path) -> io::Result<Self> {
        static COUNTER: AtomicU64 = AtomicU64::new(0);
        if !directory.is_dir() {
            let reason = format!("the directory {} does not exist", directory.display());
            return Err(io::Error::new(io::ErrorKind::NotFound, reason));
        }
        let name = target.file_name().ok_or_else(|| io::Error::other("it names no file"))?;
        let unique = format!(
            ".{}-{}-{}.part",
            name.to_string_lossy(),
            std::process::id(),
            COUNTER.fetch_add(1, Ordering::Relaxed)
        );
        let path = directory.join(unique);
        let file = OpenOptions::new().read(true).write(true).create_new(true).open(&path)?;
        Ok(Self { path, file })
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // After the rename there is nothing left to remove, and that is the good case.
        let _ = fs::remove_file(&self.path);
    }
}
