// Terrain as a sparse sum of patches out of a dictionary (Guerin2016): a coarse height is written with few pieces of a fine one, and so gets its
// detail.
#pragma once

#include "terrain/fields/landform.h"
#include "terrain/fields/spline_grid.h"

#include <memory>
#include <vector>

namespace hoodoo
{

struct DictionaryOptions {
    double spacing = 1.0;  ///< metres between neighbouring patches
    double detail = 0.1;   ///< metres between the coefficients of an atom
    int atoms = 64;        ///< at most; 1 or more
    int terms = 2;         ///< atoms that one patch may use, 1 to 8
};

/// One patch of a represented terrain: mean + sum factor atom(p - centre), weighted by the dictionary's falloff about the centre.
struct SparsePatch {
    struct Term {
        std::uint32_t atom;
        double factor;  ///< metres
    };
    Vec2d centre{0.0};
    double mean = 0.0;  ///< metres
    std::vector<Term> terms;
};

/// Pieces of one terrain. An atom is known twice: as a vector of coarse samples, by which it is chosen, and in full detail, which is what is seen.
/// Immutable, thread-safe.
class TerrainDictionary
{
public:
    /// Samples along the side of the square that holds a patch, for choosing.
    static constexpr int kSide = 13;

    /// Cuts atoms out of `exemplar` over `area`, a part of its domain in which at least one patch has room: see needed_size. Throws Error (internal)
    /// if there is none, or if the exemplar is level there.
    TerrainDictionary(const Height& exemplar, const Box2d& area, const DictionaryOptions& options);

    /// Of the side of an area from which atoms can be cut, metres.
    static double needed_size(double spacing);

    /// The patches of `target` over `area`, on a square lattice from its lower corner on.
    std::vector<SparsePatch> represent(const Height& target, const Box2d& area) const;

    /// h(p) = sum_k w(p - q_k) (mean_k + sum_j factor_kj atom_j(p - q_k)) / sum_k w(p - q_k)   (Guerin2016), as a landform whose weight is 1 wherever
    /// patches lie all around.
    LandformPtr landform(const std::vector<SparsePatch>& patches) const;

    Falloff falloff() const;
    std::uint32_t size() const { return static_cast<std::uint32_t>(atoms_->size()); }
    const SplineGrid& atom(std::uint32_t index) const { return (*atoms_)[index]; }
    std::uint64_t memory_bytes() const;

private:
    using Vector = std::vector<double>;  ///< kSide x kSide coarse samples times the roots of their weights

    DictionaryOptions options_;
    Vector weights_;              ///< of coarse samples; sum to 1
    std::vector<Vector> coarse_;  ///< of unit length
    std::shared_ptr<std::vector<SplineGrid>> atoms_;
};

}  // namespace hoodoo
