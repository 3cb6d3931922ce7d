// Matter that hangs in the air: runs of matter along z, joined where runs of neighbouring columns overlap (union-find), and those sets kept that
// reach the ground. Memory follows the number of runs, not of samples.
#include "terrain/edit/weather.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

namespace hoodoo
{

namespace
{

struct Span {
    int lo, hi;  ///< samples, both inclusive
};

std::vector<Span> runs_of(const SparseLattice<float>& values, int i, int j)
{
    std::vector<Span> runs;
    for (int k = 0; k < values.size()[2]; ++k) {
        const auto view = values.block({i / 8, j / 8, k / 8});
        if (!view.block && !(view.constant < 0.0f)) {
            k |= 7;  // a block of air
            continue;
        }
        if (!(values.at({i, j, k}) < 0.0f)) continue;
        if (!runs.empty() && runs.back().hi == k - 1) {
            runs.back().hi = k;
        } else {
            runs.push_back({k, k});
        }
    }
    return runs;
}

class Sets
{
public:
    explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
    std::size_t root(std::size_t a)
    {
        while (parent_[a] != a) a = parent_[a] = parent_[parent_[a]];
        return a;
    }
    void join(std::size_t a, std::size_t b)
    {
        a = root(a), b = root(b);
        parent_[std::max(a, b)] = std::min(a, b);
    }

private:
    std::vector<std::size_t> parent_;
};

}  // namespace

std::uint64_t drop_unsupported(VoxelGrid& grid, double ground)
{
    const Index3& n = grid.values.size();
    std::vector<Span> runs;
    std::vector<std::size_t> first;  // run of each column, i slowest
    int lowest = std::numeric_limits<int>::max();
    for (int i = 0; i < n[0]; ++i)
        for (int j = 0; j < n[1]; ++j) {
            first.push_back(runs.size());
            for (const Span& run : runs_of(grid.values, i, j)) {
                runs.push_back(run);
                lowest = std::min(lowest, run.lo);
            }
        }
    first.push_back(runs.size());
    if (runs.empty()) return 0;
    const double level = std::isfinite(ground) ? grid.local(Vec3d(0.0, 0.0, ground)).z : lowest;

    Sets sets(runs.size());
    const auto columns = static_cast<std::size_t>(n[1]);
    const auto join_columns = [&](std::size_t a, std::size_t b) {
        std::size_t s = first[b];
        for (std::size_t r = first[a]; r < first[a + 1]; ++r) {
            while (s < first[b + 1] && runs[s].hi < runs[r].lo) ++s;
            for (std::size_t t = s; t < first[b + 1] && runs[t].lo <= runs[r].hi; ++t) sets.join(r, t);
        }
    };
    for (std::size_t c = 0; c + 1 < first.size(); ++c) {
        if ((c + 1) % columns != 0) join_columns(c, c + 1);
        if (c + columns + 1 < first.size()) join_columns(c, c + columns);
    }
    std::vector<bool> stands(runs.size(), false);
    for (std::size_t r = 0; r < runs.size(); ++r)
        if (runs[r].lo <= level) stands[sets.root(r)] = true;

    std::uint64_t gone = 0;
    for (std::size_t c = 0; c + 1 < first.size(); ++c)
        for (std::size_t r = first[c]; r < first[c + 1]; ++r) {
            if (stands[sets.root(r)]) continue;
            for (int k = runs[r].lo; k <= runs[r].hi; ++k) {
                grid.set({static_cast<int>(c / columns), static_cast<int>(c % columns), k}, grid.values.outside());
                ++gone;
            }
        }
    if (gone > 0) grid.trim();
    return gone;
}

}  // namespace hoodoo
