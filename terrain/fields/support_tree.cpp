// A binary tree of rectangles, halved at the median of their middles along the longer side; answers are sorted, since operators care for the order.
#include "terrain/fields/support_tree.h"

#include <algorithm>
#include <numeric>

namespace hoodoo
{

namespace
{

constexpr std::uint32_t kLeaf = 4;  // rectangles that are tested one by one

/// Twice the middle; infinite sides count as 0.
double middle(const Box2d& box, int axis)
{
    const double sum = box.min[axis] + box.max[axis];
    return std::isfinite(sum) ? sum : 0.0;
}

}  // namespace

SupportTree::SupportTree(std::span<const Box2d> boxes) : boxes_(boxes.begin(), boxes.end()), order_(boxes.size())
{
    if (boxes.empty()) return;
    std::iota(order_.begin(), order_.end(), 0u);
    nodes_.emplace_back();
    split(0, 0, static_cast<std::uint32_t>(boxes.size()));
}

void SupportTree::split(std::size_t node, std::uint32_t first, std::uint32_t count)
{
    Box2d box, middles;
    for (std::uint32_t k = first; k < first + count; ++k) {
        const Box2d& own = boxes_[order_[k]];
        box.extendBy(own.min);
        box.extendBy(own.max);
        middles.extendBy(Vec2d(middle(own, 0), middle(own, 1)));
    }
    nodes_[node] = {box, first, count};
    if (count <= kLeaf) return;
    const int axis = middles.size().x >= middles.size().y ? 0 : 1;
    const std::uint32_t half = count / 2;
    std::nth_element(order_.begin() + first, order_.begin() + first + half, order_.begin() + first + count, [&](std::uint32_t a, std::uint32_t b) {
        const double ma = middle(boxes_[a], axis), mb = middle(boxes_[b], axis);
        return ma < mb || (ma == mb && a < b);
    });
    const std::size_t children = nodes_.size();
    nodes_[node].first = static_cast<std::uint32_t>(children);
    nodes_[node].count = 0;
    nodes_.resize(children + 2);
    split(children, first, half);
    split(children + 1, first + half, count - half);
}

void SupportTree::find(const Box2d& area, std::vector<std::uint32_t>& found) const
{
    found.clear();
    if (nodes_.empty()) return;
    std::uint32_t stack[64];
    int top = 0;
    stack[top++] = 0;
    while (top > 0) {
        const Node& node = nodes_[stack[--top]];
        if (!node.box.intersects(area)) continue;
        if (node.count == 0) {
            stack[top++] = node.first;
            stack[top++] = node.first + 1;
            continue;
        }
        for (std::uint32_t k = node.first; k < node.first + node.count; ++k)
            if (boxes_[order_[k]].intersects(area)) found.push_back(order_[k]);
    }
    std::sort(found.begin(), found.end());
}

}  // namespace hoodoo
