// Pieces of one column turned into another material: the last step of every tool that works on heights.
#pragma once

#include "terrain/stack/column_set.h"
#include "terrain/stack/material_stack.h"

#include <functional>
#include <span>
#include <vector>

namespace hoodoo
{

constexpr MaterialSet kEverything = (1u << kMaterialCount) - 1u;

/// Sorted, disjoint, not touching, none empty.
void unite(std::vector<Run>& runs);

/// The column with every material of `what` inside the runs (united) turned into `into`. Air above the last layer counts as air. Runs must not go
/// below 0, where there is bedrock that cannot be changed.
std::vector<Layer> overwrite(std::span<const Layer> layers, std::span<const Run> runs, MaterialSet what, Material into);

/// A rectangle of columns, [from, to).
struct ColumnBox {
    Vec2i from{0, 0}, to{0, 0};
    bool empty() const { return from.x >= to.x || from.y >= to.y; }
};

/// Columns whose middle lies in [low, high] (world metres, x and y), cut to the grid; empty if none does.
ColumnBox columns_within(const MaterialStack& stack, const Vec2d& low, const Vec2d& high);

/// Replaces the columns of the box by what `change` makes of them, in parallel; then sets those that differ. `change` must be thread-safe and may
/// look at the stack, which is the old one as long as it runs. Returns the columns that differ. Throws Error (scene) if a column would rise over the
/// stack's height range; the stack is then as it was.
ColumnSet change_columns(MaterialStack& stack, const ColumnBox& box,
                         const std::function<std::vector<Layer>(int i, int j, std::vector<Layer>)>& change);

/// The same for single columns, given as sorted indices j * size.x + i: only their tiles of the stack are written. `change` gets the place in the
/// list.
ColumnSet change_listed(MaterialStack& stack, std::span<const std::uint32_t> columns,
                        const std::function<std::vector<Layer>(std::size_t place, std::vector<Layer>)>& change);

/// Columns as they were before an edit of several steps, to return to if a later step fails.
class KeptColumns
{
public:
    void keep(const MaterialStack& stack, const ColumnBox& box);
    /// The last kept come back first.
    void restore(MaterialStack& stack) const;

private:
    struct Kept {
        ColumnBox box;
        std::vector<std::vector<Layer>> columns;
    };
    std::vector<Kept> kept_;
};

}  // namespace hoodoo
