// Answers of the OpenVDB library for tests/vdb_fog.rs: level sets in, what tools::sdfToFogVolume makes of them out.
//   g++ -O1 -std=c++17 official_fog.cc -o official_fog -lopenvdb -ltbb -lImath
//   ./official_fog make level_set_tiles.vdb
//   ./official_fog answer level_set_tiles.vdb ../vdb/levelset_mask.vdb > answers.json
#include <openvdb/openvdb.h>
#include <openvdb/tools/LevelSetSphere.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <cmath>
#include <cstdio>
#include <cstring>

using namespace openvdb;
using u64 = uint64_t;

static u64 mix(u64 z) {
    z += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
}

static u64 hash_at(const Coord& c, float value) {
    uint32_t bits;
    std::memcpy(&bits, &value, 4);
    if (std::isnan(value)) bits = 0x7fc00000;
    u64 place = 3 * mix(uint32_t(c.x())) + 5 * mix(u64(uint32_t(c.y())) << 1 | 1ull << 40)
        + 7 * mix(u64(uint32_t(c.z())) << 2 | 1ull << 41);
    return mix(place ^ mix(bits));
}

// A ball whose inside reaches over tiles of 8, and beside it tiles of 128 and 4096 voxels that are inside, too.
static void make(const char* path) {
    auto grid = tools::createLevelSetSphere<FloatGrid>(12.f, Vec3f(4.f), 1.f);
    grid->setName("surface");
    grid->tree().addTile(2, Coord(256, 0, 0), -3.f, false);
    grid->tree().addTile(2, Coord(512, 0, 0), 3.f, false);
    grid->tree().addTile(3, Coord(8192, 0, 0), -3.f, false);
    io::File(path).write({grid});
}

static void answer(const char* path, const char* separator) {
    io::File file(path);
    file.open(false);
    auto grid = GridBase::grid<FloatGrid>((*file.getGrids())[0]);
    tools::sdfToFogVolume(*grid);
    u64 on = 0, all = 0, tiles = 0, tile_count = 0;
    for (auto leaf = grid->tree().cbeginLeaf(); leaf; ++leaf) {
        for (auto it = leaf->cbeginValueAll(); it; ++it) all += hash_at(it.getCoord(), *it);
        for (auto it = leaf->cbeginValueOn(); it; ++it) on += hash_at(it.getCoord(), *it);
    }
    auto it = grid->tree().cbeginValueOn();
    it.setMaxDepth(it.getLeafDepth() - 1);
    for (; it; ++it, ++tile_count) {
        CoordBBox box;
        it.getBoundingBox(box);
        tiles += mix(hash_at(box.min(), *it) + u64(box.dim().x()));
    }
    std::string name(path);
    name = name.substr(name.rfind('/') + 1);
    std::printf("%s\n  {\"file\": \"%s\", \"leaf_count\": %u, \"active_tiles\": %llu, \"active_voxels\": %llu, "
                "\"background\": %g,\n   \"leaf_on_hash\": \"%llx\", \"leaf_all_hash\": \"%llx\", \"tile_hash\": \"%llx\"}",
        separator, name.c_str(), unsigned(grid->tree().leafCount()), (unsigned long long)tile_count,
        (unsigned long long)grid->activeVoxelCount(), grid->background(), (unsigned long long)on,
        (unsigned long long)all, (unsigned long long)tiles);
}

int main(int count, char** arguments) {
    initialize();
    if (count > 2 && !std::strcmp(arguments[1], "make")) return make(arguments[2]), 0;
    std::printf("[");
    for (int i = 2; i < count; ++i) answer(arguments[i], i > 2 ? "," : "");
    std::printf("\n]\n");
}
