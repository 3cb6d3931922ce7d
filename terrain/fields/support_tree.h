// Rectangles of the plane in a tree: which of many overlap a given one, without asking the others.
#pragma once

#include "terrain/fields/height.h"

#include <cstdint>
#include <span>
#include <vector>

namespace hoodoo
{

/// A value; empty at first. Rectangles may be infinite.
class SupportTree
{
public:
    SupportTree() = default;
    explicit SupportTree(std::span<const Box2d> boxes);

    /// Numbers of all rectangles that meet `area`, borders included, in ascending order.
    void find(const Box2d& area, std::vector<std::uint32_t>& found) const;

    /// visit(number) for each of them; few rectangles are just looked at.
    template <class Visit>
    void for_each(const Box2d& area, const Visit& visit) const
    {
        if (boxes_.size() <= kFew) {
            for (std::uint32_t n = 0; n < boxes_.size(); ++n)
                if (boxes_[n].intersects(area)) visit(n);
            return;
        }
        std::vector<std::uint32_t> found;
        find(area, found);
        for (const std::uint32_t n : found) visit(n);
    }

private:
    static constexpr std::size_t kFew = 16;

    struct Node {
        Box2d box;
        std::uint32_t first, count;  ///< of order_; an inner node's count is 0 and its children are `first` and `first + 1`
    };
    void split(std::size_t node, std::uint32_t first, std::uint32_t count);

    std::vector<Box2d> boxes_;
    std::vector<std::uint32_t> order_;
    std::vector<Node> nodes_;
};

}  // namespace hoodoo
