// The rock layers of a stack as a volume that holds rocks.
#pragma once

#include "terrain/rocks/placement.h"
#include "terrain/stack/material_stack.h"

namespace hoodoo
{

/// Whether any column has a layer of rock.
bool has_rock_layers(const MaterialStack& stack);

/// Beyond the grid there are no rocks; what lies there is air with a cut border, else what the edge columns hold.
class StackRocks final : public RockVolume
{
public:
    StackRocks(std::shared_ptr<const MaterialStack> stack, Border border);
    Box3d bounds() const override { return bounds_; }
    Interval heights(const Vec2d& lo, const Vec2d& hi) const override;
    bool holds(const Vec3d& p) const override;
    bool air_within(const Vec3d& p, double distance) const override;
    bool ground(const Vec3d& p) const override;

private:
    bool column_has_air(int i, int j, double low, double high) const;
    Vec2i column_of(const Vec3d& p) const;

    std::shared_ptr<const MaterialStack> stack_;
    Border border_;
    Box3d bounds_;
};

}  // namespace hoodoo
