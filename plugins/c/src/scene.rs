//! Scenes, and their images.

use std::ffi::c_char;
use std::path::Path;
use std::sync::Arc;

use photonvdb::render::{RenderOptions, Unobserved, render};
use photonvdb::scene::{Overrides, Scene};

use crate::borrow::{borrow, room, text};
use crate::{Failure, guarded, pvdb_status};

/// A scene, checked and loaded. It does not change, and may be used from any number of threads at once.
#[allow(non_camel_case_types)]
#[derive(Debug)]
pub struct pvdb_scene {
    pub(crate) scene: Arc<Scene>,
}

/// Loads a scene file (.toml or .json) and the volumes it names into `*scene`, which is null if that fails. To be freed by
/// `pvdb_scene_free`.
///
/// # Safety
/// `path` is null or a text in UTF-8 that ends with 0; `scene` is null or points to a pointer.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_scene_load(
    path: *const c_char,
    scene: *mut *mut pvdb_scene,
) -> pvdb_status {
    guarded(|| {
        // SAFETY: the caller's.
        let load =
            || Scene::load(Path::new(unsafe { text(path, "path") }?)).map_err(Failure::scene);
        // SAFETY: the caller's.
        unsafe { give(scene, load) }
    })
}

/// Loads a scene from text, as though it were the content of the file at `path`, which need not exist: its extension tells TOML from
/// JSON, and files that the scene names are relative to its directory.
///
/// # Safety
/// As for `pvdb_scene_load`.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_scene_from_text(
    content: *const c_char,
    path: *const c_char,
    scene: *mut *mut pvdb_scene,
) -> pvdb_status {
    guarded(|| {
        let load = || {
            // SAFETY: the caller's.
            let (content, path) = unsafe { (text(content, "content")?, text(path, "path")?) };
            Scene::from_text(content, Path::new(path), &Overrides::default())
                .map_err(Failure::scene)
        };
        // SAFETY: the caller's.
        unsafe { give(scene, load) }
    })
}

/// Frees a scene. Maps built from it stay good. Null is ignored.
///
/// # Safety
/// `scene` is null or was given by this library and not freed since.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_scene_free(scene: *mut pvdb_scene) {
    if !scene.is_null() {
        guarded(|| {
            // SAFETY: `Box::into_raw` made it; the rest is the caller's.
            drop(unsafe { Box::from_raw(scene) });
            Ok(())
        });
    }
}

/// Width and height of the scene's image [pixels].
///
/// # Safety
/// Pointers are null or point to what their types say.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_scene_resolution(
    scene: *const pvdb_scene,
    width: *mut usize,
    height: *mut usize,
) -> pvdb_status {
    guarded(|| {
        // SAFETY: the caller's.
        let camera = unsafe { borrow(scene, "scene") }?.scene.camera;
        if width.is_null() || height.is_null() {
            return Err(Failure::null("width or height"));
        }
        // SAFETY: not null; the rest is the caller's.
        unsafe {
            width.write(camera.width);
            height.write(camera.height);
        }
        Ok(())
    })
}

/// Renders the scene's image in so many independent passes, at least 1, into `pixels`: R G B premultiplied [W/(m^2 sr)] and coverage, row 0 at the
/// top. `length` is that of `pixels` in floats, 4 * width * height.
///
/// # Safety
/// `scene` is null or a living scene; `pixels` is null or points to `length` floats that nobody else uses meanwhile.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn pvdb_render(
    scene: *const pvdb_scene,
    passes: u32,
    pixels: *mut f32,
    length: usize,
) -> pvdb_status {
    guarded(|| {
        // SAFETY: the caller's.
        let scene = &unsafe { borrow(scene, "scene") }?.scene;
        let count = scene.camera.width * scene.camera.height;
        if length != 4 * count {
            let needed = 4 * count;
            return Err(Failure::argument(format!("pixels must be {needed} floats, not {length}")));
        }
        if passes == 0 {
            return Err(Failure::argument("passes must be at least 1"));
        }
        // SAFETY: the caller's.
        let pixels = unsafe { room::<4>(pixels, count, "pixels") }?;
        let rendering = render(scene, &RenderOptions::passes(passes), &Unobserved);
        let film = rendering.map_err(Failure::render)?.film;
        for (stored, pixel) in pixels.iter_mut().zip(&film.pixels) {
            let [red, green, blue] = pixel.radiance().as_vec3().to_array();
            *stored = [red, green, blue, pixel.alpha() as f32];
        }
        Ok(())
    })
}

/// Puts a new scene into `*handle`, or null if there is none.
///
/// # Safety
/// `handle` is null or points to a pointer.
unsafe fn give(
    handle: *mut *mut pvdb_scene,
    load: impl FnOnce() -> Result<Scene, Failure>,
) -> Result<(), Failure> {
    if handle.is_null() {
        return Err(Failure::null("scene"));
    }
    // SAFETY: not null; the rest is the caller's.
    unsafe { handle.write(std::ptr::null_mut()) };
    let scene = Arc::new(load()?);
    // SAFETY: as above.
    unsafe { handle.write(Box::into_raw(Box::new(pvdb_scene { scene }))) };
    Ok(())
}
