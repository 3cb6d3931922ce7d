// Runs and layers are both sorted lists of heights: one walk over both.
// Peytavie2009, section 4.1: the stacks that meet the region of an edit are subdivided into layers of air or bedrock. Missing: nothing.
#include "terrain/edit/overwrite.h"

#include "terrain/error.h"

#include <fmt/format.h>
#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace hoodoo
{

void unite(std::vector<Run>& runs)
{
    std::sort(runs.begin(), runs.end(), [](const Run& a, const Run& b) { return a.bottom < b.bottom; });
    std::size_t kept = 0;
    for (const Run& run : runs) {
        if (run.bottom >= run.top) continue;
        if (kept > 0 && run.bottom <= runs[kept - 1].top)
            runs[kept - 1].top = std::max(runs[kept - 1].top, run.top);
        else
            runs[kept++] = run;
    }
    runs.resize(kept);
}

std::vector<Layer> overwrite(std::span<const Layer> layers, std::span<const Run> runs, MaterialSet what, Material into)
{
    std::vector<Layer> out;
    const auto put = [&](Material material, std::int32_t top) {
        if (top <= (out.empty() ? 0 : out.back().top)) return;
        if (!out.empty() && out.back().material == material)
            out.back().top = top;
        else
            out.push_back({material, top});
    };
    std::int32_t below = 0;
    std::size_t first = 0;
    const auto walk = [&](Material material, std::int32_t top) {
        const bool changes = (what >> static_cast<unsigned>(material)) & 1u;
        while (first < runs.size() && runs[first].top <= below) ++first;
        for (std::size_t k = first; changes && k < runs.size() && runs[k].bottom < top; ++k) {
            put(material, std::max(below, runs[k].bottom));
            put(into, std::min(top, runs[k].top));
        }
        put(material, top);
        below = top;
    };
    for (const Layer& layer : layers) walk(layer.material, layer.top);
    if (!runs.empty()) walk(Material::air, std::max(below, runs.back().top));
    if (!out.empty() && out.back().material == Material::air) out.pop_back();
    return out;
}

ColumnBox columns_within(const MaterialStack& stack, const Vec2d& low, const Vec2d& high)
{
    const auto clip = [](double x, int n) { return static_cast<int>(std::clamp(x, 0.0, static_cast<double>(n))); };
    const auto first = [&](double x, double origin, int n) { return clip(std::ceil((x - origin) / stack.cell() - 0.5), n); };
    const auto last = [&](double x, double origin, int n) { return clip(std::floor((x - origin) / stack.cell() - 0.5) + 1.0, n); };
    const Vec2i n = stack.size();
    const Vec3d o = stack.origin();
    return {{first(low.x, o.x, n.x), first(low.y, o.y, n.y)}, {last(high.x, o.x, n.x), last(high.y, o.y, n.y)}};
}

namespace
{

std::int32_t top_of(const std::vector<Layer>& column)
{
    return column.empty() ? 0 : column.back().top;
}

/// Throws if the highest of the columns is too high; `place` tells which column of the grid the k-th is.
template <class Place>
void refuse_heights(const MaterialStack& stack, std::span<const std::vector<Layer>> columns, const Place& place)
{
    const auto worst = std::max_element(columns.begin(), columns.end(), [](const auto& a, const auto& b) { return top_of(a) < top_of(b); });
    if (worst == columns.end() || top_of(*worst) <= MaterialStack::max_top) return;
    const Vec2i at = place(static_cast<std::size_t>(worst - columns.begin()));
    throw Error(ErrorKind::scene,
                Problem{{},
                        fmt::format("column ({}, {}) would rise over the stack's height range", at.x, at.y),
                        fmt::format("at most z = {} m (a larger `unit` reaches higher)", stack.origin().z + MaterialStack::max_top * stack.unit()),
                        fmt::format("{} m", stack.origin().z + top_of(*worst) * stack.unit()),
                        {}});
}

}  // namespace

ColumnSet change_columns(MaterialStack& stack, const ColumnBox& box,
                         const std::function<std::vector<Layer>(int i, int j, std::vector<Layer>)>& change)
{
    if (box.empty()) return ColumnSet(stack.size());
    const int width = box.to.x - box.from.x;
    std::vector<std::vector<Layer>> columns(static_cast<std::size_t>(width) * static_cast<std::size_t>(box.to.y - box.from.y));
    std::vector<char> differs(columns.size());
    tbb::parallel_for(box.from.y, box.to.y, [&](int j) {
        for (int i = box.from.x; i < box.to.x; ++i) {
            const auto at = static_cast<std::size_t>(j - box.from.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(i - box.from.x);
            const std::vector<Layer> before = stack.column(i, j);
            columns[at] = change(i, j, before);
            differs[at] = columns[at] != before;
        }
    });
    refuse_heights(stack, columns, [&](std::size_t c) { return box.from + Vec2i(static_cast<int>(c) % width, static_cast<int>(c) / width); });
    std::vector<std::uint32_t> changed;
    const ColumnSet all(stack.size());
    for (std::size_t c = 0; c < columns.size(); ++c) {
        if (differs[c]) changed.push_back(all.index(box.from.x + static_cast<int>(c) % width, box.from.y + static_cast<int>(c) / width));
    }
    if (!changed.empty()) stack.set_columns(box.from, box.to, columns);
    return {stack.size(), std::move(changed)};
}

ColumnSet change_listed(MaterialStack& stack, std::span<const std::uint32_t> columns,
                        const std::function<std::vector<Layer>(std::size_t place, std::vector<Layer>)>& change)
{
    const ColumnSet all(stack.size());
    std::vector<std::vector<Layer>> fresh(columns.size());
    std::vector<char> differs(columns.size());
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, columns.size(), 64), [&](const auto& range) {
        for (std::size_t k = range.begin(); k < range.end(); ++k) {
            const Vec2i at = all.column(columns[k]);
            const std::vector<Layer> before = stack.column(at.x, at.y);
            fresh[k] = change(k, before);
            differs[k] = fresh[k] != before;
        }
    });
    refuse_heights(stack, fresh, [&](std::size_t k) { return all.column(columns[k]); });

    // Tile by tile of the stack, each written once.
    std::map<std::pair<int, int>, std::vector<std::size_t>> tiles;
    std::vector<std::uint32_t> changed;
    for (std::size_t k = 0; k < columns.size(); ++k) {
        if (!differs[k]) continue;
        changed.push_back(columns[k]);
        const Vec2i at = all.column(columns[k]);
        tiles[{at.y / MaterialStack::tile_size, at.x / MaterialStack::tile_size}].push_back(k);
    }
    for (const auto& [tile, places] : tiles) {
        ColumnBox box{stack.size(), {0, 0}};
        for (const std::size_t k : places) {
            const Vec2i at = all.column(columns[k]);
            box.from = Vec2i(std::min(box.from.x, at.x), std::min(box.from.y, at.y));
            box.to = Vec2i(std::max(box.to.x, at.x + 1), std::max(box.to.y, at.y + 1));
        }
        const int width = box.to.x - box.from.x;
        std::vector<std::vector<Layer>> block;
        for (int j = box.from.y; j < box.to.y; ++j) {
            for (int i = box.from.x; i < box.to.x; ++i) block.push_back(stack.column(i, j));
        }
        for (const std::size_t k : places) {
            const Vec2i at = all.column(columns[k]) - box.from;
            block[static_cast<std::size_t>(at.y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(at.x)] = std::move(fresh[k]);
        }
        stack.set_columns(box.from, box.to, block);
    }
    return {stack.size(), std::move(changed)};
}

void KeptColumns::keep(const MaterialStack& stack, const ColumnBox& box)
{
    if (box.empty()) return;
    Kept& kept = kept_.emplace_back(Kept{box, {}});
    for (int j = box.from.y; j < box.to.y; ++j) {
        for (int i = box.from.x; i < box.to.x; ++i) kept.columns.push_back(stack.column(i, j));
    }
}

void KeptColumns::restore(MaterialStack& stack) const
{
    for (auto kept = kept_.rbegin(); kept != kept_.rend(); ++kept) stack.set_columns(kept->box.from, kept->box.to, kept->columns);
}

}  // namespace hoodoo
