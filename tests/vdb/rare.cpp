// Writes the small test volumes of rare kinds, and the OpenVDB library's own answers about them.
//
//     g++ -O1 -std=c++17 rare.cpp -o rare -lopenvdb -ltbb -lImath && ./rare DIRECTORY
//
// Grids of halves (HalfGrid of OpenVDB 13, file version 225) are an instance of the library's own templates.

#include <openvdb/openvdb.h>
#include <openvdb/io/Stream.h>
#include <openvdb/tools/Interpolation.h>

#include <cmath>
#include <cstring>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

using namespace openvdb;
using Half = math::half;
using HalfTree = tree::Tree4<Half, 5, 4, 3>::Type;
using HalfGrid = Grid<HalfTree>;

// Where most voxels are: across eight leaves, but below one node of each level, which takes 9 kB at the least.
const Coord CENTER(-24, 40, 16);

// Values as numbers, and as bits for the hashes.
template<typename T> struct Kind {
    static uint64_t bits(T v) { return uint32_t(v); }
    static void print(std::ostream& os, T v) { os << int64_t(v); }
    static double number(T v) { return double(v); }
};
template<> uint64_t Kind<int64_t>::bits(int64_t v) { return uint64_t(v); }
template<> uint64_t Kind<float>::bits(float v) { if (std::isnan(v)) return 0x7fc00000u; uint32_t b; std::memcpy(&b, &v, 4); return b; }
template<> uint64_t Kind<double>::bits(double v) { if (std::isnan(v)) return 0x7ff8000000000000ull; uint64_t b; std::memcpy(&b, &v, 8); return b; }
void printNumber(std::ostream& os, double v) {
    if (std::isnan(v)) os << "\"nan\""; else if (std::isinf(v)) os << (v > 0 ? "\"inf\"" : "\"-inf\""); else os << v;
}
template<> void Kind<float>::print(std::ostream& os, float v) { printNumber(os, v); }
template<> void Kind<double>::print(std::ostream& os, double v) { printNumber(os, v); }
template<> struct Kind<Half> {
    static uint64_t bits(Half v) { return Kind<float>::bits(float(v)); }
    static void print(std::ostream& os, Half v) { printNumber(os, float(v)); }
    static double number(Half v) { return float(v); }
};
template<> struct Kind<bool> {
    static uint64_t bits(bool v) { return v; }
    static void print(std::ostream& os, bool v) { os << (v ? "true" : "false"); }
    static double number(bool v) { return v; }
};
uint64_t mix(uint64_t z) {
    z += 0x9e3779b97f4a7c15ull; z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9ull; z = (z ^ z >> 27) * 0x94d049bb133111ebull; return z ^ z >> 31;
}
template<typename S> struct Kind<math::Vec3<S>> {
    static uint64_t bits(const math::Vec3<S>& v) {
        return 11 * mix(Kind<S>::bits(v.x())) + 13 * mix(Kind<S>::bits(v.y()) + 1) + 17 * mix(Kind<S>::bits(v.z()) + 2);
    }
    static void print(std::ostream& os, const math::Vec3<S>& v) {
        os << "["; for (int i = 0; i < 3; ++i) { if (i) os << ","; Kind<S>::print(os, v[i]); } os << "]";
    }
    static double number(const math::Vec3<S>&) { return 0; }
};
uint64_t place(const Coord& c) {
    auto word = [](int x) { return uint64_t(uint32_t(x)); };
    return 3 * mix(word(c.x())) + 5 * mix(word(c.y()) << 1 | 1ull << 40) + 7 * mix(word(c.z()) << 2 | 1ull << 41);
}
template<typename T> uint64_t hashAt(const Coord& c, const T& v) { return mix(place(c) ^ mix(Kind<T>::bits(v))); }

template<typename V> struct IsVector { static const bool value = VecTraits<V>::IsVec; };

// BoxSampler of the grid as doubles where the grid itself would round or truncate the blend.
template<typename GridT> void boxSamples(std::ostream& os, const GridT& grid, const CoordBBox& bbox) {
    using V = typename GridT::ValueType;
    if constexpr (!IsVector<V>::value && !std::is_same_v<V, bool>) {
        DoubleGrid copy(double(Kind<V>::number(grid.background())));
        copy.setTransform(grid.transform().copy());
        copy.topologyUnion(grid);
        for (auto it = grid.cbeginValueAll(); it; ++it) {
            CoordBBox box; it.getBoundingBox(box);
            const double value = Kind<V>::number(*it);
            if (it.isVoxelValue()) {
                if (it.isValueOn()) copy.tree().setValueOn(it.getCoord(), value);
                else if (value != copy.background()) copy.tree().setValueOff(it.getCoord(), value);
            } else if (it.isValueOn() || value != copy.background()) {
                copy.tree().addTile(it.getLevel(), box.min(), value, it.isValueOn());
            }
        }
        std::mt19937_64 random(7);
        os << ",\"box_samples\":[";
        for (int n = 0; n < 12; ++n) {
            Vec3d index;
            for (int axis = 0; axis < 3; ++axis) {
                const bool wide = n % 3 == 0;
                const double lower = wide ? bbox.min()[axis] - 1.0 : CENTER[axis] - 6.0;
                const double upper = wide ? bbox.max()[axis] + 1.0 : CENTER[axis] + 6.0;
                index[axis] = std::uniform_real_distribution<double>(lower, upper)(random);
            }
            const Vec3d world = grid.indexToWorld(index);
            const double value = tools::BoxSampler::sample(copy.constTree(), index);
            os << (n ? "," : "") << "{\"index\":"; Kind<Vec3d>::print(os, index);
            os << ",\"world\":"; Kind<Vec3d>::print(os, world);
            os << ",\"value\":"; printNumber(os, value); os << "}";
        }
        os << "]";
    }
}

template<typename GridT> void answer(std::ostream& os, const GridT& grid, const std::string& word) {
    using V = typename GridT::ValueType;
    using K = Kind<V>;
    const auto& tree = grid.tree();
    os << "{\"name\":\"" << grid.getName() << "\",\"type\":\"" << grid.type() << "\",\"half\":" << (grid.saveFloatAsHalf() ? "true" : "false");
    os << ",\"class\":\"" << GridBase::gridClassToString(grid.getGridClass()) << "\",\"map\":\"" << grid.transform().mapType() << "\"";
    os << ",\"index_to_world_rowvec\":[";
    const Mat4R matrix = grid.transform().baseMap()->getAffineMap()->getMat4();
    for (int i = 0; i < 16; ++i) { os << (i ? "," : ""); printNumber(os, matrix[i / 4][i % 4]); }
    os << "],\"value_type\":\"" << word << "\",\"background\":"; K::print(os, tree.background());
    os << ",\"active_voxels\":" << tree.activeVoxelCount() << ",\"active_leaf_voxels\":" << tree.activeLeafVoxelCount();
    os << ",\"leaf_count\":" << tree.leafCount() << ",\"active_tiles\":" << tree.activeTileCount();
    CoordBBox bbox = grid.evalActiveVoxelBoundingBox();
    os << ",\"bbox\":[[" << bbox.min().x() << "," << bbox.min().y() << "," << bbox.min().z() << "],[" << bbox.max().x() << "," << bbox.max().y() << "," << bbox.max().z() << "]]";
    uint64_t on = 0, all = 0, tiles = 0, nonfinite = 0;
    double low = INFINITY, high = -INFINITY, sum = 0;
    for (auto leaf = tree.cbeginLeaf(); leaf; ++leaf) {
        for (Index i = 0; i < 512; ++i) {
            const Coord at = leaf->offsetToGlobalCoord(i);
            const V value = leaf->getValue(i);
            const uint64_t hash = hashAt(at, value);
            all += hash;
            if (!leaf->isValueOn(i)) continue;
            on += hash;
            const double number = K::number(value);
            if (!std::isfinite(number)) { ++nonfinite; continue; }
            low = std::min(low, number); high = std::max(high, number); sum += number;
        }
    }
    for (auto it = tree.cbeginValueOn(); it; ++it) {
        if (it.isVoxelValue()) continue;
        CoordBBox box; it.getBoundingBox(box);
        tiles += mix(hashAt(box.min(), *it) + uint64_t(box.dim().x()));
    }
    os << std::hex << ",\"leaf_on_hash\":\"" << on << "\",\"leaf_all_hash\":\"" << all << "\",\"tile_hash\":\"" << tiles << "\"" << std::dec;
    if constexpr (!IsVector<V>::value) {
        if (low <= high) { os << ",\"leaf_min\":"; printNumber(os, low); os << ",\"leaf_max\":"; printNumber(os, high); }
        os << ",\"leaf_sum\":"; printNumber(os, sum); os << ",\"nonfinite\":" << nonfinite;
    }
    os << ",\"samples\":[";
    std::mt19937 random(3);
    bool first = true;
    auto sample = [&](const Coord& at) {
        os << (first ? "" : ",") << "{\"ijk\":[" << at.x() << "," << at.y() << "," << at.z() << "],\"active\":" << (tree.isValueOn(at) ? "true" : "false") << ",\"value\":";
        first = false;
        K::print(os, tree.getValue(at));
        os << ",\"world\":"; Kind<Vec3d>::print(os, grid.indexToWorld(at)); os << "}";
    };
    uint64_t count = 0;
    for (auto it = tree.cbeginValueOn(); it; ++it) if (count++ % 37 == 0 && count < 37 * 16) sample(it.getCoord());
    for (int n = 0; n < 12; ++n) {
        Coord at;
        for (int axis = 0; axis < 3; ++axis) {
            const bool wide = n % 3 == 0;
            const int lower = wide ? bbox.min()[axis] - 10 : CENTER[axis] - 6;
            const int upper = wide ? bbox.max()[axis] + 10 : CENTER[axis] + 6;
            at[axis] = std::uniform_int_distribution<int>(lower, upper)(random);
        }
        sample(at);
    }
    os << "]";
    boxSamples(os, grid, bbox);
    os << "}";
}

// The answer about a grid of whatever type.
void answerAny(std::ostream& os, const GridBase& grid) {
    auto as = [&](auto* typed, const char* word) { if (typed) answer(os, *typed, word); return typed != nullptr; };
    as(dynamic_cast<const FloatGrid*>(&grid), "float") || as(dynamic_cast<const DoubleGrid*>(&grid), "double")
        || as(dynamic_cast<const Int32Grid*>(&grid), "int32") || as(dynamic_cast<const Int64Grid*>(&grid), "int64")
        || as(dynamic_cast<const HalfGrid*>(&grid), "half") || as(dynamic_cast<const Vec3SGrid*>(&grid), "vec3s")
        || as(dynamic_cast<const Vec3DGrid*>(&grid), "vec3d") || as(dynamic_cast<const Vec3IGrid*>(&grid), "vec3i")
        || as(dynamic_cast<const BoolGrid*>(&grid), "bool");
    if (auto* mask = dynamic_cast<const MaskGrid*>(&grid)) {
        // A mask has no values: only what is active.
        BoolGrid active(false);
        active.topologyUnion(*mask);
        std::ostringstream text;
        active.setName(mask->getName()); active.setTransform(mask->transform().copy()); active.setGridClass(mask->getGridClass());
        answer(text, active, "mask");
        std::string line = text.str();
        line.replace(line.find("Tree_bool"), 9, "Tree_mask");
        os << line;
    }
}

std::string directory;

void patchVersion(const std::string& path, uint32_t version) {
    std::fstream file(path, std::ios::in | std::ios::out | std::ios::binary);
    file.seekp(8);
    file.write(reinterpret_cast<const char*>(&version), 4);
}

// Writes the grids, reads them again, and writes the answer about what was read.
void save(const std::string& name, const GridCPtrVec& grids, uint32_t compression, bool stream = false) {
    const std::string path = directory + "/" + name + ".vdb";
    if (stream) {
        std::ofstream os(path, std::ios::binary);
        io::Stream out(os);
        out.setCompression(compression);
        out.write(grids);
    } else {
        io::File file(path);
        file.setCompression(compression);
        file.write(grids);
    }
    GridPtrVecPtr read;
    if (stream) { std::ifstream is(path, std::ios::binary); read = io::Stream(is).getGrids(); }
    else { io::File file(path); file.open(false); read = file.getGrids(); }
    std::ofstream json(directory + "/" + name + ".json");
    json.precision(17);
    json << "{\"file\":\"" << name << ".vdb\",\"library\":\"10.0/224\",\"grids\":[\n";
    bool first = true;
    for (const auto& grid : *read) { json << (first ? "" : ",\n"); first = false; answerAny(json, *grid); }
    json << "]}\n";
}

// A ball of values, some of them inactive, tiles of 8 and 128, and a root tile where asked for.
template<typename GridT, typename F>
typename GridT::Ptr ball(const std::string& name, typename GridT::ValueType background, F value, bool tiles, bool rootTile) {
    auto grid = GridT::create(background);
    grid->setName(name);
    auto& tree = grid->tree();
    for (int x = -4; x <= 5; ++x) for (int y = -3; y <= 4; ++y) for (int z = -5; z <= 3; ++z) {
        const double r = std::sqrt(double(x * x + y * y + z * z));
        if (r < 4.3) tree.setValueOn(CENTER.offsetBy(x, y, z), value(x, y, z));
        else if (r < 4.6) tree.setValueOff(CENTER.offsetBy(x, y, z), value(x, y, z));
    }
    if (tiles) {
        tree.addTile(1, Coord(-8, 16, 0), value(1, 2, 3), true);
        tree.addTile(1, Coord(-64, 8, 0), value(3, 1, 1), false);
        tree.addTile(2, Coord(-256, 128, 0), value(2, 2, 1), true);
    }
    if (rootTile) {
        tree.addTile(3, Coord(-8192, 4096, 0), value(1, 1, 2), true);
        tree.addTile(3, Coord(4096, 4096, 4096), value(2, 0, 1), false);
    }
    grid->setTransform(math::Transform::createLinearTransform(0.125));
    return grid;
}

double wave(int x, int y, int z) { return 1.0 + 0.5 * std::sin(0.7 * x + 0.3 * y) + 0.25 * std::cos(0.9 * z - 0.2 * x); }

int main(int count, char** arguments) {
    if (count != 2) { std::cerr << "usage: rare DIRECTORY\n"; return 2; }
    directory = arguments[1];
    initialize();
    if (!HalfGrid::isRegistered()) HalfGrid::registerGrid();

    auto real = [](int x, int y, int z) { return float(wave(x, y, z)); };
    auto whole = [](int x, int y, int z) { return 1 + (x & 3) + 3 * (y & 1) + (z & 7); };
    auto vector = [](int x, int y, int z) { return Vec3d(wave(x, y, z), x - 0.1 * y, -wave(z, x, y)); };

    // Every combination of the compression flags.
    const char* names[] = {"none", "zip", "mask", "zip_mask", "blosc", "zip_blosc", "blosc_mask", "zip_blosc_mask"};
    for (uint32_t flags = 0; flags < 8; ++flags) {
        auto grid = ball<FloatGrid>("density", 0.5f, real, true, true);
        // At full precision and neither packed nor masked, inner nodes alone take 150 kB.
        if (flags == 0) grid->setSaveFloatAsHalf(true);
        save(std::string("codec_") + names[flags], {grid}, flags);
    }

    // Halves, with tiles of every size and inactive values that must be told.
    for (uint32_t flags : {3u, 4u, 6u}) {
        auto grid = ball<FloatGrid>("density", 0.3f, real, true, true);
        grid->setSaveFloatAsHalf(true);
        save(std::string("half_tiles_") + names[flags], {grid}, flags);
    }

    // Other types of voxel.
    auto doubles = ball<DoubleGrid>("density", 0.1, wave, true, false);
    auto longs = ball<Int64Grid>("count", -3, [&](int x, int y, int z) { return (int64_t(whole(x, y, z)) << 40) + x; }, true, true);
    auto ints = ball<Int32Grid>("count", 7, whole, true, true);
    auto vec3d = ball<Vec3DGrid>("velocity", Vec3d(0.1, 0.2, 0.3), vector, true, true);
    auto vec3s = ball<Vec3SGrid>("velocity", Vec3f(0), [&](int x, int y, int z) { return Vec3f(vector(x, y, z)); }, true, true);
    auto vec3i = ball<Vec3IGrid>("id", Vec3i(1, 2, 3), [](int x, int y, int z) { return Vec3i(x, -y, z * z); }, true, true);
    auto bools = ball<BoolGrid>("inside", false, [](int x, int y, int z) { return ((x ^ y ^ z) & 1) != 0; }, true, true);
    auto mask = MaskGrid::create();
    mask->setName("inside");
    mask->topologyUnion(*bools);
    mask->setTransform(bools->transform().copy());
    save("type_vec3d", {vec3d}, 6);
    save("type_vec3i", {vec3i}, 6);
    save("type_bool_zip_mask", {bools}, 3);
    save("type_mask_blosc_mask", {mask}, 6);
    save("type_int32_zip_mask", {ints}, 3);
    save("type_int64_blosc", {longs}, 4);
    auto halved = [](auto grid) { auto copy = grid->deepCopy(); copy->setSaveFloatAsHalf(true); return copy; };
    save("type_vec3d_half", {halved(vec3d)}, 6);
    save("type_vec3s_half", {halved(vec3s)}, 3);
    save("type_double_half_zip", {halved(doubles)}, 1);
    // Halves are meant for reals alone.
    save("type_int32_half", {halved(ints)}, 6);

    // Grids of halves.
    auto toHalf = [](int x, int y, int z) { return Half(float(wave(x, y, z))); };
    for (uint32_t flags : {1u, 2u, 3u, 4u, 6u}) {
        auto grid = ball<HalfGrid>("density", Half(0.25f), toHalf, true, true);
        if (flags == 3) grid->setSaveFloatAsHalf(true);
        save(std::string("half_grid_") + names[flags], {grid}, flags);
        patchVersion(directory + "/half_grid_" + names[flags] + ".vdb", 225);
    }
    // Inactive values of every kind, and values that are not finite.
    {
        auto grid = ball<HalfGrid>("density", Half(0.25f), toHalf, false, false);
        auto& tree = grid->tree();
        for (int n = 0; n < 512; ++n) {
            const Coord at(n >> 6, n >> 3 & 7, n & 7);
            const Half values[] = {Half(-0.25f), Half(0.25f), Half(3.0f), Half(-7.0f)};
            tree.setValueOff(at.offsetBy(64, 0, 0), values[0]);
            tree.setValueOff(at.offsetBy(72, 0, 0), values[n % 2]);
            tree.setValueOff(at.offsetBy(80, 0, 0), values[2]);
            tree.setValueOff(at.offsetBy(88, 0, 0), values[1 + n % 2]);
            tree.setValueOff(at.offsetBy(96, 0, 0), values[2 + n % 2]);
            tree.setValueOff(at.offsetBy(104, 0, 0), Half(float(n)));
        }
        for (int n = 0; n < 6; ++n) tree.setValueOn(Coord(-128 + 8 * n, 1, 1), Half(float(n)));
        tree.setValueOn(Coord(-128, 3, 3), Half(std::numeric_limits<float>::infinity()));
        tree.setValueOn(Coord(-120, 3, 3), Half(std::numeric_limits<float>::quiet_NaN()));
        tree.setValueOn(Coord(-112, 3, 3), Half(6e-8f));
        save("half_grid_inactive", {grid}, 6);
        patchVersion(directory + "/half_grid_inactive.vdb", 225);
    }

    // Instances of a grid of vectors.
    {
        auto instance = GridBase::Ptr(vec3s->copyGrid());
        instance->setName("velocity_elsewhere");
        instance->setTransform(math::Transform::createLinearTransform(math::Mat4d(
            0.5, 0.1, 0.0, 0.0, -0.2, 0.4, 0.0, 0.0, 0.0, 0.0, 0.3, 0.0, 1.0, 2.0, 3.0, 1.0)));
        save("instanced_vec3s", {vec3s, instance}, 6);
    }
    // Written to a stream, without offsets: one grid after the other, of many types.
    save("stream_reals", {halved(ball<FloatGrid>("density", 0.5f, real, true, false)), doubles, longs}, 3, true);
    save("stream_others", {bools, mask, vec3i, halved(vec3d), ball<FloatGrid>("density", 0.5f, real, true, false)}, 6, true);
    return 0;
}
