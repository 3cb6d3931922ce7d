// Columns of layers packed into 16-bit words, tile by tile, so that a whole landscape fits into a few bytes a column.
// Peytavie2009, section 3.1: a stack lists its layers bottom to top; the paper's 8000 height steps fit into 13 bits, its materials into 3.
// Memory: size.x size.y (2 + 2 n) bytes for n layers a column, and 32 bytes a tile.
// Deviation: the paper does not say how columns are addressed; here each tile of 32 x 32 has 16-bit offsets, hence at most 65535 layers a tile.
#include "terrain/stack/material_stack.h"

#include "terrain/error.h"

#include <fmt/format.h>

namespace hoodoo
{

namespace
{

const std::array<std::string, kMaterialCount> kNames = {"air", "water", "sand", "bedrock", "rock", "soil"};

std::uint16_t pack(Material material, std::int32_t top)
{
    return static_cast<std::uint16_t>((top << 3) | static_cast<int>(material));
}

[[noreturn]] void refuse(int i, int j, std::string what, std::string expected, std::string got)
{
    throw Error(ErrorKind::scene, Problem{{}, fmt::format("column ({}, {}): {}", i, j, what), std::move(expected), std::move(got), {}});
}

/// The column in its one canonical form: no empty layers, no equal neighbours, no air on top.
std::vector<std::uint16_t> pack_column(int i, int j, std::span<const Layer> layers)
{
    std::vector<std::uint16_t> words;
    words.reserve(layers.size());
    std::int32_t below = 0;
    for (const Layer& layer : layers) {
        if (static_cast<std::size_t>(layer.material) >= kMaterialCount)
            refuse(i, j, "unknown material", "a code below 6", fmt::to_string(int(layer.material)));
        if (layer.top < below)
            refuse(i, j, "a layer ends below the one under it", fmt::format("a top of at least {} units", below), fmt::to_string(layer.top));
        if (layer.top > MaterialStack::max_top) {
            refuse(i, j, "a layer is too high", fmt::format("a top of at most {} units", MaterialStack::max_top), fmt::to_string(layer.top));
        }
        if (layer.top == below) continue;
        if (!words.empty() && MaterialStack::material_of(words.back()) == layer.material) words.pop_back();
        words.push_back(pack(layer.material, layer.top));
        below = layer.top;
    }
    if (!words.empty() && MaterialStack::material_of(words.back()) == Material::air) words.pop_back();
    return words;
}

}  // namespace

const std::string& material_name(Material material)
{
    return kNames.at(static_cast<std::size_t>(material));
}

Material material_from_name(const std::string& name)
{
    for (std::size_t m = 0; m < kMaterialCount; ++m) {
        if (kNames[m] == name) return static_cast<Material>(m);
    }
    const std::vector<std::string> names(kNames.begin(), kNames.end());
    throw Error(ErrorKind::scene,
                Problem{{}, "unknown material", "air, water, sand, bedrock, rock or soil", '"' + name + '"', nearest_name(name, names)});
}

MaterialStack::MaterialStack(Vec2i size, double cell, double unit, Vec3d origin) : size_(size), cell_(cell), unit_(unit), origin_(origin)
{
    const auto check = [](bool good, const char* what, const char* expected, std::string got) {
        if (!good) throw Error(ErrorKind::scene, Problem{{}, what, expected, std::move(got), {}});
    };
    check(size.x >= 1 && size.y >= 1 && size.x <= (1 << 20) && size.y <= (1 << 20), "size of a material stack", "1 to 1048576 columns each way",
          fmt::format("{} x {}", size.x, size.y));
    check(std::isfinite(cell) && cell > 0.0, "cell of a material stack", "a positive length in metres", fmt::to_string(cell));
    check(std::isfinite(unit) && unit > 0.0, "height unit of a material stack", "a positive length in metres", fmt::to_string(unit));
    check(is_finite(origin), "origin of a material stack", "finite coordinates", fmt::format("({}, {}, {})", origin.x, origin.y, origin.z));
    tiles_x_ = (size.x + tile_size - 1) / tile_size;
    tiles_y_ = (size.y + tile_size - 1) / tile_size;
    tiles_.resize(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>(tiles_y_));
}

std::int32_t MaterialStack::highest_top() const
{
    std::int32_t highest = 0;
    for (const Tile& tile : tiles_) {
        for (const std::uint16_t word : tile.words) highest = std::max(highest, top_of(word));
    }
    return highest;
}

std::vector<Layer> MaterialStack::column(int i, int j) const
{
    std::vector<Layer> layers;
    for (const std::uint16_t word : words(i, j)) layers.push_back({material_of(word), top_of(word)});
    return layers;
}

void MaterialStack::set_column(int i, int j, std::span<const Layer> layers)
{
    const std::vector<Layer> column(layers.begin(), layers.end());
    set_columns({i, j}, {i + 1, j + 1}, {&column, 1});
}

void MaterialStack::set_columns(Vec2i from, Vec2i to, std::span<const std::vector<Layer>> columns)
{
    const int width = to.x - from.x;
    if (from.x < 0 || from.y < 0 || to.x > size_.x || to.y > size_.y || width < 0 || to.y < from.y ||
        columns.size() != static_cast<std::size_t>(width) * static_cast<std::size_t>(to.y - from.y)) {
        throw Error(ErrorKind::scene, Problem{{},
                                              "columns to set",
                                              fmt::format("a rectangle inside {} x {} and one column for each of its cells", size_.x, size_.y),
                                              fmt::format("[{}, {}) x [{}, {}) and {} columns", from.x, to.x, from.y, to.y, columns.size()),
                                              {}});
    }
    if (columns.empty()) return;
    for (int tj = from.y / tile_size; tj <= (to.y - 1) / tile_size; ++tj) {
        for (int ti = from.x / tile_size; ti <= (to.x - 1) / tile_size; ++ti) {
            // Copy what stays, pack what changes, then swap: a refused column leaves its tile as it was.
            Tile fresh;
            Tile& old = tiles_[static_cast<std::size_t>(tj * tiles_x_ + ti)];
            for (int c = 0; c < tile_size * tile_size; ++c) {
                const int i = ti * tile_size + c % tile_size;
                const int j = tj * tile_size + c / tile_size;
                if (i >= from.x && i < to.x && j >= from.y && j < to.y) {
                    const std::size_t at =
                        static_cast<std::size_t>(j - from.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i - from.x);
                    const std::vector<std::uint16_t> packed = pack_column(i, j, columns[at]);
                    fresh.words.insert(fresh.words.end(), packed.begin(), packed.end());
                } else if (i < size_.x && j < size_.y) {
                    const std::span<const std::uint16_t> kept = words(i, j);
                    fresh.words.insert(fresh.words.end(), kept.begin(), kept.end());
                }
                if (fresh.words.size() > 0xffff)
                    refuse(i, j, "too many layers in one tile of 32 x 32 columns", "at most 65535", fmt::to_string(fresh.words.size()));
                fresh.offsets[static_cast<std::size_t>(c) + 1] = static_cast<std::uint16_t>(fresh.words.size());
            }
            fresh.words.shrink_to_fit();
            old = std::move(fresh);
        }
    }
}

std::uint64_t MaterialStack::layer_count() const
{
    std::uint64_t count = 0;
    for (const Tile& tile : tiles_) count += tile.words.size();
    return count;
}

std::uint64_t MaterialStack::memory_bytes() const
{
    std::uint64_t bytes = sizeof(*this) + tiles_.capacity() * sizeof(Tile);
    for (const Tile& tile : tiles_) bytes += tile.words.capacity() * sizeof(std::uint16_t);
    return bytes;
}

Ground::Ground(std::shared_ptr<const MaterialStack> stack, MaterialSet materials, Border border, std::int32_t base_units)
    : stack_(std::move(stack)), materials_(materials), border_(border), base_(base_units)
{
    if (!stack_) throw Error(ErrorKind::internal, "a ground without a stack");
    if (contains(Material::air) || materials == 0 || (materials >> kMaterialCount) != 0) {
        throw Error(ErrorKind::scene,
                    Problem{{}, "materials of a ground", "some of water, sand, bedrock, rock, soil", fmt::format("the set {:#b}", materials), {}});
    }
    if (base_units < 0 || base_units > -bottomless) {
        throw Error(ErrorKind::scene, Problem{{}, "base of a cut block", "0 to 2^28 units", fmt::to_string(base_units), {}});
    }
}

}  // namespace hoodoo
