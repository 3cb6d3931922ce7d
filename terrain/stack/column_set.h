// Which columns of a grid an operator touched: what a rebuild has to look at, and what a test may find changed.
#pragma once

#include "terrain/math/vec.h"

#include <algorithm>
#include <cstdint>
#include <vector>

namespace hoodoo
{

/// Columns as sorted, unique indices j * size.x + i: its cost follows the region, not the grid. A value.
class ColumnSet
{
public:
    explicit ColumnSet(Vec2i size) : size_(size) {}

    /// Any order, repeats allowed: sorts.
    ColumnSet(Vec2i size, std::vector<std::uint32_t> indices) : size_(size), indices_(std::move(indices))
    {
        std::sort(indices_.begin(), indices_.end());
        indices_.erase(std::unique(indices_.begin(), indices_.end()), indices_.end());
    }

    Vec2i size() const { return size_; }
    std::size_t count() const { return indices_.size(); }
    bool empty() const { return indices_.empty(); }
    const std::vector<std::uint32_t>& indices() const { return indices_; }
    std::uint32_t index(int i, int j) const
    {
        return static_cast<std::uint32_t>(j) * static_cast<std::uint32_t>(size_.x) + static_cast<std::uint32_t>(i);
    }
    Vec2i column(std::uint32_t index) const
    {
        const auto width = static_cast<std::uint32_t>(size_.x);
        return {static_cast<int>(index % width), static_cast<int>(index / width)};
    }
    bool contains(int i, int j) const { return std::binary_search(indices_.begin(), indices_.end(), index(i, j)); }

    void add(const ColumnSet& other)
    {
        std::vector<std::uint32_t> both;
        both.reserve(indices_.size() + other.indices_.size());
        std::set_union(indices_.begin(), indices_.end(), other.indices_.begin(), other.indices_.end(), std::back_inserter(both));
        indices_ = std::move(both);
    }

private:
    Vec2i size_;
    std::vector<std::uint32_t> indices_;
};

}  // namespace hoodoo
