// C interface of photonvdb. Made by cbindgen from src/: do not edit.

#ifndef PHOTONVDB_H
#define PHOTONVDB_H

#include <stddef.h>
#include <stdint.h>

// What became of a call.
typedef enum {
  // It did what was asked for.
  PVDB_STATUS_OK = 0,
  // An argument cannot be: a null pointer, a length that does not fit, a number out of range.
  PVDB_STATUS_BAD_ARGUMENT = 1,
  // The scene or a file that it names cannot be used.
  PVDB_STATUS_BAD_SCENE = 2,
  // It cannot be rendered, or no map can be built.
  PVDB_STATUS_RENDER_FAILED = 3,
  // A fault of the library itself; the handles in use should be freed.
  PVDB_STATUS_PANIC = 4,
} pvdb_status;

// What the k nearest photons count as.
typedef enum {
  // k.
  PVDB_DIVISOR_K = 0,
  // k - 1.
  PVDB_DIVISOR_K_MINUS_ONE = 1,
  // k - 1/2.
  PVDB_DIVISOR_K_MINUS_HALF = 2,
  // What was measured when the map was built: only if the scene says `divisor = "calibrated"`.
  PVDB_DIVISOR_CALIBRATED = 3,
} pvdb_divisor;

// A scene with its photon map. It does not change, and may be read from any number of threads at once.
typedef struct pvdb_map pvdb_map;

// A scene, checked and loaded. It does not change, and may be used from any number of threads at once.
typedef struct pvdb_scene pvdb_scene;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of the library, such as "0.1.0". Never null; not to be freed.
const char *pvdb_version(void);

// What went wrong in the last call of this thread, as one sentence in UTF-8; empty if it did not fail. Never null; not to be freed, and
// good until the next call of the same thread.
const char *pvdb_last_error(void);

// Emits and traces the scene's photons and builds their map into `*map`, which is null if that fails. To be freed by `pvdb_map_free`;
// the scene may be freed before.
//
// # Safety
// `scene` is null or a living scene; `map` is null or points to a pointer.
pvdb_status pvdb_map_build(const pvdb_scene *scene,
                           pvdb_map **map);

// Frees a map. Null is ignored.
//
// # Safety
// `map` is null or was given by `pvdb_map_build` and not freed since.
void pvdb_map_free(pvdb_map *map);

// Photons stored in a map; 0 of null.
//
// # Safety
// `map` is null or a living map.
uint64_t pvdb_map_photon_count(const pvdb_map *map);

// Fluence [W/m^2] at `count` points (x y z [m] each) into `rgb` (R G B each), from the photons of the map: scattered light, and direct light
// too where the scene says `photons_only`. k and divisor are the scene's.
//
// # Safety
// `map` is null or a living map; `points` points to 3 * count doubles and `rgb` to 3 * count floats that nobody else uses
// meanwhile, or they are null.
pvdb_status pvdb_map_fluence(const pvdb_map *map,
                             const double *points,
                             size_t count,
                             float *rgb);

// Power density [W/m^3] at `count` points (x y z [m] each) into `rgb` (R G B each), from the `k` nearest photons of the map, which count as
// `divisor` says.
//
// # Safety
// As for `pvdb_map_fluence`.
pvdb_status pvdb_map_power_density(const pvdb_map *map,
                                   const double *points,
                                   size_t count,
                                   size_t k,
                                   uint32_t divisor,
                                   float *rgb);

// Light along `count` segments: from `origins` (x y z [m] each) along `directions` (x y z each, of any length but 0) over `t_max` metres (one a
// ray; infinity for no end). `radiance` takes what travels back [W/(m^2 sr)], scattered and emitted, and lights that are seen within the segment;
// `transmittance` the share of light from behind it that passes (R G B each); either may be null. Equal `seed`s give
// equal results.
//
// # Safety
// `map` is null or a living map; arrays point to 3 * count numbers each, `t_max` to count, that nobody else uses meanwhile, or are null.
pvdb_status pvdb_map_radiance(const pvdb_map *map,
                              const double *origins,
                              const double *directions,
                              const double *t_max,
                              size_t count,
                              uint64_t seed,
                              float *radiance,
                              float *transmittance);

// Loads a scene file (.toml or .json) and the volumes it names into `*scene`, which is null if that fails. To be freed by
// `pvdb_scene_free`.
//
// # Safety
// `path` is null or a text in UTF-8 that ends with 0; `scene` is null or points to a pointer.
pvdb_status pvdb_scene_load(const char *path,
                            pvdb_scene **scene);

// Loads a scene from text, as though it were the content of the file at `path`, which need not exist: its extension tells TOML from
// JSON, and files that the scene names are relative to its directory.
//
// # Safety
// As for `pvdb_scene_load`.
pvdb_status pvdb_scene_from_text(const char *content,
                                 const char *path,
                                 pvdb_scene **scene);

// Frees a scene. Maps built from it stay good. Null is ignored.
//
// # Safety
// `scene` is null or was given by this library and not freed since.
void pvdb_scene_free(pvdb_scene *scene);

// Width and height of the scene's image [pixels].
//
// # Safety
// Pointers are null or point to what their types say.
pvdb_status pvdb_scene_resolution(const pvdb_scene *scene, size_t *width, size_t *height);

// Renders the scene's image in so many independent passes, at least 1, into `pixels`: R G B premultiplied [W/(m^2 sr)] and coverage, row 0 at the
// top. `length` is that of `pixels` in floats, 4 * width * height.
//
// # Safety
// `scene` is null or a living scene; `pixels` is null or points to `length` floats that nobody else uses meanwhile.
pvdb_status pvdb_render(const pvdb_scene *scene,
                        uint32_t passes,
                        float *pixels,
                        size_t length);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* PHOTONVDB_H */
