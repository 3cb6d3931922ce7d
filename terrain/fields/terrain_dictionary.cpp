// Atoms are patches of the exemplar itself, in eight orientations, so that their detail is real; a greedy choice takes the one that those before it
// describe worst. A patch of the target is written by orthogonal matching pursuit: again and again the atom nearest to what is left, then all factors
// at once by least squares. Both see coarse samples only, means of squares as wide as their distance, less their weighted mean; the factors then
// stand before the atoms in full detail (Guerin2016, amplification). Deviation: the paper also trains dictionaries by gradient descent; ours are cut
// only.
#include "terrain/fields/terrain_dictionary.h"

#include "terrain/error.h"
#include "terrain/fields/radial.h"
#include "terrain/math/parallel.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace hoodoo
{
namespace
{

constexpr int kSide = TerrainDictionary::kSide;
constexpr int kStep = 3;                       // coarse samples from one place to cut at to the next, at least
constexpr int kMostPlaces = 4096;              // eight orientations each
constexpr int kMeans = 4;                      // samples along the side of a coarse sample's square
constexpr double kLevel = 1e-3;                // of the longest vector: shorter ones are level ground, of which nothing can be learnt
constexpr double kRadius = 1.3, kCore = 0.72;  // of the spacing; four cores meet at 0.7071

double dot(const std::vector<double>& a, const std::vector<double>& b)
{
    return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
}

/// Mean height over a square.
double coarse_height(const Height& height, const Vec2d& middle, double side)
{
    double sum = 0.0;
    for (int b = 0; b < kMeans; ++b)
        for (int a = 0; a < kMeans; ++a) sum += height.height(middle + Vec2d((a + 0.5) / kMeans - 0.5, (b + 0.5) / kMeans - 0.5) * side);
    return sum / (kMeans * kMeans);
}

/// One of the eight that keep a square; `g` from 0 to 7. Exact.
Vec2d turned(int g, const Vec2d& p)
{
    const Vec2d q = g & 4 ? Vec2d(p.y, p.x) : p;
    return {g & 1 ? -q.x : q.x, g & 2 ? -q.y : q.y};
}

/// Takes the weighted mean off and multiplies by the roots of the weights; returns the mean.
double centred(std::vector<double>& samples, const std::vector<double>& weights)
{
    const double mean = dot(samples, weights);
    for (std::size_t n = 0; n < samples.size(); ++n) samples[n] = (samples[n] - mean) * std::sqrt(weights[n]);
    return mean;
}

/// A patch as a height.
class PatchHeight final : public Height
{
public:
    PatchHeight(std::shared_ptr<const std::vector<SplineGrid>> atoms, SparsePatch patch) : atoms_(std::move(atoms)), patch_(std::move(patch)) {}
    double height(const Vec2d& p) const override
    {
        double sum = patch_.mean;
        for (const SparsePatch::Term& term : patch_.terms) sum += term.factor * (*atoms_)[term.atom].height(p - patch_.centre);
        return sum;
    }
    Vec2d gradient(const Vec2d& p) const override
    {
        Vec2d sum(0.0);
        for (const SparsePatch::Term& term : patch_.terms) sum += (*atoms_)[term.atom].gradient(p - patch_.centre) * term.factor;
        return sum;
    }
    Interval range(const Box2d& area) const override { return bounds(area).value; }
    double slope_bound(const Box2d& area) const override { return bounds(area).slope; }
    Box2d domain() const override { return {Vec2d(-kInfinity), Vec2d(kInfinity)}; }
    std::array<Interval, 2> gradient_range(const Box2d& area) const override { return bounds(area).gradient; }
    double curvature_bound(const Box2d& area) const override { return bounds(area).curvature; }
    HeightBounds bounds(const Box2d& area) const override
    {
        HeightBounds all{{patch_.mean, patch_.mean}, 0.0, 0.0, {}};
        double size = std::abs(patch_.mean);
        for (const SparsePatch::Term& term : patch_.terms) {
            const HeightBounds one = (*atoms_)[term.atom].bounds({area.min - patch_.centre, area.max - patch_.centre});
            const double factor = std::abs(term.factor);
            // The place in the atom is rounded by less than this.
            const double place = 0x1p-51 * (std::abs(patch_.centre.x) + std::abs(patch_.centre.y)), turn = place * factor * one.curvature;
            all.value = all.value + one.value.scaled(term.factor);
            for (std::size_t k = 0; k < 2; ++k) all.gradient[k] = all.gradient[k] + one.gradient[k].scaled(term.factor) + Interval{-turn, turn};
            all.slope += factor * one.slope;
            all.curvature += factor * one.curvature;
            size += factor * one.value.magnitude() + 0x1p46 * place * factor * one.slope;
        }
        all.value = {all.value.lo - 0x1p-46 * size, all.value.hi + 0x1p-46 * size};
        return all;
    }

private:
    std::shared_ptr<const std::vector<SplineGrid>> atoms_;
    SparsePatch patch_;
};

/// Factors of `chosen` that come nearest to x, by least squares: Cholesky's decomposition of their few products.
std::vector<double> least_squares(const std::vector<const std::vector<double>*>& chosen, const std::vector<double>& x)
{
    const std::size_t n = chosen.size();
    std::vector<double> l(n * n, 0.0), f(n);
    for (std::size_t i = 0; i < n; ++i) {
        for (std::size_t j = 0; j <= i; ++j) {
            double sum = dot(*chosen[i], *chosen[j]);
            for (std::size_t k = 0; k < j; ++k) sum -= l[i * n + k] * l[j * n + k];
            l[i * n + j] = i == j ? std::sqrt(std::max(sum, 1e-12)) : sum / l[j * n + j];
        }
    }
    for (std::size_t i = 0; i < n; ++i) {
        double sum = dot(*chosen[i], x);
        for (std::size_t k = 0; k < i; ++k) sum -= l[i * n + k] * f[k];
        f[i] = sum / l[i * n + i];
    }
    for (std::size_t i = n; i-- > 0;) {
        for (std::size_t k = i + 1; k < n; ++k) f[i] -= l[k * n + i] * f[k];
        f[i] /= l[i * n + i];
    }
    return f;
}

}  // namespace

double TerrainDictionary::needed_size(double spacing)
{
    return 2.0 * kRadius * spacing;
}

Falloff TerrainDictionary::falloff() const
{
    return {kRadius * options_.spacing, kCore * options_.spacing, 3};
}

TerrainDictionary::TerrainDictionary(const Height& exemplar, const Box2d& area, const DictionaryOptions& options)
    : options_(options), atoms_(std::make_shared<std::vector<SplineGrid>>())
{
    const double radius = kRadius * options.spacing, side = 2.0 * radius / (kSide - 1);
    const Falloff shape = falloff();
    weights_.resize(kSide * kSide);
    for (int b = 0; b < kSide; ++b)
        for (int a = 0; a < kSide; ++a)
            weights_[static_cast<std::size_t>(b * kSide + a)] =
                falloff_at(shape, std::min(radius, Vec2d(a * side - radius, b * side - radius).length())).first;
    const double sum = std::accumulate(weights_.begin(), weights_.end(), 0.0);
    for (double& w : weights_) w /= sum;

    // Coarse samples of the whole area, and places whose square lies in it.
    const int columns = static_cast<int>(std::floor((area.max.x - area.min.x) / side * (1.0 + 1e-12))) + 1;
    const int rows = static_cast<int>(std::floor((area.max.y - area.min.y) / side * (1.0 + 1e-12))) + 1;
    if (columns < kSide || rows < kSide) throw Error(ErrorKind::internal, "no patch fits into the exemplar");
    std::vector<double> grid(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    parallel_items(grid.size(), [&](std::size_t n) {
        const auto i = static_cast<int>(n % static_cast<std::size_t>(columns)), j = static_cast<int>(n / static_cast<std::size_t>(columns));
        grid[n] = coarse_height(exemplar, area.min + Vec2d(i, j) * side, side);
    });
    int step = kStep;
    const auto places = [&](int count) { return (count - kSide) / step + 1; };
    while (static_cast<double>(places(columns)) * places(rows) > kMostPlaces) ++step;

    struct Candidate {
        Vec2d centre;
        int turn;
        double length2, described = 0.0;  ///< squares of its vector's length, and of that of its best approximation
    };
    std::vector<Candidate> candidates;
    std::vector<Vector> vectors;
    for (int j = 0; j < places(rows); ++j) {
        for (int i = 0; i < places(columns); ++i) {
            const int i0 = i * step, j0 = j * step;
            for (int turn = 0; turn < 8; ++turn) {
                Vector v(weights_.size());
                for (int b = 0; b < kSide; ++b) {
                    for (int a = 0; a < kSide; ++a) {
                        const Vec2d q = turned(turn, Vec2d(a, b) - Vec2d(0.5 * (kSide - 1))) + Vec2d(0.5 * (kSide - 1));
                        const std::size_t at = static_cast<std::size_t>(j0 + static_cast<int>(q.y)) * static_cast<std::size_t>(columns) +
                                               static_cast<std::size_t>(i0 + static_cast<int>(q.x));
                        v[static_cast<std::size_t>(b * kSide + a)] = grid[at];
                    }
                }
                centred(v, weights_);
                candidates.push_back({area.min + Vec2d(i0, j0) * side + Vec2d(radius), turn, dot(v, v)});
                vectors.push_back(std::move(v));
            }
        }
    }
    double longest = 0.0;
    for (const Candidate& c : candidates) longest = std::max(longest, c.length2);
    if (!(longest > 0.0)) throw Error(ErrorKind::internal, "the exemplar is level");

    // The spline needs coefficients one cell beyond what is seen, and one more for rounding.
    const int beyond = static_cast<int>(std::ceil(radius / options.detail)) + 2, across = 2 * beyond + 1;
    while (static_cast<int>(coarse_.size()) < options.atoms) {
        std::size_t worst = candidates.size();
        double most = 0.0;
        for (std::size_t n = 0; n < candidates.size(); ++n) {
            const Candidate& c = candidates[n];
            if (c.length2 < kLevel * kLevel * longest) continue;
            const double left = c.length2 - c.described;
            if (left > most * (1.0 + 1e-9) && left > 1e-9 * longest) most = left, worst = n;
        }
        if (worst == candidates.size()) break;  // all are described
        const Candidate chosen = candidates[worst];
        const double length = std::sqrt(chosen.length2);
        Vector unit = vectors[worst];
        for (double& x : unit) x /= length;
        parallel_items(candidates.size(), [&](std::size_t n) {
            const double along = dot(vectors[n], unit);
            candidates[n].described = std::max(candidates[n].described, along * along);
        });
        candidates[worst].described = chosen.length2;

        double mean = 0.0;
        for (int b = 0; b < kSide; ++b)
            for (int a = 0; a < kSide; ++a)
                mean += weights_[static_cast<std::size_t>(b * kSide + a)] *
                        coarse_height(exemplar, chosen.centre + turned(chosen.turn, Vec2d(a * side - radius, b * side - radius)), side);
        std::vector<float> coefficients(static_cast<std::size_t>(across) * static_cast<std::size_t>(across));
        parallel_items(coefficients.size(), [&](std::size_t n) {
            const Vec2d p(static_cast<int>(n) % across - beyond, static_cast<int>(n) / across - beyond);
            coefficients[n] = static_cast<float>((exemplar.height(chosen.centre + turned(chosen.turn, p * options.detail)) - mean) / length);
        });
        atoms_->emplace_back(Vec2d(-beyond * options.detail), options.detail, across, across, std::move(coefficients));
        coarse_.push_back(std::move(unit));
    }
}

std::vector<SparsePatch> TerrainDictionary::represent(const Height& target, const Box2d& area) const
{
    const double spacing = options_.spacing, radius = kRadius * spacing, side = 2.0 * radius / (kSide - 1);
    const int columns = static_cast<int>(std::floor((area.max.x - area.min.x) / spacing * (1.0 + 1e-12))) + 1;
    const int rows = static_cast<int>(std::floor((area.max.y - area.min.y) / spacing * (1.0 + 1e-12))) + 1;
    std::vector<SparsePatch> patches(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows));
    parallel_items(patches.size(), [&](std::size_t n) {
        SparsePatch& patch = patches[n];
        patch.centre =
            area.min +
            Vec2d(static_cast<double>(n % static_cast<std::size_t>(columns)), static_cast<double>(n / static_cast<std::size_t>(columns))) * spacing;
        Vector x(weights_.size());
        for (int b = 0; b < kSide; ++b)
            for (int a = 0; a < kSide; ++a)
                x[static_cast<std::size_t>(b * kSide + a)] = coarse_height(target, patch.centre + Vec2d(a * side - radius, b * side - radius), side);
        patch.mean = centred(x, weights_);
        const double length2 = dot(x, x);
        Vector left = x;
        std::vector<const Vector*> chosen;
        std::vector<double> factors;
        while (static_cast<int>(chosen.size()) < options_.terms && dot(left, left) > 1e-12 * length2) {
            std::uint32_t best = size();
            double most = 0.0;
            for (std::uint32_t k = 0; k < size(); ++k) {
                const double along = std::abs(dot(left, coarse_[k]));
                if (along > most) most = along, best = k;
            }
            if (best == size() || std::any_of(patch.terms.begin(), patch.terms.end(), [&](const auto& t) { return t.atom == best; })) break;
            chosen.push_back(&coarse_[best]);
            patch.terms.push_back({best, 0.0});
            factors = least_squares(chosen, x);
            left = x;
            for (std::size_t k = 0; k < chosen.size(); ++k)
                for (std::size_t m = 0; m < left.size(); ++m) left[m] -= factors[k] * (*chosen[k])[m];
        }
        for (std::size_t k = 0; k < factors.size(); ++k) patch.terms[k].factor = factors[k];
    });
    return patches;
}

LandformPtr TerrainDictionary::landform(const std::vector<SparsePatch>& patches) const
{
    // The patches share the atoms, and so their bytes.
    const std::uint64_t share = memory_bytes() / std::max<std::size_t>(1, patches.size());
    std::vector<LandformPtr> nodes;
    for (const SparsePatch& patch : patches)
        nodes.push_back(landform_disc(std::make_shared<PatchHeight>(atoms_, patch), patch.centre, falloff(),
                                      share + sizeof(PatchHeight) + patch.terms.size() * sizeof(SparsePatch::Term)));
    return landform_blend(std::move(nodes), BlendWeight::united);
}

std::uint64_t TerrainDictionary::memory_bytes() const
{
    std::uint64_t bytes = 0;
    for (const SplineGrid& atom : *atoms_) bytes += atom.memory_bytes();
    return bytes;
}

}  // namespace hoodoo
