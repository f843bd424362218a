// Renders a scene to a portable float map, and asks its photon map what light is where.
//
//     cargo build --release -p photonvdb-c
//     cc plugins/c/examples/render.c -Iplugins/c/include -Ltarget/release -lphotonvdb_c -o render
//     LD_LIBRARY_PATH=target/release ./render examples/scenes/fog_point.toml fog.pfm

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "photonvdb.h"

// Ends the program unless a call did what was asked for.
static void check(pvdb_status status) {
    if (status != PVDB_STATUS_OK) {
        fprintf(stderr, "error %d: %s\n", (int)status, pvdb_last_error());
        exit(1);
    }
}

// Colours, lowest row first, as the format has it; in the order of bytes of most machines.
static int write_pfm(const char *path, const float *pixels, size_t width, size_t height) {
    FILE *file = fopen(path, "wb");
    if (!file) return 0;
    fprintf(file, "PF\n%zu %zu\n-1.0\n", width, height);
    for (size_t row = height; row-- > 0;)
        for (size_t column = 0; column < width; column++)
            fwrite(pixels + 4 * (row * width + column), sizeof(float), 3, file);
    return fclose(file) == 0;
}

int main(int count, char **arguments) {
    if (count != 3) {
        fprintf(stderr, "usage: render SCENE OUT.pfm\n");
        return 2;
    }
    printf("photonvdb %s\n", pvdb_version());

    pvdb_scene *scene;
    check(pvdb_scene_load(arguments[1], &scene));
    size_t width, height;
    check(pvdb_scene_resolution(scene, &width, &height));
    float *pixels = calloc(4 * width * height, sizeof(float));
    if (!pixels) return 1;
    check(pvdb_render(scene, 1, pixels, 4 * width * height));
    if (!write_pfm(arguments[2], pixels, width, height)) {
        fprintf(stderr, "cannot write %s\n", arguments[2]);
        return 1;
    }
    double sum = 0.0;
    for (size_t i = 0; i < 4 * width * height; i++) sum += pixels[i];
    printf("image %zu x %zu, mean %.6g\n", width, height, sum / (4.0 * width * height));
    free(pixels);

    pvdb_map *map;
    check(pvdb_map_build(scene, &map));
    pvdb_scene_free(scene);
    printf("%llu photons\n", (unsigned long long)pvdb_map_photon_count(map));
    const double points[2][3] = {{0.0, 0.0, 0.0}, {0.5, 0.0, 0.0}};
    float fluence[2][3], density[2][3];
    check(pvdb_map_fluence(map, points[0], 2, fluence[0]));
    check(pvdb_map_power_density(map, points[0], 2, 50, PVDB_DIVISOR_K_MINUS_ONE, density[0]));
    for (int i = 0; i < 2; i++) printf("fluence %g W/m^2, power density %g W/m^3\n", fluence[i][1], density[i][1]);

    const double origin[3] = {0.0, 0.0, 5.0}, direction[3] = {0.0, 0.0, -1.0}, t_max = INFINITY;
    float radiance[3], transmittance[3];
    check(pvdb_map_radiance(map, origin, direction, &t_max, 1, 7, radiance, transmittance));
    printf("radiance %g W/(m^2 sr), transmittance %g\n", radiance[1], transmittance[1]);

    // What cannot be is refused, with a sentence.
    if (pvdb_map_fluence(NULL, points[0], 2, fluence[0]) != PVDB_STATUS_BAD_ARGUMENT) return 1;
    printf("refused: %s\n", pvdb_last_error());
    pvdb_map_free(map);
    return 0;
}
