// Rays through voxels: along a ray F is a cubic in each cell, and the first change of its sign is found without a tolerance (march/bernstein.h).
//
// Empty space is skipped three times: patches are blocks of cells that the surface crosses (Embree's tree over their boxes skips the rest), a patch's
// box is that of its crossed cells, and in it a bit a cell says whether there is anything to solve. Watertight: neighbouring cells share the corners
// of their common face, so F is continuous; the side of a ray is carried from cell to cell, so a crossing on a face is found whatever rounding does;
// a patch goes on a hair beyond its box, into its neighbours' cells, so a crossing on a patch's face lies well inside the reach of one that has it.
// The side where a ray enters a patch is the sign of the first coefficient. A cubic's coefficients are means of the corners: where all corners are of
// one sign the cubic is too. Deviation: none. Missing: several cells at once (SIMD).
#include "terrain/march/voxel_patches.h"

#include "terrain/fields/voxel_walk.h"
#include "terrain/march/bernstein.h"

#include <algorithm>
#include <cmath>

namespace hoodoo
{

namespace
{

/// How far a patch reaches beyond the box of its crossed cells, in cells: far above rounding, far below what can be seen.
constexpr double kHair = 1e-6;

/// What a ray carries through the cells of a patch. Distances are metres after `start`.
struct Passage {
    Vec3d origin, direction;  ///< in cells; the origin lies at `start`
    double start, t_min;      ///< metres along the ray
    Crossing wanted;
    bool inside = false;
    bool known = false;  ///< whether `inside` is

    bool counts(double t) const { return (inside || wanted == Crossing::any) && start + t > t_min; }

    /// A cell of one sign. True if it is another than the ray came with, and that counts.
    bool enter_plain(bool now_inside, double t)
    {
        const bool changed = known && now_inside != inside;
        inside = now_inside, known = true;
        return changed && counts(t);
    }

    /// The first crossing that counts in a cell that the surface crosses, between `from` and `to`.
    bool cross(const std::array<float, 8>& f, const Index3& c, double from, double to, double& t)
    {
        const Vec3d end = in_cell(origin + direction * to, c);
        // A cubic has three roots at most; each round takes one.
        for (int round = 0; round < 4; ++round) {
            Cubic b = cubic_between(f, in_cell(origin + direction * from, c), end);
            if (!known) inside = b[0] < 0.0, known = true;
            // After a crossing the value at its place is a rounding of zero, of either sign: the side is known.
            if (round > 0) b[0] = inside ? std::min(b[0], 0.0) : std::max(b[0], 0.0);
            double u = 0.0;
            if (!first_change(b, inside, u)) return false;
            inside = !inside;
            from += (to - from) * u;
            t = from;
            if (counts(t)) return true;
        }
        return false;
    }
};

}  // namespace

VoxelPatches::VoxelPatches(std::shared_ptr<const VoxelGrid> grid) : grid_(std::move(grid))
{
    const SparseLattice<float>& values = grid_->values;
    double largest = 0.0;
    each_doubtful_block(values, [&](const Index3& b) {
        Patch patch{b, {7, 7, 7}, {0, 0, 0}, {}};
        bool any = false;
        each_crossed_cell(values, b, [&](const Index3& c, const std::array<float, 8>& f) {
            any = true;
            ++crossed_;
            for (std::size_t k = 0; k < 3; ++k) {
                const auto at = static_cast<std::uint8_t>(c[k] & 7);
                patch.lo[k] = std::min(patch.lo[k], at);
                patch.hi[k] = std::max(patch.hi[k], at);
            }
            patch.crossed[static_cast<std::size_t>(c[0] & 7)] |= std::uint64_t{1} << ((c[1] & 7) * 8 + (c[2] & 7));
            for (const float x : f) largest = std::max(largest, static_cast<double>(std::abs(x)));
        });
        if (any) patches_.push_back(patch);
    });
    patches_.shrink_to_fit();
    value_error_ = 0x1p-44 * largest;
    const Box3d box = grid_->box();
    double far = 0.0;
    for (int k = 0; k < 3; ++k) far = std::max({far, std::abs(box.min[k]), std::abs(box.max[k])});
    rounding_ = 0x1p-48 * far;
}

Box3d VoxelPatches::patch_bounds(std::uint32_t index) const
{
    const Patch& p = patches_[index];
    Box3d box;
    for (int k = 0; k < 3; ++k) {
        const auto at = static_cast<std::size_t>(k);
        // Not beyond the lattice, where there are no cells; its outermost samples are air, so no crossing is lost.
        box.min[k] = std::max(8.0 * p.block[at] + p.lo[at] - kHair, 0.0);
        box.max[k] = std::min(8.0 * p.block[at] + p.hi[at] + 1.0 + kHair, grid_->values.size()[at] - 1.0);
    }
    return {grid_->world(box.min) - Vec3d(rounding_), grid_->world(box.max) + Vec3d(rounding_)};
}

bool VoxelPatches::is_crossed_cell(const Patch& patch, const Index3& c) const
{
    return (patch.crossed[static_cast<std::size_t>(c[0] & 7)] >> ((c[1] & 7) * 8 + (c[2] & 7))) & 1u;
}

bool VoxelPatches::intersect(std::uint32_t index, const Ray& ray, Hit& hit) const
{
    const Patch& patch = patches_[index];
    const Box3d box = patch_bounds(index);
    double a = ray.t_min, b = ray.t_max;
    for (int k = 0; k < 3; ++k) {
        const double d = ray.direction[k], o = ray.origin[k];
        if (d == 0.0) {
            if (!(o >= box.min[k] && o <= box.max[k])) return false;
            continue;
        }
        const double t0 = (box.min[k] - o) / d, t1 = (box.max[k] - o) / d;
        a = std::max(a, std::min(t0, t1));
        b = std::min(b, std::max(t0, t1));
    }
    // The whole way, whatever was found before, but no farther than what counts: a crossing must not depend on the order of patches.
    if (!(a < b && b < kInfinity && a < hit.t)) return false;

    Passage passage{grid_->local(ray.at(a)), ray.direction / grid_->cell, a, ray.t_min, ray.crossing};
    Index3 first, last;
    const Index3& size = grid_->values.size();
    for (std::size_t k = 0; k < 3; ++k) {
        first[k] = std::max(8 * patch.block[k] + patch.lo[k] - 1, 0);
        last[k] = std::min(8 * patch.block[k] + patch.hi[k] + 1, size[k] - 2);
    }
    bool found = false;
    walk_cells(passage.origin, passage.direction, 0.0, b - a, first, last, [&](const Index3& c, double from, double to) {
        if (a + from >= hit.t) return false;
        const bool own = c[0] >> 3 == patch.block[0] && c[1] >> 3 == patch.block[1] && c[2] >> 3 == patch.block[2];
        double t = from;
        bool met = false;
        if (own && !is_crossed_cell(patch, c)) {
            met = passage.enter_plain(grid_->at(c) < 0.0f, t);
        } else {
            // In a neighbour's cell, a hair beyond, nobody has looked yet.
            const std::array<float, 8> f = cell_corners(grid_->values, c);
            met = own || is_crossed(f) ? passage.cross(f, c, from, to, t) : passage.enter_plain(f[0] < 0.0f, t);
            ++hit.evaluations;
        }
        if (!met) return true;
        found = a + t < hit.t;
        if (found) hit.t = a + t, hit.patch = {0, index};
        return false;
    });
    return found;
}

}  // namespace hoodoo
