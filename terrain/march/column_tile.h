// The columns of one tile and its surroundings, laid out for adding up the kernel quickly.
#pragma once

#include "terrain/march/bernstein.h"
#include "terrain/march/kernel_frame.h"

#include <cstdint>

namespace hoodoo
{

/// A ray in the frame: position = origin + t * direction, t in metres.
struct FrameRay {
    Vec3d origin, direction;
    Vec3d at(double t) const { return origin + direction * t; }
};

/// What is known where a search begins: the side, and whether the point is a crossing itself, so that the sign computed there says nothing.
struct Start {
    bool inside = false;
    bool on_surface = false;
};

/// Runs of matter over a rectangle of columns. The run that begins at the floor is kept apart, one number a column, since most columns have
/// no other. Immutable after construction.
class ColumnTile
{
public:
    /// Columns [from, to) along each axis, of any place in the plane.
    ColumnTile(const Ground& ground, Vec2i from, Vec2i to);

    /// f - delta at a frame point whose kernel lies over the tile's columns: the same bits from every tile. Other points are moved there.
    double value(const KernelFrame& frame, const Vec3d& p) const;

    /// The first change of side of f - delta along the ray in (ta, tb), between which the ray meets no line of the lattice (KernelFrame::next_line).
    /// If there is none, `value` is f - delta at tb. Adds the number of sums to `evaluations`.
    bool first_change(const KernelFrame& frame, const FrameRay& ray, double ta, double tb, Start start, double& t, double& value,
                      std::uint32_t& evaluations) const;

    std::uint64_t memory_bytes() const;

private:
    struct PlacedRun {
        std::int32_t bottom, top, column;  ///< column along x
    };
    struct Window {
        int i0, i1, j0, j1;  ///< inclusive
    };
    std::size_t index(int i, int j) const { return static_cast<std::size_t>(j - from_.y) * stride_ + static_cast<std::size_t>(i - from_.x); }
    class Weights;
    class Bends;
    void collect_bends(const KernelFrame& frame, const Window& w, double z0, double z1, Bends& bends) const;
    Cubic piece(const KernelFrame& frame, const Window& w, const Weights& ax, const Weights& bx, const Vec3d& a, const Vec3d& b) const;
    Vec3d confine(const KernelFrame& frame, const Vec3d& p) const;

    Vec2i from_, to_;
    std::size_t stride_ = 0;
    std::vector<std::int32_t> base_;     ///< top of the run that begins at the floor; the floor itself if there is none
    std::vector<std::uint32_t> offset_;  ///< of a column's other runs; one more at the end
    std::vector<PlacedRun> runs_;
};

}  // namespace hoodoo
