// The rock layers of a stack as a volume that holds rocks.
#pragma once

#include "terrain/rocks/placement.h"
#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// Beyond the grid there are no rocks; what lies there is air with a cut border, else what the edge columns hold.
class StackRocks final : public RockVolume
{
public:
    StackRocks(std::shared_ptr<const MaterialStack> stack, Border border);
    Box3d bounds() const override;
    Box3d room() const override;
    Interval heights(const Vec2d& lo, const Vec2d& hi) const override;
    bool holds(const Vec3d& p) const override;
    bool air_within(const Vec3d& p, double distance) const override;
    bool ground(const Vec3d& p) const override;

    /// The stack was edited there and nowhere else.
    void follow(const ColumnSet& changed);

private:
    /// Rock in a square of columns, units above the origin; low > high if there is none.
    struct Block {
        std::int32_t low = MaterialStack::max_top + 1, high = -1;
    };
    Block look(int i0, int i1, int j0, int j1) const;
    void look_at_block(std::size_t index);
    /// Within sqrt(within2) of height z; all in units.
    bool column_has_air(int i, int j, double z, double within2) const;
    Vec2i column_of(const Vec3d& p) const;

    std::shared_ptr<const MaterialStack> stack_;
    Border border_;
    Vec2i blocks_;             ///< along x and y, each a tile of the stack
    std::vector<Block> rock_;  ///< by block, row by row
};

}  // namespace hoodoo
