// The tool as rings of corners: sections interpolated along each arc, in frames that do not twist.
//
// Peytavie2009, section 4.2: (1) cracks are projected onto the surface, tunnels stay; (2) profiles are interpolated along the arcs and oriented by
// the surface's normal and the skeleton's tangent.
//
// CHOICES: frames are carried from the first normal (skeleton.h), on request the normal is taken anew at every step; an arc that begins where another
// has been takes over its normal. A projected skeleton is smoothed over about the tool's own size, or every pebble would turn it. Ends are round:
// sections shrink as a half ball's do, which also fills the corner where arcs meet.
//
// Roughness: a corner q away from the skeleton moves to q (1 + roughness n(p / wavelength)), n the noise sum over half its bound, z stretched by
// `bedding`. Missing: corners of the section that follow the surface's height left and right of the skeleton.
#include "terrain/edit/sweep.h"

#include "terrain/edit/aim.h"
#include "terrain/error.h"
#include "terrain/math/noise.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace hoodoo
{

namespace
{

constexpr int kCapRings = 8;
constexpr double kMostRings = 1e6;

/// Straight pieces meet at corners, which only round ends fill: each is an arc of its own.
Skeleton in_spans(const Skeleton& skeleton, bool smooth)
{
    if (smooth) return skeleton;
    Skeleton spans{skeleton.nodes, {}};
    for (const auto& arc : skeleton.arcs) {
        if (arc.size() == 1) spans.arcs.push_back(arc);
        for (std::size_t k = 0; k + 1 < arc.size(); ++k) spans.arcs.push_back({arc[k], arc[k + 1]});
    }
    return spans;
}

/// Rounds of the mean (a + 2b + c) / 4: their spread is sqrt(rounds / 2) steps, so 32 spread over 4 steps, half of the 8 that a tool's radius is
/// long.
constexpr int kSmoothingRounds = 32;

template <class T, class Access>
void smooth(std::vector<T>& list, const Access& access)
{
    for (int round = 0; round < kSmoothingRounds && list.size() > 2; ++round) {
        Vec3d last = access(list[0]);
        for (std::size_t k = 1; k + 1 < list.size(); ++k) {
            const Vec3d here = access(list[k]);
            access(list[k]) = (last + here * 2.0 + access(list[k + 1])) * 0.25;
            last = here;
        }
    }
}

class Maker
{
public:
    Maker(const SweepTool& tool, double cell, const ConvolutionField* field, const Projection& projection)
        : tool_(tool), skeleton_(in_spans(tool.skeleton, tool.smooth)), field_(field), projection_(projection), normal_at_(tool.skeleton.nodes.size())
    {
        double size = 0.0;
        for (const SweepNode& node : tool.nodes)
            size += node.scale * mean_radius(tool.profiles[node.profile]) / static_cast<double>(tool.nodes.size());
        step_ = size / 8.0;
        if (tool.roughness > 0.0) step_ = std::min(step_, tool.wavelength / 6.0);
        step_ = std::max(step_, 0.5 * cell);
        ends_.resize(skeleton_.nodes.size());
        for (const auto& arc : skeleton_.arcs) ++ends_[arc.front()], ++ends_[arc.back()];
        // A node inside one arc at which another ends is a meeting too.
        for (const auto& arc : skeleton_.arcs)
            for (std::size_t k = 1; k + 1 < arc.size(); ++k) ++ends_[arc[k]];
    }

    std::size_t arcs() const { return skeleton_.arcs.size(); }

    std::vector<Ring> tube(std::size_t arc)
    {
        const auto& nodes = skeleton_.arcs[arc];
        SkeletonPath path = arc_path(arc);
        for (const SkeletonStep& step : path) {
            if (step.node == std::floor(step.node)) normal_at_[nodes[static_cast<std::size_t>(step.node)]] = step.normal;
        }
        std::vector<Ring> rings;
        const auto rounded = [&](std::size_t node) { return tool_.round_ends || ends_[node] > 1; };
        if (rounded(nodes.front())) {
            for (int k = kCapRings; k > 0; --k) rings.push_back(cap(nodes, path.front(), -1.0, k));
        }
        for (const SkeletonStep& step : path) rings.push_back(ring(nodes, step, 0.0, 1.0));
        if (rounded(nodes.back())) {
            for (int k = 1; k <= kCapRings; ++k) rings.push_back(cap(nodes, path.back(), 1.0, k));
        }
        made_ += static_cast<double>(rings.size());
        return rings;
    }

private:
    void refuse_length(double steps) const
    {
        if (!(made_ + steps < kMostRings)) throw Error(ErrorKind::scene, "a sweep takes more than 1e6 steps: it is too long for so thin a tool");
    }

    SkeletonPath arc_path(std::size_t arc)
    {
        const auto& nodes = skeleton_.arcs[arc];
        double length = 0.0;
        for (std::size_t k = 0; k + 1 < nodes.size(); ++k) length += (skeleton_.nodes[nodes[k + 1]] - skeleton_.nodes[nodes[k]]).length();
        refuse_length(length / step_);
        SkeletonPath path = arc_steps(skeleton_, arc, step_, tool_.smooth);
        std::vector<Vec3d> wanted(path.size(), Vec3d(0, 0, 1));
        if (projection_) {
            for (std::size_t k = 0; k < path.size(); ++k) {
                path[k].at = projection_(path[k].at);
                wanted[k] = surface_normal(*field_, path[k].at);
            }
            smooth(
                path, [](auto& step) -> auto& { return step.at; });
            smooth(
                wanted, [](auto& normal) -> auto& { return normal; });
        }
        if (!tool_.carried) {
            frame_towards(path, wanted);
        } else {
            const std::optional<Vec3d>& known = normal_at_[nodes.front()];
            frame_minimally(path, known ? *known : wanted.front());
        }
        return path;
    }

    /// The section at a step, moved by `forwards` along the tangent and shrunk.
    Ring ring(const std::vector<std::size_t>& nodes, const SkeletonStep& step, double forwards, double shrink) const
    {
        const auto k = std::min(static_cast<std::size_t>(step.node), nodes.size() - 1), m = std::min(k + 1, nodes.size() - 1);
        const double u = step.node - static_cast<double>(k);
        const SweepNode &a = tool_.nodes[nodes[k]], &b = tool_.nodes[nodes[m]];
        const Profile2 &from = tool_.profiles[a.profile], &to = tool_.profiles[b.profile];
        const double scale = shrink * (a.scale + (b.scale - a.scale) * u), roll = a.roll + (b.roll - a.roll) * u;
        const Vec3d right = step.across() * std::cos(roll) - step.normal * std::sin(roll),
                    up = step.normal * std::cos(roll) + step.across() * std::sin(roll);
        const Vec3d centre = step.at + step.tangent * forwards;
        Ring ring;
        ring.corners.reserve(from.size());
        for (std::size_t c = 0; c < from.size(); ++c) {
            const Vec2d q = (from[c] + (to[c] - from[c]) * u) * scale;
            ring.corners.push_back(rough(centre, right * q.x + up * q.y));
        }
        return ring;
    }

    Ring cap(const std::vector<std::size_t>& nodes, const SkeletonStep& step, double side, int k) const
    {
        const SweepNode& node = tool_.nodes[side < 0.0 ? nodes.front() : nodes.back()];
        const double radius = node.scale * mean_radius(tool_.profiles[node.profile]), turn = 0.5 * std::numbers::pi * k / kCapRings;
        return ring(nodes, step, side * radius * std::sin(turn), k == kCapRings ? 0.0 : std::cos(turn));
    }

    Vec3d rough(const Vec3d& centre, const Vec3d& offset) const
    {
        if (!(tool_.roughness > 0.0)) return centre + offset;
        const Fractal fractal{4.0, 2.0, 0.5};
        Vec3d p = (centre + offset) / tool_.wavelength;
        p.z *= tool_.bedding;
        const double n = 2.0 * fbm(p, tool_.seed, fractal).value / fbm_bound(kNoise3Bound, fractal).value;
        return centre + offset * (1.0 + tool_.roughness * std::clamp(n, -1.0, 1.0));
    }

    const SweepTool& tool_;
    Skeleton skeleton_;
    const ConvolutionField* field_;
    const Projection& projection_;
    double step_ = 1.0, made_ = 0.0;
    std::vector<int> ends_;
    std::vector<std::optional<Vec3d>> normal_at_;
};

}  // namespace

std::vector<std::vector<Ring>> sweep_rings(const SweepTool& tool, double cell, const ConvolutionField* field, const Projection& projection)
{
    Maker maker(tool, cell, field, projection);
    std::vector<std::vector<Ring>> tubes;
    for (std::size_t arc = 0; arc < maker.arcs(); ++arc) tubes.push_back(maker.tube(arc));
    return tubes;
}

}  // namespace hoodoo
