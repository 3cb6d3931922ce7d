// Primitives of the tree: planes, whole heights, heights within a circle, and paths with a section (Genevaux2015, as the maths of GalinCourse's
// group). A path has the weight w(d), d the distance from its nearest piece, and the height z + section(d) + rough. z is that of the nearest piece's
// own plane, which rises along the piece and on beyond it; near corners the planes of several pieces are blended with weights
//   e_i = length_i max(0, 1 - (d_i^2 - d^2) / joint^2)^2,    so that z is continuous although the nearest place on a path jumps.
// The weight still creases where two pieces are equally near on the inner side of a corner. Bounds: d_i^2 has the gradient 2 (p - nearest point),
// which is 2-Lipschitz for a convex piece. Deviation: heights are those of planes, not of the nearest point, beyond the ends. Missing: materials of
// their own.
#include "terrain/fields/elevation.h"
#include "terrain/fields/landform.h"
#include "terrain/fields/radial.h"
#include "terrain/fields/support_tree.h"

namespace hoodoo
{

namespace
{

constexpr double kPlaceRounding = 0x1p-7;  // of a coordinate, in units of area_jet.cpp's rounding: 2^-51

/// The rounding of coordinates, as it shows in something of this slope.
double place_size(const Vec2d& p, double slope)
{
    return kPlaceRounding * (std::abs(p.x) + std::abs(p.y)) * slope;
}

AreaJet known(const Height& height, const Area& area, double datum)
{
    const HeightBounds bounds = height.bounds(area.box);
    AreaJet jet{bounds.value, bounds.gradient, bounds.slope, bounds.curvature, {height.height(area.at), height.gradient(area.at)}, area.radius, 0.0};
    jet.size = bounds.value.magnitude() + place_size(area.at, std::min(bounds.slope, 1e6));
    return shifted(jet, -datum).narrow();
}

Box2d grown(Box2d box, double by)
{
    return {box.min - Vec2d(by), box.max + Vec2d(by)};
}

Elevated<AreaJet> nothing(const Area& area)
{
    return {AreaJet::constant(0.0, area.radius), AreaJet::constant(0.0, area.radius), {kInfinity, -kInfinity}};
}

/// weight (h - datum) from the two.
Elevated<AreaJet> weighted(const AreaJet& weight, const AreaJet& height)
{
    return {weight * height, weight, height.value};
}

/// A primitive that ends: its bounds are found over its own part of the area, and hold with 0 for the rest.
class Bounded : public Landform
{
public:
    Elevated<AreaJet> over(const Area& area, double datum) const final
    {
        const Box2d own = support();
        Box2d box(Vec2d(std::max(area.box.min.x, own.min.x), std::max(area.box.min.y, own.min.y)),
                  Vec2d(std::min(area.box.max.x, own.max.x), std::min(area.box.max.y, own.max.y)));
        if (box.isEmpty()) return nothing(area);
        if (box == area.box && std::isfinite(area.radius)) return within(area, datum);
        Elevated<AreaJet> bounds = within(Area::of(box), datum);
        const Elevated<Jet2> here = at(area.at, datum);
        for (auto [jet, point] : {std::pair(&bounds.height, &here.height), std::pair(&bounds.weight, &here.weight)}) {
            jet->value = Interval::hull(jet->value, {0.0, 0.0});
            for (Interval& g : jet->gradient) g = Interval::hull(g, {0.0, 0.0});
            jet->at = *point;
            jet->radius = area.radius;
            jet->narrow();
        }
        return bounds;
    }

protected:
    /// The area lies in the support and is finite.
    virtual Elevated<AreaJet> within(const Area& area, double datum) const = 0;
};

// -- Everywhere --------------------------------------------------------------------------------------------------------

class Flat final : public Landform
{
public:
    explicit Flat(double height) : height_(height) {}
    Elevated<Jet2> at(const Vec2d&, double datum) const override { return {{height_ - datum}, {1.0}, {}}; }
    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        return {shifted(AreaJet::constant(height_, area.radius), -datum), AreaJet::constant(1.0, area.radius), {height_ - datum, height_ - datum}};
    }
    Box2d support() const override { return {Vec2d(-kInfinity), Vec2d(kInfinity)}; }
    double least_weight() const override { return 1.0; }

private:
    double height_;
};

class Whole final : public Landform
{
public:
    Whole(std::shared_ptr<const Height> height, std::uint64_t bytes) : height_(std::move(height)), bytes_(bytes) {}
    Elevated<Jet2> at(const Vec2d& p, double datum) const override { return {{height_->height(p) - datum, height_->gradient(p)}, {1.0}, {}}; }
    Elevated<AreaJet> over(const Area& area, double datum) const override
    {
        const AreaJet height = known(*height_, area, datum);
        return {height, AreaJet::constant(1.0, area.radius), height.value};
    }
    Box2d support() const override { return {Vec2d(-kInfinity), Vec2d(kInfinity)}; }
    double least_weight() const override { return 1.0; }
    std::uint64_t memory_bytes() const override { return bytes_; }

private:
    std::shared_ptr<const Height> height_;
    std::uint64_t bytes_;
};

// -- Distances ---------------------------------------------------------------------------------------------------------

/// A straight piece of a path, or a point.
struct Piece {
    Vec2d a, along;       ///< start; unit direction, or 0
    double length = 0.0;  ///< metres
    double z = 0.0, rise = 0.0;

    /// From the nearest place on it.
    Vec2d away(const Vec2d& p) const
    {
        const Vec2d from = p - a;
        return from - along * std::clamp(from.dot(along), 0.0, length);
    }
    Jet2 height(const Vec2d& p, double datum) const { return {z - datum + rise * (p - a).dot(along), along * rise}; }
    AreaJet height(const Area& area, double datum) const
    {
        AreaJet jet;
        jet.at = height(area.at, datum);
        jet.radius = area.radius;
        jet.slope = std::abs(rise);
        for (int k = 0; k < 2; ++k) jet.gradient[static_cast<std::size_t>(k)] = {jet.at.gradient[k], jet.at.gradient[k]};
        jet.value = {jet.at.value - jet.slope * area.radius, jet.at.value + jet.slope * area.radius};
        jet.size = std::abs(z) + std::abs(datum) + jet.value.magnitude() + place_size(area.at, jet.slope);
        return jet;
    }
};

/// d^2 over an area, from the piece's p - nearest point.
AreaJet square_distance(const Vec2d& away, const Area& area)
{
    AreaJet q;
    const double d = away.length(), lo = std::max(0.0, d - area.radius), hi = d + area.radius;
    q.value = {lo * lo, hi * hi};
    q.slope = 2.0 * hi;
    q.curvature = 2.0;
    q.at = {d * d, away * 2.0};
    q.gradient = {Interval{-q.slope, q.slope}, Interval{-q.slope, q.slope}};
    q.radius = area.radius;
    q.size = hi * hi + place_size(area.at, q.slope);
    return q.narrow();
}

AreaJet distance(const Vec2d& away, const Area& area)
{
    AreaJet jet;
    const double d = away.length();
    const Vec2d n = d > 0.0 ? away * (1.0 / d) : Vec2d(0.0);
    jet.value = {std::max(0.0, d - area.radius), d + area.radius};
    jet.slope = 1.0;
    jet.gradient = {Interval{-1.0, 1.0}, Interval{-1.0, 1.0}};
    jet.curvature = jet.value.lo > 0.0 ? 1.0 / jet.value.lo : kInfinity;
    jet.at = {d, n};
    jet.radius = area.radius;
    jet.size = jet.value.hi + place_size(area.at, 1.0);
    return jet.narrow();
}

// -- Heights within a circle -------------------------------------------------------------------------------------------

class Disc final : public Bounded
{
public:
    Disc(std::shared_ptr<const Height> height, const Vec2d& centre, const Falloff& falloff, std::uint64_t bytes)
        : height_(std::move(height)), centre_(centre), falloff_(falloff), bytes_(bytes)
    {
    }
    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        const Vec2d away = p - centre_;
        const double d = away.length();
        if (d >= falloff_.radius) return {};
        const auto [w, slope] = falloff_at(falloff_, d);
        const Jet2 weight{w, d > 0.0 ? away * (slope / d) : Vec2d(0.0)};
        return {weight * Jet2{height_->height(p) - datum, height_->gradient(p)}, weight, {}};
    }
    Box2d support() const override { return grown({centre_, centre_}, falloff_.radius); }
    std::uint64_t memory_bytes() const override { return bytes_; }

private:
    Elevated<AreaJet> within(const Area& area, double datum) const override
    {
        const DistanceOver d{distance(area.at - centre_, area), true};
        const AreaJet weight = radial(falloff_at(falloff_, d.jet.at.value), falloff_over(falloff_, d.jet.value), d);
        if (weight.value.hi == 0.0) return nothing(area);
        return weighted(weight, known(*height_, area, datum));
    }

    std::shared_ptr<const Height> height_;
    Vec2d centre_;
    Falloff falloff_;
    std::uint64_t bytes_;
};

// -- Paths -------------------------------------------------------------------------------------------------------------

/// What a path is at a point or over an area, piece by piece.
template <class T>
struct NearPieces {
    struct Near {
        T square;  ///< of the distance
        T height;
        double length;
    };
    std::vector<Near> list;
};

/// Heights of the pieces, run together. `least` is the square of the smallest distance; `shortest`: the shortest piece that counts.
template <class T>
T joined(const std::vector<typename NearPieces<T>::Near>& near, const T& least, double joint, double shortest, T sum, T weights)
{
    if (near.size() == 1) return near[0].height;
    Interval heights{kInfinity, -kInfinity};
    for (const auto& piece : near) {
        T part = positive_part(shifted(scaled(piece.square - least, -1.0 / (joint * joint)), 1.0));
        if constexpr (std::is_same_v<T, AreaJet>) {
            part.within({0.0, 1.0});  // no square is below the least
            heights = Interval::hull(heights, piece.height.value);
        }
        const T e = scaled(part * part, piece.length);
        sum = sum + e * piece.height;
        weights = weights + e;
    }
    // The nearest piece itself has its length for a weight.
    if constexpr (std::is_same_v<T, AreaJet>) {
        weights.value.lo = std::max(weights.value.lo, shortest);
        return quotient(sum, weights).within(heights);
    } else {
        return quotient(sum, weights);
    }
}

class Path final : public Bounded
{
public:
    explicit Path(const PathForm& form) : falloff_(form.falloff), section_(form.section), joint_(form.joint), rough_(form.rough)
    {
        for (std::size_t n = 0; n + 1 < form.points.size() || n == 0; ++n) {
            const Vec3d a = form.points[n], b = form.points[std::min(n + 1, form.points.size() - 1)];
            Piece piece{Vec2d(a.x, a.y), Vec2d(b.x - a.x, b.y - a.y), 0.0, a.z, 0.0};
            piece.length = piece.along.length();
            if (piece.length > 0.0) {
                piece.along *= 1.0 / piece.length;
                piece.rise = (b.z - a.z) / piece.length;
            } else {
                piece.length = piece.rise = 0.0;
                piece.along = Vec2d(0.0);
            }
            pieces_.push_back(piece);
            Box2d box(Vec2d(a.x, a.y));
            box.extendBy(Vec2d(b.x, b.y));
            support_.extendBy(grown(box, falloff_.radius).min);
            support_.extendBy(grown(box, falloff_.radius).max);
            boxes_.push_back(grown(box, std::hypot(falloff_.radius, joint_)));
        }
        if (pieces_.size() > 1) tree_ = SupportTree(boxes_);
    }

    Elevated<Jet2> at(const Vec2d& p, double datum) const override
    {
        if (!support_.intersects(p)) return {};
        std::vector<NearPieces<Jet2>::Near> near;
        Jet2 least{kInfinity};
        for (const std::uint32_t n : candidates(Box2d(p))) {
            const Vec2d away = pieces_[n].away(p);
            near.push_back({{away.length2(), away * 2.0}, pieces_[n].height(p, datum), pieces_[n].length});
            if (near.back().square.value < least.value) least = near.back().square;
        }
        const double d = std::sqrt(least.value);
        if (!(d < falloff_.radius)) return {};
        std::erase_if(near, [&](const auto& piece) { return piece.square.value - least.value >= joint_ * joint_; });
        Jet2 height = joined<Jet2>(near, least, joint_, 0.0, {}, {});
        const auto along = [&](const std::pair<double, double>& f) {
            return Jet2{f.first, d > 0.0 ? least.gradient * (0.5 * f.second / d) : Vec2d(0.0)};
        };
        height = height + along(section_.at(d));
        if (rough_) height = height + Jet2{rough_->height(p), rough_->gradient(p)};
        const Jet2 weight = along(falloff_at(falloff_, d));
        return {weight * height, weight, {}};
    }
    Box2d support() const override { return support_; }
    std::uint64_t memory_bytes() const override { return pieces_.size() * (sizeof(Piece) + 2 * sizeof(Box2d)); }

private:
    std::vector<std::uint32_t> candidates(const Box2d& area) const
    {
        std::vector<std::uint32_t> found;
        if (pieces_.size() == 1) return {0};
        tree_.find(area, found);
        return found;
    }

    Elevated<AreaJet> within(const Area& area, double datum) const override
    {
        struct Candidate {
            std::uint32_t piece;
            Vec2d away;
            AreaJet distance;
        };
        std::vector<Candidate> found;
        double farthest = kInfinity;  // that the nearest piece can be
        for (const std::uint32_t n : candidates(area.box)) {
            const Vec2d away = pieces_[n].away(area.at);
            found.push_back({n, away, distance(away, area)});
            farthest = std::min(farthest, found.back().distance.value.hi);
        }
        // Some pieces can be the nearest; more can count for the height.
        DistanceOver d;
        AreaJet least;
        std::vector<NearPieces<AreaJet>::Near> near;
        double shortest = kInfinity;
        int nearest = 0;
        for (const Candidate& c : found) {
            const Piece& piece = pieces_[c.piece];
            const double lo = c.distance.value.lo;
            const AreaJet square = square_distance(c.away, area);
            if (lo <= farthest) {
                least = nearest == 0 ? square : lower_of(least, square);
                d.jet = nearest == 0 ? c.distance : lower_of(d.jet, c.distance);
                shortest = std::min(shortest, piece.length);
                ++nearest;
            }
            if (lo * lo - farthest * farthest < joint_ * joint_) near.push_back({square, piece.height(area, datum), piece.length});
        }
        if (nearest == 0) return nothing(area);
        d.convex = nearest == 1;
        const AreaJet weight = radial(falloff_at(falloff_, d.jet.at.value), falloff_over(falloff_, d.jet.value), d);
        if (weight.value.hi == 0.0) return nothing(area);
        const AreaJet none = AreaJet::constant(0.0, area.radius);
        AreaJet height = joined<AreaJet>(near, least, joint_, shortest, none, none);
        height = height + radial(section_.at(d.jet.at.value), section_.over(d.jet.value), d);
        if (rough_) height = height + known(*rough_, area, 0.0);
        return weighted(weight, height);
    }

    /// The smaller of two, wherever it is which.
    static AreaJet lower_of(const AreaJet& a, const AreaJet& b)
    {
        AreaJet c = a.at.value <= b.at.value ? a : b;
        c.value = {std::min(a.value.lo, b.value.lo), std::min(a.value.hi, b.value.hi)};
        for (std::size_t k = 0; k < 2; ++k) c.gradient[k] = Interval::hull(a.gradient[k], b.gradient[k]);
        c.slope = std::max(a.slope, b.slope);
        c.curvature = kInfinity;
        c.size = std::max(a.size, b.size);
        return c;
    }

    std::vector<Piece> pieces_;
    std::vector<Box2d> boxes_;
    Box2d support_;
    SupportTree tree_;
    Falloff falloff_;
    SectionCurve section_;
    double joint_;
    std::shared_ptr<const Height> rough_;
};

}  // namespace

LandformPtr landform_flat(double height)
{
    return std::make_shared<Flat>(height);
}

LandformPtr landform_of(std::shared_ptr<const Height> height, std::uint64_t bytes)
{
    return std::make_shared<Whole>(std::move(height), bytes);
}

LandformPtr landform_disc(std::shared_ptr<const Height> height, const Vec2d& centre, const Falloff& falloff, std::uint64_t bytes)
{
    return std::make_shared<Disc>(std::move(height), centre, falloff, bytes);
}

LandformPtr landform_path(const PathForm& form)
{
    return std::make_shared<Path>(form);
}

}  // namespace hoodoo
