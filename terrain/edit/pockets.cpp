// Columns unpacked into pockets, and packed again: bedrock stays where it is, so the pockets of a column keep their number while material moves.
// Peytavie2009, section 3.4: merging and sorting between bedrock is what unpacking does, since a pocket holds one thickness a material.
#include "terrain/edit/pockets.h"

namespace hoodoo
{

namespace
{

constexpr std::array<std::size_t, kMaterialCount> loose_index()
{
    std::array<std::size_t, kMaterialCount> index{};
    for (std::size_t k = 0; k < kLooseOrder.size(); ++k) index[static_cast<std::size_t>(kLooseOrder[k])] = k;
    return index;
}
constexpr std::array<std::size_t, kMaterialCount> kLooseIndex = loose_index();

void unpack_column(std::span<const std::uint16_t> words, std::vector<Pocket>& pockets)
{
    Pocket open;
    std::int32_t below = 0;
    for (const std::uint16_t word : words) {
        const Material material = MaterialStack::material_of(word);
        const std::int32_t top = MaterialStack::top_of(word);
        if (material == Material::bedrock) {
            open.ceiling = static_cast<std::int16_t>(below);
            if (open.ceiling > open.floor) pockets.push_back(open);
            open = Pocket{};
            open.floor = static_cast<std::int16_t>(top);
        } else if (material != Material::air) {
            std::int16_t& thickness = open.loose[kLooseIndex[static_cast<std::size_t>(material)]];
            thickness = static_cast<std::int16_t>(thickness + top - below);
        }
        below = top;
    }
    pockets.push_back(open);
}

void pack_column(std::span<const Pocket> pockets, std::vector<Layer>& layers)
{
    layers.clear();
    std::int32_t top = 0;
    const auto put = [&](Material material, std::int32_t to) {
        if (to > top) layers.push_back({material, to});
        top = std::max(top, to);
    };
    for (const Pocket& pocket : pockets) {
        put(Material::bedrock, pocket.floor);
        for (std::size_t k = 0; k < kLooseOrder.size(); ++k) put(kLooseOrder[k], top + pocket.loose[k]);
        if (&pocket != &pockets.back()) put(Material::air, pocket.ceiling);
    }
}

}  // namespace

PocketGrid::PocketGrid(MaterialStack& stack) : stack_(stack), tiles_x_((stack.size().x + tile_size - 1) / tile_size)
{
    tiles_.resize(static_cast<std::size_t>(tiles_x_) * static_cast<std::size_t>((stack.size().y + tile_size - 1) / tile_size));
}

std::unique_ptr<PocketGrid::Tile> PocketGrid::unpack(int ti, int tj) const
{
    auto tile = std::make_unique<Tile>();
    tile->pockets.reserve(2 * tile_size * tile_size);
    for (int c = 0; c < tile_size * tile_size; ++c) {
        const int i = ti * tile_size + c % tile_size, j = tj * tile_size + c / tile_size;
        if (inside(i, j)) unpack_column(stack_.words(i, j), tile->pockets);
        tile->begins[static_cast<std::size_t>(c) + 1] = static_cast<std::uint32_t>(tile->pockets.size());
    }
    return tile;
}

ColumnSet PocketGrid::write()
{
    std::vector<std::uint32_t> changed;
    const ColumnSet grid(stack_.size());
    std::vector<Layer> packed;
    for (std::size_t t = 0; t < tiles_.size(); ++t) {
        if (!tiles_[t]) continue;
        const int i0 = static_cast<int>(t % static_cast<std::size_t>(tiles_x_)) * tile_size,
                  j0 = static_cast<int>(t / static_cast<std::size_t>(tiles_x_)) * tile_size;
        const Vec2i to(std::min(i0 + tile_size, stack_.size().x), std::min(j0 + tile_size, stack_.size().y));
        std::vector<std::vector<Layer>> columns;
        const std::size_t before = changed.size();
        for (int j = j0; j < to.y; ++j) {
            for (int i = i0; i < to.x; ++i) {
                std::vector<Layer>& old = columns.emplace_back(stack_.column(i, j));
                if (!tiles_[t]->touched[place(i, j)]) continue;
                pack_column(column(i, j), packed);
                if (packed == old) continue;
                old = packed;
                changed.push_back(grid.index(i, j));
            }
        }
        if (changed.size() > before) stack_.set_columns({i0, j0}, to, columns);
    }
    return {stack_.size(), std::move(changed)};
}

}  // namespace hoodoo
