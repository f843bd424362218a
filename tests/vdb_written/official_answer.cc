// What the OpenVDB library says of a file, as JSON: the answers that tests compare this project's
// reader and writer with. Hashes are those of tests/vdb/support/hash.rs.
//
//   g++ -O1 -std=c++17 official_answer.cc -o official_answer -lopenvdb -ltbb -lImath
//   ./official_answer mask.vdb > mask.json

#include <openvdb/openvdb.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <cstring>
#include <iomanip>
#include <iostream>
#include <sstream>

using namespace openvdb;

static uint64_t mix(uint64_t z)
{
    z += 0x9e3779b97f4a7c15ull;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull;
    z = (z ^ z >> 27) * 0x94d049bb133111ebull;
    return z ^ z >> 31;
}

static uint64_t bits(float value)
{
    uint32_t word;
    std::memcpy(&word, &value, sizeof word);
    return std::isnan(value) ? 0x7fc00000 : word;
}

static uint64_t bits(const Vec3s& v)
{
    return 11 * mix(bits(v[0])) + 13 * mix(bits(v[1]) + 1) + 17 * mix(bits(v[2]) + 2);
}

template<typename V> static uint64_t hashAt(const Coord& at, const V& value)
{
    const uint64_t x = uint32_t(at[0]), y = uint32_t(at[1]), z = uint32_t(at[2]);
    const uint64_t place = 3 * mix(x) + 5 * mix(y << 1 | 1ull << 40) + 7 * mix(z << 2 | 1ull << 41);
    return mix(place ^ mix(bits(value)));
}

static std::string number(double value)
{
    if (std::isnan(value)) return "\"nan\"";
    if (std::isinf(value)) return value > 0 ? "\"inf\"" : "\"-inf\"";
    std::ostringstream text;
    text << std::setprecision(17) << value;
    return text.str();
}

static std::string number(const Vec3s& v)
{
    return "[" + number(v[0]) + "," + number(v[1]) + "," + number(v[2]) + "]";
}

static std::string triple(const Coord& c)
{
    std::ostringstream text;
    text << "[" << c[0] << "," << c[1] << "," << c[2] << "]";
    return text.str();
}

static std::string quoted(const std::string& text)
{
    std::string out = "\"";
    for (char c : text) {
        if (c == '"' || c == '\\') out += '\\';
        out += c;
    }
    return out + "\"";
}

// Smallest, largest and summed value of the active leaf voxels that are finite.
struct Figures
{
    double min = INFINITY, max = -INFINITY, sum = 0;
    uint64_t nonfinite = 0;

    void add(float value)
    {
        if (!std::isfinite(value)) { ++nonfinite; return; }
        min = std::min(min, double(value));
        max = std::max(max, double(value));
        sum += value;
    }
    void add(const Vec3s&) {}
};

// Values between voxels, at a place in each of the first leaves.
static void boxSamples(const FloatGrid& grid)
{
    std::cout << ",\"box_samples\":[";
    const char* separator = "";
    int count = 0;
    for (auto leaf = grid.tree().cbeginLeaf(); leaf && count < 16; ++leaf, ++count, separator = ",") {
        const Vec3d index = leaf->origin().asVec3d() + Vec3d(0.37 * count, 5.3 - 0.29 * count, 2.6 + 0.11 * count);
        const Vec3d world = grid.indexToWorld(index);
        std::cout << separator << "\n{\"index\":[" << number(index[0]) << "," << number(index[1]) << ","
            << number(index[2]) << "],\"world\":[" << number(world[0]) << "," << number(world[1]) << ","
            << number(world[2]) << "],\"value\":" << number(tools::BoxSampler::sample(grid.tree(), index)) << "}";
    }
    std::cout << "]";
}

template<typename GridT> static void answer(const GridT& grid)
{
    const auto& tree = grid.tree();
    uint64_t on = 0, all = 0, tiles = 0, active = 0;
    Figures figures;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        for (auto value = leaf->cbeginValueAll(); value; ++value) {
            const uint64_t hash = hashAt(value.getCoord(), *value);
            all += hash;
            if (!value.isValueOn()) continue;
            on += hash;
            ++active;
            figures.add(*value);
        }
    }
    auto tile = tree.cbeginValueOn();
    tile.setMaxDepth(tile.getLeafDepth() - 1);
    for (; tile; ++tile) {
        const CoordBBox box = tile.getBoundingBox();
        tiles += mix(hashAt(box.min(), *tile) + uint64_t(box.dim()[0]));
    }

    const auto matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
    std::cout << "{\"name\":" << quoted(grid.getName()) << ",\"type\":" << quoted(tree.type())
        << ",\"half\":" << (grid.saveFloatAsHalf() ? "true" : "false")
        << ",\"class\":" << quoted(GridBase::gridClassToString(grid.getGridClass()))
        << ",\"map\":" << quoted(grid.transform().mapType()) << ",\"index_to_world_rowvec\":[";
    for (int i = 0; i < 16; ++i) std::cout << (i ? "," : "") << number(matrix.asPointer()[i]);
    std::cout << "],\"metadata\":{";
    const char* separator = "";
    for (auto meta = grid.beginMeta(); meta != grid.endMeta(); ++meta, separator = ",") {
        std::cout << separator << quoted(meta->first) << ":"
            << quoted(meta->second->typeName() + "=" + meta->second->str());
    }
    std::cout << "},\"background\":" << number(grid.background())
        << ",\"active_voxels\":" << tree.activeVoxelCount() << ",\"active_leaf_voxels\":" << active
        << ",\"leaf_count\":" << tree.leafCount() << ",\"active_tiles\":" << tree.activeTileCount();
    const CoordBBox bbox = grid.evalActiveVoxelBoundingBox();
    std::cout << ",\"bbox\":[" << triple(bbox.min()) << "," << triple(bbox.max()) << "]" << std::hex
        << ",\"leaf_on_hash\":\"" << on << "\",\"leaf_all_hash\":\"" << all
        << "\",\"tile_hash\":\"" << tiles << "\"" << std::dec
        << ",\"leaf_min\":" << number(figures.min) << ",\"leaf_max\":" << number(figures.max)
        << ",\"leaf_sum\":" << number(figures.sum) << ",\"nonfinite\":" << figures.nonfinite
        << ",\"samples\":[";
    // The first value of every leaf and every tile, whatever its state.
    separator = "";
    auto accessor = grid.getConstAccessor();
    const auto sample = [&](const Coord& at) {
        const Vec3d world = grid.transform().indexToWorld(at);
        std::cout << separator << "\n{\"ijk\":" << triple(at)
            << ",\"active\":" << (accessor.isValueOn(at) ? "true" : "false")
            << ",\"value\":" << number(accessor.getValue(at)) << ",\"world\":[" << number(world[0])
            << "," << number(world[1]) << "," << number(world[2]) << "]}";
        separator = ",";
    };
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) sample(leaf->origin());
    auto any = tree.cbeginValueAll();
    any.setMaxDepth(any.getLeafDepth() - 1);
    for (; any; ++any) {
        if (any.isValueOn() || std::memcmp(&*any, &grid.background(), sizeof(*any)) != 0) {
            sample(any.getCoord());
        }
    }
    sample(Coord(3, 1, 2));
    sample(Coord(-100000, 7, 100000));
    std::cout << "]";
    if constexpr (std::is_same_v<GridT, FloatGrid>) boxSamples(grid);
    std::cout << "}";
}

int main(int, char** arguments)
{
    initialize();
    io::File file(arguments[1]);
    file.open();
    std::cout << "{\"library\":" << quoted(getLibraryVersionString()) << ",\"grids\":[\n";
    const GridPtrVecPtr grids = file.getGrids();
    for (size_t i = 0; i < grids->size(); ++i) {
        if (i) std::cout << ",\n";
        const GridBase::Ptr grid = (*grids)[i];
        if (grid->isType<FloatGrid>()) answer(static_cast<const FloatGrid&>(*grid));
        else answer(static_cast<const Vec3SGrid&>(*grid));
    }
    std::cout << "]}\n";
}
