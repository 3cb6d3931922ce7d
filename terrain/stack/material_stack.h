// A terrain as layers of material over a grid of columns (Peytavie2009, section 3): compact, tiled, editable.
#pragma once

#include "terrain/math/vec.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace hoodoo
{

/// Three bits; two codes are free.
enum class Material : std::uint8_t { air, water, sand, bedrock, rock, soil };
constexpr std::size_t kMaterialCount = 6;

const std::string& material_name(Material material);
/// Throws Error (scene) that names the nearest material.
Material material_from_name(const std::string& name);

/// A set of materials as bits, bit m = Material m.
using MaterialSet = std::uint8_t;
constexpr MaterialSet material_set(std::initializer_list<Material> materials)
{
    MaterialSet set = 0;
    for (const Material m : materials) set = static_cast<MaterialSet>(set | (1u << static_cast<unsigned>(m)));
    return set;
}
constexpr MaterialSet kGround = material_set({Material::sand, Material::bedrock});

/// One layer: its material up to `top`, in units of MaterialStack::unit() above the stack's origin; it begins where the one below ends.
struct Layer {
    Material material = Material::bedrock;
    std::int32_t top = 0;
    bool operator==(const Layer&) const = default;
};

/// Columns (i, j) cover [origin.x + i cell, origin.x + (i+1) cell] x [origin.y + j cell, ...]. A column lists its layers from bottom to top:
/// below z = origin.z there is bedrock, above the last layer air, both implicit. Tops strictly increase, equal neighbours are merged, no
/// explicit air on top. One 16-bit word a layer: 13 bits of top, 3 bits of material (maths of the encoding: 2 bytes a layer, 2 a column).
/// Tiles of 32 x 32 columns own their words, so that an edit rebuilds only its tiles. Copying copies; reading is thread-safe.
class MaterialStack
{
public:
    static constexpr std::int32_t max_top = 8191;
    static constexpr int tile_size = 32;

    /// All columns empty (bedrock below, air above). `cell` and `unit` in metres, > 0; size >= 1 each. Throws Error (scene).
    MaterialStack(Vec2i size, double cell, double unit, Vec3d origin = Vec3d(0.0));

    Vec2i size() const { return size_; }
    double cell() const { return cell_; }
    double unit() const { return unit_; }
    const Vec3d& origin() const { return origin_; }
    /// Highest top of all columns, in units.
    std::int32_t highest_top() const;

    /// The packed words of column (i, j), 0 <= i < size.x, 0 <= j < size.y, bottom to top.
    std::span<const std::uint16_t> words(int i, int j) const
    {
        // Unsigned, so that tile and place in it are shifts and masks.
        const unsigned x = static_cast<unsigned>(i), y = static_cast<unsigned>(j);
        const Tile& tile = tiles_[y / tile_size * static_cast<unsigned>(tiles_x_) + x / tile_size];
        const unsigned c = y % tile_size * tile_size + x % tile_size;
        const std::size_t from = tile.offsets[c], to = tile.offsets[c + 1];
        return {tile.words.data() + from, to - from};
    }
    static Material material_of(std::uint16_t word) { return static_cast<Material>(word & 7u); }
    static std::int32_t top_of(std::uint16_t word) { return word >> 3; }

    std::vector<Layer> column(int i, int j) const;

    /// Replaces column (i, j). Merges equal neighbours, drops empty layers and air on top. Throws Error (scene) naming the column if tops
    /// decrease or leave [0, max_top]. Rebuilds the tile: to change many columns use set_columns.
    void set_column(int i, int j, std::span<const Layer> layers);
    /// Replaces the columns of a rectangle [i0, i1) x [j0, j1), row by row (i fastest).
    void set_columns(Vec2i from, Vec2i to, std::span<const std::vector<Layer>> columns);

    std::uint64_t layer_count() const;
    std::uint64_t memory_bytes() const;

private:
    struct Tile {
        std::array<std::uint16_t, tile_size * tile_size + 1> offsets{};
        std::vector<std::uint16_t> words;
    };
    Vec2i size_;
    double cell_, unit_;
    Vec3d origin_;
    int tiles_x_ = 0, tiles_y_ = 0;
    std::vector<Tile> tiles_;
};

/// How a terrain goes on beyond its grid: the edge columns repeated for ever, or a block cut out with walls and a bottom.
enum class Border : std::uint8_t { extend, cut };

/// One vertical run of matter, in units above the stack's origin.
struct Run {
    std::int32_t bottom, top;
};

/// The matter of a material set, as vertical runs, for ANY column of the plane: the border rule is applied here and nowhere else.
/// With `extend` the implicit bedrock below reaches to bottomless; with `cut` there is nothing outside the grid and nothing below -base.
class Ground
{
public:
    static constexpr std::int32_t bottomless = -(1 << 28);

    Ground(std::shared_ptr<const MaterialStack> stack, MaterialSet materials, Border border, std::int32_t base_units = 0);

    const MaterialStack& stack() const { return *stack_; }
    MaterialSet materials() const { return materials_; }
    Border border() const { return border_; }
    std::int32_t floor() const { return border_ == Border::cut ? -base_ : bottomless; }

    /// Calls visit(bottom, top, is_matter) for each layer of column (i, j), bottom to top, the implicit base first; air above the last is left out.
    template <class Visit>
    void for_each_layer(int i, int j, Visit&& visit) const
    {
        const Vec2i n = stack_->size();
        if (border_ == Border::cut && (i < 0 || j < 0 || i >= n.x || j >= n.y)) return;
        i = i < 0 ? 0 : i >= n.x ? n.x - 1 : i;
        j = j < 0 ? 0 : j >= n.y ? n.y - 1 : j;
        visit(floor(), 0, contains(Material::bedrock));
        std::int32_t below = 0;
        for (const std::uint16_t word : stack_->words(i, j)) {
            const std::int32_t top = MaterialStack::top_of(word);
            visit(below, top, contains(MaterialStack::material_of(word)));
            below = top;
        }
    }

    /// Calls visit(Run) for each maximal run of column (i, j), bottom to top. Runs do not touch. The lowest begins at floor() if bedrock is in the
    /// set.
    template <class Visit>
    void for_each_run(int i, int j, Visit&& visit) const
    {
        Run run{0, 0};
        bool open = false;
        for_each_layer(i, j, [&](std::int32_t bottom, std::int32_t top, bool in) {
            if (top == bottom) return;
            if (in && !open) run.bottom = bottom;
            if (!in && open) visit(Run{run.bottom, bottom});
            open = in;
            run.top = top;
        });
        if (open) visit(run);
    }

    /// Length of matter of column (i, j) between the heights `low` and `high`, in units above the stack's origin. low <= high.
    double length(int i, int j, double low, double high) const
    {
        double sum = 0.0, from = std::min(std::max<double>(floor(), low), high);
        for_each_layer(i, j, [&](std::int32_t, std::int32_t top, bool in) {
            const double to = std::min(std::max<double>(top, low), high);
            sum += in ? to - from : 0.0;
            from = to;
        });
        return sum;
    }

    bool contains(Material m) const { return (materials_ >> static_cast<unsigned>(m)) & 1u; }

private:
    std::shared_ptr<const MaterialStack> stack_;
    MaterialSet materials_;
    Border border_;
    std::int32_t base_;
};

}  // namespace hoodoo
