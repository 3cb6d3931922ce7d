// Water stands in columns; the ground it stands on is smooth. The boxes of water reach into the ground by a kernel, and the ground's field cuts them
// off. Peytavie2009 lists water among the materials of a stack and says nothing of its surface. CHOICES: the top is flat at the layer's height. A
// column of ground within a kernel's reach of a wet column, of the same height or higher, is taken for wet up to the same level: between the two the
// smooth surface lies lower than the ground's columns, and without it the shore would stand open. Below, a box reaches a kernel into its bed (or to
// the bed's underside). A point of a box is an interface where the ground's field is positive there; elsewhere it lies in the ground, whose own
// surface closes the body. So the water's interface is the boundary of (boxes minus ground), exactly as far as it is not the ground's. Faces between
// boxes are no interface: the column on the other side is looked up. Boxes: in each tile of 32 x 32 columns, runs of the same top are joined along x,
// then along y, so that a lake of one level is one patch a tile. With `extend` the edge columns go on for ever and water has no face at the grid's
// edge; with `cut` it has. Deviations: behind a dam thinner than the kernel water may stand out of the dam's far side by less than a kernel. Missing:
// local rebuild.
#include "terrain/march/water_patches.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace hoodoo
{

/// Water of one column: a box over it may end anywhere between `lowest` and `bottom`.
struct WaterPatches::WetRun {
    std::int32_t lowest, bottom, top;
};

class WaterPatches::Builder
{
public:
    explicit Builder(WaterPatches& water) : w_(water), ground_(water.ground_.ground()), stack_(ground_.stack()), n_(stack_.size())
    {
        const double sigma = water.ground_.sigma();
        below_ = static_cast<std::int32_t>(std::min(std::ceil(sigma / stack_.unit()), 1e6));
        reach_ = static_cast<int>(std::ceil(sigma / stack_.cell()));
    }

    void build()
    {
        wet_.resize(static_cast<std::size_t>(n_.x) * static_cast<std::size_t>(n_.y));
        bool any = false;
        for (int j = 0; j < n_.y; ++j) {
            for (int i = 0; i < n_.x; ++i) any = own_runs(i, j) || any;
        }
        // Tiles are the same with and without water, so that water may come later.
        if (any) spread();
        cut_into_boxes();
        for (const auto& runs : box_runs_) {
            w_.column_begins_.push_back(static_cast<std::uint32_t>(w_.runs_.size()));
            w_.runs_.insert(w_.runs_.end(), runs.begin(), runs.end());
        }
        w_.column_begins_.push_back(static_cast<std::uint32_t>(w_.runs_.size()));
    }

private:
    std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * static_cast<std::size_t>(n_.x) + static_cast<std::size_t>(i); }

    bool own_runs(int i, int j)
    {
        std::int32_t below = 0, bed = ground_.contains(Material::bedrock) ? Ground::bottomless : 0;  // underside of the ground below
        bool matter = true;
        for (const std::uint16_t word : stack_.words(i, j)) {
            const Material material = MaterialStack::material_of(word);
            const std::int32_t top = MaterialStack::top_of(word);
            const bool is_ground = ground_.contains(material);
            if (is_ground && !matter) bed = below;
            if (material == Material::water) {
                const std::int32_t lowest = matter ? bed : below;
                wet_[at(i, j)].push_back({lowest, std::max(below - below_, lowest), top});
            }
            matter = is_ground;
            below = top;
        }
        return !wet_[at(i, j)].empty();
    }

    /// Gives the level of wet columns to the ground beside them.
    void spread()
    {
        const auto own = wet_;
        for (int j = 0; j < n_.y; ++j) {
            for (int i = 0; i < n_.x; ++i) {
                for (const WetRun& run : own[at(i, j)]) {
                    if (!inland(own, i, j, run)) spread_from(i, j, run);
                }
            }
        }
    }

    /// Whether all eight neighbours have the same water.
    bool inland(const std::vector<std::vector<WetRun>>& own, int i, int j, const WetRun& run) const
    {
        for (int b = std::max(j - 1, 0); b <= std::min(j + 1, n_.y - 1); ++b) {
            for (int a = std::max(i - 1, 0); a <= std::min(i + 1, n_.x - 1); ++a) {
                const auto& runs = own[at(a, b)];
                if (std::none_of(runs.begin(), runs.end(), [&](const WetRun& r) { return r.top == run.top; })) return false;
            }
        }
        return true;
    }

    void spread_from(int i, int j, const WetRun& run)
    {
        for (int b = std::max(j - reach_, 0); b <= std::min(j + reach_, n_.y - 1); ++b) {
            for (int a = std::max(i - reach_, 0); a <= std::min(i + reach_, n_.x - 1); ++a) {
                std::optional<std::int32_t> underside;
                ground_.for_each_run(a, b, [&](const Run& matter) {
                    if (matter.bottom < run.top && matter.top >= run.top) underside = matter.bottom;
                });
                if (underside) add(wet_[at(a, b)], {*underside, std::max(run.top - below_, *underside), run.top});
            }
        }
    }

    static void add(std::vector<WetRun>& runs, WetRun run)
    {
        // Runs that overlap are one, with the higher top: a wall between two lakes belongs to the higher one.
        for (std::size_t k = 0; k < runs.size();) {
            if (runs[k].bottom > run.top || runs[k].top < run.bottom) {
                ++k;
                continue;
            }
            run = {std::min(run.lowest, runs[k].lowest), std::min(run.bottom, runs[k].bottom), std::max(run.top, runs[k].top)};
            runs.erase(runs.begin() + static_cast<std::ptrdiff_t>(k));
        }
        runs.push_back(run);
    }

    void cut_into_boxes()
    {
        box_runs_.resize(wet_.size());
        for (int tj = 0; tj < n_.y; tj += MaterialStack::tile_size) {
            for (int ti = 0; ti < n_.x; ti += MaterialStack::tile_size) {
                const int i1 = std::min(ti + MaterialStack::tile_size, n_.x), j1 = std::min(tj + MaterialStack::tile_size, n_.y);
                for (int j = tj; j < j1; ++j) {
                    for (int i = ti; i < i1; ++i) {
                        while (!wet_[at(i, j)].empty()) put_box(i, j, i1, j1);
                    }
                }
                w_.tile_begins_.push_back(static_cast<std::uint32_t>(w_.boxes_.size()));
            }
        }
    }

    /// The run of column (i, j) that a box from `box` may be widened over, and the box then.
    std::optional<WetRun> joined(int i, int j, const WetRun& box) const
    {
        for (const WetRun& run : wet_[at(i, j)]) {
            const WetRun both{std::max(run.lowest, box.lowest), std::min(run.bottom, box.bottom), box.top};
            if (run.top == box.top && both.bottom >= both.lowest) return both;
        }
        return std::nullopt;
    }

    void put_box(int i, int j, int i1, int j1)
    {
        WetRun box = wet_[at(i, j)].back();
        int to_i = i + 1, to_j = j + 1;
        for (; to_i < i1; ++to_i) {
            const auto wider = joined(to_i, j, box);
            if (!wider) break;
            box = *wider;
        }
        for (; to_j < j1; ++to_j) {
            WetRun longer = box;
            int a = i;
            for (; a < to_i; ++a) {
                const auto next = joined(a, to_j, longer);
                if (!next) break;
                longer = *next;
            }
            if (a < to_i) break;
            box = longer;
        }
        for (int b = j; b < to_j; ++b) {
            for (int a = i; a < to_i; ++a) {
                std::erase_if(wet_[at(a, b)], [&](const WetRun& r) { return r.top == box.top; });
                box_runs_[at(a, b)].push_back({box.bottom, box.top});
            }
        }
        w_.boxes_.push_back({i, j, to_i, to_j, box.bottom, box.top});
    }

    WaterPatches& w_;
    const Ground& ground_;
    const MaterialStack& stack_;
    Vec2i n_;
    std::int32_t below_;  ///< the kernel's reach in units
    int reach_;           ///< and in columns
    std::vector<std::vector<WetRun>> wet_;
    std::vector<std::vector<Run>> box_runs_;
};

WaterPatches::WaterPatches(const ConvolutionField& ground) : ground_(ground)
{
    Builder(*this).build();
}

Box3d WaterPatches::patch_bounds(PatchId patch) const
{
    const MaterialStack& stack = ground_.ground().stack();
    const Box& b = box_of(patch);
    const Vec3d low = stack.origin() + Vec3d(b.i0 * stack.cell(), b.j0 * stack.cell(), b.bottom * stack.unit());
    const Vec3d high = stack.origin() + Vec3d(b.i1 * stack.cell(), b.j1 * stack.cell(), b.top * stack.unit());
    // A hit's place is rounded where ray and box are: a few units in the last place of the largest coordinate, and of the way.
    const double largest = std::max({low.length(), high.length(), 1.0});
    const Vec3d pad(1e-7 * stack.cell() + 0x1p-44 * largest);
    return {low - pad, high + pad};
}

WaterPatches::Way WaterPatches::way_through(const Box& box, const Ray& ray) const
{
    const MaterialStack& stack = ground_.ground().stack();
    const Vec3d origin = ray.origin - stack.origin();
    const std::array<double, 3> low = {box.i0 * stack.cell(), box.j0 * stack.cell(), box.bottom * stack.unit()};
    const std::array<double, 3> high = {box.i1 * stack.cell(), box.j1 * stack.cell(), box.top * stack.unit()};
    Way way{{-kInfinity, 2, 1}, {kInfinity, 2, 0}};
    for (int k = 0; k < 3; ++k) {
        const auto a = static_cast<std::size_t>(k);
        const double o = origin[k], d = ray.direction[k];
        if (d == 0.0) {
            if (!(o >= low[a] && o <= high[a])) return {{kInfinity, k, 0}, {-kInfinity, k, 0}};
            continue;
        }
        const double to_low = (low[a] - o) / d, to_high = (high[a] - o) / d;
        const End in = d > 0.0 ? End{to_low, k, 0} : End{to_high, k, 1}, out = d > 0.0 ? End{to_high, k, 1} : End{to_low, k, 0};
        if (in.t > way.in.t) way.in = in;
        if (out.t < way.out.t) way.out = out;
    }
    return way;
}

bool WaterPatches::wet(int i, int j, double z) const
{
    const Ground& ground = ground_.ground();
    const Vec2i n = ground.stack().size();
    if (i < 0 || j < 0 || i >= n.x || j >= n.y) {
        if (ground.border() == Border::cut) return false;
        i = std::clamp(i, 0, n.x - 1);
        j = std::clamp(j, 0, n.y - 1);
    }
    const std::size_t c = static_cast<std::size_t>(j) * static_cast<std::size_t>(n.x) + static_cast<std::size_t>(i);
    return std::any_of(runs_.begin() + column_begins_[c], runs_.begin() + column_begins_[c + 1],
                       [z](const Run& run) { return z >= run.bottom && z <= run.top; });
}

/// Whether the boundary of a box is one between water and air: no water on the other side of a side face, and no ground at the place.
bool WaterPatches::is_interface(const Box& box, const Ray& ray, const End& end) const
{
    const MaterialStack& stack = ground_.ground().stack();
    if (end.axis != 2) {
        const Vec3d p = ray.origin - stack.origin() + ray.direction * end.t;
        Vec2i beyond(std::clamp(static_cast<int>(std::floor(p.x / stack.cell())), box.i0, box.i1 - 1),
                     std::clamp(static_cast<int>(std::floor(p.y / stack.cell())), box.j0, box.j1 - 1));
        if (end.axis == 0) beyond.x = end.side == 0 ? box.i0 - 1 : box.i1;
        if (end.axis == 1) beyond.y = end.side == 0 ? box.j0 - 1 : box.j1;
        if (wet(beyond.x, beyond.y, p.z / stack.unit())) return false;
    }
    return ground_.value(ray.at(end.t)) > 0.0;
}

bool WaterPatches::intersect(PatchId patch, const Ray& ray, Hit& hit) const
{
    const Box& box = box_of(patch);
    const Way way = way_through(box, ray);
    if (!(way.in.t < way.out.t)) return false;
    const auto take = [&](const End& end) {
        if (!(end.t > ray.t_min && end.t < hit.t)) return false;
        ++hit.evaluations;
        if (!is_interface(box, ray, end)) return false;
        hit.t = end.t;
        hit.patch = patch;
        return true;
    };
    return take(way.in) || (ray.crossing == Crossing::any && take(way.out));
}

bool WaterPatches::contains(const Vec3d& p) const
{
    if (empty() || !is_finite(p)) return false;
    const MaterialStack& stack = ground_.ground().stack();
    const Vec3d local = p - stack.origin();
    const double x = local.x / stack.cell(), y = local.y / stack.cell();
    if (!(x >= 0.0 && y >= 0.0 && x <= stack.size().x && y <= stack.size().y)) return false;
    return wet(std::min(static_cast<int>(x), stack.size().x - 1), std::min(static_cast<int>(y), stack.size().y - 1), local.z / stack.unit());
}

Interaction WaterPatches::interact(const Ray& ray, const Hit& hit) const
{
    const Box& box = box_of(hit.patch);
    const Way way = way_through(box, ray);
    const End& end = std::abs(way.in.t - hit.t) <= std::abs(way.out.t - hit.t) ? way.in : way.out;
    Interaction at;
    at.t = hit.t;
    at.position = ray.at(hit.t);
    // Two roundings of a coordinate and one of the way: 2^-51 of each, and as much again for the box's own face.
    at.position_error = 0x1p-50 * (ray.origin.length() + hit.t + at.position.length());
    at.geometric_normal = Vec3d(0.0);
    at.geometric_normal[end.axis] = end.side == 0 ? -1.0 : 1.0;
    at.shading_normal = at.geometric_normal;
    at.texture_point = at.position;
    return at;
}

std::uint64_t WaterPatches::memory_bytes() const
{
    return boxes_.capacity() * sizeof(Box) + tile_begins_.capacity() * sizeof(std::uint32_t) + column_begins_.capacity() * sizeof(std::uint32_t) +
           runs_.capacity() * sizeof(Run);
}

}  // namespace hoodoo
