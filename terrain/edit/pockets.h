// A stack as the tools see it while loose material moves: each column a list of pockets between bedrock, unpacked tile by tile on demand.
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/stack/merge_and_sort.h"

#include <optional>

namespace hoodoo
{

/// What lies between two layers of bedrock, merged and sorted: thicknesses in kLooseOrder from the floor up, air above. Units of the stack.
/// The highest pocket of a column is open; its ceiling is the highest top a stack can tell.
struct Pocket {
    std::int16_t floor = 0, ceiling = MaterialStack::max_top;
    std::array<std::int16_t, kLooseOrder.size()> loose{};
    std::int16_t mark = 0;  ///< free for a search; 0 when unpacked

    /// Height of the surface of loose material `kind` (an index into kLooseOrder), as if nothing lay on it.
    std::int32_t top(std::size_t kind) const
    {
        std::int32_t sum = floor;
        for (std::size_t k = 0; k <= kind; ++k) sum += loose[k];
        return sum;
    }
    std::int32_t top() const { return top(loose.size() - 1); }
    std::int32_t room() const { return ceiling - top(); }
};

/// Copies what is looked at; the stack itself changes in write() alone. The cost follows the tiles looked at. Bedrock does not change here.
/// Not thread-safe: looking unpacks.
class PocketGrid
{
public:
    static constexpr int tile_size = MaterialStack::tile_size;

    /// `stack` must outlive the grid and not change until write().
    explicit PocketGrid(MaterialStack& stack);

    const MaterialStack& stack() const { return stack_; }
    bool inside(int i, int j) const { return i >= 0 && j >= 0 && i < stack_.size().x && j < stack_.size().y; }

    /// The pockets of column (i, j), which is inside, from the bottom up: at least one. Valid as long as the grid.
    std::span<Pocket> column(int i, int j)
    {
        Tile& tile = tile_of(i, j);
        const std::size_t c = place(i, j);
        return {tile.pockets.data() + tile.begins[c], static_cast<std::size_t>(tile.begins[c + 1] - tile.begins[c])};
    }
    /// Bits that belong to whoever works with the grid; 0 when unpacked.
    std::uint8_t& flags(int i, int j) { return tile_of(i, j).flags[place(i, j)]; }

    /// Column (i, j) shall be written.
    void touch(int i, int j) { tile_of(i, j).touched[place(i, j)] = 1; }

    /// Writes the touched columns back, merged and sorted; returns those whose layers differ from the stack's.
    ColumnSet write();

private:
    struct Tile {
        std::vector<Pocket> pockets;
        std::array<std::uint32_t, tile_size * tile_size + 1> begins{};
        std::array<std::uint8_t, tile_size * tile_size> flags{}, touched{};
    };
    static std::size_t place(int i, int j) { return static_cast<std::size_t>(j) % tile_size * tile_size + static_cast<std::size_t>(i) % tile_size; }
    Tile& tile_of(int i, int j)
    {
        std::unique_ptr<Tile>& tile =
            tiles_[static_cast<std::size_t>(j) / tile_size * static_cast<std::size_t>(tiles_x_) + static_cast<std::size_t>(i) / tile_size];
        if (!tile) tile = unpack(i / tile_size, j / tile_size);
        return *tile;
    }
    std::unique_ptr<Tile> unpack(int ti, int tj) const;

    MaterialStack& stack_;
    int tiles_x_;
    std::vector<std::unique_ptr<Tile>> tiles_;
};

/// The head under which loose material of `kind` runs from a pocket into one of a neighbouring column (maths: links between pockets), in units:
/// min(top of the source, ceiling of the target) - top of the target. Nothing if no opening connects them above the target's surface.
inline std::optional<std::int32_t> head(const Pocket& from, const Pocket& to, std::size_t kind)
{
    const std::int32_t mouth = std::min<std::int32_t>(from.top(kind), to.ceiling), surface = to.top(kind);
    if (mouth <= std::max<std::int32_t>(surface, from.floor)) return std::nullopt;
    return mouth - surface;
}

}  // namespace hoodoo
